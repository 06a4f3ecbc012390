#include <protostar/irradiance.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"
#include "support/view_checks.hpp"
#include "support/views.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

using Long = long double;

/// Returns ∫ f over [from, to] in long double, by the rule of Gauss and Legendre with 12 nodes in each panel.
Long integral(const auto& f, Long from, Long to, int panels) {
  static constexpr Long nodes[] = {0.125233408511468915472441369464L, 0.367831498998180193752691536644L,
                                   0.587317954286617447296702418941L, 0.769902674194304687036893833213L,
                                   0.904117256370474856678465866119L, 0.981560634246719250690549090149L};
  static constexpr Long weights[] = {0.249147045813402785000562436043L, 0.233492536538354808760849898925L,
                                     0.203167426723065921749064455810L, 0.160078328543346226334652529543L,
                                     0.106939325995318430960254718194L, 0.047175336386511827194615961485L};
  const Long half = (to - from) / panels / 2;
  Long sum = 0;
  for (int i = 0; i < panels; ++i) {
    const Long middle = from + (2 * i + 1) * half;
    for (int k = 0; k < 6; ++k)
      sum += weights[k] * (f(middle - half * nodes[k]) + f(middle + half * nodes[k]));
  }
  return sum * half;
}

/// Returns the irradiance by a sphere in directions within σ of an axis that makes the angle θ with the
/// normal: the integral over rings around the axis, of which each is above the horizon by a closed form.
/// `cosine` is cos θ.
Long sphere_by_rings(Long cosine, Long sigma) {
  const Long sine = std::sqrt((1 - cosine) * (1 + cosine));
  const auto ring = [&](Long angle) {
    const Long a = cosine * std::cos(angle), b = sine * std::sin(angle);
    if (a >= b) return 2 * std::numbers::pi_v<Long> * a * std::sin(angle);
    if (a <= -b) return 0 * a;
    const Long half = std::acos(-a / b);
    return 2 * (a * half + b * std::sin(half)) * std::sin(angle);
  };
  // The rings that touch the horizon: from there the integrand is smooth in the square root of the angle.
  const Long touching = std::min(sigma, std::abs(std::asin(cosine)));
  const auto beyond = [&](Long t) {
    return ring(touching + (sigma - touching) * t * t) * 2 * t * (sigma - touching);
  };
  return integral(ring, 0, touching, 8) + integral(beyond, 0, 1, 16);
}

struct LongVector {
  Long x, y, z;
  LongVector(Long first, Long second, Long third) : x(first), y(second), z(third) {}
  LongVector(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}
  friend LongVector operator+(LongVector a, LongVector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend LongVector operator*(Long a, LongVector b) { return {a * b.x, a * b.y, a * b.z}; }
  friend Long dot(LongVector a, LongVector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

/// Returns the irradiance by the part of a parallelogram, or of a disk of polar coordinates, that `place`
/// makes of [0, 1] × [0, 1] with an area element: by integration over the area, whose integrand has no
/// differences.
Long by_area(const Point& point, const Vec3& normal, const LongVector& light_normal, const auto& place,
             const auto& element, int panels) {
  return integral(
      [&](Long a) {
        return integral(
            [&](Long b) {
              const LongVector to = place(a, b) + LongVector(-1.0 * point);
              const Long square = dot(to, to);
              return std::max(dot(to, normal), Long(0)) * std::abs(dot(to, light_normal)) /
                     (square * square) * element(a, b);
            },
            0, 1, panels);
      },
      0, 1, panels);
}

/// Checks that the mean of estimates by a view is the expected irradiance, which is off by 2^-41 of itself:
/// by 32 estimates, of which each has one direction in each of 20 × 20 strata. For chance alone, 7 standard
/// errors are rarer than 1e-6 (Student's t with 31 degrees of freedom).
void check_mean(const auto& sample, const Vec3& normal, double expected, std::uint64_t seed,
                double largest_error) {
  constexpr int n = 20, count = 32;
  Random random(seed);
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    double mean = 0;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) {
        const double u = (a + random.interior()) / n, v = (b + random.interior()) / n;
        const LightSample light = sample(u, v);
        mean += std::max(0.0, dot(light.direction, normal)) / light.density / (n * n);
      }
    const double error = mean / expected - 1;
    sum += error, squares += error * error;
  }
  const double mean = sum / count;
  const double standard_error = std::sqrt(std::max(squares / count - mean * mean, 0.0) / (count - 1));
  CHECK(standard_error < largest_error);  // a bias of 7 times that is found
  // Sums of 400 and 32 positive numbers are off by 432u of themselves, directions and densities by 60u.
  CHECK(std::abs(mean) <= 7 * standard_error + 0x1p-41 + 492 * u_roundoff);
}

// Errors of irradiance by a polygon, as irradiance.hpp promises them: a share of itself, and 2^-92 of an
// angle of at most π, which is more for small ones.
constexpr double of_polygon = 0x1p-41, of_polygon_alone = 0x1p-90;

// Error of irradiance by a disk that the horizon cuts, as a share of one that faces it, and thus of the solid
// angle; and by one that it does not cut.
constexpr double of_cut_disk = 0x1p-41, of_whole_disk = 32 * u_roundoff;

}  // namespace

