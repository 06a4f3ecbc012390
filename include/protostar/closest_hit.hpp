// The first crossing of a ray: surfaces are looked at one after the other, and the best so far is kept.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A search for the first of a ray's crossings inside a range. It borrows the ray. The order is exact for
/// surfaces that can refine their roots; of crossings at equal t, that of the surface that was looked at
/// before is the first.
class ClosestHit {
 public:
  /// `first` becomes the first crossing of what is looked at; its surface is null until there is one.
  ClosestHit(const Ray& ray, const Interval& range, SurfaceCrossing& first)
      : ray_(ray), begin_(range.min), end_(range.max), first_(first) {}

  /// Looks at all surfaces of one type.
  template <Surface T>
  void look_at_all(const std::vector<T>& surfaces, const std::vector<Material>& materials) {
    if constexpr (SurfaceWithFirstRoot<T>)
      if (begin_ == 0) return look_for_first_roots(surfaces, materials);
    end_ = look_at_each(surfaces, materials, ray_, begin_, end_, first_);
  }

 private:
  static constexpr double error = Roots::relative_error;

  /// Looks at one, and returns where the range ends now. Each hit shortens it, so the last hit is the
  /// nearest. What might be before it, given its error, stays in.
  template <Surface T>
  static double look_at(const T& surface, const Material& material, const Ray& ray, Interval range,
                        SurfaceCrossing& first) {
    const auto crossing = first_crossing(surface, ray, range);
    if (!crossing) return range.max;
    const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
    if (first.surface != nullptr && !precedes(ray, candidate, first)) return range.max;
    first = candidate;
    return std::min(range.max, latest(crossing->t));
  }

  template <Surface T>
  [[gnu::noinline]] static double look_at_each(const std::vector<T>& surfaces,
                                               const std::vector<Material>& materials, const Ray& ray,
                                               double begin, double end, SurfaceCrossing& first) {
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      end = look_at(surfaces[i], materials[i], ray, {begin, end}, first);
    return end;
  }

  /// Where double tells the order, a surface is a few comparisons. What is below `sooner` is surely before
  /// the first and inside the range, and what is not below `later` surely not (docs/numerics.md, Which comes
  /// first).
  template <Surface T>
  void look_for_first_roots(const std::vector<T>& surfaces, const std::vector<Material>& materials) {
    const typename T::Line line(ray_);
    double sooner = (1 - 8 * error) * end_, later = (1 + 2 * error) * end_;
    for (const T& surface : std::span(surfaces)) {
      const FirstRoot root = surface.first_root(line);
      if (root.known == FirstRoot::Known::no_root) continue;
      const bool is_known = root.known == FirstRoot::Known::root;
      if (is_known && root.t >= later) continue;
      const Material& material = materials[static_cast<std::size_t>(&surface - surfaces.data())];
      if (is_known && root.t < sooner) {
        first_ = crossing_on(surface, {root.t, root.root}, material);
        end_ = (1 + 4 * error) * root.t;  // less than it was
      } else {
        end_ = look_closer_at(surface, material, ray_, end_, first_);
      }
      sooner = (1 - 8 * error) * end_, later = (1 + 2 * error) * end_;
    }
  }

  [[gnu::noinline, gnu::cold]] static double look_closer_at(const auto& surface, const Material& material,
                                                            const Ray& ray, double end,
                                                            SurfaceCrossing& first) {
    return look_at(surface, material, ray, {0, end}, first);
  }

  const Ray& ray_;
  double begin_, end_;
  SurfaceCrossing& first_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
