#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <stdexcept>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a random vector whose components have so few digits that sums and small whole multiples are exact.
Vec3 short_vector(Random& random) { return 0x1p-20 * random.whole_vector(1 << 20); }

Vec3 exact_normal(const Parallelogram& s) { return cross(s.edge_u, s.edge_v); }

}  // namespace

TEST_CASE("a parallelogram is the points position + a·edge_u + b·edge_v with a and b from 0 to 1") {
  const Parallelogram square{.position = {1, 1, 3}, .edge_u = {2, 0, 0}, .edge_v = {0, 2, 0}};
  const Parallelogram oblique{.position = {0, 0, 2}, .edge_u = {4, 0, 0}, .edge_v = {2, 3, 2}};
  const Parallelogram far_off{.position = {5, 5, 3}, .edge_u = {2, 0, 0}, .edge_v = {0, 2, 0}};
  const auto along_z = [](double x, double y) { return Ray{{x, y, 0}, {0, 0, 1}}; };
  struct {
    const char* what;
    Parallelogram surface;
    Ray ray;
    Interval range;
    std::optional<double> expected;
  } const rows[] = {
      {"through the middle", square, along_z(2, 2), {}, 3},
      {"t in halves", square, {{2, 2, 0}, {0, 0, 0.5}}, {}, 6},
      {"from behind", square, {{2, 2, 5}, {0, 0, -1}}, {}, 2},
      {"away from it", square, {{2, 2, 5}, {0, 0, 1}}, {}, std::nullopt},
      {"away from it, in a range that reaches back", square, {{2, 2, 5}, {0, 0, 1}}, everywhere, -2},
      {"at the end of the range", square, along_z(2, 2), {0, 3}, std::nullopt},
      {"beside it", square, along_z(4, 2), {}, std::nullopt},
      {"on the other side", square, along_z(0, 2), {}, std::nullopt},
      {"above it", square, along_z(2, 4), {}, std::nullopt},
      {"below it", square, along_z(2, 0), {}, std::nullopt},
      {"its edge along u", square, along_z(2, 1), {}, 3},
      {"its edge along v", square, along_z(1, 2), {}, 3},
      {"the edge opposite to u", square, along_z(2, 3), {}, 3},
      {"the edge opposite to v", square, along_z(3, 2), {}, 3},
      {"next to the edge along u", square, along_z(2, 1 - ulp / 2), {}, std::nullopt},
      {"next to the edge along v", square, along_z(1 - ulp / 2, 2), {}, std::nullopt},
      {"next to the edge opposite to u", square, along_z(2, 3 + 2 * ulp), {}, std::nullopt},
      {"next to the edge opposite to v", square, along_z(3 + 2 * ulp, 2), {}, std::nullopt},
      {"further away, on the edge opposite to u", far_off, along_z(6, 7), {}, 3},
      {"further away, next to it", far_off, along_z(6, 7 + 4 * ulp), {}, std::nullopt},
      {"further away, on the edge opposite to v", far_off, along_z(7, 6), {}, 3},
      {"further away, next to it", far_off, along_z(7 + 4 * ulp, 6), {}, std::nullopt},
      {"position", square, along_z(1, 1), {}, 3},
      {"the vertex at the end of u", square, along_z(3, 1), {}, 3},
      {"the vertex at the end of v", square, along_z(1, 3), {}, 3},
      {"the opposite vertex", square, along_z(3, 3), {}, 3},
      {"parallel", square, {{2, 2, 0}, {1, 1, 0}}, everywhere, std::nullopt},
      {"in its plane", square, {{0, 2, 3}, {1, 0, 0}}, everywhere, std::nullopt},
      {"all but parallel", {{1, 1, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 2, -0x1p-60}, {2, 0, 0x1p-60}}, {}, 1},
      {"starting on it", square, {{2, 2, 3}, {0, 0, 1}}, everywhere, 0},
      {"reversed edges", {{3, 3, 3}, {-2, 0, 0}, {0, -2, 0}}, along_z(1, 3), {}, 3},
      {"exchanged edges", {{1, 1, 3}, {0, 2, 0}, {2, 0, 0}}, along_z(3, 1), {}, 3},
      {"oblique, inside", oblique, along_z(3, 1.5), {}, 3},
      {"oblique, on the slanted edge", oblique, along_z(1, 1.5), {}, 3},
      {"oblique, in its box and outside", oblique, along_z(0.5, 1.5), {}, std::nullopt},
      {"no area", {{1, 1, 3}, {2, 0, 0}, {4, 0, 0}}, along_z(2, 1), everywhere, std::nullopt},
      {"a point", {{1, 1, 3}, {0, 0, 0}, {0, 0, 0}}, along_z(1, 1), everywhere, std::nullopt},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK(row.surface.intersect(row.ray, row.range) == row.expected);
  }
}

