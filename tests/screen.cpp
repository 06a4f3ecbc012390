// Tests of the positions of boxes on the screen of a tile (accel/screen.hpp).
#include <limits>
#include <protostar/accel/pixel_rays.hpp>
#include <protostar/accel/screen.hpp>
#include <protostar/pixel_grid.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("PixelsBetween holds the pixels whose centers are between two positions, and hardly any more") {
  constexpr int N = 4;
  using Places = simd::Lanes<float, N>;
  Random random(71);
  int found = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20'000; ++i) {
    const int count = 1 + static_cast<int>(random.bits() % 64);
    const auto place = [&] {
      const double x = random.real(-2, count + 2);
      return static_cast<float>(i % 3 == 0 ? std::round(x) : x);  // or exactly at a center
    };
    float a = place(), b = i % 7 == 0 ? a + 0.2f : place();
    if (b < a) std::swap(a, b);
    const simd::PixelsBetween<N> pixels(Places{a}, Places{b}, count);
    const bool any = (simd::bits(pixels.any) & 1) != 0;
    for (int x = 0; x < count; ++x) {
      const bool is_between = a <= static_cast<float>(x) && static_cast<float>(x) <= b;
      const bool is_near = a - 0.002f < static_cast<float>(x) && static_cast<float>(x) < b + 0.002f;
      const bool is_told = any && pixels.first[0] <= x && x < pixels.end[0];
      wrong.add((is_between && !is_told) || (is_told && !is_near), a, b, "pixel", x);
      found += is_told;
    }
    wrong.add(pixels.first[0] < 0 || pixels.end[0] > count, a, b, "of", count);
  }
  CHECK(found > 100'000);
  CHECK(wrong == 0);
  const float inf = std::numeric_limits<float>::infinity();
  const simd::PixelsBetween<N> all(Places{-inf}, Places{inf}, 9), none(Places{inf}, Places{-inf}, 9);
  CHECK((all.first[0] == 0 && all.end[0] == 9 && (simd::bits(all.any) & 1) != 0));
  CHECK(!any(none.any));
  // NaN culls no pixel.
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const simd::PixelsBetween<N> unknown(Places{nan}, Places{nan}, 9);
  CHECK((unknown.first[0] == 0 && unknown.end[0] == 9 && (simd::bits(unknown.any) & 1) != 0));
}

TEST_CASE(
    "points of a box that a pixel sees are in the pixels of the box, and no nearer than its nearest point") {
  Random random(72);
  int in_front = 0, kept = 0, boxes = 0;
  WrongCases wrong(random);
  for (int round = 0; round < 3000; ++round) {
    // Camera near to or far from a world of any size.
    const double size = std::exp2(random.real(-30, 30)),
                 far = std::exp2(random.real(-12, round % 2 ? 3 : 20));
    const Point center = round % 3 == 0 ? size * 100.0 * random.point(1) : Point{0};
    const Bounds world{center - Vec3{size}, center + Vec3{size}};
    const simd::BoxSpace space(world);
    Camera camera =
        Camera::look_at(center + far * size * random.direction(), center + size * random.point(0.3),
                        random.direction(), random.real(1, 120));
    if (round % 5 == 0) camera.right *= 1e-4, camera.up *= 1e-4, camera.forward *= 1e-4;
    const int width = 40 + static_cast<int>(random.bits() % 100), height = 70;
    const RenderOptions options{.samples = 1 + round % 3};
    const simd::PixelRays rays(camera, PixelGrid(width, height, options), width, height);
    const int sample = round % rays.pixels().samples();
    const int x0 = static_cast<int>(random.bits() % 30), y0 = static_cast<int>(random.bits() % 30);
    const Tile tile{x0, y0, std::min(x0 + 64, width), y0 + 1 + static_cast<int>(random.bits() % 40)};
    const simd::Screen screen(rays, sample, tile, space);
    if (!screen.usable) continue;
    // Boxes around points that pixels see, if the boxes are inside the world.
    struct Sight {
      int x, y;
      double k;
    };
    std::vector<Sight> sights;
    simd::Node node;
    for (int k = 0; k < simd::node_width; ++k) {
      const int x = static_cast<int>(random.bits() % static_cast<unsigned>(tile.width())),
                y = static_cast<int>(random.bits() % static_cast<unsigned>(tile.height()));
      const Vec3 direction = rays.pixels().u(x0 + x, rays.pixels().common_place(sample).x) * camera.right +
                             rays.pixels().v(y0 + y, rays.pixels().common_place(sample).y) * camera.up +
                             camera.forward;
      const double t = random.real(0, 2) * std::max(far, 1.0) * size / length(direction);
      const Point p = camera.position + t * direction;
      const double reach = size * std::exp2(random.real(-20, 0));
      Bounds bounds{p, p};  // with the point in a corner, on an edge or inside
      for (int axis = 0; axis < 3; ++axis) {
        if (random.bits() % 3 != 0) bounds.min[axis] -= reach * random.real(0, 1);
        if (random.bits() % 3 != 0) bounds.max[axis] += reach * random.real(0, 1);
      }
      const bool is_inside = glm::all(glm::greaterThanEqual(bounds.min, world.min)) &&
                             glm::all(glm::lessThanEqual(bounds.max, world.max));
      const simd::Box box = is_inside ? space(bounds) : simd::Box::nothing();
      for (int axis = 0; axis < 3; ++axis)
        node.end[0][axis][k] = box.min[axis], node.end[1][axis][k] = box.max[axis];
      sights.push_back({x, y, is_inside ? 1 / (t * space.scale) : 0});
    }
    const simd::BoxesOnScreen on_screen(screen, node);
    for (int k = 0; k < simd::node_width; ++k) {
      const auto [x, y, nearness] = sights[static_cast<std::size_t>(k)];
      const bool is_seen = (on_screen.seen >> k & 1) != 0;
      if (nearness == 0) {
        wrong.add(is_seen, center);
        continue;
      }
      ++boxes;
      const simd::BoxOnScreen box = on_screen[k];
      wrong.add(!is_seen || x < box.x0 || x >= box.x1 || y < box.y0 || y >= box.y1 ||
                    nearness * (1 - 0x1p-40) > static_cast<double>(box.nearest),
                center);
      in_front += (on_screen.in_front >> k & 1) != 0;
      kept += (box.x1 - box.x0) * (box.y1 - box.y0) < tile.width() * tile.height() / 4;
    }
  }
  CAPTURE(boxes, in_front, kept);
  CHECK(boxes > 1000);
  CHECK(in_front > boxes / 2);
  CHECK(kept > boxes / 4);
  CHECK(wrong == 0);
}
