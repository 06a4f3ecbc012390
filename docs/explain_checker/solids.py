"""Instances and solids made of solids."""
from fractions import Fraction

from .exact import add, cross, dot, f64, minus, root, sizes, times, unit
from .surfaces import Departure, Line, surface_of, surface_type
from .values import U, Wrong


@surface_type("moving")
class Moving:
    """A surface on its way along a straight line, at the time of the rays of a sample: they are moved to where it was
    made, by one rounding of the way and one of the origin."""

    def __init__(self, facts):
        self.velocity, self.during = facts["velocity"].vector(), facts["during"].vector(2)
        self.inner = surface_of(facts["parts"][0])
        self.move_to(Fraction(0))

    def move_to(self, time):
        opens, closes = self.during
        self.way = [f64(min(max(time, opens), closes) * v) for v in self.velocity]

    def at_rest(self, point):
        return [f64(x - w) for x, w in zip(point, self.way)]

    def departure(self, part):
        return Departure("object", None, self, part)

    def line_inside(self, line):
        left = self.inner.departure(line.left.part) if line.left and line.left.owner is self else None
        return Line(self.at_rest(line.origin), line.direction, left)

    def roots(self, line):
        return self.inner.roots(self.line_inside(line))

    def ends_inside(self, line):
        return self.inner.ends_inside(self.line_inside(line))

    def normal(self, point, part):
        return self.inner.normal(self.at_rest(point), part)

    def normal_error(self, point, part):
        return self.inner.normal_error(self.at_rest(point), part)

    def uv(self, point, part):
        return self.inner.uv(self.at_rest(point), part)

    def uv_errors(self, point, part, moved):
        return self.inner.uv_errors(self.at_rest(point), part, moved)

    def tangents(self, point, part, moved):
        return self.inner.tangents(self.at_rest(point), part, moved)


@surface_type("instance")
class Instance:
    """The image of a surface under an affine map."""

    def __init__(self, facts):
        self.columns = [facts[name].vector() for name in "xyz"]
        self.translation = facts["translation"].vector()
        x, y, z = self.columns
        determinant = dot(x, cross(y, z))
        if determinant == 0:
            raise Wrong(facts.at("is a map without an inverse"))
        self.rows = [times(1 / determinant, v) for v in (cross(y, z), cross(z, x), cross(x, y))]
        self.inner = surface_of(facts["parts"][0])

    def vector_inside(self, v):
        return [dot(row, v) for row in self.rows]

    def point_inside(self, p):
        return self.vector_inside(minus(p, self.translation))

    def departure(self, part):
        own = self.inner.departure(part)
        image = Departure("object", None, self, part)
        if own.kind == "plane":
            normal = [sum(own.geometry[i] * self.rows[i][k] for i in range(3)) for k in range(3)]
            image = Departure("plane", normal + [own.geometry[3] + dot(normal, self.translation)], self, part)
        return image

    def line_inside(self, line):
        left = line.left
        if left:
            if left.owner is self:
                left = self.inner.departure(left.part)
            elif left.kind == "plane":
                n = left.geometry[:3]
                left = Departure("plane", [dot(n, column) for column in self.columns] +
                                 [left.geometry[3] - dot(n, self.translation)])
            else:
                left = None
        return Line(self.point_inside(line.origin), self.vector_inside(line.direction), left)

    def roots(self, line):
        return self.inner.roots(self.line_inside(line))

    def ends_inside(self, line):
        return self.inner.ends_inside(self.line_inside(line))

    def normal(self, point, part):
        inside = self.inner.normal(self.point_inside(point), part)
        return unit([sum(inside[i] * self.rows[i][k] for i in range(3)) for k in range(3)])

    def normal_error(self, point, part):
        # Each entry of the inverse has an error of U, the point inside one of 8 U of its terms; the largest factor
        # by which the map of normals enlarges an error is at most |rows| |columns|.
        inner = self.inner.normal_error(self.point_inside(point), part)
        return self.factor() * (32 * U + 2 * inner * (1 + self.size_inside(point)))

    def factor(self):
        return root(sum(dot(r, r) for r in self.rows)) * root(sum(dot(c, c) for c in self.columns))

    def size_inside(self, point):
        """Returns the size of the terms of the point inside."""
        away = add(sizes(point), sizes(self.translation))
        return max(dot(sizes(row), away) for row in self.rows)

    def uv(self, point, part):
        return self.inner.uv(self.point_inside(point), part)

    def moved_inside(self, point, moved):
        """Returns how far the point inside is off, for a point that is off by so much."""
        return 32 * U * self.size_inside(point) + moved * root(sum(dot(r, r) for r in self.rows))

    def uv_errors(self, point, part, moved):
        return self.inner.uv_errors(self.point_inside(point), part, self.moved_inside(point, moved))

    def tangents(self, point, part, moved):
        own, error = self.inner.tangents(self.point_inside(point), part, self.moved_inside(point, moved))
        images = [[sum(v[i] * self.columns[i][k] for i in range(3)) for k in range(3)] for v in own]
        return images, self.factor() * (32 * U + 2 * error)