TEST_CASE("a sphere wholly above the horizon gives π (R/d)² cos θ, and one below gives nothing") {
  for (const double unit : {0.25, 1.0, 0x1p17, 0x1p37}) {  // with these the center is exact
    const Vec3 to = unit * Vec3{2, 3, 6}, direction = Vec3{2, 3, 6} / 7.0;
    const double facing = std::numbers::pi / (49 * unit * unit);
    const auto irradiance = [&](const Vec3& n) { return sphere_irradiance({1, 1, 1}, n, Point(1) + to, 1); };
    // 16u as irradiance.hpp promises, u for each rounded number in the expected ones, and u for the
    // direction.
    CHECK(std::abs(irradiance({0, 0, 1}) - facing * 6 / 7) <= (16 + 3) * u_roundoff * facing);
    CHECK(std::abs(irradiance(direction) - facing) <= (16 + 2) * u_roundoff * facing);
    CHECK(irradiance(-direction) == 0);
  }
  CHECK(sphere_irradiance({0, 0, 0}, {0, 0, 1}, {0, 0, 0.5}, 1) == std::numbers::pi);
  CHECK(sphere_irradiance({0, 0, 0}, {0, 0, 1}, {0, 0, -0.5}, -1) == std::numbers::pi);
  CHECK(sphere_irradiance({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1) ==
        std::numbers::pi / 2);  // half of all directions
}

TEST_CASE("a sphere that the horizon cuts gives the integral over its part above") {
  if (!long_double_judges()) return;
  Random random(1);
  WrongCases wrong(random);
  double most = 0;
  for (int i = 0; i < 1500; ++i) {
    // From almost on the sphere to far away, and from almost below the horizon to almost above it.
    const double distance = i % 2 == 0 ? 1 + std::exp2(random.real(-40, 2)) : std::exp2(random.real(0, 40));
    double height = random.real(-1, 1);
    if (i % 5 == 0) height = std::copysign(1 - std::exp2(random.real(-40, -2)), height);
    if (i % 5 == 1) height = std::copysign(std::exp2(random.real(-40, -2)), height);
    const Point center{std::sqrt((distance - height) * (distance + height)), 0, height};
    const LongVector c(center);
    const Long d2 = dot(c, c);
    // d² − R², of which σ is a function, has more digits than d².
    const PreciseVector precise(center);
    const DoubleDouble difference = dot(precise, precise) - DoubleDouble(1);
    const Long gap = Long(difference.hi) + difference.lo;
    if (gap < 0) continue;
    const Long expected = sphere_by_rings(c.z / std::sqrt(d2), std::atan2(Long(1), std::sqrt(gap)));
    const double whole = static_cast<double>(std::numbers::pi_v<Long> / d2);
    const double got = sphere_irradiance({0, 0, 0}, {0, 0, 1}, center, 1);
    const double error = static_cast<double>(std::abs(got - expected)) / whole;
    most = std::max(most, error);
    // As irradiance.hpp promises; `whole` is rounded, and the rule is exact to 2^-58.
    wrong.add(!(error <= 16.1 * u_roundoff), distance, height, got, error);
  }
  CHECK(wrong == 0);
  CHECK(most > 0);
}

TEST_CASE("the irradiance by a sphere is continuous where the horizon begins to cut it") {
  for (const double distance : {1.001, 2.0, 1e3, 1e9})
    for (const double side : {-1.0, 1.0}) {
      const auto at = [&](double height) {
        return sphere_irradiance({0, 0, 0}, {0, 0, 1},
                                 {std::sqrt((distance - height) * (distance + height)), 0, height}, 1) *
               distance * distance;
      };
      // The irradiance grows with the height as that of a whole sphere at most, π/d³, and is off by 16u π/d²;
      // the distance by 2u.
      constexpr double gap = 0x1p-40;
      CHECK(std::abs(at(side * (1 - gap)) - at(side * (1 + gap))) <=
            (2 * gap / distance + 2 * (16 + 4) * u_roundoff) * std::numbers::pi);
    }
}

TEST_CASE(
    "the irradiance by a polygon is the integral over its area, also if it is tiny, far or seen edge on") {
  if (!long_double_judges()) return;
  Random random(2);
  WrongCases wrong(random);
  double most = 0;
  for (int i = 0; i < 120; ++i) {
    // Seen under angles from 1e-12 to 1; the point may be almost in its plane.
    const double size = i % 3 == 0 ? 1 : std::exp2(random.real(-40, 0));
    const Vec3 u = size * Vec3{1, 0, 0}, v = size * Vec3{0.25, 1, 0};
    const Point position{0, 0, i % 2 == 0 ? std::exp2(random.real(-20, 2)) : random.real(1, 4)};
    const Point point{random.real(2, 5), random.real(1, 3), 0};
    const Vec3 normal = normalize(random.point(1) + Vec3{-2, -1, 1.5});
    const auto irradiance = [&](const Vec3& n) { return parallelogram_irradiance(point, n, position, u, v); };
    const auto place = [&](Long a, Long b) {
      return LongVector(position) + a * LongVector(u) + b * LongVector(v);
    };
    const auto element = [&](Long, Long) { return Long(size) * size; };
    if (std::min({dot(position - point, normal), dot(position + u + v - point, normal),
                  dot(position + u - point, normal), dot(position + v - point, normal)}) < 0)
      continue;
    const auto expected = static_cast<double>(by_area(point, normal, Vec3{0, 0, 1}, place, element, 4));
    const double error = std::abs(irradiance(normal) - expected);
    most = std::max(most, error);
    wrong.add(!(error <= of_polygon * expected + of_polygon_alone), size, position, point, normal, error);
  }
  CHECK(wrong == 0);
  CHECK(most > 0);
}

TEST_CASE(
    "irradiance by a polygon is that by its parts, and is linear in the normal above and below the horizon") {
  Random random(3);
  WrongCases wrong(random);
  for (int i = 0; i < 400; ++i) {
    const auto [point, corners] = triangle_case(random, i);
    // Corners are rounded so that the middles of edges are exact.
    std::array<Point, 3> t = corners;
    for (Point& p : t)
      if (i % 6 != 3)
        for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] * 0x1p48) * 0x1p-48;
    const Point p = point;
    const Vec3 normal = random.direction();
    const auto whole = [&](const Vec3& n) { return polygon_irradiance(p, n, t); };
    double net = whole(normal) - whole(-normal), all = whole(normal) + whole(-normal);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 n{0};
      n[axis] = 1;
      net -= normal[axis] * (whole(n) - whole(-n)), all += std::abs(normal[axis]) * (whole(n) + whole(-n));
    }
    wrong.add(!(std::abs(net) <= of_polygon * all + 8 * of_polygon_alone), "linear", i % 6, p, t, normal);
    if (i % 6 == 3) continue;
    const Point a = (t[1] + t[2]) / 2.0, b = (t[2] + t[0]) / 2.0, c = (t[0] + t[1]) / 2.0;
    const double parts = triangle_irradiance(p, normal, t[0], b, c) +
                         triangle_irradiance(p, normal, t[1], c, a) +
                         triangle_irradiance(p, normal, t[2], a, b) + triangle_irradiance(p, normal, a, b, c);
    const double most = of_polygon * (parts + whole(normal)) + 5 * of_polygon_alone;
    wrong.add(!(std::abs(parts - whole(normal)) <= most), "parts", i % 6, p, t, normal, parts, whole(normal));
  }
  CHECK(wrong == 0);
}

