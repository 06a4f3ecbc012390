// Distance fields: their values against other definitions of the same shapes, and their enclosures.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <protostar/exact/distance_field.hpp>
#include <protostar/fields/field.hpp>
#include <protostar/simd/vectors.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using fields::Field;

namespace {

using Real = long double;

Real length_2(Real x, Real y) { return std::sqrt(x * x + y * y); }
Real length_3(Real x, Real y, Real z) { return std::sqrt(x * x + y * y + z * z); }

/// Returns the signed distance of a point from the convex set whose points nearest to it are q, for points
/// outside; inside, minus the depth.
Real outside_or(Real distance, Real depth) { return distance > 0 ? distance : -depth; }

/// Returns the signed distance from the points with |x_i| ≤ half_i, by the nearest of them.
Real from_brick(const std::vector<Real>& x, const std::vector<Real>& half) {
  Real squares = 0, depth = 1e30L;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real beyond = std::fabs(x[i]) - std::clamp(std::fabs(x[i]), Real(0), half[i]);
    squares += beyond * beyond;
    depth = std::min(depth, half[i] - std::fabs(x[i]));
  }
  return outside_or(std::sqrt(squares), depth);
}

/// Facts about a field that do not come from its formula.
struct KnownField {
  std::string name;
  Field field;
  std::function<bool(Real, Real, Real)> is_inside;
  std::function<Real(Real, Real, Real)> distance = {};  ///< none for a bound and an implicit field
  double steepest = 1 + 0x1p-40;                        ///< largest Lipschitz constant that may be derived
  bool is_implicit = false;
};

KnownField by_distance(std::string name, Field field, std::function<Real(Real, Real, Real)> distance) {
  return {std::move(name), std::move(field),
          [distance](Real x, Real y, Real z) { return distance(x, y, z) < 0; }, distance};
}

/// Tests whether a point is in a sponge, digit by digit: in no cell of any level the middle on two axes.
bool in_sponge(Real x, Real y, Real z, int levels) {
  Real u[] = {(x + 1) / 2, (y + 1) / 2, (z + 1) / 2};
  for (const Real c : u)
    if (c < 0 || c > 1) return false;
  for (int level = 0; level < levels; ++level) {
    int middles = 0;
    for (Real& c : u) {
      c *= 3;
      const Real digit = std::min(std::floor(c), Real(2));
      middles += digit == 1 ? 1 : 0;
      c -= digit;
    }
    if (middles >= 2) return false;
  }
  return true;
}

Real wrapped(Real x, Real period) { return x - period * std::round(x / period); }

const Field unit_ball = fields::Sphere{1};
const Field brick = fields::Box{{1.5, 1, 0.5}};
bool in_brick(Real x, Real y, Real z) {
  return std::fabs(x) < 0.75L && std::fabs(y) < 0.5L && std::fabs(z) < 0.25L;
}

