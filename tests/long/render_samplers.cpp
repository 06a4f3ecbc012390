// Pictures of several samples, by any sampler and filter: tiles, threads and parts draw the same bytes, and
// integrators and functions get the sampler of their sample.
#include <algorithm>
#include <cmath>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// Sampler of a type that a program brings: its numbers are those of another.
class FixedSampler {
 public:
  explicit FixedSampler(const SampleIndex& at) : numbers_(at) {}
  SampleSet<double> operator()(std::uint32_t set) const { return numbers_(set ^ 0x5555); }

 private:
  HaltonSampler numbers_;
};

/// Integrator that returns white where a ray in a random direction around the normal meets nothing, in the
/// colors of the surface; for rays, and for packets if it is told so.
template <bool by_packets>
struct Occlusion : FirstHit<Occlusion<by_packets>> {
  using TakesPackets = std::conditional_t<by_packets, Occlusion, void>;

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene, const auto& sampler) const {
    const auto [a, b, c, d] = sampler(1);
    const auto normal = hit.facing_normal();
    auto towards = normal;
    towards.x = 1.5 * a - 0.75, towards.y = 1.5 * b - 0.75, towards.z = 1.5 * c - 0.75;
    const auto hidden = scene.occluded(hit.leave(normal + towards), Interval{});
    return select(hidden, typename Hit::Light(Color{0}), hit.color() * to_float(d + 0.5));
  }
};

/// Integrator of rays that may be packets, which makes a color of the numbers of a set.
struct SampleNumbers {
  using TakesPackets = SampleNumbers;

  template <class R>
  [[nodiscard]] typename R::Light radiance(const R&, const auto&, const auto& sampler) const {
    const auto [a, b, c, d] = sampler(7);
    static_cast<void>(d);
    return typename R::Light(to_float(a), to_float(b), to_float(c));
  }
};

using Things = Scene<Sphere, Plane, Mesh>;

Things things() {
  Things scene;
  Material checkered;
  checkered.texture = Checker{.first = Color{1}, .second = Color{0.1f}, .size = 0.1};
  scene.add(Sphere{.center = {-1, 0.3, 4}, .radius = 0.8}, checkered);
  scene.add(Sphere{.center = {0.2, -0.5, 3}, .radius = 0.5},
            Material{.diffuse = Color{0.3f, 0.1f, 0.7f}, .reflect = 0.4, .refract = 0.3, .ior = 1.4});
  for (int i = 0; i < 6; ++i)
    scene.add(Sphere{.center = {i - 2.5, 1.4, 5}, .radius = 0.4},
              Color{0.1f * static_cast<float>(i), 0.6f, 1});
  MeshData torus = meshes::moved(meshes::torus(20, 10), 0.7, {1.1, 0.2, 4});
  scene.add(Mesh(torus, {.threads = 1}), Color{0.2f, 0.7f, 0.3f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});
  scene.set_sky(Color{0.3f, 0.5f, 0.7f});
  return scene;
}

const std::vector<SamplerChoice>& all_samplers() {
  static const std::vector<SamplerChoice> all = [] {
    std::vector<SamplerChoice> choices{sampler_of<FixedSampler>};
    for (const auto name : sampler_names) choices.push_back(*sampler_named(name));
    return choices;
  }();
  return all;
}

const std::vector<ReconstructionFilter>& all_filters() {
  static const std::vector<ReconstructionFilter> all = [] {
    std::vector<ReconstructionFilter> filters{ReconstructionFilter::gaussian(7, 3)};
    for (const auto name : ReconstructionFilter::names) filters.push_back(ReconstructionFilter::named(name));
    return filters;
  }();
  return all;
}

/// Returns the number of bytes in which a picture by tiles differs from that ray by ray.
int drawn_otherwise(const auto& scene, const Camera& camera, const auto& integrator, RenderOptions options,
                    int width = 45, int height = 37) {
  Image plain(width, height), tiles(width, height);
  options.tiles = false;
  render(plain, camera, scene, integrator, options);
  options.tiles = true;
  render(tiles, camera, scene, integrator, options);
  return different_bytes(plain, tiles);
}

}  // namespace

TEST_CASE("by tiles, pictures by any sampler and filter have the bytes of those ray by ray") {
  const Things scene = things();
  const Vec3 ahead{0, 0, 1}, up{0, 1, 0};
  const Camera cameras[] = {Camera{}, Camera::sensor(Point{0}, ahead, up, 0.5),
                            Camera::orthographic(Point{0}, ahead, up, 3),
                            Camera{.right = {1, 0.5, 0}, .up = {0.2, -1, 0}, .forward = {0.3, 0, 1.2}},
                            Camera{.film_right = {0.1, 0, 0.05}, .film_up = {0, 0.2, 0}}};
  std::size_t round = 0;
  for (std::size_t s = 0; s < all_samplers().size(); ++s)
    for (std::size_t f = 0; f < all_filters().size(); ++f) {
      const int samples = std::vector{1, 2, 3, 5}[round % 4];
      const RenderOptions options{.samples = samples,
                                  .sampler = all_samplers()[s],
                                  .filter = all_filters()[f],
                                  .seed = round,
                                  .threads = 2};
      const Camera& camera = cameras[round % std::size(cameras)];
      CAPTURE(s, f, samples, round % std::size(cameras));
      ++round;
      CHECK(drawn_otherwise(scene, camera, ColorIntegrator{}, options) == 0);
      CHECK(drawn_otherwise(scene, camera, NormalIntegrator{}, options) == 0);
      CHECK(drawn_otherwise(scene, camera, TransparencyIntegrator{}, options) == 0);
      CHECK(drawn_otherwise(scene, camera, WhittedIntegrator{.depth = 3}, options) == 0);
      CHECK(drawn_otherwise(scene, camera, Occlusion<true>{}, options) == 0);
      CHECK(drawn_otherwise(scene, camera, Occlusion<false>{}, options) == 0);
      CHECK(drawn_otherwise(scene, camera, SampleNumbers{}, options) == 0);
    }
}

