"""Light: environments, shares of lights, sums, and the encoding."""
import math
from decimal import localcontext
from fractions import Fraction

from .exact import add, dot, f32, length, minus, root, times, unit
from .functions import decimal
from .solids import Csg, Instance, Moving
from .surfaces import Quadric, Sphere
from .torus import Torus
from .values import shown, U, Wrong


def dusk(u, v):
    """Returns the light of the sky of stage 16 (scenes/dusk.hpp), and the size of its terms."""
    number = lambda x: Fraction(float(x))  # a constant in double
    if v > Fraction(1, 2):
        far = (2 * (1 - v))**2
        return [far * number(x) + number(y) for x, y in ((0.26, 0.14), (0.2, 0.11), (0.09, 0.06))], Fraction(1)
    far = (2 * (u - number(0.625)))**2 + (v - number(0.41))**2
    if far < number(0.0006):
        return [Fraction(60), Fraction(40), Fraction(18)], Fraction(1)
    glow = max(1 - far / number(0.04), Fraction(0))**3 / 2
    low = (2 * v)**2
    sky = [number(x) + low * number(y) + glow * number(z)
           for x, y, z in ((0.1, 0.75, 1), (0.2, 0.3, 0.7), (0.45, -0.15, 0.4))]
    zigzag = lambda x: abs(2 * (x - math.floor(x)) - 1)
    above = v - (number(0.47) + number(0.02) * zigzag(5 * u) - number(0.01) * zigzag(13 * u))
    hill = min(max(above / number(0.003), Fraction(0)), Fraction(1))
    return [(1 - hill) * x + hill * number(y) for x, y in zip(sky, (0.12, 0.12, 0.17))], Fraction(1)


def times_float(k, color):
    return [f32(k * x) for x in color]


def mirror(d, normal):
    return minus(d, times(2 * dot(normal, d), normal))


def refracted(d, normal, ratio):
    """Returns the direction of a refracted ray, the square of the cosine of its angle, below 0 if there is none, and the
    ratio of the indices of refraction."""
    cosine = -dot(normal, d)
    square = 1 - ratio**2 * (1 - cosine**2)
    return add(times(ratio, d), times(ratio * cosine - root(square), normal)), square, ratio


def shading_normal(hit):
    """Returns the normal by which light is reflected, turned to the ray."""
    return (hit["normal_map"]["facing_shading_normal"] if "normal_map" in hit else hit["facing_normal"]).vector()


def mirroring_normal(hit, d):
    """Returns the shading normal, or the surface's own where a normal map would mirror the ray into the surface."""
    own, normal = hit["facing_normal"].vector(), shading_normal(hit)
    return normal if dot(own, mirror(d, normal)) > 0 else own


def passage(hit, d):
    """Returns whether a ray along d passes a hit, its direction behind it, the square of the cosine of its angle there,
    and the ratio of the indices of refraction. With a normal map, light may bend back to the side from which it comes,
    and does not pass then."""
    own, ior = hit["facing_normal"].vector(), hit["material"]["ior"].number()
    enters = hit["normal"].vector() == own
    bent, square, ratio = refracted(d, mirroring_normal(hit, d), 1 / ior if enters else ior)
    return square >= 0 and (dot(own, bent) < 0 or "normal_map" not in hit), bent, square, ratio


def angles_of(surface, part):
    """Returns which of u and v are angles, of which 0 is 1: 0 for u, 1 for v."""
    if isinstance(surface, (Instance, Moving)):
        return angles_of(surface.inner, part)
    if isinstance(surface, Csg):
        i = surface.leaf_of(part)
        return angles_of(surface.leaves[i], part - surface.first[i])
    return (0, 1) if isinstance(surface, Torus) else (0,) if isinstance(surface, (Sphere, Quadric)) else ()


def check_along(value, right, error):
    """Checks that a vector has the direction of another one; its length is any."""
    found = value.vector()
    if not any(found):
        value.refuse(found, right)
    if length(minus(unit(found), unit(right))) > error + 8 * U:
        value.refuse(times(1 / length(found), found), unit(right))


def position_in_pixel(i, count):
    """Returns the i-th of so many samples: column i, and the row of the rank of its digits, read backwards."""
    digits = max(count - 1, 0).bit_length()
    backwards = lambda k: int(bin(k)[2:].zfill(digits)[::-1], 2) if digits else 0
    rank = sum(backwards(k) < backwards(i) for k in range(count))
    return [(i + Fraction(1, 2)) / count, (rank + Fraction(1, 2)) / count]


def mean_of(samples):
    """Returns the light of a single sample of weight 1, otherwise the mean of the weighted lights of the samples: up to 2^47,
    in units of 2^-47, added up exactly, and rounded once."""
    lights = [times_float(f32(sample["weight"].number()), sample["radiance"].vector()) for sample in samples]
    if len(lights) == 1 and samples[0]["weight"].number() == 1:
        return lights[0]
    units = lambda x: round(min(max(x, Fraction(-(2**47))), Fraction(2**47)) * 2**47)
    return [f32(Fraction(sum(units(x) for x in channel), 2**47 * len(lights))) for channel in zip(*lights)]


def spot_share(cosine, light):
    """Returns the share of a spotlight's light in a direction, to 2^-40 by the C library's arc cosine."""
    inside = light["angle"].number() - Fraction(math.degrees(math.acos(max(-1.0, min(1.0, float(cosine))))))
    fade = light["fade"].number()
    if inside < 0:
        return 0
    if inside >= fade:
        return 1
    x = inside / fade
    return x * x * (3 - 2 * x)


def check_code(code, light, f):
    """Checks that light is encoded as a code: max_code times the curve is within ½ of it."""
    k, most = code.whole(), f["max_code"].whole()
    if k > 0 and not exceeds_or_is(light, Fraction(2 * k - 1, 2 * most), f):
        raise Wrong(code.at(f"is {k}, and {shown(light)} gives less"))
    if k < most and exceeds_or_is(light, Fraction(2 * k + 1, 2 * most), f):
        raise Wrong(code.at(f"is {k}, and {shown(light)} gives more"))


def exceeds_or_is(light, value, f):
    """Tests whether light is encoded as this value or more."""
    name = f["transfer"].word()
    if name == "linear":
        return light >= value
    if light <= 0:
        return False
    if name == "srgb":
        if value <= Fraction("12.92") * Fraction("0.0031308"):
            return light * Fraction("12.92") >= value
        return light**5 >= ((value + Fraction("0.055")) / Fraction("1.055"))**12
    if name != "gamma":
        raise Wrong(f["transfer"].at("must be linear, srgb or gamma"))
    with localcontext() as context:
        context.prec = 60
        difference = decimal(light).ln() - decimal(f["exponent"].number()) * decimal(value).ln()
        return difference >= 0  # light and a threshold differ by more than 10^-50, unless they are equal


FORMULAS = ("binary", "color", "depth", "diffuse", "normal", "shadow", "sphere", "transparency", "whitted")
BY_CHANCE = ("ambient-occlusion", "direct", "path")
