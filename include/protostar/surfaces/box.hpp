// The points from min to max, a solid with faces at right angles to the axes.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "../magnitude.hpp"
#include "../numeric/box_roots.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A box along the axes; min is nowhere above max. It may be flat.
///
/// Its parts are its faces: 0 and 1 where x is smallest and largest, 2 and 3 for y, 4 and 5 for z. Whether a
/// ray meets the box, and through which faces, is exact.
///
/// A ray that leaves a face of the box starts on it, whatever the digits of its origin say. If it leads
/// inwards, it crosses the box exactly once more, at t > 0: where it first crosses the plane of a face from
/// inside, or if the digits have that at t ≤ 0, since it starts in an edge, at the smallest t of all. If it
/// leads outwards or along the face, it does not cross the box. A ray that departs from the plane of a face,
/// but not from this box, starts anywhere in that plane: it does not cross this face, which is at t = 0, and
/// the others are what the digits say.
struct Box {
  Point min{-1}, max{1};

  /// Where a ray enters the box inside the range or, from inside, where it leaves it. Touching an edge or a
  /// vertex is a hit. Where faces are crossed at once, the one with the lowest number counts. A ray that
  /// departs from the plane of a face does not meet that face, and if it does not lead to the box's side of
  /// the plane, it does not meet the box.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    const auto crossing = first_crossing(ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    std::optional<Crossing> first;
    each_crossing(ray, range, [&](const Crossing& crossing) {
      if (!first) first = crossing;
    });
    return first;
  }

  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    const BoxStart start = start_of(ray);
    if (start.face >= 0 && !leads_inwards(ray, {start.face})) return;
    const BoxRoots met = roots(ray, start);
    for (int i = 0; i < met.roots.count(); ++i) {
      Crossing crossing{.t = met.roots[i], .part = met.face[i].number};
      if (start.is_in_box) crossing.t = std::max(crossing.t, smallest_t);
      if (crossing.part != start.face && lies_inside(*this, ray, crossing, range)) visit(crossing);
    }
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    const BoxStart start = start_of(ray);
    const ExactRoot root =
        exact_root_of(face_equation(line_of<ExactNumber>(ray), min, max, {crossing.part}, start));
    return start.is_in_box && root.b.sign() <= 0 ? exact_root_of(smallest_t) : root;
  }

  /// The unit normal of a face, outwards.
  [[nodiscard]] Vec3 normal_at(const Point&, int face) const { return outwards({face}); }

  /// Of the axes x, y, z, x, y, those two that come after the face's own: how far a point is from min along
  /// the first of them, and along the second.
  [[nodiscard]] Uv uv_at(const Point& point, int face) const {
    const int axis = BoxFace{face}.axis(), u = (axis + 1) % 3, v = (axis + 2) % 3;
    return {point[u] - min[u], point[v] - min[v]};
  }

  [[nodiscard]] int part_count() const { return 6; }

  /// What is inside has an end on every ray.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  [[nodiscard]] Bounds bounds() const { return {min, max}; }

  /// The plane of a face: what lies in it, or has a face in it, is left together with it.
  [[nodiscard]] Departure departure(int face) const {
    const BoxFace side{face};
    Departure departure{.kind = Departure::Kind::plane, .part = face, .object = this};
    departure.geometry[static_cast<std::size_t>(side.axis())] = 1;
    departure.geometry[3] = side.place(min, max);
    return departure;
  }

  /// Throws std::invalid_argument if min is above max on an axis, or a number is no coordinate
  /// (magnitude.hpp).
  void validate() const {
    const auto refuse = [](const std::string& what) { throw std::invalid_argument("Box: " + what); };
    for (int axis = 0; axis < 3; ++axis) {
      if (!is_coordinate(min[axis])) refuse(coordinate("min", min, axis) + " must be " + coordinate_rule);
      if (!is_coordinate(max[axis])) refuse(coordinate("max", max, axis) + " must be " + coordinate_rule);
      if (min[axis] > max[axis])
        refuse(coordinate("min", min, axis) + " must not be above " + coordinate("max", max, axis));
    }
  }

 private:
  /// As in "min.x = 0.1", with so many digits that no other double has the same.
  [[nodiscard]] static std::string coordinate(const std::string& name, const Point& point, int axis) {
    std::array<char, 32> digits{};  // -2.2250738585072014e-308, as long as any, has 24
    std::to_chars(digits.data(), digits.data() + digits.size(), point[axis]);
    return name + '.' + "xyz"[axis] + " = " + digits.data();
  }

  [[nodiscard]] static Vec3 outwards(BoxFace face) {
    Vec3 normal{0};
    normal[face.axis()] = face.is_upper() ? 1 : -1;
    return normal;
  }

  static constexpr double smallest_t = std::numeric_limits<double>::denorm_min();

  /// What a ray's departure says of its origin.
  [[nodiscard]] BoxStart start_of(const Ray& ray) const {
    const Departure& left = ray.departure;
    if (!left.is_planar()) return {};
    if (left.object == this) return {.face = left.part, .is_in_box = true};
    for (int face = 0; face < 6; ++face) {
      const bool may_be_parallel = left.geometry[static_cast<std::size_t>(BoxFace{face}.axis())] != 0;
      if (may_be_parallel && left == departure(face))
        return {.face = face, .is_at_0 = is_near(ray.origin, {face})};
    }
    return {};
  }

  /// Whether the digits of a point are those of a point in the plane of a face. They are off by 2^-52 of the
  /// coordinates, here or outside of an instance, and by more if the ray that met it came from much farther
  /// away. 2^-20 of the box leaves room for coordinates of 2^32 times its size; beyond that, the digits say
  /// where the point is, as they do for the trees that look for the box.
  [[nodiscard]] bool is_near(const Point& point, BoxFace face) const {
    const Vec3 size = max - min;
    const double off = std::abs(point[face.axis()] - face.place(min, max));
    return off <= 0x1p-20 * std::max({size.x, size.y, size.z});
  }

  /// Whether a ray leads from a face through the box. From one of a flat box, none does.
  [[nodiscard]] bool leads_inwards(const Ray& ray, BoxFace face) const {
    if (!(min[face.axis()] < max[face.axis()])) return false;
    const auto axis = static_cast<std::size_t>(face.axis());
    const double along = ray.direction[face.axis()];
    const int sign = ray.transform == nullptr
                         ? (along > 0) - (along < 0)
                         : sign_along(ray, [&](const auto& line) { return line.direction[axis]; });
    return face.is_upper() ? sign < 0 : sign > 0;
  }

  [[nodiscard]] BoxRoots roots(const Ray& ray, const BoxStart& start) const {
    if (ray.transform == nullptr) return box_roots(ray.origin, ray.direction, min, max, start);
    if (start.face < 0)
      if (const auto roots = rounded_box_roots(rounded_line(ray), min, max)) return *roots;
    if (!is_proper(ray)) return {};
    return decided(ray, [&](const auto& line) { return box_roots_along(line, min, max, start); });
  }
};

static_assert(CompositeSurface<Box> && SurfaceWithParts<Box> && SurfaceWithBounds<Box> && Solid<Box>);

}  // namespace protostar::inline PROTOSTAR_ABI
