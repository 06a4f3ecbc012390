// A torus: its roots against those in 113 bits, rays that leave it, and the same torus as a field.
#include <algorithm>
#include <cmath>
#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/fields/shapes.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/torus.hpp>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/true_number.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

using exact::Quad;

/// The quartic of a ray and a torus in 113 bits, as powers of the distance along the ray's direction from the
/// point s, given as a multiple of the direction, where the coefficients lose few digits.
struct TorusQuartic {
  Quad c[5], s;

  TorusQuartic(const Torus& torus, const Ray& ray) {
    Quad p[3], d[3], a[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = Quad(ray.origin[k]) - Quad(torus.center[k]);
      d[k] = ray.direction[k], a[k] = torus.axis[k];
    }
    const auto product = [](const Quad* v, const Quad* w) { return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]; };
    const Quad A = product(d, d), N = product(a, a), G = product(d, a);
    s = -product(p, d) / A;
    for (int k = 0; k < 3; ++k) p[k] += s * d[k];
    const Quad b = product(p, d), H = product(p, a), P = product(p, p), R = torus.radius, r = torus.tube;
    // (p·p + R² − r²)² N = 4 R² (N p·p − (p·a)²), with p·p = P + 2 b t + A t² and p·a = H + G t.
    const Quad q0 = P + R * R - r * r, q1 = 2 * b, q2 = A, F = 4 * R * R;
    c[0] = N * q0 * q0 - F * (N * P - H * H);
    c[1] = 2 * N * q0 * q1 - F * (2 * N * b - 2 * G * H);
    c[2] = N * (2 * q0 * q2 + q1 * q1) - F * (N * A - G * G);
    c[3] = 2 * N * q1 * q2;
    c[4] = N * q2 * q2;
  }

  [[nodiscard]] Quad value(Quad t) const {
    const Quad x = t - s;
    return (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
  }

  /// Returns the number of real roots of Σ c x^k by Sturm's theorem, or -1 if a remainder is about 0.
  [[nodiscard]] static int count(std::vector<Quad> f) {
    std::vector<Quad> g;
    for (std::size_t k = 1; k < f.size(); ++k) g.push_back(f[k] * static_cast<double>(k));
    int at_minus = 0, at_plus = 0, last_minus = 0, last_plus = 0;
    const auto take = [&](const std::vector<Quad>& h) {
      const int plus = h.back() > 0 ? 1 : -1, minus = h.size() % 2 == 1 ? plus : -plus;
      at_plus += last_plus == -plus, at_minus += last_minus == -minus;
      last_plus = plus, last_minus = minus;
    };
    take(f);
    while (true) {
      take(g);
      if (g.size() == 1) return at_minus - at_plus;
      Quad largest = 0;
      for (const Quad x : f) largest = std::max(largest, x < 0 ? -x : x);
      for (Quad& x : f) x /= largest;
      while (f.size() >= g.size()) {
        const Quad factor = f.back() / g.back();
        for (std::size_t k = 0; k < g.size(); ++k) f[f.size() - g.size() + k] -= factor * g[k];
        f.pop_back();
      }
      const Quad rest = f.back() < 0 ? -f.back() : f.back();
      if (rest < Quad(0x1p-70)) return -1;
      for (Quad& x : f) x = -x;
      std::swap(f, g);
    }
  }
};

Torus random_torus(Random& random) {
  const double radius = std::exp2(random.real(-3, 3));
  return {.center = random.point(3),
          .axis = std::exp2(random.real(-9, 9)) * random.direction(),
          .radius = radius,
          .tube = radius * std::exp2(random.real(-8, -0.01))};
}

/// Returns a ray towards a point near the tube, of any length.
Ray ray_at_torus(Random& random, const Torus& torus) {
  const Point from = torus.center + random.real(1, 8) * torus.radius * random.direction();
  const Vec3 n = normalize(torus.axis);
  const Vec3 across = normalize(cross(n, random.direction()));
  const Point to = torus.center + torus.radius * across + 1.2 * torus.tube * random.direction();
  return {.origin = from, .direction = std::exp2(random.real(-5, 5)) * (to - from)};
}

}  // namespace

