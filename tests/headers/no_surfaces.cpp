// Tests a scene without any surface type. Compiled without the precompiled headers of the other tests, in
// which g++ gives no warnings.
#include <protostar/protostar.hpp>

using namespace protostar;

int main() {
  Scene<> scene;
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{1}});
  const Ray ray;
  bool crossed = false;
  scene.crossings(ray, {}, [&](const Intersection&) { crossed = true; });
  const bool is_miss = !scene.intersect(ray) && !scene.occluded(ray) && !crossed;
  const bool is_background = ShadowIntegrator{}.radiance(ray, scene) == Color{0} &&
                             TransparencyIntegrator{}.radiance(ray, scene) == Color{1};
  const auto accelerated = accelerate(scene);
  scene.set_sky(Color{0.5f});
  Image image(3, 2), by_view(3, 2);
  render(image, Camera{}, scene, WhittedIntegrator{});
  render(by_view, Camera{}, accelerated, WhittedIntegrator{});
  const bool is_drawn = image(2, 1) == Color{0.5f} && by_view(2, 1) == Color{0.5f};
  return is_miss && is_background && is_drawn ? 0 : 1;
}