@surface_type("csg")
class Csg:
    """A solid made of solids."""

    def __init__(self, facts):
        self.leaves = [surface_of(part) for part in facts["parts"]]
        self.parent, self.weight, self.least, self.node, self.first = (
            [x.whole() for x in facts[name]] for name in ("parent", "weight", "least", "node", "first_part"))
        self.facts = facts
        if not (len(self.parent) == len(self.weight) == len(self.least) and
                len(self.node) == len(self.first) == len(self.leaves) and
                all(0 <= n < len(self.parent) for n in self.node) and
                all(p == -1 if i + 1 == len(self.parent) else i < p < len(self.parent)
                    for i, p in enumerate(self.parent))):
            raise Wrong(facts.at("is no tree of operations"))

    def leaf_of(self, part):
        return max(i for i in range(len(self.leaves)) if i == 0 or self.first[i] <= part)

    def departure(self, part):
        i = self.leaf_of(part)
        return self.leaves[i].departure(part - self.first[i])

    def is_inside(self, insides):
        sums = [0] * len(self.parent)
        at = [False] * len(self.parent)
        for i, node in enumerate(self.node):
            at[node] = insides[i]
        for i in range(len(self.parent)):  # operands come before their operation
            if i not in self.node:
                at[i] = sums[i] >= self.least[i]
            if self.parent[i] >= 0 and at[i]:
                sums[self.parent[i]] += self.weight[i]
        return at[-1]

    def roots(self, line):
        """Returns the crossings at which the inside of the whole changes. All at one t are taken together."""
        hits, begun, departed = [], [], []
        for i, leaf in enumerate(self.leaves):
            found = leaf.roots(line)
            hits += [(crossing, i) for crossing in found]
            begins, ends = leaf.ends_inside(line.reversed()), leaf.ends_inside(line)
            begun.append(begins)
            # Each crossing toggles the inside; one that is missing was at t = 0, where the ray departs.
            departed.append(len(found) % 2 != int(begins != ends))
        insides, before, roots = begun, True, []
        groups = []
        for hit in hits:  # sorted by insertion, as roots are compared exactly
            at = 0
            while at < len(groups) and groups[at][0][0].order(hit[0]) < 0:
                at += 1
            if at < len(groups) and groups[at][0][0].order(hit[0]) == 0:
                groups[at].append(hit)
            else:
                groups.insert(at, [hit])
        for group in groups:
            at_0 = group[0][0].minus(0)
            starts = before and at_0 >= 0
            if starts:
                insides = [x != y for x, y in zip(insides, departed)]
                before = False
            was, turning = self.is_inside(insides), None
            for i in sorted({i for _, i in group}):
                of_leaf = [crossing for crossing, k in group if k == i]
                if len(of_leaf) % 2:
                    now = self.is_inside(insides)
                    insides = [x != (k == i) for k, x in enumerate(insides)]
                    if self.is_inside(insides) != now:
                        turning = of_leaf[0].on(of_leaf[0].part + self.first[i])
            if self.is_inside(insides) != was and not (starts and at_0 == 0 and any(departed)):
                roots.append(turning)
        return roots

    def ends_inside(self, line):
        return self.is_inside([leaf.ends_inside(line) for leaf in self.leaves])

    def is_taken_away(self, i):
        node, odd = self.node[i], False
        while node >= 0:
            odd, node = odd != (self.weight[node] < 0), self.parent[node]
        return odd

    def normal(self, point, part):
        i = self.leaf_of(part)
        normal = self.leaves[i].normal(point, part - self.first[i])
        return times(-1, normal) if self.is_taken_away(i) else normal

    def normal_error(self, point, part):
        i = self.leaf_of(part)
        return self.leaves[i].normal_error(point, part - self.first[i])

    def uv(self, point, part):
        i = self.leaf_of(part)
        return self.leaves[i].uv(point, part - self.first[i])

    def uv_errors(self, point, part, moved):
        i = self.leaf_of(part)
        return self.leaves[i].uv_errors(point, part - self.first[i], moved)

    def tangents(self, point, part, moved):
        i = self.leaf_of(part)
        return self.leaves[i].tangents(point, part - self.first[i], moved)
