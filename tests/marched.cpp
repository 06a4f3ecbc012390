// Surfaces of fields that are marched: the crossings are those of exact surfaces and of subdivision.
#include <cmath>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/distance_field.hpp>
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

/// Returns the ray past a point of a surface at a distance, outside of it: at a right angle to the normal.
Ray ray_past(Random& random, const Point& point, const Vec3& normal, double distance) {
  const Vec3 along = normalize(cross(normal, random.direction()));
  return {.origin = point + distance * normal - 2.0 * along, .direction = along};
}

/// Returns true if a march found what is true: its answer is the true one, and t is in the enclosure, but for
/// the last digits of both.
bool is_right(const MarchedRoot& root, const TrueRoot& truth) {
  if (truth.answer == TrueRoot::Answer::miss) return root.answer == MarchedRoot::Answer::miss;
  const double slack = 4 * ulp * std::abs(truth.t);
  return root.answer == MarchedRoot::Answer::hit && root.min <= truth.t + slack &&
         truth.t <= root.max + slack;
}

}  // namespace

TEST_CASE("a ray beside thousands of waves that nearly touch it misses them all") {
  // sin x cos (x + 1) = (sin (2x + 1) − sin 1) / 2 ≥ −0.921, but over a long segment the enclosed factors
  // allow −1.
  const auto waves = [](const auto& p) { return sin(p.x) * cos(p.x + 1.0) + p.y; };
  const Marched surface{waves, Bounds{Point(-10000, -2, -1), Point(10000, 2, 1)}};
  const auto before = fallbacks.undecided;
  const auto hit = [&](double y) {
    return surface.intersect({.origin = {-10001, y, 0}, .direction = {1, 0, 0}});
  };
  CHECK_FALSE(hit(0.922));
  CHECK(hit(0.92));
  CHECK(fallbacks.undecided == before);
}

TEST_CASE("a march finds the first crossing, enclosed, or proves that there is none") {
  fallbacks = {};
  each_test_field([](const char* name, const auto& field, double half) {
    const Marched surface(field, cube_bounds(half), 4000);
    Random random(1);
    WrongCases wrong(random), wide(random);
    int hits = 0;
    for (int i = 0; i < cases(12, 2000); ++i) {
      const Ray ray = ray_into(random, half);
      MarchCounts counts;
      const MarchedRoot root = surface.march(ray, {}, counts);
      const TrueRoot truth = true_first_root(field, ray, 4 - 2 * half, 4 + 2 * half);
      wrong.add(!is_right(root, truth), name, ray, root.min, root.max, truth.t, truth.answer);
      wide.add(root.max - root.min > 0x1p-30 * root.max, name, ray, root.min, root.max);
      hits += root.answer == MarchedRoot::Answer::hit;
      CHECK(counts.evaluations() >= 1);
    }
    CHECK(wrong == 0);
    CHECK(wide == 0);
    CHECK(hits > cases(2, 400));
  });
  CHECK(fallbacks.undecided == 0);
}

TEST_CASE("rays that graze a surface are decided down to the digits of double") {
  each_test_field([](const char* name, const auto& field, double half) {
    const Marched surface(field, cube_bounds(half), 4000);
    Random random(2);
    WrongCases wrong(random);
    int decided = 0;
    for (int i = 0; i < cases(17, 1700); ++i) {
      const Ray to = ray_into(random, half);
      const auto t = surface.intersect(to);
      if (!t) continue;
      const Point point = to.at(*t);
      const Ray ray = ray_past(random, point, surface.normal_at(point), std::pow(10, -1 - i % 17));
      NoTrace trace;
      const TrueRoot truth = true_first_root(field, ray, 0, 8);
      if (truth.answer == TrueRoot::Answer::unknown) continue;
      const MarchedRoot root = surface.march(ray, {}, trace);
      if (root.answer == MarchedRoot::Answer::undecided) continue;
      wrong.add(!is_right(root, truth), name, ray, root.min, root.max, truth.t, truth.answer);
      ++decided;
    }
    CHECK(wrong == 0);
    CHECK(decided > 0);
  });
}