TEST_CASE("the crossings of a torus are all those of its quartic, as 113 bits tell them") {
  Random random(1);
  WrongCases wrong(random);
  int crossed[5] = {};
  fallbacks = {};
  for (int i = 0; i < cases(1500, 1000000); ++i) {
    const Torus torus = random_torus(random);
    const Ray ray = ray_at_torus(random, torus);
    const TorusQuartic truth(torus, ray);
    const int count = TorusQuartic::count({truth.c, truth.c + 5});
    const auto all = crossings_of(torus, ray, everywhere);
    if (count < 0) continue;
    wrong.add(static_cast<int>(all.size()) != count, ray, torus.center, torus.axis, torus.radius, torus.tube,
              all);
    ++crossed[all.size()];
    double last = -infinity;
    for (const double t : all) {
      const Quad width = Quad(Roots::relative_error) * (t < 0 ? -t : t);
      const Quad below = truth.value(Quad(t) - width), above = truth.value(Quad(t) + width);
      wrong.add(!((below < 0) != (above < 0)) || t < last, ray, torus.radius, torus.tube, t);
      last = t;
    }
  }
  CHECK(wrong == 0);
  CHECK((crossed[0] > 50 && crossed[2] > 300 && crossed[4] > 50));
  CHECK(fallbacks.undecided == 0);
}

TEST_CASE("a ray that grazes a torus is decided down to the digits of double-double") {
  // Along the top of the tube, at height r − g: the tube is crossed if g > 0.
  const Torus torus{.radius = 1, .tube = 0.25};
  for (const double gap : {0x1p-10, 0x1p-30, 0x1p-48, -0x1p-48, -0x1p-20}) {
    const Ray across{.origin = {0, 0.25 - gap, -4}, .direction = {0, 0, 1}};
    INFO(gap);
    fallbacks = {};
    CHECK(crossings_of(torus, across).size() == (gap > 0 ? 4U : 0U));
    CHECK(fallbacks.undecided == 0);
  }
  fallbacks = {};
  const auto touched = crossings_of(torus, Ray{.origin = {0, 0.25, -4}, .direction = {0, 0, 1}});
  REQUIRE(touched.size() == 4);
  CHECK(std::abs(touched[0] - 3) <= 3 * Roots::relative_error);
  CHECK(std::abs(touched[3] - 5) <= 5 * Roots::relative_error);
  CHECK(fallbacks.undecided > 0);
}

TEST_CASE(
    "a ray that starts nearer to a torus than double-double tells is counted, and not one that starts on "
    "it") {
  const Torus torus{.radius = 2, .tube = 1};
  const auto undecided = [](const AnySurface& surface, const Ray& ray) {
    fallbacks = {};
    CHECK(crossings_of(surface, ray, everywhere).size() >= 1);
    return fallbacks.undecided != 0;
  };
  // The torus touches y = −1 at (0, −1, 2). At the distance h from there, it is h²/2 away.
  for (const double h : {0.0, 0x1p-51}) {
    CAPTURE(h);
    const Ray up{.origin = {0, -1, 2 + h}, .direction = {0.5, 1, 0.25}};
    CHECK(undecided(torus, up) == (h != 0));
    const Affine wide = Affine{}.scaled_by({3, 3, 3});
    CHECK(undecided(Instance{torus, wide}, {3.0 * up.origin, up.direction}) == (h != 0));
  }
}

