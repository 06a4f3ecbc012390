"""Lights of any size: their solid angles, and the directions that numbers between 0 and 1 draw to them.

The formulas are those of the papers, in some 140 digits of 2. They cancel for small lights, which takes a few of these
digits; the library's formulas, in double, do not cancel.
"""
from bisect import bisect_right
from fractions import Fraction

from .exact import add, cross, dot, length, minus, root, short, times, unit
from .flat_surfaces import Disk, Parallelogram, Triangle
from .functions import arc_tangent, PI, sine_and_cosine
from .mesh import Mesh
from .solids import Moving
from .surfaces import Sphere
from .values import U, Wrong
from .warps import disk_point, Frame

# A direction of the library is off by less than 40 U, where the light's borders are not nearer than 2^-45 of its
# corners; the numbers that draw it have relative errors of a few U of their own.
ERROR = Fraction(1, 2**43)


class Shares:
    """Shares of a whole, by which one of several things is chosen with a number between 0 and 1."""

    def __init__(self, shares):
        self.ends = [Fraction(0)]
        for share in shares:
            self.ends.append(self.ends[-1] + share)
        self.whole = self.ends[-1]

    def probability(self, i):
        return (self.ends[i + 1] - self.ends[i]) / self.whole

    def choose(self, u):
        """Returns the index, its probability, the place in its share, and how close the choice was, in shares."""
        place = u * self.whole
        i = min(bisect_right(self.ends, place), len(self.ends) - 1) - 1
        begin, end = self.ends[i:i + 2]
        return i, (end - begin) / self.whole, (place - begin) / (end - begin), \
            min(place - begin if begin else self.whole, end - place if end < self.whole else self.whole) / self.whole


class SphereView:
    """The directions from a point to a sphere: a cap around its center, or all of them from inside."""

    def __init__(self, point, sphere):
        to = minus(sphere.center, point)
        square, radius2 = dot(to, to), sphere.radius**2
        axis = short(unit(to))
        self.frame, self.is_outside = Frame(axis), square >= radius2
        if self.is_outside:
            self.height = radius2 / square / (1 + root((square - radius2) / square))  # 1 − cos σ
        self.solid_angle = 2 * PI * self.height if self.is_outside else 4 * PI
        # Near (0, 0, −1) the frame turns by as much as the axis, off by a few U, turns around z.
        self.error = ERROR + (16 * U / (length(axis[:2]) + Fraction(1, 2**450)) if axis[2] < 0 else 0)

    def direction(self, u, v):
        if not self.is_outside:
            sine, cosine = sine_and_cosine(2 * PI * v)
            r = 2 * root(u * (1 - u))
            return self.frame.of([r * cosine, r * sine, 1 - 2 * u])
        x, y = disk_point(u, v)
        height = (x * x + y * y) * self.height
        wide = root(self.height * (2 - height))
        return self.frame.of([wide * x, wide * y, 1 - height])


def angle_between(n, m):
    """Returns the angle between two vectors."""
    return arc_tangent(*short([length(cross(n, m)), dot(n, m)]))


