// Solution: metal balls by Phong's lobe, below the same by tiny mirrors.
//
// g++ -O2 -std=c++20 -I../../include 22_lobes.cpp -o 22_lobes -pthread && ./22_lobes
#include <protostar/integrators/path.hpp>
#include <protostar/protostar.hpp>
using namespace protostar;

int main() {
  Scene<Sphere, Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0},
            Material{.texture = Checker{Color{0.6f}, Color{0.2f}}});
  const Color gold{0.9f, 0.75f, 0.55f};
  const double exponents[] = {Material::most_shininess_of_blur, 127, 7.5, 1, 0};
  for (int i = 0; i < 5; ++i) {
    const double x = 1.2 * (i - 2);
    scene.add(Sphere{.center = {x, 1.75, 0}, .radius = 0.55},
              Material{.glossy = gold, .roughness = 0.25 * i});
    scene.add(Sphere{.center = {x, 0.55, 0}, .radius = 0.55},
              Material{.shininess = exponents[i], .glossy = gold, .blur = Blur::phong});
  }
  scene.add(Sphere{.center = {-2, 4, -2}, .radius = 0.75}, Material{.emission = Color{12, 10, 7}});
  scene.add(Sphere{.center = {3, 7, 3}, .radius = 0.25}, Material{.emission = Color{140, 170, 220}});
  scene.set_sky({0.2f, 0.26f, 0.35f});

  Image image(320, 240);
  render(image, Camera::look_at({0, 1.15, -8}, {0, 1.15, 0}, {0, 1, 0}, 36), scene, PathIntegrator(scene),
         {.samples = 32});
  save_ppm(image, "out.ppm");
}
