// Intersects rays with single surfaces, by the library and by usual algorithms, and judges them by exact
// arithmetic.
//
//   stress_numerics [--tests N] [--seed S] [--threads N] [--kernel K] [--csv FILE]
//   stress_numerics --judge N [--seed S] [--threads N]
//
// Distributes N cases (2,000,000) among the corpora. Half of the cases consist of numbers that float holds;
// kernels in float get only these, so that all their errors are their own. The error of t is in units of the
// last place of double. Exits with 1 if the library was wrong once, and prints the case in hexadecimal. The
// counts and errors do not depend on the number of threads (1; 0: all cores).
//
// With --judge the reference itself is checked: its answers with 128 digits to N such cases are compared with
// exact numbers.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>
#include <protostar/scene.hpp>
#include <string>

#include "corpora/boxes.hpp"
#include "corpora/corpus.hpp"
#include "corpora/disks.hpp"
#include "corpora/draws.hpp"
#include "corpora/instances.hpp"
#include "corpora/parallelograms.hpp"
#include "corpora/planes.hpp"
#include "corpora/quadrics.hpp"
#include "corpora/solids.hpp"
#include "corpora/spheres.hpp"
#include "corpora/triangles.hpp"
#include "oracle/departures.hpp"
#include "oracle/equations.hpp"
#include "truth.hpp"
#include "usual.hpp"
#include "work.hpp"

using namespace protostar;
using exact::Truth, exact::TrueRoot;

