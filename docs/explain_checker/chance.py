"""Integrators that draw by chance: the directions that follow from the numbers of the sampler."""
from fractions import Fraction

from .exact import add, dot, f32, root, times, unit
from .functions import PI, sine_and_cosine
from .light import mirror, refracted, shading_normal
from .values import U, Wrong

DOUBT = Fraction(1, 2**40)  # more than the roundings of a probability and of the numbers left by a choice
SURE_BOUNCES = 3  # after which chance may end a path


def cosine_direction(normal, u, v):
    """Returns the direction of the hemisphere around a normal that is above the point of the unit disk to which the
    concentric map takes (u, v)."""
    a, b = 2 * u - 1, 2 * v - 1
    if a == b == 0:
        size, angle = Fraction(0), Fraction(0)
    elif abs(a) > abs(b):
        size, angle = a, PI / 4 * (b / a)
    else:
        size, angle = b, PI / 2 - PI / 4 * (a / b)
    sine, cosine = sine_and_cosine(angle)
    x, y, z = size * cosine, size * sine, root(1 - size * size)
    # The shortest turn of the z axis to the normal.
    n = normal
    square = n[0]**2 + n[1]**2
    if n[2] < 0 and square < Fraction(1, 2**900):
        first, second = [Fraction(1), Fraction(0), Fraction(0)], [Fraction(0), Fraction(-1), Fraction(0)]
    else:
        k = (1 - n[2]) / square if n[2] < 0 else 1 / (1 + n[2])
        first = [1 - n[0]**2 * k, -n[0] * n[1] * k, -n[0]]
        second = [-n[0] * n[1] * k, 1 - n[1]**2 * k, -n[1]]
    return add(add(times(x, first), times(y, second)), times(z, n))


class Choice:
    """A number between 0 and 1 that answers questions, and becomes its place among those with the same answer."""

    def __init__(self, number):
        self.number, self.is_sure = number, True

    def decide(self, probability):
        self.is_sure = self.is_sure and abs(self.number - probability) > DOUBT
        if self.number < probability:
            self.number /= probability
            return True
        if probability < 1:
            self.number = (self.number - probability) / (1 - probability)
        return False


def fresnel(before, behind, ratio):
    """Returns the share of light that a boundary reflects, from the cosines of both angles."""
    if before <= 0:
        return Fraction(1)
    across = (ratio * before - behind) / (ratio * before + behind)
    along = (before - ratio * behind) / (before + ratio * behind)
    return (across**2 + along**2) / 2


class Weight:
    """The largest channel of the weight that a path has, from which follows where chance ends it; unknown after a glossy
    lobe."""

    def __init__(self):
        self.channels, self.most = [Fraction(1)] * 3, None

    def survives(self, bounces, color, factor, choice):
        """Multiplies the weight by a color and a factor, and returns whether chance lets the path go on."""
        if bounces == SURE_BOUNCES and self.channels:
            self.most = max(self.channels)
        if not self.channels:
            choice.is_sure = choice.is_sure and bounces < SURE_BOUNCES
            return True
        self.channels = [x * y * factor for x, y in zip(self.channels, color)]
        probability = max(self.channels) / self.most if bounces >= SURE_BOUNCES else 1
        if probability >= 1:
            return True
        goes_on = choice.decide(probability)
        self.channels = [x / probability for x in self.channels]
        return goes_on


