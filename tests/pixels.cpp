#include <algorithm>
#include <cmath>
#include <limits>
#include <protostar/camera.hpp>
#include <protostar/integrators/path.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/pixel_grid.hpp>
#include <protostar/render.hpp>
#include <protostar/tone.hpp>
#include <set>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"

using namespace protostar;

namespace {

Image drawn(int width, int height, const auto& integrator, const RenderOptions& options) {
  Image image(width, height);
  render(image, Camera{}, three_spheres(), integrator, options);
  return image;
}

int different(const Image& part, const Image& whole, int x0, int y0) {
  int count = 0;
  for (int y = 0; y < part.height(); ++y)
    for (int x = 0; x < part.width(); ++x) count += part(x, y) != whole(x0 + x, y0 + y);
  return count;
}

/// Returns the places of a pixel's samples.
std::vector<FilteredPlace<double>> places_of(const RenderOptions& options) {
  const PixelGrid pixels(8, 6, options);
  std::vector<FilteredPlace<double>> places;
  for (int i = 0; i < pixels.samples(); ++i) places.push_back(pixels.place(3, 2, i));
  return places;
}

}  // namespace

TEST_CASE("one sample, or none, is the center of the pixel, and has the weight 1") {
  for (const ReconstructionFilter& filter : {ReconstructionFilter{}, ReconstructionFilter::mitchell()})
    for (const int n : {0, 1}) {
      const auto samples = places_of({.samples = n, .filter = filter});
      REQUIRE(samples.size() == 1);
      CHECK((samples[0].x == 0.5 && samples[0].y == 0.5 && samples[0].weight == 1));
    }
}

TEST_CASE("n samples have one in the middle of each of n columns and of each of n rows") {
  for (int n = 2; n < 70; ++n) {
    const auto samples = places_of({.samples = n});
    REQUIRE(samples.size() == static_cast<std::size_t>(n));
    std::set<double> rows;
    for (int i = 0; i < n; ++i) {
      CHECK(samples[static_cast<std::size_t>(i)].x == (i + 0.5) / n);
      rows.insert(samples[static_cast<std::size_t>(i)].y);
    }
    std::set<double> middles;
    for (int i = 0; i < n; ++i) middles.insert((i + 0.5) / n);
    CHECK(rows == middles);
  }
}

TEST_CASE("four samples are the Hammersley points") {
  const auto samples = places_of({.samples = 4});
  const double rows[] = {0.125, 0.625, 0.375, 0.875};
  for (std::size_t i = 0; i < 4; ++i) CHECK(samples[i].y == rows[i]);
}

TEST_CASE("a pixel is the mean of its samples, by tiles and ray by ray") {
  const auto scene = three_spheres();
  const Image by_tiles = drawn(48, 36, ShadowIntegrator{}, {.samples = 5});
  CHECK(different(drawn(48, 36, ShadowIntegrator{}, {.samples = 5, .tiles = false}), by_tiles, 0, 0) == 0);
  CHECK(different(drawn(48, 36, ShadowIntegrator{}, {}), by_tiles, 0, 0) > 100);
  const auto samples = places_of({.samples = 5});
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 48; ++x) {
      Color sum{0};
      for (const auto& [dx, dy, weight] : samples)
        sum += static_cast<float>(weight) *
               ShadowIntegrator{}.radiance(Camera{}(Camera::u_at(x + dx, 48, 36), Camera::v_at(y + dy, 36)),
                                           scene);
      const Color difference = abs(by_tiles(x, y) - sum / 5.0f);
      REQUIRE(std::max({difference.r, difference.g, difference.b}) <
              1e-5f);  // roundings of these sums, below 10
    }
}

TEST_CASE("a lamp of 1e9 is as bright by several samples as by one, after any exposure") {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1.5}, Material{.emission = Color{1e9f, 2e9f, 1.5f}});
  const auto by_samples = [&](int samples, bool tiles, const auto& integrator) {
    Image image(33, 25);
    render(image, Camera{}, scene, integrator, {.samples = samples, .threads = 1, .tiles = tiles});
    expose(image, 0x1p-31);
    return image;
  };
  const auto compare = [&](const auto& integrator) {
    for (const bool tiles : {true, false}) {
      const Image one = by_samples(1, tiles, integrator), several = by_samples(16, tiles, integrator);
      int inside = 0, edges = 0;
      for (int y = 0; y < one.height(); ++y)
        for (int x = 0; x < one.width(); ++x) {
          const Color lamp = one(16, 12);
          const float seen = std::round(several(x, y).r / lamp.r * 16);  // by so many of 16 samples
          CHECK(several(x, y) == lamp * (seen / 16));
          if (seen == 16) CHECK(one(x, y) == lamp);
          inside += seen == 16;
          edges += seen > 0 && seen < 16;
        }
      CHECK(inside > 100);
      CHECK(edges > 20);
    }
  };
  compare(WhittedIntegrator{});  // in packets
  compare(PathIntegrator(scene));
}

TEST_CASE("a cropped image has the pixels of the whole picture") {
  for (const int samples : {0, 3})
    for (const bool tiles : {false, true}) {
      const Image whole = drawn(101, 67, ShadowIntegrator{}, {.samples = samples, .tiles = tiles});
      const RenderOptions options{
          .samples = samples, .crop = {.x = 37, .y = 20, .width = 101, .height = 67}, .tiles = tiles};
      CHECK(different(drawn(30, 41, ShadowIntegrator{}, options), whole, 37, 20) == 0);
      CHECK(different(drawn(30, 41, WhittedIntegrator{}, options),
                      drawn(101, 67, WhittedIntegrator{}, {.samples = samples}), 37, 20) == 0);
    }
}

TEST_CASE("columns and rows behind the end of the largest picture follow those before it") {
  constexpr int most = std::numeric_limits<int>::max();
  const PixelGrid pixels(8, 4, {.crop = {most - 8, most - 4, most, most}});
  CHECK(pixels.u(9, 0.5) == pixels.u(7, 2.5));
  CHECK(pixels.v(5, 0.5) == pixels.v(3, 2.5));
  CHECK(pixels.u(9, simd::Doubles(0.5))[0] == pixels.u(7, 2.5));
  CHECK(pixels.v(5, simd::Doubles(0.5))[0] == pixels.v(3, 2.5));
}

TEST_CASE("a crop that does not contain the image and numbers of samples beyond the limits are refused") {
  Image image(8, 6);
  const auto refused = [&](const RenderOptions& options) {
    CHECK_THROWS_AS(render(image, Camera{}, three_spheres(), ShadowIntegrator{}, options),
                    std::invalid_argument);
    CHECK_THROWS_AS(render(
                        image, Camera{}, [](const Ray&) { return Color{1}; }, options),
                    std::invalid_argument);
  };
  refused({.samples = -1});
  refused({.samples = 1 << 22});
  refused({.crop = {.x = 1, .y = 0, .width = 8, .height = 6}});
  refused({.crop = {.x = 0, .y = 1, .width = 8, .height = 6}});
  refused({.crop = {.x = -1, .y = 0, .width = 20, .height = 20}});
  refused({.crop = {.x = 2147483647, .y = 0, .width = 20, .height = 20}});
  refused({.crop = {.x = 0, .y = 0, .width = 8, .height = 0}});
  refused({.crop = {.x = 1}});
}
