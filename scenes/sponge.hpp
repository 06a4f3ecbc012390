// Menger's sponge, four levels deep, on a floor (stage 38).
#pragma once

#include <numbers>
#include <protostar/any_scene.hpp>
#include <protostar/surfaces/distance_field.hpp>

/// Field of a cube from −1 to 1 with square holes along the axes, each of its pieces with smaller ones, and
/// so on. At each level space is folded to one piece, and three square holes are taken away through its
/// middle.
struct Sponge {
  int levels = 4;

  auto operator()(const auto& p) const {
    const auto side = abs(p);
    auto result = max(max(side.x, side.y), side.z) - 1.0;
    double size = 1;  // half of the width of a piece
    for (int level = 0; level < levels; ++level) {
      const auto q = fold(p * (1 / size)) * size;
      result = max(result, -(min(min(max(q.x, q.y), max(q.y, q.z)), max(q.z, q.x)) - size / 3));
      size = size / 3;
    }
    return result;
  }
};

inline protostar::AnyScene sponge() {
  using namespace protostar;

  // The sponge, moved and turned around the y axis, so that an edge shows.
  const auto turned = [](const auto& p) {
    const auto q = p - Vec3{0, -1.6, 3.8};
    return Sponge{}(FieldPoint{q.x * 0.8 - q.z * 0.6, q.y, q.x * 0.6 + q.z * 0.8});
  };

  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -2.63}, Color{0.2f, 0.4f, 0.8f});
  scene.add(Marched{turned, Bounds{{-1.5, -2.7, 2.3}, {1.5, -0.5, 5.3}}}, Color{0.9f, 0.6f, 0.3f});
  scene.add(PointLight{.position = {-2, 3, 1}, .power = Color{100 * std::numbers::pi_v<float>}});
  return scene;
}
