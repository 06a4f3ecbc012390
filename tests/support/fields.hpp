// Fields that tests march, and their first roots by subdivision.
#pragma once

#include <optional>
#include <protostar/surfaces/distance_field.hpp>
#include <vector>

#include "cases.hpp"
#include "random.hpp"
#include "sample_fields.hpp"

/// Calls test(name, field, half the side of its bounds) for each of the fields.
void each_test_field(const auto& test) {
  test("sphere", sphere_field, 1.0);
  test("torus", torus_field, 1.3);
  test("box", box_field, 1.0);
  test("shell", shell_field, 1.1);
  test("blend", blend_field, 1.4);
  test("gyroid", gyroid_field, 1.4);
  test("sponge", SpongeField{}, 1.0);
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
