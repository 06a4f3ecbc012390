"""Checks an explanation, from the camera to the codes."""
from fractions import Fraction

from .chance import Chance
from .exact import add, BLACK, clamped, f32, length, minus, sizes, times, unit
from .filters import CURVES, Filter
from .hits import Hits
from .images import Images
from .light import BY_CHANCE, check_code, FORMULAS, mean_of, times_float
from .lights import Lights
from .naive import check_naive, check_naive_march
from .paths import Paths
from .radiance import Radiance
from .rays import Rays
from .samplers import SAMPLERS, SET_OF_TIME
from .solids import Moving
from .surfaces import surface_of
from .values import U, Wrong
from .warps import disk_point


class Check(Rays, Hits, Lights, Radiance, Chance, Paths):
    def __init__(self, file):
        self.file = file
        self.given = set()
        self.images = Images()
        self.materials = {}  # of the surfaces that were hit

    def run(self):
        f = self.file
        f["format"].must_be("protostar explanation 1")
        self.integrator = f["integrator"].word()
        width, height = f["picture"].vector(2)
        x, y = f["pixel"].vector(2)
        for value, size in zip(f["pixel"], (width, height)):
            value.index(int(size))
        self.is_recorded = "surfaces" in f
        if self.is_recorded:
            self.surfaces = [surface_of(facts) for facts in f["surfaces"]]
            self.ambient = f["ambient"].vector() if "ambient" in f else BLACK
            self.depth = f["depth"].whole()
        for i, sample in enumerate(f["samples"]):
            self.check_sample(sample, i, len(f["samples"]), (x, y), (width, height))
        self.check_picture(x, width)

    # The camera.

    def check_sample(self, sample, i, count, pixel, size):
        in_pixel = sample["position"]
        self.numbers_of = self.sampler_of(i, count, pixel)
        for surface in self.surfaces if self.is_recorded else ():
            if isinstance(surface, Moving):
                surface.move_to(sample["time"].number() if "time" in sample else Fraction(0))
        is_center = count == 1 and in_pixel.vector(2) == [Fraction(1, 2)] * 2
        if is_center or self.file["filter"].data == "box":
            if not is_center and self.numbers_of:  # without a number of samples, the only ray passes the center
                in_pixel.must_equal(self.numbers_of(0)[:2])
            if sample["weight"].number() != 1:
                sample["weight"].refuse(sample["weight"].number(), 1)
        elif self.file["filter"].data not in CURVES:
            self.given.add("the places and weights of samples by a filter that is not the library's")
        elif self.numbers_of:
            every = [self.sampler_of(k, count, pixel)(0)[:2] for k in range(count)] \
                if self.file["sampler"].data == "hammersley" else None
            self.filter().check(sample, self.numbers_of(0)[:2], every)
        (px, py), (x, y), (width, height) = in_pixel.vector(2), pixel, size
        u, v = width / height * (2 * (x + px) / width - 1), 1 - 2 * (y + py) / height
        # Each coordinate passes at most five roundings; before the last difference it is at most 2, times the ratio.
        sample["film"][0].must_be_near(u, 16 * U * width / height)
        sample["film"][1].must_be_near(v, 16 * U)
        u, v = sample["film"].vector(2)
        of_camera = self.file["camera"]
        names = ("position", "right", "up", "forward", "film_right", "film_up")
        camera = {name: of_camera[name].vector() for name in names}
        across = lambda right, up, base: add(add(times(u, camera[right]), times(v, camera[up])), camera[base])
        across_sizes = lambda right, up, base: add(
            add(times(abs(u), sizes(camera[right])), times(abs(v), sizes(camera[up]))), sizes(camera[base]))
        errors = times(4 * U, across_sizes("film_right", "film_up", "position"))
        origin, along = across("film_right", "film_up", "position"), across("right", "up", "forward")
        along_sizes = across_sizes("right", "up", "forward")
        if "lens" in sample:
            if self.numbers_of:
                sample["lens"].must_be_near_vector(disk_point(*self.numbers_of(0)[2:]), Fraction(1, 2**47))
            lens_x, lens_y = sample["lens"].vector(2)
            aperture, focus = of_camera["aperture"].number(), of_camera["focus"].number()
            point = times(aperture, add(times(lens_x, unit(camera["right"])), times(lens_y, unit(camera["up"]))))
            origin, along = add(origin, point), minus(along, times(1 / focus, point))
            # Rounding of the two unit vectors, their multiples and sums: less than 16 of the sizes of both.
            errors = add(errors, times(16 * U, [aperture] * 3))
            along_sizes = add(along_sizes, [4 * aperture / focus] * 3)
        elif not is_center:  # without a number of samples, the only ray passes the center of the lens
            of_camera["aperture"].must_be(0)
        if "time" in sample:
            way = times(sample["time"].number(), of_camera["velocity"].vector())
            errors = add(errors, add(times(2 * U, sizes(way)), times(U, sizes(origin))))
            origin = add(origin, way)
        sample["origin"].must_be_near_vector(origin, errors)
        error = 8 * U * (1 + sum(along_sizes) / length(along))
        sample["direction"].must_be_near_vector(unit(along), error)
        if "time" in sample and not is_center and self.numbers_of:
            opens, closes = of_camera["shutter"].vector(2)
            at = opens + self.numbers_of(SET_OF_TIME)[0] * (closes - opens)
            sample["time"].must_be_near(at, 4 * U * (abs(opens) + abs(closes)))
        if "sets" in sample:
            self.check_sets(sample["sets"])
        if self.is_recorded:
            self.check_root(sample)
        if "steps" in sample:
            is_march = sample["steps"][0]["type"].word() == "marched spheres"
            (check_naive_march if is_march else check_naive)(sample, self.integrator)

    def sampler_of(self, i, count, pixel):
        """Returns the function that gives the numbers of each set of sample i; None for a sampler that is not the
        library's."""
        numbers_of = SAMPLERS.get(self.file["sampler"].word())
        if not numbers_of:
            self.given.add("the numbers of a sampler that is not the library's")
            return None
        seed, at = self.file["seed"].word_of_64(), tuple(map(int, pixel))
        return lambda set_number: numbers_of(seed, at, set_number, i, count)

    def filter(self):
        """Returns the filter of the file, which takes a while to make."""
        if not hasattr(self, "of_filter"):
            self.of_filter = Filter(self.file["filter"].word())
        return self.of_filter

    def check_sets(self, sets):
        """Checks the sets of numbers that an integrator takes of a sample."""
        for k, one in enumerate(sets):
            if self.integrator in BY_CHANCE:
                one["set"].must_be(k + 1)  # the pixel and the lens take set 0
            if self.numbers_of:
                one["numbers"].must_be_near_vector(self.numbers_of(one["set"].index(2**32)), 0)
            for number in one["numbers"]:
                if not 0 < number.number() < 1:
                    raise Wrong(number.at(f"is {float(number.number())}, and must lie between 0 and 1"))

    def check_root(self, sample):
        """Checks the rays of a sample and its radiance."""
        rays, name = sample["rays"], self.integrator
        if name in BY_CHANCE:
            return self.check_by_chance(sample)
        if name not in FORMULAS:
            self.given.add("the radiance of an integrator that is not the library's")
            return
        query = {"binary": "any", "transparency": "all"}.get(name, "closest")
        if len(rays) != 1:
            raise Wrong(rays.at(f"has {len(rays)} rays, and must have one"))
        ray = rays[0]
        ray["query"].must_be(query)
        ray["leaves"].must_be(None)
        ray["range_end"].must_be("infinity")
        for key in ("origin", "direction"):
            ray[key].must_equal(sample[key].vector())
        radiance = self.radiance_of(ray, sample, 1)
        sample["radiance"].must_equal(radiance)

    # The picture.

    def check_picture(self, x, width):
        f = self.file
        if len(f["samples"]) == 0:
            if self.integrator == "gradient":
                f["mean"].must_equal([f32(f32(x) / f32(max(width - 1, Fraction(1))))] * 3)
            else:
                self.given.add("light that no ray brings")
        else:
            f["mean"].must_equal(mean_of(f["samples"]))
            first = f["samples"][0]
            if not self.is_recorded and "steps" not in first:
                self.given.add("the radiance of a function of the ray that records nothing")
        light, exposure = f["mean"].vector(), f["exposure"].number()
        if exposure != 1:
            light = clamped(times_float(f32(exposure), light)) if f32(exposure) else BLACK
        f["light"].must_equal(light)
        if "codes" not in f:
            return
        toned, tone = light, f["tone"].word()
        largest = max(clamped(light))
        if tone == "scale_pixel":
            toned = [f32(x / largest) for x in light] if largest > 1 else light
        elif tone == "scale_image":
            self.given.add("the largest channel of the picture")
            whole = f["largest"].number()
            if whole < largest:
                f["largest"].refuse(whole, largest)
            toned = [f32(x / whole) for x in clamped(light)] if whole > 0 else light
        elif tone != "clip":
            raise Wrong(f["tone"].at("must be clip, scale_pixel or scale_image"))
        f["toned"].must_equal(toned)
        if f["max_code"].whole() not in (255, 65535):
            raise Wrong(f["max_code"].at("must be 255 or 65535"))
        for code, light_of in zip(f["codes"], f["toned"].vector()):
            code.index(f["max_code"].whole() + 1)
            check_code(code, light_of, f)
