#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <protostar/accel/accelerate.hpp>
#include <protostar/bvh/node.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/mesh_leaves.hpp>
#include <protostar/surfaces/plane.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/meshes.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

MeshData one_triangle() { return {.vertices = {{0, 0, 3}, {2, 0, 3}, {0, 2, 3}}, .triangles = {{0, 1, 2}}}; }

/// Returns the crossings of all triangles, each tested by itself, in exact order. A ray that leaves one of
/// them starts at a point inside it (StartInTriangle).
std::vector<Crossing> crossings_of_triangles(const Mesh& mesh, const Ray& ray, Interval range) {
  const MeshData& data = mesh.data();
  const int departed = ray.departure.is_planar() ? ray.departure.primitive : -1;
  std::vector<Crossing> all;
  for (int primitive = 0; primitive < mesh.primitive_count(); ++primitive) {
    const Triangle triangle = data.triangle(static_cast<std::size_t>(primitive));
    if (departed < 0) {
      if (const auto crossing = first_crossing(triangle, ray, range))
        all.push_back({.t = crossing->t, .primitive = primitive});
    } else if (primitive != departed) {
      const StartInTriangle start(ray, data.triangle(static_cast<std::size_t>(departed)));
      for (const double t : start.roots(ray, triangle)) {
        const ExactRoot root = start.exact_root(ray, triangle);
        if ((range.min == -infinity || order(exact_root_of(range.min), root) < 0) &&
            (range.max == infinity || order(root, exact_root_of(range.max)) < 0))
          all.push_back({.t = t, .primitive = primitive});
      }
    }
  }
  const auto root = [&](const Crossing& crossing) { return mesh.exact_root(ray, crossing); };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Crossing& a, const Crossing& b) { return order(root(a), root(b)) < 0; });
  return all;
}

bool are_equal_crossings(const Crossing& a, const Crossing& b) {
  return a.t == b.t && a.root == b.root && a.primitive == b.primitive;
}

/// Returns random triangles, some of them twice, some without area.
MeshData soup(Random& random, int count) {
  MeshData data;
  for (int i = 0; i < count; ++i) {
    const Point at = random.point(1);
    for (int k = 0; k < 3; ++k) data.vertices.push_back(at + random.point(0.3));
    const auto first = static_cast<std::uint32_t>(3 * i);
    data.triangles.push_back({first, first + 1, first + 2});
    if (i % 5 == 0) data.triangles.push_back({first + 1, first, first + 2});
    if (i % 7 == 0) data.triangles.push_back({first + 1, first, first + 1});
  }
  return data;
}

/// Search for all leaves.
struct AllLeaves {
  using Key = simd::NoKey;

  [[nodiscard]] simd::Met look(const simd::Node& node) const {
    simd::Bits met = 0;
    for (int k = 0; k < simd::node_width; ++k)
      if (node.has(k)) met |= simd::Bits{1} << k;
    return {met};
  }
};

}  // namespace