class RectangleView:
    """The directions from a point to a rectangle (Ureña, Fajardo and King 2013). The axes are turned so that the point
    is below it, and the larger part of it on the positive side of both."""

    def __init__(self, point, corner, u, v):
        self.x, self.y, to = short(unit(u)), short(unit(v)), minus(corner, point)
        self.z = short(unit(cross(u, v)))
        if dot(to, self.z) < 0:
            self.z = times(-1, self.z)
        self.h = dot(to, self.z)
        self.ends = []
        for name, size in (("x", length(u)), ("y", length(v))):
            axis = getattr(self, name)
            low = dot(to, axis)
            high = low + size
            if -low > high:
                setattr(self, name, times(-1, axis))
                low, high = -high, -low
            self.ends.append((low, high))
        (x0, x1), (y0, y1) = self.ends
        self.solid_angle, self.error = Fraction(0), ERROR
        if not self.h:
            return
        h = self.h
        corners = [[x0, y0, -h], [x1, y0, -h], [x1, y1, -h], [x0, y1, -h]]  # as the paper looks at it
        normals = [short(unit(cross(a, b))) for a, b in zip(corners, corners[1:] + corners[:1])]
        g = [PI - angle_between(a, b) for a, b in zip(normals, normals[1:] + normals[:1])]  # angles of the polygon
        self.b0, self.b1 = normals[0][2], normals[2][2]
        self.k, self.solid_angle = short([2 * PI - g[2] - g[3], g[0] + g[1] + g[2] + g[3] - 2 * PI])
        # A direction on a narrow rectangle is a difference of two that are nearly the same.
        self.error += 64 * U * (1 + h / (x1 - x0))

    def direction(self, u, v):
        (x0, x1), (y0, y1), h = *self.ends, self.h
        sine, cosine = short(sine_and_cosine(u * self.solid_angle + self.k))
        f = (cosine * self.b0 - self.b1) / sine
        square = f * f + self.b0**2
        x, = short([min(max((1 if f > 0 else -1) * h / root(square - 1), x0), x1)])
        d2 = x * x + h * h
        low, high = (y / root(d2 + y * y) for y in (y0, y1))
        w, = short([low + v * (high - low)])
        y = min(max(root(d2) * w / root(1 - w * w), y0), y1)
        return unit(add(add(times(x, self.x), times(y, self.y)), times(h, self.z)))


class TriangleView:
    """The directions from a point to a triangle (Arvo 1995). The corner that opposes the shortest side is the one from
    which the area is cut."""

    def __init__(self, point, corners):
        units = [short(unit(minus(corner, point))) for corner in corners]
        b = max(range(3), key=lambda i: dot(units[(i + 1) % 3], units[(i + 2) % 3]))
        self.b, self.a, self.c = units[b], units[(b + 1) % 3], units[(b + 2) % 3]
        a, b, c = self.a, self.b, self.c
        volume = abs(dot(a, cross(b, c)))
        self.solid_angle = 2 * arc_tangent(volume, 1 + dot(a, b) + dot(b, c) + dot(c, a))
        self.beta = angle_between(cross(b, a), cross(b, c))
        self.solid_angle, self.beta = short([self.solid_angle, self.beta])
        # Near its plane and the lines of its edges, digits are lost.
        self.error = ERROR + 64 * U / (volume + Fraction(1, 2**450))

    def direction(self, u, v):
        sine, cosine = short(sine_and_cosine(u * self.solid_angle - self.beta))
        sine_b, cosine_b = short(sine_and_cosine(self.beta))
        p, q = cosine - cosine_b, sine + sine_b * dot(self.a, self.b)
        z = ((q * cosine - p * sine) * cosine_b - q) / ((q * sine + p * cosine) * sine_b)
        z = min(max(z, Fraction(-1)), Fraction(1))
        z, = short([z])
        end = short(add(times(z, self.b), times(root(1 - z * z), self.across(self.c, self.b))))
        z = 1 - v * (1 - dot(end, self.a))
        return add(times(z, self.a), times(root(1 - z * z), self.across(end, self.a)))

    @staticmethod
    def across(x, axis):
        return short(unit(minus(x, times(dot(x, axis), axis))))


class TwoTriangles:
    """A parallelogram that is no rectangle."""

    def __init__(self, point, corner, u, v):
        p, q = add(corner, u), add(corner, v)
        self.parts = [TriangleView(point, [corner, p, q]), TriangleView(point, [add(p, v), q, p])]
        self.solid_angle = sum(part.solid_angle for part in self.parts)
        self.error = sum(part.error for part in self.parts)

    def direction(self, u, v):
        i, _, rest, _ = Shares([part.solid_angle for part in self.parts]).choose(u)
        return self.parts[i].direction(rest, v)


