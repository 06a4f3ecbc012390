// Program of a dozen lines, as a user compiles it by hand: .ci/run compiles it at -O3 without -march, and in
// Debug.
#include <protostar/protostar.hpp>
using namespace protostar;

int main() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1},
            Material{.diffuse = Color{1, 0.3f, 0}, .reflect = 0.5f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});
  Image image(640, 480);
  render(image, Camera{}, scene, WhittedIntegrator{});
  save_ppm(image, "whitted.ppm");
}
