#include "folded_rows.hpp"

#include <numbers>
#include <protostar/surfaces/distance_field.hpp>

/// Returns the point in folded space: its x and z are the distances, in x and in z, from the axis of the
/// nearest column. Columns stand 3 apart.
auto in_rows(const auto& p) {
  const auto folded = [](const auto& x) { return fold((x - 1.5) * (2.0 / 3)) * 1.5; };
  return protostar::FieldPoint{folded(p.x), p.y, folded(p.z)};
}

protostar::AnyScene folded_rows(RowLamp lamp) {
  using namespace protostar;

  const auto columns = [](const auto& p) {
    const auto q = in_rows(p);
    return length(FieldPoint{q.x, max(abs(q.y) - 1.2, 0.0), q.z}) - 0.3;
  };
  const auto rings = [](const auto& p) {
    const auto q = in_rows(p);
    return length(Vec2{length(Vec2{q.x, q.z}) - 0.5, q.y}) - 0.14;
  };
  const Bounds bounds{{-60, -1.6, -6}, {60, 1.6, 60}};

  AnyScene scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.2f, 0.4f, 0.8f});
  scene.add(Marched{columns, bounds}, Color{1, 0.3f, 0});
  scene.add(Marched{rings, bounds}, Color{0.2f, 0.7f, 0.1f});
  const Point position{0, 2.5, 3};
  const float power = 40 * std::numbers::pi_v<float>, radius = 0.3f;
  // Both lamps light alike. A matte surface of color c that faces a point at the distance d has the radiance
  // c · power/(4π d²): its c stands for albedo/π (docs/errata.md). One that faces a sphere of radius r has
  // about c/π · π r²/d² · emission, with c as its albedo. They are equal for emission = power/(4π r²).
  if (lamp == RowLamp::point)
    scene.add(PointLight{.position = position, .power = Color{power}});
  else
    scene.add(Sphere{.center = position, .radius = radius},
              Material{.diffuse = Color{0},
                       .emission = Color{power / (4 * std::numbers::pi_v<float> * radius * radius)}});
  return scene;
}
