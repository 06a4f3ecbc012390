// The points from min to max, a solid with faces at right angles to the axes.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "../numeric/box_roots.hpp"
#include "../surface.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A box along the axes; min is nowhere above max. It may be flat.
///
/// Its parts are its faces: 0 and 1 where x is smallest and largest, 2 and 3 for y, 4 and 5 for z. Whether a
/// ray meets the box, and through which faces, is exact for numbers whose sizes in one test differ by less
/// than 2^400.
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
    const int left = face_left_by(ray);
    if (left >= 0 && !leads_inwards(ray.direction, {left})) return;
    const BoxRoots met = box_roots(ray.origin, ray.direction, min, max, left);
    for (int i = 0; i < met.roots.count(); ++i) {
      const Crossing crossing{.t = met.roots[i], .part = met.face[i].number};
      if (crossing.part != left && lies_inside(*this, ray, crossing, range)) visit(crossing);
    }
  }

  [[nodiscard]] RefinedCrossing refine(const Ray& ray, const Crossing& crossing, Precision) const {
    const RefinedRoots root = refined_box_root(ray.origin, ray.direction, min, max, {crossing.part});
    return {root.t[0], root.relative_error};
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return exact_box_root(ray.origin, ray.direction, min, max, {crossing.part});
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
    Departure departure{.kind = Departure::Kind::plane};
    departure.geometry[static_cast<std::size_t>(side.axis())] = 1;
    departure.geometry[3] = side.place(min, max);
    return departure;
  }

  /// Throws std::invalid_argument if min is above max on an axis, or a number is not finite.
  void validate() const {
    const auto refuse = [](const std::string& what) { throw std::invalid_argument("Box: " + what); };
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(min[axis])) refuse(coordinate("min", min, axis) + " must be finite");
      if (!std::isfinite(max[axis])) refuse(coordinate("max", max, axis) + " must be finite");
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

  /// Whether a direction leads from a face through the box. From one of a flat box, no direction does.
  [[nodiscard]] bool leads_inwards(const Vec3& direction, BoxFace face) const {
    const double along = direction[face.axis()];
    return min[face.axis()] < max[face.axis()] && (face.is_upper() ? along < 0 : along > 0);
  }

  /// The face that lies in the plane that a ray departs from; −1 if none does.
  [[nodiscard]] int face_left_by(const Ray& ray) const {
    if (!ray.departure.is_planar()) return -1;
    for (int face = 0; face < 6; ++face) {
      const bool may_be_parallel =
          ray.departure.geometry[static_cast<std::size_t>(BoxFace{face}.axis())] != 0;
      if (may_be_parallel && ray.departure == departure(face)) return face;
    }
    return -1;
  }
};

static_assert(CompositeSurface<Box> && SurfaceWithParts<Box> && SurfaceWithBounds<Box> && Solid<Box>);

}  // namespace protostar::inline PROTOSTAR_ABI
