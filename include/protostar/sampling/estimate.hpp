// Errors of pictures that are drawn by chance, known from the pictures alone: for the whole picture and for
// every pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "../numeric/power.hpp"
#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Estimate of a picture's squared error, the mean of (value − truth)² over P pixels and their channels, from
/// two independent halves of its samples. The truth is the mean of infinitely many samples.
///
/// In a pixel, let A and B be the errors of the means of the halves: independent, with the same distribution
/// and mean 0 in each channel. Their mean, which the picture shows, has in each channel the squared error
///   e = ((A + B)/2)²,   and   v = ((A − B)/2)²   is known without the truth.   (1)
/// With v and e from here on as means over the channels, and V the mean of v over the pixels:
/// - v is unbiased. e − v is the mean of A B over the channels, whose expectation is 0. Hence V has the
///   expectation of the squared error, whatever is drawn, for any number of samples and any sampler that is
///   unbiased.
/// - The spread of what V lacks is bounded. For c channels and the covariance matrix S of A, the variance of
///   e − v is tr(S²)/c². Multiplying out |A − B|⁴, in which terms with a single A or B have the mean 0, gives
///   an expectation of v² of at least (4 tr(S)² + 4 tr(S²))/(16 c²). As tr(S²) ≤ tr(S)², the variance is at
///   most two times the expectation of v²:
///     variance of (squared error − V) ≤ 2 · mean(v²)/P.   (2)
/// These two are proven, for pixels that are independent of each other. The rest is asymptotic in P: by
/// the central limit theorem a mean over the pixels is nearly normal, and mean(v²) is near its expectation.
/// The normal distribution is above 2.9 standard deviations with a probability of .0019, at each of
/// 13 looks (from first_look to 65536 samples, doubling): 2.5 % in all, so that
///   squared error ≤ V + 2.9 √(2 mean(v²)/P)
/// holds at whichever look the render ends. mean(v²) is itself an estimate, too small if some pixels have
/// rare, large errors that none of their samples met. V is then too small with it, and a further margin of
/// 2.9 standard deviations of V is added, which leaves the other 2.5 % to that:
///   bound = V + 2.9 √((mean(v²) − V²)/P) + 2.9 √(2 mean(v²)/P).   (3)
/// Each doubling beyond 65536 samples adds .2 % to either. Of a few pixels nothing is promised: in
/// tests/estimate.cpp less than 1 % of pictures of 32 pixels miss their targets, but 2 % of 16 pixels and 30
/// % of one.
class PictureError {
 public:
  static constexpr int first_look = 16;       ///< samples in each pixel before the first look at the bound
  static constexpr double deviations = 2.9;   ///< standard deviations in each margin of the bound
  static constexpr double confidence = 0.95;  ///< probability that the bound holds at all of 13 looks
  static constexpr std::uint64_t fewest_pixels = 32;  ///< size of a picture from which on the bound holds

  /// Adds a pixel: the mean of v (1) over its channels.
  void add(double squared_error) {
    ++pixels_;
    sum_ += squared_error;
    sum_of_squares_ += squared_error * squared_error;
  }

  [[nodiscard]] std::uint64_t pixels() const { return pixels_; }

  /// Returns V, the unbiased estimate of the squared error; 0 for no pixels.
  [[nodiscard]] double squared() const { return pixels_ == 0 ? 0 : sum_ / count(); }

  /// Returns the estimate of the root of the mean squared error (RMSE).
  [[nodiscard]] double rmse() const { return std::sqrt(squared()); }

  /// Returns the standard deviation of V, by the spread of v over the pixels.
  [[nodiscard]] double deviation() const {
    return std::sqrt(std::max(0.0, mean_of_squares() - squared() * squared()) / std::max(1.0, count()));
  }

  /// Returns the bound of the squared error (3).
  [[nodiscard]] double bound() const {
    return squared() + deviations * deviation() +
           deviations * std::sqrt(2 * mean_of_squares() / std::max(1.0, count()));
  }

  /// Returns true if the RMSE is at most the target, with the confidence.
  [[nodiscard]] bool is_within(double target) const { return bound() <= target * target; }

  /// Returns which share of the samples that the target takes has been taken, at most 1, if the squared error
  /// falls with their number. It falls faster with samples that are spread evenly, which end sooner.
  [[nodiscard]] double share(double target) const {
    const double square = target * target;
    return square < bound() ? square / bound() : bound() <= square ? 1 : 0;
  }

 private:
  [[nodiscard]] double count() const { return static_cast<double>(pixels_); }
  [[nodiscard]] double mean_of_squares() const { return pixels_ == 0 ? 0 : sum_of_squares_ / count(); }

  std::uint64_t pixels_ = 0;
  double sum_ = 0, sum_of_squares_ = 0;
};

