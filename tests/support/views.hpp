// Reference values and random cases for lights as seen from a point.
#pragma once

#include <array>
#include <cmath>
#include <protostar/irradiance.hpp>
#include <protostar/sampling/solid_angle.hpp>

#include "random.hpp"

/// Returns the solid angle of a triangle as seen from a point by the formula of Van Oosterom and Strackee in
/// double-double: the arc tangent of a quotient in which the numerator is a triple product.
inline double solid_angle_by_quotient(const protostar::Point& from,
                                      const std::array<protostar::Point, 3>& corners) {
  using namespace protostar;
  const PreciseVector a = scaled_difference(corners[0], from, 0), b = scaled_difference(corners[1], from, 0),
                      c = scaled_difference(corners[2], from, 0);
  const PreciseVector e = scaled_difference(corners[1], corners[0], 0),
                      f = scaled_difference(corners[2], corners[0], 0);
  const DoubleDouble volume = dot(a, cross(e, f)), la = length(a), lb = length(b), lc = length(c);
  const DoubleDouble sum = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * static_cast<double>(detail::precise_angle_of(abs(volume), sum));
}

/// A point and a triangle, in one of the places where formulas lose digits.
struct TriangleCase {
  protostar::Point from;
  std::array<protostar::Point, 3> corners;
};

/// Returns a case: the point close to the inside, an edge, a corner, the plane or an edge's line, or the
/// triangle tiny; close and tiny is a random power of two from 2^-40 on.
inline TriangleCase triangle_case(Random& random, int kind) {
  using namespace protostar;
  TriangleCase c{{}, {random.point(1), random.point(1), random.point(1)}};
  auto& [p, q, r] = c.corners;
  const double close = std::exp2(random.real(-40, 0));
  const Vec3 e = q - p, f = r - p, normal = normalize(cross(e, f));
  double u = random.real(0, 1), v = random.real(0, 1);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  switch (kind % 6) {
    case 0:
      c.from = p + u * e + v * f + close * normal;
      break;
    case 1:
      c.from = p + u * e + close * random.point(1);
      break;
    case 2:
      c.from = p + close * random.point(1);
      break;
    case 3:
      c.from = random.point(4), q = p + close * e, r = p + close * f;
      break;
    case 4:
      c.from = p + random.real(-3, 3) * e + random.real(-3, 3) * f + close * normal;
      break;
    default:
      c.from = p + random.real(1, 4) * e + close * random.point(1);
  }
  return c;
}