TEST_CASE("a torus is hit by rays with a direction of any length") {
  const Torus torus{.radius = 1, .tube = 0.25};
  const AnySurface wide = Instance{torus, Affine{}.scaled_by({2, 2, 2})};
  for (const int exponent : {-1020, -500, -101, 0, 500, 900, 1000, 1020}) {
    CAPTURE(exponent);
    const double length = std::ldexp(1, exponent);
    fallbacks = {};
    const Ray ray{.origin = {-0.125, 0, 0}, .direction = {length, 0, 0}};
    for (const auto& all : {crossings_of(torus, ray, everywhere),
                            crossings_of(wide, {2.0 * ray.origin, 2.0 * ray.direction}, everywhere)}) {
      REQUIRE(all.size() == 4);
      const double expected[] = {-1.125, -0.625, 0.875, 1.375};
      for (std::size_t i = 0; i < 4; ++i)
        CHECK(std::abs(all[i] * length - expected[i]) <= Roots::relative_error * std::abs(expected[i]));
    }
    const Crossing second{-0.625 / length, 1};
    CHECK(order(torus.exact_root(ray, second), exact_root_of(-0.625 / length)) == 0);
    CHECK(order(torus.exact_root(ray, second), exact_root_of(-0.624999 / length)) < 0);
    CHECK(order(torus.exact_root(ray, second), exact_root_of(-0.625001 / length)) > 0);
  }
}

TEST_CASE("a ray through the hole of a torus, or along its axis, misses it") {
  const Torus torus{.center = {1, 2, 3}, .axis = {0, 0, -5}};
  CHECK(!torus.intersect({.origin = {1, 2, -4}, .direction = {0, 0, 1}}));
  CHECK(!torus.intersect({.origin = {1.5, 2, -4}, .direction = {0, 0.01, 1}}));
  CHECK(torus.intersect({.origin = {2, 2, -4}, .direction = {0, 0, 1}}) == 6.75);
}

TEST_CASE("a ray that leaves a torus does not hit it where it starts, and hits what is next") {
  Random random(2);
  WrongCases acne(random), wrong(random);
  int outward = 0, again = 0;
  for (int i = 0; i < cases(1200, 400000); ++i) {
    const Torus torus = random_torus(random);
    const Ray to = ray_at_torus(random, torus);
    const auto t = torus.intersect(to);
    if (!t) continue;
    const Point point = to.at(*t);
    const Vec3 normal = torus.normal_at(point);
    Vec3 direction = random.direction();
    if (i % 3 == 0) {
      const double cosine = std::pow(10, random.real(-12, -1));
      direction =
          normalize(direction - dot(direction, normal) * normal + (i % 2 ? cosine : -cosine) * normal);
    }
    const Ray ray{.origin = point, .direction = direction, .departure = torus.departure()};
    const TorusQuartic truth(torus, ray);
    // Crossings have the value of the quartic at the origin. Divided by the root there, a cubic is left.
    const Quad s = -truth.s;
    std::vector<Quad> cubic(truth.c + 1, truth.c + 5);
    for (std::size_t k = 3; k-- > 0;) cubic[k] += s * cubic[k + 1];
    const int count = TorusQuartic::count(cubic);
    const auto all = crossings_of(torus, ray, everywhere);
    const auto ahead = crossings_of(torus, ray);
    if (count > 0) wrong.add(static_cast<int>(all.size()) != count, ray, torus.radius, torus.tube, all);
    const bool is_outward = dot(direction, normal) > 0;
    // Outward it is outside, and inward inside, right behind the start.
    acne.add(ahead.size() % 2 != (is_outward ? 0U : 1U), ray, torus.radius, torus.tube, ahead);
    for (const double u : ahead) {
      const auto is_below = [&](double share) {
        const Quad x = Quad(u) + Quad(share) * Quad(u) + s;
        return ((cubic[3] * x + cubic[2]) * x + cubic[1]) * x + cubic[0] < 0;
      };
      wrong.add(is_below(-Roots::relative_error) == is_below(Roots::relative_error), ray, u);
    }
    outward += is_outward, again += is_outward && !ahead.empty();
  }
  CHECK(acne == 0);
  CHECK(wrong == 0);
  CHECK((outward > 200 && again > 20));
}

