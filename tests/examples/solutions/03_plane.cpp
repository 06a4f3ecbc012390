// Solution: the scene of stage 03 with a plane as the ground.
//
// g++ -O2 -std=c++20 -I../../include 03_plane.cpp -o 03_plane -pthread && ./03_plane
#include <protostar/protostar.hpp>
using namespace protostar;

int main() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1});
  scene.add(Sphere{.center = {-1.5, 0, 5}, .radius = 1}, Color{1});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{1});  // the points with y = -1

  Image image(320, 240);
  render(image, Camera{}, scene, BinaryIntegrator{});
  save_ppm(image, "out.ppm");
}