TEST_CASE("hits of parallelograms with whole numbers, on their outlines too, are exact") {
  // All determinants are whole numbers that double holds, so plain signs decide.
  Random random(21);
  int hits = 0, outline = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 100000; ++i) {
    const Parallelogram s{random.whole_vector(3), random.whole_vector(3), random.whole_vector(3)};
    const Ray ray{random.whole_vector(3), random.whole_vector(3)};
    const Vec3 w = s.position - ray.origin, m = cross(w, ray.direction);
    const double S = dot(exact_normal(s), ray.direction), sign = S < 0 ? -1 : 1;
    const double a = sign * dot(s.edge_v, m), b = -sign * dot(s.edge_u, m), end = sign * S;
    const bool expected = S != 0 && 0 <= a && a <= end && 0 <= b && b <= end;
    const auto t = s.intersect(ray, everywhere);
    hits += expected;
    outline += expected && (a == 0 || a == end || b == 0 || b == end);
    wrong.add(t.has_value() != expected, s, ray);
    if (t && expected) wrong.add(*t != dot(exact_normal(s), w) / S, s, ray, w, S);
  }
  CHECK(hits > 5000);
  CHECK(outline > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("a ray to the shared edge of two parallelograms hits at least one of them") {
  // Rays to rounded points of the shared edge, away from its ends, where there is nothing else to hit.
  Random random(22);
  int both = 0;
  WrongCases none(random);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = short_vector(random), edge = short_vector(random), side = short_vector(random);
    const Parallelogram one{p, edge, side}, other{p, edge, -side};
    const Point origin = random.point(3);
    const Ray ray{origin, p + random.real(0.01, 0.99) * edge - origin};
    const bool first = one.intersect(ray).has_value(), second = other.intersect(ray).has_value();
    both += first && second;
    none.add(!first && !second, one, ray);
  }
  CHECK(both < 20000);
  CHECK(none == 0);
}

TEST_CASE("huge and tiny parallelograms are hit like others, and those that are not finite are not hit") {
  for (const double size : {0x1p-900, 0x1p-400, 0x1p-30, 1.0, 0x1p30, 0x1p400, 0x1p900}) {
    CAPTURE(size);
    const Parallelogram s{size * Point{1, 1, 3}, size * Vec3{2, 0, 1}, size * Vec3{0, 2, 1}};
    for (const double length : {0x1p-60, 1.0, 0x1p60}) {
      CHECK(s.intersect({Point{0}, length * Vec3{2, 2, 4}}) == size / length);
      CHECK_FALSE(s.intersect({Point{0}, length * Vec3{2, -2, 4}}));
      CHECK(s.intersect({Point{0}, length * Vec3{1, 1, 3}}) == size / length);  // a vertex
    }
  }
  const Parallelogram flat{{1, 1, 3}, {0x1p300, 0, 0}, {0, 0x1p-300, 0}};
  CHECK(flat.intersect({Point{0}, {7, 1, 3}}) == 1);
  CHECK_FALSE(flat.intersect({Point{0}, {7, 1 - ulp, 3}}));
  CHECK_FALSE(flat.intersect({Point{0}, {7, 1 + ulp, 3}}));

  const Parallelogram sound{{-1, -1, 3}, {2, 0, 0}, {0, 2, 0}};
  const Ray ray;
  REQUIRE(sound.intersect(ray));
  CHECK_FALSE(sound.intersect({{0, 0, 0}, {0, 0, 0}}, everywhere));
  for (const double bad : {infinity, -infinity, not_a_number})
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(bad, axis);
      Ray origin = ray, direction = ray;
      origin.origin[axis] = bad, direction.direction[axis] = bad;
      CHECK_FALSE(sound.intersect(origin, everywhere));
      CHECK_FALSE(sound.intersect(direction, everywhere));
      Parallelogram position = sound, u = sound, v = sound;
      position.position[axis] = bad, u.edge_u[axis] = bad, v.edge_v[axis] = bad;
      CHECK_FALSE(position.intersect(ray, everywhere));
      CHECK_FALSE(u.intersect(ray, everywhere));
      CHECK_FALSE(v.intersect(ray, everywhere));
    }
}

