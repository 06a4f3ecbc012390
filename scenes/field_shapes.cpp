#include "field_shapes.hpp"

#include <cmath>
#include <numbers>
#include <protostar/surfaces/distance_field.hpp>

protostar::AnyScene field_shapes() {
  using namespace protostar;

  // The points at most 0.25 away from a circle, which stands in a plane of x and y.
  const auto torus = [](const auto& p) {
    const auto q = p - Vec3{-1.9, -0.1, 3.4};
    return length(Vec2{length(Vec2{q.x, q.y}) - 0.6, q.z}) - 0.25;
  };
  // The points at most 0.2 away from a box.
  const auto rounded_box = [](const auto& p) {
    return length(max(abs(p - Vec3{-0.9, -0.5, 4.2}) - Vec3{0.3, 0.3, 0.3}, 0.0)) - 0.2;
  };
  const auto octahedron = [](const auto& p) {
    const auto q = abs(p - Vec3{0.05, 0.1, 3.7});
    return (q.x + q.y + q.z - 0.9) * std::sqrt(1.0 / 3);
  };
  // The points at most 0.4 away from a part of a vertical line.
  const auto capsule = [](const auto& p) {
    const auto q = p - Vec3{1, -0.1, 4.5};
    return length(FieldPoint{q.x, max(abs(q.y) - 0.5, 0.0), q.z}) - 0.4;
  };
  const auto cylinder = [](const auto& p) {
    const auto q = p - Vec3{-0.5, -0.72, 2.6};
    return max(length(Vec2{q.x, q.z}) - 0.35, abs(q.y) - 0.28);
  };
  // A box, less a ball.
  const auto carved = [](const auto& p) {
    const auto q = p - Vec3{1.9, -0.4, 3.3};
    const auto side = abs(q);
    return max(max(max(side.x, side.y), side.z) - 0.6, -(length(q) - 0.78));
  };

  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.2f, 0.4f, 0.8f});
  scene.add(Marched{torus, Bounds{{-2.75, -0.95, 3.15}, {-1.05, 0.75, 3.65}}}, Color{1, 0.3f, 0});
  scene.add(Marched{rounded_box, Bounds{{-1.4, -1, 3.7}, {-0.4, 0, 4.7}}}, Color{0.9f, 0.6f, 0.1f});
  scene.add(Marched{octahedron, Bounds{{-0.85, -0.8, 2.8}, {0.95, 1, 4.6}}}, Color{0.2f, 0.7f, 0.1f});
  scene.add(Marched{capsule, Bounds{{0.6, -1, 4.1}, {1.4, 0.8, 4.9}}}, Color{0.7f, 0.2f, 0.6f});
  scene.add(Marched{cylinder, Bounds{{-0.85, -1, 2.25}, {-0.15, -0.44, 2.95}}}, Color{0.1f, 0.6f, 0.6f});
  scene.add(Marched{carved, Bounds{{1.3, -1, 2.7}, {2.5, 0.2, 3.9}}}, Color{0.8f, 0.8f, 0.7f});
  scene.add(PointLight{.position = {-2, 4, 0}, .power = Color{100 * std::numbers::pi_v<float>}});
  return scene;
}
