// Rays against single surfaces, by the library and in the usual ways, judged by exact arithmetic.
//
//   stress_numerics [--tests N] [--seed S] [--kernel K] [--csv FILE]
//
// N cases (2,000,000) are shared out among the corpora. Half of the cases consist of numbers that float
// holds; kernels in float get only those, so that what they get wrong is their own doing. t is in units of
// the last place of double. Exits with 1 if the library was wrong once, and prints the case in hexadecimal.

#include <array>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <optional>
#include <protostar/scene.hpp>
#include <string>

#include "corpora.hpp"
#include "naive.hpp"
#include "options.hpp"
#include "oracle.hpp"

using namespace protostar;
using exact::Quad;

namespace {

// ---- A batch of cases, in double and in float, with what is true of them

template <class T>
naive::Vector<T> converted(const Vec3& v) {
  return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}
template <class T>
naive::Ray<T> converted(const Ray& ray) {
  return {converted<T>(ray.origin), converted<T>(ray.direction)};
}
template <class T>
naive::Sphere<T> converted(const Sphere& s) {
  return {converted<T>(s.center), static_cast<T>(s.radius)};
}
template <class T>
naive::Plane<T> converted(const Plane& s) {
  return {converted<T>(s.normal), static_cast<T>(s.distance)};
}
template <class T, class S>
using Converted = decltype(converted<T>(S()));

/// The nearest float. Through a volatile, since g++ 12 at -O2 drops the rounding of pairs of doubles that are
/// converted to float and back.
double rounded(double x) {
  const volatile float nearest = static_cast<float>(x);
  return nearest;
}
Vec3 rounded(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }
Sphere rounded(const Sphere& s) { return {rounded(s.center), rounded(s.radius)}; }
Plane rounded(const Plane& s) { return {rounded(s.normal), rounded(s.distance)}; }

bool is_sound(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3{0};
}
bool is_sound(const Sphere& s) { return is_finite(s.center) && std::isfinite(s.radius) && s.radius != 0; }
bool is_sound(const Plane& s) {
  return is_finite(s.normal) && std::isfinite(s.distance) && s.normal != Vec3{0};
}

/// The case with every number rounded to float, if it stays one.
template <class S>
std::optional<Case<S>> in_floats(const Case<S>& c) {
  Case<S> near{{rounded(c.ray.origin), rounded(c.ray.direction)}, rounded(c.surface)};
  if (c.ray.departure.kind != Departure::Kind::none) near.ray.departure = near.surface.departure();
  return is_sound(near.ray) && is_sound(near.surface) ? std::optional(near) : std::nullopt;
}

template <class S>
struct Batch {
  std::vector<Case<S>> cases;
  std::vector<std::pair<naive::Ray<double>, Converted<double, S>>> doubles;
  std::vector<std::pair<naive::Ray<float>, Converted<float, S>>> floats;
  std::vector<bool> exact_in_float;
  std::vector<exact::Roots> roots;

  Batch(const Corpus<S>& corpus, Random& random, std::size_t count) {
    while (cases.size() < count) {
      Case<S> c = corpus.next(random);
      const auto in_float = corpora::coin(random) ? in_floats(c) : std::nullopt;
      if (in_float) c = *in_float;
      if (!is_sound(c.ray) || !is_sound(c.surface)) continue;
      cases.push_back(c);
      doubles.emplace_back(converted<double>(c.ray), converted<double>(c.surface));
      floats.emplace_back(converted<float>(c.ray), converted<float>(c.surface));
      exact_in_float.push_back(in_float.has_value());
      roots.push_back(exact::roots(c.ray, c.surface, c.ray.departure.kind != Departure::Kind::none));
    }
  }
};

// ---- The kernels

/// Calculates the first t > 0 of every case, infinity for a miss.
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
                                                 {"tutorial", true, in_float<naive::quadratic<float>>},
                                                 {"geometric", true, in_float<naive::geometric>},
                                                 {"gems", true, in_float<naive::gems>},
                                                 {"double", false, in_double<naive::quadratic<double>>}};
const std::vector<Kernel<Plane>> plane_kernels{{"library", false, run_library<Plane>},
                                               {"tutorial", true, in_float<naive::quotient<float>>},
                                               {"double", false, in_double<naive::quotient<double>>}};

// ---- What is counted

