// Real roots in [−1, 1] of polynomials up to degree 4, whose coefficients are enclosed.
//
// Written in Bernstein's basis over an interval, a polynomial lies between its least and its largest
// coefficient, and has at most as many roots as the coefficients change their sign, and that many less an
// even number (Descartes). Intervals are divided (de Casteljau) until no sign changes, or one does, so that
// there is one root, which Newton's method on intervals narrows. The signs of enclosed coefficients are
// certain or unknown. Signs that stay unknown in double are computed again in double-double.
#pragma once

#include <algorithm>

#include "enclosure.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Polynomial Σ c[k] x^k, for k from 0 to its degree, which is from 1 to 4. The coefficients are enclosed.
template <class B>
struct EnclosedPolynomial {
  int degree = 4;
  Enclosure<B> c[5];

  /// Returns the values over an interval.
  [[nodiscard]] Enclosure<B> value(const Enclosure<B>& x) const {
    Enclosure<B> sum = c[degree];
    for (int k = degree - 1; k >= 0; --k) sum = sum * x + c[k];
    return sum;
  }

  /// Returns the derivatives over an interval.
  [[nodiscard]] Enclosure<B> slope(const Enclosure<B>& x) const {
    Enclosure<B> sum = c[degree] * static_cast<double>(degree);
    for (int k = degree - 1; k >= 1; --k) sum = sum * x + c[k] * static_cast<double>(k);
    return sum;
  }
};

/// Roots in ascending order, each enclosed, of which there are `count`. An interval for which the digits do
/// not tell the number of its roots, as at a touch, stands for two roots if the polynomial has the same sign
/// at both of its ends, and otherwise for one; `are_certain` is then false.
template <class B>
struct EnclosedRoots {
  int count = 0;
  Enclosure<B> root[4];
  bool are_certain = true;  ///< true if there are these roots and no others

  /// Adds a root behind the others; a fifth is dropped.
  void add(const Enclosure<B>& x) {
    if (count < 4) root[count++] = x;
  }
};

namespace detail {

/// Returns 1 or -1 if all numbers of an interval have that sign, otherwise 0.
template <class B>
[[nodiscard]] int certain_sign(const Enclosure<B>& x) {
  return B(0.0) < x.lower ? 1 : x.upper < B(0.0) ? -1 : 0;
}

/// Search for the roots of a polynomial.
template <class B>
class RootSearch {
 public:
  explicit RootSearch(const EnclosedPolynomial<B>& f) : f_(f), n_(f.degree) {}

  [[nodiscard]] EnclosedRoots<B> roots() {
    const Coefficients b = over_all();
    if (certain_sign(b.at[0]) == 0 || certain_sign(b.at[n_]) == 0)
      found_.are_certain = false;
    else
      search(b, B(-1.0), B(1.0), 0);
    return found_;
  }

 private:
  /// Coefficients in Bernstein's basis.
  struct Coefficients {
    Enclosure<B> at[5];
  };

  /// Largest number of bits after the point of the ends of intervals. Ends of at most 1 in magnitude are
  /// exact with 50 bits in double and with 98 in double-double.
  static constexpr int most_bits = sizeof(B) == sizeof(double) ? 50 : 98;

