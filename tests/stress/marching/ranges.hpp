// Intervals that judge marches, with numbers T: double, long double, or Quad with 113 bits. Nothing here
// comes from the library, whose own enclosures are what a march is made of.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include "../exact.hpp"

namespace ranges {

using exact::Quad;

/// Exceeds the relative error of one operation: half a unit of the last place, and in Quad 2^-113, or 2^-106
/// of a root.
template <class T>
inline constexpr T share = std::numeric_limits<T>::epsilon();
template <>
inline constexpr Quad share<Quad> = 0x1p-104;

/// Bounds of the errors of sine and cosine. Those of the C library are guesses: half a unit of the last place
/// is 2^-54 in double, and no library is known whose sine is off by as much as 2^-50. The one of Quad: an
/// angle below 100 less a multiple of π/2 is off by 2^-105, and the series (sine) by less than 2^-105.
template <class T>
inline constexpr T sine_error = 4 * share<T>;
template <>
inline constexpr Quad sine_error<Quad> = 0x1p-100;

inline Quad size_of(Quad x) { return x < 0 ? -x : x; }

template <std::floating_point T>
T below(T x) {
  return x - std::abs(x) * share<T>;
}
template <std::floating_point T>
T above(T x) {
  return x + std::abs(x) * share<T>;
}

/// Moves a number outward or inward by 2^9 units of its last place, which are at least its `share`.
inline Quad moved(Quad x, bool away_from_0) {
  if (x == 0) return x;
  __extension__ using Bits = unsigned __int128;
  const auto bits = std::bit_cast<Bits>(x);
  return std::bit_cast<Quad>(away_from_0 ? bits + 512 : bits - 512);
}
inline Quad below(Quad x) { return moved(x, x < 0); }
inline Quad above(Quad x) { return moved(x, x > 0); }

template <std::floating_point T>
T floor_of(T x) {
  return std::floor(x);
}
inline Quad floor_of(Quad x) {
  const auto whole = static_cast<Quad>(static_cast<long long>(x));
  return whole > x ? whole - 1 : whole;
}

/// Returns the root of a number that is not negative; 0 for one below 2^-900.
template <std::floating_point T>
T root_of(T x) {
  return std::sqrt(x);
}
inline Quad root_of(Quad x) {
  if (x < Quad(0x1p-900)) return 0;
  Quad root = std::sqrt(static_cast<double>(x));
  for (int step = 0; step < 2; ++step) root = (root + x / root) / 2;
  return root;
}

template <std::floating_point T>
T half_pi_of(T) {
  return std::numbers::pi_v<T> / 2;
}
inline Quad half_pi_of(Quad) {
  return Quad(0x1.921fb54442d18p+0) + (Quad(0x1.1a62633145c07p-54) - Quad(0x1.f1976b7ed8fbcp-110));
}

/// Returns the sine of x + quarter · π/2.
template <std::floating_point T>
T sine(T x, int quarter) {
  return quarter == 0 ? std::sin(x) : std::cos(x);
}
inline Quad sine(Quad x, int quarter) {
  static const auto reciprocals = [] {
    std::array<Quad, 18> of_products{};
    for (std::size_t k = 2; k < 18; ++k) of_products[k] = Quad(1) / static_cast<Quad>(k * (k - 1));
    return of_products;
  }();
  const Quad turns = floor_of(x / half_pi_of(x) + Quad(0.5)), r = x - turns * half_pi_of(x), s = r * r;
  const auto turn = static_cast<unsigned>((static_cast<long long>(turns) + quarter) & 3);
  // Terms up to r^29/29!: with |r| < 0.8 the rest is below 2^-114. Terms from r^17/17! < 2^-53 are summed in
  // double, whose roundings are below 2^-105 of the sum.
  const int even = turn % 2;
  double small = 1;
  for (int k = 29 - even; k > 17; k -= 2) small = 1 - small * static_cast<double>(s) / (k * (k - 1));
  Quad sum = small;
  for (int k = 17 - even; k > 1; k -= 2) sum = 1 - sum * s * reciprocals[static_cast<std::size_t>(k)];
  const Quad value = even == 1 ? sum : r * sum;
  return turn >= 2 ? -value : value;
}

/// Interval [lo, hi].
template <class T>
struct Range {
  T lo, hi;