/// How many values there were of each size, in steps of 2^(1/8).
class Quantiles {
 public:
  void add(double value) {
    largest_ = std::max(largest_, value), ++total_;
    const double step = value > 0 ? std::floor(8 * std::log2(value)) : -offset;
    ++counts_[static_cast<std::size_t>(std::clamp(step + offset, 0.0, 2 * offset))];
  }
  /// The value that a share of all do not exceed, to the next step.
  [[nodiscard]] double at(double share) const {
    std::uint64_t left = static_cast<std::uint64_t>(share * static_cast<double>(total_));
    std::size_t i = 0;
    while (i + 1 < counts_.size() && counts_[i] <= left) left -= counts_[i++];
    return i == 0 ? 0 : std::min(largest_, std::exp2((static_cast<double>(i) + 1 - offset) / 8));
  }
  [[nodiscard]] double largest() const { return largest_; }

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
};

Quad size_of(Quad x) { return x < 0 ? -x : x; }

/// |t − truth| in units of the last place of truth.
double ulps(double t, Quad truth) {
  int exponent = 0;
  std::frexp(static_cast<double>(truth), &exponent);
  const double ulp = std::ldexp(1, std::max(exponent - 53, -1074));
  return static_cast<double>(size_of(Quad(t) - truth) / Quad(ulp));
}

/// The first root ahead of the origin.
const exact::Root* first_ahead(const exact::Roots& roots) {
  for (const exact::Root& root : roots)
    if (root.t > 0) return &root;
  return nullptr;
}

using QuadVector = std::array<Quad, 3>;

double length(const QuadVector& v) {
  const auto square = [](Quad x) { return static_cast<double>(x) * static_cast<double>(x); };
  return std::sqrt(square(v[0]) + square(v[1]) + square(v[2]));
}

/// The normal where the line has the parameter t, which is a root.
QuadVector true_normal(const Case<Sphere>& c, Quad t) {
  const auto component = [&](int i) {
    return (Quad(c.ray.origin[i]) + t * Quad(c.ray.direction[i]) - Quad(c.surface.center[i])) /
           Quad(c.surface.radius);
  };
  return {component(0), component(1), component(2)};
}

/// The distance between a normal and the true one.
template <class T>
double normal_error(const naive::Vector<T>& normal, const QuadVector& truth) {
  return length(QuadVector{Quad(normal.x) - truth[0], Quad(normal.y) - truth[1], Quad(normal.z) - truth[2]});
}

/// That of a kernel's normal, from its own t and in its own precision.
template <class T>
double normal_error(const Case<Sphere>& c, double t, Quad truth) {
  const auto ray = converted<T>(c.ray);
  const auto sphere = converted<T>(c.surface);
  const naive::Vector<T> normal =
      (ray.origin + static_cast<T>(t) * ray.direction - sphere.center) / sphere.radius;
  return normal_error(normal, true_normal(c, truth));
}

// ---- The library's promises beyond hit and miss

/// Whether the normal at a t with this relative error is as near to the true one as Sphere::normal_at says,
/// and no more turned. (The true one of a ray that leaves the sphere is not of unit length, as its origin is
/// rounded.)
bool is_within_bound(const Case<Sphere>& c, double t, double relative_error, Quad truth) {
  const Vec3 way = t * c.ray.direction;
  const Point point = c.ray.at(t);
  const double T = std::hypot(way.x, way.y, way.z), P = std::hypot(point.x, point.y, point.z);
  const double bound = (relative_error * T + 0x1p-53 * (T + P)) / std::abs(c.surface.radius) + 0x1p-51;

  const Vec3 normal = c.surface.normal_at(point);
  const Quad x = normal.x, y = normal.y, z = normal.z;
  const QuadVector n = true_normal(c, truth);
  const QuadVector cross{y * n[2] - z * n[1], z * n[0] - x * n[2], x * n[1] - y * n[0]};
  // The sine, times both lengths: from further than the bound says anything about, the normal may be 0.
  const bool is_turned_no_more = length(cross) <= bound * length(QuadVector{x, y, z}) * length(n);
  return normal_error(normal, n) <= bound && (is_turned_no_more || c.ray.departure == c.surface.departure());
}
bool is_within_bound(const Case<Plane>&, double, double, Quad) { return true; }

