// A surface with optional functions: its roots, and the departure of a ray from it.
#include <cmath>
#include <protostar/protostar.hpp>
using namespace protostar;

/// Points at distance radius from the y axis.
struct Cylinder {
  double radius = 1;

  std::optional<double> intersect(const Ray& ray, Interval range) const { return roots(ray).first_in(range); }
  Vec3 normal_at(Point point) const { return Vec3{point.x, 0, point.z} / radius; }

  /// Returns all crossings of the ray's line. A ray that leaves the cylinder starts with x² + z² = r², so
  /// c = 0 and one root is 0. It is left out; the other is 2b/A.
  Roots roots(const Ray& ray) const {
    const double dx = ray.direction.x, dz = ray.direction.z, ox = ray.origin.x, oz = ray.origin.z;
    const double A = dx * dx + dz * dz, b = -(dx * ox + dz * oz);
    if (A == 0) return {};  // along the axis
    if (ray.departure == departure()) return Roots{2 * b / A};
    const double c = ox * ox + oz * oz - radius * radius;
    return quadratic_roots(A, b, c, b * b - A * c);
  }

  /// Returns the departure from this cylinder, recognized by its address.
  Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }

  /// Throws if the cylinder is invalid, so that Scene::add refuses it.
  void validate() const {
    if (!(radius > 0 && std::isfinite(radius)))
      throw std::invalid_argument("Cylinder: radius must be finite and greater than 0");
  }
};
static_assert(SurfaceWithRoots<Cylinder>);

int main() {
  Scene<Cylinder> scene;
  scene.add(Cylinder{.radius = 0.5}, Color{0.8f, 0.6f, 0.3f});

  // A ray that leaves outwards never hits the cylinder again; one that leaves inwards hits its other side
  // once.
  const Ray ray{.origin = {0, 0, -3}, .direction = {0, 0, 1}};
  const auto hit = scene.intersect(ray);
  if (!hit || hit->t != 2.5) return 1;
  if (scene.intersect(hit->leave({0.1, 0.2, -1}))) return 1;
  const auto other_side = scene.intersect(hit->leave({0, 0, 1}));
  return other_side && other_side->t == 1 ? 0 : 1;
}
