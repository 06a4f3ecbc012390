// Surfaces of fields, marched along rays from far away and along directions of any length, and their bounds.
#include <cmath>
#include <protostar/accel/packet.hpp>
#include <protostar/fields/operations.hpp>
#include <protostar/fields/planar.hpp>
#include <protostar/fields/shapes.hpp>
#include <protostar/scene_fields.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

const auto plain_sphere = [](const Point& p) { return length(p) - 1; };

struct InvalidField {
  auto operator()(const auto& p) const { return length(p) - 1.0; }
  void validate() const { throw std::invalid_argument("not valid"); }
};

}  // namespace

TEST_CASE("a marched surface is not missed from any distance") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  const Marched plain{plain_sphere, Bounds{Point(-1.5), Point(1.5)}, 1.0};
  for (int exponent = 30; exponent <= 400; exponent += 5) {
    CAPTURE(exponent);
    const double far = std::ldexp(1, exponent);
    const auto before = fallbacks.undecided;
    CHECK(marched.intersect({.origin = {0, 0, -far}, .direction = {0, 0, 1}}));
    CHECK(marched.intersect({.origin = {far, 0.5, 0.25}, .direction = {-1, 0, 0}}));
    CHECK(marched.intersect({.origin = {far, far, far}, .direction = {-1, -1, -1}}));
    CHECK(fallbacks.undecided - before <= 3);
    CHECK(plain.intersect({.origin = {0, 0, -far}, .direction = {0, 0, 1}}));
    CHECK_FALSE(marched.intersect({.origin = {0, 1.75, -far}, .direction = {0, 0, 1}}));
    CHECK_FALSE(marched.intersect({.origin = {0, 1.25, -far}, .direction = {0, 0, 1}}));
    CHECK_FALSE(marched.intersect({.origin = {0, 0, -far}, .direction = {0, 0, -1}}));
  }
}

TEST_CASE(
    "from far away a marched sphere is hit where the exact one is, or the ray is counted as undecided") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  Random random(11);
  WrongCases wrong(random);
  int hits = 0;
  for (int i = 0; i < cases(300, 20000); ++i) {
    const Vec3 direction = random.direction();
    const double far = std::ldexp(1, 36 + i % 30);
    const Ray ray{.origin = random.point(1.5) - far * direction, .direction = direction};
    const auto before = fallbacks.undecided;
    const bool is_hit = marched.intersect(ray).has_value(), is_true = Sphere{}.intersect(ray).has_value();
    wrong.add(is_hit != is_true && !(is_hit && fallbacks.undecided > before), ray, is_hit, is_true);
    hits += is_true;
  }
  CHECK(wrong == 0);
  CHECK(hits > 20);
}

TEST_CASE("a marched surface in an instance is not missed from far away") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  const Affine map = Affine{}.rotated_about({1, 2, 3}, 40).moved_by({0.5, 0.25, 0.125});
  const Instance instance(marched, map);
  for (int exponent = 30; exponent <= 80; exponent += 5) {
    CAPTURE(exponent);
    const double far = std::ldexp(1, exponent);
    CHECK(instance.intersect({.origin = {0.5, 0.25, -far}, .direction = {0, 0, 1}}));
    CHECK_FALSE(instance.intersect({.origin = {0.5, 2.25, -far}, .direction = {0, 0, 1}}));
  }
}