TEST_CASE("a polygon that the horizon cuts gives as much as its part above") {
  Random random(4);
  WrongCases wrong(random);
  for (int i = 0; i < 200; ++i) {
    // An upright board and one that is not convex; numbers are multiples of 2^-40, so that the parts are
    // exact.
    const auto round = [](double x) { return std::round(x * 0x1p40) * 0x1p-40; };
    const double x = round(std::exp2(random.real(-20, 3))), y = round(random.real(-2, 1)),
                 w = round(random.real(0.1, 3)), top = round(std::exp2(random.real(-20, 2))),
                 bottom = -round(std::exp2(random.real(-20, 2)));
    const Vec3 up{0, 0, 1};
    const std::array board{Point{x, y, bottom}, Point{x, y + w, bottom}, Point{x, y + w, top},
                           Point{x, y, top}},
        above{Point{x, y, 0}, Point{x, y + w, 0}, Point{x, y + w, top}, Point{x, y, top}};
    const double expected = polygon_irradiance({0, 0, 0}, up, above);
    // Polygons that are cut are summed up in double-double.
    const double got = polygon_irradiance({0, 0, 0}, up, board);
    wrong.add(!(std::abs(got - expected) <= of_polygon * expected + 2 * of_polygon_alone), board, got,
              expected);
    const double half = y + w / 2;
    const std::array notched{board[0], Point{x, half, 2 * bottom}, board[1],
                             board[2], Point{x, half, -top / 2},   board[3]};
    const double notch = triangle_irradiance({0, 0, 0}, up, board[2], Point{x, half, -top / 2}, board[3]);
    wrong.add(!(std::abs(polygon_irradiance({0, 0, 0}, up, notched) - (expected - notch)) <=
                of_polygon * (expected + notch) + 3 * of_polygon_alone),
              notched);
  }
  CHECK(wrong == 0);
  CHECK(polygon_irradiance({0, 0, 0}, {0, 0, 1},
                           std::array{Point{1, 0, -1}, Point{2, 0, -1}, Point{1, 1, 0}}) == 0);
  CHECK(polygon_irradiance({0, 0, 0}, {0, 0, 1}, std::span<const Point>{}) == 0);
}

