// The fields of stress_marching: each as the library's, and written anew for the judge, with its level sets.
#pragma once

#include <optional>
#include <protostar/fields/operations.hpp>
#include <protostar/fields/shapes.hpp>
#include <protostar/ray.hpp>
#include <vector>

#include "ranges.hpp"

namespace marching {

using ranges::Along, ranges::Quad, ranges::Range;

/// A root in closed form: t to within `error`, or none, or not told, where the digits of Quad do not decide.
struct ClosedForm {
  enum class Answer { miss, hit, unknown } answer = Answer::unknown;
  Quad t = 0, error = 0;
};

/// Returns the roots of A t² + 2 b t + c, near to far; their number is -1 if the digits do not tell it. A is
/// above 0.
struct QuadraticRoots {
  int count = 0;
  Quad t[2]{};

  QuadraticRoots(Quad A, Quad b, Quad c) {
    const Quad D = b * b - A * c, size = b * b + A * ranges::size_of(c);
    // Sums of products, each right to a few 2^-113 of the terms of which they consist, which are below 100.
    if (ranges::size_of(D) <= size * Quad(0x1p-100)) {
      count = -1;
    } else if (D > 0) {
      const Quad root = ranges::root_of(D), q = b < 0 ? root - b : -root - b;
      const Quad one = q / A, other = c / q;
      count = 2, t[0] = std::min(one, other), t[1] = std::max(one, other);
    }
  }
};

/// Returns x·x, x·y and the like for vectors of doubles.
inline Quad dot_of(const protostar::Vec3& a, const protostar::Vec3& b) {
  return Quad(a.x) * b.x + Quad(a.y) * b.y + Quad(a.z) * b.z;
}

/// Returns the roots of a ray with a sphere around a point of the y axis.
inline QuadraticRoots sphere_roots(const protostar::Ray& ray, double y, Quad radius) {
  const protostar::Vec3 o = ray.origin, d = ray.direction;
  const Quad oy = Quad(o.y) - y;
  return {dot_of(d, d), Quad(o.x) * d.x + oy * d.y + Quad(o.z) * d.z,
          Quad(o.x) * o.x + oy * oy + Quad(o.z) * o.z - radius * radius};
}

/// Collects candidates for the first root.
class FirstRoot {
 public:
  void add(Quad t) {
    if (t > 0 && (!is_there_ || t < t_)) t_ = t, is_there_ = true;
  }
  void add(const QuadraticRoots& roots) {
    if (roots.count < 0) is_known_ = false;
    for (int i = 0; i < roots.count; ++i) add(roots.t[i]);
  }
  void add_if(Quad t, bool so) {
    if (so) add(t);
  }
  void forget() { is_known_ = false; }
  /// Returns the first. Roots are right to 2^-100 of numbers up to 10, divided by √D ≥ 2^-50.
  [[nodiscard]] ClosedForm answer() const {
    using Answer = ClosedForm::Answer;
    if (!is_known_) return {};
    return {is_there_ ? Answer::hit : Answer::miss, t_, Quad(0x1p-46)};
  }

 private:
  bool is_there_ = false, is_known_ = true;
  Quad t_ = 0;
};

struct SphereTruth {
  static constexpr const char* name = "sphere";
  static constexpr double reach = 1;
  protostar::fields::Sphere field{1};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    return square(x) + square(y) + square(z) - 1.0;
  }
  [[nodiscard]] ClosedForm closed(const protostar::Ray& ray) const {
    FirstRoot first;
    first.add(sphere_roots(ray, 0, 1));
    return first.answer();
  }
};

struct BoxTruth {
  static constexpr const char* name = "box";
  static constexpr double reach = 1.35;
  protostar::fields::Box field{{2, 1.5, 1}};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    return signed_length(abs(x) - 1.0, abs(y) - 0.75, abs(z) - 0.5);
  }
  [[nodiscard]] ClosedForm closed(const protostar::Ray& ray) const {
    using Answer = ClosedForm::Answer;
    Quad enter = -1e9, leave = 1e9;
    for (int k = 0; k < 3; ++k) {
      const Quad o = ray.origin[k], d = ray.direction[k], half = 0.5 * field.size[k];
      if (d == 0 && ranges::size_of(o) == half) return {};
      if (d == 0 && ranges::size_of(o) > half) return {Answer::miss};
      if (d == 0) continue;
      const Quad a = (-half - o) / d, b = (half - o) / d;
      enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
    }
    if (ranges::size_of(leave - enter) < Quad(0x1p-90)) return {};
    return enter < leave && enter > 0 ? ClosedForm{Answer::hit, enter, Quad(0x1p-90)}
                                      : ClosedForm{Answer::miss};
  }
};

