"""Meshes: all triangles are in the file, and a tree of boxes tells which of them a line may cross."""
from collections import Counter
from fractions import Fraction

from .flat_surfaces import Triangle
from .surfaces import Departure, Line, surface_type
from .values import U, Wrong


class Boxes:
    """A tree of boxes around triangles, in floats. A line is tested with boxes that are larger by 2^-40 of the
    coordinates, which is more than all roundings of the test: those that it misses hold no triangle that it crosses."""

    def __init__(self, boxes, indices):
        self.low = [min(boxes[i][0][k] for i in indices) for k in range(3)]
        self.high = [max(boxes[i][1][k] for i in indices) for k in range(3)]
        self.children, self.indices = [], indices
        if len(indices) > 4:
            axis = max(range(3), key=lambda k: self.high[k] - self.low[k])
            order = sorted(indices, key=lambda i: boxes[i][0][axis] + boxes[i][1][axis])
            self.children = [Boxes(boxes, half) for half in (order[:len(order) // 2], order[len(order) // 2:])]

    def near(self, origin, direction):
        """Returns the indices of all triangles whose leaf the line may cross."""
        begin, end = float("-inf"), float("inf")
        for o, d, a, b in zip(origin, direction, self.low, self.high):
            margin = (abs(o) + abs(a) + abs(b)) * 2.0**-40
            a, b = a - margin - o, b + margin - o
            if abs(d) < 2.0**-200:
                if not a <= 0 <= b:
                    return []
                continue
            a, b = (a / d, b / d) if d > 0 else (b / d, a / d)
            begin, end = max(begin, a), min(end, b)
        if begin > end:
            return []
        if not self.children:
            return self.indices
        return [i for child in self.children for i in child.near(origin, direction)]


@surface_type("mesh")
class Mesh:
    def __init__(self, facts):
        self.facts, self.triangles = facts, {}
        self.vertices = self.of_vertices("vertices", 3)
        self.normals, self.uvs = self.of_vertices("normals", 3), self.of_vertices("uvs", 2)
        count = facts["triangles"].whole()
        corners = [x.index(len(self.vertices)) for x in facts["corners"]]
        if not 0 < count == len(corners) / 3:
            raise Wrong(facts["corners"].at(f"has {len(corners)} indices, and must have 3 for each triangle"))
        self.corners = [corners[3 * i:3 * i + 3] for i in range(count)]
        boxes = []
        for of_one in self.corners:
            axes = list(zip(*(map(float, self.vertices[i]) for i in of_one)))
            boxes.append(([min(x) for x in axes], [max(x) for x in axes]))
        self.boxes = Boxes(boxes, list(range(count)))

    def of_vertices(self, name, size):
        """Returns what the file holds for each vertex; None for what the mesh does not have."""
        if name not in self.facts:
            return None
        numbers = self.facts[name].numbers()
        found = [numbers[i:i + size] for i in range(0, len(numbers), size)]
        if len(numbers) % size or (name != "vertices" and len(found) != len(self.vertices)):
            raise Wrong(self.facts[name].at(f"must have {size} numbers for each vertex"))
        return found

    def is_closed(self):
        """Returns true if each edge occurs as often in one direction as in the other."""
        edges = Counter()
        for of_one in self.corners:
            places = [tuple(self.vertices[i]) for i in of_one]
            for a, b in zip(places, places[1:] + places[:1]):
                edges[min(a, b), max(a, b)] += (a < b) - (b < a)
        return not any(edges.values())

    def triangle(self, part):
        if not 0 <= part < len(self.corners):
            raise Wrong(self.facts.at(f"has no triangle {part}"))
        if part not in self.triangles:
            of = lambda values: values and [values[i] for i in self.corners[part]]
            self.triangles[part] = Triangle.of(of(self.vertices), of(self.normals), of(self.uvs))
        return self.triangles[part]

    def check_primitive(self, primitive, part):
        """Checks a triangle that a hit tells, with what its corners have."""
        triangle = self.triangle(part)
        for name, of_corners in (("", triangle.corners), ("normal_", triangle.normals), ("uv_", triangle.uvs)):
            for corner, right in zip("abc", of_corners or ()):
                primitive[name + corner].must_equal(right)

    def departure(self, part):
        return Departure("plane", self.triangle(part).departure(0).geometry, self, part)

    def roots(self, line):
        """Returns the crossings with all triangles. A line that leaves this mesh starts inside the triangle that it
        leaves, at the point next to the origin, which is rounded: its t may differ by as much as that point is off."""
        left = line.left.part if line.left and line.left.owner is self else None
        exact = line if left is None else Line(inner_point(self.triangle(left), line.origin), line.direction, line.left)
        found = []
        for i in self.boxes.near(list(map(float, line.origin)), list(map(float, line.direction))):
            if i == left:
                continue
            triangle = self.triangle(i)
            for crossing in triangle.roots(exact):
                if left is not None:
                    slope = triangle.equation(exact)[1]
                    crossing.slack = 16 * U * triangle.equation_sizes(line)[0] / abs(slope)
                found.append(crossing.on(i))
        found.sort(key=lambda crossing: (crossing.b / crossing.A, crossing.part))
        return found

    def ends_inside(self, line):
        return False

    def normal(self, point, part):
        return self.triangle(part).normal(point, 0)

    def normal_error(self, point, part):
        return self.triangle(part).normal_error(point, 0)

    def uv(self, point, part):
        return self.triangle(part).uv(point, 0)

    def uv_errors(self, point, part, moved):
        return self.triangle(part).uv_errors(point, 0, moved)

    def tangents(self, point, part, moved):
        return self.triangle(part).tangents(point, 0, moved)


def inner_point(triangle, near):
    """Returns a point inside a triangle that is next to a rounded point of it."""
    a, b = triangle.coordinates(near)
    shares = [max(x, Fraction(1, 2**60)) for x in (1 - a - b, a, b)]
    return [sum(share * corner[k] for share, corner in zip(shares, triangle.corners)) / sum(shares) for k in range(3)]
