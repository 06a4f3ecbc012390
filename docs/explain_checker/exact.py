"""Exact numbers and vectors, and the roots of linear and quadratic equations."""
import math
from copy import copy
from fractions import Fraction


def sign(x):
    return (x > 0) - (x < 0)


def root(x):
    """Returns the square root, off by less than 2^-200 of itself."""
    if x <= 0:
        return Fraction(0)
    shift = max(0, 420 - (x.numerator.bit_length() + x.denominator.bit_length()) // 2)
    return Fraction(math.isqrt(x.numerator * x.denominator << 2 * shift), x.denominator << shift)


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def times(k, v):
    return [k * x for x in v]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def sizes(v):
    return [abs(x) for x in v]


def length(v):
    return root(dot(v, v))


def unit(v):
    return times(1 / length(v), v) if any(v) else [Fraction(0), Fraction(0), Fraction(1)]


def nearest(x, digits, least):
    """Returns the nearest number of so many binary digits, ties to even; least is the exponent of the smallest."""
    if x == 0:
        return Fraction(0)
    size = abs(x)
    exponent = size.numerator.bit_length() - size.denominator.bit_length()
    if size < Fraction(2)**exponent:
        exponent -= 1
    unit_of = Fraction(2)**max(exponent - digits + 1, least)
    return round(x / unit_of) * unit_of  # round() of a fraction rounds ties to even


def short(v):
    """Returns a vector, rounded to 200 digits, so that the digits of products of fractions stay few."""
    return [nearest(x, 200, -1200) for x in v]


def f32(x):
    return nearest(x, 24, -149)


def f64(x):
    return nearest(x, 53, -1074)


LARGEST = Fraction(2)**128 - Fraction(2)**104


def clamped(color):
    return [min(x, LARGEST) for x in color]


def sum32(a, b):
    return [f32(x + y) for x, y in zip(a, b)]


def product32(a, b):
    return [f32(x * y) for x, y in zip(a, b)]


BLACK = [Fraction(0)] * 3


class Root:
    """The number (b + side √D) / A with A > 0, on a part of a surface; slack is how far the library's may be off."""

    def __init__(self, A, b, D=Fraction(0), side=0, part=0):
        self.A, self.b, self.D, self.side, self.part, self.slack = A, b, D, side, part, 0

    def on(self, part):
        """Returns the same root on another part."""
        same = copy(self)
        same.part = part
        return same

    def minus(self, x):
        """Returns the sign of the difference from a fraction."""
        return sign_of(self.b - self.A * x, Fraction(self.side), self.D)

    def order(self, other):
        """Returns the sign of the difference from another root."""
        if not isinstance(other, Root):  # a root of a polynomial of higher degree
            return -other.order(self)
        p = self.b / self.A - other.b / other.A
        q, r = self.D / self.A**2, other.D / other.A**2
        left, right = sign_of(p, Fraction(self.side), q), sign(other.side) * sign(r)
        if left != right or left == 0:
            return sign(left - right)
        return left * sign_of(p * p + self.side**2 * q - other.side**2 * r, 2 * p * self.side, q)

    def about(self):
        return (self.b + self.side * root(self.D)) / self.A


def sign_of(x, y, q):
    """Returns the sign of x + y √q for q >= 0."""
    a, b = sign(x), sign(y) * sign(q)
    if a * b >= 0:
        return a or b
    return a * sign(x * x - y * y * q)


def linear(height, slope, part=0):
    """Returns the roots of slope · t = height."""
    return [Root(abs(slope), height * sign(slope), part=part)] if slope else []


def quadratic(A, b, c, leaves):
    """Returns the roots of A t² − 2 b t + c = 0; without 0 if the line leaves the surface, where c is 0."""
    if A < 0:
        A, b, c = -A, -b, -c
    if leaves:
        return linear(2 * b, A)
    if A == 0:
        return linear(c, 2 * b)
    D = b * b - A * c
    return [] if D < 0 else [Root(A, b, D, -1), Root(A, b, D, 1)]
