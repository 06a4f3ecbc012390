#include <protostar/bvh/node.hpp>
#include <protostar/simd/lane_sets.hpp>
#include <protostar/simd/simd.hpp>
#include <protostar/simd/store_lanes.hpp>
#include <protostar/simd/vectors.hpp>
#include <protostar/vec3.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using simd::Bits;
using simd::Lanes;
using simd::Mask;

namespace {

/// Calls test(lanes) with a Lanes of each type and number that the library uses.
void for_each_kind(const auto& test) {
  test(Lanes<float, simd::float_lanes>(0.0f));
  test(Lanes<float, simd::double_lanes>(0.0f));
  test(Lanes<float, simd::node_width>(0.0f));
  test(Lanes<double, simd::double_lanes>(0.0));
}

template <class T, int N>
constexpr int count_of(const Lanes<T, N>&) {
  return N;
}

/// Returns true if two numbers have the same bits or are both NaN; an operation may return any NaN.
template <class T>
bool same(T a, T b) {
  using Whole = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  return std::bit_cast<Whole>(a) == std::bit_cast<Whole>(b) || (std::isnan(a) && std::isnan(b));
}

/// Returns numbers at the ends and in the middle of a type's range, infinities and NaN; then random bits and
/// random numbers.
template <class T>
std::vector<T> numbers() {
  using Limits = std::numeric_limits<T>;
  std::vector<T> all;
  for (const T x : {T{0}, T{1}, std::nextafter(T{1}, T{2}), T{1} / 3, T{1e10f}, Limits::denorm_min(),
                    Limits::min(), Limits::max(), Limits::infinity(), Limits::quiet_NaN()}) {
    all.push_back(x);
    all.push_back(-x);
  }
  Random random(1);
  for (int i = 0; i < 80; ++i) {
    const std::uint64_t bits = random.bits();
    T x;
    std::memcpy(&x, &bits, sizeof(x));
    all.push_back(x);
    all.push_back(static_cast<T>(random.real(-4, 4)));
  }
  return all;
}

/// Checks that f returns for lanes the same as for the numbers in them, for every two numbers. f returns
/// numbers or truth values.
template <class T, int N>
void check_each_pair(const Lanes<T, N>&, const auto& f) {
  const std::vector<T> all = numbers<T>();
  const std::size_t n = all.size();
  WrongCases wrong;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) {
      Lanes<T, N> a, b;
      for (int lane = 0; lane < N; ++lane) {
        a.set(lane, all[(i + static_cast<std::size_t>(lane)) % n]);
        b.set(lane, all[(i + k + 3 * static_cast<std::size_t>(lane)) % n]);
      }
      const auto answers = f(a, b);
      for (int lane = 0; lane < N; ++lane) {
        const auto expected = f(a[lane], b[lane]);
        if constexpr (std::is_same_v<decltype(answers), const Mask<T, N>>)
          wrong.add(((bits(answers) >> lane) & 1) != (expected ? 1U : 0U), a[lane], b[lane]);
        else
          wrong.add(!same(answers[lane], expected), a[lane], b[lane], answers[lane]);
      }
    }
  CHECK(wrong == 0);
}

struct Smaller {
  float operator()(float a, float b) const { return std::min(a, b); }
  double operator()(double a, double b) const { return std::min(a, b); }
  auto operator()(auto a, auto b) const { return min(a, b); }
};
struct Larger {
  float operator()(float a, float b) const { return std::max(a, b); }
  double operator()(double a, double b) const { return std::max(a, b); }
  auto operator()(auto a, auto b) const { return max(a, b); }
};

}  // namespace

TEST_CASE("lane arithmetic is rounded like that of single numbers") {
  for_each_kind([](const auto& kind) {
    check_each_pair(kind, [](auto a, auto b) { return a + b; });
    check_each_pair(kind, [](auto a, auto b) { return a - b; });
    check_each_pair(kind, [](auto a, auto b) { return a * b; });
    check_each_pair(kind, [](auto a, auto b) { return a / b; });
    check_each_pair(kind, [](auto a, auto) { return -a; });
    check_each_pair(kind, [](auto a, auto b) { return a += b; });
    check_each_pair(kind, [](auto a, auto b) { return a *= b; });
    check_each_pair(kind, [](auto a, auto) {
      using std::sqrt;
      return sqrt(a);
    });
  });
}