const std::vector<KnownField>& shapes() {
  static const std::vector<KnownField> all = [] {
    const Real pi = std::acos(Real(-1));
    std::vector<KnownField> known;
    known.push_back(by_distance("sphere", fields::Sphere{1.25},
                                [](Real x, Real y, Real z) { return length_3(x, y, z) - 1.25L; }));
    known.push_back(by_distance("plane", fields::Plane{{0.6, 0, 0.8}, 0.25},
                                [](Real x, Real, Real z) { return (3 * x + 4 * z) / 5 - 0.25L; }));
    known.push_back(by_distance("box", fields::Box{{2, 1, 0.5}}, [](Real x, Real y, Real z) {
      return from_brick({x, y, z}, {1, 0.5L, 0.25L});
    }));
    known.push_back(
        by_distance("rounded box", fields::RoundedBox{{2, 1, 0.5}, 0.125}, [](Real x, Real y, Real z) {
          return from_brick({x, y, z}, {0.875L, 0.375L, 0.125L}) - 0.125L;
        }));
    known.push_back(by_distance("torus", fields::Torus{1, 0.25}, [](Real x, Real y, Real z) {
      const Real r = length_2(x, z);  // the nearest point of the circle is (x, z)/r
      return length_3(x - x / r, y, z - z / r) - 0.25L;
    }));
    known.push_back(by_distance("cylinder", fields::Cylinder{0.75, 1.5}, [](Real x, Real y, Real z) {
      return from_brick({length_2(x, z), y}, {0.75L, 0.75L});
    }));
    known.push_back(by_distance("capsule", fields::Capsule{0.5, 1}, [](Real x, Real y, Real z) {
      return length_3(x, y - std::clamp(y, Real(-0.5L), Real(0.5L)), z) - 0.5L;
    }));
    known.push_back(by_distance("extruded circle",
                                fields::Extruded<fields::PlanarField>{fields::Circle{0.75}, 1},
                                [](Real x, Real y, Real z) {
                                  return from_brick({length_2(x, y), z}, {0.75L, 0.5L});
                                }));
    known.push_back(by_distance("revolved rectangle",
                                fields::Revolved<fields::PlanarField>{fields::Rectangle{{0.5, 1}}, 1},
                                [](Real x, Real y, Real z) {
                                  return from_brick({length_2(x, z) - 1, y}, {0.25L, 0.5L});
                                }));
    known.push_back({"cone",
                     fields::Cone{0.75, 1.5},
                     [](Real x, Real y, Real z) { return y > -0.75L && length_2(x, z) < (0.75L - y) / 2; },
                     {},
                     1.5});
    known.push_back(
        {"ellipsoid",
         fields::Ellipsoid{{1.25, 0.75, 0.5}},
         [](Real x, Real y, Real z) { return x * x / 1.5625L + y * y / 0.5625L + z * z / 0.25L < 1; },
         {},
         1.01});
    known.push_back(
        {"octahedron",
         fields::Octahedron{1.25},
         [](Real x, Real y, Real z) { return std::fabs(x) + std::fabs(y) + std::fabs(z) < 1.25L; },
         {},
         1.01});
    known.push_back({"horn",
                     fields::GabrielsHorn{1.75, 0.25},
                     [](Real x, Real y, Real z) {
                       return x > 1 && x < 1.75L && std::fabs(length_2(y, z) - 1 / x) < 0.125L;
                     },
                     {},
                     1.3});
    known.push_back({"gyroid",
                     fields::Gyroid{1.5, 0.4},
                     [pi](Real x, Real y, Real z) {
                       const Real k = 2 * pi / 1.5L;
                       return std::fabs(std::sin(k * x) * std::cos(k * y) +
                                        std::sin(k * y) * std::cos(k * z) +
                                        std::sin(k * z) * std::cos(k * x)) < 0.4L;
                     },
                     {},
                     2});
    known.push_back({"sponge",
                     fields::MengerSponge{2, 3},
                     [](Real x, Real y, Real z) { return in_sponge(x, y, z, 3); },
                     {},
                     1.01});
    known.push_back({"extruded polygon",
                     fields::Extruded<fields::PlanarField>{
                         fields::Polygon({{-1, -0.5}, {1, -0.5}, {0.5, 0.5}, {-0.5, 0.75}}), 1},
                     [](Real x, Real y, Real z) {
                       return std::fabs(z) < 0.5L && y > -0.5L && 2 * x + y < 1.5L && y < 0.625L - x / 4 &&
                              5 * x - 2 * y > -4;
                     },
                     {},
                     1.01});
    known.push_back({"metaballs",
                     fields::Metaballs{{{{0, 0, 0}, 0.75}, {{1, 0.5, 0}, 0.5}}, 2},
                     [](Real x, Real y, Real z) {
                       return std::exp(2 - 2 * (x * x + y * y + z * z) / 0.5625L) +
                                  std::exp(2 - 8 * ((x - 1) * (x - 1) + (y - 0.5L) * (y - 0.5L) + z * z)) >
                              1;
                     },
                     {},
                     4,
                     true});
    return known;
  }();
  return all;
}