namespace {

// ---- A batch of cases, in double and in float, with their true crossings

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

/// Returns the nearest float. Goes through a volatile, since g++ 12 at -O2 drops the rounding of pairs of
/// doubles that are converted to float and back.
double rounded(double x) {
  const volatile float nearest = static_cast<float>(x);
  return nearest;
}
Vec3 rounded(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }
Sphere rounded(const Sphere& s) { return {rounded(s.center), rounded(s.radius)}; }
Plane rounded(const Plane& s) { return {rounded(s.normal), rounded(s.distance)}; }
Parallelogram rounded(const Parallelogram& s) {
  return {rounded(s.position), rounded(s.edge_u), rounded(s.edge_v)};
}
Triangle rounded(const Triangle& s) { return {rounded(s.a), rounded(s.b), rounded(s.c)}; }
Disk rounded(const Disk& s) { return {rounded(s.position), rounded(s.normal), rounded(s.radius)}; }
Box rounded(const Box& s) { return {rounded(s.min), rounded(s.max)}; }
Quadric rounded(const Quadric& s) {
  return {
      {rounded(s.form.squares), rounded(s.form.products), rounded(s.form.linear), rounded(s.form.constant)}};
}

template <class S>
Placed<S> rounded(const Placed<S>& s) {
  const Affine& map = s.placement;
  return Placed(rounded(s.own),
                Affine{rounded(map.x), rounded(map.y), rounded(map.z), rounded(map.translation)});
}
SolidTree rounded(SolidTree tree) {
  std::visit([](auto& solid) { solid = rounded(solid); }, tree.solid);
  for (SolidTree& operand : tree.operands) operand = rounded(std::move(operand));
  return tree;
}
Made rounded(const Made& s) { return Made(rounded(s.tree)); }

bool is_sound(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3{0};
}
bool is_sound(const Sphere& s) { return is_finite(s.center) && std::isfinite(s.radius) && s.radius != 0; }
bool is_sound(const Plane& s) {
  return is_finite(s.normal) && std::isfinite(s.distance) && s.normal != Vec3{0};
}
bool is_sound(const Parallelogram& s) {
  return is_finite(s.position) && is_finite(s.edge_u) && is_finite(s.edge_v);
}
bool is_sound(const Triangle& s) { return is_finite(s.a) && is_finite(s.b) && is_finite(s.c); }

bool is_sound(const auto& s) {
  try {
    s.validate();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// Returns the departure from a surface that corresponds to that of a case's ray from the case's surface.
Departure departure_like(const auto& s, const Case<std::remove_cvref_t<decltype(s)>>&) {
  return s.departure();
}
Departure departure_like(const Box& s, const Case<Box>& c) {
  Departure departure = s.departure(exact::face_left(c.ray, c.surface));
  if (c.ray.departure.object == nullptr) departure.object = nullptr;
  return departure;
}

/// Returns the departure of the case: a plane remains the same, since the numbers are small and whole.
Departure departure_like(const Made&, const Case<Made>& c) { return c.ray.departure; }

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

// ---- The kernels

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
constexpr auto in_float = [](const auto& batch, std::vector<double>& t) {
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = kernel(batch.floats[i].first, batch.floats[i].second);
};
template <auto kernel>
constexpr auto in_double = [](const auto& batch, std::vector<double>& t) {
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = kernel(batch.doubles[i].first, batch.doubles[i].second);
};

const std::vector<Kernel<Sphere>> sphere_kernels{{"library", false, run_library<Sphere>},
                                                 {"tutorial", true, in_float<usual::quadratic<float>>},
                                                 {"geometric", true, in_float<usual::geometric>},
                                                 {"gems", true, in_float<usual::gems>},
                                                 {"double", false, in_double<usual::quadratic<double>>}};
const std::vector<Kernel<Plane>> plane_kernels{{"library", false, run_library<Plane>},
                                               {"tutorial", true, in_float<usual::quotient<float>>},
                                               {"double", false, in_double<usual::quotient<double>>}};
const std::vector<Kernel<Parallelogram>> parallelogram_kernels{
    {"library", false, run_library<Parallelogram>},
    {"tutorial", true, in_float<usual::in_parallelogram<float>>},
    {"double", false, in_double<usual::in_parallelogram<double>>}};
const std::vector<Kernel<Triangle>> triangle_kernels{
    {"library", false, run_library<Triangle>},
    {"tutorial", true, in_float<usual::in_triangle<float>>},
    {"double", false, in_double<usual::in_triangle<double>>}};
const std::vector<Kernel<Disk>> disk_kernels{{"library", false, run_library<Disk>},
                                             {"tutorial", true, in_float<usual::in_circle<float>>},
                                             {"double", false, in_double<usual::in_circle<double>>}};
const std::vector<Kernel<Box>> box_kernels{{"library", false, run_library<Box>},
                                           {"tutorial", true, in_float<usual::slabs<float>>},
                                           {"double", false, in_double<usual::slabs<double>>}};
const std::vector<Kernel<Quadric>> quadric_kernels{{"library", false, run_library<Quadric>},
                                                   {"tutorial", true, in_float<usual::school<float>>},
                                                   {"double", false, in_double<usual::school<double>>}};

const std::vector<Kernel<Placed<Sphere>>> placed_sphere_kernels{
    {"library", false, run_library<Placed<Sphere>>},
    {"tutorial", true, in_float<usual::carried<usual::quadratic<float>, usual::Sphere<float>, float>>},
    {"double", false, in_double<usual::carried<usual::quadratic<double>, usual::Sphere<double>, double>>}};
const std::vector<Kernel<Placed<Plane>>> placed_plane_kernels{
    {"library", false, run_library<Placed<Plane>>},
    {"tutorial", true, in_float<usual::carried<usual::quotient<float>, usual::Plane<float>, float>>},
    {"double", false, in_double<usual::carried<usual::quotient<double>, usual::Plane<double>, double>>}};
const std::vector<Kernel<Made>> tree_kernels{{"library", false, run_library<Made>}};

// ---- Counts

/// Histogram of values by size, in steps of 2^(1/8).
class Quantiles {
 public:
  void add(double value) {
    largest_ = std::max(largest_, value), ++total_;
    const double step = value > 0 ? std::floor(8 * std::log2(value)) : -offset;
    ++counts_[static_cast<std::size_t>(std::clamp(step + offset, 0.0, 2 * offset))];
  }
  /// Returns the value that a share of all values do not exceed, to the next step.
  [[nodiscard]] double at(double share) const {
    std::uint64_t left = static_cast<std::uint64_t>(share * static_cast<double>(total_));
    std::size_t i = 0;
    while (i + 1 < counts_.size() && counts_[i] <= left) left -= counts_[i++];
    return i == 0 ? 0 : std::min(largest_, std::exp2((static_cast<double>(i) + 1 - offset) / 8));
  }
  [[nodiscard]] double largest() const { return largest_; }

  void add(const Quantiles& other) {
    largest_ = std::max(largest_, other.largest_), total_ += other.total_;
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  }

 private:
  static constexpr double offset = 8 * 1100;
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(2 * 8 * 1100 + 1);
  std::uint64_t total_ = 0;
  double largest_ = 0;
};

struct Tally {
  std::uint64_t tests = 0, hits = 0, false_hits = 0, false_misses = 0, wrong_roots = 0, broken = 0;
  Quantiles t_error, normal_error;
  double seconds = 0;
  std::uint64_t timed = 0;
  Fallbacks fallbacks;

  [[nodiscard]] std::uint64_t wrong() const { return false_hits + false_misses + wrong_roots + broken; }

  void add(const Tally& other) {
    tests += other.tests, hits += other.hits, false_hits += other.false_hits;
    false_misses += other.false_misses, wrong_roots += other.wrong_roots, broken += other.broken;
    t_error.add(other.t_error), normal_error.add(other.normal_error);
    seconds += other.seconds, timed += other.timed;
    fallbacks.exact += other.fallbacks.exact;
  }
};

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

/// Returns the first root ahead of the origin, or nullptr.
const TrueRoot<long double>* first_ahead(const Truth<>& truth) {
  for (const auto& root : truth)
    if (root.t > 0) return &root;
  return nullptr;
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

/// Returns the error of a kernel's normal, from its own t and in its own precision.
template <class T>
double normal_error(const Case<Sphere>& c, double t, long double truth) {
  const auto ray = converted<T>(c.ray);
  const auto sphere = converted<T>(c.surface);
  const usual::Vector<T> normal =
      (ray.origin + static_cast<T>(t) * ray.direction - sphere.center) / sphere.radius;
  return length(exact::Vector<long double>(Vec3(normal)) - true_normal(c, truth));
}

// ---- The library's promises beyond hit and miss

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
  if constexpr (SurfaceWithRoots<S>) {
    for (const double t : c.surface.roots(c.ray)) all.push_back({t, static_cast<int>(all.size())});
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

void print(const Vec3& v) { std::fprintf(stderr, "{%a, %a, %a}", v.x, v.y, v.z); }
void print(const Sphere& s) {
  std::fprintf(stderr, "sphere "), print(s.center), std::fprintf(stderr, ", %a", s.radius);
}
void print(const Plane& s) {
  std::fprintf(stderr, "plane "), print(s.normal), std::fprintf(stderr, ", %a", s.distance);
}
void print(const Parallelogram& s) {
  std::fprintf(stderr, "parallelogram "), print(s.position), print(s.edge_u), print(s.edge_v);
}
void print(const Triangle& s) { std::fprintf(stderr, "triangle "), print(s.a), print(s.b), print(s.c); }
void print(const Disk& s) {
  std::fprintf(stderr, "disk "), print(s.position), print(s.normal), std::fprintf(stderr, ", %a", s.radius);
}
void print(const Box& s) { std::fprintf(stderr, "box "), print(s.min), print(s.max); }
void print(const Quadric& s) {
  std::fprintf(stderr, "quadric "), print(s.form.squares), print(s.form.products), print(s.form.linear);
  std::fprintf(stderr, ", %a", s.form.constant);
}

template <class S>
void print(const Placed<S>& s) {
  std::fprintf(stderr, "image by "), print(s.placement.x), print(s.placement.y), print(s.placement.z);
  print(s.placement.translation), std::fprintf(stderr, " of "), print(s.own);
}
void print(const SolidTree& tree) {
  if (tree.operation == Csg::Operation::none) std::visit([](const auto& solid) { print(solid); }, tree.solid);
  if (tree.operation != Csg::Operation::none)
    std::fprintf(stderr, "operation %d (", static_cast<int>(tree.operation));
  for (const SolidTree& operand : tree.operands) std::fprintf(stderr, "\n    "), print(operand);
  if (tree.operation != Csg::Operation::none) std::fprintf(stderr, ")");
}
void print(const Made& s) { print(s.tree); }

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

// ---- Judging

/// Returns the error of an answer, or nullptr, and adds it to the tally.
template <class S>
const char* judge(Tally& tally, const Kernel<S>& kernel, const Case<S>& c, const Truth<>& truth, double t) {
  const auto* first = first_ahead(truth);
  const bool hit = t < infinity;
  ++tally.tests;
  if (first) ++tally.hits;
  if (hit && !first) return ++tally.false_hits, "a false hit";
  if (!hit && first) return ++tally.false_misses, "a false miss";
  if (!hit) return nullptr;
  // Roots so close to each other that the kernel's numbers hardly tell them apart may be exchanged.
  const long double apart = (kernel.in_float ? 0x1p-20 : 0x1p-30) * first->t;
  for (const auto& other : truth)
    if (std::abs(other.t - first->t) > apart && std::abs(t - other.t) < std::abs(t - first->t))
      return ++tally.wrong_roots, "a wrong root";
  tally.t_error.add(ulps(t, first->t));
  if constexpr (std::same_as<S, Sphere>)
    tally.normal_error.add(kernel.in_float ? normal_error<float>(c, t, first->t)
                                           : normal_error<double>(c, t, first->t));
  return nullptr;
}

/// Checks the library's answer against all that it promises.
template <class S>
void judge_promises(Tally& tally, const char* corpus, const char* wrong, const Case<S>& c,
                    const Truth<>& truth) {
  if (const char* broken = broken_promise(c, truth)) {
    if (!wrong) ++tally.broken;
    wrong = broken;
  }
  if (wrong) report(corpus, wrong, c, truth);
}

/// Runs one kernel on one batch.
template <class S>
void run(Tally& tally, const Kernel<S>& kernel, const char* corpus, const Batch<S>& batch) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> t(batch.cases.size());
  fallbacks = {};
  const auto start = Clock::now();
  kernel.run(batch, t);
  tally.seconds += std::chrono::duration<double>(Clock::now() - start).count();
  tally.timed += t.size();
  tally.fallbacks.exact += fallbacks.exact;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (kernel.in_float && !batch.exact_in_float[i]) continue;
    const char* wrong = judge(tally, kernel, batch.cases[i], batch.truths[i], t[i]);
    if (kernel.is_library()) judge_promises(tally, corpus, wrong, batch.cases[i], batch.truths[i]);
  }
}

// ---- The table

class Table {
 public:
  explicit Table(const std::string& csv) {
    if (!csv.empty()) {
      csv_.open(csv);
      if (!csv_) throw std::runtime_error(csv + ": cannot be written");
      csv_
          << "corpus,kernel,tests,hits,false hits,false misses,wrong roots,broken promises,t p50 ulp,t p99.9 "
             "ulp,t max ulp,normal p99.9,normal max,ns per test\n";
    }
    std::printf("%-17s%-10s%10s%10s%9s%9s%9s%8s%10s%10s%10s%10s%10s%8s\n", "corpus", "kernel", "tests",
                "hits", "f. hits", "f. miss", "w. root", "broken", "t p50", "t p99.9", "t max", "n p99.9",
                "n max", "ns");
  }

  void row(const char* corpus, const char* kernel, const Tally& x) {
    const double ns = 1e9 * x.seconds / static_cast<double>(std::max<std::uint64_t>(x.timed, 1));
    const auto& t = x.t_error;
    const auto& n = x.normal_error;
    std::printf("%-17s%-10s%10" PRIu64 "%10" PRIu64 "%9" PRIu64 "%9" PRIu64 "%9" PRIu64 "%8" PRIu64
                "%10.2g%10.2g%10.2g%10.2g%10.2g%8.1f\n",
                corpus, kernel, x.tests, x.hits, x.false_hits, x.false_misses, x.wrong_roots, x.broken,
                t.at(0.5), t.at(0.999), t.largest(), n.at(0.999), n.largest(), ns);
    std::fflush(stdout);
    if (csv_.is_open())
      csv_ << corpus << ',' << kernel << ',' << x.tests << ',' << x.hits << ',' << x.false_hits << ','
           << x.false_misses << ',' << x.wrong_roots << ',' << x.broken << ',' << t.at(0.5) << ','
           << t.at(0.999) << ',' << t.largest() << ',' << n.at(0.999) << ',' << n.largest() << ',' << ns
           << '\n';
  }

  void close() {
    if (!csv_.is_open()) return;
    csv_.close();
    if (!csv_) throw std::runtime_error("--csv: the file could not be written");
  }

 private:
  std::ofstream csv_;
};

struct Totals {
  std::uint64_t tests = 0, wrong = 0;
  Fallbacks fallbacks;

  void add(const Tally& tally) {
    tests += tally.tests, wrong += tally.wrong();
    fallbacks.exact += tally.fallbacks.exact;
  }
};

constexpr std::uint64_t chunk_size = 8192;

/// Runs every chosen kernel on every corpus of one kind of surface, and adds the library's results to the
/// totals.
template <class S>
void run(const std::vector<Corpus<S>>& all, const std::vector<Kernel<S>>& kernels, const std::string& only,
         Work& work, Table& table, Totals& library) {
  for (const Corpus<S>& corpus : all) {
    std::vector<Tally> tallies(kernels.size());
    std::mutex adding;
    work.in_chunks(chunk_size, [&](Random& random, std::uint64_t left) {
      std::vector<Tally> chunk(kernels.size());
      while (left > 0) {
        const Batch<S> batch(corpus, random, static_cast<std::size_t>(std::min<std::uint64_t>(left, 256)));
        left -= batch.cases.size();
        for (std::size_t k = 0; k < kernels.size(); ++k)
          if (only.empty() || only == kernels[k].name) run(chunk[k], kernels[k], corpus.name, batch);
      }
      const std::lock_guard lock(adding);
      for (std::size_t k = 0; k < kernels.size(); ++k) tallies[k].add(chunk[k]);
    });
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      if (!only.empty() && only != kernels[k].name) continue;
      table.row(corpus.name, kernels[k].name, tallies[k]);
      if (kernels[k].is_library()) library.add(tallies[k]);
    }
  }
}

/// Returns the number of cases in which 128 digits contradict exact numbers, on every corpus of one kind of
/// surface.
template <class S>
std::uint64_t judge_the_judge(const std::vector<Corpus<S>>& all, Work& work) {
  std::uint64_t all_wrong = 0;
  for (const Corpus<S>& corpus : all) {
    std::atomic<std::uint64_t> decided = 0, wrong = 0;
    work.in_chunks(chunk_size, [&](Random& random, std::uint64_t left) {
      for (; left > 0; --left) {
        const Case<S> c = sound_case(corpus, random).first;
        if (exact::first_level(c.ray, c.surface, leaves(c))) ++decided;
        if (const char* what = exact::wrong_in_first_level(c.ray, c.surface, leaves(c))) {
          ++wrong;
          report(corpus.name, what, c, exact::second_level(c.ray, c.surface, leaves(c)));
        }
      }
    });
    std::printf("%-17s%10" PRIu64 "%10" PRIu64 "%10" PRIu64 "\n", corpus.name, work.cases, decided.load(),
                wrong.load());
    std::fflush(stdout);
    all_wrong += wrong;
  }
  return all_wrong;
}

bool is_kernel(const std::string& name) {
  return std::any_of(sphere_kernels.begin(), sphere_kernels.end(),
                     [&](const auto& k) { return name == k.name; });
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed", "--threads", "--kernel", "--csv", "--judge"});
  const std::string& only = options.text("--kernel");
  if (!only.empty() && !is_kernel(only)) throw std::invalid_argument("no such kernel: " + only);
  const bool judges_itself = !options.text("--judge").empty();
  const std::uint64_t corpora_count = corpora::of_spheres.size() + corpora::of_planes.size() +
                                      corpora::of_parallelograms.size() + corpora::of_triangles.size() +
                                      corpora::of_disks.size() + corpora::of_boxes.size() +
                                      corpora::of_quadrics.size() + corpora::of_placed_spheres.size() +
                                      corpora::of_placed_planes.size() + corpora::of_trees.size();
  const std::uint64_t tests = options.number(judges_itself ? "--judge" : "--tests", 2'000'000);
  Work work(options, tests, corpora_count);

  if (judges_itself) {
    std::printf("%-17s%10s%10s%10s\n", "corpus", "cases", "decided", "wrong");
    std::uint64_t wrong = judge_the_judge(corpora::of_spheres, work);
    wrong += judge_the_judge(corpora::of_planes, work);
    wrong += judge_the_judge(corpora::of_parallelograms, work);
    wrong += judge_the_judge(corpora::of_triangles, work);
    wrong += judge_the_judge(corpora::of_disks, work);
    wrong += judge_the_judge(corpora::of_boxes, work);
    wrong += judge_the_judge(corpora::of_quadrics, work);
    wrong += judge_the_judge(corpora::of_placed_spheres, work);
    wrong += judge_the_judge(corpora::of_placed_planes, work);
    wrong += judge_the_judge(corpora::of_trees, work);
    return wrong > 0 ? 1 : 0;
  }
  Table table(options.text("--csv"));
  Totals library;
  run(corpora::of_spheres, sphere_kernels, only, work, table, library);
  run(corpora::of_planes, plane_kernels, only, work, table, library);
  run(corpora::of_parallelograms, parallelogram_kernels, only, work, table, library);
  run(corpora::of_triangles, triangle_kernels, only, work, table, library);
  run(corpora::of_disks, disk_kernels, only, work, table, library);
  run(corpora::of_boxes, box_kernels, only, work, table, library);
  run(corpora::of_quadrics, quadric_kernels, only, work, table, library);
  run(corpora::of_placed_spheres, placed_sphere_kernels, only, work, table, library);
  run(corpora::of_placed_planes, placed_plane_kernels, only, work, table, library);
  run(corpora::of_trees, tree_kernels, only, work, table, library);
  table.close();
  std::printf("library: wrong %" PRIu64 " of %" PRIu64 "; answered without rounding %" PRIu64 "\n",
              library.wrong, library.tests, library.fallbacks.exact);
  return library.wrong > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return stress(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stress_numerics: %s\n", error.what());
    return 2;
  }
}
