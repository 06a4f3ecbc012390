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
      : ray_(ray), range_(range), first_(first) {}

  /// Looks at all surfaces of one type.
  template <Surface T>
  void look_at_all(const std::vector<T>& surfaces, const std::vector<Material>& materials) {
    if constexpr (SurfaceWithFirstRoot<T>)
      if (range_.min == 0) return look_for_first_roots(surfaces, materials);
    for (std::size_t i = 0; i < surfaces.size(); ++i) look_at(surfaces[i], materials[i]);
  }

  /// Looks at one.
  template <Surface T>
  void look_at(const T& surface, const Material& material) {
    const auto crossing = first_crossing(surface, ray_, range_);
    if (!crossing) return;
    const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
    if (first_.surface == nullptr || precedes(ray_, candidate, first_)) take(candidate);
  }

 private:
  static constexpr double error = Roots::relative_error;

  /// Each hit shortens the range, so the last hit is the nearest. What might be before it, given its error,
  /// stays in.
  void take(const SurfaceCrossing& candidate) {
    first_ = candidate;
    range_.max = std::min(range_.max, latest(candidate.crossing.t));
  }

  /// Where double tells the order, a surface is a few comparisons. What is below `sooner` is surely before
  /// the first and inside the range, and what is not below `later` surely not (docs/numerics.md, Which comes
  /// first).
  template <Surface T>
  void look_for_first_roots(const std::vector<T>& surfaces, const std::vector<Material>& materials) {
    const typename T::Line line(ray_);
    double sooner = (1 - 8 * error) * range_.max, later = (1 + 2 * error) * range_.max;
    for (const T& surface : std::span(surfaces)) {
      const FirstRoot root = surface.first_root(line);
      if (root.known == FirstRoot::Known::no_root) continue;
      const bool is_known = root.known == FirstRoot::Known::root;
      if (is_known && root.t >= later) continue;
      const Material& material = materials[static_cast<std::size_t>(&surface - surfaces.data())];
      if (is_known && root.t < sooner) {
        first_ = crossing_on(surface, {root.t, root.root}, material);
        range_.max = (1 + 4 * error) * root.t;  // less than it was
      } else {
        look_closer_at(surface, material);
      }
      sooner = (1 - 8 * error) * range_.max, later = (1 + 2 * error) * range_.max;
    }
  }

  [[gnu::noinline, gnu::cold]] void look_closer_at(const auto& surface, const Material& material) {
    look_at(surface, material);
  }

  const Ray& ray_;
  Interval range_;
  SurfaceCrossing& first_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