TEST_CASE("the normal of a parallelogram is the unit vector along edge_u × edge_v, whatever their lengths") {
  for (const double size : {1e-300, 1e-9, 1.0, 1e9, 1e300}) {
    CAPTURE(size);
    const Parallelogram s{.position = {1, 2, 3}, .edge_u = size * Vec3{2, -1, 0}, .edge_v = {3, 0, -1}};
    // With u = 2^-53, normalize is off by 4.5u (camera.cpp), and a quotient by a root by 2u.
    CHECK(length(s.normal_at(s.position) - Vec3{1, 2, 3} / std::sqrt(14)) <= 6.501 * 0x1p-53);
  }
  // Edges that are nearly parallel: in plain double, all digits of their product cancel.
  const Parallelogram thin{.edge_u = {1, 1 + ulp, 0}, .edge_v = {1 - ulp, 1, 0.1}};
  const Vec3 n = thin.normal_at(Point{0});
  CHECK(length(n - normalize(Vec3{1 + ulp, -1, 10 * ulp * ulp})) <= 9.001 * 0x1p-53);  // twice 4.5u
}

TEST_CASE("u and v are lengths along the edges, from position") {
  const Parallelogram s{.position = {1, 2, 3}, .edge_u = {0, 3, 4}, .edge_v = {2, 2, 1}};
  // With v = 2^-53, unit vectors are off by v in direction and 3.5v in length, and cross products of vectors
  // of the sine 0.745 by 2.83v of their factors. The vector to the point is shorter than |α| + |β|: α is off
  // by 5.2v of that and by 23v of itself.
  const auto is_near = [](const Uv& a, const Uv& b) {
    const double most = 28.2 * 0x1p-53 * (std::abs(b.x) + std::abs(b.y));
    return std::abs(a.x - b.x) <= most && std::abs(a.y - b.y) <= most;
  };
  CHECK(s.uv_at(s.position) == Uv{0, 0});
  CHECK(is_near(s.uv_at(s.position + s.edge_u), {5, 0}));
  CHECK(is_near(s.uv_at(s.position + s.edge_v), {0, 3}));
  CHECK(is_near(s.uv_at(s.position + 0.5 * s.edge_u + 0.25 * s.edge_v), {2.5, 0.75}));
  CHECK(is_near(s.uv_at(s.position - s.edge_u + 2.0 * s.edge_v), {-5, 6}));
  for (const double size : {1e-200, 1e200}) {
    const Parallelogram other{.edge_u = {size, 0, 0}, .edge_v = {0, 0, 2}};
    CHECK(other.uv_at({3, 0, 1}) == Uv{3, 1});
  }
}