class AreaLight:
    """A surface that is a light of any size."""

    def __init__(self, light, surfaces):
        self.index = light["surface"].index(len(surfaces))
        self.surface, self.emission, self.light = surfaces[self.index], light["emission"].vector(), light
        if isinstance(self.surface, Mesh):
            self.triangles = [self.surface.triangle(i).corners for i in range(len(self.surface.corners))]
            areas = [length(cross(minus(b, a), minus(c, a))) for a, b, c in self.triangles]
            self.by_area, area = Shares(areas), sum(areas) / (8 if self.surface.is_closed() else 4)
        elif isinstance(self.surface, Sphere):
            area = PI * self.surface.radius**2
        elif isinstance(self.surface, Parallelogram):
            area = length(cross(self.surface.u, self.surface.v)) / 2
        elif isinstance(self.surface, Triangle):
            area = length(cross(self.surface.u, self.surface.v)) / 4
        elif isinstance(self.surface, Disk):
            area = PI / 2 * self.surface.radius**2
        elif isinstance(self.surface, Moving):
            raise NoDirections("directions to an area light that moves")
        else:
            raise Wrong(light["surface"].at("must name a surface to which directions can be drawn"))
        self.power = area * sum(self.emission)

    def view(self, point, part):
        """Returns the view of the light, or of one triangle of a mesh."""
        surface = self.surface
        if isinstance(surface, Sphere):
            return SphereView(point, surface)
        if isinstance(surface, Parallelogram):
            u, v = surface.u, surface.v
            is_rectangle = abs(dot(u, v)) <= length(u) * length(v) / 2**50
            return (RectangleView if is_rectangle else TwoTriangles)(point, surface.point, u, v)
        if isinstance(surface, Triangle):
            return TriangleView(point, [surface.point, add(surface.point, surface.u), add(surface.point, surface.v)])
        if isinstance(surface, Mesh):
            return TriangleView(point, self.triangles[part])
        raise NoDirections("directions to disks that are lights, and their solid angles")

    def draw(self, point, u, v):
        """Returns the view to which two numbers draw a direction, the numbers there, the probability of a triangle, and
        its index."""
        if not isinstance(self.surface, Mesh):
            return self.view(point, 0), u, v, 1, 0
        i, probability, rest, doubt = self.by_area.choose(u)
        if doubt < Fraction(1, 2**40):
            raise NoDirections("directions to meshes, where chance decides by the last digits")
        return self.view(point, i), rest, v, probability, i

    def density(self, point, part):
        """Returns the density with which directions from a point to a part of the light are drawn."""
        of_part = self.by_area.probability(part) if isinstance(self.surface, Mesh) else 1
        angle = self.view(point, part).solid_angle
        return of_part / angle if angle else None


class NoDirections(Exception):
    """Nothing is known here about the directions to a light; says which."""


class AreaLights:
    """The lights of any size, in the order of the file."""

    def __init__(self, lights, surfaces):
        self.lights = [AreaLight(light, surfaces) for light in lights]
        self.by_power = Shares([light.power for light in self.lights])
        self.by_surface = {light.index: i for i, light in enumerate(self.lights)}

    def check_emission(self, emission, surface, index):
        """Checks the emission at a hit on a surface: that of the light, or none on a surface that could be one."""
        if index in self.by_surface:
            emission.must_equal(self.lights[self.by_surface[index]].emission)
        elif any(emission.vector()) and isinstance(surface, (Sphere, Parallelogram, Triangle, Disk, Mesh)):
            raise Wrong(emission.at("is that of a surface which is not among the area lights"))

    def drawn(self, point, index, part):
        """Returns the density of the direction from a point to a hit, and the probability of its light."""
        if index not in self.by_surface:
            return 0, 0
        i = self.by_surface[index]
        return self.lights[i].density(point, part), self.by_power.probability(i)
