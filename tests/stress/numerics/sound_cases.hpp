// Cases that the library accepts, half of which consist of numbers that float holds.
#pragma once

#include <cmath>
#include <optional>
#include <protostar/numeric/affine.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <protostar/vec3.hpp>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>

#include "stress/corpora/corpus.hpp"
#include "stress/corpora/draws.hpp"
#include "stress/made_of.hpp"
#include "stress/oracle/departures.hpp"
#include "support/random.hpp"

namespace numerics {

using protostar::Affine, protostar::Box, protostar::Departure, protostar::Disk, protostar::Parallelogram,
    protostar::Plane, protostar::Quadric, protostar::Ray, protostar::Sphere, protostar::Triangle,
    protostar::Vec3, protostar::is_finite;

/// Returns the nearest float. Goes through a volatile, since g++ 12 at -O2 drops the rounding of pairs of
/// doubles that are converted to float and back.
inline double rounded(double x) {
  const volatile float nearest = static_cast<float>(x);
  return nearest;
}
inline Vec3 rounded(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }
inline Sphere rounded(const Sphere& s) { return {rounded(s.center), rounded(s.radius)}; }
inline Plane rounded(const Plane& s) { return {rounded(s.normal), rounded(s.distance)}; }
inline Parallelogram rounded(const Parallelogram& s) {
  return {rounded(s.position), rounded(s.edge_u), rounded(s.edge_v)};
}
inline Triangle rounded(const Triangle& s) { return {rounded(s.a), rounded(s.b), rounded(s.c)}; }
inline Disk rounded(const Disk& s) { return {rounded(s.position), rounded(s.normal), rounded(s.radius)}; }
inline Box rounded(const Box& s) { return {rounded(s.min), rounded(s.max)}; }
inline Quadric rounded(const Quadric& s) {
  return {
      {rounded(s.form.squares), rounded(s.form.products), rounded(s.form.linear), rounded(s.form.constant)}};
}

template <class S>
Placed<S> rounded(const Placed<S>& s) {
  const Affine& map = s.placement;
  return Placed(rounded(s.own),
                Affine{rounded(map.x), rounded(map.y), rounded(map.z), rounded(map.translation)});
}
inline SolidTree rounded(SolidTree tree) {
  std::visit([](auto& solid) { solid = rounded(solid); }, tree.solid);
  for (SolidTree& operand : tree.operands) operand = rounded(std::move(operand));
  return tree;
}
inline Made rounded(const Made& s) { return Made(rounded(s.tree)); }

inline bool is_sound(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3{0};
}
inline bool is_sound(const Sphere& s) {
  return is_finite(s.center) && std::isfinite(s.radius) && s.radius != 0;
}
inline bool is_sound(const Plane& s) {
  return is_finite(s.normal) && std::isfinite(s.distance) && s.normal != Vec3{0};
}
inline bool is_sound(const Parallelogram& s) {
  return is_finite(s.position) && is_finite(s.edge_u) && is_finite(s.edge_v);
}
inline bool is_sound(const Triangle& s) { return is_finite(s.a) && is_finite(s.b) && is_finite(s.c); }

inline bool is_sound(const auto& s) {
  try {
    s.validate();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// Returns the departure from a surface that corresponds to that of a case's ray from the case's surface.
inline Departure departure_like(const auto& s, const Case<std::remove_cvref_t<decltype(s)>>&) {
  return s.departure();
}
inline Departure departure_like(const Box& s, const Case<Box>& c) {
  Departure departure = s.departure(exact::face_left(c.ray, c.surface));
  if (c.ray.departure.object == nullptr) departure.object = nullptr;
  return departure;
}

/// Returns the departure of the case: a plane remains the same, since the numbers are small and whole.
inline Departure departure_like(const Made&, const Case<Made>& c) { return c.ray.departure; }

/// Returns the case with every number rounded to float, if it remains valid.
template <class S>
std::optional<Case<S>> in_floats(const Case<S>& c) {
  Case<S> near{{rounded(c.ray.origin), rounded(c.ray.direction)}, rounded(c.surface)};
  if (c.ray.departure.kind != Departure::Kind::none) near.ray.departure = departure_like(near.surface, c);
  return is_sound(near.ray) && is_sound(near.surface) ? std::optional(near) : std::nullopt;
}

template <class S>
bool leaves(const Case<S>& c) {
  return c.ray.departure.kind != Departure::Kind::none;
}

/// Returns the next valid case of a corpus, and whether float holds its numbers.
template <class S>
std::pair<Case<S>, bool> sound_case(const Corpus<S>& corpus, Random& random) {
  for (;;) {
    const Case<S> c = corpus.next(random);
    if (corpora::coin(random))
      if (const auto in_float = in_floats(c)) return {*in_float, true};
    if (is_sound(c.ray) && is_sound(c.surface)) return {c, false};
  }
}

}  // namespace numerics