TEST_CASE("a mesh is hit where one of its triangles is, whatever their orientation") {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  struct Met {
    double t;
    int primitive;
    double normal_z;
  };
  // The corners of a square around (1, 1), and its middle. On an edge the ray's origin counts as moved by (ε,
  // ε², ε³): here to the right of the diagonal from vertex 0 to 2.
  const std::vector<Point> vertices{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}};
  const Triangles square{{0, 1, 2}, {0, 2, 3}}, reversed{{0, 2, 1}, {0, 3, 2}}, mixed{{0, 2, 1}, {0, 2, 3}},
      degenerate{{0, 0, 2}, {0, 2, 4}, {4, 4, 4}, {2, 0, 2}}, twice{{0, 1, 2}, {0, 2, 1}};
  Triangles among_degenerate = degenerate;
  among_degenerate.insert(among_degenerate.end(), square.begin(), square.end());
  const auto up = [](double x, double y) { return Ray{{x, y, -3}, {0, 0, 1}}; };
  const auto down = [](double x, double y) { return Ray{{x, y, 3}, {0, 0, -2}}; };
  const double tiny = 0x1p-60;
  struct {
    const char* what;
    const Triangles& triangles;
    Ray ray;
    std::optional<Met> expected;
  } const rows[] = {
      {"inside the first", square, up(1.5, 0.5), Met{3, 0, 1}},
      {"inside the second", square, up(0.5, 1.5), Met{3, 1, 1}},
      {"inside, from above", square, down(1.5, 0.5), Met{1.5, 0, 1}},
      {"behind the origin", square, {{1.5, 0.5, 3}, {0, 0, 1}}, std::nullopt},
      {"outside", square, up(2.5, 0.5), std::nullopt},
      {"outside, and in its box", degenerate, up(1.5, 0.5), std::nullopt},
      {"just inside the outline", square, up(2 - ulp, 1), Met{3, 0, 1}},
      {"just outside the outline", square, up(2 + 2 * ulp, 1), std::nullopt},
      {"an edge that is met a bit further inside", square, up(0, 1), Met{3, 1, 1}},
      {"an edge that is met a bit further outside", square, up(2, 1), std::nullopt},
      {"the edge of both, from below", square, up(1, 1), Met{3, 0, 1}},
      {"the edge of both, from above", square, down(1, 1), Met{1.5, 0, 1}},
      {"just beside the edge of both", square, up(1, 1 + ulp), Met{3, 1, 1}},
      {"the vertex of both that is met inside", square, up(0, 0), Met{3, 0, 1}},
      {"the vertex of both that is met outside", square, up(2, 2), std::nullopt},
      {"grazing, in its plane", square, {{-1, 0.5, 0}, {1, 0, 0}}, std::nullopt},
      {"grazing, along the edge of both", square, {{-1, -1, 0}, {1, 1, 0}}, std::nullopt},
      {"grazing, next to its plane", square, {{-1, 0.5, tiny}, {1, 0, 0}}, std::nullopt},
      {"grazing, from below", square, {{-1, 0.5, -tiny}, {2, 0, tiny}}, Met{1, 0, 1}},
      {"grazing, from above", square, {{-1, 0.5, tiny}, {1, 0, -tiny}}, Met{1, 1, 1}},
      {"reversed", reversed, up(1.5, 0.5), Met{3, 0, -1}},
      {"reversed, from above", reversed, down(0.5, 1.5), Met{1.5, 1, -1}},
      {"reversed, the edge of both", reversed, up(1, 1), Met{3, 0, -1}},
      {"one reversed, inside it", mixed, up(1.5, 0.5), Met{3, 0, -1}},
      {"one reversed, inside the other", mixed, up(0.5, 1.5), Met{3, 1, 1}},
      {"one reversed, the edge of both", mixed, up(1, 1), Met{3, 0, -1}},
      {"a triangle, and reversed in its place", twice, up(1.5, 0.5), Met{3, 0, 1}},
      {"nothing but triangles without area", degenerate, up(1, 1), std::nullopt},
      {"along triangles without area", degenerate, {{-1, -1, 0}, {1, 1, 0}}, std::nullopt},
      {"through triangles without area", among_degenerate, up(1, 1), Met{3, 4, 1}},
      {"beside triangles without area", among_degenerate, up(0.5, 1.5), Met{3, 5, 1}},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    const Mesh mesh({.vertices = vertices, .triangles = row.triangles}, {.threads = 1});
    const auto first = mesh.first_crossing(row.ray, {});
    REQUIRE(first.has_value() == row.expected.has_value());
    CHECK(mesh.any_hit(row.ray, {}) == row.expected.has_value());
    if (!first) continue;
    CHECK(first->t == row.expected->t);
    CHECK(first->primitive == row.expected->primitive);
    CHECK(mesh.normal_at(row.ray.at(first->t), first->primitive) == Vec3{0, 0, row.expected->normal_z});
  }
}

