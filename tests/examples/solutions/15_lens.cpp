// Solution: a lens of glass before a wall with squares.
//
// g++ -O2 -std=c++20 -I../../include 15_lens.cpp -o 15_lens -pthread && ./15_lens
#include <protostar/protostar.hpp>
#include <protostar/surfaces/csg.hpp>
using namespace protostar;

int main() {
  const Csg lens = intersection_of(
      {Sphere{.center = {0, 0, 2}, .radius = 1.375}, Sphere{.center = {0, 0, 4}, .radius = 1.375}});
  const Checker squares{.first = {0.9f, 0.8f, 0.6f}, .second = {0.1f, 0.3f, 0.6f}, .size = 0.25};

  Scene<Csg, Plane> scene;
  scene.add(lens, Material{.refract = 0.9, .ior = 1.5});
  scene.add(Plane{.normal = {0, 0, -1}, .distance = -4},
            Material{.texture = squares});  // the points with z = 4
  scene.add(AmbientLight{Color{1}});

  Image image(320, 240);
  render(image, Camera::look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 50), scene, WhittedIntegrator{});
  save_ppm(image, "out.ppm");
}
