// Fields for tests of marches, each a generic function of a point, and their first roots by subdivision.
#pragma once

#include <optional>
#include <protostar/surfaces/distance_field.hpp>
#include <vector>

#include "cases.hpp"
#include "random.hpp"

inline constexpr auto sphere_field = [](const auto& p) { return length(p) - 1.0; };

inline constexpr auto torus_field = [](const auto& p) {
  using protostar::Vec2;
  const auto ring = length(Vec2{p.x, p.z}) - 1.0;
  return length(Vec2{ring, p.y}) - 0.3;
};

inline constexpr auto box_field = [](const auto& p) {
  using protostar::FieldPoint;
  return signed_length(FieldPoint{abs(p.x) - 1.0, abs(p.y) - 0.7, abs(p.z) - 0.5});
};

/// Two spheres, of radii 1 ± 1e-6.
inline constexpr auto shell_field = [](const auto& p) { return abs(length(p) - 1.0) - 1e-6; };

inline constexpr auto blend_field = [](const auto& p) {
  using protostar::FieldPoint;
  const auto ball = [&](double x, double y, double z, double radius) {
    return length(FieldPoint{p.x - x, p.y - y, p.z - z}) - radius;
  };
  return smooth_min(smooth_min(ball(-0.6, 0, 0, 0.6), ball(0.6, 0.1, 0, 0.5), 0.3), ball(0.1, 0.7, 0.3, 0.4),
                    0.3);
};

inline constexpr auto gyroid_field = [](const auto& p) {
  const auto x = p.x * 6.0, y = p.y * 6.0, z = p.z * 6.0;
  const auto g = sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
  return max(abs(g) - 0.3, length(p) - 1.4);
};

/// A Menger sponge of two levels.
inline constexpr auto sponge_field = [](const auto& p) {
  auto d = max(abs(p.x), max(abs(p.y), abs(p.z))) - 1.0;
  double scale = 1;
  for (int i = 0; i < 2; ++i, scale *= 3) {
    const auto x = fold(p.x * scale + 1.0), y = fold(p.y * scale + 1.0), z = fold(p.z * scale + 1.0);
    const auto hole = max(min(x, y), max(min(y, z), min(z, x))) - 2.0 / 3;
    d = max(d, hole * (1 / scale));
  }
  return d;
};

/// Calls test(name, field, half the side of its bounds) for each of the fields.
void each_test_field(const auto& test) {
  test("sphere", sphere_field, 1.0);
  test("torus", torus_field, 1.3);
  test("box", box_field, 1.0);
  test("shell", shell_field, 1.1);
  test("blend", blend_field, 1.4);
  test("gyroid", gyroid_field, 1.4);
  test("sponge", sponge_field, 1.0);
}

/// Returns the box from −half to half in each coordinate.
inline protostar::Bounds cube_bounds(double half) {
  return {protostar::Point(-half), protostar::Point(half)};
}

/// The first root of a field along a ray in a range, by halving the range until enclosures in double-double
/// decide, near parts first. It knows nothing of marches.
struct TrueRoot {
  enum class Answer { miss, hit, unknown } answer = Answer::miss;
  double t = 0;
};

/// Finds the first t > 0 in (a, b) with f = level along a ray. A part is empty if its value is on one side of
/// the level, or its slope has one sign and both ends are on one side. After so many parts the answer is
/// unknown, as for rays that graze.
TrueRoot true_first_root(const auto& field, const protostar::Ray& ray, double a, double b,
                         std::optional<protostar::Enclosure<protostar::DoubleDouble>> level = {}) {
  using namespace protostar;
  using D = DoubleDouble;
  using E = Enclosure<D>;
  const auto at = [&](D low, D high) {
    const auto coordinate = [&](int k) {
      const E d{D(ray.direction[k]), D(ray.direction[k])}, o{D(ray.origin[k]), D(ray.origin[k])};
      return Slope<E>{o + E{low, high} * d, d};
    };
    const auto f = field(FieldPoint<Slope<E>>{coordinate(0), coordinate(1), coordinate(2)});
    return Slope<E>{level ? f.value - *level : f.value, f.slope};
  };
  const D zero(0.0);
  const auto sign_of = [&](const E& x) { return zero < x.lower ? 1 : x.upper < zero ? -1 : 0; };
  std::vector<std::pair<double, double>> parts{{a, b}};
  for (int i = 0; i < cases(500, 100000) && !parts.empty(); ++i) {
    auto [low, high] = parts.back();
    parts.pop_back();
    const auto over = at(D(low), D(high));
    if (sign_of(over.value) != 0) continue;
    if (zero <= over.slope.lower || over.slope.upper <= zero) {
      const int first = sign_of(at(D(low), D(low)).value), last = sign_of(at(D(high), D(high)).value);
      if (first != 0 && first == last) continue;
      if (first != 0 && last == -first) {
        for (int k = 0; k < 60; ++k) {
          const double middle = 0.5 * (low + high);
          const int sign = sign_of(at(D(middle), D(middle)).value);
          (sign == first ? low : high) = middle;
        }
        return {TrueRoot::Answer::hit, high};
      }
    }
    const double middle = 0.5 * (low + high);
    if (!(low < middle && middle < high)) return {TrueRoot::Answer::unknown, low};
    parts.push_back({middle, high});
    parts.push_back({low, middle});
  }
  return {parts.empty() ? TrueRoot::Answer::miss : TrueRoot::Answer::unknown, 0};
}

/// Returns a ray from outside of a cube towards a point in it.
inline protostar::Ray ray_into(Random& random, double half) {
  const protostar::Point from = 4.0 * random.direction();
  return {.origin = from, .direction = normalize(random.point(half) - from)};
}
