// Judges PathIntegrator by scenes with known light, as this project does, and by gates like those of others.
//
//   judge RAYS SAMPLES           looks at so many rays of each scene, with 32 times so many samples each
//   judge RAYS SAMPLES --bias B  doubles the samples of each scene until a relative bias of B would be found,
//   and
//                                prints a table of the scenes
//
// The last line has the number of scenes in which each gate finds a fault. The exit status is 1 if ours finds
// one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>

#include "support/light_truth.hpp"
#include "support/path_truth.hpp"

namespace {

/// Returns the probability that a normal number exceeds x, to both sides.
double normal_probability(double x) { return std::erfc(x / std::numbers::sqrt2); }

/// Returns that of Student's t with an odd number of degrees of freedom, as errors of rays have it.
double student_probability(double t) {
  constexpr int degrees = LightTruth::scramblings - 1;
  static_assert(degrees % 2 == 1);
  const double angle = std::atan(t / std::sqrt(degrees)), c = std::cos(angle);
  double sum = 0, term = c;
  for (int k = 1; k < degrees; k += 2) sum += term, term *= c * c * (k + 1) / (k + 2);
  return 1 - 2 / std::numbers::pi * (angle + std::sin(angle) * sum);
}

/// Returns the number that is exceeded with a probability of p, by bisection.
double exceeded_with(double p, double (*probability)(double)) {
  double low = 0, high = 40;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (probability(middle) > p ? low : high) = middle;
  }
  return low;
}

/// Returns the probability for each of some tests by which all of them together have the probability p
/// (Šidák).
double of_each_of(double tests, double p) { return -std::expm1(std::log1p(-p) / tests); }

/// One mean for the picture, which may be off by 2.5 %.
bool fails_mean(const LightTruth& light) { return std::abs(light.mean_error) > 0.025 * light.mean_truth; }

/// A test of each pixel, with 1 % of false alarms in all pixels together, in which .25 % of them may fail.
bool fails_pixels(const LightTruth& light) {
  const double most = exceeded_with(of_each_of(light.rays, 0.01), student_probability);
  const auto failed =
      std::count_if(light.estimates.begin(), light.estimates.end(), [&](const LightTruth::Estimate& one) {
        return std::abs(one.error) > most * one.deviation + 0x1p-20 * light.mean_truth / light.rays;
      });
  return static_cast<double>(failed) > 0.0025 * light.rays;
}

/// A test of the mean, with 1 % of false alarms in all scenes together.
bool fails_test_of_mean(const LightTruth& light, double scenes) {
  const double most = exceeded_with(of_each_of(scenes, 0.01), normal_probability);
  return std::abs(light.mean_error) > most * std::sqrt(light.variance) + 0x1p-20 * light.mean_truth;
}

}  // namespace

int main(int count, char** arguments) {
  const bool has_bias = count == 5 && std::strcmp(arguments[3], "--bias") == 0;
  if (count != 3 && !has_bias) {
    std::fprintf(stderr, "usage: judge RAYS SAMPLES [--bias B]\n");
    return 2;
  }
  const int rays = std::atoi(arguments[1]), least_samples = std::atoi(arguments[2]);
  const double target = has_bias ? std::atof(arguments[4]) : 0;
  const PathTruths truths(rays);
  const auto scenes = static_cast<int>(truths.all().size());
  int ours = 0, mean = 0, pixels = 0, test_of_mean = 0;
  double largest_bias = 0;
  if (has_bias)
    std::printf(
        "| scene | samples of a ray | largest z | z of the mean | bias that is found |\n"
        "| --- | --- | --- | --- | --- |\n");
  for (const PathTruth& truth : truths.all()) {
    int samples = least_samples;
    LightTruth light = truth.judge(samples);
    while (has_bias && PathTruth::detectable_bias(light) > target && samples < 1 << 16)
      light = truth.judge(samples *= 2);
    ours += !PathTruth::is_right(light);
    mean += fails_mean(light);
    pixels += fails_pixels(light);
    test_of_mean += fails_test_of_mean(light, scenes);
    largest_bias = std::max(largest_bias, PathTruth::detectable_bias(light));
    if (has_bias)
      std::printf("| %s | %d | %.1f | %.1f | %.3f %% |\n", truth.name.c_str(),
                  LightTruth::scramblings * samples, light.largest,
                  light.largest > 0 ? light.mean_error / std::sqrt(light.variance) : 0,
                  100 * PathTruth::detectable_bias(light));
    std::fflush(stdout);
  }
  std::printf("of %d scenes: ours %d, one mean %d, pixels %d, test of the mean %d; found in each: %.3f %%\n",
              scenes, ours, mean, pixels, test_of_mean, 100 * largest_bias);
  return ours > 0;
}
