// Pictures by a camera with a lens.
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/lens_scene.hpp"
#include "support/light_truth.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

TEST_CASE("by tiles, pictures of a lens have the bytes of those ray by ray, for any sampler and filter") {
  Random random(3);
  const Vec3 up{0, 1, 0};
  const std::vector<Camera> cameras{
      Camera::thin_lens({0, 0, 0}, {0, 0, 1}, up, 60, 0.1, 3),
      Camera::thin_lens({0, 0.5, -3}, {0, 0, 1}, up, 90, 1, 5),
      Camera::look_at_right_handed({2, 1, -2}, {0, 0, 4}, up, 40).with_lens(0.5, 0.7),
      skewed_camera_with_lens(random),
      skewed_camera_with_lens(random),
      skewed_camera_with_lens(random)};
  std::size_t round = 0;
  for (const int count : {12, 300, 2500}) {
    if (count > cases(12, 2500, 2500)) continue;
    const LensScene scene = balls_at_all_depths(count);
    for (const auto sampler : sampler_names)
      for (const auto filter : ReconstructionFilter::names) {
        if (count == 2500 && round % 4 != 0 && ++round) continue;
        const Camera& camera = cameras[round % cameras.size()];
        RenderOptions options{.samples = std::vector{1, 2, 3}[round % 3],
                              .sampler = *sampler_named(sampler),
                              .filter = ReconstructionFilter::named(filter),
                              .seed = round,
                              .threads = 2};
        if (round % 5 == 0) options.crop = {.x = 7, .y = 3, .width = 60, .height = 50};
        CAPTURE(count, sampler, filter, round % cameras.size());
        ++round;
        const auto differ = [&](const auto& integrator) {
          Image plain(45, 37), tiles(45, 37);
          options.tiles = false;
          render(plain, camera, scene, integrator, options);
          options.tiles = true;
          render(tiles, camera, scene, integrator, options);
          return different_pixels(plain, tiles);
        };
        CHECK(differ(NormalIntegrator{}) == 0);
        CHECK(differ(ColorIntegrator{}) == 0);
        if (count == 12) {
          CHECK(differ(TransparencyIntegrator{}) == 0);
          CHECK(differ(WhittedIntegrator{.depth = 3}) == 0);
          CHECK(differ([](const Ray& ray, const auto& in) {
                  const auto hit = in.intersect(ray, Interval{});
                  return Color(hit ? static_cast<float>(hit->t) : 0.0f);
                }) == 0);
        }
      }
  }
}

TEST_CASE("an edge out of focus fades as the disk's segment beyond it, pixel by pixel") {
  // A pixel at u sees of the plane z = d, from the lens point x, the place u d + x (1 − d/s). Beyond the edge
  // at e are the points of the unit disk beyond c = (e − u d)/(r |1 − d/s|), of which the share is the
  // segment's (arccos c − c √(1 − c²))/π; its mean over a pixel is the difference of the integral G.
  const auto integral = [](double c) {
    if (c >= 1) return 0.0;
    if (c <= -1) return c;
    const double root = std::sqrt(1 - c * c);
    return (c * std::acos(c) - root + root * root * root / 3) / std::numbers::pi;
  };
  constexpr int width = 32, height = 4, samples = PROTOSTAR_LONG_FORMS ? 1024 : 32;
  struct {
    double depth, focus, aperture, edge;
  } const rows[] = {{2, 1, 4, 1}, {1, 2, 4, 0.5}, {3, 2, 6, -0.75}};
  for (const auto& row : rows)
    for (const SamplerChoice& sampler :
         {sampler_of<SobolSampler>, sampler_of<HaltonSampler>, sampler_of<StratifiedSampler>}) {
      CAPTURE(row.depth, row.focus, row.aperture);
      Scene<Parallelogram> scene;
      scene.add(Parallelogram{{row.edge, -1000, row.depth}, {1000, 0, 0}, {0, 2000, 0}}, Color{1});
      const Camera camera = Camera::thin_lens({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 90, row.aperture, row.focus);
      std::vector<Image> pictures;
      for (int r = 0; r < LightTruth::scramblings; ++r) {
        pictures.emplace_back(width, height);
        render(pictures.back(), camera, scene, ColorIntegrator{},
               {.samples = samples, .sampler = sampler, .seed = static_cast<std::uint64_t>(r)});
      }
      LightTruth truth;
      const double radius = row.aperture * std::abs(1 - row.depth / row.focus);
      for (int x = 0; x < width; ++x) {
        const auto place = [&](int column) {
          return (row.edge - Camera::u_at(column, width, height) * row.depth) / radius;
        };
        const double from = place(x + 1), to = place(x);
        for (int y = 0; y < height; ++y) {
          std::vector<double> means;
          for (const Image& picture : pictures) means.push_back(picture(x, y).g);
          const double share = integral(to) - integral(from);
          truth.compare(means, share / (to - from), "pixel", x, y);
        }
      }
      CHECK(truth.wrong == 0);
      CHECK(truth.lit > width / 2);
      CHECK(std::abs(truth.mean_error) <=
            LightTruth::most_errors * std::sqrt(truth.variance) + 0x1p-20 * truth.mean_truth);
      CHECK(truth.detectable_bias() < (PROTOSTAR_LONG_FORMS ? 2e-3 : 0.02));
    }
}
