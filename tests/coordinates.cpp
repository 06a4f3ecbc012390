#include <cmath>
#include <numbers>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/coordinates.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>

#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/errors.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"

using namespace protostar;

TEST_CASE("on a sphere u is the longitude, ½ towards z, and v the angle from the top over π") {
  struct {
    Vec3 direction;
    Uv uv;
  } const rows[] = {
      {{0, 0, 1}, {0.5, 0.5}},    {{1, 0, 0}, {0.75, 0.5}},    {{-1, 0, 0}, {0.25, 0.5}},
      {{1e-17, 0, -1}, {1, 0.5}}, {{-1e-17, 0, -1}, {0, 0.5}}, {{0, 1, 0}, {0.5, 0}},
      {{0, -1, 0}, {0.5, 1}},     {{1, 0, 1}, {0.625, 0.5}},   {{-1, 0, -1}, {0.125, 0.5}},
      {{0, 1, 1}, {0.5, 0.25}},   {{0, -1, 1}, {0.5, 0.75}},   {{1, -1, -1}, {0.875, 0.69591327601530384}},
  };
  constexpr double u = 0x1p-53, pi = std::numbers::pi;
  for (const auto& [direction, uv] : rows) {
    CAPTURE(direction.x, direction.y, direction.z);
    const Vec3 unit = normalize(direction);
    CHECK(direction_uv(unit).x == uv.x);  // angles of axes and diagonals are exact
    // On an axis v is exact. Elsewhere the cosine is off by 2u of itself, the angle by that times the
    // cotangent and by 2.04u (trigonometry.hpp), π by 0.35u of itself, the quotient and the expected number
    // by 0.5u.
    const bool is_exact = direction.y == 0 || unit.y == direction.y;
    CHECK(std::abs(direction_uv(unit).y - uv.y) <= (is_exact ? 0 : (2 + 2.04) / pi + 0.35 * 0.75 + 1) * u);
    const Sphere sphere{.center = {4, -2, 8}, .radius = length(direction)},
        inverted{sphere.center, -sphere.radius};
    const Point point = sphere.center + direction;
    if (std::abs(direction.x) != 1e-17) {  // the sum would lose 1e-17
      CHECK(sphere.uv_at(point) == direction_uv(unit));
      CHECK(sphere.uv_at(point) == inverted.uv_at(point));
    }
  }
}

TEST_CASE("u and v of a direction agree with the mathematical formula") {
  if (!long_double_judges()) return;
  // Angles up to π are off by 2.04u (trigonometry.hpp), and π by 0.35u of itself; v and the sum ½ + … are
  // rounded by 0.5u, and the quotient in it by 0.25u.
  constexpr double u = 0x1p-53, pi = std::numbers::pi;
  constexpr double most_u = 2.04 / (2 * pi) + 0.35 / 2 + 0.5 + 0.25, most_v = 2.04 / pi + 0.35 + 0.5;
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random.direction();
    const long double x = n.x, y = n.y, z = n.z, true_pi = std::numbers::pi_v<long double>;
    CHECK(std::abs(direction_uv(n).x - (0.5L + std::atan2(x, z) / (2 * true_pi))) <= most_u * u);
    CHECK(std::abs(direction_uv(n).y - std::acos(y) / true_pi) <= most_v * u);
  }
}

TEST_CASE("on a plane u and v are lengths from its point nearest to the coordinate origin") {
  struct {
    Plane plane;
    Point foot;
    Vec3 e1, e2;  // e1 along a × n, e2 along n × e1, where a is the axis of n's smallest component
  } const rows[] = {
      {{{0, 1, 0}, -1}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}},
      {{{0, 3, 0}, -3}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}},
      {{{0, -1, 0}, 1}, {0, -1, 0}, {0, 0, -1}, {1, 0, 0}},
      {{{0, 0, 1}, 5}, {0, 0, 5}, {0, -1, 0}, {1, 0, 0}},
      {{{1, 0, 0}, 2}, {2, 0, 0}, {0, 0, -1}, {0, 1, 0}},  // y is the first of the smallest components
      {{{1, 1, 0}, 0}, {0, 0, 0}, {-1, 1, 0}, {0, 0, 1}},
      {{{0, 1, 1}, 7}, {0, 3.5, 3.5}, {0, -1, 1}, {1, 0, 0}},
      {{{1, 1, 1}, 3}, {1, 1, 1}, {0, -1, 1}, {2, -1, -1}},
      {{{-3, 1, 2}, 14}, {-3, 1, 2}, {2, 0, 3}, {3, 13, -2}},
  };
  // The normal is off by 5.5u, for a quotient and normalize (camera.cpp). Its scale is lost in e1, but for
  // 2u of components that are each rounded twice, and normalize rounds again: 6.5u. A cross product adds up
  // the errors of both and rounds by 2√2 u: e2 is off by 14.9u. A dot product rounds by 3u, and the expected
  // length by 1.5u.
  constexpr double u = 0x1p-53;
  for (const auto& [plane, foot, e1, e2] : rows)
    for (const Uv& at : {Uv{0, 0}, Uv{1, 0}, Uv{0, 1}, Uv{2, -3}}) {
      CAPTURE(plane.normal.x, plane.normal.y, plane.normal.z, at.x, at.y);
      const Point p = foot + at.x * e1 + at.y * e2;
      const Uv off = plane.uv_at(p) - at * Uv{length(e1), length(e2)};
      CHECK(std::abs(off.x) <= (6.5 + 3 + 1.5) * u * length(p));
      CHECK(std::abs(off.y) <= (14.9 + 3 + 1.5) * u * length(p));
    }
}

TEST_CASE("a hit has the surface's u and v, and its color is that of the texture there") {
  const auto check = [](auto scene, const auto& surface) {
    Material material{.diffuse = Color{9}};
    material.texture = [](double u, double v) { return Color{u, v, 0.5f}; };
    scene.add(surface, material);
    const auto hit = scene.intersect({{1, 3, 2}, {0, -1, 0}});
    REQUIRE(hit);
    CHECK(hit->uv() == Uv{2, 1});
    CHECK(hit->color() == Color{2, 1, 0.5f});
  };
  const Plane ground{.normal = {0, 1, 0}, .distance = -1};
  check(Scene<Plane>{}, ground);
  check(Scene<AnySurface>{}, AnySurface(ground));
}

TEST_CASE("a texture is refused on a surface without u and v, whose hits have u = v = 0") {
  Scene<Cylinder, AnySurface> scene;
  const Material textured{.texture = Checker{}};
  for (const auto& add :
       {+[](Scene<Cylinder, AnySurface>&to, const Material&m) { to.add(Cylinder{}, m); },
        +[](Scene<Cylinder, AnySurface>&to, const Material&m) { to.add(AnySurface(Cylinder{}), m); }}) {
    CHECK_THAT(message_of<std::invalid_argument>([&] { add(scene, textured); }),
               ContainsSubstring("a texture needs a surface with coordinates, uv_at(point)"));
    CHECK(scene.size() == 0);
  }
  scene.add(Cylinder{}, Color{0.5f});
  const auto hit = scene.intersect({{0, 0, -3}, {0, 0, 1}});
  REQUIRE(hit);
  CHECK(hit->uv() == Uv{0, 0});
}
