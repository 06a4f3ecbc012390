// Tests which pixels are covered by triangles in front of the eye (accel/triangles_in_front.hpp).
#include <protostar/accel/triangles_in_front.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/random.hpp"

using namespace protostar;
using namespace protostar::simd;

namespace {

/// Tile of a picture, with the positions at which points are seen, relative to its first pixel.
struct View {
  Camera camera;
  int width, height;
  Tile tile;
  PixelRays rays;
  Screen screen;

  View(const Camera& of, int columns, int rows, const Tile& part)
      : camera(of),
        width(columns),
        height(rows),
        tile(part),
        rays(camera, PixelGrid(width, height, {}), width, height),
        screen(rays, 0, tile, BoxSpace(Bounds{camera.position - Vec3{4}, camera.position + Vec3{4}})) {}

  [[nodiscard]] glm::dvec2 place(const Point& p) const {
    const Vec3 v = p - camera.position;
    const double z = dot(v, screen.ahead);
    return {dot(v, screen.across) / z - screen.left, dot(v, screen.down) / z - screen.top};
  }

  /// Returns the point that is seen at a position, at the given distance along the middle ray.
  [[nodiscard]] Point at(const glm::dvec2& place, double distance) const {
    const Ray first = camera.through_pixel(tile.x0, tile.y0, width, height),
              right = camera.through_pixel(tile.x0 + 1, tile.y0, width, height),
              below = camera.through_pixel(tile.x0, tile.y0 + 1, width, height);
    const auto ahead = [&](const Ray& ray) { return ray.direction / dot(ray.direction, camera.forward); };
    return camera.position + distance * (ahead(first) + place.x * (ahead(right) - ahead(first)) +
                                         place.y * (ahead(below) - ahead(first)));
  }
};

View random_view(Random& random) {
  const int width = 1 + static_cast<int>(random.bits() % 120),
            height = 1 + static_cast<int>(random.bits() % 90),
            x = static_cast<int>(random.bits() % static_cast<unsigned>(width)),
            y = static_cast<int>(random.bits() % static_cast<unsigned>(height));
  const Point eye = random.point(3);
  return View(
      Camera::look_at(eye, eye + random.direction(), random.direction(), std::exp2(random.real(0, 7))), width,
      height, {x, y, std::min(width, x + 64), std::min(height, y + 64)});
}

/// Returns one triangle, repeated in all lanes.
std::array<Vectors, 3> everywhere(const Point& a, const Point& b, const Point& c) {
  return {Vectors(a), Vectors(b), Vectors(c)};
}

}  // namespace

TEST_CASE("edge functions of triangles in front keep their error bound, and the bound is not too large") {
  Random random(61);
  int wrong = 0, known = 0;
  float largest = 0;
  for (int i = 0; i < 20'000; ++i) {
    const View view = random_view(random);
    if (!view.screen.usable) continue;
    const double size = std::exp2(random.real(-9, 6));
    const glm::dvec2 middle{random.real(0, view.tile.width()), random.real(0, view.tile.height())};
    Point corners[3];
    for (Point& corner : corners)
      corner = view.at(middle + size * glm::dvec2{random.real(-1, 1), random.real(-1, 1)}, random.real(1, 3));
    const TrianglesInFront triangles(TrianglesInFront::Places(view.screen),
                                     everywhere(corners[0], corners[1], corners[2]));
    if ((triangles.known & triangles.in_tile & 1) == 0) continue;
    ++known;
    const int x0 = triangles.x0[0], y0 = triangles.y0[0];
    const int x = static_cast<int>(random.bits() % static_cast<unsigned>(triangles.x1[0] - x0)),
              y = static_cast<int>(random.bits() % static_cast<unsigned>(triangles.y1[0] - y0));
    bool as_they_are = true, turned = true;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 from = view.place(corners[k]), to = view.place(corners[(k + 1) % 3]),
                       pixel{x0 + x, y0 + y};
      const double side = (to.x - from.x) * (pixel.y - from.y) - (to.y - from.y) * (pixel.x - from.x);
      const auto& [of_x, of_y, one] = triangles.sides[k];
      const float told = of_x[0] * static_cast<float>(x) + (of_y[0] * static_cast<float>(y) + one[0]);
      const auto off = static_cast<float>(std::abs(std::abs(side) - std::abs(static_cast<double>(told))));
      wrong += !(off < triangles.error[0]);
      largest = std::max(largest, off / triangles.error[0]);
      if (std::abs(told) < triangles.error[0]) continue;
      as_they_are = as_they_are && (side > 0) == (told > 0);
      turned = turned && (side > 0) != (told > 0);
    }
    wrong += !as_they_are && !turned;
  }
  CHECK(known > 5'000);
  CHECK(wrong == 0);
  CHECK(largest > 0.01f);
}

