// Samples added to films: in any ranges, by tiles or ray by ray, on any number of threads, they give the
// bytes of the picture of all samples.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// Integrator of one ray whose light is a number of the sampler, on what the ray hits.
struct LightByNumber {
  [[nodiscard]] Color radiance(const Ray& ray, const auto& scene, const PixelSampler& sampler) const {
    const auto hit = scene.intersect(ray, Interval{});
    const auto [a, b, c, d] = sampler(3);
    static_cast<void>(d);
    return Color{to_float(a), to_float(b), to_float(c)} * (hit ? 1.0f : 0.1f);
  }
};

Scene<Sphere, Plane> scene_of_films() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {-0.6, 0.1, 3}, .radius = 0.7}, Color{0.3f, 0.9f, 2.5f});
  scene.add(Sphere{.center = {0.7, -0.2, 3.5}, .radius = 0.6},
            Material{.diffuse = Color{0.3f, 0.1f, 0.7f}, .reflect = 0.4, .refract = 0.3, .ior = 1.4});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -0.8}, Color{0.5f});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});
  scene.set_sky(Color{0.3f, 0.5f, 0.7f});
  return scene;
}

/// Draws a picture with all samples at once, and its films in several ranges; counts bytes that differ.
int film_differs(const auto& integrator, const RenderOptions& options) {
  const auto scene = scene_of_films();
  const auto accelerated = accelerate(scene);
  constexpr int width = 45, height = 37;
  Image expected(width, height);
  render(expected, Camera{}, scene, integrator, options);
  int differences = 0;
  for (const bool tiles : {false, true}) {
    RenderOptions other = options;
    other.tiles = tiles;
    other.threads = tiles ? 3 : 1;
    Film film(expected.tile());
    const auto last = static_cast<std::uint32_t>(options.samples);
    for (const auto& [from, to] : {std::pair{last / 2, last}, {0u, 1u}, {1u, last / 2}, {3u, 3u}})
      add_samples(film, {from, to}, Camera{}, accelerated, integrator, other);
    differences += different_bytes(film.mean(), expected);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        differences += film(x, y).counts != std::array{(last + 1) / 2, last / 2};
    // A part of the picture has the whole's sums; a scene is drawn as one that was accelerated before.
    Film part(Tile{11, 5, 40, 21});
    other.crop = {.width = width, .height = height};
    add_samples(part, {0, last}, Camera{}, scene, integrator, other);
    for (int y = 5; y < 21; ++y)
      for (int x = 11; x < 40; ++x) differences += !(part(x, y) == film(x, y));
  }
  return differences;
}

}  // namespace

TEST_CASE("samples added to a film in ranges have the bytes of all samples at once") {
  std::vector<SamplerChoice> samplers;
  for (const auto name : sampler_names) samplers.push_back(*sampler_named(name));
  samplers.resize(std::size_t{cases(2, 5, 5)});
  for (const SamplerChoice& sampler : samplers)
    for (const bool weights : {false, true})
      for (const double clamp : {0.0, 0.4}) {
        const RenderOptions options{
            .samples = 7,
            .sampler = sampler,
            .filter = weights ? ReconstructionFilter::mitchell() : ReconstructionFilter::box(),
            .seed = 5,
            .clamp = clamp};
        CAPTURE(&sampler - samplers.data(), weights, clamp);
        CHECK(film_differs(ColorIntegrator{}, options) == 0);
        CHECK(film_differs(NormalIntegrator{}, options) == 0);
        CHECK(film_differs(TransparencyIntegrator{}, options) == 0);
        CHECK(film_differs(WhittedIntegrator{.depth = 2}, options) == 0);
        CHECK(film_differs(LightByNumber{}, options) == 0);
      }
}

TEST_CASE("sample i of a Sobol film is the same for any number of samples") {
  const auto scene = scene_of_films();
  const auto drawn = [&](int samples) {
    Film film(Tile{0, 0, 20, 15});
    add_samples(film, {4, 8}, Camera{}, scene, LightByNumber{}, {.samples = samples});
    return film;
  };
  const Film few = drawn(8), many = drawn(4096);
  CHECK(few == many);
  // Without a number of samples, the range's end counts as it.
  CHECK(drawn(0) == many);
}

