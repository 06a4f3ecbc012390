"""The naive stages: each step is rounded, and the file holds exactly what comes out."""
from fractions import Fraction

from .exact import add, BLACK, dot, f32, length, minus, product32, root, sum32, times, unit
from .functions import PI
from .light import times_float
from .values import shown, U, Unreadable, Wrong


def dot32(a, b):
    x, y, z = product32(a, b)
    return f32(f32(x + y) + z)


def minus32(a, b):
    return [f32(x - y) for x, y in zip(a, b)]


def naive_t(sphere, origin, direction):
    """Returns the smaller of b ± √(b² − c) that is greater than 0; None if there is none."""
    l, radius = minus32(sphere["center"].vector(), origin), sphere["radius"].number()
    b = dot32(direction, l)
    D = f32(f32(b * b) - f32(dot32(l, l) - f32(radius**2)))
    if D <= 0:
        return None
    of_D = f32(root(D))
    return next((t for t in (f32(b - of_D), f32(b + of_D)) if t > 0), None)


def check_naive_ray(step, name, spheres, origin, direction):
    """Checks a ray and where it hits each sphere; returns these t."""
    step["type"].must_be(name)
    step["origin"].must_equal(origin)
    step["direction"].must_equal(direction)
    all_t = [naive_t(sphere, origin, direction) for sphere in spheres]
    if len(step["t"]) != len(all_t):
        raise Unreadable(step["t"].at("must have a number for each sphere"))
    for value, t in zip(step["t"], all_t):
        if t is None:
            value.must_be("infinity")
        elif value.number() != t:
            value.refuse(value.number(), t)
    return all_t


def check_naive_hit(step, spheres, origin, direction):
    """Checks a ray and its closest hit; returns point, normal and color of the hit, or None."""
    all_t = check_naive_ray(step, "ray", spheres, origin, direction)
    hits = [(t, i) for i, t in enumerate(all_t) if t is not None]
    if not hits:
        return None
    t, taken = min(hits)
    sphere = spheres[taken]
    point = sum32(origin, times_float(t, direction))
    normal = [f32(x / sphere["radius"].number()) for x in minus32(point, sphere["center"].vector())]
    normal = normal if dot32(normal, direction) <= 0 else times(-1, normal)
    for key, right in (("point", point), ("normal", normal), ("color", sphere["color"].vector())):
        step[key].must_equal(right)
    return point, normal, sphere["color"].vector()


def check_naive(sample, integrator):
    """Checks the steps of the stages 08_naive and 09_naive, and the radiance that they lead to."""
    scene, steps = sample["steps"][0], list(sample["steps"])[1:]
    offset, spheres = scene["offset"].number(), list(scene["parts"])
    origin, direction = ([f32(x) for x in sample[key].vector()] for key in ("origin", "direction"))
    taken = 0

    def next_step():
        nonlocal taken
        if taken == len(steps):
            raise Wrong(sample["steps"].at("ends before the last ray"))
        taken += 1
        return steps[taken - 1]

    if integrator == "naive transparency":
        light = [Fraction(1)] * 3
        for _ in range(10):
            hit = check_naive_hit(next_step(), spheres, origin, direction)
            if not hit:
                break
            point, normal, color = hit
            light, origin = product32(light, color), minus32(point, times_float(offset, normal))
    else:
        light = BLACK
        hit = check_naive_hit(next_step(), spheres, origin, direction)
        if hit:
            point, normal, color = hit
            to_light = minus32([f32(x) for x in scene["position"].vector()], point)
            distance = f32(root(dot32(to_light, to_light)))
            cosine = f32(dot32(normal, to_light) / distance)
            if cosine > 0:
                step, end = next_step(), f32(distance - offset)
                step["end"].must_be_near(end, 0)
                all_t = check_naive_ray(step, "shadow ray", spheres, sum32(point, times_float(offset, normal)),
                                        [f32(x / distance) for x in to_light])
                if not any(t is not None and t < end for t in all_t):
                    share = f32(f32(f32(1 / (4 * f32(PI))) * cosine) / f32(distance**2))
                    light = times_float(share, product32(color, scene["power"].vector()))
    if taken != len(steps):
        raise Wrong(sample["steps"].at(f"has {len(steps)} rays, and must have {taken}"))
    sample["radiance"].must_equal(light)


def check_naive_march(sample, integrator):
    """Checks the marches of the stages 30 to 32 through spheres: each value of the field, and each t by the one before;
    and whether the last is a hit."""
    scene, steps = sample["steps"][0], list(sample["steps"])[1:]
    spheres = [(one["center"].vector(), one["radius"].number()) for one in scene["parts"]]
    origin, direction, epsilon = sample["origin"].vector(), sample["direction"].vector(), scene["epsilon"].number()
    is_fixed, relaxation = integrator == "fixed step", Fraction(8, 5) if integrator.startswith("enhanced") else 1
    t, before, width, is_hit = epsilon if is_fixed else Fraction(0), Fraction(0), Fraction(0), False
    for step in steps:
        if is_hit:
            raise Wrong(step.at("follows the hit"))
        step["t"].must_be_near(t, 8 * U * abs(t))
        t = step["t"].number()
        point = add(origin, times(t, direction))
        # The sums of distance and radius are rounded.
        free = min(length(minus(point, center)) - radius for center, radius in spheres)
        largest = max(map(abs, [*point, *(x for center, radius in spheres for x in (*center, radius))]))
        step["field"].must_be_near(free, 32 * U * largest)
        free = step["field"].number()
        if is_fixed:
            is_hit, t = free <= 0, t + epsilon
            continue
        if relaxation > 1 and before + abs(free) < width:
            t, width, relaxation = t + before - width, before, 1
            continue
        is_hit, before, width = free < epsilon, free, relaxation * free
        t += width
    if not is_hit and t < 50 and len(steps) < (100000 if is_fixed else 512):
        raise Wrong(sample["steps"].at(f"ends at t = {shown(t)}, before the hit"))
    scene["hits"].must_be(int(is_hit))
    check_light_of_march(sample, scene, spheres, steps[-1]["t"].number() if is_hit else None)


def check_light_of_march(sample, scene, spheres, t):
    """Checks the light of a matte sphere at the point that a march of the stages 30 to 32 ends at; t is None for black.
    The normal follows from differences of the field over the width 2h, whose values are rounded."""
    if t is None:
        return sample["radiance"].must_equal(BLACK)
    point = add(sample["origin"].vector(), times(t, sample["direction"].vector()))
    h = Fraction(1e-4)
    distances = lambda p: [length(minus(p, center)) - radius for center, radius in spheres]
    aside = lambda axis, step: [x + step * int(i == axis) for i, x in enumerate(point)]
    gradient = [min(distances(aside(i, h))) - min(distances(aside(i, -h))) for i in range(3)]
    normal = unit(gradient)
    largest = max(map(abs, [*point, *(x for center, radius in spheres for x in (*center, radius))]))
    error = 128 * U * largest / length(gradient)
    if dot(normal, sample["direction"].vector()) > 0:
        normal = times(-1, normal)
    own = distances(point)
    color = scene["parts"][min(range(len(spheres)), key=lambda i: own[i])]["color"].vector()
    to_light = minus(scene["position"].vector(), point)
    distance = length(to_light)
    cosine, falloff = max(dot(normal, to_light) / distance, Fraction(0)), 1 / (4 * PI * distance**2)
    # The float of the factor is rounded, and so are its products with the power and the color.
    for value, share, flux in zip(sample["radiance"], color, scene["power"].vector()):
        right = cosine * falloff * share * flux
        value.must_be_near(right, right / 2**22 + error * falloff * share * flux)
