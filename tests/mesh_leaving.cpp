// Rays that leave a mesh at edges and vertices, where the rounded origin may be behind a neighboring
// triangle.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <protostar/accel/accelerate.hpp>
#include <protostar/numeric/affine.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <utility>
#include <vector>

#include "stress/exact.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

MeshData octahedron() {
  return {
      .vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      .triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

/// Returns a mesh with the orientation of every other triangle reversed.
MeshData turned(MeshData data) {
  for (std::size_t i = 0; i < data.triangles.size(); i += 2)
    std::swap(data.triangles[i][0], data.triangles[i][1]);
  return data;
}

/// Returns a ray that is aimed at an edge of a mesh, or if at_vertices, in one of four cases at a vertex.
Ray aimed_at_border(Random& random, const MeshData& data, double scale, bool at_vertices) {
  const auto& corners = data.triangles[random.bits() % data.triangles.size()];
  const std::size_t i = random.bits() % 3;
  const Point p = data.vertices[corners[i]], q = data.vertices[corners[(i + 1) % 3]];
  const Point target = p + (at_vertices && random.bits() % 4 == 0 ? 0.0 : random.real(0, 1)) * (q - p);
  const Point origin = target + scale * random.real(0.5, 8) * random.direction();
  return {origin, target - origin};
}

/// Number of rays that left a mesh outwards, those of them that wrongly hit it again, and those with an odd
/// number of crossings ahead.
struct Left {
  int outwards = 0;
  WrongCases again, odd;
};

/// Counts rays that leave a surface of the mesh's shape at its edges and vertices. outwards(point) leads to
/// the outer side of the surface there, to which normals are turned. may_be_hit(t / scale, slope) tells
/// whether a hit is allowed.
template <Surface S>
Left left_at_borders(const S& surface, const MeshData& data, double scale, const auto& outwards,
                     const auto& may_be_hit, bool at_vertices = true) {
  Scene<S> scene;
  scene.add(surface, Color{1});
  Random random(71);
  Left left{.outwards = 0, .again = WrongCases(random), .odd = WrongCases(random)};
  for (int i = 0; i < cases(300, 1200, 1200); ++i) {
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
    left.again.add(again && !may_be_hit(again->t / scale, slope_at(*again)), ray);
    int crossings = 0;
    scene.crossings(ray, Interval{}, [&](const Intersection&) { ++crossings; });
    CHECK(again.has_value() == scene.occluded(ray, Interval{}));
    CHECK(again.has_value() == (crossings > 0));
    left.odd.add(crossings % 2 != 0, ray);
  }
  return left;
}

const auto never = [](double, double) { return false; };

}  // namespace

TEST_CASE("a ray that leaves a convex mesh outwards at an edge or a vertex never hits it again") {
  const Vec3 middle{0.3, -0.2, 0.1};
  for (const MeshData& at_origin : {octahedron(), meshes::icosphere(2), turned(octahedron())})
    for (const double scale : {1.0, 0.7, 1e6}) {
      const MeshData data = meshes::moved(at_origin, scale, scale * middle);
      const auto outwards = [&](const Point& point) { return point - scale * middle; };
      const Left left = left_at_borders(Mesh(data, {.threads = 1}), data, scale, outwards, never);
      CHECK(left.outwards > cases(60, 300, 300));
      CHECK(left.again == 0);
    }
}

TEST_CASE("the line of a ray that leaves a convex mesh crosses it only on the other side") {
  const Mesh mesh(octahedron(), {.threads = 1});
  Scene<Mesh> scene;
  scene.add(mesh, Color{1});
  Random random(73);
  int left = 0;
  WrongCases wrong(random);
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
    wrong.add(ahead != (is_outwards ? 0 : 1) || behind != (is_outwards ? 1 : 0), origin, direction);
  }
  CHECK(left > 500);
  CHECK(wrong == 0);
}

TEST_CASE(
    "rays that leave an instance of a convex mesh outwards, or a solid made of it, never hit it again") {
  const auto point_itself = [](const Point& point) { return point; };
  const MeshData data = octahedron();
  const Mesh mesh(data, {.threads = 1});
  const Instance<> instance(AnySurface(mesh), Affine{});
  const Csg solid = intersection_of({mesh, Sphere{.radius = 2}});
  for (const Left& left : {left_at_borders(instance, data, 1, point_itself, never),
                           left_at_borders(solid, data, 1, point_itself, never)}) {
    CHECK(left.outwards > cases(60, 300, 300));
    CHECK(left.again == 0);
  }
}

