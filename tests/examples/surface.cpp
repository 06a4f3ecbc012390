// A surface of your own: two functions, and the concept as a check.
#include <cmath>
#include <protostar/protostar.hpp>
using namespace protostar;

/// Points at distance radius from the y axis.
struct Cylinder {
  double radius = 1;

  /// Returns the smallest t inside the range with x² + z² = r². Without y this is a circle, so the equation
  /// is a quadratic, A t² − 2 b t + c = 0, unless the ray runs along the axis.
  std::optional<double> intersect(const Ray& ray, Interval range) const {
    const double dx = ray.direction.x, dz = ray.direction.z, ox = ray.origin.x, oz = ray.origin.z;
    const double A = dx * dx + dz * dz, b = -(dx * ox + dz * oz), c = ox * ox + oz * oz - radius * radius;
    if (A == 0) return std::nullopt;
    return quadratic_roots(A, b, c, b * b - A * c).first_in(range);
  }

  Vec3 normal_at(Point point) const { return Vec3{point.x, 0, point.z} / radius; }
};
static_assert(Surface<Cylinder>);

int main() {
  Scene<Cylinder, Sphere> scene;
  scene.add(Cylinder{.radius = 0.5}, Color{0.8f, 0.6f, 0.3f});
  scene.add(Sphere{.center = {1.2, 0, 0}, .radius = 0.6}, Color{0.2f, 0.4f, 0.8f});
  scene.add(PointLight{.position = {4, 3, -4}, .power = Color{400}});

  Image image(320, 240);
  render(image, Camera{.position = {0, 0, -3}}, scene, ShadowIntegrator{});
  save_ppm(image, "surface.ppm");
}