TEST_CASE("the bounds of a parallelogram hold its vertices, and are tight") {
  Random random(23);
  WrongCases outside(random), loose(random);
  for (int i = 0; i < 5000; ++i) {
    const Parallelogram s{random.point(1e3), random.point(1e-3), random.point(1e3)};
    const auto [min, max] = s.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      // Sums of three doubles, without rounding.
      double least = infinity, most = -infinity;
      for (const double a : {0.0, 1.0})
        for (const double b : {0.0, 1.0}) {
          const ExactNumber vertex = ExactNumber(s.position[axis]) + ExactNumber(a * s.edge_u[axis]) +
                                     ExactNumber(b * s.edge_v[axis]);
          outside.add(
              (vertex - ExactNumber(min[axis])).sign() < 0 || (vertex - ExactNumber(max[axis])).sign() > 0,
              s);
          const double rounded = static_cast<double>(DoubleDouble(vertex));
          least = std::min(least, rounded), most = std::max(most, rounded);
        }
      // With u = 2^-53, each of two sums is rounded by u, and moved by 2u and its rounding: 4u of 1000 and of
      // 2000. The exact one is rounded by u.
      constexpr double off = (4 * 1000 + 4 * 2000 + 2000) * 1.001 * 0x1p-53;
      loose.add(!(max[axis] - most <= off && least - min[axis] <= off), s, least);
    }
  }
  CHECK(outside == 0);
  CHECK(loose == 0);
}

TEST_CASE("a ray that leaves a parallelogram never hits it again") {
  Random random(24);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Parallelogram s{random.point(2), random.point(5), random.point(5)};
    const Point origin = random.point(5);
    const Ray ray{origin, s.position + random.real(0, 1) * s.edge_u + random.real(0, 1) * s.edge_v - origin};
    const auto t = s.intersect(ray);
    if (!t) continue;
    ++hits;
    wrong.add(s.intersect({ray.at(*t), random.direction(), s.departure()}, everywhere).has_value(), s, ray);
  }
  CHECK(hits > 15000);
  CHECK(wrong == 0);
}

