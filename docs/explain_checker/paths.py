"""Light that is drawn by chance: of the integrators direct and path.

Numbers of float are sums and products of positive numbers, of which each operation rounds by 2^-24 of its result at most.
So the radiance is off by 2^-24 for each operation on the way to it, and by the error of the lobes: Tally counts both.
"""
from fractions import Fraction

from .area_lights import AreaLights, NoDirections
from .chance import Choice, DOUBT, fresnel
from .exact import BLACK, dot, f32, product32, root
from .light import mirror, mirroring_normal, passage
from .lobes import CLOSE, floats, heuristic, Reflector
from .values import U, Wrong
from .warps import cosine_direction

ROUGH = Fraction(1, 2**18)  # more than the roundings of float in the weights and shares of glossy lobes
OVER_PI = 0.31830988618379067


def times_double(color, factor):
    """Returns a color times a factor, rounded to double and then to float."""
    return [f32(Fraction(float(x) * factor)) for x in color]


class Tally:
    """The light of a sample, and the bound of its relative error."""

    def __init__(self):
        self.light, self.error = [0.0] * 3, 2.0**-24 * 16

    def add(self, light, error=0.0):
        self.light = [x + y for x, y in zip(self.light, light)]
        self.error += error + 2.0**-24 * 4

    def check(self, value):
        value.must_be_near_vector([Fraction(x) for x in self.light],
                                  [Fraction(x * self.error) + Fraction(1, 2**130) for x in self.light])


