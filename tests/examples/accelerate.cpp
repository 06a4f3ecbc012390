// Your own rays in a scene of many surfaces: a turning laser scanner in a wood of 10,000 trees.
#include <cstdio>
#include <protostar/protostar.hpp>
using namespace protostar;

int main() {
  Scene<Sphere, Plane> wood;
  wood.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{0.3f});
  for (int i = 0; i < 10000; ++i)  // in rows of 100, each a little out of line; none where the scanner stands
    if (const int x = i % 100 - 50, z = i / 100 - 50; x != 0 || z != 0)
      wood.add(Sphere{.center = {3.0 * x + 0.1 * (i % 7), 1, 3.0 * z + 0.1 * (i % 11)}, .radius = 0.4},
               Color{0.2f, 0.6f, 0.2f});

  // A BVH, built once. It returns the same hits as the scene, to the last bit, and many threads may use it.
  const auto fast = accelerate(wood);
  const Point scanner{0, 1, 0};
  double farthest = 0;
  for (int i = 0; i < 3600; ++i) {
    const Vec3 direction{cosine_of_degrees(i * 0.1), 0, sine_of_degrees(i * 0.1)};
    const auto hit = fast.intersect({.origin = scanner, .direction = direction});
    if (hit && hit->t > farthest) farthest = hit->t;
  }
  std::printf("the farthest tree in sight is %.2f away\n", farthest);

  // A surface that is added to the scene is not in the BVH, which throws until it is built anew.
  wood.add(Sphere{.center = {1, 1, 0}, .radius = 0.5}, Color{1});
  bool refused = false;
  try {
    static_cast<void>(fast.occluded({.origin = scanner, .direction = {1, 0, 0}}));
  } catch (const std::logic_error&) {
    refused = true;
  }
  const bool sees_it = accelerate(wood).occluded({.origin = scanner, .direction = {1, 0, 0}}, {0, 0.6});
  return farthest > 10 && refused && sees_it ? 0 : 1;
}