TEST_CASE(
    "a ray that leaves a torus outwards at an edge or a vertex next enters it, and leaves it as often as it "
    "enters") {
  const double scale = 0.7;
  const Vec3 middle{0.2, -0.1, 0.1};
  const auto outwards = [&](const Point& point) {
    const Vec3 from_middle = point - middle, in_plane{from_middle.x, from_middle.y, 0};
    return from_middle - scale * normalize(in_plane);  // from the circle in the middle of the tube
  };
  const auto goes_in = [](double, double slope) { return slope < 0; };
  const MeshData data = meshes::moved(meshes::torus(24, 12), scale, middle);
  for (const MeshData& one : {data, turned(data)}) {
    const Left left = left_at_borders(Mesh(one, {.threads = 1}), data, scale, outwards, goes_in);
    CHECK(left.outwards > cases(100, 400, 400));
    CHECK(left.again == 0);
    CHECK(left.odd == 0);
  }
}

TEST_CASE("a ray that leaves one side of a valley hits the other, however near it is") {
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

namespace {

/// Returns the sign of the dot product of a direction with (b − a) × (c − a), without rounding.
int side_led_to(const Vec3& direction, const Triangle& triangle) {
  using exact::Number;
  const auto difference = [&](const Point& p, int i) { return Number(p[i]) - Number(triangle.a[i]); };
  Number sum;
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    sum = sum + Number(direction[i]) * (difference(triangle.b, k) * difference(triangle.c, l) -
                                        difference(triangle.b, l) * difference(triangle.c, k));
  }
  return sum.sign();
}

/// Returns a mesh rotated so that no plane is at a right angle to an axis.
MeshData tilted(MeshData data) {
  const Affine turn = Affine{}.rotated_about({1, 2, 3}, 40);
  for (Point& p : data.vertices) p = turn.x * p.x + turn.y * p.y + turn.z * p.z;
  return data;
}

/// Returns pyramids on the faces of an icosahedron, with a sharp valley between neighbors.
MeshData star() {
  MeshData data = meshes::icosphere(0);
  const auto faces = std::exchange(data.triangles, {});
  for (const auto& [a, b, c] : faces) {
    const auto tip = static_cast<std::uint32_t>(data.vertices.size());
    data.vertices.push_back(0.9 * (data.vertices[a] + data.vertices[b] + data.vertices[c]));
    for (const auto& side : {std::array{a, b, tip}, {b, c, tip}, {c, a, tip}}) data.triangles.push_back(side);
  }
  return data;
}

/// Returns a mesh turned inside out: a room.
MeshData inside_out(MeshData data) {
  for (auto& triangle : data.triangles) std::swap(triangle[0], triangle[1]);
  return data;
}

/// Returns two slopes down to the y axis.
MeshData trench() {
  return {.vertices = {{0, -1, 0}, {0, 1, 0}, {1, 1, 1}, {1, -1, 1}, {-1, 1, 1}, {-1, -1, 1}},
          .triangles = {{0, 3, 2}, {0, 2, 1}, {0, 1, 4}, {0, 4, 5}}};
}

/// Returns a direction from a triangle: any, or one along it up to a normal component of 2^-k with k <
/// flattest.
Vec3 direction_from(Random& random, const Triangle& triangle, unsigned flattest) {
  if (random.bits() % 2 == 0) return random.direction();
  const double steep = std::ldexp(1, -static_cast<int>(random.bits() % flattest));
  return random.real(-1, 1) * (triangle.b - triangle.a) + random.real(-1, 1) * (triangle.c - triangle.a) +
         steep * triangle.normal_at(triangle.a);
}

/// Counts rays that leave a closed mesh at its edges and vertices and then do not cross it alternately in and
/// out until they are outside. A solid made of it has the same crossings, and may name another of the
/// triangles that join there.
template <Surface S>
WrongCases disordered(const S& surface, const MeshData& data, bool is_room, Random& random, int& left) {
  WrongCases wrong(random);
  const auto side = [&](const Vec3& direction, int primitive) {
    return side_led_to(direction, data.triangle(static_cast<std::size_t>(primitive))) * (is_room ? -1 : 1);
  };
  for (int i = 0; i < cases(60, 250, 1000); ++i) {
    const Ray ray = aimed_at_border(random, data, 1, true);
    const auto hit = first_crossing(surface, ray, Interval{});
    if (!hit) continue;
    const Triangle triangle = data.triangle(static_cast<std::size_t>(hit->primitive));
    const Point point = ray.at(hit->t);
    const Ray to_border = aimed_at_border(random, data, 1, true);
    const Vec3 direction =
        random.bits() % 2 == 0 ? direction_from(random, triangle, 70) : to_border.at(1) - point;
    const int from = side(direction, hit->primitive);
    if (from == 0) continue;
    ++left;
    const Ray leaving{point, direction, departure_of(surface, hit->primitive)};
    std::vector<Crossing> crossings;
    each_crossing(surface, leaving, Interval{},
                  [&](const Crossing& crossing) { crossings.push_back(crossing); });
    bool is_wrong = (crossings.size() % 2 != 0) != (from < 0);
    if constexpr (std::same_as<S, Mesh>) {
      int inside = from < 0 ? 1 : 0;
      for (std::size_t k = 0; k < crossings.size(); ++k) {
        is_wrong |= inside != 0 && inside != 1;
        inside -= side(direction, crossings[k].primitive);
      }
      is_wrong |= inside != 0;
      const auto first = surface.first_crossing(leaving, {});
      is_wrong |=
          first ? crossings.empty() || first->primitive != crossings[0].primitive : !crossings.empty();
      is_wrong |= surface.any_hit(leaving, {}) == crossings.empty();
    }
    wrong.add(is_wrong, leaving, "primitive", hit->primitive);
  }
  return wrong;
}

}  // namespace

