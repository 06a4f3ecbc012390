// Tests a scene without any surface type. Compiled without the precompiled headers of the other tests, in
// which g++ gives no warnings.
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>

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
  return is_miss && is_background ? 0 : 1;
}