class Chance:
    """Checks of what is drawn by chance."""

    def check_by_chance(self, sample):
        rays = sample["rays"]
        for key in ("origin", "direction"):
            rays[0][key].must_equal(sample[key].vector())
        if self.integrator == "ambient-occlusion":
            return self.check_ambient_occlusion(sample)
        self.given.add("the light of an integrator that draws by chance, and its directions to lights of any size")
        if self.integrator == "direct":
            self.given.add("the directions that glossy lobes draw")
        self.check_drawn(rays, [], sample, 0, Weight())

    def check_drawn(self, rays, hits, sample, bounces, weight):
        """Checks where rays start and what they hit, and where paths go on; adds their hits to those before."""
        for ray in rays:
            if hits:
                start = [ray["leaves"].whole(), ray["leaves_part"].whole(), ray["origin"].vector()]
                if start not in hits:
                    raise Wrong(ray["origin"].at("must be a point that a ray hit before, on the surface that it leaves"))
            else:
                ray["leaves"].must_be(None)
            line, _, taken = self.check_ray(ray)
            if ray["query"].word() != "closest":
                continue
            goes_on = bounces == 0 or self.is_of_path(ray)
            if taken is not None:
                hit = self.check_hit(ray["hit"], line, ray["considered"][taken])
                hits.append([taken, hit["part"].whole(), hit["point"].vector()])
                if goes_on and self.integrator == "path":
                    self.check_bounce(ray, hit, line, sample, bounces, weight)
            self.check_drawn(ray["rays"], hits, sample, bounces + 1, weight)

    def is_of_path(self, ray):
        """Returns true for a ray along which a path goes on. One to a light has a radiance of its own."""
        return self.integrator == "path" and ray["query"].word() == "closest" and ray["radiance"].is_null()

    def check_bounce(self, ray, hit, line, sample, bounces, weight):
        """Checks that a path goes on in the direction that the sampler's numbers give, or that it ends."""
        following = [one for one in ray["rays"] if self.is_of_path(one)]
        if bounces >= self.depth:
            if following:
                raise Wrong(following[0].at(f"follows {self.depth} bounces, and the path ends there"))
            return
        if len(following) > 1:
            raise Wrong(following[1].at("is a second ray along which the path goes on"))
        material = hit["material"]
        if any(material["glossy"].vector()):
            self.given.add("the directions of paths on surfaces with a glossy lobe, and where chance ends them after these")
            weight.channels = None
            return
        sets = sample["sets"] if "sets" in sample else ()
        if len(sets) <= bounces:
            raise Wrong(sample.at(f"must have the set of numbers of bounce {bounces}"))
        u, v, choice = sets[bounces]["numbers"].vector(4)[:3]
        diffuse, mirrored, glass = (max(hit["color"].vector()), f32(material["reflect"].number()),
                                    f32(material["refract"].number()))
        whole, choice = diffuse + mirrored + glass, Choice(choice)
        if whole <= 0:
            if following:
                raise Wrong(following[0].at("leaves a black surface"))
            return
        d, own, normal, error = unit(line.direction), hit["facing_normal"].vector(), shading_normal(hit), 64 * U
        color, share = hit["color"].vector(), diffuse
        if choice.decide(diffuse / whole):
            right = cosine_direction(normal, u, v)
            if "normal_map" in hit and dot(own, right) <= DOUBT:
                return  # it leads into the surface, and ends there
        else:
            if dot(own, mirror(d, normal)) <= 0:
                normal = own
            right, color, share = mirror(d, normal), [mirrored] * 3, mirrored
            if not choice.decide(mirrored / (mirrored + glass)):
                color, share = [glass] * 3, glass
                enters, ior = hit["normal"].vector() == own, material["ior"].number()
                bent, square, ratio = refracted(d, normal, 1 / ior if enters else ior)
                passes = square >= 0 and (dot(own, bent) < 0 or "normal_map" not in hit)
                reflectance = fresnel(-dot(normal, d), -dot(normal, bent), ratio) if passes else Fraction(1)
                if not choice.decide(reflectance):
                    right = bent
                    error += 64 * U * (1 + ratio**2) / (root(square) + Fraction(1, 2**26))
        goes_on = weight.survives(bounces, color, whole / share, choice)
        if not choice.is_sure:
            return
        if goes_on != bool(following):
            raise Wrong(ray["rays"].at(f"must have {'a' if goes_on else 'no'} ray along which the path goes on"))
        if following:
            following[0]["query"].must_be("closest")
            following[0]["range_end"].must_be("infinity")
            following[0]["direction"].must_be_near_vector(right, error)
            self.check_start(following[0], ray, hit)

    def check_ambient_occlusion(self, sample):
        """Checks the light of a white sky in one direction that the first numbers give."""
        rays = sample["rays"]
        if len(rays) != 1:
            raise Wrong(rays.at(f"has {len(rays)} rays, and must have one"))
        ray = rays[0]
        ray["leaves"].must_be(None)
        line, _, taken = self.check_ray(ray)
        light = Fraction(1)
        if taken is not None:
            hit = self.check_hit(ray["hit"], line, ray["considered"][taken])
            right = cosine_direction(shading_normal(hit), *sample["sets"][0]["numbers"].vector(4)[:2])
            if len(ray["rays"]):
                occluding = ray["rays"][0]
                occluding["query"].must_be("any")
                occluding["direction"].must_be_near_vector(right, 64 * U)
                self.check_start(occluding, ray, hit)
                light = Fraction(int(self.check_ray(occluding)[2] is None))
                self.given.add("the distance from which on surfaces occlude nothing, for ambient occlusion")
            elif "normal_map" in hit and dot(hit["facing_normal"].vector(), right) <= DOUBT:
                light = Fraction(0)
            else:
                raise Wrong(ray["rays"].at("must have a ray"))
        sample["radiance"].must_equal([light] * 3)
