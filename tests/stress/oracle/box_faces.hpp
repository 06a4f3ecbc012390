// Faces of a box through which a line enters and leaves it, in numbers of any type.
#pragma once

#include <optional>
#include <protostar/surfaces/box.hpp>
#include <vector>

#include "equations.hpp"

namespace exact {

/// Face of a box in whose plane a ray starts by its departure, −1 if none; is_own if it leaves this box's
/// face.
struct LeftOfBox {
  int face = -1;
  bool is_own = false;
};

/// Equation slope · t = height of the crossing with the plane of a box's face. A line that leaves the face
/// crosses it at t = 0, whatever its digits are.
template <class T>
struct FaceEquation {
  T slope, height;

  FaceEquation(const Line<T>& line, const protostar::Box& box, int face, const LeftOfBox& left = {})
      : slope(face / 2 == 0   ? line.direction.x
              : face / 2 == 1 ? line.direction.y
                              : line.direction.z) {
    const Vector<T> from_min = line.to(box.min), from_max = line.to(box.max);
    const Vector<T>& from = face % 2 ? from_max : from_min;
    height = face == left.face ? T(0.0) : face / 2 == 0 ? from.x : face / 2 == 1 ? from.y : from.z;
  }

  /// Returns true if the crossing is a point of the box, on the outer side of no other face; nothing if 128
  /// digits do not decide. Points with t > 0 are on the inner side of the face that is left, if the line
  /// leads inwards there.
  [[nodiscard]] std::optional<bool> is_in_box(const Line<T>& line, const protostar::Box& box,
                                              const LeftOfBox& left = {}) const {
    for (int other = 0; other < 6; ++other) {
      const FaceEquation of_other(line, box, other);
      // (position of the face − position of the point) · weight · slope; positive is inside of an upper face.
      T beyond = of_other.height * slope - of_other.slope * height;
      if (other % 2 == 0) beyond = -beyond;
      if (other == left.face) beyond = height;
      if constexpr (requires { beyond.is_known(); })
        if (!beyond.is_known() || !line.weight.is_known() || !slope.is_known()) return std::nullopt;
      const int weight_sign = other == left.face ? 1 : line.weight.sign();
      if (beyond.sign() * slope.sign() * weight_sign < 0) return false;
    }
    return true;
  }
};

/// Returns true if a line leads from a face through the box; nothing if 128 digits do not decide.
template <class T>
std::optional<bool> leads_inwards(const Line<T>& line, const protostar::Box& box, int face) {
  const FaceEquation<T> e(line, box, face);
  if constexpr (requires { e.slope.is_known(); })
    if (!e.slope.is_known() || !line.weight.is_known()) return std::nullopt;
  const bool is_flat = box.min[face / 2] == box.max[face / 2];
  return !is_flat && e.slope.sign() * line.weight.sign() * (face % 2 ? -1 : 1) > 0;
}

/// Returns the faces through which a line enters and leaves a box, or nothing if 128 digits do not decide:
/// for each direction, the first face that it crosses in a point of the box. A ray that leaves a face of the
/// box inwards is in the box and only leaves it: through the face whose plane it crosses first among the
/// faces that it leads out of.
template <class T>
std::optional<std::vector<int>> faces_crossed(const Line<T>& line, const protostar::Box& box,
                                              const LeftOfBox& left) {
  std::vector<int> crossed;
  if (left.face >= 0) {
    const std::optional<bool> inwards = leads_inwards(line, box, left.face);
    if (!inwards) return std::nullopt;
    if (!*inwards) return crossed;
  }
  int signs[6];  // 1 if the face is entered, -1 if it is left
  for (int face = 0; face < 6; ++face) {
    const FaceEquation<T> e(line, box, face);
    if constexpr (requires { e.slope.is_known(); })
      if (!e.slope.is_known() || !line.weight.is_known()) return std::nullopt;
    signs[face] = e.slope.sign() * line.weight.sign() * (face % 2 ? -1 : 1);
  }
  if (left.is_own) {
    int first = -1;
    for (int face = 0; face < 6; ++face) {
      if (signs[face] >= 0) continue;
      if (first >= 0) {
        const FaceEquation<T> e(line, box, face), f(line, box, first);
        const T earlier = f.height * e.slope - e.height * f.slope;  // times both slopes
        if constexpr (requires { earlier.is_known(); })
          if (!earlier.is_known()) return std::nullopt;
        if (earlier.sign() * e.slope.sign() * f.slope.sign() <= 0) continue;
      }
      first = face;
    }
    crossed.push_back(first);
    return crossed;
  }
  for (const int sign : {1, -1}) {
    int first = -1;
    for (int face = 0; face < 6; ++face) {
      if (signs[face] != sign) continue;
      const std::optional<bool> is_in = FaceEquation<T>(line, box, face, left).is_in_box(line, box, left);
      if (!is_in) return std::nullopt;
      if (*is_in && (first < 0 || face == left.face)) first = face;
    }
    if (first >= 0 && first != left.face) crossed.push_back(first);
  }
  return crossed;
}

}  // namespace exact
