// Solution: a globe with squares of 15 degrees.
//
// g++ -O2 -std=c++20 -I../../include 13_globe.cpp -o 13_globe -pthread && ./13_globe
#include <protostar/protostar.hpp>
using namespace protostar;

// Colors the globe by u, from 0 to 1 around it, and v, from 0 at the top to 1 at the bottom.
Color squares(double u, double v) {
  const int column = static_cast<int>(24 * u), row = static_cast<int>(12 * v);
  return (column + row) % 2 == 0 ? Color{0.9f, 0.8f, 0.6f} : Color{0.1f, 0.3f, 0.6f};
}

int main() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Material{.texture = squares});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(PointLight{.position = {-2, 4, 0}, .power = Color{300}});
  scene.add(AmbientLight{Color{0.1f}});

  Image image(320, 240);
  render(image, Camera::look_at({0, 1.5, 0}, {0, 0, 3}, {0, 1, 0}, 50), scene, WhittedIntegrator{});
  save_ppm(image, "out.ppm");
}
