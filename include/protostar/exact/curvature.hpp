// Bounds of the second derivatives of a field over a box, also where its gradient jumps.
//
// Second derivatives of f along lines are in [c⁻, c⁺] if along each line p + s d with |d| = 1 the function
// f − c⁻ s²/2 is convex, and f − c⁺ s²/2 is concave. Both follow from what holds at each point alone. A point
// p is supported by a gradient g and a symmetric matrix H, which may depend on the direction of h, if
//   f(p + h) ≥ f(p) + g·h + ½ h·H h − o(|h|²)   for small vectors h.
// Where all points of a line are supported with d·H d ≥ c, φ = f − c s²/2 is convex along it. Otherwise φ + ε
// s² would not be convex either for a small ε > 0: it would have a largest distance above one of its chords
// at a point s between the ends, where φ(s + h) + ε (s + h)² is at most a line in h. But by the support it is
// at least a line and ε h² − o(h²), for h and −h, so that ε ≤ 0. Upper bounds are the lower ones of −f.
//
// A Curvature says that each point of a box is supported by some H = B + R, from below and from above, where
// the components of B are in `parts` and the eigenvalues of R in `rest`. Infinite ends of `rest` mean that
// there may be no support: none from above where two branches of a maximum meet, none from below for a
// minimum. Gradients of supports are generalized gradients (slope.hpp). Supports of sums add up. A product
// with a factor above 0 takes the support of its side, one with a factor below 0 the other: these are the
// ends of products of intervals. There 0 times infinity is 0, since a factor of 0 leaves only products of
// gradients.
#pragma once

#include <algorithm>
#include <cmath>

#include "enclosure.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Bounds of the second derivatives of a function on a box. Constructs those of a linear function, which are
/// 0.
class Curvature {
 public:
  using Values = Enclosure<double>;

  /// Returns bounds that say nothing.
  [[nodiscard]] static Curvature unknown() {
    Curvature all;
    all.rest_ = Values::whole();
    return all;
  }

  /// Returns the symmetric matrix a bᵀ + b aᵀ.
  [[nodiscard]] static Curvature of_product(const Values (&a)[3], const Values (&b)[3]) {
    Curvature c;
    for (int i = 0; i < 3; ++i)
      for (int k = i; k < 3; ++k) c.part(i, k) = a[i] * b[k] + b[i] * a[k];
    return c;
  }

  /// Returns the matrix a aᵀ.
  [[nodiscard]] static Curvature of_square(const Values (&a)[3]) {
    Curvature c;
    for (int i = 0; i < 3; ++i)
      for (int k = i; k < 3; ++k) c.part(i, k) = i == k ? square(a[i]) : a[i] * a[k];
    return c;
  }

  friend Curvature operator-(const Curvature& a) {
    Curvature c;
    for (int i = 0; i < 6; ++i) c.parts_[i] = -a.parts_[i];
    c.rest_ = -a.rest_;
    return c;
  }
  friend Curvature operator+(const Curvature& a, const Curvature& b) {
    Curvature c;
    for (int i = 0; i < 6; ++i) c.parts_[i] = a.parts_[i] + b.parts_[i];
    c.rest_ = a.rest_ + b.rest_;
    return c;
  }
  friend Curvature operator-(const Curvature& a, const Curvature& b) { return a + -b; }

  /// Returns the bounds for a function times a factor, for all factors in an interval.
  friend Curvature operator*(const Values& factor, const Curvature& a) {
    Curvature c;
    for (int i = 0; i < 6; ++i) c.parts_[i] = factor * a.parts_[i];
    const Values& r = a.rest_;
    c.rest_ = {std::min({least(factor.lower, r.lower), least(factor.lower, r.upper),
                         least(factor.upper, r.lower), least(factor.upper, r.upper)}),
               std::max({most(factor.lower, r.lower), most(factor.lower, r.upper),
                         most(factor.upper, r.lower), most(factor.upper, r.upper)})};
    return c;
  }

  /// Returns the bounds for a function that is one of two at each point.
  [[nodiscard]] static Curvature either(const Curvature& a, const Curvature& b) {
    Curvature c;
    for (int i = 0; i < 6; ++i) c.parts_[i] = hull(a.parts_[i], b.parts_[i]);
    c.rest_ = hull(a.rest_, b.rest_);
    return c;
  }

  /// Returns the bounds for eigenvalues of R that may be lower by `lower` ≥ 0 as well, and higher by
  /// `higher` ≥ 0.
  [[nodiscard]] Curvature widened(double lower, double higher) const {
    Curvature c = *this;
    c.rest_ = {below(rest_.lower - lower), above(rest_.upper + higher)};
    return c;
  }

  /// Returns an interval that contains all second derivatives along unit vectors: by Gershgorin's theorem an
  /// eigenvalue of B is at most the magnitudes of the others in a row away from the number on the diagonal.
  [[nodiscard]] Values range() const {
    Values all(infinity, -infinity);
    for (int i = 0; i < 3; ++i) {
      Values others(0.0);
      for (int k = 0; k < 3; ++k)
        if (k != i) others = others + Values{-part(i, k).magnitude(), part(i, k).magnitude()};
      all = hull(all, part(i, i) + others);
    }
    return all + rest_;
  }

 private:
  /// Returns the index of a component of a symmetric matrix: xx, yy, zz, yz, zx, xy.
  static int index(int i, int k) { return i == k ? i : 6 - i - k; }
  Values& part(int i, int k) { return parts_[index(i, k)]; }
  [[nodiscard]] const Values& part(int i, int k) const { return parts_[index(i, k)]; }

  /// Return a lower and an upper bound of a · b, where 0 times infinity is 0.
  static double least(double a, double b) {
    if (a == 0 || b == 0) return 0;
    if (std::isinf(a) || std::isinf(b)) return a * b;
    return rounding::below(a * b, rounding::underflow<double>);
  }
  static double most(double a, double b) { return -least(-a, b); }

  /// Return a lower and an upper bound of a sum of two doubles that was rounded to x. The rounded sum is 0
  /// only if the exact sum is, and then the bounds are 0.
  static double below(double x) { return x == 0 ? x : rounding::below(x, rounding::underflow<double>); }
  static double above(double x) { return -below(-x); }

  Values parts_[6], rest_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
