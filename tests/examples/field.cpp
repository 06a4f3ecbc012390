// A surface of your own as a field: one function of a point, which is 0 on the surface and negative inside.
#include <protostar/protostar.hpp>
#include <protostar/surfaces/distance_field.hpp>
using namespace protostar;

int main() {
  // Written for any number type: the library takes values, bounds and slopes from it, and proves each hit.
  const auto torus = [](const auto& p) {
    const auto ring = length(Vec2{p.x, p.z}) - 1.0;
    return length(Vec2{ring, p.y}) - 0.3;
  };

  // Written for double alone, with a bound of how fast it changes: nothing is proven.
  const auto ball = [](const Point& p) { return length(p - Point{0, 0.2, 0}) - 0.4; };

  Scene<AnySurface> scene;
  scene.add(Marched{torus, Bounds{{-1.3, -0.3, -1.3}, {1.3, 0.3, 1.3}}}, Color{0.8f, 0.6f, 0.3f});
  scene.add(Marched{ball, Bounds{Point(-0.7), Point(0.7)}, 1.0}, Color{0.2f, 0.4f, 0.8f});
  scene.add(PointLight{.position = {4, 6, -4}, .power = Color{900}});

  Image image(320, 240);
  const Camera camera = Camera::look_at({0, 2.5, -3}, {0, 0, 0}, {0, 1, 0}, 50);
  render(image, camera, scene, ShadowIntegrator{});
  save_ppm(image, "field.ppm");
}