TEST_CASE("rays that leave a closed mesh next to edges and vertices cross it alternately in and out") {
  Random random(75);
  const struct {
    MeshData data;
    bool is_room;
  } rows[] = {{star(), false},
              {tilted(meshes::box(1)), false},
              {inside_out(meshes::box(1)), true},
              {inside_out(tilted(meshes::box(1))), true},
              {tilted(meshes::torus(12, 7)), false},
              {inside_out(star()), true}};
  int left = 0;
  for (const auto& row : rows)
    for (const double far : {0.0, 1.0, 1e5}) {
      CAPTURE(&row - rows, far);
      const MeshData data = meshes::moved(row.data, 1, far * Vec3{0.3, -0.7, 0.2});
      const Mesh mesh(data, {.threads = 1});
      REQUIRE(mesh.is_solid());
      CHECK(disordered(mesh, data, row.is_room, random, left) == 0);
      const Sphere around{.center = far * Point{0.3, -0.7, 0.2}, .radius = 100};
      CHECK(disordered(intersection_of({mesh, around}), data, row.is_room, random, left) == 0);
    }
  CHECK(left > cases(1'000, 5'000, 20'000));
}

TEST_CASE("rays from next to the bottom of a valley hit its other side if they lead there, and only then") {
  Random random(76);
  int left = 0;
  WrongCases wrong(random);
  for (const MeshData& at_origin : {trench(), tilted(trench())})
    for (const double far : {0.0, 1.0, 1e5}) {
      const MeshData data = meshes::moved(at_origin, 1, far * Vec3{0.3, -0.7, 0.2});
      const Mesh mesh(data, {.threads = 1});
      const Vec3 along = data.vertices[1] - data.vertices[0],
                 up = data.vertices[2] + data.vertices[4] - 2.0 * data.vertices[1];
      for (int i = 0; i < cases(600, 3000, 3000); ++i) {
        const Point target = data.vertices[0] + random.real(0.3, 0.7) * along;
        const Point origin = target + up + 0.9 * random.direction();
        const Ray ray{origin, target - origin};
        const auto hit = mesh.first_crossing(ray, {});
        if (!hit) continue;  // it has passed along the edge, and hits neither side
        const Triangle from = data.triangle(static_cast<std::size_t>(hit->primitive)),
                       other = data.triangle(hit->primitive < 2 ? 2u : 0u);
        const Vec3 direction =
            direction_from(random, from, 30);  // the two triangles of a side are coplanar to 2^-36
        // Takes directions to the upper side of `from`. The other triangle is hit if they lead to its lower
        // side.
        if (std::abs(dot(normalize(direction), normalize(along))) > 0.9 || side_led_to(direction, from) <= 0)
          continue;
        ++left;
        const Ray leaving{ray.at(hit->t), direction, mesh.departure(hit->primitive)};
        wrong.add(mesh.any_hit(leaving, {}) != (side_led_to(direction, other) < 0), from, ray, leaving,
                  direction);
        const auto next = mesh.first_crossing(leaving, {});
        wrong.add(next.has_value() != (side_led_to(direction, other) < 0), from, ray, leaving, direction);
        wrong.add(next && (next->primitive < 2) == (hit->primitive < 2), from, ray, leaving);
        wrong.add(next && !(next->t > 0), from, ray, leaving);
      }
    }
  CHECK(left > cases(600, 4000, 4000));
  CHECK(wrong == 0);
}

TEST_CASE(
    "triangles far from the origin are hit, also by rays from a border or along the plane that is left") {
  // A floor, a wall through its plane, and a blade above it that shares a corner with it.
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
  CHECK((wall->t == 1 && wall->primitive == 1));
  Random random(74);
  int met = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {  // from the floor's edge opposite to the corner, rounded
    const double f = random.real(0.1, 0.9);
    const Ray ray{data.vertices[1] + f * (data.vertices[2] - data.vertices[1]),
                  Vec3{random.real(-0.3, 0.3), random.real(-0.3, 0.3), 1}, mesh.departure(0)};
    const auto blade = first_crossing(data.triangle(2), ray, Interval{});
    met += blade.has_value();
    int crossings = 0;
    mesh.each_crossing(ray, Interval{},
                       [&](const Crossing& crossing) { crossings += crossing.primitive == 2; });
    wrong.add(crossings != (blade ? 1 : 0), ray);
  }
  CHECK(met > 500);
  CHECK(wrong == 0);
}

TEST_CASE(
    "an accelerated scene finds the hits of rays from a mesh's border, also if the origin is rounded off the "
    "mesh") {
  // Two trenches along the x axis: one ends at the x where the other begins, in the middle of the scene. The
  // origin is beyond the border by the possible error of t for a ray from a few times the trench's size away.
  const auto trench_at = [](double x, double y) {
    return Mesh(
        meshes::moved({.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 1}, {1, -1, 1}, {0, -1, 1}},
                       .triangles = {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {0, 5, 4}}},
                      1, {x, y, 0}),
        {.threads = 1});
  };
  Scene<Mesh> plain;
  plain.add(trench_at(-1, 4), Color{1});
  plain.add(trench_at(0, 0), Color{0.5f});
  const auto fast = accelerate(plain, {.threads = 1});
  const Mesh& mesh = plain.surfaces<Mesh>()[1];
  Ray ray{{-0x1p-28, 0.5, 0.5}, {0, -1, 0}, mesh.departure(1)};
  ray.departure.surface = &mesh;  // as Intersection::leave sets it
  for (const auto& hit : {plain.intersect(ray), fast.intersect(ray)}) {
    REQUIRE(hit);
    CHECK(hit->t == 1);
    CHECK(hit->color() == Color{0.5f});
  }
  CHECK(plain.occluded(ray, {}));
  CHECK(fast.occluded(ray, {}));
}

