// Asks a surface for its own intersect, and checks the answer.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>
#ifndef NDEBUG
#include <atomic>
#include <cstdio>
#endif

#include "interval.hpp"
#include "numeric/roots.hpp"
#include "ray.hpp"
#include "shown.hpp"
#include "surface_concepts.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

#ifndef NDEBUG
/// Warns on stderr that a surface's intersect returned a t outside its range. Only the first warning of the
/// program is printed, for whichever type comes first.
[[gnu::noinline, gnu::cold]] inline void warn_of_range(std::string_view type, double t, Interval range) {
  static std::atomic_flag is_told;
  if (is_told.test_and_set()) return;
  std::fprintf(
      stderr,
      "protostar: Surface %.*s: intersect returned t = %.17g, which is not inside the range that it was "
      "given; it must return the smallest t with %.17g < t < %.17g of a crossing, or none. Such a hit "
      "is left out, and with it those behind it: shadows or whole surfaces are missing.\n",
      static_cast<int>(type.size()), type.data(), t, range.min, range.max);
}
#endif

/// Returns the answer of a surface's own intersect; none if it is not inside the range, for which a debug
/// build, one without NDEBUG, calls warn_of_range.
///
/// A surface may ask one of the library's, which takes the range for that of exact roots. If the range begins
/// at a rounded root, the exact one may lie behind its beginning and is found again, with the same t. The
/// surface is then asked for a range that begins later: by one last place, and then by twice as much each
/// time, up to the largest error of a root. Answers nearer to the beginning than that are this root, or those
/// of a march that does not leave its start. At the end of the range, an exact root inside may have a rounded
/// one that is not: as in all of a surface of one's own, the rounded one counts.
template <Surface S>
[[nodiscard]] std::optional<double> own_intersect(const S& surface, const Ray& ray, Interval range) {
  std::optional<double> t = surface.intersect(ray, range);
  if (!t || range.contains(*t)) return t;
  [[maybe_unused]] const double first = *t;
  const double begin = std::abs(range.min), error = Roots::relative_error * begin;
  const auto is_at_beginning = [&] { return t && std::abs(*t - range.min) <= error; };
  for (double later = 0x1p-52 * begin; 0 < later && later < error && is_at_beginning(); later *= 2)
    t = surface.intersect(ray, {range.min + later, range.max});
  if (!t || (range.contains(*t) && !is_at_beginning())) return t;
#ifndef NDEBUG
  const double behind = first - range.max;
  if (!(0 <= behind && behind <= Roots::relative_error * std::abs(range.max)))
    warn_of_range(name_of_type<S>(), first, range);
#endif
  return std::nullopt;
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