  Range(T number = 0) : lo(number), hi(number) {}
  Range(T least, T most) : lo(least), hi(most) {}

  /// Returns the interval of another number type, outward.
  template <class U>
  static Range from(const Range<U>& other) {
    return {below(static_cast<T>(other.lo)), above(static_cast<T>(other.hi))};
  }

  [[nodiscard]] bool is_zero() const { return lo == 0 && hi == 0; }

  friend Range operator-(const Range& a) { return {-a.hi, -a.lo}; }
  friend Range operator+(const Range& a, const Range& b) {
    return {below(T(a.lo + b.lo)), above(T(a.hi + b.hi))};
  }
  friend Range operator-(const Range& a, const Range& b) { return a + -b; }
  friend Range operator*(const Range& a, const Range& b) {
    if (a.is_zero() || b.is_zero()) return {};
    const T p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    const T least = std::min(std::min(p, q), std::min(r, s)), most = std::max(std::max(p, q), std::max(r, s));
    const T underflow(0x1p-1020);
    return {T(below(least) - underflow), T(above(most) + underflow)};
  }
};

template <class T>
Range<T> hull(const Range<T>& a, const Range<T>& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
template <class T>
Range<T> min(const Range<T>& a, const Range<T>& b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}
template <class T>
Range<T> max(const Range<T>& a, const Range<T>& b) {
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}
template <class T>
Range<T> square(const Range<T>& a) {
  const Range<T> product = a * a;
  const T least = a.lo > 0 || a.hi < 0 ? std::min(T(a.lo * a.lo), T(a.hi * a.hi)) : T(0);
  return {std::max(below(least), T(0)), std::max(product.hi, T(0))};
}
/// Returns the root; the square is known not to be negative.
template <class T>
Range<T> root(const Range<T>& a) {
  const T least = root_of(std::max(a.lo, T(0))), most = root_of(std::max(a.hi, T(0)));
  return {below(least), T(above(most) + (a.hi > 0 ? T(0x1p-440) : T(0)))};
}
/// Returns the sine of x + quarter · π/2 over an interval. It has a peak 1 where x + (quarter − 1) π/2 is a
/// multiple of 2π, and one of −1 half a turn from there; one that is nearly inside counts.
template <class T>
Range<T> sine(const Range<T>& a, int quarter) {
  const T turn = 4 * half_pi_of(a.lo), slack(0x1p-40);
  const auto meets = [&](double share_of_turn) {
    const T shift = T(0.25 * quarter - share_of_turn);
    return floor_of(T(a.hi / turn + shift + slack)) >= a.lo / turn + shift - slack;
  };
  const T first = sine(a.lo, quarter), last = a.hi == a.lo ? first : sine(a.hi, quarter);
  const T error = sine_error<T>;
  return {meets(0.75) ? T(-1) : T(std::min(first, last) - error),
          meets(0.25) ? T(1) : T(std::max(first, last) + error)};
}

/// Function of one number over an interval: its values, and its slopes, at kinks all between those of both
/// sides.
template <class T>
struct Along {
  Range<T> v, s;

  Along(double number = 0) : v(T(number)) {}
  Along(const Range<T>& values, const Range<T>& slopes) : v(values), s(slopes) {}

  friend Along operator-(const Along& a) { return {-a.v, -a.s}; }
  friend Along operator+(const Along& a, const Along& b) { return {a.v + b.v, a.s + b.s}; }
  friend Along operator-(const Along& a, const Along& b) { return {a.v - b.v, a.s - b.s}; }
  friend Along operator*(const Along& a, const Along& b) { return {a.v * b.v, a.s * b.v + a.v * b.s}; }

  friend Along square(const Along& a) { return {square(a.v), Range<T>(T(2)) * a.v * a.s}; }
  friend Along min(const Along& a, const Along& b) {
    return a.v.hi < b.v.lo ? a : b.v.hi < a.v.lo ? b : Along{min(a.v, b.v), hull(a.s, b.s)};
  }
  friend Along max(const Along& a, const Along& b) { return -min(-a, -b); }
  friend Along abs(const Along& a) { return max(a, -a); }

  /// Returns the length of a vector, whose slope is e · v' for the unit vector e along it.
  template <class... Others>
  friend Along length(const Along& first, const Others&... others) {
    const Along parts[]{first, others...};
    Range<T> squares;
    for (const Along& part : parts) squares = squares + square(part.v);
    Along result{root(squares), {}};
    for (const Along& part : parts) {
      Range<T> e{T(part.v.lo < 0 ? -1 : 0), T(part.v.hi > 0 ? 1 : 0)};
      if (result.v.lo > 0) {
        const auto quotient = [&](T x, T by) { return T(x / by); };
        e.lo = std::max(e.lo, below(quotient(part.v.lo, part.v.lo < 0 ? result.v.lo : result.v.hi)));
        e.hi = std::min(e.hi, above(quotient(part.v.hi, part.v.hi > 0 ? result.v.lo : result.v.hi)));
      }
      result.s = result.s + e * part.s;
    }
    return result;
  }

  /// Returns the signed distance from the points without a positive coordinate. Where two coordinates are
  /// below 0 and below the third, it is the third, on both sides of 0.
  friend Along signed_length(const Along& x, const Along& y, const Along& z) {
    const auto decides = [](const Along& a, const Along& b, const Along& c) {
      return std::max(b.v.hi, c.v.hi) < std::min(T(0), a.v.lo);
    };
    if (decides(x, y, z)) return x;
    if (decides(y, z, x)) return y;
    if (decides(z, x, y)) return z;
    const Along outside = length(max(x, Along()), max(y, Along()), max(z, Along()));
    const Along inside = max(x, max(y, z));
    if (inside.v.lo > 0) return outside;
    if (inside.v.hi < 0) return inside;
    return {outside.v + min(inside.v, Range<T>()), hull(outside.s, inside.s)};
  }

  friend Along sine(const Along& a, int quarter) {
    // The derivative of the cosine, quarter 1, is −sin.
    const Range<T> slope = quarter == 0 ? sine(a.v, 1) : -sine(a.v, 0);
    return {sine(a.v, quarter), slope * a.s};
  }

  /// Returns the distance to the nearest even number.
  friend Along fold(const Along& a) {
    const T first = floor_of(a.v.lo), last = floor_of(a.v.hi);
    const auto is_even = [](T whole) { return floor_of(T(whole / 2)) * 2 == whole; };
    const auto at = [&](T x, T whole) { return is_even(whole) ? T(x - whole) : T(whole + 1 - x); };
    if (first == last) return is_even(first) ? a - Along{{first}, {}} : Along{{T(first + 1)}, {}} - a;
    const T low = at(a.v.lo, first), high = at(a.v.hi, last);
    // Each whole number after the first is met, even ones and odd ones by turns.
    const bool both = last > first + 1, meets_even = both || is_even(last),
               meets_odd = both || !is_even(last);
    return {{meets_even ? T(0) : below(std::min(low, high)), meets_odd ? T(1) : above(std::max(low, high))},
            hull(a.s, -a.s)};
  }

  /// Returns min(a, b) − max(k − |a − b|, 0)²/4k, which grows with a and with b. With w = ½ + (b − a)/2k from
  /// 0 to 1 its slope is w a' + (1 − w) b'.
  friend Along smooth_min(const Along& a, const Along& b, double k) {
    const Range<T> width{T(k)}, quarter{below(T(1 / (T(4) * T(k)))), above(T(1 / (T(4) * T(k))))};
    const auto value = [&](T x, T y) {
      const Range<T> p(x), q(y), apart = max(p - q, q - p);
      return min(p, q) - square(max(width - apart, Range<T>())) * quarter;
    };
    const Range<T> w = (b.v - a.v) * quarter * Range<T>(T(2)) + Range<T>(T(0.5));
    const Range<T> weight{std::clamp(w.lo, T(0), T(1)), std::clamp(w.hi, T(0), T(1))};
    const Range<T> mixed = b.s + weight * (a.s - b.s), all = hull(a.s, b.s);
    return {{value(a.v.lo, b.v.lo).lo, value(a.v.hi, b.v.hi).hi},
            {std::max(mixed.lo, all.lo), std::min(mixed.hi, all.hi)}};
  }
};

}  // namespace ranges