TEST_CASE("a marched sphere and a marched box are hit where the exact ones are") {
  const Marched marched_sphere(sphere_field, cube_bounds(1));
  const Sphere exact_sphere{.center = {0, 0, 0}, .radius = 1};
  const Marched marched_box(box_field, Bounds{{-1, -0.7, -0.5}, {1, 0.7, 0.5}});
  const Box exact_box{.min = {-1, -0.7, -0.5}, .max = {1, 0.7, 0.5}};
  Random random(3);
  WrongCases wrong(random), normals(random);
  const auto compare = [&](const auto& marched, const auto& exact, double roundings, const Ray& ray) {
    NoTrace trace;
    const MarchedRoot root = marched.march(ray, {}, trace);
    const auto crossing = first_crossing(exact, ray, {});
    wrong.add((root.answer == MarchedRoot::Answer::hit) != crossing.has_value(), ray);
    if (!crossing || root.answer != MarchedRoot::Answer::hit) return;
    const ExactRoot truth = exact_root(exact, ray, *crossing);
    wrong.add(order(exact_root_of(root.min), truth) > 0 || order(truth, exact_root_of(root.max)) > 0, ray,
              root.min, root.max);
    const Point point = ray.at(root.t());
    const Vec3 off = marched.normal_at(point) - normalize(normal_at(exact, point, crossing->primitive));
    normals.add(!(length(off) <= roundings * 0x1p-53), ray, point);
  };
  // A gradient of the box is along an axis. For the sphere it is the middle of an enclosure, of which each
  // operation moves the ends by up to 4u (rounding.hpp), u = 2^-53: a product, two sums and a quotient, and
  // for the length a square, two sums and half as much of it for the root's own: 12u + 6u + 4u + 4u.
  // normalize is off by 4.5u on both sides.
  for (int i = 0; i < cases(400, 40000); ++i) {
    compare(marched_sphere, exact_sphere, 35, ray_into(random, 1.1));
    compare(marched_box, exact_box, 0, ray_into(random, 1.1));
  }
  CHECK(wrong == 0);
  CHECK(normals == 0);
}

