// Depth of field in passes: each is a picture from another point on the lens, and their mean is sharp at one
// distance.
#include <protostar/protostar.hpp>
using namespace protostar;

/// Returns the pinhole camera at a point on the lens of another pinhole camera. Both see the plane at
/// distance · forward in the same pixels:
///   position + distance · (u · right + v · up + forward)
/// is seen from position + offset in the direction of u · right + v · up + (forward − offset / distance).
Camera through_lens(Camera camera, const Vec3& offset, double distance) {
  camera.position += offset;
  camera.forward -= offset / distance;
  return camera;
}

int main() {
  Scene<Sphere, Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1},
            Material{.texture = Checker{Color{0.8f}, Color{0.2f}}});
  for (int i = 0; i < 5; ++i)
    scene.add(Sphere{.center = {i - 1.5, -0.5, 2.0 + 2 * i}, .radius = 0.5},
              Color{0.9f, 0.2f * static_cast<float>(i), 0.1f});
  scene.add(PointLight{.position = {-3, 6, 0}, .power = Color{1200}});

  const Camera camera = Camera::look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60);
  const double distance = 6;  // in focus, in lengths of forward, which is 1 here: the third sphere
  const double radius = 0.1;  // radius of the lens

  // The points on the lens are the points of a grid that lie in it.
  Image image(320, 240), pass(320, 240);
  const int n = 4;
  int passes = 0;
  for (int y = -n; y <= n; ++y)
    for (int x = -n; x <= n; ++x) {
      if (x * x + y * y > n * n) continue;
      const Vec3 offset = radius * x / n * normalize(camera.right) + radius * y / n * normalize(camera.up);
      render(pass, through_lens(camera, offset, distance), scene, ShadowIntegrator{});
      for (int row = 0; row < image.height(); ++row)
        for (int column = 0; column < image.width(); ++column) image(column, row) += pass(column, row);
      ++passes;
    }
  expose(image, 1.0 / passes);
  save_ppm(image, "lens.ppm");
  return 0;
}
