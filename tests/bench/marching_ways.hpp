// Ways to march along a ray that stop at an epsilon, for one ray and for packets. The field must change by no
// more than the distance between two points.
#pragma once

#include <cmath>
#include <cstdint>
#include <protostar/exact/distance_field.hpp>
#include <protostar/interval.hpp>
#include <protostar/ray.hpp>
#include <protostar/simd/vectors.hpp>

namespace bench {

/// Number of steps after which marches that stop at an epsilon give up.
inline constexpr int most_steps = 512;

/// Result of a way for a ray that misses.
inline constexpr double no_hit = -1;

/// Ray with the part of it in which it is marched. Its direction is a unit vector.
struct MarchedRay {
  protostar::Ray ray;
  protostar::Interval span;
};

/// Marches by steps of one length. A change of sign is narrowed by bisection.
double fixed_step(const auto& field, const MarchedRay& marched, double step, std::uint64_t& evaluations) {
  const auto is_inside = [&](double t) {
    ++evaluations;
    return protostar::plain_value(field, marched.ray.at(t)) <= 0;
  };
  for (double t = marched.span.min; t < marched.span.max; t += step) {
    if (!is_inside(t)) continue;
    double outside = t - step;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (outside + t);
      (is_inside(middle) ? t : outside) = middle;
    }
    return t;
  }
  return no_hit;
}

/// Marches by the values of the field (Hart 1996) to the first that is below epsilon.
double sphere_tracing(const auto& field, const MarchedRay& marched, double epsilon,
                      std::uint64_t& evaluations) {
  double t = marched.span.min;
  for (int i = 0; i < most_steps && t < marched.span.max; ++i) {
    ++evaluations;
    const double free = protostar::plain_value(field, marched.ray.at(t));
    if (free < epsilon) return t;
    t += free;
  }
  return no_hit;
}

/// Marches by 1.6 times the values (Keinert et al. 2014). If the free balls around the two ends of a step do
/// not overlap, the step is taken back to the end of the first, and the relaxation ends.
double enhanced(const auto& field, const MarchedRay& marched, double epsilon, std::uint64_t& evaluations) {
  double t = marched.span.min, before = 0, step = 0, relaxation = 1.6;
  for (int i = 0; i < most_steps && t < marched.span.max; ++i) {
    ++evaluations;
    const double free = protostar::plain_value(field, marched.ray.at(t));
    if (relaxation > 1 && before + std::abs(free) < step) {
      t += before - step, step = before, relaxation = 1;
      continue;
    }
    if (free < epsilon) return t;
    before = free, step = relaxation * free, t += step;
  }
  return no_hit;
}

/// Marches the rays of a packet as enhanced does.
inline protostar::simd::Doubles enhanced(const auto& field, const protostar::simd::Vectors& origin,
                                         const protostar::simd::Vectors& direction,
                                         protostar::simd::Doubles t, protostar::simd::Doubles end,
                                         double epsilon) {
  using protostar::simd::Doubles, protostar::simd::LaneMask;
  Doubles before = 0.0, step = 0.0, relaxation = 1.6, found = no_hit;
  LaneMask live = t < end;
  for (int i = 0; i < most_steps && any(live); ++i) {
    const Doubles free = protostar::plain_values(field, origin + t * direction);
    const LaneMask turns_back = relaxation > 1.0 && before + abs(free) < step;
    const LaneMask hits = live && !turns_back && free < epsilon;
    found = select(hits, t, found);
    live = live && !hits;
    t = select(live, t + select(turns_back, before - step, relaxation * free), t);
    step = select(turns_back, before, relaxation * free);
    before = select(turns_back, before, free);
    relaxation = select(turns_back, Doubles(1.0), relaxation);
    live = live && t < end;
  }
  return found;
}

}  // namespace bench
