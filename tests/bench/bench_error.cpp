// Run time against error, for algorithms to intersect a sphere and for pictures.
//
//   bench_error [--runs N] [--threads N] [--csv FILE] [--quick]
//
// A kernel is judged by exact arithmetic, on cases whose numbers float holds, so that all errors of a kernel
// in float are its own. A picture is judged by the true light on each of 640 × 480 pixels, the average over
// its area; a picture of fewer pixels is shown in larger ones. "front" marks the Pareto front of time and
// error.
#include "bench_error.hpp"

int main(int argc, char** argv) {
  return bench::run(argc, argv, [](const bench::Options& options) {
    errors_of_kernels(options);
    errors_of_pictures(options);
  });
}
