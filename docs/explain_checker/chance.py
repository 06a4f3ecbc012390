"""Integrators that draw by chance: the directions that follow from the numbers of the sampler."""
from fractions import Fraction

from .exact import dot
from .light import shading_normal
from .values import U, Wrong
from .warps import cosine_direction

DOUBT = Fraction(1, 2**40)  # more than the roundings of a probability and of the numbers left by a choice


class Choice:
    """A number between 0 and 1 that answers questions, and becomes its place among those with the same answer."""

    def __init__(self, number, doubt=DOUBT):
        self.number, self.doubt, self.is_sure = number, doubt, True

    def decide(self, probability):
        self.is_sure = self.is_sure and (not 0 < probability < 1 or abs(self.number - probability) > self.doubt)
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


class Chance:
    """Checks of what is drawn by chance."""

    def check_by_chance(self, sample):
        rays = sample["rays"]
        rays[0]["leaves"].must_be(None)
        rays[0]["range_end"].must_be("infinity")
        for key in ("origin", "direction"):
            rays[0][key].must_equal(sample[key].vector())
        if self.integrator == "ambient-occlusion":
            return self.check_ambient_occlusion(sample)
        self.check_drawn_light(sample)

    def check_ambient_occlusion(self, sample):
        """Checks the light of a white sky in one direction that the first numbers give."""
        rays = sample["rays"]
        if len(rays) != 1:
            raise Wrong(rays.at(f"has {len(rays)} rays, and must have one"))
        ray = rays[0]
        line, _, taken = self.check_ray(ray)
        ray["radiance"].must_be(None)
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
            elif "normal_map" in hit and dot(hit["facing_normal"].vector(), right) <= DOUBT:
                light = Fraction(0)
            else:
                raise Wrong(ray["rays"].at("must have a ray"))
        sample["radiance"].must_equal([light] * 3)