TEST_CASE("a wide board close to a surface is a wedge: it gives π (1 + cos α)/2") {
  for (const double angle : {0.0, 30.0, 90.0, 150.0, 180.0}) {
    const Vec3 normal{sine_of_degrees(angle), 0, cosine_of_degrees(angle)};
    // The board of the half side 1 lacks light from heights below h/ρ, where ρ is the distance of its edge, h
    // sin α ∫ cos φ/ρ dφ = (1 + π/4) h sin α, but for terms of h².
    constexpr double h = 1e-12, pi = std::numbers::pi;
    const double irradiance = parallelogram_irradiance({0, 0, 0}, normal, {-1, -1, h}, {2, 0, 0}, {0, 2, 0});
    const double expected =
        pi * (1 + cosine_of_degrees(angle)) / 2 - (1 + pi / 4) * h * sine_of_degrees(angle);
    CHECK(std::abs(irradiance - expected) <= (of_polygon + 4 * u_roundoff) * expected + 4 * h * h);
  }
}

TEST_CASE("a disk gives πR²/(R² + d²) on its axis, and elsewhere the integral over its area") {
  for (const double d : {1e-12, 1e-3, 1.0, 1e6, 1e12}) {
    const double expected = std::numbers::pi / (1 + d * d);
    CHECK(std::abs(disk_irradiance({0, 0, -d}, {0, 0, 1}, {0, 0, 0}, {0, 0, 3}, 1) - expected) <=
          (of_whole_disk + 3 * u_roundoff) * expected);
  }
  if (!long_double_judges()) return;
  Random random(5);
  WrongCases wrong(random);
  int checked = 0;
  for (int i = 0; i < 60; ++i) {
    const double rho = i % 3 == 0 ? random.real(0, 0.5) : random.real(1.5, 4) * (i % 5 == 0 ? 1e9 : 1);
    const double h = i % 3 == 0 ? random.real(0.6, 3) : std::exp2(random.real(-30, 2));
    const Vec3 normal = normalize(random.point(1) + Vec3{-2 * rho, 0, 3 * h});
    const Point point{rho, 0, -h};
    const auto irradiance = disk_irradiance(point, normal, {0, 0, 0}, {0, 0, 1}, 1);
    const double least = dot(-point, normal) - std::sqrt(normal.x * normal.x + normal.y * normal.y);
    if (least <= 0) continue;  // the horizon cuts it, or it is below
    const auto place = [&](Long a, Long b) {
      const Long angle = 2 * std::numbers::pi_v<Long> * b;
      return LongVector(a * std::cos(angle), a * std::sin(angle), 0);
    };
    const auto element = [](Long a, Long) { return 2 * std::numbers::pi_v<Long> * a; };
    const auto expected = static_cast<double>(by_area(point, normal, Vec3{0, 0, 1}, place, element, 12));
    const double most = of_whole_disk * DiskView(point, {0, 0, 0}, {0, 0, 1}, 1).solid_angle();
    wrong.add(!(std::abs(irradiance - expected) <= most), point, normal, irradiance, expected);
    ++checked;
  }
  CHECK(wrong == 0);
  CHECK(checked > 20);
  CHECK(disk_irradiance({0, 0, 0}, {0, 0, 1}, {5, 0, -2}, {1, 0, 1}, 1) == 0);
}

