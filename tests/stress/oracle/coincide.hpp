// Surfaces that coincide: they are the same points, or lie in one plane.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/interval.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>

#include "equations.hpp"
#include "stress/exact.hpp"

namespace exact {

/// Returns the double nearest to N/M, and the one with an even last bit if two are: the one with the least
/// |N − x M|, without rounding, among the quotient of Quads, rounded, and its neighbors.
inline double nearest_quotient(const Number& N, const Number& M) {
  const double q = static_cast<double>(Quad(N) / Quad(M));
  double best = q;
  const auto off = [&](double x) {
    const Number difference = N - Number(x) * M;
    return difference.sign() < 0 ? -difference : difference;
  };
  for (const double x : {std::nextafter(q, -protostar::infinity), std::nextafter(q, protostar::infinity)}) {
    const int closer = (off(best) - off(x)).sign();
    const auto is_even = [](double y) { return (std::bit_cast<std::uint64_t>(y) & 1) == 0; };
    if (closer > 0 || (closer == 0 && is_even(x))) best = x;
  }
  return best;
}

/// Returns the equation of a plane by which surfaces in one plane recognize each other: divided by the
/// largest component of the normal, the first of equals, and rounded.
inline std::array<double, 4> rounded_equation(const Vector<Number>& n, const Number& distance) {
  const Number numbers[] = {n.x, n.y, n.z, distance};
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if ((square(numbers[i]) - square(numbers[k])).sign() > 0) k = i;
  std::array<double, 4> rounded{};
  for (std::size_t i = 0; i < 4; ++i) rounded[i] = nearest_quotient(numbers[i], numbers[k]);
  return rounded;
}

/// Returns true if two surfaces are the same points.
inline bool coincide(const protostar::Sphere& a, const protostar::Sphere& b) {
  return a.center == b.center && std::abs(a.radius) == std::abs(b.radius);
}
inline bool coincide(const protostar::Plane& a, const protostar::Plane& b) {
  const Number p[] = {a.normal.x, a.normal.y, a.normal.z, a.distance};
  const Number q[] = {b.normal.x, b.normal.y, b.normal.z, b.distance};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j)
      if ((p[i] * q[j] - p[j] * q[i]).sign() != 0) return false;  // not multiples of each other
  return true;
}
inline std::array<double, 4> rounded_equation(const protostar::Plane& s) {
  return rounded_equation(Vector<Number>(s.normal), s.distance);
}
inline std::array<double, 4> rounded_equation(const protostar::Parallelogram& s) {
  const Vector<Number> n = cross(Vector<Number>(s.edge_u), Vector<Number>(s.edge_v));
  return rounded_equation(n, dot(n, Vector<Number>(s.position)));
}
inline std::array<double, 4> rounded_equation(const protostar::Disk& s) {
  const Vector<Number> n(s.normal);
  return rounded_equation(n, dot(n, Vector<Number>(s.position)));
}
inline bool coincide(const protostar::Parallelogram& a, const protostar::Parallelogram& b) {
  return rounded_equation(a) == rounded_equation(b);
}
/// Returns true if both are in one plane, exactly if the parallelogram is orthogonal to an axis.
inline bool coincide(const protostar::Parallelogram& a, const protostar::Plane& b) {
  for (int i = 0; i < 3; ++i)
    if (a.edge_u[i] == 0 && a.edge_v[i] == 0) {
      protostar::Plane plane{protostar::Vec3{0}, a.position[i]};
      plane.normal[i] = 1;
      return coincide(plane, b);
    }
  return rounded_equation(a) == rounded_equation(b);
}

inline bool coincide(const protostar::Disk& a, const protostar::Disk& b) {
  return rounded_equation(a) == rounded_equation(b);
}
inline bool coincide(const protostar::Disk& a, const protostar::Parallelogram& b) {
  return rounded_equation(a) == rounded_equation(b);
}
inline bool coincide(const protostar::Disk& a, const protostar::Plane& b) {
  for (int i = 0; i < 3; ++i)
    if (a.normal[(i + 1) % 3] == 0 && a.normal[(i + 2) % 3] == 0) {
      protostar::Plane plane{protostar::Vec3{0}, a.position[i]};
      plane.normal[i] = 1;
      return coincide(plane, b);
    }
  return rounded_equation(a) == rounded_equation(b);
}

}  // namespace exact
