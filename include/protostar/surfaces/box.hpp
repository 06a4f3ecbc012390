// A solid box between the points min and max, with faces perpendicular to the axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "../magnitude.hpp"
#include "../numeric/box_roots.hpp"
#include "../shown.hpp"
#include "../surface.hpp"
#include "../transformed_ray.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A box along the axes; min is nowhere above max. It may be flat.
///
/// Its parts are its faces: 0 and 1 at the smallest and largest x, 2 and 3 for y, 4 and 5 for z. Hits, and
/// the faces that are hit, are decided exactly.
///
/// A ray that leaves a face of the box starts on it, however its origin is rounded. If it leads inward, it
/// crosses the box exactly once more, at t > 0: at the first plane of a face that it crosses from inside or,
/// if the digits put that at t ≤ 0 because the ray starts in an edge, at the smallest positive double. If it
/// leads outward or along the face, it does not cross the box. A ray that departs from the plane of a face,
/// but not from this box, starts anywhere in that plane: it does not cross this face, which is at t = 0, and
/// its digits decide on the other faces.
struct Box {
  Point min{-1}, max{1};

  /// Returns t of the closest hit in the range, at which the ray enters the box or, from inside, leaves it.
  /// Touching an edge or a vertex is a hit. If faces are crossed at once, the one with the lowest index
  /// counts. A ray that departs from the plane of a face does not hit that face, and if it does not lead to
  /// the box's side of the plane, it does not hit the box.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
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

  /// Returns the outward unit normal of a face.
  [[nodiscard]] Vec3 normal_at(const Point&, int face) const { return outwards({face}); }

  /// Returns how far a point is from min along the two axes that follow the face's own in the cycle x, y, z.
  [[nodiscard]] Uv uv_at(const Point& point, int face) const {
    const int axis = BoxFace{face}.axis(), u = (axis + 1) % 3, v = (axis + 2) % 3;
    return {point[u] - min[u], point[v] - min[v]};
  }

  [[nodiscard]] int part_count() const { return 6; }

  /// Returns false: the inside is bounded on every ray.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  [[nodiscard]] Bounds bounds() const { return {min, max}; }

  /// Returns the plane of a face; surfaces and faces in one plane are left together.
  [[nodiscard]] Departure departure(int face) const {
    const BoxFace side{face};
    Departure departure{.kind = Departure::Kind::plane, .part = face, .object = this};
    departure.geometry[static_cast<std::size_t>(side.axis())] = 1;
    departure.geometry[3] = side.place(min, max);
    return departure;
  }

  /// Throws std::invalid_argument if min is above max on an axis, or a number is not a coordinate
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
  /// Formats as in "min.x = 0.1", with enough digits to tell the number from any other double.
  [[nodiscard]] static std::string coordinate(const std::string& name, const Point& point, int axis) {
    return name + '.' + "xyz"[axis] + " = " + shown(point[axis]);
  }

  [[nodiscard]] static Vec3 outwards(BoxFace face) {
    Vec3 normal{0};
    normal[face.axis()] = face.is_upper() ? 1 : -1;
    return normal;
  }

  static constexpr double smallest_t = std::numeric_limits<double>::denorm_min();

  /// Derives the start of a ray relative to the box from the ray's departure.
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

  /// Returns true if the digits of a point may be those of a point in the plane of a face. They are off by
  /// 2^-52 of the coordinates, here or outside of an instance, and by more if the ray that hit it came from
  /// much farther away. 2^-20 of the box's size leaves room for coordinates of 2^32 times that size; beyond
  /// that, the digits say where the point is, as they do for the BVH traversals that look for the box.
  [[nodiscard]] bool is_near(const Point& point, BoxFace face) const {
    const Vec3 size = max - min;
    const double off = std::abs(point[face.axis()] - face.place(min, max));
    return off <= 0x1p-20 * std::max({size.x, size.y, size.z});
  }

  /// Returns true if the ray leads from a face into the box; never if the box is flat on the face's axis.
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

static_assert(CompositeSurface<Box> && is_made_of_parts<Box> && SurfaceWithBounds<Box> && Solid<Box>);

}  // namespace protostar::inline PROTOSTAR_ABI
