"""Spheres and quadrics, and the departures of the rays that leave surfaces."""
import math
from fractions import Fraction
from itertools import permutations

from .exact import BLACK, add, cross, dot, length, minus, quadratic, root, sizes, times, unit
from .values import TINY, U, Wrong

TYPES = {}


def surface_type(name):
    """Returns a decorator of a class that stands for the surfaces with a type in the file."""
    def register(its_class):
        TYPES[name] = its_class
        return its_class

    return register


def surface_of(facts):
    name = facts["type"].word()
    if name not in TYPES:
        raise Wrong(facts["type"].at(f"is {name!r}, and must be one of {', '.join(TYPES)}"))
    return TYPES[name](facts)


class Departure:
    """The geometry that a ray leaves: a sphere, a plane, or a part of one object alone."""

    def __init__(self, kind, geometry=None, owner=None, part=0):
        self.kind, self.geometry, self.owner, self.part = kind, geometry, owner, part

    def is_plane(self, normal, distance):
        """Tests whether this is the plane normal · x = distance, in any multiple."""
        if self.kind != "plane":
            return False
        a, b = self.geometry + [], normal + [distance]
        return all(a[i] * b[k] == a[k] * b[i] for i in range(4) for k in range(i))


def same_plane_through(point, normal):
    return normal + [dot(normal, point)]


class Line:
    """The points origin + t · direction, and the departure of the ray along it."""

    def __init__(self, origin, direction, left=None):
        self.origin, self.direction, self.left = origin, direction, left

    def reversed(self):
        return Line(self.origin, times(-1, self.direction), self.left)


@surface_type("sphere")
class Sphere:
    def __init__(self, facts):
        self.center, self.radius = facts["center"].vector(), facts["radius"].number()

    def departure(self, part):
        return Departure("sphere", [*self.center, abs(self.radius)], self)

    def equation(self, line):
        l, d = minus(self.center, line.origin), line.direction
        return dot(d, d), dot(d, l), dot(l, l) - self.radius**2

    def equation_sizes(self, line):
        l, d = add(sizes(self.center), sizes(line.origin)), sizes(line.direction)
        return dot(d, d), dot(d, l), dot(l, l) + self.radius**2

    def roots(self, line):
        left = line.left and line.left.kind == "sphere" and line.left.geometry == self.departure(0).geometry
        return quadratic(*self.equation(line), left)

    def ends_inside(self, line):
        return False

    def normal(self, point, part):
        return times(1 / self.radius, minus(point, self.center))

    def normal_error(self, point, part):
        return 8 * U * (1 + max(add(sizes(point), sizes(self.center))) / abs(self.radius))

    def direction(self, point, moved):
        """Returns the direction whose longitude and latitude are u and v, and its error for a point that is moved."""
        error = self.normal_error(point, 0) + 2 * moved / abs(self.radius)
        return unit(minus(point, self.center)), error

    def uv(self, point, part):
        return direction_uv(self.direction(point, 0)[0])

    def uv_errors(self, point, part, moved):
        return direction_uv_errors(*self.direction(point, moved))

    def tangents(self, point, part, moved):
        direction, error = self.direction(point, moved)
        return direction_tangents(direction), 8 * error / flat_length(direction)


