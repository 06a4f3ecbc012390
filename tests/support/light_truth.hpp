// Tests of estimates of light against its true value, by independent scramblings.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <protostar/render.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <vector>

#include "random.hpp"
#include "wrong_cases.hpp"

/// Estimates of the light along some rays, compared with the truth.
///
/// For each ray, the means of independent scramblings are as many independent estimates, whose mean has the
/// standard error s/√R. If chance alone were at work, a share of 5e-9 of them would be more than 8 standard
/// errors away from the truth (Student's t with 31 degrees of freedom), so that of 200 rays or fewer a test
/// fails in one of 10^6 seeds; its seeds are fixed. Light is float: 2^-20 of it is allowed for rounding.
struct LightTruth {
  static constexpr int scramblings = 32;
  static constexpr double most_errors = 8;

  WrongCases wrong;
  int rays = 0, lit = 0;
  double largest = 0;     ///< distance from the truth, in standard errors
  double mean_error = 0;  ///< sum of estimate − truth over all rays
  double mean_truth = 0;  ///< sum of the truths
  double variance = 0;    ///< of the sum of errors

  /// An estimate along a ray: its distance from the truth, and its standard error.
  struct Estimate {
    double error, deviation;
  };
  std::vector<Estimate> estimates;

  /// Standard errors that are allowed; more than most_errors for more than 200 rays.
  double allowed_errors = most_errors;

  /// Compares the green light of estimate(sampler) with its true value.
  void compare(const protostar::Ray& ray, const auto& estimate, double truth, int samples) {
    using namespace protostar;
    std::vector<double> means;
    for (int r = 0; r < scramblings; ++r) {
      double mean = 0;
      for (int i = 0; i < samples; ++i)
        mean += estimate(SobolSampler({.seed = static_cast<std::uint64_t>(r) + 1,
                                       .x = static_cast<std::uint32_t>(rays),
                                       .sample = static_cast<std::uint32_t>(i),
                                       .samples = static_cast<std::uint32_t>(samples)}))
                    .g;
      means.push_back(mean / samples);
    }
    compare(means, truth, ray.origin, ray.direction);
  }

  /// Compares the means of scramblings with the true value.
  void compare(const std::vector<double>& means, double truth, const auto&... where) {
    double sum = 0, squares = 0;
    for (const double estimate : means)
      sum += estimate - truth, squares += (estimate - truth) * (estimate - truth);
    const double mean = sum / scramblings;
    const double square = std::max(0.0, squares / scramblings - mean * mean) / (scramblings - 1);
    const double allowed = allowed_errors * std::sqrt(square) + 0x1p-20 * truth;
    if (const double d = std::sqrt(square); d > 0x1p-20 * truth)
      largest = std::max(largest, std::abs(mean) / d);
    wrong.add(!(std::abs(mean) <= allowed), where..., "estimate", mean + truth, "truth", truth, "allowed",
              allowed);
    estimates.push_back({mean, std::sqrt(square)});
    ++rays, lit += truth > 0;
    mean_error += mean, mean_truth += truth, variance += square;
  }

  /// Returns the relative bias that would be found, if all rays had it: 8 standard errors of their sum, and
  /// as many again for chance.
  [[nodiscard]] double detectable_bias() const { return 2 * most_errors * std::sqrt(variance) / mean_truth; }
};