TEST_CASE("a mesh reports the crossings of its triangles in exact order, at equal t the lower index first") {
  Random random(41);
  std::size_t crossings = 0;
  WrongCases wrong(random);
  for (const MeshData& data :
       {soup(random, 60), meshes::box(2), meshes::icosphere(1), meshes::torus(9, 7), one_triangle()}) {
    const Mesh mesh(data, {.threads = 1});
    for (int i = 0; i < 400; ++i) {
      const double unit = i % 2 == 0 ? 0.5 : 1e-9;  // with 0.5 many rays hit edges and vertices
      const auto place = [&](double size) { return unit * glm::floor(random.point(size) / unit); };
      const Point origin = (i % 4 == 0 ? 1000.0 : 1.0) * place(3), target = place(1);
      Ray ray{origin, target - origin};
      Interval range = i % 3 == 0 ? everywhere : i % 3 == 1 ? Interval{} : Interval{0.25, 1.5};
      for (int leave = 0; leave < 2; ++leave) {
        const auto expected = crossings_of_triangles(mesh, ray, range);
        std::vector<Crossing> found;
        mesh.each_crossing(ray, range, [&](const Crossing& crossing) { found.push_back(crossing); });
        wrong.add(
            !std::equal(found.begin(), found.end(), expected.begin(), expected.end(), are_equal_crossings),
            ray, range);
        const auto first = mesh.first_crossing(ray, range);
        wrong.add(first ? expected.empty() || !are_equal_crossings(*first, expected[0]) : !expected.empty(),
                  ray, range);
        wrong.add(mesh.any_hit(ray, range) == expected.empty(), ray, range);
        crossings += expected.size();
        if (!first) break;
        ray = {ray.at(first->t), place(2), mesh.departure(first->primitive)};
        range = {};
      }
    }
  }
  CHECK(crossings > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("queries of a mesh for many rays answer each ray as a query by itself") {
  Random random(43);
  const auto answer = [](const std::optional<Crossing>& crossing) {
    return crossing ? std::pair(crossing->primitive, crossing->t) : std::pair(-1, 0.0);
  };
  for (const MeshData& data : {soup(random, 60), meshes::torus(9, 7), one_triangle()}) {
    const Mesh mesh(data, {.threads = 1});
    for (const std::size_t count : {0u, 1u, 15u, 100u}) {
      std::vector<Ray> rays;
      for (std::size_t i = 0; i < count; ++i) {
        const Point origin = random.point(2);
        rays.push_back({origin, random.point(1) - origin});
      }
      if (count > 10) rays[3].origin.x = 1e300, rays[7].direction.y = infinity;  // boxes do not help them
      const auto ray = [&](std::size_t k) { return rays[k]; };
      for (const Interval& range : {Interval{}, Interval{0.25, 1.5}, everywhere}) {
        std::vector<std::optional<Crossing>> first(count);
        std::vector<int> any_hit(count), told(count);
        mesh.first_crossings(count, ray, range, [&](std::size_t k, const std::optional<Crossing>& crossing) {
          first[k] = crossing;
          ++told[k];
        });
        mesh.any_hits(count, ray, range, [&](std::size_t k, bool met) {
          any_hit[k] = met;
          ++told[k];
        });
        int hits = 0;
        for (std::size_t k = 0; k < count; ++k) {
          CHECK(told[k] == 2);
          CHECK(answer(first[k]) == answer(mesh.first_crossing(rays[k], range)));
          CHECK((any_hit[k] != 0) == mesh.any_hit(rays[k], range));
          hits += any_hit[k];
        }
        if (count == 100 && data.triangles.size() > 1) CHECK((hits > 10 && hits < 90));
      }
    }
  }
}

TEST_CASE("a ray that leaves a convex mesh hits it again if it leads inwards, and never outwards") {
  Random random(42);
  int hits = 0;
  WrongCases wrong(random);
  for (const MeshData& data : {meshes::box(2), meshes::icosphere(2)})
    for (const double scale : {1e-3, 1.0, 1e6}) {
      const Mesh mesh(meshes::moved(data, scale, scale * Vec3{100, 20, -30}), {.threads = 1});
      Scene<Mesh> scene;
      scene.add(mesh, Color{1});
      for (int i = 0; i < 500; ++i) {
        const Point origin = scale * (Vec3{100, 20, -30} + 8.0 * random.direction());
        const Point target = scale * (Vec3{100, 20, -30} + random.point(1));
        const auto hit = scene.intersect({origin, target - origin});
        if (!hit) continue;
        ++hits;
        const Vec3 d = random.direction();
        const auto again = scene.intersect(hit->leave(d));
        // Skips flat directions: next to an edge, the rounded hit may be on the outer side of a neighboring
        // triangle.
        const double slope = dot(d, hit->normal());
        if (std::abs(slope) < 1e-6) continue;
        wrong.add(again.has_value() != (slope < 0), origin, target, d, slope);
      }
    }
  CHECK(hits > 1500);
  CHECK(wrong == 0);
}

TEST_CASE("vertex normals are interpolated, and a triangle without them has its own normal") {
  MeshData data = one_triangle();
  const Point middle{0.5, 1, 3};  // u = 1/4, v = 1/2
  CHECK(Mesh(data).normal_at(middle, 0) == Vec3{0, 0, 1});
  data.normals = {{0, 0, 2}, {4, 0, 0}, {0, -2, 0}};
  // Normals along axes have exact lengths, and the sum with weights of 1/4 and 1/2 is a fourth of this
  // vector.
  CHECK(Mesh(data).normal_at(middle, 0) == normalize(Vec3{1, -1, 0.5}));
  CHECK(Mesh(data).normal_at(data.vertices[1], 0) == Vec3{1, 0, 0});
  for (Vec3& normal : data.normals) normal *= 1e300;
  CHECK(Mesh(data).normal_at(middle, 0) == normalize(Vec3{1, -1, 0.5}));
  data.normals = {{0, 0, 0}, {0, 0, -1}, {0, 0, 0.5}};  // the normals cancel there
  CHECK(Mesh(data).normal_at(middle, 0) == Vec3{0, 0, 1});
}

TEST_CASE(
    "interpolated normals are unit vectors, and the facing normal faces the ray, whatever the vertex "
    "normals") {
  Random random(45);
  int hits = 0, turned = 0;
  WrongCases not_units(random), wrong(random);
  for (int round = 0; round < 40; ++round) {
    MeshData data = meshes::icosphere(1);
    for (const Point& p : data.vertices) {
      // Normals of any length, some of them inwards; in one round of four, almost those of the sphere.
      const Vec3 normal = round % 4 == 0 ? p + 0x1p-40 * random.direction() : random.direction();
      data.normals.push_back(std::ldexp(1, static_cast<int>(random.bits() % 1000) - 500) * normal);
    }
    Scene<Mesh> scene;
    scene.add(Mesh(data, {.threads = 1}), Color{1});
    for (int i = 0; i < 100; ++i) {
      const Point origin = i % 2 == 0 ? 3.0 * random.direction() : random.point(0.3);
      const auto hit = scene.intersect({origin, random.point(0.5) - origin});
      if (!hit) continue;
      ++hits;
      const Vec3 normal = hit->normal(), facing = hit->facing_normal();
      // In units of 2^-53: the squares and their sums are off by 3, which the root halves; the root, its
      // inverse and the product round by 3 more. Measuring the length adds another 3: at most 8.
      not_units.add(!(std::abs(length(normal) - 1) <= 0x1p-50), origin, normal);
      wrong.add(!(dot(facing, hit->direction()) <= 0) || !(facing == normal || facing == -normal), origin,
                normal);
      turned += facing != normal;
    }
  }
  CHECK(hits > 3000);
  CHECK(turned > 1000);
  CHECK(turned < hits - 1000);
  CHECK(not_units == 0);
  CHECK(wrong == 0);
}

TEST_CASE("texture coordinates of vertices are interpolated, and without them u and v are barycentric") {
  MeshData data = one_triangle();
  const Point middle{0.5, 1, 3};
  CHECK(Mesh(data).uv_at(middle, 0) == Uv{0.25, 0.5});
  data.uvs = {{1, 1}, {5, 1}, {1, 3}};
  CHECK(Mesh(data).uv_at(middle, 0) == Uv{2, 2});
}

TEST_CASE("the bounds of a mesh contain its triangles, and not unused vertices") {
  MeshData data = one_triangle();
  data.vertices.push_back({9, 9, 9});
  const Bounds bounds = Mesh(data).bounds();
  CHECK(bounds.min == Point{0, 0, 3});
  CHECK(bounds.max == Point{2, 2, 3});
}

TEST_CASE("a ray that leaves a plane or a triangle does not hit triangles of a mesh in the same plane") {
  const Mesh box(meshes::box(3), {.threads = 1});
  const Plane side{.normal = {0, 2, 0}, .distance = 6};
  const Departure departures[] = {side.departure(), Triangle{{0, 3, 0}, {0, 3, 1}, {1, 3, 0}}.departure()};
  for (const Departure& departure : departures) {
    const Ray down{{0.3, 3 + 1e-15, 0.4}, {0.1, -1, 0.2}, departure};
    const auto t = box.intersect(down);
    REQUIRE(t);
    CHECK(*t > 5.9);
  }
}

TEST_CASE("copies of a mesh share its data") {
  const Mesh mesh(meshes::icosphere(1));
  const Mesh copy = mesh;
  CHECK(&copy.data() == &mesh.data());
}

TEST_CASE("meshes of all sizes are hit, and rays that are not finite hit nothing") {
  for (const double size : {0x1p-400, 0x1p-30, 1.0, 0x1p30, 0x1p398}) {
    CAPTURE(size);
    const Mesh mesh(meshes::moved(meshes::box(2), size, Vec3{0}));
    CHECK(mesh.intersect({{0, 0, -5 * size}, {0, 0, size}}) == 3);
    CHECK_FALSE(mesh.intersect({{0, 0, -5 * size}, {0, 0, -size}}));
    CHECK(mesh.intersect({{0, 0, -5 * size}, {0, 0, -size}}, everywhere) == -7);
  }
  const Mesh mesh(meshes::box(2));
  for (const double bad : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()})
    for (int axis = 0; axis < 3; ++axis) {
      Ray ray{{0, 0, -5}, {0, 0, 1}};
      ray.origin[axis] = bad;
      CHECK_FALSE(mesh.intersect(ray, everywhere));
      ray = {{0, 0, -5}, {0, 0, 1}};
      ray.direction[axis] = bad;
      CHECK_FALSE(mesh.intersect(ray, everywhere));
    }
}

TEST_CASE(
    "pictures of meshes are the same plain, accelerated and by tiles, and hits are the same with "
    "AnySurface") {
  Random random(43);
  MeshData ball = meshes::moved(meshes::icosphere(2), 0.9, {-0.8, 0, 4});
  for (const Point& p : ball.vertices) ball.normals.push_back(p - Vec3{-0.8, 0, 4});
  const Mesh smooth(ball), ring(meshes::moved(meshes::torus(12, 7), 0.7, {0.9, 0, 4.2})),
      confetti(meshes::moved(soup(random, 20), 0.5, {0, 1, 3}));
  std::vector<Mesh> beads;  // more than a tree node has children, some in front of others
  for (int i = 0; i < 20; ++i)
    beads.push_back(Mesh(meshes::moved(meshes::icosphere(0), 0.25, Point{0, 0, 5} + random.point(1))));
  Material checkered;
  checkered.texture = Checker{.first = Color{1}, .second = Color{0.1f}, .size = 0.5};
  const auto add_all = [&](auto& scene) {
    scene.add(smooth, Color{0.8f, 0.3f, 0.1f});
    scene.add(ring, checkered);
    scene.add(confetti, Color{0.2f, 0.7f, 0.3f});
    for (const Mesh& bead : beads) scene.add(bead, Color{0.5f});
    scene.add(PointLight{.position = {1, 4, 1}, .power = Color{400}});
  };
  Scene<Mesh> scene;
  Scene<AnySurface> any;
  add_all(scene), add_all(any);
  const DrawnAlike drawn = drawn_alike(scene, Camera{}, ShadowIntegrator{});
  CHECK(drawn.lit > 100);
  CHECK(drawn.different == 0);

  const auto fast = accelerate(scene);
  int hits = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const Point target = Point{0, 0, 4} + random.point(1);
    const Ray ray{random.point(1), target};
    const auto a = scene.intersect(ray), b = any.intersect(ray), c = fast.intersect(ray);
    wrong.add(a.has_value() != b.has_value() || a.has_value() != c.has_value(), ray);
    if (!a || !b || !c) continue;
    ++hits;
    for (const auto& other : {b, c})
      wrong.add(other->t != a->t || other->normal() != a->normal() || other->uv() != a->uv(), ray);
    const Vec3 to_light = Point{1, 4, 1} - a->point();
    const bool dark = scene.occluded(a->leave(to_light), {0, 1});
    wrong.add(any.occluded(b->leave(to_light), {0, 1}) != dark, ray, to_light);
    wrong.add(fast.occluded(c->leave(to_light), {0, 1}) != dark, ray, to_light);
  }
  CHECK(hits > 500);
  CHECK(wrong == 0);
}