struct RoundedBoxTruth {
  static constexpr const char* name = "rounded box";
  static constexpr double reach = 1.35;
  protostar::fields::RoundedBox field{{2, 1.5, 1}, 0.125};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    return signed_length(abs(x) - 0.875, abs(y) - 0.625, abs(z) - 0.375) - 0.125;
  }
};

struct TorusTruth {
  static constexpr const char* name = "torus";
  static constexpr double reach = 1.3;
  protostar::fields::Torus field{1, 0.3};

  /// Compares squares: (ρ − 1)² + y² with 0.3².
  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    return square(length(x, z) - 1.0) + square(y) - square(Along<T>(0.3));
  }
  /// Returns the first root of the quartic (|p|² + 1 − r²)² − 4 (x² + z²) along the ray.
  [[nodiscard]] ClosedForm closed(const protostar::Ray& ray) const {
    const protostar::Vec3 o = ray.origin, d = ray.direction;
    const Quad r = 0.3, A = dot_of(d, d), B = 2 * dot_of(o, d), C = dot_of(o, o) + 1 - r * r;
    const Quad a = Quad(d.x) * d.x + Quad(d.z) * d.z, b = 2 * (Quad(o.x) * d.x + Quad(o.z) * d.z),
               c = Quad(o.x) * o.x + Quad(o.z) * o.z;
    const Quad f[]{C * C - 4 * c, 2 * B * C - 4 * b, B * B + 2 * A * C - 4 * a, 2 * A * B, A * A};
    const std::optional<std::vector<Quad>> roots = roots_between(f, 4, 0, 16);
    if (!roots) return {};
    FirstRoot first;
    for (const Quad t : *roots) first.add(t);
    return first.answer();
  }

 private:
  /// Returns the roots of Σ c[k] t^k in (a, b) where it changes its sign: between those of its derivative,
  /// by bisection and regula falsi. None if the sign at one of these is not certain.
  static std::optional<std::vector<Quad>> roots_between(const Quad* c, int degree, Quad a, Quad b) {
    const auto value = [&](Quad t) {
      Quad sum = c[degree];
      for (int k = degree - 1; k >= 0; --k) sum = sum * t + c[k];
      return sum;
    };
    std::vector<Quad> ends{a}, roots;
    if (degree > 1) {
      Quad derivative[5];
      for (int k = 0; k < degree; ++k) derivative[k] = c[k + 1] * (k + 1);
      const auto turns = roots_between(derivative, degree - 1, a, b);
      if (!turns) return std::nullopt;
      ends.insert(ends.end(), turns->begin(), turns->end());
    }
    ends.push_back(b);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      Quad low = ends[i], high = ends[i + 1], f_low = value(low), f_high = value(high);
      // Coefficients are below 2^12 and t below 2^4, so that 2^-70 is far above all rounding.
      if (ranges::size_of(f_low) < Quad(0x1p-70) || ranges::size_of(f_high) < Quad(0x1p-70))
        return std::nullopt;
      if ((f_low > 0) == (f_high > 0)) continue;
      for (int k = 0; k < 200 && high - low > Quad(0x1p-90); ++k) {
        Quad t = k % 3 == 2 ? (low + high) / 2 : low - f_low * (high - low) / (f_high - f_low);
        if (!(low < t && t < high)) t = (low + high) / 2;
        const Quad f = value(t);
        if ((f > 0) == (f_low > 0))
          low = t, f_low = f, f_high /= 2;
        else
          high = t, f_high = f, f_low /= 2;
      }
      roots.push_back((low + high) / 2);
    }
    return roots;
  }
};

struct CapsuleTruth {
  static constexpr const char* name = "capsule";
  static constexpr double reach = 1.15;
  protostar::fields::Capsule field{0.5, 1.25};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    return square(x) + square(z) + square(max(abs(y) - 0.625, Along<T>())) - 0.25;
  }
  /// Returns the first of the crossings with the cylinder between the ends and with the spheres beyond them.
  [[nodiscard]] ClosedForm closed(const protostar::Ray& ray) const {
    const protostar::Vec3 o = ray.origin, d = ray.direction;
    const Quad A = Quad(d.x) * d.x + Quad(d.z) * d.z;
    if (A < Quad(0x1p-40)) return {};
    FirstRoot first;
    const auto height = [&](Quad t) { return ranges::size_of(Quad(o.y) + t * d.y); };
    const auto add = [&](const QuadraticRoots& roots, bool beyond) {
      if (roots.count < 0) first.forget();
      for (int i = 0; i < roots.count; ++i) first.add_if(roots.t[i], (height(roots.t[i]) > 0.625) == beyond);
    };
    add({A, Quad(o.x) * d.x + Quad(o.z) * d.z, Quad(o.x) * o.x + Quad(o.z) * o.z - Quad(0.25)}, false);
    add(sphere_roots(ray, 0.625, 0.5), true);
    add(sphere_roots(ray, -0.625, 0.5), true);
    return first.answer();
  }
};

