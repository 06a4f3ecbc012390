#include "sponge.hpp"

#include <numbers>

protostar::AnyScene sponge() {
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
