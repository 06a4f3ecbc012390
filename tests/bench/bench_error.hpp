// Both halves of bench_error. Each prints its tables.
#pragma once

#include <algorithm>
#include <vector>

#include "support.hpp"

namespace bench {

/// Time and error. On the Pareto front of several are those that none beats in one without losing in the
/// other.
struct Measure {
  double time, error;
};
inline bool is_on_front(const Measure& point, const std::vector<Measure>& all) {
  return std::none_of(all.begin(), all.end(), [&](const Measure& other) {
    return other.time <= point.time && other.error <= point.error &&
           (other.time < point.time || other.error < point.error);
  });
}

}  // namespace bench

/// Measures algorithms to intersect a ray and a sphere.
void errors_of_kernels(const bench::Options& options);

/// Measures pictures of the tutorial's scene, in the library's way and the naive one.
void errors_of_pictures(const bench::Options& options);