TEST_CASE("films of samplers that tell no error refuse to tell one, on both paths") {
  const auto scene = scene_of_films();
  const auto refuses = [&](const RenderOptions& options, const SampleRange& samples = {0, 4}) {
    Film film(Tile{0, 0, 20, 15});
    add_samples(film, samples, Camera{}, scene, ColorIntegrator{}, options);
    return !message_of<std::logic_error>([&] { return film.error(); }).empty();
  };
  for (const bool tiles : {false, true}) {
    CHECK(refuses({.tiles = tiles}));  // HammersleySampler by default
    CHECK(refuses({.samples = 4, .sampler = sampler_of<HammersleySampler>, .tiles = tiles}));
    CHECK(refuses({.samples = 4, .sampler = sampler_of<StratifiedSampler>, .tiles = tiles}));
    for (const auto sampler :
         {sampler_of<SobolSampler>, sampler_of<HaltonSampler>, sampler_of<IndependentSampler>})
      CHECK_FALSE(refuses({.samples = 4, .sampler = sampler, .tiles = tiles}));
    CHECK_FALSE(refuses({.tiles = tiles}, {2, 2}));  // no samples
  }
}

TEST_CASE("functions of a ray draw films too") {
  Film film(Tile{0, 0, 20, 15});
  add_samples(film, {0, 4}, Camera{},
              [](const Ray& ray) { return Color{static_cast<float>(ray.direction.x)}; });
  Image image(20, 15);
  render(image, Camera{}, [](const Ray& ray) { return Color{static_cast<float>(ray.direction.x)}; },
         {.samples = 4});
  CHECK(different_bytes(film.mean(), image) == 0);
}

TEST_CASE("a generic function of a ray and a scene draws films and images") {
  const auto scene = scene_of_films();
  const auto normals = [](const Ray& ray, const auto& traced) {
    return NormalIntegrator{}.radiance(ray, traced);
  };
  Film film(Tile{0, 0, 20, 15});
  add_samples(film, {0, 4}, Camera{}, scene, normals);
  Image image(20, 15);
  render(image, Camera{}, scene, normals, {.samples = 4});
  CHECK(different_bytes(film.mean(), image) == 0);
}

TEST_CASE("light is clamped sample by sample") {
  const auto light = [](const Ray&, const PixelSampler& sampler) {
    return sampler.index().sample % 2 == 0 ? Color{3, -1, std::numeric_limits<float>::quiet_NaN()}
                                           : Color{0.5f, 0.25f, 1};
  };
  Image image(2, 2);
  render(image, Camera{}, light, {.samples = 2, .clamp = 2});
  CHECK(image(1, 1) == Color{1.25f, 0.125f, 0.5f});
  render(image, Camera{}, light, {.samples = 1, .clamp = 2});
  CHECK(image(1, 1) == Color{2, 0, 0});
  // No float is above the clamp: the nearest to 1/3 would be, and the one below it counts.
  render(image, Camera{}, light, {.samples = 1, .clamp = 1.0 / 3});
  CHECK(double{image(1, 1).r} <= 1.0 / 3);
  CHECK(image(1, 1).r == std::nextafter(static_cast<float>(1.0 / 3), 0.0f));
  render(image, Camera{}, light, {.samples = 2, .clamp = infinity});
  CHECK(image(1, 1) == Color{1.75f, -0.375f, 0.5f});
}

TEST_CASE("samples that a film cannot have are refused") {
  Film film(Tile{3, 4, 20, 15});
  const auto white = [](const Ray&) { return Color{1}; };
  const auto message = [&](const SampleRange& samples, const RenderOptions& options) {
    return message_of<std::invalid_argument>([&] { add_samples(film, samples, Camera{}, white, options); });
  };
  CHECK(message({0, 9}, {.samples = 8}) ==
        "render: samples must end at the 8 of the options or before; they end at 9");
  CHECK(message({0, 0x80000000}, {}) ==
        "render: samples must end at 4194303 or before; they end at 2147483648");
  CHECK(message({0, 1}, {.crop = {.width = 19, .height = 15}}).find("is not inside 19x15") !=
        std::string::npos);
  CHECK(message({0, 1}, {.clamp = -1}) == "RenderOptions: clamp must be 0 (none) or greater; it is -1");
  CHECK_FALSE(message({0, 1}, {.clamp = std::nan("")}).empty());
  CHECK(message({0, 1}, {}).empty());

  // A range of none is checked alike.
  CHECK(message({9, 9}, {.samples = 8}) ==
        "render: samples must end at the 8 of the options or before; they end at 9");
  CHECK(message({0, 0}, {.clamp = -1}) == "RenderOptions: clamp must be 0 (none) or greater; it is -1");
  CHECK(message({1, 1}, {.error = 1}).find("options of an image, not of a film") != std::string::npos);
  CHECK(message({1, 1}, {.threads = -1}).find("threads must be 0 (all cores) or more; it is -1") !=
        std::string::npos);
  CHECK(message({1, 1}, {.crop = {.width = 19, .height = 15}}).find("is not inside 19x15") !=
        std::string::npos);
  CHECK(message({0, 0}, {}).empty());
  CHECK(message({3, 3}, {}).empty());
}