TEST_CASE("parallelograms of one plane have equal departures, and so has the plane") {
  Random random(25);
  int tilted = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    // The numbers have so few digits that b and the normals are exact.
    Parallelogram a{short_vector(random), short_vector(random), short_vector(random)};
    const int kind = static_cast<int>(random.bits() % 4);
    if (kind == 0) a.edge_u.y = a.edge_v.y = 0;
    if (kind == 1) a = {random.whole_vector(3), random.whole_vector(3), random.whole_vector(3)};
    if (kind == 2) a.edge_u = {1, -1, 0};
    if (exact_normal(a) == Vec3{0}) continue;
    const double j = static_cast<double>(random.whole(3)), k = static_cast<double>(random.whole(3));
    const Parallelogram b{a.position + j * a.edge_u + k * a.edge_v, a.edge_u + j * a.edge_v, -3.0 * a.edge_v};
    const Vec3 n = exact_normal(a);  // 42 binary digits
    const Plane plane{n, dot(n, a.position)};
    const bool is_exact = kind == 1 || a.position == Point{0};
    tilted += a.departure().kind == Departure::Kind::rounded_plane;
    wrong.add(a.departure() != b.departure() || b.departure() != a.departure(), a, b, plane);
    const Ray left{b.position, random.direction(), a.departure()};
    wrong.add(b.intersect(left, everywhere).has_value(), a, b, plane, left);
    if (!is_exact) continue;
    wrong.add(a.departure() != plane.departure() || plane.departure() != b.departure(), a, b, plane, left);
    wrong.add(plane.intersect(left, everywhere).has_value(), a, b, plane, left);
    wrong.add(a.intersect({b.position, random.direction(), plane.departure()}, everywhere).has_value(), a, b,
              plane, left);
  }
  CHECK(tilted > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("planes that differ by more than the rounding of their equations have different departures") {
  const Parallelogram s{.position = {0, 0.1, 0}, .edge_u = {0.3, 0, 0.7}, .edge_v = {-0.2, 0, 0.6}};
  const Plane same{.normal = {0, 1, 0}, .distance = 0.1}, reversed{{0, -3, 0}, -3 * 0.1};
  CHECK(s.departure() == same.departure());
  CHECK(s.departure() != Plane{.normal = {0, 1, 0}, .distance = 0.1 + ulp / 8}.departure());
  CHECK(s.departure() != reversed.departure());  // 3 · 0.1 is rounded
  CHECK(s.departure() != Plane{.normal = {0x1p-60, 1, 0}, .distance = 0.1}.departure());

  const Parallelogram tilted{.position = {1, 0, 2}, .edge_u = {2, -1, 0}, .edge_v = {-3, 0, 1}};
  CHECK(tilted.departure() == Plane{{1, 2, 3}, 7}.departure());
  CHECK(tilted.departure() == Plane{{-3, -6, -9}, -21}.departure());
  CHECK(tilted.departure() != Plane{{1, 2, 3}, 7 + 8 * ulp}.departure());
  CHECK(tilted.departure() != Plane{{1, 2 + 4 * ulp, 3}, 7}.departure());
  for (const double off : {-4 * ulp, 4 * ulp}) {
    Parallelogram other = tilted;
    other.position.z += off;
    CHECK(other.departure() != tilted.departure());
    other = tilted;
    other.edge_u.y += off;
    CHECK(other.departure() != tilted.departure());
    CHECK(other.intersect({{2, 3, 0}, {-0.75, -3.5, 2.25}, tilted.departure()}));
  }
  const Departure sphere{.kind = Departure::Kind::sphere, .geometry = tilted.departure().geometry};
  CHECK(tilted.departure() != sphere);
  CHECK(tilted.intersect({Point{0}, {0, -0.5, 2.5}, sphere}));
}

TEST_CASE("the equation of a plane is rounded to nearest, in double-double as in exact arithmetic") {
  Random random(26);
  int undecided = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 3000; ++i) {
    const Point p = random.point(1);
    const Vec3 u = random.point(1), v = i % 3 == 0 ? u + 1e-9 * random.point(1) : random.point(1);
    const auto refined = detail::refined_plane_at(p, cross_product(u, v), 0x1p-100);
    const ExactVector n = cross(exact_vector(u), exact_vector(v));
    undecided += !refined;
    wrong.add(refined && *refined != detail::nearest_plane(n, dot(n, exact_vector(p))), p, u);
  }
  CHECK(undecided < 10);
  CHECK(wrong == 0);

  // Quotients next to the midpoint of two doubles, and at it.
  const ExactNumber one(1.0), hair(0x1p-200);
  for (const double q : {1.0, 1 + ulp, 1 + 2 * ulp}) {
    const ExactNumber middle = ExactNumber(q) + ExactNumber(ulp / 2);
    const double up = q + ulp, even = q == 1 + ulp ? up : q;
    CHECK(detail::nearest_quotient(middle - hair, one) == q);
    CHECK(detail::nearest_quotient(middle + hair, one) == up);
    CHECK(detail::nearest_quotient(middle, one) == even);
    CHECK(detail::nearest_quotient(-middle, one) == -even);
    CHECK(detail::nearest_quotient(-middle - hair, one) == -up);
    CHECK(detail::nearest_quotient(hair - middle, -one) == q);
  }
  CHECK(detail::nearest_quotient(ExactNumber(), one) == 0);
  // At the largest double, above which 2^1024 would be next.
  const double most = std::numeric_limits<double>::max();
  const ExactNumber largest(most), tie = largest + ExactNumber(0x1p970);
  for (const ExactNumber& quotient : {largest, tie - hair, largest - ExactNumber(0x1p969)}) {
    CHECK(detail::nearest_quotient(quotient, one) == most);
    CHECK(detail::nearest_quotient(quotient, -one) == -most);
  }
  for (const ExactNumber& quotient : {tie, tie + hair, largest * largest}) {
    CHECK(detail::nearest_quotient(quotient, one) == infinity);
    CHECK(detail::nearest_quotient(-quotient, one) == -infinity);
  }
  WrongCases off(random);
  for (int i = 0; i < 3000; ++i) {
    const double leading = random.real(1, 2), more = random.real(-1, 1), last = random.real(-1, 1);
    const ExactNumber M = ExactNumber(leading) + ExactNumber(0x1p-60 * more) + ExactNumber(0x1p-120 * last);
    off.add(detail::nearest_quotient((ExactNumber(1 + ulp) + ExactNumber(ulp / 2)) * M, M) != 1 + 2 * ulp, i);
  }
  CHECK(off == 0);
}