/// Rule for each pixel by itself: observe until the mean is known to within a target, with a probability of
/// failure that is proven, for observations from 0 to a largest value.
class BernsteinRule {
 public:
  /// Makes a rule for observations in [0, most], such as one channel of radiance that is clamped. For all
  /// channels of all pixels of a picture together, divide the probability of failure by their number, 3 P.
  /// Throws std::invalid_argument unless most and target are finite and greater than 0, and the probability
  /// is less than 1 and at least 2^-1022, so that 2/α is finite.
  BernsteinRule(double most, double target, double failure_probability) : most_(most), target_(target) {
    require(most > 0 && std::isfinite(most), "most", "finite and greater than 0", most);
    require(target > 0 && std::isfinite(target), "target", "finite and greater than 0", target);
    require(failure_probability >= 0x1p-1022 && failure_probability < 1, "failure_probability",
            "less than 1 and at least 2^-1022 (2.2e-308)", failure_probability);
    // ln(2/α), of the correctly rounded quotient; above 0.69, as α < 1.
    log_ = (log2(DoubleDouble(2 / failure_probability)) * detail::ln_2).hi;
  }

  [[nodiscard]] double most() const { return most_; }
  [[nodiscard]] double target() const { return target_; }
  [[nodiscard]] double log() const { return log_; }  ///< L = ln(2/α) for the probability of failure α

  /// Returns the least number of observations that the rule takes, however little they differ: the half width
  /// is at least L/Σλ ≥ L/(n · largest_weight) of the largest value.
  [[nodiscard]] double least_observations() const {
    return std::ceil(log_ * most_ / (largest_weight * target_));
  }

  static constexpr double largest_weight = 0.75;  ///< largest λ of an observation (BernsteinSequence)

 private:
  static void require(bool holds, const char* name, const char* allowed, double value) {
    if (!holds)
      throw std::invalid_argument("BernsteinRule: " + std::string(name) + " must be " + allowed + "; it is " +
                                  shown(value));
  }

  double most_, target_, log_ = 0;
};

/// Confidence sequence of a mean: an interval that holds it after every observation at once, except with the
/// rule's probability of failure, so that one may stop as soon as it is narrow enough (empirical Bernstein:
/// Waudby-Smith and Ramdas, "Estimating means of bounded random variables by betting", 2023, theorem 2).
///
/// Observations have to be independent of each other or at least have the same mean whatever came before:
/// independent samples, or means over scramblings each of which is used once; not the samples of one
/// scrambling one by one. Divided by the largest value they are x in [0, 1]. With weights λ, each chosen
/// before its observation, and m the mean so far, the interval is
///   Σ λ x/Σ λ ± (L + Σ (x − m)² ψ(λ))/Σ λ,   ψ(λ) = −ln(1 − λ) − λ.
/// For a variance s² the half width is about L/(nλ) + λ s²/2. It comes to the target E by the fewest
/// observations, n = 2 L s²/E², if λ = E/s². For targets that are not small against s², the second term is
/// ψ(λ) s²/λ; with λ = E/(E + s²) it stays below E/2, since ψ(λ)/λ = (1 + r) ln(1 + r)/r − 1 < r/2 for
/// r = E/s². Hence λ = min(.75, E/(E + variance so far)).
class BernsteinSequence {
 public:
  explicit BernsteinSequence(const BernsteinRule& rule) : rule_(rule) {}

  /// Adds an observation. One outside of [0, most] counts as the nearer end, and NaN as 0.
  void add(double observation) {
    const double x = observation > 0 ? std::min(observation / rule_.most(), 1.0) : 0.0;
    const double target = rule_.target() / rule_.most();
    const double weight = std::min(BernsteinRule::largest_weight, target / (target + variance_));
    weights_ += weight;
    weighted_ += weight * x;
    penalty_ += (x - mean_) * (x - mean_) * upper_psi(weight);
    // The mean and the variance start as if 1/2 had been observed once, with a variance of 1/4.
    ++count_;
    sum_ += x;
    mean_ = (0.5 + sum_) / (count_ + 1);
    variance_ = (variance_ * count_ + (x - mean_) * (x - mean_)) / (count_ + 1);
  }

  /// Returns the number of observations.
  [[nodiscard]] double count() const { return count_; }

  /// Returns the center of the interval; 0 for no observations.
  [[nodiscard]] double center() const { return count_ == 0 ? 0 : rule_.most() * weighted_ / weights_; }

  /// Returns half of the interval's width; infinity for no observations.
  [[nodiscard]] double half_width() const { return rule_.most() * ((rule_.log() + penalty_) / weights_); }

  /// Returns the largest error that a value, such as the plain mean, can have while the interval holds.
  [[nodiscard]] double error_of(double value) const { return std::abs(value - center()) + half_width(); }

  /// Returns true if the center is known to within the target.
  [[nodiscard]] bool is_within_target() const { return half_width() <= rule_.target(); }

 private:
  /// Returns an upper bound of ψ(λ) = λ²/2 + λ³/3 + …: seven terms, and λ⁹/9 (1 + λ + λ² + …) for the rest,
  /// which exceeds λ⁹/9 + λ¹⁰/10 + …. It is 1.1 % too large at λ = .75, and less for smaller weights.
  [[nodiscard]] static double upper_psi(double weight) {
    const double rest = weight / (9 * (1 - weight));
    return weight * weight *
           (1.0 / 2 +
            weight *
                (1.0 / 3 +
                 weight * (1.0 / 4 +
                           weight * (1.0 / 5 +
                                     weight * (1.0 / 6 + weight * (1.0 / 7 + weight * (1.0 / 8 + rest)))))));
  }

  BernsteinRule rule_;
  double count_ = 0, sum_ = 0, mean_ = 0.5, variance_ = 0.25;
  double weights_ = 0, weighted_ = 0, penalty_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI
