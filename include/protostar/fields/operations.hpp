// Operations on fields: combinations of shapes, other surfaces of a shape, and fields of moved points.
//
// Each is a field of the fields that it takes, such as unite(Sphere{1}, Moved{Box{}, Vec3{0, 1, 0}}). Its
// comment says what the operation makes of distances and of bounds. A bound is a field whose value is nowhere
// larger in magnitude than the distance (shapes.hpp). A combination of distances that is only a bound
// still has the surface of the combined shapes. Lengths are in scene units.
//
// Each operation has three functions: its value at a point, with any number type; bounds(level), a box that
// contains all points where the field is at most `level` ≥ 0, but for roundings; and validate(), which throws
// std::invalid_argument if one of its numbers or of its fields is not valid.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "../bounds.hpp"
#include "../exact/field_point.hpp"
#include "../interval.hpp"
#include "../magnitude.hpp"
#include "../numeric/affine.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI::fields {

// ---- Rules by which values are joined. join(a, b) returns the joined value, and for two boxes, those of
// both fields up to level_of_parts(level), a box of the points where the joined value is at most `level`.

/// Union: the smaller value. For distances it is the distance outside, and a bound inside.
struct Smaller {
  template <class T>
  [[nodiscard]] T join(const T& a, const T& b) const {
    return min(a, b);
  }
  /// Level to which the fields may rise where their union is at most `level`.
  [[nodiscard]] double level_of_parts(double level) const { return level; }
  [[nodiscard]] Bounds join(const Bounds& a, const Bounds& b) const {
    Bounds all = a;
    for (int k = 0; k < 3; ++k)
      all.min[k] = std::min(a.min[k], b.min[k]), all.max[k] = std::max(a.max[k], b.max[k]);
    return all;
  }
};

/// Intersection: the larger value. For distances it is the distance inside, and a bound outside.
struct Larger {
  template <class T>
  [[nodiscard]] T join(const T& a, const T& b) const {
    return max(a, b);
  }
  [[nodiscard]] double level_of_parts(double level) const { return level; }
  [[nodiscard]] Bounds join(const Bounds& a, const Bounds& b) const {
    Bounds common = a;
    for (int k = 0; k < 3; ++k)
      common.min[k] = std::max(a.min[k], b.min[k]), common.max[k] = std::min(a.max[k], b.max[k]);
    return common;
  }
};

/// Difference: the first shape without the others, max(a, −b). For distances and bounds it is a bound.
struct Without {
  template <class T>
  [[nodiscard]] T join(const T& a, const T& b) const {
    return max(a, -b);
  }
  [[nodiscard]] double level_of_parts(double level) const { return level; }
  [[nodiscard]] Bounds join(const Bounds& a, const Bounds&) const { return a; }
};

/// Smooth union: Quilez' polynomial minimum, min(a, b) − max(w − |a − b|, 0)²/(4w), below the minimum by at
/// most w/4 where the values differ by less than w (https://iquilezles.org/articles/smin). For distances and
/// bounds it is a bound.
struct SmoothlySmaller {
  double width = 0.25;  ///< w, a difference of values above 0

  template <class T>
  [[nodiscard]] T join(const T& a, const T& b) const {
    return smooth_min(a, b, width);
  }
  [[nodiscard]] double level_of_parts(double level) const { return level + 0.25 * width; }
  [[nodiscard]] Bounds join(const Bounds& a, const Bounds& b) const { return Smaller{}.join(a, b); }
  void validate() const { require_size(width, "fields::SmoothlySmaller: width must be"); }
};

/// Two fields, joined by a rule.
template <class Rule, class A, class B>
struct Joined {
  A a;
  B b;
  Rule rule = {};

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return rule.join(a(p), b(p));
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const double of_parts = rule.level_of_parts(level);
    return rule.join(a.bounds(of_parts), b.bounds(of_parts));
  }
  void validate() const { validate_each(a, b, rule); }
};

/// Any number of fields of one type, at least one, joined by a rule from the first to the last.
template <class Rule, class F>
struct JoinedList {
  std::vector<F> fields;
  Rule rule = {};

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    T value = fields.front()(p);
    for (std::size_t i = 1; i < fields.size(); ++i) value = rule.join(value, fields[i](p));
    return value;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    // The last fields are joined once, the first as often as there are others.
    for (std::size_t i = 1; i < fields.size(); ++i) level = rule.level_of_parts(level);
    Bounds all = fields.front().bounds(level);
    for (std::size_t i = 1; i < fields.size(); ++i) all = rule.join(all, fields[i].bounds(level));
    return all;
  }
  void validate() const {
    if (fields.empty()) throw std::invalid_argument("fields::JoinedList: fields must not be empty");
    validate_each(rule);
    for (const F& field : fields) validate_each(field);
  }
};