namespace {

using BoardsAndFloors = Scene<Parallelogram, Plane>;

/// Returns the picture drawn by tiles, and drawn ray by ray.
std::vector<Image> pictures_of(const BoardsAndFloors& scene, const Camera& camera) {
  std::vector<Image> pictures(2, Image(96, 64));
  render(pictures[0], camera, scene, ShadowIntegrator{});
  render(pictures[1], camera, scene, ShadowIntegrator{}, {.tiles = false});
  return pictures;
}

/// Number of pixels that show a surface, and of those among them that differ from the light that falls there
/// without any shadow.
struct LitPixels {
  int lit = 0;
  WrongCases wrong;
};
LitPixels count_shadowed(const BoardsAndFloors& scene, const Camera& camera) {
  LitPixels tally;
  for (const Image& picture : pictures_of(scene, camera))
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x) {
        const auto hit = scene.intersect(camera.through_pixel(x, y, picture.width(), picture.height()));
        if (!hit) continue;
        const Color light = scene.lights()[0].irradiance(hit->point(), hit->facing_normal());
        ++tally.lit;
        tally.wrong.add(picture(x, y) != hit->color() * light || light == Color{0}, "pixel", x, y, "is",
                        picture(x, y), "in light", light);
      }
  return tally;
}

}  // namespace

TEST_CASE("a board that lies on a floor shows no acne, and neither does the floor") {
  const Color gray{0.5f}, red{0.8f, 0.1f, 0.1f};
  const Camera camera;
  SECTION("level") {
    for (const double height : {-0.1, -0.3, -1.1, -1e-3, -100.1}) {
      CAPTURE(height);
      const double s = -height;
      BoardsAndFloors scene;
      scene.add(Plane{.normal = {0, 1, 0}, .distance = height}, gray);
      scene.add(Parallelogram{{-1 * s, height, 2 * s}, {1.7 * s, 0, 0.3 * s}, {-0.4 * s, 0, 1.9 * s}}, red);
      scene.add(Parallelogram{{-0.5 * s, height, 2.5 * s}, {0, 0, 3 * s}, {2.3 * s, 0, 0}}, gray);
      scene.add(PointLight{.position = {0.7 * s, 3 * s, s}, .power = Color{static_cast<float>(300 * s * s)}});
      const LitPixels tally = count_shadowed(scene, camera);
      CHECK(tally.lit > 5000);
      CHECK(tally.wrong == 0);
    }
  }
  SECTION("tilted") {
    // All lie in the plane x + 8y − 2z = −14, or in a multiple of its equation. The products 0.7 · 2 and
    // 0.3 · 4 are exact.
    const Vec3 across{2, 0, 1}, ahead{0, 1, 4};
    BoardsAndFloors scene;
    scene.add(Plane{.normal = {-3, -24, 6}, .distance = 42}, gray);
    scene.add(Parallelogram{{-2, -1, 2}, 0.7 * across, 0.3 * ahead}, red);
    scene.add(Parallelogram{Point{-2, -1, 2} + 0.25 * across, 0.1 * ahead, 1.1 * across}, gray);
    scene.add(PointLight{.position = {0.7, 3, 1}, .power = Color{300}});
    const LitPixels tally = count_shadowed(scene, camera);
    CHECK(tally.lit > 5000);
    CHECK(tally.wrong == 0);
  }
  SECTION("tilted anyhow, on another board") {
    Random random(27);
    for (int i = 0; i < 10; ++i) {
      const Point p = Point{-2, -1, 1.5} + 0.25 * short_vector(random);
      const Vec3 u = Vec3{4, 0, 0} + 0.25 * short_vector(random),
                 v = Vec3{0, 0, 4} + 0.25 * short_vector(random);
      BoardsAndFloors scene;
      scene.add(Parallelogram{p + 0.25 * u + 0.125 * v, 0.5 * u, 0.25 * v + 0.25 * u}, red);
      scene.add(Parallelogram{p + 0.5 * v, u, -0.25 * v}, red);
      scene.add(Parallelogram{p, u, v}, gray);
      scene.add(PointLight{.position = {0.7, 3, 1}, .power = Color{300}});
      const LitPixels tally = count_shadowed(scene, camera);
      CHECK(tally.lit > 1000);
      CHECK(tally.wrong == 0);
    }
  }
}