TEST_CASE("the length of a direction does not change the answer of a march, but t by a power of two") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  const Marched plain{plain_sphere, Bounds{Point(-1.5), Point(1.5)}, 1.0};
  Random random(12);
  WrongCases wrong(random);
  for (int i = 0; i < cases(40, 400); ++i) {
    const Ray ray = ray_into(random, 1.25);
    MarchCounts counts;
    const MarchedRoot root = marched.march(ray, {}, counts);
    const auto t = plain.intersect(ray);
    for (const int exponent : {-950, -700, -570, -540, -500, -200, -50, 50, 200, 520, 800, 950}) {
      const double length = std::ldexp(1, exponent);
      const Ray other{.origin = ray.origin, .direction = length * ray.direction};
      MarchCounts other_counts;
      const MarchedRoot of_other = marched.march(other, {}, other_counts);
      wrong.add(of_other.answer != root.answer || of_other.min * length != root.min ||
                    of_other.max * length != root.max,
                exponent, ray, of_other.min * length, root.min);
      wrong.add(other_counts.evaluations() != counts.evaluations(), exponent, ray);
      const auto other_t = plain.intersect(other);
      wrong.add(other_t.has_value() != t.has_value() || (t && *other_t * length != *t), exponent, ray);
    }
  }
  CHECK(wrong == 0);
  // Beside the surface, in the bounds, a ray hits nothing, and a ray from the surface ends.
  for (const double length : {1e-300, 1e-170, 1e160, 1e300}) {
    CAPTURE(length);
    CHECK_FALSE(marched.intersect({.origin = {1.25, 1.25, 0}, .direction = {0, 0, length}}));
    CHECK_FALSE(plain.intersect({.origin = {1.25, 1.25, 0}, .direction = {0, 0, length}}));
    const auto t = marched.intersect({.origin = {0, 0, -1}, .direction = {0, 0, length}});
    REQUIRE(t);
    CHECK(std::abs(*t * length - 2) < 0x1p-29);
    CHECK(marched.intersect({.origin = {0, 0, 0}, .direction = {0, 0, length}}));
    CHECK_FALSE(marched.intersect({.origin = {0, 0, -2}, .direction = {0, 0, length}}, {0, 0.5 / length}));
    CHECK(marched.intersect({.origin = {0, 0, -2}, .direction = {0, 0, length}}, {0, 1.5 / length}));
    int crossings = 0;
    marched.each_crossing({.origin = {0.25, 0, 0}, .direction = {0, 0, length}}, {-infinity, infinity},
                          [&](const Crossing& crossing) {
                            CHECK(std::abs(std::abs(crossing.t * length) - std::sqrt(0.9375)) < 0x1p-29);
                            ++crossings;
                          });
    CHECK(crossings == 2);
    Ray leaving{.origin = {0, 0, -1}, .direction = {0, 0, length}, .departure = marched.departure()};
    const auto next = marched.intersect(leaving);
    REQUIRE(next);
    CHECK(std::abs(*next * length - 2) < 0x1p-29);
    const ExactRoot root = marched.exact_root(leaving, {*next, 0});
    CHECK(std::abs(refined(root).hi * length - 2) < 0x1p-50);
  }
}

TEST_CASE("a ray beside the bounds misses, along a face and also if it leads to or from it ever so slowly") {
  const Bounds bounds{Point(-1), Point(1)};
  const Marched marched{[](const auto& p) { return p.x; }, bounds};
  const Marched plain{[](const Point& p) { return p.x; }, bounds, 1.0};
  const Instance instance(marched, Affine{}.moved_by({0, 0, 0.5}));
  const auto are_hit = [&](const Ray& ray) {
    const bool is_hit = marched.intersect(ray).has_value();
    CHECK(plain.intersect(ray).has_value() == is_hit);
    CHECK(instance.intersect(ray).has_value() == is_hit);
    return is_hit;
  };
  for (const double slow : {0.0, 0x1p-1074, 0x1p-1030, 0x1p-1025, 0x1p-1022, 0x1p-1000})
    for (const double sign : {-1, 1}) {
      CAPTURE(slow, sign);
      CHECK_FALSE(are_hit({.origin = {-2, 4, 0}, .direction = {1, sign * slow, 0}}));
      CHECK_FALSE(are_hit({.origin = {-2, -4, 0}, .direction = {1, sign * slow, 0}}));
      CHECK_FALSE(are_hit({.origin = {-2, 0, 4}, .direction = {1, 0, sign * slow}}));
      CHECK_FALSE(are_hit({.origin = {-2, 1.25, -4}, .direction = {1, sign * slow, slow}}));
      CHECK_FALSE(are_hit({.origin = {-2, 1.25, 0}, .direction = {1, sign * slow, 0}}));
      CHECK_FALSE(are_hit({.origin = {-2, -1.25, 0}, .direction = {1, sign * slow, 0}}));
      CHECK(are_hit({.origin = {-2, 1, 0}, .direction = {1, sign * slow, 0}}));
      CHECK(are_hit({.origin = {-2, -1, 0.25}, .direction = {1, sign * slow, slow}}));
    }
}

TEST_CASE("a ray from the border of the range of double is not missed") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  for (const int exponent : {0, 101, 200, 700, 1023}) {
    CAPTURE(exponent);
    const auto before = fallbacks.undecided;
    CHECK(marched.intersect({.origin = {-0x1.8p1023, 0, 0}, .direction = {std::ldexp(1, exponent), 0, 0}}));
    CHECK(fallbacks.undecided > before);
  }
}

