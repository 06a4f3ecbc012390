// Rays that leave a mesh where it has edges and vertices: the rounded origin may be behind a neighbor.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <protostar/numeric/affine.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

MeshData octahedron() {
  return {
      .vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      .triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

/// The same triangles, every other of which turns the other way.
MeshData turned(MeshData data) {
  for (std::size_t i = 0; i < data.triangles.size(); i += 2)
    std::swap(data.triangles[i][0], data.triangles[i][1]);
  return data;
}

/// A ray that is aimed at an edge of a mesh, or if it may, in one of four cases at a vertex.
Ray aimed_at_border(Random& random, const MeshData& data, double scale, bool at_vertices) {
  const auto& corners = data.triangles[random.bits() % data.triangles.size()];
  const std::size_t i = random.bits() % 3;
  const Point p = data.vertices[corners[i]], q = data.vertices[corners[(i + 1) % 3]];
  const Point target = p + (at_vertices && random.bits() % 4 == 0 ? 0.0 : random.real(0, 1)) * (q - p);
  const Point origin = target + scale * random.real(0.5, 8) * random.direction();
  return {origin, target - origin};
}

/// How often a mesh was left outwards, and how often it was met again where it should not.
struct Left {
  int outwards = 0, again = 0;
  int odd = 0;  ///< those with an odd number of crossings ahead
};

/// Of rays that leave a surface of the mesh's shape at its borders. outwards(point) is on the outer side of
/// the surface there, and so are normals if need be turned.
template <Surface S>
Left left_at_borders(const S& surface, const MeshData& data, double scale, const auto& outwards,
                     const auto& may_be_met, bool at_vertices = true) {
  Scene<S> scene;
  scene.add(surface, Color{1});
  Random random(71);
  Left left;
  for (int i = 0; i < 1200; ++i) {
    const auto hit = scene.intersect(aimed_at_border(random, data, scale, at_vertices));
    const Vec3 direction = random.direction();
    const auto slope_at = [&](const Intersection& place) {
      const Vec3 normal = place.normal();
      return dot(normal, direction) * (dot(normal, outwards(place.point())) < 0 ? -1 : 1);
    };
    if (!hit || slope_at(*hit) <= 1e-6) continue;
    ++left.outwards;
    const Ray ray = hit->leave(direction);
    const auto again = scene.intersect(ray);
    if (again && !may_be_met(again->t / scale, slope_at(*again))) ++left.again;
    int crossings = 0;
    scene.crossings(ray, Interval{}, [&](const Intersection&) { ++crossings; });
    CHECK(again.has_value() == scene.occluded(ray, Interval{}));
    CHECK(again.has_value() == (crossings > 0));
    left.odd += crossings % 2;
  }
  return left;
}

const auto never = [](double, double) { return false; };

}  // namespace

TEST_CASE("a ray that leaves a convex mesh outwards at an edge or a vertex never meets it again") {
  const Vec3 middle{0.3, -0.2, 0.1};
  for (const MeshData& at_origin : {octahedron(), meshes::icosphere(2), turned(octahedron())})
    for (const double scale : {1.0, 0.7, 1e6}) {
      const MeshData data = meshes::moved(at_origin, scale, scale * middle);
      const auto outwards = [&](const Point& point) { return point - scale * middle; };
      const Left left = left_at_borders(Mesh(data, {.threads = 1}), data, scale, outwards, never);
      CHECK(left.outwards > 300);
      CHECK(left.again == 0);
    }
}

TEST_CASE("of the line of a ray that leaves a convex mesh, all is crossed but where it leaves") {
  const Mesh mesh(octahedron(), {.threads = 1});
  Scene<Mesh> scene;
  scene.add(mesh, Color{1});
  Random random(73);
  int left = 0, wrong = 0;
  for (int i = 0; i < 1000; ++i) {
    const Point origin = 3.0 * random.direction();
    const auto hit = scene.intersect({origin, random.point(0.5) - origin});
    const Vec3 direction = random.direction();
    if (!hit || std::abs(dot(hit->normal(), direction)) < 1e-3) continue;
    ++left;
    int ahead = 0, behind = 0;
    mesh.each_crossing(hit->leave(direction), {-infinity, infinity},
                       [&](const Crossing& crossing) { ++(crossing.t > 0 ? ahead : behind); });
    const bool is_outwards = dot(hit->normal(), direction) > 0;
    wrong += ahead != (is_outwards ? 0 : 1) || behind != (is_outwards ? 1 : 0);
  }
  CHECK(left > 500);
  CHECK(wrong == 0);
}

TEST_CASE("an instance of a mesh, and a solid made of one, are left as the mesh is") {
  const auto point_itself = [](const Point& point) { return point; };
  const MeshData data = octahedron();
  const Mesh mesh(data, {.threads = 1});
  const Instance<> instance(AnySurface(mesh), Affine{});
  const Csg solid = intersection_of({mesh, Sphere{.radius = 2}});
  for (const Left& left : {left_at_borders(instance, data, 1, point_itself, never),
                           left_at_borders(solid, data, 1, point_itself, never)}) {
    CHECK(left.outwards > 300);
    CHECK(left.again == 0);
  }
}

// A torus has valleys. There an origin may be rounded to behind the other side, which then is not met, and
// the ray comes out of the torus far away: it is in the dark either way.
TEST_CASE("what a ray meets at once that leaves a torus outwards at an edge or a vertex is a way in") {
  const double scale = 0.7;
  const Vec3 middle{0.2, -0.1, 0.1};
  const auto outwards = [&](const Point& point) {
    const Vec3 from_middle = point - middle, in_plane{from_middle.x, from_middle.y, 0};
    return from_middle - scale * normalize(in_plane);  // from the circle in the middle of the tube
  };
  const auto goes_in_or_is_far = [](double t, double slope) { return t > 1e-9 || slope < 0; };
  const MeshData data = meshes::moved(meshes::torus(24, 12), scale, middle);
  for (const bool all_turn_alike : {true, false}) {  // around a vertex, sides count
    const Mesh torus(all_turn_alike ? data : turned(data), {.threads = 1});
    const Left left = left_at_borders(torus, data, scale, outwards, goes_in_or_is_far, all_turn_alike);
    CHECK(left.outwards > 400);
    CHECK(left.again == 0);
    CHECK(left.odd < left.outwards / 100);  // of those, the ones that are behind the other side
  }
}

TEST_CASE("in a valley the other side is met, however near it is") {
  const Mesh valley(
      {.vertices = {{0, 0, 0}, {0, 4, 0}, {4, 2, 0}, {0, 2, 4}}, .triangles = {{0, 1, 2}, {1, 0, 3}}});
  Scene<Mesh> scene;
  scene.add(valley, Color{1});
  for (const double distance : {1.0, 1e-3, 1e-15, 1e-300}) {
    const auto hit = scene.intersect({{distance, 2, 5}, {0, 0, -1}});
    REQUIRE(hit);
    const auto again = scene.intersect(hit->leave({-1, 0.25, 0.5}));
    REQUIRE(again);
    CHECK(again->t == distance);
    CHECK(again->normal() == Vec3{-1, 0, 0} * (again->normal().x < 0 ? 1.0 : -1.0));
    CHECK_FALSE(scene.intersect(hit->leave({1, 0.25, 0.5})));
  }
}

TEST_CASE("sides of the plane through three points are exact") {
  Random random(72);
  int wrong = 0, on_it = 0;
  const auto whole = [&](int most) { return std::floor(random.real(-most, most + 1)); };
  const auto point = [&](int most) { return Point{whole(most), whole(most), whole(most)}; };
  const auto sign = [](double number) { return (number > 0) - (number < 0); };
  for (int i = 0; i < 6000; ++i) {
    // Up to 2^15, so that the determinant of differences is a whole number below 2^53.
    const int most = i % 2 == 0 ? 2 : 1 << 15;
    const Point a = point(most), b = point(most), c = point(most);
    Point other = point(most);
    if (i % 3 == 0) other = a + whole(2) * (b - a) + whole(2) * (c - a);  // in the plane
    const double exact = dot(cross(b - a, c - a), other - a);
    on_it += exact == 0;
    for (const double scale : {1.0, 0x1p-700, 0x1p600}) {
      const Vec3 far = scale * (other - a);
      wrong += side_of_point(scale * other, scale * a, scale * b, scale * c) != sign(exact);
      wrong += side_led_to(far, a, b, c) != sign(exact);
    }
  }
  CHECK(wrong == 0);
  CHECK(on_it > 1000);
  // What double cannot decide: planes through points that are nearly on one line, and numbers that are tiny.
  const Point a{0.1, 0.2, 0.3}, b{0.7, 0.8, 0.9};
  const Point c{0.4, 0.5, std::nextafter(0.6, 1.0)};
  CHECK(side_of_point({0.1, 0.3, 0.3}, a, b, c) == -1);
  CHECK(side_of_point(0.5 * (a + b), a, b, c) == 1);
  const double tiny = 0x1p-530;  // the normal is (0, 0, 1) of 2^-1060, and next to it what underflows
  const Point o{0}, p{tiny, 0, 0x1p-20 * tiny}, q{0, tiny, 0};
  CHECK(side_led_to({0x1p700, 0, 0x1.00001p680}, o, p, q) == 1);
  CHECK(side_led_to({0x1p700, 0, 0x1.fffffp679}, o, p, q) == -1);
}

TEST_CASE("what is crossed far away is crossed, also from a border and along the plane that is left") {
  // A floor, a wall through its plane, and a blade above it that has a corner of the floor.
  const MeshData data{.vertices = {{0, 0, 0},
                                   {4, 0, 0},
                                   {0, 4, 0},
                                   {2, -1, -1},
                                   {2, 5, -1},
                                   {2, 2, 3},
                                   {-6, -3, 1.5},
                                   {6, 3, 1.7},
                                   {6, -3, 1.5}},
                      .triangles = {{0, 1, 2}, {3, 4, 5}, {0, 8, 7}}};
  const Mesh mesh(data, {.threads = 1});
  const auto leaves_floor = [&](const Point& origin, const Vec3& direction) {
    return mesh.first_crossing({origin, direction, mesh.departure(0)}, Interval{});
  };
  const auto wall = leaves_floor({1, 1, 0}, {1, 0, 0});
  REQUIRE(wall);
  CHECK((wall->t == 1 && wall->part == 1));
  Random random(74);
  int met = 0, wrong = 0;
  for (int i = 0; i < 2000; ++i) {  // from the floor's edge opposite to the corner, rounded
    const double f = random.real(0.1, 0.9);
    const Ray ray{data.vertices[1] + f * (data.vertices[2] - data.vertices[1]),
                  Vec3{random.real(-0.3, 0.3), random.real(-0.3, 0.3), 1}, mesh.departure(0)};
    const auto blade = first_crossing(data.triangle(2), ray, Interval{});
    met += blade.has_value();
    int crossings = 0;
    mesh.each_crossing(ray, Interval{}, [&](const Crossing& crossing) { crossings += crossing.part == 2; });
    wrong += crossings != (blade ? 1 : 0);
  }
  CHECK(met > 500);
  CHECK(wrong == 0);
}
