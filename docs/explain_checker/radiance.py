"""The light along a ray, by the formulas of the integrators that use no chance."""
from fractions import Fraction

from .exact import BLACK, clamped, f32, f64, product32, root, sum32, unit
from .light import mirror, mirroring_normal, passage, times_float
from .values import U, Wrong


class Radiance:
    """Checks of radiance."""

    def radiance_of(self, ray, sample, rays):
        """Checks a ray and all that follow it; returns its radiance, rounded as float is."""
        line, all_of, taken = self.check_ray(ray)
        name = self.integrator
        if name == "binary":
            return [Fraction(int(taken is not None))] * 3
        if name == "transparency":
            light = self.sky(sample, line.direction, [Fraction(1)] * 3)
            crossings = [(one, i) for one, found in zip(ray["considered"], all_of) for i in range(len(found))]
            if len(ray["hits"]) != len(crossings):
                raise Wrong(ray["hits"].at(f"has {len(ray['hits'])} hits, and there are {len(crossings)} crossings"))
            for hit, (one, i) in zip(ray["hits"], crossings):
                light = product32(light, self.check_hit(hit, line, one, i)["color"].vector())
            return clamped(light)
        if name == "whitted":
            radiance = self.whitted(ray, line, taken, rays)
            ray["radiance"].must_equal(radiance)
            return radiance
        ray["radiance"].must_be(None)
        if taken is None:
            if name in ("depth", "normal", "sphere"):
                return BLACK
            return self.sky(ray, line.direction, BLACK)
        hit = self.check_hit(ray["hit"], line, ray["considered"][taken])
        if name == "sphere":
            return [Fraction(1)] * 3
        if name == "color":
            return hit["color"].vector()
        if name == "depth":
            return clamped([f32(f64(1 / hit["t"].number()))] * 3)
        if name == "normal":
            shading = hit["normal_map"]["shading_normal"] if "normal_map" in hit else hit["normal"]
            return [f32(f64(f64(x / 2) + Fraction(1, 2))) for x in shading.vector()]
        light = self.ambient
        for own in self.check_lights(ray, hit, line)[0]:
            light = sum32(light, own["irradiance"].vector())
        return clamped(product32(hit["color"].vector(), light))

    def whitted(self, ray, line, taken, rays):
        if taken is None:
            return self.sky(ray, line.direction, BLACK)
        hit = self.check_hit(ray["hit"], line, ray["considered"][taken])
        material = hit["material"]
        light = product32(hit["color"].vector(), self.ambient)
        lit, used = self.check_lights(ray, hit, line)
        for own in lit:
            light = sum32(light, own["share"].vector())
        light = sum32(light, material["emission"].vector())
        d, following = unit(line.direction), []
        if material["reflect"].number() > 0:
            following.append(("reflect", mirror(d, mirroring_normal(hit, d)), 0))
        if material["refract"].number() > 0:
            passes, bent, square, ratio = passage(hit, d)
            if passes:
                # Near total reflection the square root magnifies the errors of the square.
                following.append(("refract", bent, 64 * U * (1 + ratio**2) / (root(square) + Fraction(1, 2**26))))
        skies = 0
        for name, direction, error in following:
            if rays < self.depth:
                if used >= len(ray["rays"]):
                    raise Wrong(ray["rays"].at(f"must have a ray for {name}"))
                next_ray = ray["rays"][used]
                used += 1
                next_ray["query"].must_be("closest")
                next_ray["range_end"].must_be("infinity")
                self.check_start(next_ray, ray, hit)
                next_ray["direction"].must_be_near_vector(direction, 32 * U + error)
                seen = self.radiance_of(next_ray, None, rays + 1)
            else:
                if skies >= len(ray["sky"]):
                    raise Wrong(ray["sky"].at("must hold the sky at the end of the path"))
                seen = self.sky_value(ray["sky"][skies], direction, BLACK)
                skies += 1
            light = sum32(light, times_float(f32(material[name].number()), seen))
        if used != len(ray["rays"]):
            raise Wrong(ray["rays"].at(f"has {len(ray['rays'])} rays, and must have {used}"))
        return clamped(light)
