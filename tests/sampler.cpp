#include <protostar/sampling/halton_sampler.hpp>
#include <protostar/sampling/hammersley_sampler.hpp>
#include <protostar/sampling/hash.hpp>
#include <protostar/sampling/independent_sampler.hpp>
#include <protostar/sampling/sampler.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/stratified_sampler.hpp>
#include <protostar/vec3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Calls test(name, sampler type in a box) for each sampler of which the numbers are random.
template <class S>
struct Kind {
  using type = S;
};
void for_each_random_sampler(const auto& test) {
  test("independent", Kind<IndependentSampler>());
  test("stratified", Kind<StratifiedSampler>());
  test("halton", Kind<HaltonSampler>());
  test("sobol", Kind<SobolSampler>());
}
void for_each_sampler(const auto& test) {
  for_each_random_sampler(test);
  test("hammersley", Kind<HammersleySampler>());
}

/// Returns the first points of one scrambling, of a set.
template <class S>
std::vector<SampleSet<double>> points_of(const SampleIndex& at, std::uint32_t scrambling, std::uint32_t set,
                                         std::uint32_t count) {
  std::vector<SampleSet<double>> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    SampleIndex index = at;
    index.sample = scramblings * i + scrambling;
    points.push_back(S(index)(set));
  }
  return points;
}

/// Returns the least and the largest number of points in a box of a grid with so many cells along each axis.
std::pair<int, int> least_and_most(const std::vector<SampleSet<double>>& points,
                                   const std::array<std::size_t, 4>& cells) {
  std::vector<int> counts(cells[0] * cells[1] * cells[2] * cells[3]);
  for (const SampleSet<double>& point : points) {
    std::size_t box = 0;
    for (std::size_t d = 0; d < 4; ++d)
      box = box * cells[d] + static_cast<std::size_t>(point[d] * static_cast<double>(cells[d]));
    ++counts[box];
  }
  const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
  return {*least, *most};
}

/// Counts of a table of equally likely results.
class CellCounts {
 public:
  explicit CellCounts(std::size_t size) : counts_(size) {}

  void add(std::size_t result) { ++counts_.at(result), ++total_; }

  /// Tests whether χ² is within its limit, which it exceeds by chance with a probability of less than 2.6 ·
  /// 10^-10 for 15 to 255 degrees of freedom (Wilson and Hilferty: the cube root of χ² is about normal; here
  /// 6.2 deviations from its mean, checked by the incomplete gamma function). The tests of this file make
  /// less than 3,800 such tests, so that all pass with a probability above 1 − 10^-6; their seeds are fixed.
  bool are_even() const {
    const double expected = total_ / static_cast<double>(counts_.size());
    double chi_square = 0;
    for (const double count : counts_) chi_square += (count - expected) * (count - expected) / expected;
    const double freedom = static_cast<double>(counts_.size()) - 1, spread = 2 / (9 * freedom);
    return chi_square < freedom * std::pow(1 - spread + 6.2 * std::sqrt(spread), 3);
  }

 private:
  std::vector<double> counts_;
  double total_ = 0;
};

std::size_t part(double number, std::size_t parts) {
  return static_cast<std::size_t>(number * static_cast<double>(parts));
}

/// Tests whether two numbers are independent and uniform: first(pixel) and second(pixel) over many pixels, by
/// 8 × 8 boxes.
bool are_independent(const auto& first, const auto& second) {
  CellCounts counts(64);
  for (std::uint32_t pixel = 0; pixel < 4096; ++pixel)
    counts.add(8 * part(first(pixel), 8) + part(second(pixel), 8));
  return counts.are_even();
}

/// Sampler of a user's own.
struct OwnSampler {
  explicit OwnSampler(const SampleIndex& at) : index(at) {}
  SampleSet<double> operator()(std::uint32_t set) const {
    return {(index.x + 0.5) / 1e3, (index.y + 0.5) / 1e3, (index.sample + 0.5) / index.samples,
            (set + 0.5) / 1e3};
  }
  SampleIndex index;
};
static_assert(Sampler<OwnSampler>);
static_assert(!Sampler<int>);

}  // namespace