TEST_CASE("a mesh of few triangles also refuses a negative number of threads") {
  CHECK_THROWS_AS(Mesh(meshes::box(1), {.threads = -1}), std::invalid_argument);
}

TEST_CASE("the tree of a mesh is the same for any number of threads") {
  const double scale = GENERATE(1.0, 1 / 3.0);  // coordinates that float represents, or not
  MeshData data = meshes::torus(150, 50);
  for (Point& p : data.vertices) p = scale * Point(glm::vec3(p));
  const auto tree = [&](int threads) {
    return simd::TriangleTree(data.triangles.size(), data.triangle_of(), {.threads = threads});
  };
  const auto one = tree(1), several = tree(3);
  REQUIRE(one.bvh().order().size() == data.triangles.size());
  REQUIRE(several.bvh().order().size() == one.bvh().order().size());
  const auto &order = one.bvh().order(), &other = several.bvh().order();
  CHECK(std::equal(order.begin(), order.end(), other.begin(), other.end()));
  // Returns the triangles and their indices, in the order of the leaves.
  const auto contents = [](const simd::TriangleTree& of) {
    std::vector<double> numbers;
    const auto take = [&](simd::Leaf leaf) {
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const auto place = simd::TriangleLeaves::place(leaf, i);
        const Triangle triangle = of.leaves().triangle(place);
        for (const Point& p : {triangle.a, triangle.b, triangle.c})
          numbers.insert(numbers.end(), {p.x, p.y, p.z});
        numbers.push_back(of.leaves().number(place));
      }
    };
    of.each_leaf(AllLeaves{}, take);
    return numbers;
  };
  CHECK(contents(one).size() == 10 * one.bvh().order().size());
  CHECK(contents(one) == contents(several));
}

