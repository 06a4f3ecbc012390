"""Functions of numbers to more than 2^-100 of 1."""
import math
from decimal import Decimal, localcontext
from fractions import Fraction

from .exact import root

PI = Fraction("3.14159265358979323846264338327950288419716939937510582")
DIGITS = 45  # of decimals, that is 149 binary digits


def decimal(x):
    return Decimal(x.numerator) / Decimal(x.denominator)


def power(x, exponent):
    """Returns x^exponent for x up to 1 and a little; 0 if x is not positive."""
    if x <= 0:
        return Fraction(0)
    with localcontext() as context:
        context.prec = 60
        logarithm = decimal(min(x, Fraction(1))).ln() * decimal(exponent)
        return Fraction(logarithm.exp()) if logarithm > -2000 else Fraction(0)


def exponential(x):
    """Returns e^x."""
    with localcontext() as context:
        context.prec = DIGITS
        return Fraction(decimal(x).exp())


def sine_and_cosine(x):
    """Returns sine and cosine of an angle in radians, by the series of e^(ix/2^k), squared k times."""
    with localcontext() as context:
        context.prec = DIGITS + 10
        halvings = max(0, int(abs(x)).bit_length() + 8)
        angle = decimal(Fraction(x)) / 2**halvings
        # Sine and 1 − cosine of the small angle: fewer than 12 terms of each series count.
        square, term, sine, versine = angle * angle, angle, Decimal(0), Decimal(0)
        for k in range(1, 25, 2):
            sine += term
            term = term * angle / (k + 1)
            versine += term
            term = -term * angle / (k + 2)
        for _ in range(halvings):
            sine, versine = 2 * sine * (1 - versine), 2 * versine * (2 - versine)
        return Fraction(sine), 1 - Fraction(versine)


def arc_tangent(y, x):
    """Returns the angle of the point (x, y) in radians, from −π to π, by Newton's method from the C library's
    number on."""
    angle = Fraction(math.atan2(float(y), float(x)))
    if x == 0 and y == 0:
        return angle
    size = root(Fraction(x * x + y * y))
    for _ in range(2):  # each doubles the digits
        sine, cosine = sine_and_cosine(angle)
        angle += (y * cosine - x * sine) / size
    return angle