TEST_CASE("keys of pixels are all different, for one seed and over seeds") {
  std::set<std::uint64_t> keys;
  for (std::uint32_t x = 0; x < 100; ++x)
    for (std::uint32_t y = 0; y < 100; ++y) keys.insert(sampling::pixel_key(7, x, y));
  CHECK(keys.size() == 10000);
  for (std::uint64_t seed = 8; seed < 1008; ++seed) keys.insert(sampling::pixel_key(seed, 3u, 5u));
  CHECK(keys.size() == 11000);
  // Both words of the place and all digits of the seed count.
  CHECK(sampling::pixel_key(0, 0u, 1u) != sampling::pixel_key(0, 1u, 0u));
  CHECK(sampling::pixel_key(std::uint64_t{1} << 63, 0u, 0u) != sampling::pixel_key(0, 0u, 0u));
}

TEST_CASE("mixing can be undone, so that different numbers stay different") {
  // The inverses of the factors modulo 2^64, by Newton's method, which doubles the correct digits.
  const auto inverse = [](std::uint64_t factor) {
    std::uint64_t x = factor;
    for (int i = 0; i < 6; ++i) x *= 2 - factor * x;
    return x;
  };
  const auto undo_shift = [](std::uint64_t z, int shift) {
    std::uint64_t x = z;
    for (int known = shift; known < 64; known += shift) x = z ^ x >> shift;
    return x;
  };
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t z = random.bits();
    std::uint64_t x = undo_shift(sampling::mix(z), 31) * inverse(0x94d049bb133111eb);
    x = undo_shift(x, 27) * inverse(0xbf58476d1ce4e5b9);
    CHECK(undo_shift(x, 30) == z);
  }
}

TEST_CASE("each digit of a nested scrambling depends on itself and on lower digits alone") {
  WrongCases wrong;
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const auto x = static_cast<std::uint32_t>(random.bits()),
               seed = static_cast<std::uint32_t>(random.bits());
    for (int digit = 0; digit < 32; ++digit) {
      const std::uint32_t one = std::uint32_t{1} << digit;
      const std::uint32_t changed = sampling::nested(x, seed) ^ sampling::nested(x ^ one, seed);
      // Lower digits do not change, and this one does.
      wrong.add((changed & (2 * one - 1)) != one, x, seed, digit);
      const std::uint32_t shuffled = sampling::shuffled(x, seed) ^ sampling::shuffled(x ^ one, seed);
      wrong.add((shuffled & (2 * one - 1)) != one, x, seed, digit);
    }
    wrong.add(sampling::shuffled(0u, seed) != 0, seed);
  }
  CHECK(wrong == 0);
}

TEST_CASE("all scramblings of three digits occur about as often as each other") {
  Random random(3);
  std::set<std::string> seen;
  CellCounts counts(128);
  for (int i = 0; i < 20000; ++i) {
    const auto seed = static_cast<std::uint32_t>(random.bits()),
               last = static_cast<std::uint32_t>(random.bits());
    // A coin for each node of the tree: for no digit before, for 0 and 1, and for 00, 10, 01 and 11.
    std::size_t coins = 0;
    for (std::uint32_t digits = 0; digits < 3; ++digits)
      for (std::uint32_t node = 0; node < 1u << digits; ++node)
        coins = 2 * coins + ((sampling::nested(node, seed) ^ last) >> digits & 1);
    counts.add(coins);
  }
  CHECK(counts.are_even());
}

TEST_CASE("a number takes all values alike over all keys") {
  // Over keys with one lower half: the higher half is a bijection of the number.
  Random random(3);
  const auto word = [&] { return static_cast<std::uint32_t>(random.bits()); };
  for (int i = 0; i < 20; ++i) {
    const std::uint32_t digits = word(), low = word(), start = word();
    std::set<std::uint32_t> seen;
    for (std::uint32_t high = start; high != start + 1000; ++high) {
      const auto number = [&](std::uint32_t h) {
        return sampling::scrambled(digits, low, h, sampling::factors[1], sampling::factors[5]);
      };
      seen.insert(number(high));
      const auto last = [&](std::uint32_t h) { return sampling::word_of(low, h, sampling::factors[5]); };
      CHECK((number(high) ^ last(high)) == (number(0) ^ last(0)));
    }
    CHECK(seen.size() == 1000);
  }
}

