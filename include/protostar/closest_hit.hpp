// Search for the closest hit of a ray: surfaces are tested one after the other, and the best hit is kept.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Search for the closest hit of a ray in a range. It borrows the ray. The order is exact for surfaces that
/// can refine their roots. Among hits at equal t, the surface tested first wins.
class ClosestHit {
 public:
  /// Starts a search that writes the closest hit so far to `first`, whose surface is null until there is one.
  ClosestHit(const Ray& ray, const Interval& range, SurfaceCrossing& first)
      : ray_(ray), begin_(range.min), end_(range.max), first_(first) {}

  /// Tests all surfaces of one type.
  template <Surface T>
  void test_all(const std::vector<T>& surfaces, const std::vector<Material>& materials) {
    if constexpr (SurfaceWithEquation<T> && !SurfaceWithRoots<T>)
      if (begin_ == 0 && ray_.transform == nullptr) return test_first_roots(surfaces, materials);
    end_ = test_each(surfaces, materials, ray_, begin_, end_, first_);
  }

 private:
  static constexpr double error = Roots::relative_error;

  /// Tests one surface. If its first crossing precedes `first`, stores it there. Returns the new end of the
  /// range: crossings that may still precede `first`, given the error of t, lie before it.
  template <Surface T>
  static double test_one(const T& surface, const Material& material, const Ray& ray, Interval range,
                         SurfaceCrossing& first) {
    const auto crossing = first_crossing(surface, ray, range);
    if (!crossing) return range.max;
    const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
    if (first.surface != nullptr && !precedes(ray, candidate, first)) return range.max;
    first = candidate;
    return std::min(range.max, upper_bound_of(crossing->t));
  }

  template <Surface T>
  [[gnu::noinline]] static double test_each(const std::vector<T>& surfaces,
                                            const std::vector<Material>& materials, const Ray& ray,
                                            double begin, double end, SurfaceCrossing& first) {
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      end = test_one(surfaces[i], materials[i], ray, {begin, end}, first);
    return end;
  }

  /// Tests surfaces with an equation by their first roots, for a ray that no instance has mapped and a range
  /// that begins at 0: if double decides the order, each takes a few comparisons. A root below `sooner`
  /// surely precedes the closest hit so far and lies in the range; one not below `later` surely does not
  /// (docs/derivations.md, Which comes first).
  template <Surface T>
  void test_first_roots(const std::vector<T>& surfaces, const std::vector<Material>& materials) {
    // The ray without its departure, copied: what its equation has in common with all surfaces is computed
    // once.
    const struct {
      Point origin;
      Vec3 direction;
    } line{ray_.origin, ray_.direction};
    const bool departs = ray_.departure.kind != Departure::Kind::none;
    double sooner = (1 - 8 * error) * end_, later = (1 + 2 * error) * end_;
    for (const T& surface : std::span(surfaces)) {
      const auto root = first_root_of_each(surface.equation(line), true);
      const bool is_known = !root.in_doubt && !(departs && surface.is_left_by(ray_));
      if (is_known && !(root.is_there && root.t < later)) continue;
      const Material& material = materials[static_cast<std::size_t>(&surface - surfaces.data())];
      if (is_known && root.t < sooner) {
        first_ = crossing_on(surface, {root.t, root.is_far}, material);
        end_ = (1 + 4 * error) * root.t;  // less than before
      } else {
        end_ = test_closer(surface, material, ray_, end_, first_);
      }
      sooner = (1 - 8 * error) * end_, later = (1 + 2 * error) * end_;
    }
  }

  [[gnu::noinline, gnu::cold]] static double test_closer(const auto& surface, const Material& material,
                                                         const Ray& ray, double end, SurfaceCrossing& first) {
    return test_one(surface, material, ray, {0, end}, first);
  }

  const Ray& ray_;
  double begin_, end_;
  SurfaceCrossing& first_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
