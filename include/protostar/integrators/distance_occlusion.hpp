// Shows ambient occlusion as an approximation by a few distances from the surfaces nearby, without rays and
// without chance.
#pragma once

#include <algorithm>
#include <stdexcept>

#include "../render.hpp"
#include "../scene_fields.hpp"
#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of ambient occlusion by distance, an approximation of AmbientOcclusionIntegrator. The radiance
/// of a hit is
///   1 − Σ w_i (1 − f_i/h_i)
/// with the distance f_i, cut to 0 … h_i, from the point at the height h_i over the hit, along its normal, to
/// the nearest surface, or a lower bound of it. Over an open plane f_i = h_i, and nothing is occluded. White
/// if there is no hit. Distances are negative inside of solids: cameras belong outside.
///
/// The weights make the result right for an endless wall that stands on a plane. From a point at the distance
/// a from it, the wall hides the directions with a component of c = a/R or more towards it, R being the
/// farthest distance: the share (arccos c − c √(1 − c²))/π of the light. With f = min(h, a) and a weight w(x)
/// for the height xR the sum is ∫ w(x) (1 − c/x) dx over x > c, whose second derivative by c is w(c)/c; that
/// of the share is 2c/(π √(1 − c²)). Hence w(x) = 2x²/(π √(1 − x²)): with x = sin α, equal parts of α have
/// weights in proportion to sin² α. Eight parts leave an error of about 1/1000 at most for any wall.
///
/// Anything else is off: the result is never below ½, that of a wall at the hit; only the nearer one of two
/// walls counts, so that corners and slots are too bright; and anything nearby counts as an endless wall,
/// however small it is, so that the surroundings of small things are too dark.
struct DistanceOcclusionIntegrator : FirstHit<DistanceOcclusionIntegrator> {
  SceneDistances distances;

  /// Distance R in scene units, above 0, beyond which surfaces occlude nothing, as in
  /// AmbientOcclusionIntegrator.
  double distance;

  /// Prepares the distances of a scene; pictures of that scene can then be drawn. Throws
  /// std::invalid_argument if no distance is known for a surface that emits no light.
  template <Surface... S>
  DistanceOcclusionIntegrator(const Scene<S...>& scene, double farthest)
      : distances(scene, "DistanceOcclusionIntegrator: "), distance(farthest) {}

  /// Throws std::invalid_argument unless the distance is finite and greater than 0. render calls it.
  void validate() const {
    if (!(distance > 0 && distance < infinity)) [[unlikely]]
      throw std::invalid_argument(
          "DistanceOcclusionIntegrator: distance must be finite and greater than 0; it is " +
          shown(distance));
  }

  [[nodiscard]] Color background(const auto&, const auto&) const { return Color{1}; }

  /// Throws std::logic_error if the scene is not the one of the distances.
  [[nodiscard]] Color shade(const Intersection& hit, const auto& scene) const {
    distances.require(scene);
    return Color{to_float(free_share(hit.point(), hit.facing_normal()))};
  }

  /// Returns the free share of the space over a point of a surface with a unit normal: from ½, with a surface
  /// at the point, to 1.
  [[nodiscard]] double free_share(const Point& point, const Vec3& normal) const {
    // sin α in the middles of eight equal parts of a right angle.
    constexpr double heights[] = {0.098017140329560604, 0.29028467725446233, 0.47139673682599764,
                                  0.63439328416364549,  0.77301045336273699, 0.88192126434835494,
                                  0.95694033573220894,  0.99518472667219682};
    double free = 1;
    for (const double x : heights) {
      const double h = x * distance, f = std::clamp(distances.distance_bound(point + h * normal), 0.0, h);
      free -= x * x / 8 * (1 - f / h);
    }
    return free;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
