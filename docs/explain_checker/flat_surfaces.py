"""Surfaces in planes, and boxes."""
from fractions import Fraction

from .exact import add, cross, dot, length, linear, minus, Root, sign, sizes, times, unit
from .surfaces import Departure, same_plane_through, surface_type
from .values import TINY, U


class Planar:
    """A plane, or a surface in one, given by a point, a normal and a test of its inside."""

    def departure(self, part):
        return Departure("plane", same_plane_through(self.point, self.n), self)

    def equation(self, line):
        return dot(self.n, minus(self.point, line.origin)), dot(self.n, line.direction)

    def equation_sizes(self, line):
        w = add(sizes(self.point), sizes(line.origin))
        return dot(self.n_sizes, w), dot(self.n_sizes, sizes(line.direction))

    def roots(self, line):
        if line.left and line.left.is_plane(self.n, dot(self.n, self.point)):
            return []
        height, slope = self.equation(line)
        return linear(height, slope) if slope and self.is_crossed(line, height / slope) else []

    def ends_inside(self, line):
        return False

    def normal(self, point, part):
        return unit(self.n)

    def normal_error(self, point, part):
        return 16 * U * (1 + sum(self.n_sizes) / length(self.n))

    def uv_errors(self, point, part, moved):
        right, factor = self.uv(point, part), max(1, self.uv_factor())
        size = 1 + sum(sizes(point)) + max(sizes(right))
        return [(64 * U * size + 4 * moved) * factor] * 2

    def uv_factor(self):
        """Returns by how much u and v may be larger than the points that they are computed from."""
        return 1 + max(sizes(self.point))

    def tangents(self, point, part, moved):
        return plane_tangents(self.normal(point, part)), 4 * self.normal_error(point, part)


def plane_tangents(normal):
    """Returns two directions of the plane with a unit normal: a × n, for the axis a on which the normal is smallest,
    and n × that."""
    size = sizes(normal)
    axis = min(range(3), key=lambda i: size[i])
    first = unit(cross([Fraction(int(i == axis)) for i in range(3)], normal))
    return [first, cross(normal, first)]


def in_plane(normal, p):
    return [dot(v, p) for v in plane_tangents(normal)]


@surface_type("plane")
class Plane(Planar):
    def __init__(self, facts):
        self.n, distance = facts["normal"].vector(), facts["distance"].number()
        self.point = times(distance / dot(self.n, self.n), self.n)
        self.n_sizes, self.distance = sizes(self.n), distance

    def equation_sizes(self, line):
        return (abs(self.distance) + dot(self.n_sizes, sizes(line.origin)),
                dot(self.n_sizes, sizes(line.direction)))

    def is_crossed(self, line, t):
        return True

    def uv(self, point, part):
        return in_plane(self.normal(point, part), point)


@surface_type("disk")
class Disk(Planar):
    def __init__(self, facts):
        self.point, self.n = facts["position"].vector(), facts["normal"].vector()
        self.radius, self.n_sizes = facts["radius"].number(), sizes(self.n)

    def is_crossed(self, line, t):
        w = minus(add(line.origin, times(t, line.direction)), self.point)
        return dot(w, w) <= self.radius**2

    def uv(self, point, part):
        return in_plane(self.normal(point, part), minus(point, self.point))


class WithEdges(Planar):
    """A planar surface with a corner and two edges u and v."""

    def set_edges(self, point, u, v):
        self.point, self.u, self.v, self.n = point, u, v, cross(u, v)
        a, b = sizes(u), sizes(v)
        self.n_sizes = [a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]]

    def coordinates(self, point):
        """Returns a and b of the point a · u + b · v from the corner."""
        w, nn = minus(point, self.point), dot(self.n, self.n)
        return dot(cross(w, self.v), self.n) / nn, dot(cross(self.u, w), self.n) / nn

    def tangents(self, point, part, moved):
        return [self.u, self.v], 8 * U * max(sum(add(sizes(self.point), sizes(edge))) / length(edge)
                                             for edge in (self.u, self.v))


@surface_type("parallelogram")
class Parallelogram(WithEdges):
    def __init__(self, facts):
        self.set_edges(facts["position"].vector(), facts["edge_u"].vector(), facts["edge_v"].vector())

    def is_crossed(self, line, t):
        a, b = self.coordinates(add(line.origin, times(t, line.direction)))
        return 0 <= a <= 1 and 0 <= b <= 1

    def uv(self, point, part):
        a, b = self.coordinates(point)
        return [a * length(self.u), b * length(self.v)]

    def uv_factor(self):
        return length(self.u) * length(self.v) / length(self.n) * (1 + sum(sizes(self.point)))


