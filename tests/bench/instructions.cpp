// Draws one of the pictures that bench_instructions counts, a number of times: instructions NAME TIMES.
#include <cstdlib>
#include <cstring>
#include <protostar/protostar.hpp>

#include "scenes/three_spheres.hpp"

using namespace protostar;

namespace {

template <Surface... S>
Scene<S...> spheres_in_a_scene_of(bool lit = true) {
  Scene<S...> scene;
  for (const auto& [sphere, color] : the_three_spheres) scene.add(sphere, color);
  if (lit) scene.add(light_of_the_three_spheres);
  return scene;
}

void draw(int times, const auto& scene, const auto& integrator, const Camera& camera = {}) {
  Image image(640, 480);
  for (int i = 0; i < times; ++i) render(image, camera, scene, integrator, {.threads = 1});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto is = [&](const char* name) { return std::strcmp(argv[1], name) == 0; };
  const int times = std::atoi(argv[2]);
  const auto scene = spheres_in_a_scene_of<Sphere>();
  if (is("binary"))
    draw(times, scene, BinaryIntegrator{});
  else if (is("color"))
    draw(times, scene, ColorIntegrator{});
  else if (is("shadow"))
    draw(times, scene, ShadowIntegrator{});
  else if (is("shadow-more-types"))
    draw(times, spheres_in_a_scene_of<Sphere, Plane, Parallelogram>(), ShadowIntegrator{});
  else if (is("color-more-types"))
    draw(times, spheres_in_a_scene_of<Sphere, Plane, Parallelogram>(), ColorIntegrator{});
  else if (is("shadow-no-lights"))
    draw(times, spheres_in_a_scene_of<Sphere>(false), ShadowIntegrator{});
  else if (is("sky"))
    draw(times, scene, ColorIntegrator{}, {.up = {0, 0, -1}, .forward = {0, 1, 0}});
  else if (is("nothing"))
    draw(times, Scene<Sphere>(), ColorIntegrator{});
  else
    return 2;
  return 0;
}