TEST_CASE("a torus is hit as the field of a torus is, also turned, in an instance, and as part of a solid") {
  const Torus exact{};
  const Marched marched(fields::Torus{}, fields::Torus{}.bounds(0.1));
  const Affine turned = Affine{}.scaled_by(Vec3(1, 2, 0.5)).rotated_about({1, 2, 3}, 40);
  const Sphere ball{.center = {1, 0.1, 0}, .radius = 0.3};
  using Operation = Csg::Operation;
  Random random(3);
  WrongCases wrong(random);
  int crossed = 0;
  const auto compare = [&](const auto& a, const auto& b) {
    for (int i = 0; i < cases(60, 20000); ++i) {
      const Ray ray = ray_at_torus(random, exact);
      const auto as = crossings_of(a, ray, everywhere), bs = crossings_of(b, ray, everywhere);
      bool is_equal = as.size() == bs.size();
      for (std::size_t k = 0; is_equal && k < as.size(); ++k)
        is_equal = std::abs(as[k] - bs[k]) <= 2 * Roots::relative_error * std::abs(as[k]);
      wrong.add(!is_equal, ray, as, bs);
      crossed += !as.empty();
    }
  };
  compare(exact, marched);
  compare(Instance(exact, turned), Instance(marched, turned));
  for (const auto operation : {Operation::either, Operation::all, Operation::first_alone})
    compare(Csg(operation, {Csg(exact), Csg(ball)}), Csg(operation, {Csg(marched), Csg(ball)}));
  CHECK(wrong == 0);
  CHECK(crossed > 150);
}

TEST_CASE("normals, coordinates and their directions of a torus fit its points") {
  Random random(4);
  WrongCases wrong(random);
  for (int i = 0; i < 300; ++i) {
    const Torus torus = random_torus(random);
    const Vec3 n = normalize(torus.axis);
    const auto [e1, e2] = plane_tangents(n);
    const double around = random.real(-3.1, 3.1), beside = random.real(-3.1, 3.1), pi = std::numbers::pi;
    const Vec3 outward = std::cos(around) * e1 + std::sin(around) * e2;
    const Vec3 normal = std::cos(beside) * outward + std::sin(beside) * n;
    const Point point = torus.center + torus.radius * outward + torus.tube * normal;
    const Uv uv = torus.uv_at(point);
    const Tangents tangents = torus.tangents_at(point);
    // With u = 2^-53, `outward` is off from a unit vector across the axis by 20u, as e2 is (coordinates.cpp),
    // the point by 4u of its terms, and its section by 14u. Seen from the circle, that is over the tube, and
    // around the axis over the distance from it; the normals have 20u. A 38th of that is measured.
    const double terms = length(torus.center) + torus.radius + torus.tube;
    const double close =
        58 * 0x1p-53 * terms * (1 / torus.tube + 1 / (torus.radius + torus.tube * std::cos(beside)));
    wrong.add(!(length(torus.normal_at(point) - normal) < close), torus.radius, torus.tube, point);
    wrong.add(!(std::abs(uv.x - (0.5 + around / (2 * pi))) < close), uv.x, around);
    wrong.add(!(std::abs(uv.y - (0.5 - beside / (2 * pi))) < close), uv.y, beside);
    const Vec3 along_u = cross(n, outward), along_v = std::sin(beside) * outward - std::cos(beside) * n;
    wrong.add(!(length(tangents.u - along_u) < close && length(tangents.v - along_v) < close), point);
    const Bounds box = torus.bounds();
    for (int k = 0; k < 3; ++k) wrong.add(!(box.min[k] < point[k] && point[k] < box.max[k]), point);
  }
  CHECK(wrong == 0);
}