@surface_type("triangle")
class Triangle(WithEdges):
    def __init__(self, facts):
        self.set_corners([facts[name].vector() for name in "abc"])

    @classmethod
    def of(cls, corners, normals, uvs):
        """Returns a triangle of a mesh, with the normals and texture coordinates of its vertices, or None."""
        triangle = cls.__new__(cls)
        triangle.set_corners(corners, normals, uvs)
        return triangle

    def set_corners(self, corners, normals=None, uvs=None):
        a, b, c = self.corners = corners
        self.set_edges(a, minus(b, a), minus(c, a))
        self.normals, self.uvs = normals, uvs

    @staticmethod
    def side(line, p, q):
        """Returns the side on which a line passes an edge. On the edge it is that of a line whose origin is moved
        by (ε, ε², ε³), with ε > 0 smaller than any number."""
        d = line.direction
        side = sign(dot(d, cross(minus(p, line.origin), minus(q, line.origin))))
        return side or next((sign(x) for x in cross(minus(p, q), d) if x), 0)

    def is_crossed(self, line, t):
        a, b, c = self.corners
        found = {self.side(line, a, b), self.side(line, b, c), self.side(line, c, a)}
        return found in ({1}, {-1})

    def normal(self, point, part):
        if self.normals:
            a, b = self.coordinates(point)
            at = [(1 - a - b) * x + a * y + b * z for x, y, z in zip(*self.normals)]
            if any(at):
                return unit(at)
        return unit(self.n)

    def normal_error(self, point, part):
        # The interpolated point has the digits of the point over the size of the triangle.
        height = length(self.n) / max(length(self.u), length(self.v))
        error = Planar.normal_error(self, point, part)
        return error + (64 * U * (1 + max(sizes(point)) / height) * 4 if self.normals else 0)

    def uv(self, point, part):
        a, b = self.coordinates(point)
        if not self.uvs:
            return [a, b]
        return [(1 - a - b) * x + a * y + b * z for x, y, z in zip(*self.uvs)]

    def uv_factor(self):
        height = length(self.n) / max(length(self.u), length(self.v))
        largest = max(sum(sizes(uv)) for uv in self.uvs) if self.uvs else 1
        return (1 + sum(sizes(self.point))) / height * max(1, largest)

    def tangents(self, point, part, moved):
        edges, error = WithEdges.tangents(self, point, part, moved)
        if not self.uvs:
            return edges, error
        # u and v are linear in the plane. Along x times the first edge and y times the second, u grows by
        # x e[0] + y f[0], and v by x e[1] + y f[1].
        e, f = minus(self.uvs[1], self.uvs[0]), minus(self.uvs[2], self.uvs[0])
        side = sign(e[0] * f[1] - f[0] * e[1])
        along = lambda x, y: add(times(side * x, self.u), times(side * y, self.v))
        found = [along(f[1], -e[1]), along(-f[0], e[0])]
        # Terms may cancel, of sizes up to largest.
        largest = sum(sum(sizes(uv)) for uv in self.uvs) * sum(map(length, edges))
        return found, 8 * (error + U) * (1 + largest / (min(map(length, found)) or TINY))


@surface_type("box")
class Box:
    def __init__(self, facts):
        self.ends = [facts["min"].vector(), facts["max"].vector()]

    def place(self, face):
        return self.ends[face % 2][face // 2]

    def departure(self, part):
        normal = [Fraction(int(i == part // 2)) for i in range(3)]
        return Departure("plane", normal + [self.place(part)], self, part)

    def roots(self, line):
        """Returns the entry and the exit, or the exit alone if the line starts in the box."""
        o, d, left = line.origin, line.direction, line.left
        start, starts_inside = None, False
        if left and left.kind == "plane":
            if left.owner is self:
                start, starts_inside = left.part, True
            else:
                start = next((face for face in range(6) if left.is_plane(self.departure(face).geometry[:3],
                                                                         self.place(face))), None)
        if start is not None and not (self.ends[0][start // 2] < self.ends[1][start // 2] and
                                      d[start // 2] * (-1 if start % 2 else 1) > 0):
            return []
        near = max(minus(self.ends[1], self.ends[0])) / 2**20
        entry = exit = None
        for axis in range(3):
            if d[axis] == 0:
                if not starts_inside and not self.ends[0][axis] <= o[axis] <= self.ends[1][axis]:
                    return []
                continue
            faces = (2 * axis, 2 * axis + 1) if d[axis] > 0 else (2 * axis + 1, 2 * axis)

            def at(face):
                is_start = face == start and (starts_inside or abs(o[axis] - self.place(face)) <= near)
                return Fraction(0) if is_start else (self.place(face) - o[axis]) / d[axis]

            t = at(faces[0])
            if entry is None or t > entry[0] or (t == entry[0] and faces[0] == start):
                entry = t, faces[0]
            t = at(faces[1])
            if exit is None or t < exit[0] or (t == exit[0] and faces[1] == start):
                exit = t, faces[1]
        if exit is None:
            return []
        as_root = lambda crossing: Root(Fraction(1), crossing[0], part=crossing[1])
        if starts_inside:
            return [as_root((max(exit[0], Fraction(1, 2**1074)), exit[1]))]
        if entry[0] > exit[0]:
            return []
        return [as_root(x) for x in (entry, exit) if x[1] != start]

    def ends_inside(self, line):
        return False

    def normal(self, point, part):
        return [Fraction((1 if part % 2 else -1) * int(i == part // 2)) for i in range(3)]

    def normal_error(self, point, part):
        return Fraction(0)

    def uv(self, point, part):
        axis = part // 2
        return [point[i] - self.ends[0][i] for i in ((axis + 1) % 3, (axis + 2) % 3)]

    def uv_errors(self, point, part, moved):
        return [64 * U * (1 + sum(sizes(point)) + max(sizes(self.uv(point, part)))) + moved] * 2

    def tangents(self, point, part, moved):
        return [[Fraction(int(i == (part // 2 + k) % 3)) for i in range(3)] for k in (1, 2)], U
