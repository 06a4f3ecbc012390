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
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <mutex>
#include <protostar/scene.hpp>
#include <stdexcept>
#include <string>
#include <vector>

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
#include "csv.hpp"
#include "numerics/kernels.hpp"
#include "numerics/promises.hpp"
#include "numerics/report.hpp"
#include "numerics/sound_cases.hpp"
#include "numerics/tally.hpp"
#include "oracle/equations.hpp"
#include "truth.hpp"
#include "usual.hpp"
#include "work.hpp"

using namespace protostar;
using namespace numerics;
using exact::Truth, exact::TrueRoot;

namespace {

// ---- Judging

/// Returns the first root ahead of the origin, or nullptr.
const TrueRoot<long double>* first_ahead(const Truth<>& truth) {
  for (const auto& root : truth)
    if (root.t > 0) return &root;
  return nullptr;
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
  explicit Table(const std::string& csv)
      : csv_(csv,
             "corpus,kernel,tests,hits,false hits,false misses,wrong roots,broken promises,t p50 ulp,t p99.9 "
             "ulp,t max ulp,normal p99.9,normal max,ns per test") {
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
    csv_.row(corpus, kernel, x.tests, x.hits, x.false_hits, x.false_misses, x.wrong_roots, x.broken,
             t.at(0.5), t.at(0.999), t.largest(), n.at(0.999), n.largest(), ns);
  }

 private:
  CsvFile csv_;
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