/// Returns the union of two fields.
template <class A, class B>
[[nodiscard]] Joined<Smaller, A, B> unite(A a, B b) {
  return {std::move(a), std::move(b)};
}
/// Returns the intersection of two fields.
template <class A, class B>
[[nodiscard]] Joined<Larger, A, B> intersect(A a, B b) {
  return {std::move(a), std::move(b)};
}
/// Returns the shape of the first field without that of the second.
template <class A, class B>
[[nodiscard]] Joined<Without, A, B> subtract(A a, B b) {
  return {std::move(a), std::move(b)};
}
/// Returns the smooth union of two fields whose values are blended where they differ by less than `width`.
template <class A, class B>
[[nodiscard]] Joined<SmoothlySmaller, A, B> blend(A a, B b, double width) {
  return {std::move(a), std::move(b), {width}};
}

// ---- Other surfaces of one field.

/// Shell around the surface of a field: |value| − thickness/2. A distance near the surface of a distance,
/// whose wall has that thickness. The wall of a bound is thicker.
template <class F>
struct Shell {
  F field;
  double thickness = 0.1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return abs(field(p)) - 0.5 * thickness;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return field.bounds(level + 0.5 * thickness); }
  void validate() const { validate_each(field), require_size(thickness, "fields::Shell: thickness must be"); }
};
template <class F>
Shell(F, double) -> Shell<F>;

/// Shape that is larger by a radius on all sides, whose corners and edges are round: value − radius. For a
/// distance it is the distance outside, and a bound inside. The shape of a bound grows by more than the
/// radius in places, and the result is a bound.
template <class F>
struct Rounded {
  F field;
  double radius = 0.1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return field(p) - radius;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return field.bounds(level + radius); }
  void validate() const { validate_each(field), require_size(radius, "fields::Rounded: radius must be"); }
};
template <class F>
Rounded(F, double) -> Rounded<F>;

// ---- Fields of moved points: the shape moves by the inverse of the map of the points.

/// Shape moved by a vector. The field keeps its kind: distance, bound or implicit (shapes.hpp).
template <class F>
struct Moved {
  F field;
  Vec3 by{0};

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return field(p - by);
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const Bounds own = field.bounds(level);
    return {own.min + by, own.max + by};
  }
  void validate() const {
    validate_each(field), require_coordinate(by, "fields::Moved: each number of by must be");
  }
};
template <class F>
Moved(F, Vec3) -> Moved<F>;

/// Shape rotated about an axis through the origin. It keeps its kind, but for rounding. With u = 2^-53, the
/// unit vector of the axis has a length off by less than 5u, of which the rotation takes up to 4 times as
/// much, and its nine numbers are rounded, by less than 20u together: the matrix is off by less than 40u, and
/// lengths change by a share of less than 2^-47.
template <class F>
class Rotated {
 public:
  /// Takes an axis, of any length but 0, and the angle in degrees: by 90 about z, x goes to y. Throws
  /// std::invalid_argument for other axes, and for numbers that are not finite.
  Rotated(F field, const Vec3& axis, double degrees)
      : field_(std::move(field)), turned_(Affine{}.rotated_about(axis, degrees)) {
    if (!is_finite(axis) || axis == Vec3{0})
      detail::refuse_found("fields::Rotated: axis must be finite, and not (0, 0, 0)", axis);
    if (!std::isfinite(degrees)) detail::refuse_found("fields::Rotated: degrees must be finite", degrees);
  }

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return field_(FieldPoint<T>{dot(p, turned_.x), dot(p, turned_.y), dot(p, turned_.z)});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const Bounds own = field_.bounds(level);
    if (!is_finite(own)) return {Point(-infinity), Point(infinity)};
    const Vec3 half = 0.5 * (own.max - own.min);
    const Vec3 reach = half.x * abs(turned_.x) + half.y * abs(turned_.y) + half.z * abs(turned_.z);
    const Point center = turned_.vector(0.5 * (own.min + own.max));
    return {center - reach, center + reach};
  }

  [[nodiscard]] const F& field() const { return field_; }
  void validate() const { validate_each(field_); }

 private:
  F field_;
  Affine turned_;  ///< images of the axes
};

/// Shape scaled by a factor above 0: factor · value at p/factor. It keeps its kind. 1/factor is rounded, so
/// that the shape is larger or smaller by a share of 2^-53.
template <class F>
struct Scaled {
  F field;
  double factor = 1;

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    return field(p * T(1 / factor)) * factor;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const Bounds own = field.bounds(level / factor);
    return {factor * own.min, factor * own.max};
  }
  void validate() const { validate_each(field), require_size(factor, "fields::Scaled: factor must be"); }
};
template <class F>
Scaled(F, double) -> Scaled<F>;

/// Returns a box around the points of another, turned by any angles about an axis.
[[nodiscard]] inline Bounds turned_about(int axis, const Bounds& box) {
  double squares = 0;
  for (int k = 0; k < 3; ++k)
    if (k != axis) {
      const double far = std::max(std::abs(box.min[k]), std::abs(box.max[k]));
      squares += far * far;
    }
  Bounds turned{Point(-std::sqrt(squares)), Point(std::sqrt(squares))};
  turned.min[axis] = box.min[axis], turned.max[axis] = box.max[axis];
  return turned;
}

