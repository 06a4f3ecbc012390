// The surfaces that float tells the pixels of a tile to see, by their places in its list.
#include <protostar/accel/candidates.hpp>
#include <protostar/accel/frustum.hpp>
#include <protostar/accel/pixel_rays.hpp>
#include <protostar/accel/visibility.hpp>
#include <protostar/pixel_grid.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <vector>

#include "support/candidates.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using simd::Candidates;
using simd::Frustum;
using simd::PixelRays;

TEST_CASE("the places that a tile finds in a list are those of the surfaces that it keeps") {
  Random random(11);
  const PixelRays rays({}, PixelGrid(64, 64), 64, 64);
  std::vector<Sphere> spheres;
  for (int i = 0; i < 200; ++i) spheres.push_back({Point{0, 0, 4} + random.point(3), random.real(0.01, 0.3)});
  const Candidates everything = candidates_of(spheres, rays.viewpoint());
  simd::CandidatePositions places, all;
  for (const Tile& tile : {Tile{0, 0, 64, 64}, Tile{8, 16, 16, 24}, Tile{40, 40, 48, 42}}) {
    Candidates kept;
    kept.add(everything, Frustum(rays, tile));
    everything.find(Frustum(rays, tile), places);
    REQUIRE(places.size() == kept.size());
    for (int i = 0; i < kept.size(); ++i) CHECK(everything.index(places[i]) == kept.index(i));
  }
  all.add_first(everything.size());
  REQUIRE(all.size() == 200);
  for (int i = 0; i < 200; ++i) CHECK(all[i] == i);
}

TEST_CASE("a ray of a block sees first what float tells, or one of the two that it leaves") {
  Random random(12);
  const PixelRays rays({}, PixelGrid(64, 64), 64, 64);
  WrongCases wrong(random);
  int sure = 0, of_two = 0;
  for (int picture = 0; picture < cases(4, 20, 20); ++picture) {
    Scene<Sphere> scene;  // of spheres that overlap, some of them as dense as pixels are
    for (int i = 0; i < 100; ++i)
      scene.add(Sphere{Point{0, 0, 4} + random.point(2), random.real(0.003, i % 2 == 0 ? 0.02 : 0.6)},
                Color{1});
    const auto& spheres = scene.surfaces<Sphere>();
    Candidates list = candidates_of({spheres.begin(), spheres.end()}, rays.viewpoint());
    list.sort(Candidates::Order::near_to_far);
    simd::CandidatePositions places;
    places.add_first(list.size());
    for (int y = 0; y < 64; y += simd::RayBlock::height)
      for (int x = 0; x < 64; x += simd::RayBlock::width)
        for (const bool are_traced_anyway : {false, true}) {
          const auto seen = simd::seen_by(rays.block_directions(x, y), list, places, are_traced_anyway);
          for (int k = 0; k < simd::float_lanes; ++k) {
            if (seen.indices[k] == simd::doubtful_index) continue;
            const Ray ray =
                Camera{}.through_pixel(x + k % simd::RayBlock::width, y + k / simd::RayBlock::width, 64, 64);
            const auto hit = scene.intersect(ray);
            const auto first =
                hit ? static_cast<int>(static_cast<const Sphere*>(hit->surface()) - spheres.data())
                    : simd::no_surface_index;
            const bool is_sure = seen.others[k] == simd::no_surface_index;
            const bool is_told = first == seen.indices[k] || (!is_sure && first == seen.others[k]);
            wrong.add(!is_told, "pixel", x, y, k, "sees", first);
            ++(is_sure ? sure : of_two);
          }
        }
  }
  CHECK(wrong == 0);
  CHECK(sure > cases(2'000, 10'000, 10'000));
  CHECK(of_two > cases(20, 100, 100));
}

TEST_CASE("lists of candidates end with room for the vector of their last surface, and with no more") {
  // The sanitizers see what is read or written behind it: each list here has the memory that it asks for.
  const PixelRays rays(Camera{}, PixelGrid(8, 8), 8, 8);
  const simd::Frustum frustum(rays, {0, 0, 8, 8});
  for (int n = 1; n <= 3 * simd::float_lanes; ++n) {
    const std::vector<Sphere> spheres(static_cast<std::size_t>(n), Sphere{{0, 0, 5}, 1});
    const simd::Candidates all = candidates_of(spheres, rays.viewpoint());
    simd::Candidates seen, seen_again;
    seen.add(all, frustum);
    CHECK(seen.size() == n);
    seen.sort(simd::Candidates::Order::near_to_far);
    seen_again.add(seen, frustum);
    CHECK(seen_again.size() == n);
    simd::CandidatePositions found;
    seen_again.find(frustum, found);
    CHECK(found.size() == n);
  }
}
