"""Maps from pairs of numbers between 0 and 1 to points of a disk and to directions."""
from fractions import Fraction

from .exact import add, dot, root, times
from .functions import PI, sine_and_cosine


def disk_point(u, v):
    """Returns the point of the unit disk to which the concentric map takes (u, v) (Shirley and Chiu 1997)."""
    a, b = 2 * u - 1, 2 * v - 1
    if a == b == 0:
        return [Fraction(0), Fraction(0)]
    if abs(a) > abs(b):
        size, angle = a, PI / 4 * (b / a)
    else:
        size, angle = b, PI / 2 - PI / 4 * (a / b)
    sine, cosine = sine_and_cosine(angle)
    return [size * cosine, size * sine]


class Frame:
    """Three axes, of which z is a unit vector n: the z axis of space, turned to n by the shortest way."""

    def __init__(self, n):
        square = n[0]**2 + n[1]**2
        if n[2] < 0 and square < Fraction(1, 2**900):
            self.x, self.y = [Fraction(1), Fraction(0), Fraction(0)], [Fraction(0), Fraction(-1), Fraction(0)]
        else:
            k = (1 - n[2]) / square if n[2] < 0 else 1 / (1 + n[2])
            self.x = [1 - n[0]**2 * k, -n[0] * n[1] * k, -n[0]]
            self.y = [-n[0] * n[1] * k, 1 - n[1]**2 * k, -n[1]]
        self.z = n

    def of(self, local):
        return add(add(times(local[0], self.x), times(local[1], self.y)), times(local[2], self.z))

    def local(self, direction):
        return [dot(direction, axis) for axis in (self.x, self.y, self.z)]


def cosine_direction(normal, u, v):
    """Returns the direction of the hemisphere around a normal that is above a point of the unit disk (Malley)."""
    x, y = disk_point(u, v)
    return Frame(normal).of([x, y, root(1 - x * x - y * y)])
