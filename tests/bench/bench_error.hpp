// Both halves of bench_error. Each prints its table and returns the plots.
#pragma once

#include <vector>

#include "plot.hpp"
#include "support.hpp"

/// Measures algorithms to intersect a ray and a sphere.
bench::Plot errors_of_kernels(const bench::Options& options);

/// Measures pictures of the tutorial's scene, in the library's way and the naive one.
std::vector<bench::Plot> errors_of_pictures(const bench::Options& options);
