#include <protostar/sampling/estimate.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <protostar/sampling/film.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

/// Random numbers of a pixel, faster than std::mt19937_64 without optimizations (splitmix64).
struct Numbers {
  std::uint64_t state;

  double next() {
    std::uint64_t x = state += 0x9e3779b97f4a7c15;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
    x = (x ^ x >> 27) * 0x94d049bb133111eb;
    return static_cast<double>((x ^ x >> 31) >> 11) * 0x1p-53;
  }
};

/// SyntheticPixel whose mean and variance are known, as pictures have them.
struct SyntheticPixel {
  enum class Kind { edge, light, penumbra, rare } kind;
  double share;  ///< part of the pixel that is bright, or its probability

  [[nodiscard]] double sample(Numbers& numbers) const {
    const double u = numbers.next();
    switch (kind) {
      case Kind::edge:
        return u < share ? 1 : 0;
      case Kind::light:
        return 0.35 + 0.3 * u;
      case Kind::penumbra:
        return u < share ? 0.8 * numbers.next() : 0;
      default:
        return u < share ? 1 : 0.1;
    }
  }
  [[nodiscard]] double mean() const {
    switch (kind) {
      case Kind::edge:
        return share;
      case Kind::light:
        return 0.5;
      case Kind::penumbra:
        return 0.4 * share;
      default:
        return 0.1 + 0.9 * share;
    }
  }
  [[nodiscard]] double variance() const {
    switch (kind) {
      case Kind::edge:
        return share * (1 - share);
      case Kind::light:
        return 0.3 * 0.3 / 12;
      case Kind::penumbra:
        return 0.64 * (share / 3 - share * share / 4);
      default:
        return 0.81 * share * (1 - share);
    }
  }
};

/// Returns a picture of all kinds of pixels, or of those alone that are bright by the given chance.
std::vector<SyntheticPixel> picture(int pixels, bool all_kinds, double chance) {
  using enum SyntheticPixel::Kind;
  constexpr std::array<SyntheticPixel::Kind, 8> kinds{light, light,    light,    edge,
                                                      edge,  penumbra, penumbra, rare};
  std::vector<SyntheticPixel> made;
  Random random(static_cast<std::uint64_t>(pixels));
  for (std::size_t i = 0; i < static_cast<std::size_t>(pixels); ++i) {
    const SyntheticPixel::Kind kind = all_kinds ? kinds[i % 8] : rare;
    made.push_back({kind, kind == rare ? chance : random.real(0, 1)});
  }
  return made;
}

double mean_variance(const std::vector<SyntheticPixel>& pixels) {
  double sum = 0;
  for (const SyntheticPixel& pixel : pixels) sum += pixel.variance();
  return sum / static_cast<double>(pixels.size());
}

/// A render that doubles its samples until its error is small enough.
struct Render {
  const std::vector<SyntheticPixel>& pixels;
  std::vector<Numbers> numbers;
  std::vector<PixelSums> sums;
  std::uint32_t samples = 0;

  Render(const std::vector<SyntheticPixel>& of, std::uint64_t seed) : pixels(of), sums(of.size()) {
    for (std::uint64_t i = 0; i < of.size(); ++i) numbers.push_back({(seed << 32 | i) * 0xd1342543de82ef95});
  }

  PictureError draw_to(std::uint32_t more) {
    PictureError error;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      for (std::uint32_t k = samples; k < more; ++k)
        sums[i].add(k, Color{static_cast<float>(pixels[i].sample(numbers[i])), 0, 0});
      error.add(sums[i].squared_error(0));
    }
    samples = more;
    return error;
  }

  [[nodiscard]] double squared_error() const {
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double error = sums[i].sums[0].channels[0].value() + sums[i].sums[1].channels[0].value() -
                           samples * pixels[i].mean();
      sum += error * error / samples / samples;
    }
    return sum / static_cast<double>(pixels.size());
  }
};

/// Pictures above their target, of those of many seeds, and the samples that all of them took.
struct Coverage {
  int wrong = 0, wrong_without_margin = 0;
  double samples = 0;
};

Coverage coverage(const std::vector<SyntheticPixel>& pixels, double target, int seeds) {
  Coverage found;
  for (int seed = 1; seed <= seeds; ++seed) {
    Render render(pixels, static_cast<std::uint64_t>(seed));
    bool is_drawn = false;  // without a margin
    for (std::uint32_t samples = PictureError::first_look;; samples *= 2) {
      const PictureError error = render.draw_to(samples);
      const bool is_wrong = render.squared_error() > target * target;
      if (!is_drawn && error.squared() <= target * target)
        is_drawn = true, found.wrong_without_margin += is_wrong ? 1 : 0;
      if (!error.is_within(target)) continue;
      found.wrong += is_wrong ? 1 : 0;
      found.samples += samples;
      break;
    }
  }
  return found;
}

}  // namespace

