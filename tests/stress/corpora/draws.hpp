// Random numbers, vectors and rays that the cases of all corpora consist of.
#pragma once

#include <cmath>
#include <cstdint>
#include <protostar/ray.hpp>
#include <protostar/vec3.hpp>

#include "support/random.hpp"

// The order in which the operands of a sum or the arguments of a call are evaluated is the compiler's choice,
// so a statement draws no more than one random number, unless braces set the order.
namespace corpora {

using protostar::Point, protostar::Ray, protostar::Vec3;

inline int whole(Random& random, int min, int max) {
  return min + static_cast<int>(random.bits() % static_cast<std::uint64_t>(max - min + 1));
}
inline bool coin(Random& random) { return (random.bits() & 1) != 0; }

/// Returns a number whose logarithm is uniform, from 2^min to 2^max.
inline double size(Random& random, int min, int max) {
  const double mantissa = random.real(1, 2);
  return std::ldexp(mantissa, whole(random, min, max - 1));
}

/// Returns ± 2^-k with k in [min, max].
inline double tiny(Random& random, int min, int max) {
  const double sign = coin(random) ? 1 : -1;
  return std::ldexp(sign, -whole(random, min, max));
}

/// Returns a unit vector at a right angle to d, to within rounding.
inline Vec3 across(Random& random, const Vec3& d) { return normalize(cross(random.direction(), d)); }

/// Returns a ray of unit direction that passes the center at a distance of impact, after about t = ahead.
inline Ray passing(Random& random, const Point& center, double impact, double ahead) {
  const Vec3 d = random.direction();
  const Point origin = center + impact * across(random, d) - ahead * d;
  return {origin, d};
}

inline Vec3 whole_vector(Random& random, int min, int max) {
  const int x = whole(random, min, max), y = whole(random, min, max);
  return {x, y, whole(random, min, max)};
}

inline Vec3 turned(const Vec3& v, int times) {
  return times == 0 ? v : times == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
}

/// Moves one coordinate by one unit in the last place, in one of three calls.
inline void nudge(Random& random, Point& point) {
  double& moved = point[whole(random, 0, 2)];
  if (moved != 0 && whole(random, 0, 2) == 0) moved = std::nextafter(moved, coin(random) ? 1e9 : -1e9);
}

}  // namespace corpora
