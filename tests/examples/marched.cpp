// A surface of your own that is marched: no root of its equation is known, only how fast it can bend.
#include <algorithm>
#include <cmath>
#include <protostar/protostar.hpp>
using namespace protostar;

/// Waves on a pond: y = height · (sin x + sin z), for x and z from −size to size.
struct Waves {
  double height = 0.25, size = 10;

  /// Returns F(p) = y − height · (sin x + sin z), which is 0 on the waves and greater above them.
  double F(const Point& p) const { return p.y - height * (std::sin(p.x) + std::sin(p.z)); }
  Vec3 gradient(const Point& p) const { return {-height * std::cos(p.x), 1, -height * std::cos(p.z)}; }

  /// Returns F(p + v) − F(p), by sin(a + b) − sin a = 2 cos(a + b/2) sin(b/2). The difference of two values
  /// of F would be noise for small v; here each term has a factor that vanishes with v, and is exact for
  /// v = 0.
  double rise(const Point& p, const Vec3& v) const {
    return v.y -
           2 * height *
               (std::cos(p.x + v.x / 2) * std::sin(v.x / 2) + std::cos(p.z + v.z / 2) * std::sin(v.z / 2));
  }

  Vec3 normal_at(Point point) const { return normalize(gradient(point)); }

  /// Marches along f(t) = F(origin + t · direction). Everywhere |f''| ≤ K = height · (dx² + dz²), so f keeps
  /// its sign at least for free_way(|f|, ±f', K). Steps of that length approach the next crossing and never
  /// pass it, except by rounding; if a step is too small to change t, t is the crossing.
  ///
  /// A ray that leaves the waves starts on them, whatever its rounded origin is. Hence it marches along
  /// f(t) = F(origin + t · direction) − F(origin), which has a root at 0: the slope there tells on which side
  /// the ray continues, and how far it surely stays there. No epsilon moves it off the waves.
  std::optional<double> intersect(const Ray& ray, Interval range) const {
    const Vec3& d = ray.direction;
    const Interval inside = part_inside(ray);
    const bool leaves = ray.departure == departure();
    const auto f_at = [&](double t) { return leaves ? rise(ray.origin, t * d) : F(ray.at(t)); };
    const auto slope_at = [&](double t) { return dot(gradient(ray.at(t)), d); };
    const double K = height * (d.x * d.x + d.z * d.z);

    double t = std::max(leaves ? 0 : inside.min, range.min);
    const double end = std::min(inside.max, range.max);
    if (!(t < end)) return std::nullopt;
    double f = f_at(t), slope = slope_at(t);
    double side = std::copysign(1, f);  // 1 above the waves, -1 below
    if (t + free_way(side * f, side * slope, K) == t) {
      // The range starts at a crossing: at the point that the ray leaves, or at the previous crossing when
      // the next one is searched.
      f = 0;
      side = std::copysign(1, slope);
    }
    for (int i = 0; i < most_steps; ++i) {
      const double next = t + free_way(side * f, side * slope, K);
      if (!(next < end)) return std::nullopt;
      if (next == t) return t;
      t = next, f = f_at(t), slope = slope_at(t);
      if (side * f <= 0) return t;
    }
    return std::nullopt;
  }

  /// Returns the departure from these waves, recognized by their address.
  Departure departure() const { return {.kind = Departure::Kind::object, .object = this}; }

  /// Returns a box that is a thousandth larger than the one in which rays march, to allow for rounding.
  Bounds bounds() const { return {-1.001 * corner(), 1.001 * corner()}; }

  void validate() const {
    if (!(height > 0 && size > 0 && std::isfinite(height) && std::isfinite(size)))
      throw std::invalid_argument("Waves: height and size must be finite and greater than 0");
  }

 private:
  /// Maximum number of steps. Near a crossing, steps shrink as those of Newton's method do, so a few tens are
  /// enough. A ray that needs as many as this runs along the waves, closer than double resolves, and counts
  /// as a miss.
  static constexpr int most_steps = 10000;

  /// Returns the smallest way > 0 at which f + slope · way − K/2 · way² is 0, for f ≥ 0 and K ≥ 0, by the one
  /// of its two forms in which nothing cancels. Returns NaN, which ends the march, if f and slope are 0.
  static double free_way(double f, double slope, double K) {
    const double root = std::sqrt(slope * slope + 2 * K * f);
    return slope > 0 ? (slope + root) / K : 2 * f / (root - slope);
  }

  /// Returns a corner of the box around the waves, which lie between −2 · height and 2 · height; with more
  /// room, their crests are not cut.
  Vec3 corner() const { return {size, 3 * height, size}; }

  /// Returns the range in which a ray is inside the box around the waves.
  Interval part_inside(const Ray& ray) const {
    Interval part{.min = -infinity, .max = infinity};
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (-corner()[axis] - ray.origin[axis]) / ray.direction[axis];
      const double b = (corner()[axis] - ray.origin[axis]) / ray.direction[axis];
      part.min = std::max(part.min, std::min(a, b));
      part.max = std::min(part.max, std::max(a, b));
    }
    return part;
  }
};
static_assert(SurfaceWithBounds<Waves>);

int main() {
  Scene<Waves, Sphere> scene;
  scene.add(Waves{}, Color{0.2f, 0.5f, 0.7f});
  scene.add(Sphere{.center = {0, 0.6, 5}, .radius = 0.8}, Color{0.9f, 0.3f, 0.1f});
  scene.add(PointLight{.position = {-5, 4, 1}, .power = Color{900}});
  const Camera camera = Camera::look_at({0, 2, -2}, {0, 0, 5}, {0, 1, 0}, 60);
  Image image(320, 240);
  render(image, camera, scene, ShadowIntegrator{});
  save_ppm(image, "marched.ppm");

  // Rays straight up from a wave hit nothing but the sphere, and rays straight down hit nothing at all.
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const auto hit = scene.intersect(camera.through_pixel(x, y, image.width(), image.height()));
      if (!hit || hit->color().r == 0.9f) continue;
      if (scene.occluded(hit->leave({0, -1, 0}))) return 1;
      const auto above = scene.intersect(hit->leave({0, 1, 0}));
      if (above && above->color().r != 0.9f) return 1;
    }
  return 0;
}