/// The first promise that is broken, if any is.
template <class S>
const char* broken_promise(const Case<S>& c, const exact::Roots& truth) {
  const Roots roots = c.surface.roots(c.ray);
  // The roots of a ray of a tangency may be given once or twice, those of two crossings not.
  if (roots.count() != static_cast<int>(truth.size())) return "the number of roots";
  for (int i = 0; i < roots.count(); ++i) {
    const double t = roots[i];
    const Quad exact_t = truth[static_cast<std::size_t>(i)].t;
    if ((t > 0) != (exact_t > 0) || (t < 0) != (exact_t < 0)) return "the sign of a root";
    if (!(size_of(Quad(t) - exact_t) <= Quad(0x1p-30) * size_of(exact_t))) return "a root to 2^-30";

    const Material material;
    const Intersection hit(c.ray, {{t, i}, &c.surface, &functions_of<S>, &material});
    if (ulps(hit.refined(), exact_t) > 1) return "a refined root to 1 ulp";
    if (!is_within_bound(c, t, 0x1p-30, exact_t)) return "a normal";
    if (!is_within_bound(c, hit.refined(), 0x1p-52, exact_t)) return "a normal of a refined root";
  }
  for (const Interval range : {Interval{0, 1}, Interval{1, infinity}, Interval{-infinity, 1}}) {
    const exact::Root* first = nullptr;
    for (const exact::Root& root : truth)
      if (!first && (range.min == -infinity || compare(root, exact::root_at(range.min)) > 0) &&
          (range.max == infinity || compare(root, exact::root_at(range.max)) < 0))
        first = &root;
    const auto t = c.surface.intersect(c.ray, range);
    if (t.has_value() != (first != nullptr)) return "a root inside a range that ends at 1";
    if (t && size_of(Quad(*t) - first->t) > Quad(0x1p-30) * size_of(first->t))
      return "the first root inside a range that ends at 1";
  }
  return nullptr;
}

void print(const Vec3& v) { std::fprintf(stderr, "{%a, %a, %a}", v.x, v.y, v.z); }
void print(const Sphere& s) {
  std::fprintf(stderr, "sphere "), print(s.center), std::fprintf(stderr, ", %a", s.radius);
}
void print(const Plane& s) {
  std::fprintf(stderr, "plane "), print(s.normal), std::fprintf(stderr, ", %a", s.distance);
}

template <class S>
void report(const char* corpus, const char* what, const Case<S>& c, const exact::Roots& truth) {
  static int reports = 0;
  if (++reports > 20) return;
  std::fprintf(stderr, "wrong in %s: %s\n  origin ", corpus, what);
  print(c.ray.origin), std::fprintf(stderr, " direction "), print(c.ray.direction);
  std::fprintf(stderr, c.ray.departure.kind == Departure::Kind::none ? "\n  " : " leaving\n  "),
      print(c.surface);
  std::fprintf(stderr, "\n  true:");
  for (const exact::Root& root : truth) std::fprintf(stderr, " %a", static_cast<double>(root.t));
  std::fprintf(stderr, " library:");
  for (const double t : c.surface.roots(c.ray)) std::fprintf(stderr, " %a", t);
  std::fprintf(stderr, "\n");
}

// ---- Judging

/// What is wrong with an answer; adds it to the tally.
template <class S>
const char* judge(Tally& tally, const Kernel<S>& kernel, const Case<S>& c, const exact::Roots& truth,
                  double t) {
  const exact::Root* first = first_ahead(truth);
  const bool hit = t < infinity;
  ++tally.tests;
  if (first) ++tally.hits;
  if (hit && !first) return ++tally.false_hits, "a false hit";
  if (!hit && first) return ++tally.false_misses, "a false miss";
  if (!hit) return nullptr;
  // Roots so near to each other that the kernel's numbers hardly tell them apart may stand for each other.
  const Quad apart = Quad(kernel.in_float ? 0x1p-20 : 0x1p-30) * size_of(first->t);
  for (const exact::Root& other : truth)
    if (size_of(other.t - first->t) > apart && size_of(Quad(t) - other.t) < size_of(Quad(t) - first->t))
      return ++tally.wrong_roots, "a wrong root";
  tally.t_error.add(ulps(t, first->t));
  if constexpr (std::same_as<S, Sphere>)
    tally.normal_error.add(kernel.in_float ? normal_error<float>(c, t, first->t)
                                           : normal_error<double>(c, t, first->t));
  return nullptr;
}