const std::vector<KnownField>& operations() {
  static const std::vector<KnownField> all = [] {
    using List = std::vector<Field>;
    const auto in_ball = [](Real x, Real y, Real z) { return length_3(x, y, z) < 1; };
    const Field lifted = fields::Moved<Field>{brick, {0.5, 0.75, 0}};
    const auto in_lifted = [](Real x, Real y, Real z) { return in_brick(x - 0.5L, y - 0.75L, z); };
    std::vector<KnownField> known;
    known.push_back({"union", fields::JoinedList<fields::Smaller, Field>{List{unit_ball, lifted}},
                     [=](Real x, Real y, Real z) { return in_ball(x, y, z) || in_lifted(x, y, z); }});
    known.push_back({"intersection", fields::JoinedList<fields::Larger, Field>{List{unit_ball, lifted}},
                     [=](Real x, Real y, Real z) { return in_ball(x, y, z) && in_lifted(x, y, z); }});
    known.push_back({"difference", fields::JoinedList<fields::Without, Field>{List{unit_ball, lifted}},
                     [=](Real x, Real y, Real z) { return in_ball(x, y, z) && !in_lifted(x, y, z); }});
    known.push_back(
        {"smooth union",
         fields::JoinedList<fields::SmoothlySmaller, Field>{
             List{fields::Sphere{0.75}, fields::Moved<Field>{fields::Sphere{0.5}, {1, 0, 0}}}, {0.5}},
         [](Real x, Real y, Real z) {
           const Real a = length_3(x, y, z) - 0.75L, b = length_3(x - 1, y, z) - 0.5L;
           const Real w = std::clamp(0.5L + (b - a), Real(0), Real(1));  // the mix of both, w of a
           return b + w * (a - b) - 0.5L * w * (1 - w) < 0;
         }});
    known.push_back(by_distance("smooth union with itself",
                                fields::JoinedList<fields::SmoothlySmaller, Field>{
                                    List{fields::Sphere{0.75}, fields::Sphere{0.75}}, {0.5}},
                                [](Real x, Real y, Real z) { return length_3(x, y, z) - 0.875L; }));
    known.push_back(by_distance("shell", fields::Shell<Field>{unit_ball, 0.25}, [](Real x, Real y, Real z) {
      return std::max(length_3(x, y, z) - 1.125L, 0.875L - length_3(x, y, z));
    }));
    known.push_back(by_distance("round", fields::Rounded<Field>{brick, 0.25}, [](Real x, Real y, Real z) {
      return from_brick({x, y, z}, {0.75L, 0.5L, 0.25L}) - 0.25L;
    }));
    known.push_back({"rotate", fields::Rotated<Field>(brick, {0, 0, 1}, 90),
                     [](Real x, Real y, Real z) { return in_brick(y, x, z); }});
    known.push_back({"rotate about a diagonal", fields::Rotated<Field>(brick, {1, 1, 1}, 120),  // x to y to z
                     [](Real x, Real y, Real z) { return in_brick(y, z, x); }});
    known.push_back({"scale", fields::Scaled<Field>{brick, 1.5},
                     [](Real x, Real y, Real z) { return in_brick(x / 1.5L, y / 1.5L, z / 1.5L); }});
    known.push_back({"twist",
                     fields::Twisted<Field>{brick, 60},
                     [](Real x, Real y, Real z) {
                       const Real a = y * std::acos(Real(-1)) / 3;  // undone: from x towards z
                       return in_brick(x * std::cos(a) - z * std::sin(a), y,
                                       x * std::sin(a) + z * std::cos(a));
                     },
                     {},
                     6,
                     true});
    known.push_back({"bend",
                     fields::Bent<Field>{brick, 60},
                     [](Real x, Real y, Real z) {
                       const Real a = x * std::acos(Real(-1)) / 3;
                       return in_brick(x * std::cos(a) - y * std::sin(a), x * std::sin(a) + y * std::cos(a),
                                       z);
                     },
                     {},
                     6,
                     true});
    known.push_back(
        {"mirror",
         fields::Mirrored<Field>{fields::Moved<Field>{fields::Sphere{0.375}, {0.25, 0, 0}}, {1, 0, 0}},
         [](Real x, Real y, Real z) {
           const bool is_odd = std::fmod(std::fabs(std::round(x)), Real(2)) == 1;
           return length_3((is_odd ? -1 : 1) * wrapped(x, 1) - 0.25L, y, z) < 0.375L;
         }});
    known.push_back({"repeat", fields::Repeated<Field>{fields::Sphere{0.5}, {0.75, 1.25, 0}, {3, 2, 1}},
                     [](Real x, Real y, Real z) {
                       bool is_inside = false;
                       for (int i = 0; i < 3; ++i)
                         for (int k = 0; k < 2; ++k)
                           is_inside = is_inside || length_3(x - 0.75L * i, y - 1.25L * k, z) < 0.5L;
                       return is_inside;
                     }});
    return known;
  }();
  return all;
}

std::vector<KnownField> known_fields() {
  std::vector<KnownField> all = shapes();
  all.insert(all.end(), operations().begin(), operations().end());
  return all;
}

double at(const Field& field, const Point& p) { return plain_value(field, p); }

/// Segment of a line, inside a cube of 2 around the origin.
struct Segment {
  Point origin;
  Vec3 direction;
  double first, last;
};