TEST_CASE("tori look alike ray by ray, by tiles and through the tree, and as fields do") {
  Scene<Torus, Sphere> scene;
  scene.add(Torus{.axis = {1, 2, -1}}, Color{0.8f, 0.6f, 0.3f});
  scene.add(Torus{.center = {0.9, 0, 0}, .axis = {1, -1, 0}, .tube = 0.1},
            Material{.diffuse = Color{0.5f}, .reflect = 0.4});
  scene.add(Sphere{.center = {0.2, 0, 0}, .radius = 0.4}, Color{0.3f, 0.6f, 0.8f});
  scene.add(PointLight{.position = {4, 3, -4}, .power = Color{400}});
  const Camera camera{.position = {0, 0.5, -2.6}};
  const DrawnAlike drawn = drawn_alike(scene, camera);
  CHECK(drawn.lit > 200);
  CHECK(drawn.different == 0);

  // The depths of a torus and of its field round to the same floats but where t is halfway between two.
  Scene<AnySurface> exact, marched;
  exact.add(Torus{}, Color{1});
  marched.add(Marched(fields::Torus{}, fields::Torus{}.bounds()), Color{1});
  Image a(64, 48), b(64, 48);
  const Camera above = Camera::look_at({0, 1.5, -2}, Point{0});
  render(a, above, exact, DepthIntegrator{});
  render(b, above, marched, DepthIntegrator{});
  CHECK(count_pixels(a, [&](int x, int y) { return a(x, y) != Color{0}; }) > 100);
  CHECK(count_pixels(a, [&](int x, int y) { return (a(x, y) == Color{0}) != (b(x, y) == Color{0}); }) == 0);
  CHECK(different_pixels(a, b) < 3);
}

TEST_CASE(
    "a torus so far away that its center's digits are larger than its size is hit through a tree, too") {
  Random random(9);
  WrongCases wrong(random);
  int hits = 0;
  for (const double far : {1e12, 1e15, 1e16}) {
    for (int k = 0; k < 40; ++k) {
      const Torus torus{{far * random.real(0.5, 1.5), k % 2 == 0 ? 0 : far * random.real(-1, 1), 0},
                        random.direction(),
                        1,
                        0.25};
      const Bounds box = torus.bounds();
      const Vec3 n = normalize(torus.axis);
      for (int axis = 0; axis < 3; ++axis) {
        const double reach = std::sqrt(std::max(0.0, 1 - n[axis] * n[axis])) + 0.25;
        wrong.add((ExactNumber(box.max[axis]) - torus.center[axis] - reach).sign() < 0 ||
                      (ExactNumber(box.min[axis]) - torus.center[axis] + reach).sign() > 0,
                  torus.center, torus.axis);
      }
      Scene<Torus> scene;
      scene.add(torus, Color{1});
      scene.add(Torus{torus.center + Vec3{0, 0, 5}}, Color{1});
      const auto fast = accelerate(scene, {.threads = 1});
      for (int i = 0; i < 200; ++i) {
        const Vec3 direction = random.direction();
        const Point aim = torus.center + Vec3{0, random.real(-1.5, 1.5), random.real(-1.5, 1.5)};
        const Ray ray{aim - std::max(10.0, far * 0x1p-50) * direction, direction};
        const auto expected = scene.intersect(ray, Interval{}), found = fast.intersect(ray, Interval{});
        wrong.add(expected ? !found || found->t != expected->t : found.has_value(), torus.center, torus.axis,
                  ray);
        hits += expected.has_value();
      }
    }
  }
  CHECK(hits > 4000);
  CHECK(wrong == 0);
}

TEST_CASE("a torus whose numbers make none is refused, with the reason") {
  Scene<Torus> scene;
  const auto refused = [&](const Torus& torus) {
    return message_of<std::invalid_argument>([&] { scene.add(torus, Color{1}); });
  };
  CHECK_THAT(refused({.tube = 1}), ContainsSubstring("tube must be less than radius"));
  CHECK_THAT(refused({.axis = Vec3{0}}), ContainsSubstring("axis must not be 0"));
  CHECK_THAT(refused({.radius = -1}), ContainsSubstring("radius must be a number"));
  CHECK_THAT(refused({.tube = 0}), ContainsSubstring("tube must be a number"));
  CHECK_THAT(refused({.center = {infinity, 0, 0}}), ContainsSubstring("center must have numbers"));
}