/// The library's answer against all that it promises.
template <class S>
void judge_promises(Tally& tally, const char* corpus, const char* wrong, const Case<S>& c,
                    const exact::Roots& truth) {
  if (const char* broken = broken_promise(c, truth)) {
    if (!wrong) ++tally.broken;
    wrong = broken;
  }
  if (wrong) report(corpus, wrong, c, truth);
}

/// One kernel on one batch.
template <class S>
void run(Tally& tally, const Kernel<S>& kernel, const char* corpus, const Batch<S>& batch) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> t(batch.cases.size());
  fallbacks = {};
  const auto start = Clock::now();
  kernel.run(batch, t);
  tally.seconds += std::chrono::duration<double>(Clock::now() - start).count();
  tally.timed += t.size();
  tally.fallbacks.double_double += fallbacks.double_double;
  tally.fallbacks.exact += fallbacks.exact;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (kernel.in_float && !batch.exact_in_float[i]) continue;
    const char* wrong = judge(tally, kernel, batch.cases[i], batch.roots[i], t[i]);
    if (kernel.is_library()) judge_promises(tally, corpus, wrong, batch.cases[i], batch.roots[i]);
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
    std::printf("%-17s%-10s%10s%10s%9s%9s%9s%8s%10s%10s%10s%10s%10s%7s\n", "corpus", "kernel", "tests",
                "hits", "f. hits", "f. miss", "w. root", "broken", "t p50", "t p99.9", "t max", "n p99.9",
                "n max", "ns");
  }

  void row(const char* corpus, const char* kernel, const Tally& x) {
    const double ns = 1e9 * x.seconds / static_cast<double>(std::max<std::uint64_t>(x.timed, 1));
    const auto& t = x.t_error;
    const auto& n = x.normal_error;
    std::printf("%-17s%-10s%10" PRIu64 "%10" PRIu64 "%9" PRIu64 "%9" PRIu64 "%9" PRIu64 "%8" PRIu64
                "%10.2g%10.2g%10.2g%10.2g%10.2g%7.1f\n",
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
    fallbacks.double_double += tally.fallbacks.double_double;
    fallbacks.exact += tally.fallbacks.exact;
  }
};

/// Every chosen kernel on every corpus of one kind of surface; what the library did is added to the totals.
template <class S>
void run(const std::vector<Corpus<S>>& all, const std::vector<Kernel<S>>& kernels, const std::string& only,
         std::uint64_t tests, Random& seeds, Table& table, Totals& library) {
  for (const Corpus<S>& corpus : all) {
    Random random(seeds.bits());
    std::vector<Tally> tallies(kernels.size());
    for (std::uint64_t left = tests; left > 0;) {
      const Batch<S> batch(corpus, random, static_cast<std::size_t>(std::min<std::uint64_t>(left, 256)));
      left -= batch.cases.size();
      for (std::size_t k = 0; k < kernels.size(); ++k)
        if (only.empty() || only == kernels[k].name) run(tallies[k], kernels[k], corpus.name, batch);
    }
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      if (!only.empty() && only != kernels[k].name) continue;
      table.row(corpus.name, kernels[k].name, tallies[k]);
      if (kernels[k].is_library()) library.add(tallies[k]);
    }
  }
}

bool is_kernel(const std::string& name) {
  return std::any_of(sphere_kernels.begin(), sphere_kernels.end(),
                     [&](const auto& k) { return name == k.name; });
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed", "--kernel", "--csv"});
  const std::string& only = options.text("--kernel");
  if (!only.empty() && !is_kernel(only)) throw std::invalid_argument("no such kernel: " + only);
  const std::uint64_t corpora_count = corpora::of_spheres.size() + corpora::of_planes.size();
  const std::uint64_t each = (options.number("--tests", 2'000'000) + corpora_count - 1) / corpora_count;
  Random seeds(options.number("--seed", 1));

  Table table(options.text("--csv"));
  Totals library;
  run(corpora::of_spheres, sphere_kernels, only, each, seeds, table, library);
  run(corpora::of_planes, plane_kernels, only, each, seeds, table, library);
  table.close();
  std::printf("library: wrong %" PRIu64 " of %" PRIu64 "; not decided in double %" PRIu64
              ", nor in double-double %" PRIu64 "\n",
              library.wrong, library.tests, library.fallbacks.double_double, library.fallbacks.exact);
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
