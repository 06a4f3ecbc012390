// Prints the cases in which the library is wrong, in hexadecimal.
#pragma once

#include <cstdio>
#include <mutex>
#include <protostar/ray.hpp>
#include <protostar/surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <protostar/vec3.hpp>
#include <variant>

#include "promises.hpp"
#include "stress/corpora/corpus.hpp"
#include "stress/made_of.hpp"
#include "stress/truth.hpp"

namespace numerics {

using exact::Truth;
using protostar::Box, protostar::Crossing, protostar::Csg, protostar::Departure, protostar::Disk,
    protostar::Parallelogram, protostar::Plane, protostar::Quadric, protostar::Sphere, protostar::Triangle,
    protostar::Vec3;

inline void print(const Vec3& v) { std::fprintf(stderr, "{%a, %a, %a}", v.x, v.y, v.z); }
inline void print(const Sphere& s) {
  std::fprintf(stderr, "sphere "), print(s.center), std::fprintf(stderr, ", %a", s.radius);
}
inline void print(const Plane& s) {
  std::fprintf(stderr, "plane "), print(s.normal), std::fprintf(stderr, ", %a", s.distance);
}
inline void print(const Parallelogram& s) {
  std::fprintf(stderr, "parallelogram "), print(s.position), print(s.edge_u), print(s.edge_v);
}
inline void print(const Triangle& s) {
  std::fprintf(stderr, "triangle "), print(s.a), print(s.b), print(s.c);
}
inline void print(const Disk& s) {
  std::fprintf(stderr, "disk "), print(s.position), print(s.normal), std::fprintf(stderr, ", %a", s.radius);
}
inline void print(const Box& s) { std::fprintf(stderr, "box "), print(s.min), print(s.max); }
inline void print(const Quadric& s) {
  std::fprintf(stderr, "quadric "), print(s.form.squares), print(s.form.products), print(s.form.linear);
  std::fprintf(stderr, ", %a", s.form.constant);
}

template <class S>
void print(const Placed<S>& s) {
  std::fprintf(stderr, "image by "), print(s.placement.x), print(s.placement.y), print(s.placement.z);
  print(s.placement.translation), std::fprintf(stderr, " of "), print(s.own);
}
inline void print(const SolidTree& tree) {
  if (tree.operation == Csg::Operation::none) std::visit([](const auto& solid) { print(solid); }, tree.solid);
  if (tree.operation != Csg::Operation::none)
    std::fprintf(stderr, "operation %d (", static_cast<int>(tree.operation));
  for (const SolidTree& operand : tree.operands) std::fprintf(stderr, "\n    "), print(operand);
  if (tree.operation != Csg::Operation::none) std::fprintf(stderr, ")");
}
inline void print(const Made& s) { print(s.tree); }

template <class S>
void report(const char* corpus, const char* what, const Case<S>& c, const Truth<>& truth) {
  static std::mutex one_at_a_time;
  static int reports = 0;
  const std::lock_guard lock(one_at_a_time);
  if (++reports > 20) return;
  std::fprintf(stderr, "wrong in %s: %s\n  origin ", corpus, what);
  print(c.ray.origin), std::fprintf(stderr, " direction "), print(c.ray.direction);
  std::fprintf(stderr, c.ray.departure.kind == Departure::Kind::none ? "\n  " : " leaving\n  "),
      print(c.surface);
  std::fprintf(stderr, "\n  true:");
  for (const auto& root : truth) std::fprintf(stderr, " %a", static_cast<double>(root.t));
  std::fprintf(stderr, " library:");
  for (const Crossing& crossing : crossings(c)) std::fprintf(stderr, " %a", crossing.t);
  std::fprintf(stderr, "\n");
}

}  // namespace numerics