TEST_CASE("reciprocals of square roots are off by less than 2^-21 of themselves, in every lane") {
  const auto check = []<int n>(std::integral_constant<int, n>) {
    Random random(5);
    double largest = 0;
    for (int i = 0; i < 100000; ++i) {
      const auto a = Lanes<float, n>::of_each([&](int) {
        return static_cast<float>(std::exp2(i < 1000 ? random.real(-100, 100) : random.real(0, 2)));
      });
      const auto root = reciprocal_sqrt(a);
      for (int lane = 0; lane < n; ++lane)
        largest = std::max(largest, std::abs(root[lane] * std::sqrt(static_cast<double>(a[lane])) - 1));
    }
    CHECK(largest < 0x1p-21);
  };
  check(std::integral_constant<int, simd::float_lanes>());
  check(std::integral_constant<int, simd::double_lanes>());
}

TEST_CASE("copysign and abs work in every lane") {
  using std::abs, std::copysign;
  for_each_kind([](const auto& kind) {
    check_each_pair(kind, [](auto a, auto b) { return copysign(a, b); });
    check_each_pair(kind, [](auto a, auto) { return abs(a); });
  });
  Lanes<double, simd::double_lanes> a(std::nan("")), b(-0.0);
  CHECK(std::signbit(copysign(a, b)[0]));
  CHECK_FALSE(std::signbit(copysign(-a, -b)[0]));
}

TEST_CASE("numbers are compared in every lane, and every comparison with NaN is false") {
  for_each_kind([](const auto& kind) {
    check_each_pair(kind, [](auto a, auto b) { return a < b; });
    check_each_pair(kind, [](auto a, auto b) { return a <= b; });
    check_each_pair(kind, [](auto a, auto b) { return a == b; });
    check_each_pair(kind, [](auto a, auto b) { return a > b; });
    check_each_pair(kind, [](auto a, auto b) { return a >= b; });
  });
}

TEST_CASE("masks are negated and combined in every lane") {
  for_each_kind([](const auto& kind) {
    check_each_pair(kind, [](auto a, auto b) { return !(a < b); });
    check_each_pair(kind, [](auto a, auto b) { return a < b && b > 0; });
    check_each_pair(kind, [](auto a, auto b) { return a < b || b > 0; });
  });
}

TEST_CASE("select returns one number or the other unchanged") {
  for_each_kind(
      [](const auto& kind) { check_each_pair(kind, [](auto a, auto b) { return select(a < 1, b, a); }); });
}

TEST_CASE("min and max choose as std::min and std::max do") {
  for_each_kind([](const auto& kind) {
    check_each_pair(kind, Smaller{});
    check_each_pair(kind, Larger{});
  });
}

TEST_CASE("doubles are converted to the nearest floats in every lane") {
  using D = Lanes<double, simd::double_lanes>;
  std::vector<double> all = numbers<double>();
  for (const float x : numbers<float>()) all.push_back(static_cast<double>(x) * (1 + 0x1p-24));  // halfway
  for (const double x : all) {
    D a(1.0);
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      a.set(lane, x);
      CHECK(same(to_float(a)[lane], to_float(x)));
      CHECK(same(to_double(to_float(a))[lane], static_cast<double>(to_float(x))));
    }
  }
}

TEST_CASE(
    "whole numbers are converted to floats and to wider ones, and from floats without their fractions") {
  using Floats = Lanes<float, simd::float_lanes>;
  using Wholes = Lanes<std::int32_t, simd::float_lanes>;
  for (const float x : {0.0f, 0.99999994f, 1.0f, 63.5f, -0.5f, -7.75f, 8388607.5f, -2147483648.0f}) {
    const Floats a = Floats(x) + Floats(0.0f);
    const Wholes whole = to_whole(a), negative = to_whole(-a * Floats(0.5f));
    for (int lane = 0; lane < simd::float_lanes; ++lane) {
      CHECK(whole[lane] == static_cast<std::int32_t>(x));
      CHECK(negative[lane] == static_cast<std::int32_t>(-x * 0.5f));
      CHECK(to_float(whole)[lane] == static_cast<float>(static_cast<std::int32_t>(x)));
    }
    const auto wide = widened(Lanes<std::int32_t, simd::double_lanes>(whole[0]));
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      CHECK(wide[lane] == std::int64_t{whole[0]});
      CHECK(to_double(Lanes<std::int32_t, simd::double_lanes>(whole[0]))[lane] ==
            static_cast<double>(whole[0]));
    }
  }
}