TEST_CASE("small triangles in one block cover the same pixels together and one by one") {
  Random random(62);
  int wrong = 0, together = 0, alone = 0, covered = 0, beyond = 0;
  for (int i = 0; i < 5'000; ++i) {
    const View view = random_view(random);
    if (!view.screen.usable) continue;
    const TrianglesInFront::Places places(view.screen);
    std::array<Vectors, 3> corners;
    const glm::dvec2 all{random.real(0, view.tile.width()), random.real(0, view.tile.height())};
    const double spread = random.real(0, 6);
    for (int lane = 0; lane < double_lanes; ++lane) {
      const glm::dvec2 middle = all + spread * glm::dvec2{random.real(-1, 1), random.real(-1, 1)};
      for (Vectors& corner : corners) {
        const Point p =
            view.at(middle + glm::dvec2{random.real(-2, 2), random.real(-2, 2)}, random.real(1, 3));
        corner.x.set(lane, p.x), corner.y.set(lane, p.y), corner.z.set(lane, p.z);
      }
    }
    const TrianglesInFront triangles(places, corners);
    const Bits some = triangles.known & triangles.in_tile;
    const auto block = triangles.small_in_one_block(some);
    wrong += (block.triangles & ~some) != 0 || (block.surely & ~block.maybe) != 0;

    // The block begins at the first column and row of all small triangles, and holds those that fit into it.
    constexpr int side = TrianglesInFront::Covered::side;
    Bits small = 0;
    int first_x = 1000, first_y = 1000;
    for (Bits left = some; left != 0; left &= left - 1) {
      const int one = std::countr_zero(left);
      if (triangles.x1[one] - triangles.x0[one] > 4 || triangles.y1[one] - triangles.y0[one] > 4) continue;
      small |= Bits{1} << one;
      first_x = std::min<int>(first_x, triangles.x0[one]),
      first_y = std::min<int>(first_y, triangles.y0[one]);
    }
    if (small == 0) {
      wrong += block.triangles != 0 || block.maybe != 0;
      continue;
    }
    wrong += block.x != first_x || block.y != first_y;
    std::uint64_t surely_alone = 0, maybe_alone = 0;
    const auto put = [&](int x, int y, Bits pixels, std::uint64_t& to) {
      for (; pixels != 0; pixels &= pixels - 1) {
        const int k = std::countr_zero(pixels), column = x + k % PixelBlock::width - first_x,
                  row = y + k / PixelBlock::width - first_y;
        if (column < side && row < side) to |= std::uint64_t{1} << (side * row + column);
      }
    };
    for (; small != 0; small &= small - 1) {
      const int one = std::countr_zero(small);
      const bool fits = triangles.x1[one] <= first_x + side && triangles.y1[one] <= first_y + side;
      wrong += ((block.triangles >> one & 1) != 0) != fits;
      ++(fits ? together : alone);
      if (fits)
        triangles.each_block(one, [&](int x, int y, Bits sure, Bits may) {
          put(x, y, sure, surely_alone), put(x, y, may, maybe_alone);
        });
    }
    // Horizontally, only pixels inside the tile are reported as covered.
    std::uint64_t in_columns = 0, in_tile = 0;
    for (int row = 0; row < side; ++row) {
      in_columns |= std::uint64_t{first_bits(std::min(side, view.tile.width() - first_x))} << side * row;
      if (first_y + row < view.tile.height()) in_tile = in_columns;
    }
    wrong += (block.surely & in_tile & ~maybe_alone) != 0 || (surely_alone & in_tile & ~block.maybe) != 0 ||
             (block.maybe & ~in_columns) != 0;
    covered += std::popcount(block.surely);
    beyond += (surely_alone & ~in_columns) != 0;
  }
  CHECK(together > 3'000);
  CHECK((double_lanes == 1 || alone > 30));
  CHECK(covered > 3'000);
  CHECK((PixelBlock::width == 1 || beyond > 30));
  CHECK(wrong == 0);
}

TEST_CASE("corners are near if they are in front, and no more than seven times half a tile beside it") {
  const Camera camera;
  const View view(camera, 64, 64, {0, 0, 64, 64});
  const TrianglesInFront::Places places(view.screen);
  const auto is_near = [](const TrianglesInFront::Places& of, const Point& p) {
    return (bits(of(Vectors(p)).is_near) & 1) != 0;
  };
  const double most = 7 * view.screen.reach;
  for (const double distance : {1e-3, 1.0, 3.0}) {
    CHECK(is_near(places, view.at({3, 5}, distance)));
    CHECK(!is_near(places, view.at({3, 5}, -distance)));
    for (const double sign : {-1.0, 1.0}) {
      CHECK(is_near(places, view.at({0.99 * sign * most, 5}, distance)));
      CHECK(!is_near(places, view.at({1.01 * sign * most, 5}, distance)));
      CHECK(is_near(places, view.at({3, 0.99 * sign * most}, distance)));
      CHECK(!is_near(places, view.at({3, 1.01 * sign * most}, distance)));
    }
  }
  CHECK(!is_near(places, camera.position));
  CHECK(!is_near(places, Point{std::numeric_limits<double>::quiet_NaN(), 0, 1}));
  // Nothing is known of a triangle whose corners are not all near, so it may be in the tile.
  const TrianglesInFront behind(places,
                                everywhere(view.at({3, 5}, 1), view.at({9, 5}, 1), view.at({3, 9}, -1)));
  CHECK(behind.known == 0);
  CHECK(behind.in_tile == first_bits(double_lanes));
  // No corner is near if directions are less accurate than the size of a pixel.
  Camera narrow;
  narrow.right *= 0x1p-22, narrow.up *= 0x1p-22;
  const View far(narrow, 64, 64, {0, 0, 64, 64});
  REQUIRE(far.screen.usable);
  CHECK(!is_near(TrianglesInFront::Places(far.screen), narrow.position + narrow.forward));
}