  /// Returns the coefficients over [−1, 1]. With x = 2y − 1 the polynomial is Σ a_k y^k, a_k = 2^k f^(k)(−1)
  /// / k!, and its i-th coefficient is the sum of C(i, k) / C(n, k) a_k.
  [[nodiscard]] Coefficients over_all() const {
    static constexpr double choose[5][5] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}};
    Coefficients a, b;
    for (int k = 0; k <= n_; ++k) a.at[k] = f_.c[k];
    for (int k = 0; k < n_; ++k)
      for (int i = n_ - 1; i >= k; --i) a.at[i] = a.at[i] - a.at[i + 1];
    for (int k = 1; k <= n_; ++k) a.at[k] = a.at[k] * static_cast<double>(1 << k);
    for (int i = 0; i <= n_; ++i)
      for (int k = 0; k <= i; ++k) b.at[i] = b.at[i] + a.at[k] * choose[i][k] / Enclosure<B>(choose[n_][k]);
    return b;
  }

  /// Divides [0, 1] at a share of it: returns the coefficients of the first part, and b becomes those of the
  /// second.
  [[nodiscard]] Coefficients divide(Coefficients& b, double share) const {
    Coefficients first;
    for (int i = 0; i <= n_; ++i) {
      first.at[i] = b.at[0];
      for (int k = 0; k < n_ - i; ++k) b.at[k] = b.at[k] * (1 - share) + b.at[k + 1] * share;
    }
    return first;
  }

  /// Tests whether no sign is unknown but one between two that are known and different, and counts the
  /// changes of sign; -1 if the test fails. An unknown sign there changes nothing: it is one or the other.
  [[nodiscard]] int sign_changes(const Coefficients& b) const {
    int changes = 0, last = certain_sign(b.at[0]);
    for (int i = 1; i <= n_; ++i) {
      const int sign = certain_sign(b.at[i]);
      if (sign == 0 && !(i < n_ && certain_sign(b.at[i + 1]) == -last)) return -1;
      if (sign == -last) ++changes;
      if (sign != 0) last = sign;
    }
    return changes;
  }

  /// Adds the roots between `low` and `high`, where the polynomial is surely not 0. If its sign is unknown in
  /// the middle, the interval is divided elsewhere; if it is there too, or the ends have no more digits, the
  /// polynomial is nearer to 0 than digits tell.
  void search(const Coefficients& b, const B& low, const B& high, int bits) {
    const int changes = sign_changes(b);
    if (changes == 0) return;
    if (changes == 1) return found_.add(narrowed({low, high}, certain_sign(b.at[0])));
    struct {
      double share;
      int bits;
    } static constexpr places[] = {{0.5, 1}, {0.375, 3}, {0.625, 3}};
    for (const auto& [share, more] : places) {
      if (bits + more > most_bits) break;
      Coefficients second = b;
      const Coefficients first = divide(second, share);
      if (certain_sign(second.at[0]) == 0) continue;
      const B middle = low + B(share) * (high - low);
      search(first, low, middle, bits + more);
      return search(second, middle, high, bits + more);
    }
    found_.are_certain = false;
    found_.add({low, high});
    if (certain_sign(b.at[0]) == certain_sign(b.at[n_])) found_.add({low, high});
  }

  /// Narrows an interval around one root, before which the polynomial has a sign, as far as digits allow: to
  /// m − f(m)/F' for its middle m and the slopes F' over it, if these are not 0, and otherwise by halves.
  /// Each turn leaves ¾ of the width or less, or is the last: 200 of them 2^-82 of the interval, if Newton's
  /// method never helps.
  [[nodiscard]] Enclosure<B> narrowed(Enclosure<B> x, int sign_before) const {
    const auto width = [&] { return static_cast<double>(x.upper - x.lower); };
    for (int i = 0; i < 200; ++i) {
      const double before = width();
      for (const double share : {0.5, 0.25, 0.75}) {
        const B middle = x.lower + B(share) * (x.upper - x.lower);
        if (!(x.lower < middle && middle < x.upper)) return x;
        const Enclosure<B> at = Enclosure<B>::at(middle), value = f_.value(at), slope = f_.slope(x);
        if (const int sign = certain_sign(value); sign != 0)
          (sign == sign_before ? x.lower : x.upper) = middle;
        if (certain_sign(slope) != 0) x = common(x, at - value / slope);
        if (width() <= 0.75 * before) break;
      }
      if (!(width() <= 0.75 * before)) return x;
    }
    return x;
  }

  const EnclosedPolynomial<B>& f_;
  int n_;
  EnclosedRoots<B> found_;
};

}  // namespace detail

/// Returns the real roots in (−1, 1), each in an interval as narrow as the digits of B allow. If the sign of
/// the polynomial at −1 or at 1 is unknown, it returns no roots and `are_certain` = false.
template <class B>
[[nodiscard]] EnclosedRoots<B> roots_in_unit_interval(const EnclosedPolynomial<B>& f) {
  return detail::RootSearch<B>(f).roots();
}

}  // namespace protostar::inline PROTOSTAR_ABI
