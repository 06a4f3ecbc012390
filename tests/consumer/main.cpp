// The README's program, as a user compiles it.
#include <protostar/protostar.hpp>
using namespace protostar;
int main() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1, 0.3f, 0});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});
  Image image(640, 480);
  Camera camera;
  render(image, camera, scene, ShadowIntegrator{}, RenderOptions{.threads = 2});
  save_ppm(image, "out.ppm", Gamma{2.2});
  render(image, camera, [&](const Ray& ray) { return scene.intersect(ray) ? Color{1} : Color{0}; });
}