TEST_CASE("numbers are in the open interval, and lanes have the bits of single samplers") {
  const std::uint32_t corner[] = {0, 1, 2, 7, 1000, 0x7fffffff, 0x80000000, 0xffffffff};
  for_each_sampler([&]<class S>(const std::string& name, Kind<S>) {
    WrongCases wrong;
    Random random(4);
    for (int i = 0; i < 2000; ++i) {
      const auto any_word = [&] {
        const std::uint64_t bits = random.bits();
        return bits % 4 == 0 ? corner[bits / 4 % 8] : static_cast<std::uint32_t>(bits >> 32) >> bits / 4 % 32;
      };
      SampleIndices at{.seed = random.bits(), .sample = any_word(), .samples = any_word()};
      for (int lane = 0; lane < simd::double_lanes; ++lane)
        at.x.set(lane, any_word()), at.y.set(lane, any_word());
      const std::uint32_t set = any_word();
      const SampleSet<simd::Doubles> numbers = SamplerInLanes<S>(at)(set);
      for (int lane = 0; lane < simd::double_lanes; ++lane) {
        const SampleIndex one{at.seed, at.x[lane], at.y[lane], at.sample, at.samples};
        const SampleSet<double> expected = S(one)(set);
        for (std::size_t d = 0; d < 4; ++d) {
          wrong.add(!(0 < expected[d] && expected[d] < 1), name, one.sample, one.samples, expected[d]);
          wrong.add(numbers[d][lane] != expected[d], name, one.x, one.y, one.sample, one.samples, set, d);
        }
      }
    }
    CHECK(wrong == 0);
  });
}

TEST_CASE("a sampler of one's own is asked lane by lane") {
  SampleIndices at{.seed = 1, .sample = 2, .samples = 4};
  for (int lane = 0; lane < simd::double_lanes; ++lane) at.x.set(lane, static_cast<std::uint32_t>(5 + lane));
  const auto numbers = SamplerInLanes<OwnSampler>(at)(3);
  for (int lane = 0; lane < simd::double_lanes; ++lane) {
    CHECK(numbers[0][lane] == (5 + lane + 0.5) / 1e3);
    CHECK(numbers[1][lane] == 0.5 / 1e3);
    CHECK(numbers[2][lane] == 2.5 / 4);
    CHECK(numbers[3][lane] == 3.5 / 1e3);
  }
}

TEST_CASE("numbers are the same bits on every machine") {
  // Sums of the bits of many numbers, which were equal for g++ and clang, with AVX-512, AVX2, SSE2 and
  // without vectors.
  const std::array<std::pair<std::string, std::uint64_t>, 5> expected = {
      {{"independent", 0xd0f503251b8c493a},
       {"stratified", 0x8600ca5d56c84317},
       {"halton", 0x8a0de76e63e23226},
       {"sobol", 0xa3e6d4a0c079948f},
       {"hammersley", 0xf4ed5d06b64193a0}}};
  std::size_t next = 0;
  for_each_sampler([&]<class S>(const std::string& name, Kind<S>) {
    std::uint64_t sum = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
      const std::uint32_t sample = i * i * i * 7;
      const auto numbers = S(SampleIndex{
          .seed = i % 3, .x = i, .y = 7, .sample = sample, .samples = sample + 1 + i % 13})(i % 5);
      for (const double number : numbers) sum = sampling::mix(sum ^ std::bit_cast<std::uint64_t>(number));
    }
    INFO(name << " has the sum 0x" << std::hex << sum);
    CHECK(name == expected[next].first);
    CHECK(sum == expected[next].second);
    ++next;
  });
}

TEST_CASE("Sobol's points: each elementary box has as many as the net promises") {
  // A set of 2^k points is a (t, k, s)-net if each box of volume 2^(t − k), with sides that are powers of ½,
  // has 2^t of them. For coordinates whose polynomials have the degrees 1, 1, 2 and 3 (x, x + 1, …), t is the
  // sum of (degree − 1), for each choice of coordinates.
  const int quality[] = {0, 0, 1, 2};
  Random random(5);
  for (int round = 0; round < cases(6, 60); ++round) {
    const SampleIndex at{.seed = random.bits(), .x = static_cast<std::uint32_t>(round), .y = 3};
    const std::uint32_t scrambling = static_cast<std::uint32_t>(round) % scramblings;
    const auto all = points_of<SobolSampler>(at, scrambling, static_cast<std::uint32_t>(round % 4), 512);
    for (int k = 0; k <= 8; ++k)
      for (const std::uint32_t first : {0u, 256u}) {  // the first 2^k, and a later block
        const std::vector<SampleSet<double>> points(all.begin() + first, all.begin() + first + (1 << k));
        for (int a = 0; a <= k; ++a)
          for (int b = 0; a + b <= k; ++b)
            for (int c = 0; a + b + c <= k; ++c)
              for (int d = 0; a + b + c + d <= k; ++d) {
                const int sides[] = {a, b, c, d};
                int t = 0;
                for (int i = 0; i < 4; ++i) t += sides[i] > 0 ? quality[i] : 0;
                const int expected = k - a - b - c - d;
                if (expected < t) continue;
                const auto [least, most] = least_and_most(points, {std::size_t{1} << a, std::size_t{1} << b,
                                                                   std::size_t{1} << c, std::size_t{1} << d});
                CAPTURE(round, k, a, b, c, d);
                if (least != 1 << expected || most != 1 << expected) FAIL("not a net");
              }
      }
  }
}