/// Shape twisted about the y axis: at the height y it is turned by y times a rate, from z towards x.
/// Implicit: at a distance r from the axis it is sheared by s = rate · r, the rate in radians, so that
/// lengths are changed by factors of up to s/2 + √(1 + s²/4).
template <class F>
struct Twisted {
  F field;
  double degrees = 90;  ///< angle for each unit of length along y

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    const T angle = p.y * (degrees * (0x1.921fb54442d18p+1 / 180));
    const T sine = sin(angle), cosine = cos(angle);
    return field(FieldPoint<T>{p.x * cosine - p.z * sine, p.y, p.x * sine + p.z * cosine});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return turned_about(1, field.bounds(level)); }
  void validate() const {
    validate_each(field), require_coordinate(degrees, "fields::Twisted: degrees must be");
  }
};
template <class F>
Twisted(F, double) -> Twisted<F>;

/// Shape bent in the plane of x and y: at x it is turned about the z axis by x times a rate, from y towards
/// x, so that both ends of a bar along x bend towards −y if the rate is above 0. Implicit.
template <class F>
struct Bent {
  F field;
  double degrees = 30;  ///< angle for each unit of length along x

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    const T angle = p.x * (degrees * (0x1.921fb54442d18p+1 / 180));
    const T sine = sin(angle), cosine = cos(angle);
    return field(FieldPoint<T>{p.x * cosine - p.y * sine, p.x * sine + p.y * cosine, p.z});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const { return turned_about(2, field.bounds(level)); }
  void validate() const {
    validate_each(field), require_coordinate(degrees, "fields::Bent: degrees must be");
  }
};
template <class F>
Bent(F, double) -> Bent<F>;

/// Copies of a shape without end, in cells around multiples of `cell` along each axis where that is above 0;
/// a copy is the mirror image of its neighbors. Hence the field does not jump at the border of two cells,
/// whatever the shape, and what reaches beyond a cell is cut there. For distances and bounds it is a bound.
/// In a cell each coordinate is from −cell/2 to cell/2: cell · (fold(x/cell + ½) − ½), with 1/cell rounded.
template <class F>
struct Mirrored {
  F field;
  Vec3 cell{1, 1, 1};

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    const auto in_cell = [](const T& x, double c) { return c > 0 ? (fold(x * (1 / c) + 0.5) - 0.5) * c : x; };
    return field(FieldPoint<T>{in_cell(p.x, cell.x), in_cell(p.y, cell.y), in_cell(p.z, cell.z)});
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    Bounds all = field.bounds(level);
    for (int k = 0; k < 3; ++k)
      if (cell[k] > 0) all.min[k] = -infinity, all.max[k] = infinity;
    return all;
  }
  void validate() const {
    validate_each(field);
    for (const double side : {cell.x, cell.y, cell.z})
      if (side != 0) require_size(side, "fields::Mirrored: each number of cell must be 0 or");
  }
};
template <class F>
Mirrored(F, Vec3) -> Mirrored<F>;

/// Copies of a shape at the multiples of a step along each axis, from 0 on, as many as `count` says: their
/// union, with all neighbors that reach over the border of a cell. For a distance it is the distance outside,
/// and a bound inside. Each evaluation takes one of the field for each copy, of which there are at most
/// most_copies.
template <class F>
struct Repeated {
  F field;
  Vec3 step{1, 1, 1};
  int count[3] = {2, 1, 1};

  /// Largest number of copies.
  static constexpr int most_copies = 1024;

  [[nodiscard]] int copies() const { return count[0] * count[1] * count[2]; }

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const {
    T value = field(p);
    for (int i = 1; i < copies(); ++i) value = min(value, field(p - place(i)));
    return value;
  }
  [[nodiscard]] Bounds bounds(double level = 0) const {
    const Bounds own = field.bounds(level),
                 last{own.min + place(copies() - 1), own.max + place(copies() - 1)};
    return Smaller{}.join(own, last);
  }
  void validate() const {
    if (!(count[0] > 0 && count[1] > 0 && count[2] > 0 && count[0] <= most_copies &&
          count[1] <= most_copies && count[0] * count[1] <= most_copies && count[2] <= most_copies &&
          copies() <= most_copies))
      detail::refuse_found("fields::Repeated: count must be above 0 along each axis, and 1024 in all at most",
                           Vec3(count[0], count[1], count[2]));
    validate_each(field);
    require_coordinate(step, "fields::Repeated: each number of step must be");
  }

 private:
  /// Returns the vector by which copy i is moved, for i from 0 to copies() − 1; x counts first, z last.
  [[nodiscard]] Vec3 place(int i) const {
    return {step.x * (i % count[0]), step.y * (i / count[0] % count[1]), step.z * (i / count[0] / count[1])};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::fields