TEST_CASE("a ray from far beside the bounds that slowly comes to their middle is not missed") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  for (int exponent = 40; exponent < 400; exponent += 3) {
    CAPTURE(exponent);
    const double far = std::ldexp(1, exponent);
    CHECK(marched.intersect({.origin = {-3, -far, 0}, .direction = {3 / far, 1, 0}}));
    CHECK(marched.intersect({.origin = {far, 0, 3}, .direction = {-1, 0, -3 / far}}));
    CHECK_FALSE(marched.intersect({.origin = {-3, -far, 0}, .direction = {0.25 / far, 1, 0}}));
    CHECK_FALSE(marched.intersect({.origin = {-3, -far, 0}, .direction = {9 / far, 1, 0}}));
  }
}

TEST_CASE("a ray past an instance of a marched surface of any size is proven to miss it") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  for (int exponent = -390; exponent <= 390; exponent += 10) {
    CAPTURE(exponent);
    const double size = std::ldexp(1, exponent);
    const Instance instance(marched, Affine{}.scaled_by(Vec3(size)));
    const auto before = fallbacks.undecided;
    // Past the sphere at the distance √(0.6² + 0.8²) of the doubles, which is above 1 by less than 2^-54.
    CHECK_FALSE(instance.intersect({.origin = size * Vec3(-3, 0.6, 0.8), .direction = {1, 0, 0}}));
    CHECK(fallbacks.undecided == before);
  }
}

TEST_CASE("lines that an instance maps are enclosed in double-double, below the range of double as well") {
  Random random(14);
  WrongCases wrong(random);
  const auto exact = [](DoubleDouble x) { return ExactNumber(x.hi) + ExactNumber(x.lo); };
  for (int i = 0; i < cases(300, 20000); ++i) {
    const double size = std::ldexp(1, static_cast<int>(random.whole(300)));
    const Affine map = Affine{}.scaled_by(size * Vec3(3, 0.75, 1.25)).rotated_about({1, 0, 2}, i % 2 * 30);
    const AffineInverse inverse(map);
    const auto number = [&] {
      return std::ldexp(random.real(-1, 1), -static_cast<int>(std::abs(random.whole(1070))));
    };
    const Ray outer{.origin = {number(), number(), number()}, .direction = {number(), number(), 1}};
    const RayTransform transform(outer, inverse);
    const Ray ray = transform.ray();
    const detail::ModerateLine rounded(ray);
    const auto enclosed = detail::enclosed_exact_line(ray, rounded, rounded.unit);
    const ExactLine line = exact_line(ray);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto contains = [&](const Enclosure<DoubleDouble>& e, const ExactNumber& weighted) {
        return !std::isfinite(e.lower.hi) || !std::isfinite(e.upper.hi) ||
               ((exact(e.lower) * line.weight - weighted).sign() <= 0 &&
                (exact(e.upper) * line.weight - weighted).sign() >= 0);
      };
      wrong.add(line.weight.sign() <= 0, outer, "weight");
      wrong.add(!contains(enclosed.origin[k], line.origin[k]), outer, size, "origin");
      wrong.add(!contains(enclosed.direction[k], ExactNumber(rounded.unit) * line.direction[k]), outer, size,
                "direction");
      wrong.add(line.direction[k].sign() == 0 && enclosed.direction[k].magnitude().hi != 0, outer, "zero");
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a ray that leaves a torus along a direction in which it hardly curves is decided") {
  const auto torus = [](const auto& p) {
    const auto ring = length(Vec2{p.x, p.z}) - 1.0;
    return length(Vec2{ring, p.y}) - 0.3;
  };
  const Marched marched{torus, Bounds{{-1.3, -0.3, -1.3}, {1.3, 0.3, 1.3}}};
  // The field is about 3e-5 t² above its value at the origin: small steps for long.
  const Ray ray{.origin = {-0x1.7fe84e7b90c28p-2, -0x1.0870f0f4eb5ep-4, -0x1.32ea51331ea7p-1},
                .direction = {0x1.4d5fdbe7c1cd9p-1, -0x1.0ea583f6e8ffep-1, -0x1.16d8f54ceaf1p-1},
                .departure = marched.departure()};
  const auto before = fallbacks.undecided;
  CHECK_FALSE(marched.intersect(ray));
  CHECK(fallbacks.undecided == before);
}

TEST_CASE("a hit at the smallest t above 0 is found") {
  const Marched marched{[](const auto& p) { return p.x; }, Bounds{Point(-1), Point(1)}};
  for (const double multiple : {1.0, 3.0, 7.0}) {
    const auto t = marched.intersect({.origin = {-multiple * 0x1p-75, 0, 0}, .direction = {0x1p999, 0, 0}});
    REQUIRE(t);
    CHECK(*t == multiple * 0x1p-1074);
  }
}

TEST_CASE("from far away points count no farther beyond the margin of bounds than two last places of t") {
  for (int exponent = 30; exponent <= 60; ++exponent) {
    const double far = std::ldexp(1, exponent), last_place = std::ldexp(1, exponent - 52);
    const double beyond = 1.001 * (0x1p-9 + 2 * last_place);
    for (const double x : {4 - beyond, 4.0, 5.0, 6.0, 6 + beyond}) {
      CAPTURE(exponent, x);
      const Marched marched{[x](const auto& p) { return p.x - x; }, Bounds{Point(4), Point(6)}};
      const auto t = marched.intersect({.origin = {-far, 5, 5}, .direction = {1, 0, 0}});
      CHECK(t.has_value() == (4 <= x && x <= 6));
    }
  }
}

TEST_CASE("packets of rays from far away, and of any length, march as each ray alone") {
  const Marched marched{sphere_field, Bounds{Point(-1.5), Point(1.5)}};
  Random random(13);
  WrongCases wrong(random);
  int hits = 0;
  for (int i = 0; i < cases(60, 2000); ++i) {
    constexpr int exponents[] = {-950, -540, -101, -100, -99, 99, 100, 101, 520, 950, 0, 0};
    const double length = std::ldexp(1, exponents[i % 12]);
    const Point eye = std::ldexp(1, i % 7 * 10) * random.direction();
    simd::Vectors directions(Vec3{0});
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const Vec3 d = (lane % 2 == 0 ? length : 1) * (0.75 * random.point(1) - eye);
      directions.x.set(lane, d.x), directions.y.set(lane, d.y), directions.z.set(lane, d.z);
    }
    const simd::RayPacket rays(eye, directions);
    const auto first = simd::first_crossings(marched, rays, true, Interval{});
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const auto t = marched.intersect(rays[lane]);
      const bool is_met = (bits(first.met) >> lane & 1) != 0;
      wrong.add(is_met != t.has_value() || (t && first.t[lane] != *t), rays[lane], is_met, first.t[lane], t);
      hits += is_met;
    }
  }
  CHECK(wrong == 0);
  CHECK(hits > 20);
}

