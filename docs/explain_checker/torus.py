"""Tori, whose crossings with a line are roots of a quartic polynomial: Sturm's theorem counts them in any interval."""
import math
from copy import copy
from fractions import Fraction

from .exact import add, cross, dot, length, minus, sign, sizes, times, unit
from .flat_surfaces import plane_tangents
from .surfaces import Departure, surface_type
from .values import TINY, U, Wrong


def value_at(polynomial, x):
    """Returns the value of a polynomial, whose coefficients begin with the constant."""
    value = 0
    for coefficient in reversed(polynomial):
        value = value * x + coefficient
    return value


def shortened(polynomial):
    """Returns a positive multiple of a polynomial, with whole coefficients, of which the last is not 0."""
    while polynomial and polynomial[-1] == 0:
        polynomial = polynomial[:-1]
    common = math.lcm(*(Fraction(x).denominator for x in polynomial))
    whole = [int(x * common) for x in polynomial]
    factor = math.gcd(*whole) or 1
    return [x // factor for x in whole]


def divided(a, b):
    """Returns the quotient and the remainder of two polynomials."""
    a, quotient = list(map(Fraction, a)), [Fraction(0)] * max(len(a) - len(b) + 1, 0)
    for k in reversed(range(len(quotient))):
        quotient[k] = a[k + len(b) - 1] / b[-1]
        for i, x in enumerate(b):
            a[k + i] -= quotient[k] * x
    return quotient, a[:len(b) - 1]


def sturm_chain(polynomial):
    """Returns Sturm's chain, which ends with the common divisor of the polynomial and its derivative."""
    chain = [polynomial, shortened([k * x for k, x in enumerate(polynomial)][1:])]
    while chain[-1]:
        chain.append(shortened([-x for x in divided(chain[-2], chain[-1])[1]]))
    return chain[:-1]


class PolynomialRoot:
    """The only root of a polynomial without multiple roots in an interval, without its lower end."""

    def __init__(self, chain, low, high):
        self.chain, self.low, self.high, self.part, self.slack = chain, low, high, 0, 0

    def on(self, part):
        same = copy(self)
        same.part = part
        return same

    def minus(self, x):
        """Returns the sign of the difference from a fraction."""
        if x <= self.low:
            return 1
        if x < self.high:
            if not roots_between(self.chain, self.low, x):
                self.low = x
                return 1
            self.high = x
        return 0 if x == self.high and value_at(self.chain[0], x) == 0 else -1

    def halve(self):
        """Halves the interval; returns false if it is so narrow that two roots in it count as equal."""
        self.minus((self.low + self.high) / 2)
        return self.high - self.low > max(abs(self.low), abs(self.high), TINY) / 2**300

    def order(self, other):
        """Returns the sign of the difference from another root."""
        while True:
            if isinstance(other, PolynomialRoot):
                if self.high <= other.low:
                    return -1
                if other.high <= self.low:
                    return 1
                other.halve()
            else:
                if other.minus(self.high) > 0:
                    return -1
                if other.minus(self.low) <= 0:
                    return 1
            if not self.halve():
                return 0

    def about(self):
        while self.high - self.low > max(abs(self.low), abs(self.high)) / 2**200:
            if not self.halve():
                break  # at 0, of which no interval is a small share
        return (self.low + self.high) / 2


def roots_between(chain, low, high):
    """Returns how many roots a polynomial has in (low, high], by the changes of sign in its chain."""
    def changes(x):
        signs = [s for s in (sign(value_at(p, x)) for p in chain) if s]
        return sum(a != b for a, b in zip(signs, signs[1:]))

    return changes(low) - changes(high)


def roots_of(polynomial):
    """Returns all roots of a polynomial, from the smallest; a double one twice."""
    polynomial = shortened(polynomial)
    if len(polynomial) < 2:
        return []
    chain = sturm_chain(polynomial)
    if len(chain[-1]) > 1:  # the roots of the common divisor are multiple
        own = roots_of(divided(polynomial, chain[-1])[0]) + roots_of(chain[-1])
        return sorted(own, key=lambda x: x.about())
    # All roots lie within 1 + the largest ratio of a coefficient to the last (Cauchy).
    bound = Fraction(2)**(max(abs(x) for x in polynomial) // abs(polynomial[-1]) + 1).bit_length()
    found, intervals = [], [(-bound, bound)]
    while intervals:
        low, high = intervals.pop()
        count = roots_between(chain, low, high)
        if count == 1:
            found.append(PolynomialRoot(chain, low, high))
        elif count:
            middle = (low + high) / 2
            intervals += [(middle, high), (low, middle)]
    return found


@surface_type("torus")
class Torus:
    def __init__(self, facts):
        self.center, self.axis = facts["center"].vector(), facts["axis"].vector()
        self.radius, self.tube = facts["radius"].number(), facts["tube"].number()
        if not any(self.axis):
            raise Wrong(facts["axis"].at("must not be 0"))

    def departure(self, part):
        return Departure("object", None, self, part)

    def polynomial(self, line):
        """Returns N (p·p + R² − r²)² − 4R² (N p·p − (p·a)²) for the points p = o + t d of a line, seen from the
        center, and N = a·a: the square of the distance from the axis is p·p − (p·a)²/N."""
        o, d, a = minus(line.origin, self.center), line.direction, self.axis
        N, k = dot(a, a), self.radius**2 - self.tube**2
        square = [dot(o, o), 2 * dot(o, d), dot(d, d)]  # p·p
        along = [dot(o, a), dot(d, a)]  # p·a
        product = lambda p, q: [sum(p[i] * q[n - i] for i in range(len(p)) if 0 <= n - i < len(q))
                                for n in range(len(p) + len(q) - 1)]
        first = product([square[0] + k, *square[1:]], [square[0] + k, *square[1:]])
        of_along = product(along, along)
        second = [N * x - y for x, y in zip(square, of_along)] + [0, 0]
        return [N * x - 4 * self.radius**2 * y for x, y in zip(first, second)]

    def roots(self, line):
        """Returns all crossings; without that at 0 if the line leaves the torus, whose constant then is 0."""
        leaves = bool(line.left) and line.left.owner is self
        o, d = minus(line.origin, self.center), line.direction
        if not leaves and dot(o, o) * dot(d, d) - dot(o, d)**2 > (self.radius + self.tube)**2 * dot(d, d):
            return []
        return roots_of(self.polynomial(line)[1 if leaves else 0:])

    def ends_inside(self, line):
        return False

    def section(self, point):
        """Returns the unit axis, the unit vector away from it, and the way there and up from the middle of the tube."""
        axis, p = unit(self.axis), minus(point, self.center)
        up = dot(p, axis)
        across = minus(p, times(up, axis))
        return axis, unit(across), length(across) - self.radius, up

    def normal(self, point, part):
        axis, outward, away, up = self.section(point)
        return unit(add(times(away, outward), times(up, axis)))

    def size(self, point):
        return max(add(sizes(point), sizes(self.center))) + 2 * self.radius

    def normal_error(self, point, part):
        # A point has an error of U of its size. Over the tube, it turns the normal; over the distance from the axis,
        # the direction away from the axis.
        _, _, away, _ = self.section(point)
        size = self.size(point)
        return 32 * U * (1 + size / self.tube + size / ((away + self.radius) or TINY))

    def uv(self, point, part):
        axis, outward, away, up = self.section(point)
        e1, e2 = plane_tangents(axis)
        turns = lambda y, x: Fraction(math.atan2(float(y), float(x)) / (2 * math.pi))
        return [Fraction(1, 2) + turns(dot(e2, outward), dot(e1, outward)), Fraction(1, 2) - turns(up, away)]

    def uv_errors(self, point, part, moved):
        error = self.normal_error(point, part) + 2 * moved / self.tube
        return [Fraction(1, 2**40) + 2 * error] * 2

    def tangents(self, point, part, moved):
        axis, outward, _, _ = self.section(point)
        around = cross(axis, outward)
        return [around, cross(around, self.normal(point, part))], 8 * self.uv_errors(point, part, moved)[0]