TEST_CASE("the irradiance by a disk that the horizon cuts is the integral over the part above it") {
  if (!long_double_judges()) return;
  Random random(11);
  WrongCases wrong(random);
  int checked = 0;
  for (int i = 0; i < 60; ++i) {
    // Also on the axis, close to it, close to the plane, and small.
    const double distance = i % 5 == 0 ? std::exp2(random.real(0, 24)) : random.real(0.5, 3);
    const double rho = i % 6 == 0 ? 0 : i % 6 == 1 ? std::exp2(random.real(-120, -10)) : distance;
    const double h = distance * random.real(0.1, 1);
    const Point point{rho, 0, -h};
    // The horizon meets the disk's plane at the distance `cut` from the center, across the direction `out`.
    const double angle = random.real(0, 2 * std::numbers::pi), cut = random.real(-0.9, 0.9);
    const Vec3 out{std::cos(angle), std::sin(angle), 0}, along{-out.y, out.x, 0};
    Vec3 normal = normalize(cross(along, cut * out - point));
    if (normal.x * out.x + normal.y * out.y < 0) normal = -normal;
    const Long x = -dot(normal, -point) / dot(normal, out), delta = std::acos(x);
    const auto place = [&](Long a, Long b) {
      const Long up = std::cos(delta * a), aside = std::sin(delta * a) * (2 * b - 1);
      return LongVector(up * out.x + aside * along.x, up * out.y + aside * along.y, 0);
    };
    const auto element = [&](Long a, Long) { return 2 * delta * std::sin(delta * a) * std::sin(delta * a); };
    const auto expected = static_cast<double>(by_area(point, normal, Vec3{0, 0, 1}, place, element, 12));
    const double irradiance = disk_irradiance(point, normal, {0, 0, 0}, {0, 0, 1}, 1);
    const double most = of_cut_disk * DiskView(point, {0, 0, 0}, {0, 0, 1}, 1).solid_angle();
    wrong.add(!(std::abs(irradiance - expected) <= most), point, normal, irradiance, expected);
    ++checked;
  }
  CHECK(wrong == 0);
  CHECK(checked == 60);
  CHECK(disk_irradiance({2, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {0, 0, 1}, 1) == 0);  // edge on
  // Edge on, and cut: three angles up to π cancel, each off by 2^-97 of itself.
  CHECK(disk_irradiance({2, 0, 0}, normalize(Vec3{-.1, 1, .1}), {0, 0, 0}, {0, 0, 1}, 1) < 0x1p-93);
}

TEST_CASE("a point on the rim of a disk, or within rounding of it, has a finite irradiance") {
  const Vec3 wall{-0.8, 0, 0.6}, axis{0, 0, 1};
  CHECK(disk_irradiance({1, 0, 0}, wall, {0, 0, 0}, axis, 1) == 0);
  CHECK(disk_irradiance({1, 0, 0}, {-1, 0, 0}, {0, 0, 0}, axis, 1) == 0);
  // Without care, the argument of a logarithm becomes 0 or negative, and its table is read outside.
  Random random(23);
  WrongCases wrong(random);
  for (int i = 0; i < 500; ++i) {
    const double h = std::exp2(random.real(-300, -40)), r = 1 + std::exp2(random.real(-120, -40));
    const Vec3 normal = normalize(random.point(1));
    const double turn = random.real(0, 6);
    const Point point{r * std::cos(turn), r * std::sin(turn), i % 3 == 0 ? 0 : h};
    const Point at_axis{0, i % 2 == 0 ? r : 1 - 0x1p-53, i % 3 == 0 ? -h : h};
    for (const Point& p : {point, at_axis}) {
      const double irradiance = disk_irradiance(p, normal, {0, 0, 0}, axis, 1);
      wrong.add(!(0 <= irradiance && irradiance <= (1 + of_cut_disk) * std::numbers::pi), p, normal,
                irradiance);
    }
  }
  CHECK(wrong == 0);
  // The horizon is parallel to the disk but for 1e-270.
  const double below =
      disk_irradiance({1, 1, 0.2}, {1, 0x1p-900, 0x1p-900}, {2, 0, 0.5}, {1e30, -1, -0.5}, 1e30);
  CHECK(std::abs(below / std::numbers::pi - 1) <= of_cut_disk);
}

TEST_CASE("irradiance above the horizon less that below is linear in the normal, for a disk in any place") {
  Random random(12);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const double size = std::exp2(random.real(-26, 2));
    const Point point = random.point(1);
    const Vec3 axis = random.direction();
    const auto net = [&](const Vec3& n) {
      return disk_irradiance(point, n, {0, 0, 0}, axis, size) -
             disk_irradiance(point, -n, {0, 0, 0}, axis, size);
    };
    const Vec3 all{net({1, 0, 0}), net({0, 1, 0}), net({0, 0, 1})};
    const Vec3 n =
        normalize(cross(random.direction(), point) + 0.5 * size * random.direction());  // often cut
    // Two numbers, and six with weights of √3 together in each of two signs.
    const double most =
        (2 + 2 * std::sqrt(3)) * of_cut_disk * DiskView(point, {0, 0, 0}, axis, size).solid_angle();
    wrong.add(!(std::abs(net(n) - dot(all, n)) <= most), point, axis, size, n, net(n), dot(all, n));
  }
  CHECK(wrong == 0);
}

