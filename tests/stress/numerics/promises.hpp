// Promises of the library beyond hit and miss: roots, normals and ranges, held against the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <protostar/intersection.hpp>
#include <protostar/interval.hpp>
#include <protostar/material.hpp>
#include <protostar/ray.hpp>
#include <protostar/surface.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "sound_cases.hpp"
#include "stress/corpora/corpus.hpp"
#include "stress/exact.hpp"
#include "stress/oracle/equations.hpp"
#include "stress/truth.hpp"

namespace numerics {

using exact::Truth, exact::TrueRoot;
using protostar::Crossing, protostar::Intersection, protostar::Interval, protostar::Material,
    protostar::Point, protostar::Sphere, protostar::SurfaceWithEquation, protostar::SurfaceWithRoots,
    protostar::Vec3, protostar::infinity;

template <class T>
T size_of(T x) {
  return x < 0 ? -x : x;
}

/// Returns |t − truth| in units of the last place of truth.
template <class T>
double ulps(double t, T truth) {
  int exponent = 0;
  std::frexp(static_cast<double>(truth), &exponent);
  const double ulp = std::ldexp(1, std::max(exponent - 53, -1074));
  return static_cast<double>(size_of(T(t) - truth) / T(ulp));
}

template <class T>
double length(const exact::Vector<T>& v) {
  const auto square = [](T x) { return static_cast<double>(x) * static_cast<double>(x); };
  return std::sqrt(square(v.x) + square(v.y) + square(v.z));
}

/// Returns the normal at the root t of the line.
template <class T>
exact::Vector<T> true_normal(const Case<Sphere>& c, T t) {
  const auto component = [&](int i) {
    return (T(c.ray.origin[i]) + t * T(c.ray.direction[i]) - T(c.surface.center[i])) / T(c.surface.radius);
  };
  return {component(0), component(1), component(2)};
}

/// Returns true if the normal at a t with this relative error is as close to the true one as
/// Sphere::normal_at promises, and no more turned: within part of the bound. (The true normal of a ray that
/// leaves the sphere is not of unit length, as its origin is rounded.)
template <class T>
bool is_within_bound(const Case<Sphere>& c, double t, double relative_error, T true_t, double part) {
  const Vec3 way = t * c.ray.direction;
  const Point point = c.ray.at(t);
  const double to_hit = std::hypot(way.x, way.y, way.z), to_point = std::hypot(point.x, point.y, point.z);
  const double bound =
      part *
      ((relative_error * to_hit + 0x1p-53 * (to_hit + to_point)) / std::abs(c.surface.radius) + 0x1p-51);

  const exact::Vector<T> normal(c.surface.normal_at(point)), n = true_normal(c, true_t);
  const exact::Vector<T> cross{normal.y * n.z - normal.z * n.y, normal.z * n.x - normal.x * n.z,
                               normal.x * n.y - normal.y * n.x};
  // The sine, times both lengths, since the normal may be 0 at distances for which the bound is void.
  const bool is_turned_no_more = length(cross) <= bound * length(normal) * length(n);
  return length(normal - n) <= bound && (is_turned_no_more || c.ray.departure == c.surface.departure());
}
template <class S, class T>
bool is_within_bound(const Case<S>&, double, double, T, double) {
  return true;
}

/// Returns true if a root lies inside a range with ends at 0, 1 or infinity.
template <class T>
bool contains(Interval range, const TrueRoot<T>& root) {
  return (range.min != 0 || root.t > 0) && (range.min != 1 || root.beyond_one > 0) &&
         (range.max != 1 || root.beyond_one < 0);
}

/// Returns all crossings of the ray's line.
template <class S>
std::vector<Crossing> crossings(const Case<S>& c) {
  std::vector<Crossing> all;
  if constexpr (SurfaceWithRoots<S> || SurfaceWithEquation<S>) {
    for (const double t : protostar::roots_of(c.surface, c.ray))
      all.push_back({t, static_cast<int>(all.size())});
  } else {
    each_crossing(c.surface, c.ray, {-infinity, infinity},
                  [&](const Crossing& crossing) { all.push_back(crossing); });
  }
  return all;
}

/// Returns the first broken promise, or nullptr; part is the share of each bound that is allowed.
template <class S, class T>
const char* broken_promise(const Case<S>& c, const Truth<T>& truth, double part) {
  const auto is_good = [&](double t, T true_t) {
    return size_of(T(t) - true_t) <= T(part * 0x1p-30) * size_of(true_t);
  };
  // A point of tangency counts twice in both.
  int i = 0;
  const std::vector<Crossing> all = crossings(c);
  if (static_cast<int>(all.size()) != truth.count) return "the number of roots";
  for (const Crossing& crossing : all) {
    const double t = crossing.t;
    const T true_t = truth.root[i++].t;
    if ((t > 0) != (true_t > 0) || (t < 0) != (true_t < 0)) return "the sign of a root";
    if (!is_good(t, true_t)) return "a root to 2^-30";

    const Material black;
    const Intersection hit(c.ray, crossing_on(c.surface, crossing, black));
    const double refined = hit.refined();
    if (!(ulps(refined, true_t) <= part)) return "a refined root to 1 ulp";
    if (!is_within_bound(c, t, 0x1p-30, true_t, part)) return "a normal";
    if (!is_within_bound(c, refined, 0x1p-52, true_t, part)) return "a normal of a refined root";
  }
  for (const Interval range : {Interval{0, 1}, Interval{1, infinity}, Interval{-infinity, 1}}) {
    const auto first =
        std::find_if(truth.begin(), truth.end(), [&](const auto& root) { return contains(range, root); });
    const auto t = c.surface.intersect(c.ray, range);
    if (t.has_value() != (first != truth.end())) return "a root inside a range that ends at 1";
    if (t && !is_good(*t, first->t)) return "the first root inside a range that ends at 1";
  }
  return nullptr;
}

/// Returns the first broken promise, or nullptr, where the truth may be off by a small part of a bound. The
/// smallest bound on t is 1 ulp ≥ 2^-53 and t is true to 2^-60; a true normal is off by (2^-60 T + 2^-63
/// (T + P)) / |radius| + 2^-62 at most, with T and P as in Sphere::normal_at, where the bound is 2^8 times
/// that. Hence whatever is within all but 2^-7 of a bound is within it; exact numbers and Quad judge the
/// rest.
template <class S>
const char* broken_promise(const Case<S>& c, const Truth<>& truth) {
  if (!broken_promise(c, truth, 1 - 0x1p-7)) return nullptr;
  return broken_promise(c, exact::second_level<exact::Quad>(c.ray, c.surface, leaves(c)), 1);
}

}  // namespace numerics