TEST_CASE(
    "rays from a mesh hit a triangle and a board in its plane at equal t, and the earlier surface is the "
    "closest hit") {
  // A slope, and a board in its plane, both exact in double; the ray leaves the ground.
  const Mesh mesh({.vertices = {{-8, -8, 0.3}, {8, -8, -0.2}, {0, 9, 0.1}, {-6, 7, 1}, {6, 7, 1}, {0, 10, 7}},
                   .triangles = {{0, 1, 2}, {3, 4, 5}}},
                  {.threads = 1});
  const Parallelogram board{.position = {-6, 7, 1}, .edge_u = {12, 0, 0}, .edge_v = {0, 3, 6}};
  Scene<Mesh, Parallelogram> mesh_first;
  Scene<Parallelogram, Mesh> board_first;
  mesh_first.add(mesh, Color{0}), mesh_first.add(board, Color{1});
  board_first.add(board, Color{1}), board_first.add(mesh, Color{0});
  Random random(77);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const Point eye = random.point(1) + Vec3{0, -3, 4}, seen{random.real(-2, 2), random.real(-4, 2), 0};
    const auto hit = mesh_first.intersect({eye, seen - eye});
    REQUIRE(hit);
    const Point target =
        Point{0, 8, 3} + random.real(-1, 1) * Vec3{2, 0, 0} + random.real(-0.3, 0.3) * Vec3{0, 1, 2};
    const Ray ray = hit->leave(target - hit->point());
    const auto one = mesh_first.intersect(ray), other = board_first.intersect(ray);
    wrong.add(!one || one->color() != Color{0} || !other || other->color() != Color{1}, board, ray);
  }
  CHECK(wrong == 0);
}

TEST_CASE(
    "a ray that leaves a triangle of a mesh does not cross others that overlap it in its plane, ahead or "
    "behind") {
  // A triangle, its reverse, one that overlaps it in its plane, and one that passes through it.
  const Mesh mesh({.vertices = {{0, 0, 0}, {4, 1, 2}, {1, 3, 5}, {8, 2, 4}, {2, 1, -9}, {2, 1, 9}, {1, 9, 2}},
                   .triangles = {{0, 1, 2}, {2, 1, 0}, {0, 3, 2}, {4, 5, 6}}},
                  {.threads = 1});
  Random random(78);
  for (int i = 0; i < 100; ++i) {
    const double u = random.real(0.2, 0.4), v = random.real(0.2, 0.4);
    const Point place = u * Point{4, 1, 2} + v * Point{1, 3, 5};
    for (int primitive = 0; primitive < 3; ++primitive) {
      WrongCases on_plane(random);
      mesh.each_crossing({place, random.direction(), mesh.departure(primitive)}, {-infinity, infinity},
                         [&](const Crossing& crossing) { on_plane.add(crossing.primitive < 3, place); });
      CHECK(on_plane == 0);
    }
  }
}
