"""Glossy lobes, and what a hit reflects of the light from a direction.

Directions are drawn in fractions. Densities and light are numbers of double: a relative error of a lobe is given, which
covers the roundings here and those of the library, and is far above both.
"""
import math
from fractions import Fraction

from .exact import add, dot, f32, length, minus, root, short, times, unit
from .functions import PI, power, sine_and_cosine
from .light import shading_normal
from .values import U, Wrong
from .warps import disk_point, Frame

CLOSE = 2.0**-36  # angles below may have either sign: far above the error of a drawn direction


def floats(v):
    return [float(x) for x in v]


def dot_of(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


class Ggx:
    """Microfacets of Trowbridge and Reitz, that see each other by Smith's function, correlated by height (Heitz 2014),
    and reflect by Schlick's approximation. Visible normals are drawn (Dupuy and Benyoub 2023)."""

    def __init__(self, material):
        self.color = material["glossy"].vector()
        roughness = material["roughness"].number()
        if not 0 <= roughness <= 1:
            raise Wrong(material["roughness"].at("must be from 0 to 1"))
        self.width = max(roughness * roughness, Fraction(1, 2**20))
        self.alpha = float(self.width)
        self.error = 2.0**-44 / self.alpha  # a tilt by a few U changes the lobe by as many parts of its width

    def reflectance(self, cosine):
        rest = min(max(1 - cosine, 0), 1)
        return [c + (1 - c) * rest**5 for c in floats(self.color)]

    def length(self, d):
        return math.sqrt(d[2]**2 + self.alpha**2 * (d[0]**2 + d[1]**2))

    def distribution(self, n):
        if n[2] <= 0:
            return 0.0
        k = self.alpha**2 * n[2]**2 + n[0]**2 + n[1]**2
        return self.alpha**2 / (math.pi * k * k)

    def halfway(self, view, light):
        return floats(unit([Fraction(a) + Fraction(b) for a, b in zip(view, light)]))

    def reflection(self, view, light):
        """Returns the light reflected per radiance and solid angle: F D G/(4 cos θ_view)."""
        if view[2] < 0 or light[2] <= 0:
            return [0.0] * 3
        h = self.halfway(view, light)
        both = self.length(view) + view[2] / light[2] * self.length(light)
        factor = self.distribution(h) / (2 * both)
        return [factor * f for f in self.reflectance(min(dot_of(view, h), 1))]

    def density(self, view, light):
        h = self.halfway(view, light)
        return self.distribution(h) / (2 * (view[2] + self.length(view)))

    def sample(self, view, u, v):
        """Returns a direction, its error, its density and its weight."""
        stretched = unit([self.width * view[0], self.width * view[1], view[2]])
        below = v * (1 + stretched[2])
        r, (sine, cosine) = root(below * (2 - below)), sine_and_cosine(2 * PI * u)
        h = add([r * cosine, r * sine, 1 - below], stretched)
        n = short(unit([self.width * h[0], self.width * h[1], h[2]]))
        light = short(unit(minus(times(2 * dot(view, n), n), view)))  # a normal may be longer than 1 by some hundred U
        view, n, to_light = floats(view), floats(n), floats(light)
        density = self.distribution(n) / (2 * (view[2] + self.length(view)))
        weight = [0.0] * 3
        if light[2] > 0:
            both = self.length(view) + view[2] / to_light[2] * self.length(to_light)
            weight = [(view[2] + self.length(view)) / both * f for f in self.reflectance(dot_of(view, n))]
        # The height in the cap is a difference of numbers up to 2, off by U, and (1 − v)(1 + z). The viewer's height is
        # off by a few U, and the stretch turns what is at its angle by up to 1/z and 1/α as much, and back by `turn`.
        turn = self.width * dot(h, h) / (h[2]**2 + self.width**2 * (h[0]**2 + h[1]**2))
        steep = 1 / max(Fraction(view[2]), self.width)
        return light, 64 * U * (1 + 1 / (1 - v)) + 16 * U * turn * (1 + steep) / length(h), density, weight


class Phong:
    """Phong's lobe, of a share of light that does not depend on the exponent (Lafortune and Willems 1994)."""

    def __init__(self, material):
        self.color, self.exponent = material["glossy"].vector(), material["shininess"].number()
        self.error = 2.0**-44 * (1 + float(self.exponent))

    def reflectance(self, cosine):
        return floats(self.color)

    def density(self, view, light):
        cosine = dot([-view[0], -view[1], view[2]], light)
        if cosine <= 0:
            return 0.0
        return float((self.exponent + 1) / (2 * PI) * power(Fraction(cosine), self.exponent))

    def gain(self, light):
        return float(light[2] * (self.exponent + 2) / (self.exponent + 1))

    def reflection(self, view, light):
        if light[2] <= 0:
            return [0.0] * 3
        return [c * self.gain(light) * self.density(view, light) for c in floats(self.color)]

    def sample(self, view, u, v):
        x, y = disk_point(u, v)
        square = x * x + y * y
        z = power(1 - square, 1 / (self.exponent + 1))
        wide, size = root((1 - z) * (1 + z)), root(square)
        local = [wide * x / size, wide * y / size, z] if size else [Fraction(0), Fraction(0), Fraction(1)]
        axis = [-view[0], -view[1], view[2]]
        light = short(Frame(axis).of(local))
        density = float((self.exponent + 1) / (2 * PI) * power(z, self.exponent))
        weight = [c * self.gain(light) for c in floats(self.color)] if light[2] > 0 else [0.0] * 3
        error = 16 * U / (root(axis[0]**2 + axis[1]**2) + Fraction(1, 2**450)) if axis[2] < 0 else 0
        return light, 256 * U + error, density, weight


class GlossyAt:
    """A glossy lobe around the shading normal of a hit, or around the surface's own where that faces away."""

    def __init__(self, material, d, own, normal):
        if "blur" not in material:
            raise Wrong(material["glossy"].at("must be black, or the file tells what blurs it"))
        blur = material["blur"].word()
        if blur not in ("ggx", "phong"):
            raise Wrong(material["blur"].at("must be ggx or phong"))
        self.lobe = (Ggx if blur == "ggx" else Phong)(material)
        self.own, self.error = own, self.lobe.error
        self.frame = Frame(normal if dot(normal, d) <= 0 else own)
        self.view = short(self.frame.local(times(-1, d)))
        self.view[2] = max(self.view[2], Fraction(0))
        self.share = max(float(f32(Fraction(x))) for x in self.lobe.reflectance(float(self.view[2])))

    def reflection(self, direction):
        light = floats(self.frame.local(direction))
        if dot(self.own, direction) <= 0:
            return [0.0] * 3
        return self.lobe.reflection(floats(self.view), light)

    def is_grazing(self, direction):
        """Tests whether a direction that is nearly this one may lead into the surface."""
        return min(dot(self.own, direction), dot(self.frame.z, direction)) <= CLOSE

    def density(self, direction):
        return self.lobe.density(floats(self.view), floats(self.frame.local(direction)))

    def sample(self, u, v):
        local, error, density, weight = self.lobe.sample(self.view, u, v)
        direction = short(self.frame.of(local))
        return direction, error, density, weight if dot(self.own, direction) > 0 else [0.0] * 3


def heuristic(own, other):
    """Returns the weight of a direction drawn with the density own, and with other in another way; None is ∞."""
    if own is None or (other is not None and other <= 0):
        return 1.0
    if other is None or own <= 0:
        return 0.0
    return 1 / (1 + (other / own)**2)


class Reflector:
    """What a hit reflects of light from a direction."""

    def __init__(self, ray, hit, line):
        self.ray, self.hit, self.material = ray, hit, hit["material"]
        self.d, self.own, self.normal = unit(line.direction), hit["facing_normal"].vector(), shading_normal(hit)
        self.color, self.is_mapped = hit["color"].vector(), "normal_map" in hit
        self.is_matte, self.glossy, self.glossy_probability = any(self.color), None, 1.0
        if any(self.material["glossy"].vector()):
            self.glossy = GlossyAt(self.material, self.d, self.own, self.normal)
        self.error = self.glossy.error if self.glossy else 2.0**-44

    def reflects(self):
        return self.is_matte or self.glossy is not None

    def height(self, direction):
        if not self.is_matte or (self.is_mapped and dot(self.own, direction) <= 0):
            return 0.0
        return float(dot(self.normal, direction))

    def is_skipped(self, direction):
        """Tests whether no ray may be traced in a direction, since no light from there counts."""
        if self.is_matte and self.height(direction) > CLOSE and \
                not (self.is_mapped and dot(self.own, direction) <= CLOSE):
            return False
        return self.glossy is None or self.glossy.is_grazing(direction) or \
            max(self.glossy.reflection(direction)) < 2.0**-140

    def light_along(self, direction, density, weight, light):
        """Returns the light by the matte and the glossy way, of light from a direction that was drawn with a density."""
        matte = weight * max(self.height(direction), 0.0) / (math.pi * density)
        glossy = [0.0] * 3
        if self.glossy:
            own = density / weight
            part = heuristic(own, self.glossy_probability * self.glossy.density(direction)) / own
            glossy = [x * part * y for x, y in zip(self.glossy.reflection(direction), light)]
        return [matte * x for x in light], glossy
