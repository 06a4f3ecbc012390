#include "blended_balls.hpp"

#include <numbers>
#include <protostar/surfaces/distance_field.hpp>

protostar::AnyScene blended_balls() {
  using namespace protostar;

  const auto drop = [](const auto& p) {
    const auto ball = [&](const Vec3& center, double radius) { return length(p - center) - radius; };
    auto all = ball({-1.3, -0.3, 3}, 0.6);
    all = smooth_min(all, ball({-0.3, 0.3, 3.2}, 0.5), 0.8);
    all = smooth_min(all, ball({0.6, -0.2, 2.8}, 0.6), 0.8);
    all = smooth_min(all, ball({1.5, 0.5, 3.4}, 0.45), 0.8);
    return smooth_min(all, ball({0.4, 1.2, 3.2}, 0.35), 0.8);
  };

  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.2f, 0.4f, 0.8f});
  scene.add(Marched{drop, Bounds{{-2.2, -1.1, 1.9}, {2.2, 1.8, 4.2}}}, Color{1, 0.3f, 0});
  scene.add(PointLight{.position = {-2, 4, 0}, .power = Color{100 * std::numbers::pi_v<float>}});
  return scene;
}