TEST_CASE("Halton's points: boxes of each number of cells have as many points as each other, or one more") {
  Random random(6);
  for (int round = 0; round < cases(6, 60); ++round) {
    const SampleIndex at{.seed = random.bits(), .x = static_cast<std::uint32_t>(round), .y = 4};
    for (const std::uint32_t count : {1u, 2u, 8u, 64u, 256u, 512u}) {
      const auto points =
          points_of<HaltonSampler>(at, static_cast<std::uint32_t>(round) % scramblings, 2, count);
      for (const std::size_t twos : {1u, 2u, 8u, 64u})
        for (const std::size_t threes : {1u, 3u, 27u, 81u})
          for (const std::size_t fives : {1u, 5u, 25u})
            for (const std::size_t sevens : {1u, 7u, 49u}) {
              const std::size_t boxes = twos * threes * fives * sevens;
              if (boxes > 512) continue;
              const auto [least, most] = least_and_most(points, {twos, threes, fives, sevens});
              CAPTURE(round, count, twos, threes, fives, sevens);
              if (least != static_cast<int>(count / boxes) ||
                  most != static_cast<int>((count + boxes - 1) / boxes))
                FAIL("not evenly spread");
            }
    }
  }
}

TEST_CASE("stratified samples: at most one in each cell of either pair, and none left out if they divide") {
  for (const std::uint32_t samples : {1u, 2u, 3u, 4u, 7u, 16u, 32u, 61u, 100u, 128u, 144u}) {
    const sampling::Grid grid = sampling::grid_of(samples);
    CAPTURE(samples, grid.columns, grid.rows);
    CHECK(grid.columns * grid.rows >= samples);
    CHECK(grid.columns * (grid.rows - 1) < samples);
    if (std::has_single_bit(samples) || samples == 100 || samples == 144)
      CHECK(grid.columns * grid.rows == samples);
    for (std::uint32_t x = 0; x < 20; ++x)
      for (const std::uint32_t round : {0u, 1u}) {
        std::vector<SampleSet<double>> points;
        for (std::uint32_t i = 0; i < samples; ++i)
          points.push_back(
              StratifiedSampler(SampleIndex{.x = x, .sample = round * samples + i, .samples = samples})(1));
        CHECK(least_and_most(points, {grid.columns, grid.rows, 1, 1}).second == 1);
        CHECK(least_and_most(points, {1, 1, grid.columns, grid.rows}).second == 1);
      }
  }
  // Samples take the cells in different orders: pixels, sets, pairs and rounds.
  const auto order = [](std::uint32_t x, std::uint32_t set, std::uint32_t round, std::size_t pair) {
    std::string cells;
    for (std::uint32_t i = 0; i < 64; ++i) {
      const auto n = StratifiedSampler(SampleIndex{.x = x, .sample = 64 * round + i, .samples = 64})(set);
      cells += static_cast<char>(8 * part(n[2 * pair + 1], 8) + part(n[2 * pair], 8));
    }
    return cells;
  };
  const std::set<std::string> orders = {order(0, 0, 0, 0), order(1, 0, 0, 0), order(0, 1, 0, 0),
                                        order(0, 0, 1, 0), order(0, 0, 0, 1)};
  CHECK(orders.size() == 5);
}

TEST_CASE("a shuffled place is another one for each, and any of them for each") {
  for (const std::uint32_t count : {1u, 2u, 3u, 5u, 16u, 17u, 100u}) {
    CellCounts counts(std::max(count, 2u));
    for (std::uint32_t key = 0; key < 2000; ++key) {
      const std::uint64_t hash = sampling::mix(key + sampling::golden * count);
      std::set<std::uint32_t> places;
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto place = sampling::shuffled_place(i, count, simd::low_word(hash), simd::high_word(hash));
        CHECK(place < count);
        places.insert(place);
        if (i == count / 2) counts.add(place);
      }
      CHECK(places.size() == count);
    }
    if (count >= 16) CHECK(counts.are_even());
  }
}