TEST_CASE("a mask is the set of its lanes, for lanes of any type") {
  for_each_kind([]<class T, int N>(const Lanes<T, N>&) {
    const Bits all = simd::first_bits(N);
    CHECK(bits(Mask<T, N>(true)) == all);
    CHECK(bits(Mask<T, N>(false)) == 0);
    for (Bits lanes = 0; lanes <= std::min(all, Bits{0xfff}); ++lanes) {
      const Bits set = lanes | (lanes << 4 & all);
      const auto mask = simd::mask_of<T, N>(set);
      CHECK(bits(mask) == set);
      CHECK(bits(!mask) == (~set & all));
      CHECK(any(mask) == (set != 0));
    }
    CHECK(bits(simd::mask_of<T, N>(~Bits{0})) == all);
    CHECK_FALSE(any(simd::mask_of<T, N>(~all)));
  });
  for (Bits lanes = 0; lanes <= simd::first_bits(simd::double_lanes); ++lanes) {
    const auto mask = simd::mask_of<double, simd::double_lanes>(lanes);
    CHECK(bits(simd::mask_for<float>(mask)) == lanes);
    CHECK(bits(simd::mask_for<std::int64_t>(mask)) == lanes);
    CHECK(bits(simd::mask_for<double>(simd::mask_for<float>(mask))) == lanes);
    const auto chosen = select(mask, Lanes<float, simd::double_lanes>(1.0f), -2.0f);
    for (int lane = 0; lane < simd::double_lanes; ++lane) CHECK(chosen[lane] == (lanes >> lane & 1 ? 1 : -2));
  }
}

TEST_CASE("whole numbers are selected and compared in every lane") {
  using Whole = Lanes<std::int64_t, simd::double_lanes>;
  const std::int64_t numbers[] = {-1, 0, 1, 7, std::int64_t{1} << 40, (std::int64_t{1} << 40) + 1};
  for (const std::int64_t a : numbers)
    for (const std::int64_t b : numbers)
      for (int lane = 0; lane < simd::double_lanes; ++lane) {
        const auto only = simd::mask_of<double, simd::double_lanes>(Bits{1} << lane);
        const Whole some = select(only, Whole(a), Whole(b));
        for (int i = 0; i < simd::double_lanes; ++i) CHECK(some[i] == (i == lane ? a : b));
        CHECK(bits(some == Whole(b)) == (a == b ? bits(only || !only) : bits(!only)));
        CHECK(bits(some < Whole(b)) == (a < b ? bits(only) : 0));
      }
}

TEST_CASE("whole numbers as wide as floats are compared in every lane, negative ones as well") {
  const auto compare = [](auto lanes) {
    using Whole = decltype(lanes);
    const Bits all = bits(Whole(1) == Whole(1));
    CHECK(all == simd::first_bits(static_cast<int>(sizeof(Whole) / sizeof(std::int32_t))));
    for (const std::int32_t a : {-7, -5, -1, 0, 1, 5, 1 << 30, -(1 << 30)})
      for (const std::int32_t b : {-7, -5, -1, 0, 1, 5, 1 << 30, -(1 << 30)}) {
        CHECK(bits(Whole(a) < Whole(b)) == (a < b ? all : 0));
        CHECK(bits(Whole(a) <= Whole(b)) == (a <= b ? all : 0));
        CHECK(bits(Whole(a) == Whole(b)) == (a == b ? all : 0));
      }
  };
  compare(Lanes<std::int32_t, simd::float_lanes>());
  compare(Lanes<std::int32_t, simd::double_lanes>());
  compare(Lanes<std::int32_t, 4>());
}

TEST_CASE("first_bits sets the lowest bits, up to all") {
  CHECK(simd::first_bits(0) == 0);
  CHECK(simd::first_bits(1) == 1);
  CHECK(simd::first_bits(5) == 31);
  CHECK(simd::first_bits(31) == 0x7fffffff);
  static_assert(simd::first_bits(32) == 0xffffffff);
  static_assert(simd::first_bits(100) == 0xffffffff);  // a tile may have more pixels left than there are bits
}

TEST_CASE("the lanes in a set are visited in order, even if the loop changes the set") {
  for (Bits set : {Bits{0}, Bits{1}, Bits{0b101100}, Bits{0x80000000}, ~Bits{0}}) {
    const Bits all = set;
    Bits visited = 0;
    int last = -1;
    for (const int lane : simd::lanes_in(set)) {
      CHECK(lane > last);
      last = lane;
      visited |= Bits{1} << lane;
      set = 0;
    }
    CHECK(visited == all);
  }
  for_each_kind([]<class T, int N>(const Lanes<T, N>&) {
    for (Bits set = 0; set <= std::min(simd::first_bits(N), Bits{0xfff}); ++set) {
      Bits visited = 0;
      for (const int lane : lanes_in(simd::mask_of<T, N>(set))) visited |= Bits{1} << lane;
      CHECK(visited == set);
    }
  });
}