TEST_CASE("the mean of light drawn by solid angle is the irradiance in closed form") {
  const Point point{0.1, 0.2, 0.3};
  const Vec3 normal = normalize(Vec3{0.3, -0.2, 1});
  const auto check = [&](const auto& view, double expected, double largest_error) {
    CAPTURE(expected);
    const auto sample = [&](double u, double v) { return view.sample(u, v); };
    check_mean(sample, normal, expected, 6, largest_error);
  };
  struct {
    Point center;
    double radius;
  } const spheres[] = {
      {{1, 2, 3}, 1}, {{1, 2, 0.1}, 1}, {{0.1, 0.2, 1.4}, 1.0999}, {{0.3, 0.2, -0.5}, 2}, {{1e6, 0, 1e6}, 3}};
  for (const auto& [center, radius] : spheres)
    check(SphereView(point, center, radius), sphere_irradiance(point, normal, center, radius), 2e-3);

  const std::array<std::array<Point, 3>, 4> triangles{{{{{1, 2, 3}, {2, 2, 1}, {1, -2, 4}}},
                                                       {{{1, 2, -3}, {2, 2, 1}, {1, -2, 4}}},
                                                       {{{-3, -2, 0.3001}, {3, -2, 0.3003}, {0, 4, 0.3002}}},
                                                       {{{1e4, 1, 1e4}, {1e4, 9, 1e4}, {1e4, 5, 1e4 + 3}}}}};
  for (const auto& [a, b, c] : triangles)
    check(TriangleView(point, a, b, c), triangle_irradiance(point, normal, a, b, c), 2e-3);

  const std::array<std::array<Vec3, 3>, 4> boards{{{{{1, 2, 3}, {2, 2, 1}, {1, -2, 2}}},   // a rectangle
                                                   {{{1, 2, -3}, {2, 2, 1}, {1, -2, 4}}},  // not one
                                                   {{{-3, -2, 0.3001}, {7, 0, 0}, {0, 5, 0}}},
                                                   {{{1, -3, -2}, {0, 5, 0}, {0, 0, 4}}}}};
  for (const auto& [p, u, v] : boards)
    check(ParallelogramView(point, p, u, v), parallelogram_irradiance(point, normal, p, u, v), 2e-3);

  for (const double height : {0.11, 2.0, 1e5}) {
    const Point center = point + height * normalize(Vec3{0.1, 0, 1});
    check(DiskView(point, center, {0.2, -0.2, 1}, 0.3),
          disk_irradiance(point, normal, center, {0.2, -0.2, 1}, 0.3), 2e-3);
  }

  double whole = 0;
  std::vector<TriangleCorners> corners;
  for (const auto& t : triangles) corners.push_back(t), whole += polygon_irradiance(point, normal, t);
  const MeshLight mesh(corners);
  const MeshView view(point, corners);
  check_mean([&](double u, double v) { return view.sample(u, v).light; }, normal, whole, 7, 0.01);
  corners.pop_back();
  const MeshLight near(corners);
  whole -= polygon_irradiance(point, normal, triangles[3]);
  check_mean([&](double u, double v) { return near.sample(point, u, v).light; }, normal, whole, 8, 0.02);
}