TEST_CASE("a board on a floor, in the floor's color, changes no shadow that falls on both") {
  const Color gray{0.5f};
  const Plane floor{.normal = {0, 1, 0}, .distance = -1.1};
  const Parallelogram board{{-1, -1.1, 2}, {1.7, 0, 0.3}, {-0.4, 0, 1.9}};
  const Parallelogram above{{-0.5, 0.1, 2.2}, {1, 0.3, 0}, {0.2, -0.1, 1}};
  const PointLight light{.position = {0.3, 3, 2}, .power = Color{300}};
  BoardsAndFloors without, with;
  for (auto* scene : {&without, &with}) scene->add(floor, gray), scene->add(above, gray), scene->add(light);
  with.add(board, gray);
  const auto expected = pictures_of(without, Camera{}), found = pictures_of(with, Camera{});
  int dark = 0;
  WrongCases wrong;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (int y = 0; y < found[i].height(); ++y)
      for (int x = 0; x < found[i].width(); ++x) {
        // The other surface rounds t, and hence the point, differently: by 2^-30 of the way of at most 8.
        // Light from distances of 2 and more changes by 3/2 of that, and floats are rounded four times.
        const float difference = found[i](x, y).r - expected[0](x, y).r;
        wrong.add(!(std::abs(difference) <= (8 * 1.5f * 0x1p-30f + 0x1p-22f) * expected[0](x, y).r), floor,
                  board, above, difference);
        dark += y > 32 && expected[0](x, y).r == 0;
      }
  CHECK(dark > 150);
  CHECK(wrong == 0);
}

TEST_CASE("an invalid parallelogram is refused with the field's name") {
  const auto says = [](const Parallelogram& s) {
    return message_of<std::invalid_argument>([&] { s.validate(); });
  };
  for (const Vec3& bad : {Vec3{0, not_a_number, 0}, Vec3{0, infinity, 0}, Vec3{-infinity, 1, 0}}) {
    CHECK_THAT(says({.position = bad}), ContainsSubstring("Parallelogram: position"));
    CHECK_THAT(says({.edge_u = bad}), ContainsSubstring("Parallelogram: edge_u"));
    CHECK_THAT(says({.edge_v = bad}), ContainsSubstring("edge_v"));
  }
  const Vec3 u{0.1, 0.7, -0.3};
  for (const Vec3& parallel : {Vec3{0}, u, -u, 4.0 * u, 0x1p-900 * u})
    CHECK_THAT(says({.edge_u = u, .edge_v = parallel}), ContainsSubstring("must not be 0 or parallel"));
  CHECK_THAT(says({.edge_u = Vec3{0}}), ContainsSubstring("must not be 0 or parallel"));
  CHECK_NOTHROW(Parallelogram{}.validate());
  CHECK_NOTHROW(Parallelogram{.edge_u = u, .edge_v = {0.1, 0.7, std::nextafter(-0.3, 0)}}.validate());
  CHECK_NOTHROW(Parallelogram{.edge_u = {0, 0x1p-400, 0}, .edge_v = {0x1p400, 0, 0}}.validate());
  CHECK_THAT(says({.position = {0, 1e121, 0}}),
             ContainsSubstring("position must have numbers at most 2^400"));
  CHECK_THAT(says({.edge_u = {1e-121, 0, 0}}),
             ContainsSubstring("edge_v must have largest components from 2^-400"));
}
