// Solution: a lens of glass before a wall with squares.
//
// g++ -O2 -std=c++20 -I../../include 15_lens.cpp -o 15_lens -pthread && ./15_lens
#include <cstdio>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/csg.hpp>
using namespace protostar;

// Returns the width of the square that a pixel shows: how many neighbors in its row show more red than blue,
// or more blue than red, as it does.
int width_of_square(const Image& image, int x, int y) {
  const auto is_first = [&](int column) { return image(column, y).r > image(column, y).b; };
  int begin = x, end = x + 1;
  while (begin > 0 && is_first(begin - 1) == is_first(x)) --begin;
  while (end < image.width() && is_first(end) == is_first(x)) ++end;
  return end - begin;
}

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
  std::printf("a square in the middle: %d pixels\n", width_of_square(image, 170, 120));
  std::printf("one beside the lens: %d pixels\n", width_of_square(image, 40, 120));
}