TEST_CASE("pictures by samplers are the same for any number of threads, and a part has the whole's bytes") {
  const Things scene = things();
  for (const SamplerChoice& sampler : all_samplers())
    for (const bool tiles : {false, true}) {
      const RenderOptions options{.samples = 2,
                                  .sampler = sampler,
                                  .filter = ReconstructionFilter::gaussian(),
                                  .seed = 3,
                                  .threads = 1,
                                  .tiles = tiles};
      Image whole(45, 37), again(45, 37), part(20, 23);
      render(whole, Camera{}, scene, Occlusion<true>{}, options);
      RenderOptions other = options;
      other.threads = 3;
      render(again, Camera{}, scene, Occlusion<true>{}, other);
      CHECK(different_bytes(whole, again) == 0);
      other.crop = {.x = 19, .y = 9, .width = 45, .height = 37};
      render(part, Camera{}, scene, Occlusion<true>{}, other);
      Image expected(20, 23);
      for (int y = 0; y < 23; ++y)
        for (int x = 0; x < 20; ++x) expected(x, y) = whole(19 + x, 9 + y);
      CHECK(different_bytes(part, expected) == 0);
      other = options;
      ++other.seed;
      render(again, Camera{}, scene, Occlusion<true>{}, other);
      CHECK(different_bytes(whole, again) > 100);
    }
}

TEST_CASE("a function of a ray and a sampler gets the pixel, the sample and the numbers of the sampler") {
  Image image(6, 4);
  const RenderOptions options{.samples = 3,
                              .sampler = sampler_of<HaltonSampler>,
                              .seed = 11,
                              .crop = {.x = 5, .y = 7, .width = 20, .height = 11}};
  render(
      image, Camera{},
      [](const Ray&, const PixelSampler& sampler) {
        const SampleIndex& at = sampler.index();
        REQUIRE((at.seed == 11 && at.samples == 3 && at.sample < 3));
        CHECK(sampler(2) == HaltonSampler(at)(2));
        return Color(static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.sample));
      },
      [&] {
        RenderOptions one = options;
        one.threads = 1;  // CHECK is for one thread
        return one;
      }());
  CHECK(image(0, 0) == Color{5, 7, 1});
  CHECK(image(5, 3) == Color{10, 10, 1});
}

TEST_CASE("integrators that take a sampler get Sobol's, others have Hammersley's places") {
  const auto scene = things();
  const auto by_sampler = [](const Ray&, const auto&, const auto& sampler) {
    return Color(static_cast<float>(sampler(1)[2]));
  };
  Image by_default(9, 8), by_sobol(9, 8);
  render(by_default, Camera{}, scene, by_sampler, {.samples = 2});
  render(by_sobol, Camera{}, scene, by_sampler, {.samples = 2, .sampler = sampler_of<SobolSampler>});
  CHECK(different_bytes(by_default, by_sobol) == 0);
  render(by_default, Camera{}, scene, ShadowIntegrator{}, {.samples = 2});
  render(by_sobol, Camera{}, scene, ShadowIntegrator{},
         {.samples = 2, .sampler = sampler_of<HammersleySampler>});
  CHECK(different_bytes(by_default, by_sobol) == 0);
}

TEST_CASE(
    "a picture of one light stays as it is by any filter whose weights are alike, and by fixed places") {
  const auto constant = [](const Ray&) { return Color{0.3f, 7, 1e-3f}; };
  for (const SamplerChoice& sampler : all_samplers())
    for (const ReconstructionFilter& filter : all_filters()) {
      if (filter.has_weights() && !sampler.has_common_places()) continue;
      Image image(5, 4);
      render(image, Camera{}, constant, {.samples = 16, .sampler = sampler, .filter = filter});
      const Color off = abs(image(3, 2) - Color{0.3f, 7, 1e-3f}) / Color{0.3f, 7, 1e-3f};
      // Weights are rounded to float, and so is their product with a light: 2^-23, and 2^-24 for the mean.
      CHECK(std::max({off.r, off.g, off.b}) <= (filter.has_weights() ? 0x1p-22f : 0));
    }
}

TEST_CASE("a wide filter reaches over the edge of a pixel as far as its radius") {
  // Light is 1 to the right of the middle of the picture, where u > 0.
  const auto step = [](const Ray& ray) { return Color(ray.direction.x > 0 ? 1.0f : 0.0f); };
  for (const SamplerChoice& sampler : all_samplers()) {
    Image image(12, 4);
    render(image, Camera{}, step,
           {.samples = 256, .sampler = sampler, .filter = ReconstructionFilter::tent(2)});
    // Centers are ½, 3/2 and 5/2 from the step; the tent has (2 − d)²/8 of its area beyond d.
    CHECK(std::abs(image(5, 1).r - 0.28125f) < 0.1f);
    CHECK(std::abs(image(4, 1).r - 0.03125f) < 0.05f);
    CHECK(image(3, 1).r == 0);
    CHECK(image(8, 1).r == 1);
  }
}