TEST_CASE("groups have each number in some lanes once, with all of these lanes that hold it") {
  constexpr int n = simd::double_lanes;
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    const auto number = [](int lane, std::uint64_t bits) {
      return static_cast<std::int64_t>(bits >> 2 * lane & 3) - 2;
    };
    const std::uint64_t of_lanes = random.bits();
    const auto some = static_cast<Bits>(random.bits()) & simd::first_bits(n);
    const auto numbers = simd::Indices::of_each([&](int lane) { return number(lane, of_lanes); });
    auto remaining = simd::mask_of<double, n>(some);
    while (any(remaining)) {
      const Bits before = bits(remaining);
      const simd::Group group = take_group(numbers, remaining);
      Bits right = 0;
      for (const int lane : simd::lanes_in(some))
        right |= Bits{number(lane, of_lanes) == group.number} << lane;
      CHECK(bits(group.lanes) == right);
      CHECK((right & before & (~before + 1)) != 0);
      CHECK(bits(remaining) == (before & ~right));
    }
  }
}

TEST_CASE("lanes are loaded and stored in order, from any address") {
  for_each_kind([]<class T, int N>(const Lanes<T, N>&) {
    T from[N + 1], to[N + 2];
    for (int i = 0; i <= N; ++i) from[i] = static_cast<T>(10 + i);
    std::fill(std::begin(to), std::end(to), T{-1});
    const auto lanes = Lanes<T, N>::load(from + 1);
    lanes.store(to + 1);
    for (int i = 0; i < N; ++i) {
      CHECK(lanes[i] == from[i + 1]);
      CHECK(to[i + 1] == from[i + 1]);
      CHECK(simd::iota<T, N>()[i] == static_cast<T>(i));
    }
    CHECK(to[0] == -1);
    CHECK(to[N + 1] == -1);
  });
}

TEST_CASE("the chosen lanes are stored side by side, in order") {
  const auto check = []<class T, int N>(const Lanes<T, N>&) {
    for (Bits round = 0; round < Bits{1} << std::min(N, 12); ++round) {
      // Because the factor is odd, these are all subsets of up to 12 lanes.
      const Bits chosen = round * 2654435761U & simd::first_bits(N);
      std::vector<T> to(2 * N + 1, T{-1}), expected{T{-1}};
      for (int i = 0; i < N; ++i)
        if (chosen >> i & 1) expected.push_back(static_cast<T>(i));
      const int count = simd::store_chosen(to.data() + 1, chosen, simd::iota<T, N>());
      CHECK(count == std::popcount(chosen));
      CHECK(std::equal(expected.begin(), expected.end(), to.begin()));
      CHECK(std::all_of(to.begin() + 1 + N, to.end(), [](T x) { return x == T{-1}; }));
    }
  };
  for_each_kind(check);
  check(Lanes<std::int32_t, simd::float_lanes>(0));
}

TEST_CASE("largest and smallest find the extreme number in any lane") {
  for_each_kind([]<class T, int N>(const Lanes<T, N>&) {
    for (int i = 0; i < N; ++i) {
      Lanes<T, N> a(T{-3});
      a.set(i, T{-2});
      CHECK(largest(a) == T{-2});
      a.set((i + 1) % N, std::numeric_limits<T>::infinity());
      CHECK(largest(a) == std::numeric_limits<T>::infinity());
      CHECK(smallest(-a) == -std::numeric_limits<T>::infinity());
    }
  });
  for (int i = 0; i < simd::double_lanes; ++i) {
    Lanes<std::int32_t, simd::double_lanes> a = 7;
    a.set(i, -5);
    CHECK(smallest(a) == -5);
  }
}

TEST_CASE("bits of whole numbers are shifted and combined in every lane") {
  constexpr int N = simd::double_lanes;
  const auto number = [](int i) { return std::int64_t{0x1234567} + i; };
  const auto a = Lanes<std::int64_t, N>::of_each(number), by = simd::iota<std::int64_t, N>() * 5,
             moved = a << by, joined = a | by;
  for (int i = 0; i < N; ++i) {
    CHECK(moved[i] == number(i) << 5 * i);
    CHECK(joined[i] == (number(i) | 5 * i));
  }
}
