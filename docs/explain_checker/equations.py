"""Checks the numbers of equations."""
from fractions import Fraction

from .exact import add, cross, dot, length, minus, sizes
from .flat_surfaces import Box, Disk, Planar, WithEdges
from .solids import Csg, Instance, Moving
from .surfaces import Line, Quadric, Sphere
from .values import U, Wrong


def check_equation(found, surface, line, is_inside):
    """Checks the numbers of a surface's equation, against the exact ones: within 32 U of the sizes of their terms.
    The line inside of an instance is rounded itself: by 2^-40 of the sizes, for maps that enlarge by up to 2^8."""
    unit_of = Fraction(1, 2**40) if is_inside else 32 * U
    if isinstance(surface, Instance):
        found["type"].must_be("instance")
        inside = surface.line_inside(line)
        return check_equation(found["parts"][0], surface.inner, Line(inside.origin, inside.direction), True)
    if isinstance(surface, Moving):
        found["type"].must_be("moving")
        return check_equation(found["parts"][0], surface.inner, surface.line_inside(line), is_inside)
    if isinstance(surface, Csg):
        found["type"].must_be("csg")
        if len(found["parts"]) != len(surface.leaves):
            raise Wrong(found["parts"].at("must have all solids"))
        for part, leaf in zip(found["parts"], surface.leaves):
            check_equation(part, leaf, line, is_inside)
        return
    if isinstance(surface, Box):
        found["type"].must_be("slabs")
        o = line.origin
        for name, end in zip(("to_min", "to_max"), surface.ends):
            found[name].must_be_near_vector(minus(end, o), [unit_of * (abs(x) + abs(y) + int(is_inside))
                                                            for x, y in zip(end, o)])
        found["slope"].must_be_near_vector(line.direction, unit_of * max(sizes(line.direction)))
        return
    if isinstance(surface, (Sphere, Quadric)):
        found["type"].must_be("quadratic")
        (A, b, c), (As, bs, cs) = surface.equation(line), surface.equation_sizes(line)
        turn = -1 if A < 0 else 1
        found["A"].must_be_near(turn * A, unit_of * As)
        found["b"].must_be_near(turn * b, unit_of * bs)
        found["c"].must_be_near(turn * c, unit_of * cs)
        found["D"].must_be_near(b * b - A * c, 2 * unit_of * (bs * bs + As * cs))
        # The bound on the error of D must hold, and may not be large.
        if found["error_of_D"].data != "infinity":
            error = found["error_of_D"].number()
            if abs(found["D"].number() - (b * b - A * c)) > error:
                found["error_of_D"].refuse(error, abs(found["D"].number() - (b * b - A * c)))
            if not is_inside:
                bound = size_of_error(surface, line) / 2**48
                found["error_of_D"].must_be_near(bound, bound / 2**40 + Fraction(1, 2**899))
        return
    if isinstance(surface, Planar):
        found["type"].must_be("linear")
        height, slope = surface.equation(line)
        heights, slopes = surface.equation_sizes(line)
        found["height"].must_be_near(height, unit_of * heights)
        found["slope"].must_be_near(slope, unit_of * slopes)
        w = minus(surface.point, line.origin)
        w_sizes, d_sizes = add(sizes(surface.point), sizes(line.origin)), sizes(line.direction)
        terms = sum(w_sizes) * sum(d_sizes)
        if isinstance(surface, WithEdges):
            m = cross(w, line.direction)
            found["along_u"].must_be_near(dot(surface.v, m), unit_of * sum(sizes(surface.v)) * terms)
            found["along_v"].must_be_near(-dot(surface.u, m), unit_of * sum(sizes(surface.u)) * terms)
        if isinstance(surface, Disk):
            away = length(cross(surface.n, cross(line.direction, w)))
            found["from_center"].must_be_near(away, unit_of * sum(surface.n_sizes) * terms)
            found["reach"].must_be_near(surface.radius * abs(slope), surface.radius * unit_of * slopes)


def size_of_error(surface, line):
    """Returns the size of the terms of D in the bound of its error: A w for a sphere, b̂² + Â ĉ for a quadric."""
    if isinstance(surface, Sphere):
        l, d = minus(surface.center, line.origin), line.direction
        return dot(d, d) * (dot(l, l) + surface.radius**2)
    A, b, c = surface.equation_sizes(line)
    return b * b + A * c