class Paths:
    """Checks of light that is drawn by chance."""

    def check_drawn_light(self, sample):
        tally = Tally()
        root_ray = sample["rays"][0]
        if len(sample["rays"]) != 1:
            raise Wrong(sample["rays"].at(f"has {len(sample['rays'])} rays, and must have one"))
        try:
            if not hasattr(self, "area_lights"):
                self.area_lights = AreaLights(self.file["area_lights"], self.surfaces)
                self.most_rays = self.file["most_rays"].index(2**31)
            if self.file["environment_has_places"].truth():
                raise NoDirections("directions to an environment")
            (self.check_path if self.integrator == "path" else self.check_direct)(root_ray, sample, tally)
        except NoDirections as what:
            self.given.add(f"{what}; and the light of the sample")
            return self.check_rays_alone(sample["rays"], [])
        tally.check(sample["radiance"])

    def check_rays_alone(self, rays, hits):
        """Checks where rays start and what they hit, whatever draws their directions; adds their hits to those before."""
        for ray in rays:
            if hits:
                start = [ray["leaves"].whole(), ray["leaves_part"].whole(), ray["origin"].vector()]
                if start not in hits:
                    raise Wrong(ray["origin"].at("must be a point that a ray hit before, on the surface that it leaves"))
            line, _, taken = self.check_ray(ray)
            if ray["query"].word() != "closest":
                continue
            if taken is not None:
                hit = self.check_hit(ray["hit"], line, ray["considered"][taken])
                hits.append([taken, hit["part"].whole(), hit["point"].vector()])
            self.check_rays_alone(ray["rays"], hits)

    def numbers_of_set(self, sample, k):
        sets = sample["sets"] if "sets" in sample else ()
        if len(sets) <= k:
            raise Wrong(sample.at(f"must have the set of numbers {k + 1}"))
        return sets[k]["numbers"].vector(4)

    def met(self, ray, line, taken):
        """Checks a hit, with its emission; returns it as what reflects light."""
        hit = self.check_hit(ray["hit"], line, ray["considered"][taken])
        self.area_lights.check_emission(hit["material"]["emission"], self.surfaces[taken], taken)
        return Reflector(ray, hit, line)

    def density_by_lights(self, origin, hit, taken):
        """Returns the density with which rays to lights draw the direction from a point to a hit; None is ∞."""
        density, probability = self.area_lights.drawn(origin, taken, hit["part"].whole())
        if density is None:
            return None
        if self.integrator == "path":
            return float(density * probability)
        is_each = len(self.area_lights.lights) <= self.most_rays
        return float(density if is_each else density * probability * self.most_rays)

    # Lights.

    def lights_at(self, at, line, rays, choice):
        """Returns the light of the ambient lights, and of lights at points or in directions that nothing occludes."""
        matte, glossy = floats(self.ambient), [0.0] * 3
        if "lights" not in at.hit:
            if "lights" in self.file and len(self.file["lights"]):
                raise Wrong(at.hit.at("must have the lights of the scene"))
            return matte, glossy
        all_lights, found = self.file["lights"], at.hit["lights"]
        if len(found) != len(all_lights):
            raise Wrong(found.at("must have all lights of the scene"))
        for light, own in zip(all_lights, found):
            self.check_light(light, own, at.hit, line)
        count = len(found)
        if choice is None or count <= self.most_rays:
            taken, weight = range(count), 1.0
        else:
            weight = count / self.most_rays
            taken = [min(int((k + float(choice)) * weight), count - 1) for k in range(self.most_rays)]
        for i in taken:
            light, own = all_lights[i], found[i]
            towards = own["towards"].vector()
            size = root(dot(towards, towards))
            direction = [x / size for x in towards]
            shadow = rays.take("any", lambda ray: ray["direction"].vector() == towards)
            if shadow is None and not at.is_skipped(direction):
                raise Wrong(own["shadow_ray"].at("must be a ray"))
            if len(taken) == count:  # otherwise a light may have the ray of another that is in its direction
                own["shadow_ray"].must_be(None if shadow is None else rays.at - 1)
            if shadow is None:
                continue
            shadow["range_end"].must_be("infinity" if "direction" in light else 1)
            self.check_start(shadow, at.ray, at.hit)
            if self.check_ray(shadow)[2] is not None:
                continue
            if at.is_matte:
                matte = [x + weight * y for x, y in zip(matte, floats(own["irradiance"].vector()))]
            if at.glossy:
                share = at.glossy.reflection(direction)
                glossy = [x + weight * y * z for x, y, z in zip(glossy, share, floats(own["facing"].vector()))]
        return matte, glossy

    def light_by_ray(self, at, light, numbers, weight, rays):
        """Returns the light that a hit reflects from a light, by one ray to it."""
        point = at.hit["point"].vector()
        view, u, v, of_part, part = light.draw(point, *numbers)
        dark = [0.0] * 3
        if not view.solid_angle:
            return dark, dark
        direction = view.direction(u, v)
        ray = rays.take("closest", lambda one: not one["radiance"].is_null())
        if ray is None:
            if not at.is_skipped(direction):
                raise Wrong(at.ray["rays"].at("must have a ray to each light that is drawn"))
            return dark, dark
        if at.is_skipped(direction) and not self.is_near(ray, direction, view.error):
            rays.put_back()
            return dark, dark
        ray["direction"].must_be_near_vector(direction, view.error)
        ray["range_end"].must_be("infinity")
        self.check_start(ray, at.ray, at.hit)
        line, _, taken = self.check_ray(ray)
        seen = BLACK
        if taken is not None:
            self.met(ray, line, taken)
            if taken == light.index and ray["hit"]["part"].whole() == part:
                seen = light.emission
        ray["radiance"].must_equal(seen)
        density = float(of_part / view.solid_angle)
        return at.light_along(ray["direction"].vector(), density, float(weight), floats(seen))

    @staticmethod
    def is_near(ray, direction, error):
        return all(abs(x - y) <= error for x, y in zip(ray["direction"].vector(), direction))

    # Integrators.

    def check_direct(self, ray, sample, tally):
        line, _, taken = self.check_ray(ray)
        ray["radiance"].must_be(None)
        if taken is None:
            return tally.add(floats(self.sky(ray, line.direction, BLACK)))
        at = self.met(ray, line, taken)
        emission = floats(at.material["emission"].vector())
        rays = InOrder(ray["rays"])
        if at.reflects():
            matte, glossy = self.lights_at(at, line, rays, None)
            matte, pair = [x * OVER_PI for x in matte], [0]

            def next_pair():
                k = pair[0]
                pair[0] += 1
                return self.numbers_of_set(sample, k // 2)[2 * (k % 2):2 * (k % 2) + 2]

            lights, most = self.area_lights.lights, self.most_rays
            if len(lights) <= most:
                drawn = [(light, next_pair(), Fraction(1)) for light in lights]
            else:
                u, drawn = next_pair()[0], []
                for k in range(most):
                    i, probability, _, doubt = self.area_lights.by_power.choose((k + u) / most)
                    if doubt < DOUBT:
                        raise NoDirections("lights where chance decides by the last digits")
                    drawn.append((lights[i], next_pair(), 1 / (most * probability)))
            for one in drawn:
                more = self.light_by_ray(at, *one, rays)
                matte, glossy = ([x + y for x, y in zip(*pair)] for pair in zip((matte, glossy), more))
                tally.error += 2.0**-24
            emission = [x + y * z for x, y, z in zip(emission, floats(at.color), matte)]
            if at.glossy:
                lobe = self.light_along_lobe(at, next_pair(), rays)
                emission = [x + y + z for x, y, z in zip(emission, glossy, lobe)]
        rays.must_end()
        tally.add(emission, 4 * at.error)

    def light_along_lobe(self, at, numbers, rays):
        direction, error, density, weight = at.glossy.sample(*numbers)
        ray = rays.take("closest", lambda one: True)
        if ray is None:
            if not at.glossy.is_grazing(direction) and any(weight):
                raise Wrong(at.ray["rays"].at("must have a ray along the glossy lobe"))
            return [0.0] * 3
        ray["direction"].must_be_near_vector(direction, error)
        ray["range_end"].must_be("infinity")
        self.check_start(ray, at.ray, at.hit)
        line, _, taken = self.check_ray(ray)
        if taken is None:
            light = floats(self.sky(ray, line.direction, BLACK))
        else:
            self.met(ray, line, taken)
            light = floats(ray["hit"]["material"]["emission"].vector())
            if any(light):
                share = heuristic(density, self.density_by_lights(line.origin, ray["hit"], taken))
                light = [share * x for x in light]
        seen = Tally()
        seen.add([x * y for x, y in zip(weight, light)], 4 * at.error)
        seen.check(ray["radiance"])
        return seen.light

    def check_path(self, ray, sample, tally):
        sure_share = Fraction(1, 2 if self.has_light() else 4)  # of the first weight; chance may end paths below
        weight, first_weight, bounces, density, is_exact = [Fraction(1)] * 3, 0.0, 0, None, True
        while True:
            line, _, taken = self.check_ray(ray)
            ray["radiance"].must_be(None)
            if taken is None:
                if len(ray["rays"]):
                    raise Wrong(ray["rays"].at("must be empty, since nothing is hit"))
                sky = floats(self.sky(ray, line.direction, BLACK))
                return tally.add([x * y for x, y in zip(floats(weight), sky)])
            at = self.met(ray, line, taken)
            emission = floats(at.material["emission"].vector())
            if any(emission):
                share = 1.0 if bounces == 0 else \
                    heuristic(density, self.density_by_lights(line.origin, at.hit, taken))
                tally.add([share * x * y for x, y in zip(floats(weight), emission)], 4 * at.error)
            rays = InOrder(ray["rays"])
            if bounces >= self.depth:
                return rays.must_end()
            shares = LobeShares(at)
            if not shares.whole:  # as most lamps, which need no numbers
                return rays.must_end()
            numbers = self.numbers_of_set(sample, bounces)
            if at.glossy and shares.whole:
                at.glossy_probability = shares.glossy / shares.whole
            if at.reflects():
                light = self.reflected_light(at, line, numbers, rays)
                tally.add([x * y for x, y in zip(floats(weight), light)], 4 * at.error)
            is_exact = is_exact and not at.glossy
            choice = Choice(numbers[2], DOUBT if is_exact else ROUGH)
            onward = shares.scatter(at, numbers, choice)
            if not choice.is_sure:
                raise NoDirections("a path where chance decides by the last digits")
            direction, error, factor, density, may_end = onward
            following = rays.take("closest", lambda one: one["radiance"].is_null())
            rays.must_end()
            goes_on = any(factor)
            if goes_on:
                weight = product32(weight, factor)
                if bounces == 0:
                    first_weight = max(weight)
                probability = float(max(weight)) / float(sure_share * first_weight)
                if bounces > 0 and not is_exact and abs(1 - probability) <= ROUGH:
                    raise NoDirections("a path where chance decides by the last digits")
                if probability < 1:
                    goes_on = choice.decide(Fraction(probability))
                    if not choice.is_sure:
                        raise NoDirections("a path where chance decides by the last digits")
                    weight = times_double(weight, 1 / probability)
            if following is None:
                if goes_on and not may_end:
                    raise Wrong(ray["rays"].at("must have a ray along which the path goes on"))
                return None
            if not goes_on:
                raise Wrong(following.at("must not be: the path ends at the hit before"))
            following["direction"].must_be_near_vector(direction, error)
            following["range_end"].must_be("infinity")
            self.check_start(following, ray, at.hit)
            ray, bounces = following, bounces + 1
            tally.error += 8 * 2.0**-24 + at.error

    def has_light(self):
        """Returns true if the scene has lights, or ambient light."""
        return self.area_lights.by_power.whole or ("lights" in self.file and len(self.file["lights"])) or \
            any(self.ambient)

    def reflected_light(self, at, line, numbers, rays):
        """Returns the light that a hit reflects of the lights, by rays to them."""
        if not self.has_light():
            return [0.0] * 3
        by_ray = [0.0] * 3, [0.0] * 3
        if self.area_lights.by_power.whole:  # whose ray comes before the shadow rays
            i, probability, rest, doubt = self.area_lights.by_power.choose(numbers[2])
            if doubt < DOUBT:
                raise NoDirections("lights where chance decides by the last digits")
            by_ray = self.light_by_ray(at, self.area_lights.lights[i], (rest, numbers[3]), 1 / probability, rays)
        matte, glossy = self.lights_at(at, line, rays, numbers[2])
        matte = [x * OVER_PI for x in matte]
        matte, glossy = ([x + y for x, y in zip(*pair)] for pair in zip((matte, glossy), by_ray))
        reflected = [x * y for x, y in zip(floats(at.color), matte)]
        return [x + y for x, y in zip(reflected, glossy)] if at.glossy else reflected


class InOrder:
    """The rays that follow a hit, to be taken one by one."""

    def __init__(self, rays):
        self.rays, self.at = rays, 0

    def take(self, query, is_wanted):
        """Returns the next ray if it is of this kind, otherwise None."""
        if self.at < len(self.rays):
            ray = self.rays[self.at]
            if ray["query"].word() == query and is_wanted(ray):
                self.at += 1
                return ray
        return None

    def put_back(self):
        self.at -= 1

    def must_end(self):
        if self.at < len(self.rays):
            raise Wrong(self.rays[self.at].at("is a ray that nothing asks for"))


class LobeShares:
    """Shares of light that the lobes of a material send back, of which chance chooses one."""

    def __init__(self, at):
        self.diffuse, self.glossy = max(at.color), at.glossy.share if at.glossy else 0.0
        self.mirror, self.glass = (f32(at.material[name].number()) for name in ("reflect", "refract"))
        self.whole = (float(self.diffuse) + self.glossy) + (float(self.mirror) + float(self.glass))

    def scatter(self, at, numbers, choice):
        """Returns the direction in which a path goes on, its error, the factor of its weight, its density, and whether
        it may end there, since the direction is next to one that leads into the surface."""
        if not self.whole:
            return None, 0, [0.0] * 3, 0.0, False
        u, v = numbers[:2]
        whole, sharp, d, own = Fraction(self.whole), self.mirror + self.glass, at.d, at.own
        of = lambda color, share: times_double(color, self.whole / float(share))
        if choice.decide(self.diffuse / whole):
            direction = cosine_direction(at.normal, u, v)
            over = dot(own, direction) if at.is_mapped else Fraction(1)
            return direction, 64 * U, of(at.color, self.diffuse) if over > 0 else [0.0] * 3, 0.0, over <= CLOSE
        if self.glossy and choice.decide(Fraction(self.glossy) / (Fraction(self.glossy) + sharp)):
            direction, error, density, weight = at.glossy.sample(u, v)
            return direction, error, of(weight, self.glossy), density * self.glossy / self.whole, \
                at.glossy.is_grazing(direction)
        normal = mirroring_normal(at.hit, d)
        if choice.decide(self.mirror / sharp):
            return mirror(d, normal), 64 * U, of([self.mirror] * 3, self.mirror), None, False
        passes, bent, square, ratio = passage(at.hit, d)
        reflectance = fresnel(-dot(normal, d), -dot(normal, bent), ratio) if passes else Fraction(1)
        factor = of([self.glass] * 3, self.glass)
        if choice.decide(reflectance):
            return mirror(d, normal), 64 * U, factor, None, False
        return bent, 64 * U * (1 + (1 + ratio**2) / (root(square) + Fraction(1, 2**26))), factor, None, False