@surface_type("quadric")
class Quadric:
    def __init__(self, facts):
        self.squares, self.products = facts["squares"].vector(), facts["products"].vector()
        self.linear, self.constant = facts["linear"].vector(), facts["constant"].number()

    def departure(self, part):
        return Departure("object", None, self)

    @staticmethod
    def apply(squares, products, v):
        """Returns M v for the symmetric matrix M; products holds M_yz, M_zx and M_xy."""
        a, b, c = products
        return add([s * x for s, x in zip(squares, v)],
                   [c * v[1] + b * v[2], c * v[0] + a * v[2], b * v[0] + a * v[1]])

    def equation(self, line):
        o, d = line.origin, line.direction
        g = add(self.apply(self.squares, self.products, o), self.linear)
        return (dot(d, self.apply(self.squares, self.products, d)), -dot(d, g),
                dot(o, g) + dot(self.linear, o) + self.constant)

    def equation_sizes(self, line):
        o, d, squares, products = (sizes(x) for x in (line.origin, line.direction, self.squares, self.products))
        g = add(self.apply(squares, products, o), sizes(self.linear))
        return (dot(d, self.apply(squares, products, d)), dot(d, g),
                dot(o, g) + dot(sizes(self.linear), o) + abs(self.constant))

    def is_left(self, line):
        return bool(line.left) and line.left.owner is self

    def roots(self, line):
        return quadratic(*self.equation(line), self.is_left(line))

    def ends_inside(self, line):
        A, b, c = self.equation(line)
        return A < 0 if A else b > 0 if b else c < 0 and not self.is_left(line)

    def determinant(self):
        """Returns the determinant of the symmetric 4x4 matrix, and the sum of its terms without their signs."""
        (a, b, c), (d, e, f) = self.squares, self.products
        rows = [[a, f, e], [f, b, d], [e, d, c]]
        rows = [row + [x] for row, x in zip(rows, self.linear)] + [[*self.linear, self.constant]]
        det = size = Fraction(0)
        for order in permutations(range(4)):
            term = Fraction(1)
            for row, column in zip(rows, order):
                term *= row[column]
            odd = sum(order[i] > order[j] for i in range(4) for j in range(i, 4)) % 2
            det, size = det + (-term if odd else term), size + abs(term)
        return det, size

    def normal(self, point, part):
        return unit(self.gradient(point))

    def gradient(self, point):
        return add(self.apply(self.squares, self.products, point), self.linear)

    def normal_error(self, point, part):
        terms = add(self.apply(sizes(self.squares), sizes(self.products), sizes(point)), sizes(self.linear))
        return 16 * U * (1 + sum(terms) / (length(self.gradient(point)) or 1))

    def direction(self, point, moved):
        terms = sum(sizes(self.squares)) + 2 * sum(sizes(self.products))
        error = self.normal_error(point, 0) + 4 * terms * moved / (length(self.gradient(point)) or 1)
        return self.normal(point, 0), error

    def uv(self, point, part):
        return direction_uv(self.normal(point, part))

    def uv_errors(self, point, part, moved):
        return direction_uv_errors(*self.direction(point, moved))

    def tangents(self, point, part, moved):
        """Returns directions in which the normal turns to the east alone, and down alone; any if rounding makes the
        quadric a cone or a cylinder, where the normal turns in one way only."""
        normal, error = self.direction(point, moved)
        det, size = self.determinant()
        if abs(det) <= 64 * U * size:
            return [BLACK, BLACK], Fraction(1)
        east, down = direction_tangents(normal)
        turned = lambda v: self.apply(self.squares, self.products, v)
        terms = sum(sizes(self.squares)) + 2 * sum(sizes(self.products))
        # How far the normal turns along one of these ways, and against the other, is the curvature, whose sign is that
        # of -det at all points.
        curvature = -1 if det > 0 else 1
        found = [times(curvature, cross(normal, turned(down))), times(-curvature, cross(normal, turned(east)))]
        least = min(Fraction(1), *(length(along) / (terms or 1) for along in found))
        return found, 64 * error / (least or TINY)


def direction_uv(d):
    """Returns the longitude and the latitude of a unit direction, by the C library's arc functions, which are good to
    2^-50."""
    return [Fraction(0.5 + math.atan2(float(d[0]), float(d[2])) / (2 * math.pi)),
            Fraction(math.acos(max(-1.0, min(1.0, float(d[1])))) / math.pi)]


def flat_length(d):
    """Returns the distance of a unit direction from the y axis."""
    return root(d[0]**2 + d[2]**2) or TINY


def direction_uv_errors(d, error):
    """Returns the errors of direction_uv for a direction that has one: at the poles, the longitude is any, and the
    latitude has half the digits."""
    of_angle = Fraction(1, 2**40) + 2 * error / flat_length(d)
    return [min(of_angle, Fraction(1)), min(of_angle, root(error) + Fraction(1, 2**24))]


def direction_tangents(d):
    """Returns the directions in which a direction moves to the east and down."""
    around = [d[2], Fraction(0), -d[0]]
    return [around, cross(around, d)]


@surface_type("surface")
class Other:
    """A surface of a type that the library does not know; what is said of it is taken from the file."""

    is_given = True

    def __init__(self, facts):
        pass

    def departure(self, part):
        return Departure("object", None, self, part)


def is_given(surface):
    """Returns true for a surface whose crossings are taken from the file."""
    inner = getattr(surface, "leaves", None) or ([surface.inner] if hasattr(surface, "inner") else [])
    return getattr(surface, "is_given", False) or any(map(is_given, inner))