TEST_CASE("the estimate of a picture's squared error is unbiased, also for few pixels and few samples") {
  const std::vector<SyntheticPixel> pixels = picture(16, true, 0.004);
  const double expected = mean_variance(pixels) / 4;
  const int seeds = cases(4000, 100000);
  double sum = 0, squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const double estimate = Render(pixels, static_cast<std::uint64_t>(seed)).draw_to(4).squared();
    sum += estimate, squares += estimate * estimate;
  }
  const double mean = sum / seeds, deviation = std::sqrt((squares / seeds - mean * mean) / seeds);
  CAPTURE(mean, expected, deviation);
  CHECK(std::abs(mean - expected) < 4 * deviation);
  CHECK(deviation < 0.02 * expected);
}

TEST_CASE("the squared error differs from its estimate with a variance of at most 2 mean(v^2)/P") {
  for (const auto& [all_kinds, rare] : {std::pair{true, 0.004}, {false, 0.5}, {false, 0.02}}) {
    const std::vector<SyntheticPixel> pixels = picture(64, all_kinds, rare);
    const int seeds = cases(500, 20000);
    double squares = 0, bound = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      Render render(pixels, static_cast<std::uint64_t>(seed));
      const PictureError error = render.draw_to(16);
      squares += std::pow(render.squared_error() - error.squared(), 2) / seeds;
      const double mean_of_squares =
          error.deviation() * error.deviation() * 64 + error.squared() * error.squared();
      bound += 2 * mean_of_squares / 64 / seeds;
    }
    CAPTURE(all_kinds, rare, squares / bound);
    CHECK(squares < bound);
    CHECK(squares > 0.2 * bound);
  }
}

TEST_CASE("at most 5 of 100 pictures have an error above their target") {
  // The hardest targets are those that the expected error of a look just misses.
  const std::vector<SyntheticPixel> pixels = picture(1024, true, 0.004);
  const int seeds = cases(20, 200);
  for (const double just_above : {1.0, 0.98}) {
    const double target = just_above * std::sqrt(mean_variance(pixels) / 64);
    const Coverage found = coverage(pixels, target, seeds);
    CAPTURE(found.wrong, found.wrong_without_margin, found.samples);
    CHECK(found.wrong <= seeds / 20);
    CHECK(found.samples <= 2.2 * 64 * seeds);
    if (just_above == 1.0) CHECK(found.wrong_without_margin > seeds / 20);  // the margin is needed
  }
}

TEST_CASE("error targets hold for pictures of one kind and for small ones", "[long]") {
  struct Row {
    int pixels;
    bool all_kinds;
    double rare, most_times;  ///< at most so many times the samples of an oracle that knows the variance
  };
  const auto row =
      GENERATE(Row{1024, false, 0.5, 2.2}, Row{1024, false, 0.05, 2.2}, Row{4096, false, 0.004, 2.6},
               Row{256, true, 0.004, 3.5}, Row{1024, true, 0.0005, 2.5}, Row{100, true, 0.004, 4.5},
               Row{PictureError::fewest_pixels, true, 0.004, 7});
  const std::vector<SyntheticPixel> pixels = picture(row.pixels, row.all_kinds, row.rare);
  for (const double samples : {64, 256}) {
    const double target = std::sqrt(mean_variance(pixels) / samples);
    const int seeds = cases(20, 200);
    const Coverage found = coverage(pixels, target, seeds);
    CAPTURE(row.pixels, row.all_kinds, row.rare, samples, found.wrong, found.wrong_without_margin,
            found.samples);
    CHECK(found.wrong <= seeds / 20);
    CHECK(found.samples <= row.most_times * seeds * samples);
  }
}