TEST_CASE("a marched field is validated, and each field that it is made of") {
  const auto message = [](const auto& field) {
    return message_of<std::invalid_argument>([&] { Marched surface(field, cube_bounds(4), 200); });
  };
  const std::string sizes = " must be from 2^-400 (3.9e-121) to 2^400 (2.6e120); it is ";
  const fields::Sphere ball{1}, wrong{-1};
  const std::string of_ball = "fields::Sphere: radius" + sizes + "-1";
  CHECK(message(wrong) == of_ball);
  CHECK(message(fields::unite(ball, wrong)) == of_ball);
  CHECK(message(fields::subtract(wrong, ball)) == of_ball);
  CHECK(message(fields::JoinedList<fields::Larger, fields::Sphere>{{ball, wrong}}) == of_ball);
  CHECK(message(fields::Shell{wrong, 0.1}) == of_ball);
  CHECK(message(fields::Rounded{wrong, 0.1}) == of_ball);
  CHECK(message(fields::Moved{wrong, Vec3{1, 0, 0}}) == of_ball);
  CHECK(message(fields::Rotated{wrong, Vec3{0, 1, 0}, 30}) == of_ball);
  CHECK(message(fields::Scaled{wrong, 0.5}) == of_ball);
  CHECK(message(fields::Twisted{wrong, 30.0}) == of_ball);
  CHECK(message(fields::Bent{wrong, 30.0}) == of_ball);
  CHECK(message(fields::Mirrored{fields::Scaled{wrong, 0.5}, Vec3{1, 0, 0}}) == of_ball);
  CHECK(message(fields::Repeated<fields::Sphere>{wrong}) == of_ball);
  CHECK(message(fields::Extruded{fields::Circle{-1}, 1.0}) == "fields::Circle: radius" + sizes + "-1");
  CHECK(message(fields::Revolved{fields::Circle{-1}, 1.0}) == "fields::Circle: radius" + sizes + "-1");
  CHECK(message(fields::blend(ball, fields::Moved{ball, Vec3{1, 0, 0}}, -0.25)) ==
        "fields::SmoothlySmaller: width" + sizes + "-0.25");
  CHECK(message(fields::Repeated<fields::Sphere>{ball, {1, 1, 1}, {2, 0, 1}}) ==
        "fields::Repeated: count must be above 0 along each axis, and 1024 in all at most; it is (2, 0, 1)");
  CHECK(message(fields::Moved{ball, Vec3{0x1p401, 0, 0}}) ==
        "fields::Moved: each number of by must be at most 2^400 (2.6e120) in magnitude; it is "
        "(5.164499756173817e+120, 0, 0)");
  const auto rotated = [&](const Vec3& axis, double degrees) {
    return message_of<std::invalid_argument>(
        [&] { static_cast<void>(fields::Rotated<fields::Sphere>(ball, axis, degrees)); });
  };
  CHECK(rotated({0, 0, 0}, 30) == "fields::Rotated: axis must be finite, and not (0, 0, 0); it is (0, 0, 0)");
  CHECK(rotated({0, 1, 0}, infinity) == "fields::Rotated: degrees must be finite; it is inf");
  CHECK_NOTHROW(fields::Rotated<fields::Sphere>(ball, {0, 1e-200, 0}, 30));
  // A field of one's own is validated as well, and a smooth minimum of no width has no bounded slope.
  CHECK(message(fields::Shell{InvalidField{}, 0.1}) == "not valid");
  CHECK_THAT(message([](const auto& p) { return smooth_min(length(p) - 1.0, p.x, -0.25); }),
             ContainsSubstring("found a slope of up to inf"));
}