TEST_CASE("irradiance does not depend on the unit of length") {
  const Point point{0.1, 0.2, 0.3}, p{1, 2, 3}, q{2, 2, 1}, r{1, -2, -4};
  const Vec3 n{0.6, 0, 0.8};
  for (const double unit : {0x1p-390, 0x1p-40, 0x1p40, 0x1p390}) {
    CHECK(sphere_irradiance(unit * point, n, unit * q, unit) == sphere_irradiance(point, n, q, 1));
    CHECK(triangle_irradiance(unit * point, n, unit * p, unit * q, unit * r) ==
          triangle_irradiance(point, n, p, q, r));
    CHECK(disk_irradiance(unit * point, n, unit * p, q, unit) == disk_irradiance(point, n, p, q, 1));
  }
}

TEST_CASE("a point on the rim of a disk gets 0 with a normal of any length") {
  Random random(31);
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const double radius = random.real(0.5, 2), size = random.real(0.5, 2);
    const Vec3 normal = random.direction();
    const double got = disk_irradiance({radius, 0, 0}, normal, {0, 0, 0}, {0, size, 0}, radius);
    wrong.add(got != 0, normal, size, radius, got);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a sphere at any distance brings π (R/d)² cos θ, or 0 where that is below the range of double") {
  const Vec3 n{0.6, 0, 0.8}, sideways{0.8, 0, -0.6};
  for (int exponent = 1; exponent <= 2000; ++exponent) {
    CAPTURE(exponent);
    // From the distance 2^exponent radii; both are within 2^±1000.
    const double radius = std::ldexp(1, -exponent / 2), d = std::ldexp(1, exponent - exponent / 2);
    const double facing = std::ldexp(std::numbers::pi, -2 * exponent);
    const auto from = [&](const Vec3& direction) {
      return sphere_irradiance({0, 0, 0}, n, d * direction, radius);
    };
    // Below the normal numbers, sin² σ is rounded to a multiple of 2^-1074.
    const double error = 16 * 0x1p-53 * facing + 4 * 0x1p-1074;
    CHECK(std::abs(from(n) - facing) <= error);
    CHECK(std::abs(from({0, 0, 1}) - 0.8 * facing) <= error);
    // The half above the horizon brings less than sin σ times as much as one facing it.
    CHECK(from(sideways) >= 0);
    CHECK(from(sideways) <= std::ldexp(facing, -exponent) + error);
    CHECK(from(-n) == 0);
  }
}

// These values would differ between machines if functions of the C library took part.
TEST_CASE("irradiance has the same bits on every machine") {
  const Point point{0.1, 0.2, 0.3}, p{1, 2, 3}, q{2, 2, 1};
  const Vec3 n{0.6, 0, 0.8};
  CHECK(sphere_irradiance(point, n, p, 1) == 0x1.c6e890684cc8fp-3);
  CHECK(sphere_irradiance(point, n, {1, 2, 0}, 1) == 0x1.3541866aa2639p-3);
  CHECK(triangle_irradiance(point, n, p, q, {1, -2, 4}) == 0x1.912e541659b72p-2);
  CHECK(triangle_irradiance(point, n, p, q, {1, -2, -4}) == 0x1.a4fb8c5c6a7a4p-3);
  CHECK(disk_irradiance(point, n, p, {.3, .2, -1}, 1) == 0x1.1017bdfa32dc6p-3);
}