TEST_CASE("certified results for the triangles of a leaf are correct, and most are certified") {
  Random random(44);
  int crossed = 0, surely = 0;
  WrongCases wrong(random);
  for (int round = 0; round < cases(60, 400, 400); ++round) {
    // Triangles of all sizes, some of them needles, some nearly edge-on to many rays, some without area.
    std::vector<Triangle> triangles;
    const double size = std::ldexp(1, -static_cast<int>(random.bits() % 16));
    const Vec3 flat{1, round % 3 == 0 ? 1e-6 : 1, round % 5 == 0 ? 0 : 1};
    for (int i = 0; i < 8; ++i) {
      const Point at = random.point(1);
      const auto near = [&] {
        const Point point = at + size * flat * random.point(1);
        return round % 2 == 0 ? point : Point(glm::vec3(point));  // coordinates that float represents, or not
      };
      triangles.push_back({near(), near(), near()});
      if (i % 8 == 7) triangles.back().c = triangles.back().a;
    }
    const simd::Bvh bvh(triangles.size(), [&](std::size_t i) { return triangles[i].bounds(); },
                        {.most = simd::node_width}, {.threads = 1});
    const simd::TriangleLeaves leaves(bvh, [&](std::size_t i) { return triangles[i]; }, {.threads = 1});
    for (int i = 0; i < 100; ++i) {
      const Triangle& aim = triangles[random.bits() % 8];
      const double u = random.real(-0.1, 1), v = random.real(-0.1, 1.1 - u);
      const Point target = aim.a + u * (aim.b - aim.a) + v * (aim.c - aim.a);
      const Point origin = (i % 4 == 0 ? 1000.0 : i % 4 == 1 ? 1e-3 : 2.0) * random.point(1);
      Ray ray{origin, std::ldexp(1, i % 7) * (target - origin)};
      if (i % 10 == 9) ray.departure = aim.departure();
      const double end = i % 2 == 0 ? infinity : std::ldexp(i % 3 == 0 ? 1 : random.real(0.9, 1.1), -(i % 7));
      bvh.each_leaf([&](simd::Leaf leaf) {
        for (std::uint32_t k = 0; k < leaf.count; ++k) {
          const std::uint32_t first = k / simd::double_lanes * simd::double_lanes;
          const auto lane = static_cast<int>(k - first);
          const auto tried = leaves.tried(leaf, first, ray, rounded_line(ray), {0, end});
          const auto place = leaves.place(leaf, k);
          const std::uint32_t number = leaves.number(place);
          const Triangle& triangle = triangles[number];
          const auto copy = leaves.triangle(place);
          wrong.add(number != bvh.order()[leaf.first + k], aim, triangle, ray);
          wrong.add(copy.a != triangle.a || copy.b != triangle.b || copy.c != triangle.c, aim, triangle, ray);
          const auto t = triangle.intersect(ray, {0, end});
          const bool sure = (tried.crossed >> lane & 1) != 0, doubt = (tried.in_doubt >> lane & 1) != 0;
          wrong.add((t && !sure && !doubt) || (sure && doubt), aim, triangle, ray);
          wrong.add(sure && !(t && *t == tried.t[lane]), aim, triangle, ray);
          crossed += t && !ray.departure.is_planar(), surely += sure;
        }
      });
    }
  }
  CHECK(wrong == 0);
  CHECK(crossed > cases(1'500, 10'000, 10'000));
  CHECK(surely > crossed * 9 / 10);
}

TEST_CASE("an invalid mesh is refused, with the reason") {
  const auto says = [](const MeshData& data) {
    return message_of<std::invalid_argument>([&] { Mesh mesh(data); });
  };
  CHECK_THAT(says({}), ContainsSubstring("Mesh: there is no triangle"));
  MeshData data = one_triangle();
  data.triangles.push_back({0, 3, 1});
  CHECK_THAT(says(data), ContainsSubstring("triangle 1 names vertex 3, and there are 3"));
  data.triangles[1] = {0, 1, 0xffffffff};
  CHECK_THAT(says(data), ContainsSubstring("triangle 1 names vertex 4294967295"));
  for (const double bad : {infinity, std::numeric_limits<double>::quiet_NaN()}) {
    data = one_triangle();
    data.vertices[1].y = bad;
    CHECK_THAT(says(data), ContainsSubstring("vertex 1 must have numbers at most 2^400"));
    data = one_triangle();
    data.normals = {{0, 0, 1}, {0, bad, 1}, {0, 0, 1}};
    CHECK_THAT(says(data), ContainsSubstring("normal 1 must be finite"));
    data = one_triangle();
    data.uvs = {{0, 0}, {0, 0}, {0, bad}};
    CHECK_THAT(says(data), ContainsSubstring("uv 2 must have numbers at most 2^400"));
  }
  data = one_triangle();
  data.normals = {{0, 0, 1}};
  CHECK_THAT(says(data), ContainsSubstring("as many normals as vertices, or none; there are 1 and 3"));
  data = one_triangle();
  data.uvs = {{0, 0}};
  CHECK_THAT(says(data), ContainsSubstring("as many uvs as vertices, or none; there are 1 and 3"));
  data = one_triangle();
  data.triangles.push_back({1, 1, 1});  // no area
  CHECK_NOTHROW(Mesh(data));
}