TEST_CASE("a continuous field whose Lipschitz constant is below the range of double does not jump") {
  const auto flat = [](double factor) { return [=](const auto& p) { return p.x * factor * factor; }; };
  CHECK(lipschitz_bound(flat(1e-200), cube_bounds(1), 1).lipschitz > 0);
  CHECK_NOTHROW(Marched{flat(1e-200), cube_bounds(0x1p398)});
  const auto small = [](const auto& p) { return length(p * 1e-170) * 1e170 - 1.0; };
  CHECK(lipschitz_bound(small, cube_bounds(1), 1).lipschitz >= 1);
  // 1/(x + 4) − 1/4, which has the slope −1/9 at x = −1.
  const auto ratio = [](const auto& p) { return 0x1p-1074 / ((p.x + 4.0) * 0x1p-400) * 0x1p674 - 0.25; };
  CHECK(lipschitz_bound(ratio, cube_bounds(1), 1).lipschitz >= 1.0 / 9);
  CHECK_NOTHROW(Marched{ratio, cube_bounds(1)});
  // −(k − 2^-539 |x|)²/4k, less 2^-540 |x|, has the second derivative −2^-1078/2k.
  const auto joined = [](const auto& p) { return smooth_min(p.x * 0x1p-540, p.x * -0x1p-540, 0x1p-400); };
  CHECK(lipschitz_bound(joined, cube_bounds(1), 1).curvature.lower <= -0x1p-679);
}

TEST_CASE("a march that begins on the surface tells its trace of a touch") {
  const auto plane = [](const auto& p) {
    return p.x + (1 + 0x1p-9);
  };  // at the end of the box that is marched
  const Marched surface{plane, cube_bounds(1)};
  CountedMarch march;
  const MarchedRoot root = surface.march({.origin = {-3, 0, 0}, .direction = {1, 0, 0}}, Interval{}, march);
  CHECK(root.answer == MarchedRoot::Answer::undecided);
  CHECK(root.min == 2 - 0x1p-9);
  CHECK(march.is_hit());
  CHECK(march.enclosure().min == root.min);
  CHECK(march.enclosure().max == root.max);
}