TEST_CASE("the bound of no error is none, and one unknown error makes it infinite") {
  PictureError none;
  CHECK(none.bound() == 0);
  CHECK(none.is_within(1e-300));
  CHECK(none.share(0.5) == 1);
  for (int i = 0; i < 10; ++i) none.add(0);
  CHECK(none.bound() == 0);
  PictureError some;
  for (int i = 0; i < 100; ++i) some.add(1);
  CHECK(some.deviation() == 0);
  CHECK(some.bound() == 1 + 2.9 * std::sqrt(2.0 / 100));
  CHECK(some.share(0.5) == 0.25 / some.bound());
  CHECK_FALSE(some.is_within(1));
  CHECK(some.is_within(2));
  some.add(infinity);
  CHECK(some.bound() == infinity);
  CHECK_FALSE(some.is_within(1e150));
  CHECK_FALSE(none.is_within(std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("a confidence sequence holds the mean after every observation, but for its share of failures") {
  struct Row {
    SyntheticPixel pixel;
    double target;
  };
  const auto row =
      GENERATE(Row{{SyntheticPixel::Kind::edge, 0.5}, 0.05}, Row{{SyntheticPixel::Kind::edge, 0.02}, 0.05},
               Row{{SyntheticPixel::Kind::light, 0}, 0.02}, Row{{SyntheticPixel::Kind::penumbra, 0.3}, 0.02},
               Row{{SyntheticPixel::Kind::rare, 0.004}, 0.05}, Row{{SyntheticPixel::Kind::edge, 1}, 0.05});
  constexpr double alpha = 0.05, most = 2;  // observations of a half of the range, as of a dark pixel
  const int sequences = cases(100, 2000), observations = cases(1000, 4000);
  const BernsteinRule rule(most, row.target, alpha);
  CHECK(BernsteinSequence(rule).half_width() == infinity);
  int failed = 0, failed_normal = 0;
  for (int k = 0; k < sequences; ++k) {
    Numbers numbers{static_cast<std::uint64_t>(k + 1) * 0xd1342543de82ef95};
    BernsteinSequence sequence(rule);
    double sum = 0, squares = 0;
    bool fails = false, fails_normal = false;
    for (int n = 1; n <= observations; ++n) {
      const double x = row.pixel.sample(numbers);
      sequence.add(x);
      sum += x, squares += x * x;
      fails = fails || !(std::abs(sequence.center() - row.pixel.mean()) <= sequence.half_width());
      const double deviation = std::sqrt(std::max(0.0, squares / n - sum * sum / n / n) / n);
      fails_normal = fails_normal || (n >= 100 && std::abs(sum / n - row.pixel.mean()) > 1.96 * deviation);
    }
    failed += fails ? 1 : 0;
    failed_normal += fails_normal ? 1 : 0;
  }
  CAPTURE(static_cast<int>(row.pixel.kind), row.pixel.share, failed, failed_normal);
  CHECK(failed <= alpha * sequences);
  // An interval of the normal distribution, looked at again and again, does not hold.
  if (row.pixel.variance() > 0) CHECK(failed_normal > 2 * alpha * sequences);
}

TEST_CASE("a confidence sequence comes to its target, but not before the least number of observations") {
  struct Row {
    SyntheticPixel pixel;
    double target, most_times;  ///< at most so many times 2 L variance/target², plus the least number
  };
  const auto row = GENERATE(
      Row{{SyntheticPixel::Kind::edge, 0.5}, 0.05, 1.6}, Row{{SyntheticPixel::Kind::edge, 0}, 0.05, 1},
      Row{{SyntheticPixel::Kind::edge, 1}, 0.05, 1}, Row{{SyntheticPixel::Kind::penumbra, 0.3}, 0.02, 1.6});
  const BernsteinRule rule(1, row.target, 0.05 / 3);
  BernsteinSequence sequence(rule);
  Numbers numbers{7};
  while (!sequence.is_within_target() && sequence.count() < 1e6) sequence.add(row.pixel.sample(numbers));
  const double normal = 2 * rule.log() * row.pixel.variance() / row.target / row.target;
  CAPTURE(row.pixel.share, row.target, sequence.count(), normal, rule.least_observations());
  CHECK(sequence.count() >= rule.least_observations());
  CHECK(sequence.count() <= row.most_times * normal + 1.6 * rule.least_observations());
  CHECK(std::abs(sequence.center() - row.pixel.mean()) <= row.target);
  CHECK(sequence.error_of(sequence.center()) == sequence.half_width());
  CHECK(sequence.error_of(sequence.center() + 1) ==
        sequence.half_width() + (sequence.center() + 1 - sequence.center()));
}

TEST_CASE("the interval of a confidence sequence is that of its theorem, and little wider") {
  Numbers numbers{11};
  for (const double target : {0.001, 0.02, 0.25, 3.0}) {
    CAPTURE(target);
    const BernsteinRule rule(1, target, 0.01);
    BernsteinSequence sequence(rule);
    // The means so far and the variances that choose weights are as if 1/2 had been seen once, with 1/4.
    double mean = 0.5, variance = 0.25, sum = 0.5, weights = 0, weighted = 0, penalty = 0;
    for (int n = 1; n <= 100; ++n) {
      const double x = n % 3 == 0 ? 1 : numbers.next();
      sequence.add(x);
      const double weight = std::min(0.75, target / (target + variance));
      weights += weight, weighted += weight * x;
      penalty += (x - mean) * (x - mean) * (-std::log1p(-weight) - weight);
      sum += x, mean = sum / (n + 1);
      variance = (variance * n + (x - mean) * (x - mean)) / (n + 1);
      // 100 steps and the difference of ψ(λ), at least λ²/2, of two numbers of λ's size: below 2^-40 for
      // these.
      const double width = (rule.log() + penalty) / weights;
      CHECK(sequence.half_width() > width * (1 - 0x1p-40));
      CHECK(sequence.half_width() < width * 1.011);
      CHECK(std::abs(sequence.center() - weighted / weights) < 0x1p-40);
    }
  }
}

TEST_CASE("a sequence scales with its range, and takes what is outside of it as an end") {
  const BernsteinRule one(1, 0.125, 0.05), eight(8, 1, 0.05);
  BernsteinSequence a(one), b(eight), c(eight);
  Numbers numbers{3};
  for (int i = 0; i < 200; ++i) {
    const double x = numbers.next();
    a.add(i % 4 == 0 ? 1 : i % 4 == 1 ? 0 : x);
    b.add(i % 4 == 0 ? 8 : i % 4 == 1 ? 0 : 8 * x);
    c.add(i % 4 == 0 ? infinity : i % 4 == 1 ? (i % 8 == 1 ? -1 : std::nan("")) : 8 * x);
  }
  CHECK(b.center() == 8 * a.center());
  CHECK(b.half_width() == 8 * a.half_width());
  CHECK(c.center() == b.center());
  CHECK(c.half_width() == b.half_width());
}

TEST_CASE("the rule of a sequence has its price, and refuses numbers that are no rule's") {
  // ln(2/.05) = 3.688879…; the target is 1/255 for radiance up to 10. With u = 2^-53, both logarithms are off
  // by at most 2u of themselves, and 2/α by 2u, which a logarithm has as such.
  const auto most_off = [](double logarithm) { return (4 * logarithm + 2) * 0x1p-53; };
  CHECK(std::abs(BernsteinRule(1, 0.01, 0.05).log() - std::log(40.0)) <= most_off(std::log(40.0)));
  CHECK(BernsteinRule(1, 0.01, 0.05).least_observations() == 492);
  CHECK(BernsteinRule(10, 1 / 255.0, 0.05).least_observations() == std::ceil(std::log(40.0) * 2550 / 0.75));
  CHECK(std::abs(BernsteinRule(1, 0.01, 1e-300).log() - std::log(2e300)) <= most_off(std::log(2e300)));
  const auto message = [](double most, double target, double alpha) {
    return message_of<std::invalid_argument>([&] { BernsteinRule rule(most, target, alpha); });
  };
  const double nan = std::nan("");
  for (const double wrong : {0.0, -1.0, infinity, nan}) {
    CHECK_THAT(message(wrong, 0.1, 0.05),
               ContainsSubstring("most must be finite and greater than 0; it is "));
    CHECK_THAT(message(1, wrong, 0.05),
               ContainsSubstring("target must be finite and greater than 0; it is "));
  }
  for (const double wrong : {0.0, 1.0, -1.0, nan, std::nextafter(0x1p-1022, 0.0)})
    CHECK_THAT(message(1, 0.1, wrong),
               ContainsSubstring("failure_probability must be less than 1 and at least 2^-1022 (2.2e-308); "
                                 "it is "));
  const double least = 1023 * std::log(2.0);
  CHECK(std::abs(BernsteinRule(1, 0.01, 0x1p-1022).log() - least) <= most_off(least));
}

TEST_CASE("a mean of large variance is known to within a large target after a while") {
  for (const double target : {0.15, 0.2, 0.25, 0.4}) {
    BernsteinSequence sequence(BernsteinRule(1, target, 1e-4));
    for (int i = 0; i < 3000 && !sequence.is_within_target(); ++i) sequence.add(i % 2);
    CAPTURE(target, sequence.count());
    CHECK(sequence.is_within_target());
  }
}
