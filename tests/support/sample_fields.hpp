// Distance fields for tests, each with the box that it is looked at in.
#pragma once

#include <protostar/bounds.hpp>
#include <protostar/exact/field_point.hpp>
#include <protostar/vec3.hpp>

/// Calls test(name, field, half side of a cube around the coordinate origin) for each field: for distances,
/// with kinks and without, and for functions that are none.
void for_each_sample_field(const auto& test) {
  using protostar::FieldPoint;
  using protostar::Vec2;
  using protostar::Vec3;
  const auto torus = [](const auto& p) {
    const auto ring = length(Vec2{p.x, p.z}) - 1.0;
    return length(Vec2{ring, p.y}) - 0.3;
  };
  const auto box = [](const auto& p) { return signed_length(abs(p) - Vec3{1, 0.7, 0.5}); };
  test(
      "sphere", [](const auto& p) { return length(p) - 1.0; }, 1.1);
  test("torus", torus, 1.4);
  test("box", box, 1.4);
  test(
      "blend",
      [](const auto& p) {
        const auto a = length(p - Vec3{-0.6, 0, 0}) - 0.6, b = length(p - Vec3{0.6, 0.1, 0}) - 0.5;
        return smooth_min(smooth_min(a, b, 0.3), length(p - Vec3{0.1, 0.7, 0.3}) - 0.4, 0.3);
      },
      1.4);
  test(
      "sponge",
      [](const auto& p) {
        auto d = max(abs(p.x), max(abs(p.y), abs(p.z))) - 1.0;
        double s = 1;
        for (int level = 0; level < 3; ++level, s *= 3) {
          const auto q = fold(p * s + Vec3{1, 1, 1});
          const auto cross = max(min(q.x, q.y), max(min(q.y, q.z), min(q.z, q.x))) - 2.0 / 3.0;
          d = max(d, cross * (1 / s));
        }
        return d;
      },
      1.8);
  test(
      "shell", [](const auto& p) { return abs(length(p) - 1.0) - 1e-6; }, 1.1);
  test(
      "gyroid",
      [](const auto& p) {
        const auto q = p * 6.0;
        const auto g = sin(q.x) * cos(q.y) + sin(q.y) * cos(q.z) + sin(q.z) * cos(q.x);
        return max(abs(g) - 0.3, length(p) - 1.4);
      },
      1.5);
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
      [box](const auto& p) {
        const auto s = sin(p.y * 2.0), c = cos(p.y * 2.0);
        return box(FieldPoint{c * p.x - s * p.z, p.y, s * p.x + c * p.z});
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