Segment random_segment(Random& random) {
  Segment segment{random.point(0.9), random.point(1), 0, 0};
  segment.first = random.real(0, 1);
  segment.last = segment.first + std::ldexp(random.real(0, 0.1), -static_cast<int>(random.bits() % 40));
  return segment;
}

}  // namespace

TEST_CASE("a field is below 0 inside of its shape, and above 0 outside") {
  for (const KnownField& known : known_fields()) {
    CAPTURE(known.name);
    Random random(1);
    WrongCases wrong(random);
    int inside = 0;
    for (int i = 0; i < cases(1000, 100000); ++i) {
      const Point p = random.point(1.75);
      const double value = at(known.field, p);
      if (std::abs(value) < 1e-12) continue;
      const bool is_inside = known.is_inside(p.x, p.y, p.z);
      inside += is_inside ? 1 : 0;
      wrong.add((value < 0) != is_inside, p, value);
    }
    CHECK(wrong == 0);
    CHECK(inside > 0);
  }
}

TEST_CASE("a field that is a distance has the value of the distance") {
  for (const KnownField& known : known_fields()) {
    if (!known.distance) continue;
    CAPTURE(known.name);
    Random random(2);
    WrongCases wrong(random);
    for (int i = 0; i < cases(500, 100000); ++i) {
      const Point p = random.point(2);
      // Each has at most some ten roundings of numbers below 4.
      wrong.add(!(std::fabs(known.distance(p.x, p.y, p.z) - at(known.field, p)) < 40 * 0x1p-52L), p);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a field that is a bound is nowhere larger than the distance of points on the other side") {
  for (const KnownField& known : known_fields()) {
    if (known.is_implicit) continue;
    CAPTURE(known.name);
    Random random(3);
    WrongCases wrong(random);
    for (int i = 0; i < cases(1000, 100000); ++i) {
      const Point p = random.point(1.75);
      const Point q = p + random.real(0, 1) * random.direction();
      if (known.is_inside(p.x, p.y, p.z) == known.is_inside(q.x, q.y, q.z)) continue;
      wrong.add(!(std::abs(at(known.field, p)) <= length(q - p) + 1e-14), p, q, at(known.field, p));
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("the bounds of a field contain all points where it is at most the level") {
  for (const KnownField& known : known_fields()) {
    CAPTURE(known.name);
    Random random(4);
    WrongCases wrong(random);
    for (const double level : {0.0, 0.125}) {
      const Bounds bounds = known.field.bounds(level);
      for (int i = 0; i < cases(500, 50000); ++i) {
        const Point p = random.point(2);
        if (at(known.field, p) > level) continue;
        for (int k = 0; k < 3; ++k)
          wrong.add(!(bounds.min[k] <= p[k] && p[k] <= bounds.max[k]), p, level, bounds.min, bounds.max);
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("enclosures of a field contain its values and slopes, in double and in double-double") {
  for (const KnownField& known : known_fields()) {
    CAPTURE(known.name);
    const Field& field = known.field;
    Random random(5);
    WrongCases value_outside(random), slope_outside(random), precise_outside(random);
    for (int i = 0; i < cases(60, 20000); ++i) {
      const Segment s = random_segment(random);
      const auto precise = [&](double t) {
        return value_at<DoubleDouble>(field, s.origin, s.direction, Enclosure<DoubleDouble>(t));
      };
      const Enclosure<double> t{s.first, s.last};
      const auto values = value_at<double>(field, s.origin, s.direction, t);
      const auto slopes = slope_at<double>(field, s.origin, s.direction, t);
      const auto precise_slopes =
          slope_at<DoubleDouble>(field, s.origin, s.direction, Enclosure<DoubleDouble>{s.first, s.last});
      const double inner = s.first + random.real(0, 1) * (s.last - s.first);
      if (!(s.first <= inner && inner <= s.last)) continue;
      const auto v = precise(inner), first = precise(s.first), last = precise(s.last);
      const auto is_beside = [](double lower, double upper, const Enclosure<DoubleDouble>& x) {
        return x.upper < DoubleDouble(lower) || DoubleDouble(upper) < x.lower;
      };
      value_outside.add(
          is_beside(values.lower, values.upper, v) || is_beside(slopes.value.lower, slopes.value.upper, v),
          s.origin, s.direction, s.first, s.last);
      if (s.first < s.last) {
        const auto quotient =
            (last - first) / (Enclosure<DoubleDouble>(s.last) - Enclosure<DoubleDouble>(s.first));
        slope_outside.add(is_beside(slopes.slope.lower, slopes.slope.upper, quotient), s.origin, s.direction,
                          s.first, s.last);
        precise_outside.add(
            quotient.upper < precise_slopes.slope.lower || precise_slopes.slope.upper < quotient.lower,
            s.origin, s.direction, s.first, s.last);
      }
    }
    CHECK(value_outside == 0);
    CHECK(slope_outside == 0);
    CHECK(precise_outside == 0);
  }
}

TEST_CASE("a field changes no faster than its Lipschitz bound, and is rounded by no more than its error") {
  for (const KnownField& known : known_fields()) {
    CAPTURE(known.name);
    const Field& field = known.field;
    const FieldBound bound = lipschitz_bound(field, {Point(-2), Point(2)}, 2000);
    CHECK(bound.lipschitz <= known.steepest);
    CHECK(bound.error < 1e-12);
    Random random(6);
    WrongCases too_steep(random), too_inexact(random);
    double seen = 0;
    for (int i = 0; i < cases(100, 50000); ++i) {
      const Point p = random.point(1.9);
      const Point q = p + std::ldexp(0.1, -static_cast<int>(random.bits() % 20)) * random.direction();
      const double step = length(q - p), change = std::abs(at(field, q) - at(field, p));
      too_steep.add(!(change <= bound.lipschitz * step * (1 + 0x1p-40) + 2 * bound.error), p, q);
      seen = std::max(seen, (change - 2 * bound.error) / step);
      const auto exact = value_at<DoubleDouble>(field, p, Vec3{0}, Enclosure<DoubleDouble>(0.0));
      const DoubleDouble rest = DoubleDouble(at(field, p)) - exact.lower;
      too_inexact.add(!(std::abs(rest.hi) <= bound.error), p, rest.hi);
    }
    CHECK(too_steep == 0);
    CHECK(too_inexact == 0);
    CHECK(seen > 0.5);  // hence a bound that is half as large would be found
  }
}

TEST_CASE("a field has the same value in each lane as alone") {
  for (const KnownField& known : known_fields()) {
    CAPTURE(known.name);
    Random random(7);
    simd::Vectors points;
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const Point p = random.point(1.5);
      points.x.set(lane, p.x), points.y.set(lane, p.y), points.z.set(lane, p.z);
    }
    using Lanes = Plain<simd::Doubles>;
    const simd::Doubles values =
        known.field(FieldPoint<Lanes>{Lanes::of(points.x), Lanes::of(points.y), Lanes::of(points.z)}).value;
    for (int lane = 0; lane < simd::double_lanes; ++lane)
      CHECK(values[lane] == at(known.field, points[lane]));
  }
}

TEST_CASE("fields made of types and fields made at run time are the same") {
  const auto typed = fields::blend(fields::Sphere{1}, fields::Moved{fields::Box{}, Vec3{1, 0.5, 0}}, 0.25);
  const Field held = fields::JoinedList<fields::SmoothlySmaller, Field>{
      {fields::Sphere{1}, fields::Moved<Field>{fields::Box{}, {1, 0.5, 0}}}, {0.25}};
  static_assert(DistanceField<decltype(typed)> && DistanceField<Field>);
  Random random(8);
  WrongCases wrong(random);
  for (int i = 0; i < 100; ++i) {
    const Point p = random.point(2);
    wrong.add(plain_value(typed, p) != at(held, p), p);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a field is at most 64 deep, and takes at most 4096 shapes and operations") {
  Field deep = fields::Sphere{1};
  for (int i = 1; i < Field::most_depth; ++i) deep = fields::Rounded<Field>{deep, 0.125};
  CHECK(deep.depth() == 64);
  CHECK(message_of<std::invalid_argument>([&] {
          static_cast<void>(Field(fields::Rounded<Field>{deep, 1}));
        }) == "Field: the tree is 65 shapes and operations deep; at most 64 are allowed");

  const Field large = fields::JoinedList<fields::Smaller, Field>{std::vector<Field>(4095, unit_ball)};
  CHECK(large.size() == 4096);
  CHECK(message_of<std::invalid_argument>([&] {
          static_cast<void>(Field(fields::Shell<Field>{large, 1}));
        }) == "Field: an evaluation takes 4097 shapes and operations; at most 4096 are allowed");
  CHECK(Field(fields::Repeated<Field>{unit_ball, {1, 1, 1}, {3, 4, 5}}).size() == 61);
  CHECK(Field(fields::MengerSponge{2, 5}).size() == 6);
}

TEST_CASE("a shape that is not valid is refused") {
  const auto error_of = [](const auto& make) {
    return message_of<std::invalid_argument>([&] { static_cast<void>(Field(make())); });
  };
  CHECK(error_of([] { return fields::Sphere{0}; }) ==
        "fields::Sphere: radius must be from 2^-400 (3.9e-121) to 2^400 (2.6e120); it is 0");
  CHECK(error_of([] {
          return fields::RoundedBox{{1, 1, 1}, 0.75};
        }) == "fields::RoundedBox: radius must be at most half the shortest side; it is 0.75");
  CHECK(error_of([] {
          return fields::GabrielsHorn{1, 0.1};
        }) == "fields::GabrielsHorn: end must be above 1, where the mouth is; it is 1");
  const std::string sizes = " must be from 2^-400 (3.9e-121) to 2^400 (2.6e120); it is ";
  CHECK(error_of([] {
          return fields::RoundedBox{{1, 1, 1}, 0x1p-401};
        }) == "fields::RoundedBox: radius" + sizes + "1.9362959574246591e-121");
  CHECK(error_of([] {
          return fields::GabrielsHorn{0x1p401, 0.1};
        }) == "fields::GabrielsHorn: end" + sizes + "5.164499756173817e+120");
  CHECK(error_of([] {
          return fields::Metaballs{{{Point(0), 1}}, 0x1p-401};
        }) == "fields::Metaballs: sharpness" + sizes + "1.9362959574246591e-121");
  CHECK(error_of([] {
          return fields::Metaballs{{{Point(0), 1}}, 101};
        }) == "fields::Metaballs: sharpness must be at most 100; it is 101");
  CHECK(error_of([] {
          return fields::MengerSponge{1, 13};
        }) == "fields::MengerSponge: levels must be from 0 to 12; it is 13");
  CHECK(error_of([] { return fields::Metaballs{}; }) == "fields::Metaballs: balls must not be empty");
  CHECK(error_of([] {
          return fields::Plane{{1, 1, 0}, 0};
        }) == "fields::Plane: normal must be a unit vector, to within 2^-50; it is (1, 1, 0)");
  CHECK(error_of([] {
          return fields::Plane{{1 + 0x1p-40, 0, 0}, 0};
        }) ==
        "fields::Plane: normal must be a unit vector, to within 2^-50; it is (1.0000000000009095, 0, 0)");
  const auto polygon = [](std::vector<Uv> corners) {
    return message_of<std::invalid_argument>([&] { static_cast<void>(fields::Polygon(std::move(corners))); });
  };
  const std::string allowed =
      "fields::Polygon: corners must be three or more of a convex polygon, counterclockwise";
  CHECK(polygon({{0, 0}, {1, 0}}) == allowed);
  CHECK(polygon({{0, 0}, {0, 1}, {1, 0}}) == allowed);                                        // clockwise
  CHECK(polygon({{0, 0}, {2, 0}, {1, 0.5}, {1, 2}}) == allowed);                              // a dent
  CHECK(polygon({{0, 1}, {-0.6, -0.8}, {0.95, 0.3}, {-0.95, 0.3}, {0.6, -0.8}}) == allowed);  // a star
}

TEST_CASE("the bounds of a polygon with a narrow corner contain the tip of a larger one, or are infinite") {
  WrongCases wrong;
  int finite = 0;
  for (int exponent = 1; exponent < 40; ++exponent)
    for (double direction = 0; direction < 6.25; direction += 0.25) {
      const double angle = std::ldexp(1, -exponent);
      const auto corner = [](double turned) { return Uv(std::cos(turned), std::sin(turned)); };
      const fields::Polygon polygon({{0, 0}, corner(direction), corner(direction + angle)});
      // The lines of both sides, moved by 1/8, meet at this distance from the corner (0, 0).
      const double way = 0.125 / std::sin(0.5 * angle) * (1 - 0x1p-20);
      const Uv tip = -way * corner(direction + 0.5 * angle);
      const fields::PlanarBounds box = polygon.bounds(0.125);
      wrong.add(!(box.min.x <= tip.x && tip.x <= box.max.x && box.min.y <= tip.y && tip.y <= box.max.y),
                angle, direction);
      if (box.max.x < infinity) ++finite;
      wrong.add(exponent < 15 && !(box.max.x < infinity), angle, "infinite");
    }
  CHECK(wrong == 0);
  CHECK(finite > 300);
}