inline auto three_balls() {
  using protostar::fields::blend, protostar::fields::Moved, protostar::fields::Sphere;
  return blend(blend(Moved{Sphere{0.6}, {-0.6, 0, 0}}, Moved{Sphere{0.5}, {0.6, 0.1, 0}}, 0.3),
               Moved{Sphere{0.4}, {0.1, 0.7, 0.3}}, 0.3);
}

struct BlendTruth {
  static constexpr const char* name = "blend";
  static constexpr double reach = 1.4;
  decltype(three_balls()) field = three_balls();

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    const auto of_ball = [&](double cx, double cy, double cz, double radius) {
      return length(x - cx, y - cy, z - cz) - radius;
    };
    return smooth_min(smooth_min(of_ball(-0.6, 0, 0, 0.6), of_ball(0.6, 0.1, 0, 0.5), 0.3),
                      of_ball(0.1, 0.7, 0.3, 0.4), 0.3);
  }
};

struct GyroidTruth {
  static constexpr const char* name = "gyroid";
  static constexpr double reach = 1.4;
  decltype(protostar::fields::intersect(protostar::fields::Gyroid{}, protostar::fields::Sphere{})) field =
      protostar::fields::intersect(protostar::fields::Gyroid{1, 0.3}, protostar::fields::Sphere{1.4});

  /// The wave number 2π and the factor 1/√3 are those of the library's field, to the last digit.
  template <class T>
  Along<T> operator()(const Along<T>& px, const Along<T>& py, const Along<T>& pz) const {
    const Along<T> wave(0x1.921fb54442d18p+2), x = px * wave, y = py * wave, z = pz * wave;
    const Along<T> g = sine(x, 0) * sine(y, 1) + sine(y, 0) * sine(z, 1) + sine(z, 0) * sine(x, 1);
    const double factor = 0x1.279a74590331cp-1 / 0x1.921fb54442d18p+2;
    return max((abs(g) - 0.3) * factor, length(px, py, pz) - 1.4);
  }
};

struct SpongeTruth {
  static constexpr const char* name = "sponge";
  static constexpr double reach = 1.74;
  protostar::fields::MengerSponge field{2, 4};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    Along<T> value = max(abs(x), max(abs(y), abs(z))) - 1.0;
    double cells = 1;
    for (int level = 0; level < 4; ++level, cells *= 3) {
      const Along<T> a = fold(x * cells + 1.0), b = fold(y * cells + 1.0), c = fold(z * cells + 1.0);
      const Along<T> cross = max(min(a, b), max(min(b, c), min(c, a))) - 2.0 / 3.0;
      value = max(value, cross * (1 / cells));
    }
    return value;
  }
};

struct TwistTruth {
  static constexpr const char* name = "twist";
  static constexpr double reach = 1.35;
  protostar::fields::Twisted<protostar::fields::RoundedBox> field{{{1, 2, 1}, 0.125}, 90};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    const Along<T> angle = y * (90 * (0x1.921fb54442d18p+1 / 180));
    const Along<T> s = sine(angle, 0), c = sine(angle, 1);
    return signed_length(abs(x * c - z * s) - 0.375, abs(y) - 0.875, abs(x * s + z * c) - 0.375) - 0.125;
  }
};

struct ShellTruth {
  static constexpr const char* name = "shell";
  static constexpr double reach = 1.001;
  protostar::fields::Shell<protostar::fields::Sphere> field{{1}, 2e-6};

  template <class T>
  Along<T> operator()(const Along<T>& x, const Along<T>& y, const Along<T>& z) const {
    return abs(length(x, y, z) - 1.0) - 1e-6;
  }
  [[nodiscard]] ClosedForm closed(const protostar::Ray& ray) const {
    FirstRoot first;
    first.add(sphere_roots(ray, 0, Quad(1) + Quad(1e-6)));
    first.add(sphere_roots(ray, 0, Quad(1) - Quad(1e-6)));
    return first.answer();
  }
};

/// Calls visit(truth) for each of the ten fields.
void each_field(const auto& visit) {
  visit(SphereTruth{}), visit(BoxTruth{}), visit(RoundedBoxTruth{}), visit(TorusTruth{});
  visit(CapsuleTruth{}), visit(BlendTruth{}), visit(GyroidTruth{}), visit(SpongeTruth{});
  visit(TwistTruth{}), visit(ShellTruth{});
}

}  // namespace marching
