// The two halves of bench_error. Each prints its table and gives what is to be drawn.
#pragma once

#include <vector>

#include "plot.hpp"
#include "support.hpp"

/// Ways to intersect a ray and a sphere.
bench::Plot errors_of_kernels(const bench::Options& options);

/// Pictures of the tutorial's scene, the library's way and the naive one.
std::vector<bench::Plot> errors_of_pictures(const bench::Options& options);
