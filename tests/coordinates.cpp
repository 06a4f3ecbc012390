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
#include "support/random.hpp"

using namespace protostar;

namespace {
bool near(const Uv& a, const Uv& b) { return std::abs(a.x - b.x) < 1e-15 && std::abs(a.y - b.y) < 1e-15; }
}  // namespace

TEST_CASE("on a sphere u is the longitude, ½ towards z, and v the angle from the top over π") {
  const double half = std::sqrt(0.5), third = std::sqrt(1.0 / 3);
  struct {
    Vec3 direction;
    Uv uv;
  } const rows[] = {
      {{0, 0, 1}, {0.5, 0.5}},
      {{1, 0, 0}, {0.75, 0.5}},
      {{-1, 0, 0}, {0.25, 0.5}},
      {{1e-17, 0, -1}, {1, 0.5}},
      {{-1e-17, 0, -1}, {0, 0.5}},
      {{0, 1, 0}, {0.5, 0}},
      {{0, -1, 0}, {0.5, 1}},
      {{half, 0, half}, {0.625, 0.5}},
      {{-half, 0, -half}, {0.125, 0.5}},
      {{0, half, half}, {0.5, 0.25}},
      {{0, -half, half}, {0.5, 0.75}},
      {{third, -third, -third}, {0.875, std::acos(-third) / std::numbers::pi}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.direction.x, row.direction.y, row.direction.z);
    CHECK(near(direction_uv(row.direction), row.uv));
    const Sphere sphere{.center = {4, -2, 8}, .radius = 2}, inverted{sphere.center, -2};
    const Point point = sphere.center + 2.0 * row.direction;
    if (std::abs(row.direction.x) != 1e-17) {  // the sum would lose 1e-17
      CHECK(near(sphere.uv_at(point), row.uv));
      CHECK(sphere.uv_at(point) == inverted.uv_at(point));
    }
  }
}

TEST_CASE("u and v of a direction agree with the mathematical formula") {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random.direction();
    const Uv expected{0.5 + std::atan2(n.x, n.z) / (2 * std::numbers::pi), std::acos(n.y) / std::numbers::pi};
    CHECK(near(direction_uv(n), expected));
  }
}

TEST_CASE("on a plane u and v are lengths from its point nearest to the coordinate origin") {
  const double half = std::sqrt(0.5);
  struct {
    Plane plane;
    Vec3 e1, e2;  // e1 along a × n, e2 = n × e1, where a is the axis of n's smallest component
  } const rows[] = {
      {{{0, 1, 0}, -1}, {0, 0, 1}, {1, 0, 0}},
      {{{0, 3, 0}, -3}, {0, 0, 1}, {1, 0, 0}},
      {{{0, -1, 0}, 1}, {0, 0, -1}, {1, 0, 0}},
      {{{0, 0, 1}, 5}, {0, -1, 0}, {1, 0, 0}},
      {{{1, 0, 0}, 2}, {0, 0, -1}, {0, 1, 0}},  // y is the first of the smallest components
      {{{1, 1, 0}, 0}, {-half, half, 0}, {0, 0, 1}},
      {{{0, 1, 1}, 7}, {0, -half, half}, {1, 0, 0}},
      {{{1, 1, 1}, 1}, {0, -half, half}, {2 / std::sqrt(6.0), -1 / std::sqrt(6.0), -1 / std::sqrt(6.0)}},
      {{{-3, 1, 2}, 1}, Vec3{2, 0, 3} / std::sqrt(13.0), Vec3{3, 13, -2} / std::sqrt(182.0)},
  };
  for (const auto& row : rows) {
    CAPTURE(row.plane.normal.x, row.plane.normal.y, row.plane.normal.z);
    const Point foot = row.plane.normal * (row.plane.distance / dot(row.plane.normal, row.plane.normal));
    CHECK(near(row.plane.uv_at(foot), {0, 0}));
    CHECK(near(row.plane.uv_at(foot + row.e1), {1, 0}));
    CHECK(near(row.plane.uv_at(foot + row.e2), {0, 1}));
    CHECK(near(row.plane.uv_at(foot + 0.5 * row.e1 - 0.75 * row.e2), {0.5, -0.75}));
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
