#include <protostar/protostar.hpp>
using namespace protostar;

int main() {
  Scene<Sphere, Plane> scene;  // a vector for each named surface type, and nothing for others
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1, 0.3f, 0});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});  // points x: normal · x = distance
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});

  Image image(640, 480);
  Camera camera;  // at the origin, x to the right, y up, looking along z
  render(image, camera, scene, ShadowIntegrator{}, RenderOptions{.threads = 2});  // no options: all cores
  save_ppm(image, "out.ppm", Gamma{2.2});  // Srgb{} is the default; Linear{} leaves light as it is

  // Instead of an integrator, any function of a ray may return its color.
  render(image, camera, [&](const Ray& ray) { return scene.intersect(ray) ? Color{1} : Color{0}; });
}
