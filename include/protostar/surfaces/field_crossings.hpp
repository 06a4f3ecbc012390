// Crossings of a ray with a marched surface, by a search along the ray or its whole line, and their exact
// roots.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "../intersection.hpp"
#include "../march/field_roots.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Crossings of a ray with the surface of a field. A search goes along the ray, or its whole line, and
/// numbers what it finds: by even numbers along the ray and by odd ones along the line, since the two may
/// find the same crossing with other last digits of t.
template <class F>
class FieldCrossings {
 public:
  /// Takes a ray, and whether it leaves the surface.
  FieldCrossings(const F& field, const MarchSetup& setup, const Ray& ray, bool leaves)
      : field_(field), setup_(setup), ray_(ray), leaves_(leaves) {}

  /// Calls visit(const Crossing&, const MarchedRoot&, const Enclosure<DoubleDouble>&) for the crossings, by
  /// increasing t, until it returns true. If the range has parameters below 0, the search is along the whole
  /// line; otherwise it is along the ray, from t = 0. Besides that, the range only ends the search, and
  /// changes no digit of t. The first two arguments have parameters of the ray; the third encloses that of
  /// the FieldLine, with all digits.
  void each(Interval range, auto& trace, const auto& visit) const {
    if (!is_proper(ray_)) return;
    FieldLine line(field_, setup_, ray_, trace);
    const Interval span = line.span();
    if (!(span.min < span.max)) return;
    int number = range.min < 0 ? 1 : 0;
    const auto visit_next = [&](const MarchedRoot& root, const Enclosure<DoubleDouble>& enclosure) {
      const MarchedRoot of_ray{root.answer, root.min * line.unit(), root.max * line.unit()};
      const Crossing crossing{of_ray.t(), std::exchange(number, number + 2)};
      return visit(crossing, of_ray, enclosure);
    };
    if (range.min < 0 && leaves_ && span.min < 0) {
      std::vector<std::pair<MarchedRoot, Enclosure<DoubleDouble>>> behind;
      const Ray back = ray_.reversed();
      FieldLine line_back(field_, setup_, back, trace);
      each_root(line_back, 0, infinity, true, [&](const MarchedRoot& root, const auto& enclosure) {
        behind.push_back({{root.answer, -root.max, -root.min}, -enclosure});
        return false;
      });
      for (auto root = behind.rbegin(); root != behind.rend(); ++root)
        if (visit_next(root->first, root->second)) return;
    }
    const double begin = leaves_ ? 0 : range.min < 0 ? span.min : std::max(0.0, span.min);
    each_root(line, begin, range.max / line.unit(), leaves_, visit_next);
  }

  /// Returns the root of a crossing, narrowed in double-double. A ray may cross the surface several times at
  /// one t, so the search that found it is made again, and the crossing known by its t and number. One that
  /// comes from a march in lanes has the number 0, and is the first with its t. Where double-double does not
  /// tell that the surface is crossed, the root has the error of a march: 2^-30 of itself, or of half the
  /// size of the bounds if that is more.
  [[nodiscard]] ExactRoot exact_root(const Crossing& crossing) const {
    NoTrace trace;
    FieldLine line(field_, setup_, ray_, trace);
    if (leaves_) line.leave_level();
    const double t = crossing.t / line.unit();
    const double error = enclosure_width * std::max(std::abs(t), line.extent());
    ExactRoot root{.A = 1.0, .b = t, .D = {}, .error = error};
    bool is_found = false;
    const auto visit = [&](const Crossing& other, const MarchedRoot& found, const auto& enclosure) {
      if (other.t == crossing.t && (!is_found || other.root == crossing.root)) {
        is_found = true;
        if (found.answer == MarchedRoot::Answer::hit) root = exact_root_in(line, enclosure);
      }
      return other.t > crossing.t;
    };
    each({crossing.root % 2 != 0 ? -infinity : 0, infinity}, trace, visit);
    root.b = root.b * line.unit(), root.error = root.error * line.unit();
    return root;
  }

 private:
  const F& field_;
  const MarchSetup& setup_;
  const Ray& ray_;
  bool leaves_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
