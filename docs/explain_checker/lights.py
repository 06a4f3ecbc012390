"""Lights at a hit, and the light of the sky."""
import math
from fractions import Fraction

from .exact import add, BLACK, clamped, dot, length, minus, product32, sizes, times, unit
from .functions import PI, power
from .light import BY_CHANCE, dusk, mirror, shading_normal, spot_share
from .values import U, Wrong

KINDS = ("PointLight", "ConstantLight", "DirectionalLight", "SpotLight")


class Lights:
    """Checks of lights."""

    def check_lights(self, ray, hit, line):
        """Checks the lights of a hit; returns those that are not occluded, and the number of shadow rays."""
        rays, lit, shadow_rays = ray["rays"], [], 0
        if len(hit["lights"]) != len(self.file["lights"]):
            raise Wrong(hit["lights"].at("must have all lights of the scene"))
        for light, own in zip(self.file["lights"], hit["lights"]):
            in_front, adds = self.check_light(light, own, hit, line)
            if own["shadow_ray"].is_null():
                if in_front and adds and self.integrator != "diffuse":
                    raise Wrong(own["shadow_ray"].at("must be a ray"))
                if in_front and adds:
                    lit.append(own)
                continue
            if self.integrator == "diffuse" or not in_front:
                raise Wrong(own["shadow_ray"].at("must be null"))
            own["shadow_ray"].must_be(shadow_rays)
            shadow = rays[own["shadow_ray"].index(len(rays))]
            shadow_rays += 1
            shadow["query"].must_be("any")
            shadow["range_end"].must_be("infinity" if "direction" in light else 1)
            self.check_start(shadow, ray, hit)
            shadow["direction"].must_equal(own["towards"].vector())
            if self.check_ray(shadow)[2] is None:
                lit.append(own)
        return lit, shadow_rays

    def check_start(self, ray, before, hit):
        """Checks that a ray leaves a hit."""
        ray["origin"].must_equal(hit["point"].vector())
        ray["leaves"].must_be(before["taken"].whole())
        ray["leaves_part"].must_be(hit["part"].whole())

    def check_light(self, light, own, hit, line):
        """Checks one light; returns whether it is in front of the surface, and whether it adds anything."""
        point, normal = hit["point"].vector(), shading_normal(hit)
        kind, is_far = light["type"].word(), "direction" in light
        if kind not in KINDS or is_far != (kind == "DirectionalLight") or ("axis" in light) != (kind == "SpotLight"):
            raise Wrong(light["type"].at("must be that of a light with these members"))
        place = light["direction" if is_far else "position"].vector()
        own["towards"].must_be_near_vector(place if is_far else minus(place, point),
                                           [U * abs(x) for x in (place if is_far else minus(place, point))])
        l = own["towards"].vector()
        height, distance = dot(normal, l), length(l)
        terms = dot(sizes(normal), sizes(l))
        # A light behind the surface does not shine on it, however a normal map tilts the normal.
        facing = hit["facing_normal"].vector()
        over, lost = dot(facing, l), 4 * U * dot(sizes(facing), sizes(l))
        if "normal_map" in hit and (over < -lost or (over <= lost and own["cosine"].number() <= 0)):
            height = Fraction(0)
        own["cosine"].must_be_near(height / distance, 8 * U * (1 + terms / distance))
        # The factor of the light's color passes fewer than 16 roundings of U, then two of float.
        falloff = 1 / (4 * PI * distance**2) if kind in ("PointLight", "SpotLight") else 1
        share = 1
        if "axis" in light:
            share = spot_share(-dot(l, light["axis"].vector()) / distance, light)
        color = light["color"].vector()
        largest = Fraction(2)**107 / max([*color, Fraction(1, 2**20)])
        in_front = height > 4 * U * terms or (abs(height) <= 4 * U * terms and own["cosine"].number() > 0)
        of_cosine = 8 * U * terms / distance
        for name, cosine, lost in (("facing", 1, 0), ("irradiance", max(height / distance, 0), of_cosine)):
            factor = min(falloff * cosine, largest) * share
            error = Fraction(1, 2**22) * factor + falloff * lost * share + Fraction(1, 2**148)
            own[name].must_be_near_vector([factor * x for x in color], [error * max(x, 1) for x in color])
        adds = self.check_share(own, hit, line, in_front)
        return in_front, adds

    def check_share(self, own, hit, line, in_front):
        """Checks the share of the radiance; returns whether it is more than 0."""
        if own["share"].is_null():
            if self.integrator in BY_CHANCE:  # which add up the light in another place
                return True
            self.given.add("the share of a light by an integrator that is not the library's")
            return True
        color, irradiance = hit["color"].vector(), own["irradiance"].vector()
        diffuse = product32(color, irradiance)
        if self.integrator != "whitted":
            own["share"].must_equal(clamped(diffuse) if in_front else BLACK)
            return True
        material, l = hit["material"], own["towards"].vector()
        specular = material["specular"].vector()
        mirrored = mirror(unit(line.direction), shading_normal(hit))
        lobe = power(dot(mirrored, l) / length(l), material["shininess"].number()) if in_front else 0
        right = [x + s * e * lobe for x, s, e in zip(diffuse, specular, own["facing"].vector())]
        # The cosine of the lobe is off by 16 U, and its power by shininess times that; a few roundings of float.
        error = Fraction(1, 2**21) + 32 * U * material["shininess"].number()
        right = right if in_front else BLACK
        own["share"].must_be_near_vector(right, [error * x + Fraction(1, 2**147) for x in right])
        return any(own["share"].vector())

    def sky(self, record, direction, fallback):
        """Returns the radiance of the sky, which the record must hold."""
        if not len(record["sky"]):
            raise Wrong(record["sky"].at("must hold the sky"))
        return self.sky_value(record["sky"][0], direction, fallback)

    def sky_value(self, sky, direction, fallback):
        if "uv" in sky:
            d = unit(direction)
            # The angles by the C library's arc functions, which are good to 2^-50.
            u = 0.5 + math.atan2(float(d[0]), float(d[2])) / (2 * math.pi)
            v = math.acos(max(-1.0, min(1.0, float(d[1])))) / math.pi
            error = Fraction(1, 2**40)
            if abs(d[1]) < 1 - Fraction(1, 2**20):
                sky["uv"][0].must_be_near(Fraction(u), error)
            sky["uv"][1].must_be_near(Fraction(min(v, 1 - 2**-53)), error if abs(d[1]) < 0.999 else Fraction(1, 2**24))
            self.check_look_up(sky, d)
        elif sky["radiance"].is_null():
            return fallback
        else:
            value = sky["radiance"].vector()
            known = self.__dict__.setdefault("sky_color", value)
            sky["radiance"].must_equal(known)
        return sky["radiance"].vector()

    def check_look_up(self, sky, direction):
        """Checks the radiance of an environment at u and v, or in a direction."""
        way, (u, v) = sky["environment"], sky["uv"].vector(2)
        name = way["type"].word()
        if name == "image":
            # A double next to an edge between two pixels may round to the edge: the place is that of doubles.
            size, image = [x.index(2**31) for x in way["size"]], way["file"]
            place = [float(u - math.floor(u)) * size[0] - 0.5, float(v) * size[1] - 0.5]
            first = [math.floor(x) for x in place]
            (across, down), right, largest = [Fraction(x) - k for x, k in zip(place, first)], BLACK, Fraction(0)
            if len(way["parts"]) != 4:
                raise Wrong(way["parts"].at("must be four pixels"))
            for k, pixel in enumerate(way["parts"]):
                pixel["column"].must_be((first[0] + k % 2) % size[0])
                pixel["row"].must_be(min(max(first[1] + k // 2, 0), size[1] - 1))
                color = pixel["color"].vector()
                known, error, reason = self.images.light_at(image, size, way["size"], pixel["column"].whole(),
                                                            pixel["row"].whole())
                if known:
                    pixel["color"].must_be_near_vector(known, [error * x for x in known])
                else:
                    self.given.add(f"the colors of {reason}, which is the environment")
                share = (across if k % 2 else 1 - across) * (down if k // 2 else 1 - down)
                right, largest = add(right, times(share, color)), max(largest, *sizes(color))
        elif name == "dusk":
            right, largest = dusk(u, v)
        elif name == "weekend":  # of floats: white below, blue above
            blue = (1 + direction[1]) / 2
            sky["radiance"].must_be_near_vector([1 - blue / 2, 1 - Fraction(3, 10) * blue, Fraction(1)], Fraction(1, 2**22))
            return
        else:
            self.given.add("the radiance of an environment that is a function")
            return
        # Rounded once to float, after a few roundings of double.
        sky["radiance"].must_be_near_vector(right, [Fraction(1, 2**24) * abs(x) + largest / 2**40 for x in right])