TEST_CASE("Hammersley's points are the same in every pixel and for every seed") {
  for (int n = 1; n < 200; ++n) {
    // The numbers with their binary digits read backwards, in rows: those that are below n have ranks.
    std::vector<Uv> expected(static_cast<std::size_t>(n));
    int power = 1, rank = 0;
    while (power < n) power *= 2;
    for (int row = 0; row < power; ++row) {
      int i = 0;
      for (int from = 1, to = power / 2; from < power; from *= 2, to /= 2)
        if (row & from) i |= to;
      if (i < n) expected[static_cast<std::size_t>(i)] = {(i + 0.5) / n, (rank++ + 0.5) / n};
    }
    WrongCases wrong;
    for (std::uint32_t i = 0; i < expected.size(); ++i) {
      const SampleIndex at{
          .seed = i, .x = 3 * i, .y = i, .sample = i, .samples = static_cast<std::uint32_t>(n)};
      const auto numbers = HammersleySampler(at)(0);
      wrong.add(numbers[0] != expected[i].x || numbers[1] != expected[i].y, n, i);
    }
    CHECK(wrong == 0);
  }
  const auto at = [](std::uint32_t x) {
    return HammersleySampler(SampleIndex{.x = x, .sample = 3, .samples = 9});
  };
  CHECK(at(0)(0) == at(5)(0));
  CHECK(at(0)(1) == at(5)(1));
  CHECK(at(0)(1) != at(0)(2));
}

TEST_CASE("numbers of Sobol, Halton and independent samplers do not depend on how many samples there are") {
  const auto check = [](auto kind) {
    using S = typename decltype(kind)::type;
    for (std::uint32_t i = 0; i < 50; ++i)
      CHECK(S(SampleIndex{.x = i, .sample = i, .samples = 50})(i) ==
            S(SampleIndex{.x = i, .sample = i, .samples = 65536})(i));
  };
  check(Kind<IndependentSampler>());
  check(Kind<HaltonSampler>());
  check(Kind<SobolSampler>());
}

TEST_CASE("each number of a sample is uniform over pixels, and independent of all others") {
  for_each_random_sampler([]<class S>(const std::string& name, Kind<S>) {
    const std::uint32_t samples = 6;
    const auto sampler = [](std::uint32_t pixel, std::uint32_t sample, std::uint64_t seed = 11) {
      return S(
          SampleIndex{.seed = seed, .x = pixel % 64, .y = pixel / 64, .sample = sample, .samples = samples});
    };
    for (const std::uint32_t sample : {0u, 1u, 5u})
      for (const std::uint32_t set : {0u, 1u, 9u}) {
        if (sample + set > 0 && cases(1, 9) == 1 && !(sample == 5 && set == 9)) continue;
        for (std::size_t d = 0; d < 4; d += static_cast<std::size_t>(cases(3, 1))) {
          CAPTURE(name, sample, set, d);
          const auto number = [&](std::uint32_t pixel) { return sampler(pixel, sample)(set)[d]; };
          CellCounts high(64), low(64);
          for (std::uint32_t pixel = 0; pixel < 4096; ++pixel) {
            high.add(part(number(pixel), 64));
            low.add(part(std::fmod(number(pixel) * 0x1p20, 1), 64));  // later digits
          }
          CHECK(high.are_even());
          CHECK(low.are_even());
          for (std::size_t other = 0; other < 4; ++other) {
            // Another coordinate of the set, another set, a neighbor, another seed.
            if (other != d)
              CHECK(are_independent(number, [&](std::uint32_t p) { return sampler(p, sample)(set)[other]; }));
            CHECK(
                are_independent(number, [&](std::uint32_t p) { return sampler(p, sample)(set + 1)[other]; }));
            CHECK(
                are_independent(number, [&](std::uint32_t p) { return sampler(p + 1, sample)(set)[other]; }));
            CHECK(are_independent(number,
                                  [&](std::uint32_t p) { return sampler(p + 64, sample)(set)[other]; }));
            CHECK(
                are_independent(number, [&](std::uint32_t p) { return sampler(p, sample, 12)(set)[other]; }));
            // The next sample: of the other scrambling, for samplers that have two.
            if (name != "stratified")
              CHECK(are_independent(number,
                                    [&](std::uint32_t p) { return sampler(p, sample ^ 1)(set)[other]; }));
          }
        }
      }
  });
}
