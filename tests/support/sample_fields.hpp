// Distance fields for tests, each a generic function of a point.
#pragma once

#include <protostar/bounds.hpp>
#include <protostar/exact/field_point.hpp>
#include <protostar/vec3.hpp>

inline constexpr auto sphere_field = [](const auto& p) { return length(p) - 1.0; };

inline constexpr auto torus_field = [](const auto& p) {
  using protostar::Vec2;
  const auto ring = length(Vec2{p.x, p.z}) - 1.0;
  return length(Vec2{ring, p.y}) - 0.3;
};

inline constexpr auto box_field = [](const auto& p) {
  using protostar::FieldPoint;
  return signed_length(FieldPoint{abs(p.x) - 1.0, abs(p.y) - 0.7, abs(p.z) - 0.5});
};

/// Two spheres, of radii 1 ± 1e-6.
inline constexpr auto shell_field = [](const auto& p) { return abs(length(p) - 1.0) - 1e-6; };

inline constexpr auto blend_field = [](const auto& p) {
  using protostar::FieldPoint;
  const auto ball = [&](double x, double y, double z, double radius) {
    return length(FieldPoint{p.x - x, p.y - y, p.z - z}) - radius;
  };
  return smooth_min(smooth_min(ball(-0.6, 0, 0, 0.6), ball(0.6, 0.1, 0, 0.5), 0.3), ball(0.1, 0.7, 0.3, 0.4),
                    0.3);
};

inline constexpr auto gyroid_field = [](const auto& p) {
  const auto x = p.x * 6.0, y = p.y * 6.0, z = p.z * 6.0;
  const auto g = sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
  return max(abs(g) - 0.3, length(p) - 1.4);
};

/// A Menger sponge.
struct SpongeField {
  int levels = 2;

  auto operator()(const auto& p) const {
    auto d = max(abs(p.x), max(abs(p.y), abs(p.z))) - 1.0;
    double scale = 1;
    for (int i = 0; i < levels; ++i, scale *= 3) {
      const auto q = fold(p * scale + protostar::Vec3{1, 1, 1});
      const auto hole = max(min(q.x, q.y), max(min(q.y, q.z), min(q.z, q.x))) - 2.0 / 3;
      d = max(d, hole * (1 / scale));
    }
    return d;
  }
};

/// Calls test(name, field, half side of a cube around the coordinate origin) for each field: for distances,
/// with kinks and without, and for functions that are none.
void for_each_sample_field(const auto& test) {
  using protostar::FieldPoint;
  using protostar::Vec2;
  test("sphere", sphere_field, 1.1);
  test("torus", torus_field, 1.4);
  test("box", box_field, 1.4);
  test("blend", blend_field, 1.4);
  test("sponge", SpongeField{3}, 1.8);
  test("shell", shell_field, 1.1);
  test("gyroid", gyroid_field, 1.5);
  // A row of spheres: the nearest one and its neighbors are looked at, so nothing jumps.
  test(
      "row",
      [](const auto& p) {
        const auto x = wrap(p.x * 2.0) * 0.5;
        const auto sphere = [&](double place) { return length(FieldPoint{x - place, p.y, p.z}) - 0.2; };
        return min(sphere(0), min(sphere(-0.5), sphere(0.5)));
      },
      1.5);
  // A twisted box, a quotient, a root, an exponential and a logarithm.
  test(
      "twist",
      [](const auto& p) {
        const auto s = sin(p.y * 2.0), c = cos(p.y * 2.0);
        return box_field(FieldPoint{c * p.x - s * p.z, p.y, s * p.x + c * p.z});
      },
      1.4);
  test(
      "horn",
      [](const auto& p) {
        return length(Vec2{p.x, p.z}) - 1.0 / (p.y + 3.0) + sqrt(square(p.y) + 0.01) * 0.1;
      },
      1.4);
  test(
      "growth", [](const auto& p) { return exp(p.x * -1.5) * 0.2 + log(p.y + 2.5) - abs(p.z) * p.z; }, 1.4);
}