TEST_CASE("a field that is 0 everywhere is at no distance, and another constant one at an infinite one") {
  const auto marched = [](double value) {
    return Marched{[=](const auto& p) { return std::decay_t<decltype(p.x)>(value); }, cube_bounds(1)};
  };
  CHECK(marched(0).march_setup()->bound.lipschitz == 0);
  CHECK(marched(0).distance_bound({0.5, -0.25, 0}) == 0);
  CHECK(marched(0).distance_bound({-0.5, 0.25, 0}) == 0);
  CHECK(marched(0).distance_bound({3, 0, 0}) == 2 - 0x1p-9);  // from the bounds, with their margin
  for (const double x : {0.0, 0.5, 3.0}) CHECK(marched(0.25).distance_bound({x, 0, 0}) == infinity);
  CHECK(marched(-0.25).distance_bound({0.5, 0, 0}) == -infinity);
  // A plain field has a constant above 0.
  const Marched plain{[](const Point&) { return 0.0; }, cube_bounds(1), 1.0};
  CHECK(plain.distance_bound({0.5, 0, 0}) == 0);
}

TEST_CASE("bounds that are too far apart are refused with the difference that is allowed") {
  CHECK(
      message_of<std::invalid_argument>([] { Marched surface(sphere_field, cube_bounds(0x1p400)); }) ==
      "Marched: bounds.x goes from -2.5822498780869086e+120 to 2.5822498780869086e+120; both must be at most "
      "2^400 (2.6e120) in magnitude, and the second must be larger than the first, by a number from 2^-400 "
      "(3.9e-121) to 2^400 (2.6e120)");
}

TEST_CASE(
    "a march from far away that takes thousands of segments between two doubles goes on behind its roots") {
  // fold(x) + fold(x + 1) = 1, but the sum of their enclosures tells so only between kinks. A bar across the
  // ray is all that it meets.
  const auto teeth = [](const auto& p) {
    return min(fold(p.x * 512.0) + fold(p.x * 512.0 + 1.0) - 0.99 + p.y, max(p.x - 0.41, 0.4 - p.x));
  };
  const Marched surface{teeth, cube_bounds(1), 2000};
  /// Counts the roots of a march, and ends one that finds more than there are.
  struct Roots : NoTrace {
    int count = 0;
    void proven(MarchProof proof, double, double) {
      count += proof == MarchProof::sign_change || proof == MarchProof::touch;
      if (count > 100) throw std::runtime_error("a march that finds its roots again and again");
    }
  };
  fallbacks = {};
  for (const double direction : {1.0, -1.0}) {
    Roots roots;
    const Ray ray{.origin = {-direction * 0x1p52, 0, 0}, .direction = {direction, 0, 0}};
    CHECK(surface.march(ray, {0x1p53, infinity}, roots).answer == MarchedRoot::Answer::miss);
    CHECK(roots.count == 2);
  }
  CHECK(fallbacks.undecided == 0);
}

TEST_CASE("a surface counts up to 2^-10 of the bounds beyond them, and no farther") {
  const auto plane = [](const auto& p) { return p.x; };
  const auto hit = [&](double face) {
    const Marched surface{plane, Bounds{Point(face, -1, -1), Point(face + 2, 1, 1)}};
    return surface.intersect({.origin = {3, 0, 0}, .direction = {-1, 0, 0}}).has_value();
  };
  CHECK(hit(0));
  CHECK(hit(0x1p-10));
  CHECK_FALSE(hit(0x1p-8));
}

TEST_CASE(
    "a positive rate twists from z towards x where y > 0, and bends both ends of a bar along x towards -y") {
  // Balls on the axes of the shape, a unit from its middle; each is looked for where it must have come to.
  const auto ball = [](const Vec3& at) { return fields::Moved{fields::Sphere{0.125}, at}; };
  const auto at = [](const auto& field, const Point& p) { return plain_value(field, p); };
  const fields::Twisted twisted{ball({0, 1, 1}), 90.0};
  CHECK(at(twisted, {1, 1, 0}) < 0);
  CHECK(at(twisted, {-1, 1, 0}) > 0);
  CHECK(at(fields::Twisted{ball({0, -1, 1}), 90.0}, {-1, -1, 0}) < 0);
  // A long bar along x bends towards −y at x > 0 for a positive rate.
  const fields::Bent bent{fields::Box{{4, 0.125, 0.5}}, 30.0};
  CHECK(at(bent, {1, std::tan(-std::acos(-1) / 6), 0}) < 0);
  CHECK(at(bent, {1, std::tan(std::acos(-1) / 6), 0}) > 0);
  CHECK(at(bent, {-1, std::tan(-std::acos(-1) / 6), 0}) < 0);
}
