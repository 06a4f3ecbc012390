// Algorithms that stress_numerics compares, and the batches of cases that they run on.
#pragma once

#include <cstddef>
#include <protostar/interval.hpp>
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
#include <string>
#include <utility>
#include <vector>

#include "sound_cases.hpp"
#include "stress/corpora/corpus.hpp"
#include "stress/made_of.hpp"
#include "stress/truth.hpp"
#include "stress/usual.hpp"
#include "support/random.hpp"

namespace numerics {

using exact::Truth;
using protostar::Affine, protostar::Box, protostar::Disk, protostar::Parallelogram, protostar::Plane,
    protostar::Quadric, protostar::Ray, protostar::Sphere, protostar::Triangle, protostar::Vec3,
    protostar::infinity;

template <class T>
usual::Vector<T> converted(const Vec3& v) {
  return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}
template <class T>
usual::Ray<T> converted(const Ray& ray) {
  return {converted<T>(ray.origin), converted<T>(ray.direction)};
}
template <class T>
usual::Sphere<T> converted(const Sphere& s) {
  return {converted<T>(s.center), static_cast<T>(s.radius)};
}
template <class T>
usual::Plane<T> converted(const Plane& s) {
  return {converted<T>(s.normal), static_cast<T>(s.distance)};
}
template <class T>
usual::Parallelogram<T> converted(const Parallelogram& s) {
  return {converted<T>(s.position), converted<T>(s.edge_u), converted<T>(s.edge_v)};
}
template <class T>
usual::Triangle<T> converted(const Triangle& s) {
  return {converted<T>(s.a), converted<T>(s.b), converted<T>(s.c)};
}
template <class T>
usual::Disk<T> converted(const Disk& s) {
  return {converted<T>(s.position), converted<T>(s.normal), static_cast<T>(s.radius)};
}
template <class T>
usual::Box<T> converted(const Box& s) {
  return {converted<T>(s.min), converted<T>(s.max)};
}
template <class T>
usual::Quadric<T> converted(const Quadric& s) {
  return {converted<T>(s.form.squares), converted<T>(s.form.products), converted<T>(s.form.linear),
          static_cast<T>(s.form.constant)};
}
/// Returns the map with its inverse's rows by cofactors, as usual.
template <class T, class S>
auto converted(const Placed<S>& s) {
  const Affine& map = s.placement;
  const Vec3 yz = cross(map.y, map.z);
  const double determinant = dot(map.x, yz);
  return usual::Placed<decltype(converted<T>(s.own)), T>{
      converted<T>(s.own),
      {converted<T>(yz / determinant), converted<T>(cross(map.z, map.x) / determinant),
       converted<T>(cross(map.x, map.y) / determinant)},
      converted<T>(map.translation)};
}
/// Returns a placeholder: there is no usual algorithm for solids made of solids.
template <class T>
int converted(const Made&) {
  return 0;
}
template <class T, class S>
using Converted = decltype(converted<T>(S()));

template <class S>
struct Batch {
  std::vector<Case<S>> cases;
  std::vector<std::pair<usual::Ray<double>, Converted<double, S>>> doubles;
  std::vector<std::pair<usual::Ray<float>, Converted<float, S>>> floats;
  std::vector<bool> exact_in_float;
  std::vector<Truth<>> truths;

  Batch(const Corpus<S>& corpus, Random& random, std::size_t count) {
    cases.reserve(count);
    while (cases.size() < count) {
      const auto [c, in_float] = sound_case(corpus, random);
      cases.push_back(c);
      // A surface that is recognized by its address has a new address now.
      if (c.ray.departure.object != nullptr)
        cases.back().ray.departure = departure_like(cases.back().surface, c);
      doubles.emplace_back(converted<double>(c.ray), converted<double>(c.surface));
      floats.emplace_back(converted<float>(c.ray), converted<float>(c.surface));
      exact_in_float.push_back(in_float);
      truths.push_back(exact::truth_of(c.ray, c.surface, leaves(c)));
    }
  }
};

/// Algorithm that calculates the first t > 0 of every case, infinity for a miss.
template <class S>
struct Kernel {
  const char* name;
  bool in_float;
  void (*run)(const Batch<S>&, std::vector<double>& t);

  [[nodiscard]] bool is_library() const { return std::string("library") == name; }
};

template <class S>
void run_library(const Batch<S>& batch, std::vector<double>& t) {
  for (std::size_t i = 0; i < t.size(); ++i)
    t[i] = batch.cases[i].surface.intersect(batch.cases[i].ray).value_or(infinity);
}
template <auto kernel>
inline constexpr auto in_float = [](const auto& batch, std::vector<double>& t) {
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = kernel(batch.floats[i].first, batch.floats[i].second);
};
template <auto kernel>
inline constexpr auto in_double = [](const auto& batch, std::vector<double>& t) {
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = kernel(batch.doubles[i].first, batch.doubles[i].second);
};

inline const std::vector<Kernel<Sphere>> sphere_kernels{
    {"library", false, run_library<Sphere>},
    {"tutorial", true, in_float<usual::quadratic<float>>},
    {"geometric", true, in_float<usual::geometric>},
    {"gems", true, in_float<usual::gems>},
    {"double", false, in_double<usual::quadratic<double>>}};
inline const std::vector<Kernel<Plane>> plane_kernels{{"library", false, run_library<Plane>},
                                                      {"tutorial", true, in_float<usual::quotient<float>>},
                                                      {"double", false, in_double<usual::quotient<double>>}};
inline const std::vector<Kernel<Parallelogram>> parallelogram_kernels{
    {"library", false, run_library<Parallelogram>},
    {"tutorial", true, in_float<usual::in_parallelogram<float>>},
    {"double", false, in_double<usual::in_parallelogram<double>>}};
inline const std::vector<Kernel<Triangle>> triangle_kernels{
    {"library", false, run_library<Triangle>},
    {"tutorial", true, in_float<usual::in_triangle<float>>},
    {"double", false, in_double<usual::in_triangle<double>>}};
inline const std::vector<Kernel<Disk>> disk_kernels{{"library", false, run_library<Disk>},
                                                    {"tutorial", true, in_float<usual::in_circle<float>>},
                                                    {"double", false, in_double<usual::in_circle<double>>}};
inline const std::vector<Kernel<Box>> box_kernels{{"library", false, run_library<Box>},
                                                  {"tutorial", true, in_float<usual::slabs<float>>},
                                                  {"double", false, in_double<usual::slabs<double>>}};
inline const std::vector<Kernel<Quadric>> quadric_kernels{
    {"library", false, run_library<Quadric>},
    {"tutorial", true, in_float<usual::school<float>>},
    {"double", false, in_double<usual::school<double>>}};

inline const std::vector<Kernel<Placed<Sphere>>> placed_sphere_kernels{
    {"library", false, run_library<Placed<Sphere>>},
    {"tutorial", true, in_float<usual::carried<usual::quadratic<float>, usual::Sphere<float>, float>>},
    {"double", false, in_double<usual::carried<usual::quadratic<double>, usual::Sphere<double>, double>>}};
inline const std::vector<Kernel<Placed<Plane>>> placed_plane_kernels{
    {"library", false, run_library<Placed<Plane>>},
    {"tutorial", true, in_float<usual::carried<usual::quotient<float>, usual::Plane<float>, float>>},
    {"double", false, in_double<usual::carried<usual::quotient<double>, usual::Plane<double>, double>>}};
inline const std::vector<Kernel<Made>> tree_kernels{{"library", false, run_library<Made>}};

}  // namespace numerics