TEST_CASE("all crossings of a line with a marched surface are found, also behind the origin") {
  const Marched marched(torus_field, cube_bounds(1.3));
  const Ray through{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const auto all = crossings_of(marched, through, everywhere);
  const std::vector<double> truth{-1.3, -0.7, 0.7, 1.3};
  REQUIRE(all.size() == truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i)  // enclosed to that of itself (marched.hpp)
    CHECK(std::abs(all[i] - truth[i]) <= Roots::relative_error * std::abs(truth[i]));
  CHECK(crossings_of(marched, through).size() == 2);
  CHECK(crossings_of(marched, through, {0.7, 1.3}).size() <= 2);
  CHECK(crossings_of(marched, through, {0.71, 1.29}).empty());
  CHECK(marched.intersect(through, {0.71, 5}).has_value());
}

TEST_CASE("the order of a marched crossing among those of other surfaces is decided far below double") {
  const Marched marched(sphere_field, cube_bounds(1));
  const Ray ray{.origin = {0.3, -0.2, -4}, .direction = {0, 0, 1}};
  const auto crossing = first_crossing(marched, ray, {});
  REQUIRE(crossing);
  const ExactRoot truth = exact_root(Sphere{}, ray, *first_crossing(Sphere{}, ray, {}));
  const ExactRoot enclosed = marched.exact_root(ray, *crossing);
  CHECK(enclosed.error.sign() > 0);
  CHECK(std::abs(static_cast<double>(DoubleDouble(enclosed.error))) < 0x1p-90);

  fallbacks = {};
  CHECK(order(enclosed, truth) == 0);  // no number of digits tells this root from the enclosure
  CHECK(fallbacks.undecided == 1);
  ExactRoot shifted = truth;
  shifted.b += truth.A * ExactNumber(0x1p-85);
  CHECK(order(enclosed, shifted) == -1);
  CHECK(order(shifted, enclosed) == 1);
  CHECK(fallbacks.undecided == 1);
}

TEST_CASE("rays past an edge or a seam, and rays that meet one, are decided down to double-double") {
  // Each field is 0 at the origin, and rays come there at t = 1/3, between two doubles.
  const Vec3 start{1, -2, 0}, past{-3, 6, 0};
  const auto undecided_of = [](const auto& field, const Ray& ray, MarchedRoot::Answer answer) {
    const Marched surface(field, cube_bounds(3), 100);
    fallbacks = {};
    MarchCounts counts;
    CHECK(surface.march(ray, {}, counts).answer == answer);
    return fallbacks.undecided;
  };
  const auto wedge = [](double gap) { return [gap](const auto& p) { return max(p.x, p.y) + gap; }; };
  const auto box = [](double gap) {
    return [gap](const auto& p) {
      const auto x = abs(p.x + 1.0) - 1.0, y = abs(p.y + 1.0) - 1.0;
      return length(Vec2{max(x, 0.0), max(y, 0.0)}) + min(max(x, y), 0.0) + gap;
    };
  };
  const auto two_balls = [](double gap) {  // they meet at the origin, among others
    return [gap](const auto& p) {
      return min(length(p - Vec3{-0.75, 1, 0}), length(p - Vec3{0.75, 1, 0})) - 1.25 - gap;
    };
  };
  using enum MarchedRoot::Answer;
  CHECK(undecided_of(wedge(0x1p-95), {start, past}, miss) == 0);
  CHECK(undecided_of(wedge(0x1p-110), {start, past}, undecided) == 1);
  CHECK(undecided_of(wedge(-0x1p-95), {start, past}, hit) == 0);
  // The terms of the formula of a box have their kinks in one place, and slopes over a piece around it are
  // the sum of their hulls.
  CHECK(undecided_of(box(0x1p-56), {start, past}, miss) == 0);
  CHECK(undecided_of(box(0x1p-95), {start, past}, miss) == 0);
  CHECK(undecided_of(box(0x1p-110), {start, past}, undecided) == 1);
  CHECK(undecided_of(box(-0x1p-95), {start, past}, hit) == 0);
  // Past a seam, from one ball to the other: the first crossing is where the ray leaves the second one.
  CHECK(undecided_of(two_balls(0x1p-95), {{-0.25, 0.125, 0}, {0.75, -0.375, 0}}, hit) == 0);
  CHECK(undecided_of(two_balls(0x1p-110), {{-0.25, 0.125, 0}, {0.75, -0.375, 0}}, undecided) == 1);
  // Crossings at the edge and at the seam.
  CHECK(undecided_of(box(0), {{1, 2, 0}, {-3, -6, 0}}, hit) == 0);
  CHECK(undecided_of(two_balls(0), {{0.25, -1, 0}, {-0.75, 3, 0}}, hit) == 0);
}

TEST_CASE("a ray that clips an edge between two doubles crosses the surface twice there") {
  // From x > 0 into y > 0, with the corner of the solid beyond the line by 2^-60, at t = 1/3.
  const auto clipped = [](const auto& p) { return max(p.x, p.y) - 0x1p-60; };
  const Marched surface(clipped, cube_bounds(3), 100);
  const Ray ray{.origin = {1, -2, 0}, .direction = {-3, 6, 0}};
  fallbacks = {};
  const auto all = crossings_of(surface, ray);
  REQUIRE(all.size() == 2);
  CHECK(std::abs(all[0] - 1.0 / 3) <= 2 * ulp);
  CHECK(std::abs(all[1] - 1.0 / 3) <= 2 * ulp);
  NoTrace trace;
  const MarchedRoot first = surface.march(ray, {}, trace);
  CHECK(first.min < first.max);
  CHECK((first.min <= 1.0 / 3 && 1.0 / 3 <= first.max));
  // The same from the other side, where one ray leaves the solid and enters it again.
  const auto groove = [](const auto& p) { return 0x1p-60 - max(p.x, p.y); };
  CHECK(crossings_of(Marched(groove, cube_bounds(3), 100), ray).size() == 2);
  CHECK(fallbacks.undecided == 0);
}

TEST_CASE("crossings between two doubles are told apart, and ordered among those of other surfaces") {
  // Into the solid beside −y = 2^-56, and out of it beside 2x − y = 2^-59: 3 · 2^-59 before and 2^-59 behind
  // t = 1/3, as shares of 9 and 27.
  const auto clipped = [](const auto& p) {
    return max(max(2.0 * p.x - p.y - 0x1p-59, p.y - 0x1p-55), length(p) - 2.0);
  };
  const Marched marched(clipped, cube_bounds(3), 100);
  const Ray ray{.origin = {-3, 3, -2}, .direction = {9, -9, 6}};
  const auto root_at = [](double numerator, const ExactNumber& change) {
    return ExactRoot{.A = numerator, .b = ExactNumber(numerator / 3) + change, .D = {}};
  };
  const ExactRoot truth[]{root_at(9, -0x1p-55), root_at(27, 0x1p-59)}, middle = root_at(3, 0.0);
  for (const Interval range : {Interval{}, everywhere}) {
    fallbacks = {};
    std::vector<ExactRoot> roots;
    marched.each_crossing(ray, range,
                          [&](const Crossing& one) { roots.push_back(marched.exact_root(ray, one)); });
    REQUIRE(roots.size() == 2);
    CHECK(order(roots[0], middle) == -1);
    CHECK(order(middle, roots[1]) == -1);
    CHECK(order(roots[0], roots[1]) == -1);
    CHECK(fallbacks.undecided == 0);
    for (int i = 0; i < 2; ++i) CHECK(order(roots[static_cast<std::size_t>(i)], truth[i]) == 0);
  }
  // A box from x = 0 on, where the ray comes at t = 1/3, leaves the second part of the chord.
  fallbacks = {};
  const Csg both = intersection_of({marched, Box{.min = {0, -2, -2}, .max = {2, 2, 2}}});
  CHECK(crossings_of_solid(both, ray).size() == 2);
  CHECK(crossings_of_solid(both, ray.with_direction(-ray.direction), everywhere).size() == 2);
  const Csg part = difference_of({Box{.min = {-2, -2, -2}, .max = {0, 2, 2}}, marched});
  CHECK(crossings_of_solid(part, ray).size() == 2);
  CHECK(fallbacks.undecided == 0);
}

TEST_CASE("crossings at the origin of a ray that leaves no surface are taken together") {
  // A ball and a cube around it touch at (1, 0, 0).
  const Marched ball([](const auto& p) { return length(p) - 1.0; }, cube_bounds(2), 100);
  const Marched cube([](const auto& p) { return max(max(abs(p.x), abs(p.y)), abs(p.z)) - 1.0; },
                     cube_bounds(2), 100);
  for (const Vec3& direction : {Vec3{3, 1, 1}, Vec3{-3, 1, 1}, Vec3{1, -0.3, 0.1}}) {
    fallbacks = {};
    const Ray ray{.origin = {1, 0, 0}, .direction = direction};
    CHECK(crossings_of_solid(difference_of({ball, cube}), ray, everywhere).empty());
    CHECK(crossings_of_solid(difference_of({cube, ball}), ray, everywhere).size() == 2);
    CHECK(fallbacks.undecided > 0);
  }
}

TEST_CASE("bounds that are empty, infinite or not numbers are refused with what was found") {
  const auto message = [](const Bounds& bounds) {
    return message_of<std::invalid_argument>([&] { Marched surface(sphere_field, bounds); });
  };
  CHECK_THAT(message({{-1, 2, -1}, {1, 1, 1}}), ContainsSubstring("bounds.y goes from 2"));
  CHECK_THAT(message({{-1, -1, -infinity}, {1, 1, 1}}), ContainsSubstring("bounds.z goes from -inf"));
  CHECK_THAT(message({{not_a_number, -1, -1}, {1, 1, 1}}), ContainsSubstring("bounds.x goes from"));
  CHECK_THAT(message({{-1, -1, -1}, {1, 1, -1}}), ContainsSubstring("must be larger"));
}

TEST_CASE("a field that jumps at the borders of cells is refused, and one of the neighbors too is not") {
  // A ball at the right of each cell of the size `cell`, in the middle of its y and z.
  const auto balls = [](double cell, bool with_neighbors) {
    return [=](const auto& p) {
      const auto x = wrap(p.x / cell), y = wrap(p.y / cell), z = wrap(p.z / cell);
      const auto ball = [&](double place) {
        return length(FieldPoint{x - place, y, z}) * cell - 0.125 * cell;
      };
      const auto own = ball(0.375);
      return with_neighbors ? min(own, min(ball(-0.625), ball(1.375))) : own;
    };
  };
  for (const double cell : {1.5, 0.25, 0x1p-5}) {
    CAPTURE(cell);
    CHECK_NOTHROW(Marched(balls(cell, true), cube_bounds(1), 200));
    CHECK_THAT(
        message_of<std::invalid_argument>([&] { Marched surface(balls(cell, false), cube_bounds(1), 200); }),
        ContainsSubstring("Marched: the field jumps, so that proofs about it would not hold: from ("));
  }
}

TEST_CASE("a plain function is marched past steps below the last digit of t") {
  const auto sphere = [](const Point& p) { return length(p) - 1; };
  const Marched surface{sphere, Bounds{Point(-1), Point(1)}, 1.0};
  // Digits of t are 2^-23 apart, and the field is 2^-24 where the ray is nearest.
  const Ray ray{.origin = {0x1p30, 1 + 0x1p-24, 0}, .direction = {-1, 0, 0}};
  CHECK_FALSE(surface.intersect(ray));
}

TEST_CASE("a plain function is marched by the user's own bound") {
  const auto plain = [](const Point& p) { return length(p) - 1; };
  const Marched marched(plain, cube_bounds(1), 1.0);
  Random random(6);
  WrongCases wrong(random);
  for (int i = 0; i < cases(200, 20000); ++i) {
    const Ray ray = ray_into(random, 0.9);
    const auto t = marched.intersect(ray), exact = Sphere{}.intersect(ray);
    wrong.add(t.has_value() != exact.has_value(), ray);
    if (!t || !exact) continue;
    // The march ends where the field is at most 2^-40 of the bounds' side. With u = 2^-53, the field is off
    // by 5u for a length of about 1 and 1, and by 3u of a point's terms of at most 5. Before the sphere by x,
    // it is at least √(1 + 2 s x + x²) − 1, where s is the ray's slope there, and so x is at most √(s² + 2f)
    // − s.
    const double slope = dot(ray.direction, ray.at(*exact)), f = 2 * 0x1p-40 + (5 + 15) * 0x1p-53;
    wrong.add(!(std::abs(*t - *exact) <= std::sqrt(slope * slope + 2 * f) - std::abs(slope)), ray, *t,
              *exact);
    Ray leaving{.origin = ray.at(*t), .direction = ray.direction, .departure = marched.departure()};
    wrong.add(!marched.intersect(leaving), leaving);
    leaving.direction = marched.normal_at(leaving.origin);
    wrong.add(marched.intersect(leaving).has_value(), leaving);
  }
  CHECK(wrong == 0);
  CHECK_THAT(message_of<std::invalid_argument>([&] { Marched surface(plain, cube_bounds(1), 0.0); }),
             ContainsSubstring("lipschitz is 0"));
}
