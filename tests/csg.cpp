#include <protostar/surfaces/csg.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/two_plates.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// The half-space below a plane: a solid without bounds.
struct HalfSpace {
  Plane plane;

  std::optional<double> intersect(const Ray& ray, Interval range) const {
    return plane.intersect(ray, range);
  }
  Vec3 normal_at(Point p) const { return plane.normal_at(p); }
  auto equation(const auto& rays) const { return plane.equation(rays); }
  bool is_left_by(const Ray& ray) const { return plane.is_left_by(ray); }
  Departure departure() const { return plane.departure(); }
  bool ends_inside(const Ray& ray) const {
    const double slope = dot(plane.normal, ray.direction);
    return slope < 0 || (slope == 0 && dot(plane.normal, ray.origin) <= plane.distance);
  }
};
static_assert(Solid<HalfSpace> && SurfaceWithEquation<HalfSpace>);

Ray along_x(double x, double y = 0, double z = 0) { return {{x, y, z}, {1, 0, 0}}; }
Sphere ball(double x, double radius = 1) { return {.center = {x, 0, 0}, .radius = radius}; }
Box slab(double from, double to) { return {{from, -1, -1}, {to, 1, 1}}; }

// ---- The judge: crossings computed in whole numbers.

__extension__ using Int128 = __int128;

int sign_of(Int128 x) { return (x > 0) - (x < 0); }

/// (p + s √D) / q with q > 0.
struct Surd {
  std::int64_t p, D, q;
  int s;
  /// Returns the value, off by at most 4 roundings, since nothing cancels: if p and s √D differ in sign, the
  /// fraction is extended by p − s √D.
  [[nodiscard]] double value() const {
    const auto over = static_cast<double>(p), under = static_cast<double>(q);
    const double root = s * std::sqrt(static_cast<double>(D));
    return over * root >= 0 ? (over + root) / under
                            : static_cast<double>(p * p - D) / ((over - root) * under);
  }
};

/// Returns the sign of a + s √X.
int sign_of_one(Int128 a, int s, Int128 X) {
  if (sign_of(a) * s * sign_of(X) >= 0) return a != 0 ? sign_of(a) : s * sign_of(X);
  return sign_of(a) * sign_of(a * a - X);
}

/// Returns the sign of x − y. With a = x's rational part minus y's, it is the sign of (a + s√X) − t√Y, which
/// squares decide if both terms have one sign.
int compare(const Surd& x, const Surd& y) {
  const Int128 a = Int128{x.p} * y.q - Int128{y.p} * x.q;
  const Int128 X = Int128{x.D} * y.q * y.q, Y = Int128{y.D} * x.q * x.q;
  const int left = sign_of_one(a, x.s, X), right = y.s * sign_of(Y);
  if (left != right || left == 0) return left > right ? 1 : left < right ? -1 : 0;
  return left * sign_of_one(a * a + X - Y, x.s * sign_of(a), 4 * a * a * X);
}

/// The closed interval in which a line is inside a leaf, if there is one.
struct Stretch {
  bool is_met = false;
  Surd enters{}, leaves{};
};

using Triple = std::array<std::int64_t, 3>;

Stretch stretch_of_ball(const Triple& o, const Triple& d, const Triple& center, std::int64_t radius) {
  std::int64_t A = 0, b = 0, c = -radius * radius;
  for (std::size_t i = 0; i < 3; ++i) {
    A += d[i] * d[i], b += d[i] * (center[i] - o[i]), c += (center[i] - o[i]) * (center[i] - o[i]);
  }
  const std::int64_t D = b * b - A * c;
  if (D < 0) return {};
  return {true, {b, D, A, -1}, {b, D, A, 1}};
}

Stretch stretch_of_box(const Triple& o, const Triple& d, const Triple& min, const Triple& max) {
  Stretch met{true, {-1000000, 0, 1, 0}, {1000000, 0, 1, 0}};
  for (std::size_t i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (o[i] < min[i] || o[i] > max[i]) return {};
      continue;
    }
    const std::int64_t near = d[i] > 0 ? min[i] - o[i] : o[i] - max[i],
                       far = d[i] > 0 ? max[i] - o[i] : o[i] - min[i];
    const std::int64_t q = std::abs(d[i]);
    if (compare({near, 0, q, 0}, met.enters) > 0) met.enters = {near, 0, q, 0};
    if (compare({far, 0, q, 0}, met.leaves) < 0) met.leaves = {far, 0, q, 0};
  }
  if (compare(met.enters, met.leaves) > 0) return {};
  return met;
}

struct JudgedLeaf {
  bool is_ball;
  Triple a, b;  ///< center and radius, or min and max
};
struct JudgedTree {
  int operation = 0, leaf = -1;
  std::vector<JudgedTree> operands = {};
};

bool is_inside(const JudgedTree& tree, const std::vector<bool>& leaves) {
  if (tree.operands.empty()) return leaves[static_cast<std::size_t>(tree.leaf)];
  const auto inside = [&](const JudgedTree& operand) { return is_inside(operand, leaves); };
  if (tree.operation == 0) return std::any_of(tree.operands.begin(), tree.operands.end(), inside);
  if (tree.operation == 1) return std::all_of(tree.operands.begin(), tree.operands.end(), inside);
  return inside(tree.operands[0]) && std::none_of(tree.operands.begin() + 1, tree.operands.end(), inside);
}

/// A tree of few leaves, in the form of the library and of the judge.
struct Grown {
  Csg tree;
  JudgedTree judged;
};

Triple triple(Random& random, int size) {
  const auto x = random.whole(size), y = random.whole(size), z = random.whole(size);
  return {x, y, z};
}
Vec3 vector_of(const Triple& t) {
  return {static_cast<double>(t[0]), static_cast<double>(t[1]), static_cast<double>(t[2])};
}

Grown grown(Random& random, int depth, std::vector<JudgedLeaf>& leaves) {
  if (depth == 0 || random.bits() % 4 == 0) {
    const int place = static_cast<int>(leaves.size());
    Triple a = triple(random, 3), b = triple(random, 3);
    if (random.bits() % 2 == 0) {
      b = {2 + std::abs(b[0]), 0, 0};
      leaves.push_back({true, a, b});
      return {Sphere{vector_of(a), static_cast<double>(b[0])}, {.leaf = place}};
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (a[i] > b[i]) std::swap(a[i], b[i]);
      if (a[i] == b[i]) ++b[i];
    }
    leaves.push_back({false, a, b});
    return {Box{vector_of(a), vector_of(b)}, {.leaf = place}};
  }
  const int operation = static_cast<int>(random.bits() % 3);
  std::vector<Csg> operands;
  JudgedTree judged{.operation = operation};
  for (std::uint64_t i = 0; i < 1 + random.bits() % 3; ++i) {
    Grown operand = grown(random, depth - 1, leaves);
    operands.push_back(std::move(operand.tree));
    judged.operands.push_back(std::move(operand.judged));
  }
  using Operation = Csg::Operation;
  const Operation operations[] = {Operation::either, Operation::all, Operation::first_alone};
  return {Csg(operations[operation], std::move(operands)), std::move(judged)};
}

/// Returns where a line crosses the tree. Adds the number of coinciding crossings of leaves to *coinciding.
std::vector<Surd> judged_crossings(const JudgedTree& tree, const std::vector<JudgedLeaf>& leaves,
                                   const Triple& o, const Triple& d, int* coinciding = nullptr) {
  std::vector<Stretch> stretches;
  std::vector<Surd> places;
  for (const JudgedLeaf& leaf : leaves) {
    stretches.push_back(leaf.is_ball ? stretch_of_ball(o, d, leaf.a, leaf.b[0])
                                     : stretch_of_box(o, d, leaf.a, leaf.b));
    if (stretches.back().is_met) {
      places.push_back(stretches.back().enters);
      places.push_back(stretches.back().leaves);
    }
  }
  std::sort(places.begin(), places.end(), [](const Surd& x, const Surd& y) { return compare(x, y) < 0; });
  std::vector<Surd> found;
  bool before = false;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i + 1 < places.size() && compare(places[i], places[i + 1]) == 0) {
      if (coinciding) ++*coinciding;
      continue;
    }
    // Finds the leaves that contain the line between this place and the next.
    std::vector<bool> inside;
    for (const Stretch& s : stretches)
      inside.push_back(s.is_met && i + 1 < places.size() && compare(s.enters, places[i]) <= 0 &&
                       compare(places[i + 1], s.leaves) <= 0);
    const bool now = is_inside(tree, inside);
    if (now != before) found.push_back(places[i]);
    before = now;
  }
  return found;
}

/// Compares crossings. The relative error of t is at most 2^-30.9 (docs/derivations.md, t) and the judge's
/// 2^-51, together below 2^-30.
bool are_equal(const std::vector<double>& found, const std::vector<Surd>& expected) {
  return std::equal(found.begin(), found.end(), expected.begin(), expected.end(),
                    [](double t, const Surd& s) {
                      return std::abs(t - s.value()) <= Roots::relative_error * std::abs(s.value());
                    });
}

}  // namespace

TEST_CASE(
    "a point is in a union if it is in any of the solids, in an intersection if in all, in a difference if "
    "in the first alone") {
  using Ts = std::vector<double>;
  const Ray ray = along_x(-5);
  struct {
    const char* what;
    Csg tree;
    Ts expected;
  } const rows[] = {
      {"a solid by itself", ball(0), {4, 6}},
      {"a union of one", union_of({ball(0)}), {4, 6}},
      {"a union, apart", union_of({ball(0), ball(5)}), {4, 6, 9, 11}},
      {"a union, overlapping", union_of({ball(0), ball(1)}), {4, 7}},
      {"a union, one inside the other", union_of({ball(0), ball(0, 3)}), {2, 8}},
      {"a union, touching", union_of({ball(0), ball(2)}), {4, 8}},
      {"a union, touching from inside", union_of({ball(0), ball(1, 2)}), {4, 8}},
      {"a union with faces that coincide", union_of({slab(0, 1), slab(1, 2), slab(2, 3)}), {5, 8}},
      {"a union of the same twice", union_of({ball(0), ball(0)}), {4, 6}},
      {"an intersection, apart", intersection_of({ball(0), ball(5)}), {}},
      {"an intersection, overlapping", intersection_of({ball(0), ball(1)}), {5, 6}},
      {"an intersection, one inside the other", intersection_of({ball(0), ball(0, 3)}), {4, 6}},
      {"an intersection, touching", intersection_of({ball(0), ball(2)}), {}},
      {"an intersection of faces that coincide", intersection_of({slab(0, 1), slab(1, 2)}), {}},
      {"an intersection of the same twice", intersection_of({ball(0), ball(0)}), {4, 6}},
      {"a difference, apart", difference_of({ball(0), ball(5)}), {4, 6}},
      {"a difference, overlapping", difference_of({ball(0), ball(1)}), {4, 5}},
      {"a shell", difference_of({ball(0, 3), ball(0)}), {2, 4, 6, 8}},
      {"a difference of nothing left", difference_of({ball(0), ball(0, 3)}), {}},
      {"a difference of the same", difference_of({ball(0), ball(0)}), {}},
      {"a difference of what touches", difference_of({ball(0), ball(2)}), {4, 6}},
      {"a difference with a common face", difference_of({slab(0, 2), slab(0, 1)}), {6, 7}},
      {"a difference of two", difference_of({ball(0, 3), ball(-2), ball(2)}), {4, 6}},
      {"a difference of a difference",
       difference_of({ball(0, 3), difference_of({ball(0, 2), ball(0)})}),
       {2, 3, 4, 6, 7, 8}},
      {"a half-space taken away", difference_of({ball(0), HalfSpace{{{1, 0, 0}, 0}}}), {5, 6}},
      {"a half-space and a ball", union_of({HalfSpace{{{1, 0, 0}, 0}}, ball(0)}), {6}},
      {"between half-spaces",
       intersection_of({HalfSpace{{{1, 0, 0}, 2}}, HalfSpace{{{-1, 0, 0}, 1}}}),
       {4, 7}},
      {"a half-space without a ball", difference_of({HalfSpace{{{-1, 0, 0}, 0}}, ball(2)}), {5, 6, 8}},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK(crossings_of_solid(row.tree, ray, everywhere) == row.expected);
    CHECK(row.tree.intersect(ray) == (row.expected.empty() ? std::nullopt : std::optional(row.expected[0])));
    // The reversed line, and a ray from x = 0.5.
    Ts reversed;
    for (const double t : row.expected) reversed.insert(reversed.begin(), 20 - t);
    CHECK(crossings_of_solid(row.tree, {{15, 0, 0}, {-1, 0, 0}}, everywhere) == reversed);
    Ts ahead;
    for (const double t : row.expected)
      if (t > 5.5) ahead.push_back(t - 5.5);
    CHECK(crossings_of_solid(row.tree, along_x(0.5)) == ahead);
    Ts around;
    for (const double t : row.expected) around.push_back(t - 5.5);
    CHECK(crossings_of_solid(row.tree, along_x(0.5), everywhere) == around);
    CHECK(row.tree.ends_inside(ray) == (std::string(row.what).starts_with("a half-space without")));
  }
}

TEST_CASE("a line that only touches a solid does not cross it") {
  const Ray touching = along_x(-5, 1);
  CHECK(crossings_of_solid(ball(0), touching).empty());
  CHECK(crossings_of_solid(union_of({ball(0), ball(3, 2)}), touching).size() == 2);
  CHECK(crossings_of_solid(difference_of({ball(0, 2), ball(0)}), touching).size() == 2);
  CHECK(crossings_of_solid(difference_of({ball(0, 2), ball(0)}), along_x(-5, 1 - 0x1p-53)).size() == 4);
  CHECK(crossings_of_solid(difference_of({ball(0, 2), ball(0)}), along_x(-5, 1 + 0x1p-52)).size() == 2);
}

TEST_CASE("crossings of CSG trees of whole numbers agree with exact arithmetic") {
  Random random(81);
  int lines = 0, crossed = 0, coinciding = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 4000; ++i) {
    std::vector<JudgedLeaf> leaves;
    const Grown g = grown(random, 3, leaves);
    for (int k = 0; k < 8; ++k) {
      const Triple o = triple(random, 4), d = triple(random, 2);
      if (d == Triple{0, 0, 0}) continue;
      const std::vector<Surd> expected = judged_crossings(g.judged, leaves, o, d, &coinciding);
      const std::vector<double> found = crossings_of_solid(g.tree, {vector_of(o), vector_of(d)}, everywhere);
      ++lines, crossed += !expected.empty();
      wrong.add(!are_equal(found, expected), "from", vector_of(o), "along", vector_of(d), found);
    }
  }
  CHECK(lines > 20000);
  CHECK(crossed > 5000);
  CHECK(coinciding > 5000);
  CHECK(wrong == 0);
}

TEST_CASE("crossings of a ray that leaves a CSG tree of whole numbers agree with exact arithmetic") {
  // Rays leave only crossings at points of whole numbers, which are not rounded.
  Random random(82);
  int left = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 8000; ++i) {
    std::vector<JudgedLeaf> leaves;
    const Grown g = grown(random, 3, leaves);
    const Triple o = triple(random, 4);
    Triple d{0, 0, 0};
    d[random.bits() % 3] = random.bits() % 2 == 0 ? 1 : -1;
    g.tree.each_crossing({vector_of(o), vector_of(d)}, everywhere, [&](const Crossing& crossing) {
      if (crossing.t != std::round(crossing.t)) return;
      Triple p = o;
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += d[axis] * std::lround(crossing.t);
      for (int k = 0; k < 4; ++k) {
        const Triple onwards = triple(random, 3);
        if (onwards[0] == 0 || onwards[1] == 0 || onwards[2] == 0) continue;  // no ray along a face
        std::vector<Surd> expected;
        for (const Surd& s : judged_crossings(g.judged, leaves, p, onwards))
          if (compare(s, {0, 0, 1, 0}) > 0) expected.push_back(s);
        ++left;
        const Ray ray{vector_of(p), vector_of(onwards), g.tree.departure(crossing.primitive)};
        // Drops crossings at the smallest t, which a box reports if it is left in an edge (Box).
        std::vector<double> found = crossings_of_solid(g.tree, ray);
        std::erase(found, std::numeric_limits<double>::denorm_min());
        wrong.add(!are_equal(found, expected), ray, found);
      }
    });
  }
  CHECK(left > 3000);
  CHECK(wrong == 0);
}

TEST_CASE(
    "a ray that leaves a CSG tree is outside at first if it leads outwards and inside if it leads inwards") {
  const Csg tree =
      difference_of({union_of({Sphere{{0, 0, 0}, 2}, Box{{-1, -3, -1}, {1, 3, 1}}}), Sphere{{0.5, 0, 0}, 1.2},
                     Sphere{{-2, 0, 0}, 1}, Quadric{{.squares = {0, 1, 1}, .constant = -0.25}}});
  Random random(83);
  int in = 0, out = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Point origin = random.point(4);
    const Ray ray{origin, random.point(2) - origin};
    const auto crossing = tree.first_crossing(ray, {});
    if (!crossing) continue;
    const Point p = ray.at(crossing->t);
    const Vec3 normal = tree.normal_at(p, crossing->primitive), onwards = random.direction();
    const double slope = dot(onwards, normal);
    if (std::abs(slope) < 1e-6) continue;
    in += slope<0, out += slope> 0;
    wrong.add(crossings_of_solid(tree, {p, onwards, tree.departure(crossing->primitive)}).size() % 2 !=
                  (slope < 0 ? 1 : 0),
              ray, p, slope);
  }
  CHECK(in > 3000);
  CHECK(out > 3000);
  CHECK(wrong == 0);
}

TEST_CASE("a ray that leaves one solid of a CSG tree does not hit another solid of the tree at its origin") {
  const Csg tree = difference_of({slab(0, 1), ball(2)});  // the slab and the ball touch
  const Ray ray{{1, 0, 0}, {-1, 0, 0}, ball(2).departure()};
  CHECK(crossings_of_solid(tree, ray, everywhere) == std::vector<double>{1});
  const Csg both = union_of({slab(0, 1), ball(2)});
  CHECK(crossings_of_solid(both, {{1, 0, 0}, {1, 0, 0}, ball(2).departure()}, everywhere) ==
        std::vector<double>{-1, 2});
}

TEST_CASE("an unbounded solid works in a CSG tree like others, in front of a ray's origin and behind it") {
  const Quadric along_x_axis{{.squares = {0, 1, 1}, .constant = -0.25}};  // a cylinder of radius 1/2
  const Csg pierced = difference_of({slab(-1, 1), along_x_axis});
  CHECK(crossings_of_solid(pierced, {{0, -3, 0}, {0, 1, 0}}) == std::vector<double>{2, 2.5, 3.5, 4});
  CHECK(crossings_of_solid(pierced, along_x(-3)).empty());
  CHECK(crossings_of_solid(pierced, along_x(-3, 0.75)) == std::vector<double>{2, 4});
  CHECK(crossings_of_solid(intersection_of({slab(-1, 1), along_x_axis}), along_x(-3)) ==
        std::vector<double>{2, 4});
  const Csg half = intersection_of({along_x_axis, HalfSpace{{{1, 0, 0}, 0}}});
  CHECK(half.ends_inside({{0, 0, 0}, {-1, 0, 0}}));
  CHECK_FALSE(half.ends_inside({{0, 0, 0}, {1, 0, 0}}));
  CHECK(crossings_of_solid(half, along_x(-3)) == std::vector<double>{3});
  CHECK(crossings_of_solid(half, along_x(3), everywhere) == std::vector<double>{-3});
  // From the wall of the hole: across it, into the slab, and out through the end of the hole.
  std::optional<Crossing> wall;
  pierced.each_crossing({{0, -3, 0}, {0, 1, 0}}, {}, [&](const Crossing& c) {
    if (c.t == 2.5) wall = c;
  });
  REQUIRE(wall);
  const Departure departure = pierced.departure(wall->primitive);
  CHECK(crossings_of_solid(pierced, {{0, -0.5, 0}, {0, 1, 0}, departure}) == std::vector<double>{1, 1.5});
  CHECK(crossings_of_solid(pierced, {{0, -0.5, 0}, {0, -1, 0}, departure}) == std::vector<double>{0.5});
  CHECK(crossings_of_solid(pierced, {{0, -0.5, 0}, {1, 0.5, 0}, departure}).empty());
}

TEST_CASE("the normal of a CSG tree points outwards, also where a solid is subtracted") {
  const Csg shell = difference_of({ball(0, 3), ball(0)});
  std::vector<double> normals;
  const Ray ray = along_x(-5);
  shell.each_crossing(ray, {}, [&](const Crossing& c) {
    const Vec3 n = shell.normal_at(ray.at(c.t), c.primitive);
    CHECK(n == Vec3{n.x, 0, 0});
    normals.push_back(n.x);
  });
  CHECK(normals == std::vector<double>{-1, 1, -1, 1});

  // Along every line, crossings alternate between in and out.
  Random random(84);
  int seen = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 1000; ++i) {
    std::vector<JudgedLeaf> leaves;
    const Grown g = grown(random, 4, leaves);
    const Point origin = random.point(5);
    const Ray line{origin, random.point(2) - origin};
    bool leads_in = true;
    g.tree.each_crossing(line, everywhere, [&](const Crossing& c) {
      const Vec3 n = g.tree.normal_at(line.at(c.t), c.primitive);
      // A ball's normal is off by (2^-30 T + u (T + P)) / r + 4u (docs/derivations.md, The normal). Here r is
      // at least 2, and all is within 16 of the coordinate origin, so that T + P is below 48. The length
      // rounds by 3u: 24u + 4u + 3u < 2^-48.
      const double off = 0x1p-31 * length(c.t * line.direction) + 0x1p-48;
      wrong.add((dot(n, line.direction) < 0) != leads_in || std::abs(length(n) - 1) > off, ray, line, n, off);
      leads_in = !leads_in;
      ++seen;
    });
    wrong.add(!leads_in, ray, line);
  }
  CHECK(seen > 500);
  CHECK(wrong == 0);
}

TEST_CASE(
    "the primitives of a CSG tree are those of its solids, with their normals, coordinates and departures") {
  const Csg tree = union_of({Sphere{}, difference_of({Box{{0, -3, -3}, {4, 3, 3}}, Sphere{{4, 0, 0}, 1}})});
  CHECK(tree.primitive_count() == 8);
  CHECK(tree.has_uv());
  std::vector<int> primitives;
  const Ray ray = along_x(-5);
  tree.each_crossing(ray, {}, [&](const Crossing& c) { primitives.push_back(c.primitive); });
  // Primitive 0 is the sphere, 1 to 6 are the faces of the box, and 7 is the cavity. The face at x = 0 is
  // inside the sphere.
  CHECK(primitives == std::vector<int>{0, 7});
  CHECK(tree.departure(0) == Sphere{}.departure());
  CHECK(tree.departure(7) == Sphere{{4, 0, 0}, 1}.departure());
  primitives.clear();
  const Ray beside = along_x(-5, 2, 1);
  tree.each_crossing(beside, {}, [&](const Crossing& c) { primitives.push_back(c.primitive); });
  CHECK(primitives == std::vector<int>{1, 2});
  CHECK(tree.normal_at({0, 2, 1}, 1) == Vec3{-1, 0, 0});
  CHECK(tree.normal_at({4, 2, 1}, 2) == Vec3{1, 0, 0});
  CHECK(tree.uv_at({4, 2, 1}, 2) == Box{{0, -3, -3}, {4, 3, 3}}.uv_at({4, 2, 1}, 1));
  CHECK(tree.departure(2) == Plane{{1, 0, 0}, 4}.departure());
  CHECK_FALSE(union_of({Sphere{}, HalfSpace{}}).has_uv());
}

TEST_CASE("where faces coincide, the hit names a face at which the CSG tree begins or ends") {
  // At x = 1 the line leaves the ball, and enters a slab that counts only inside another ball, which is
  // elsewhere.
  const Csg tree = union_of({intersection_of({slab(1, 2), ball(9)}), ball(0)});
  std::vector<Vec3> normals;
  const Ray ray = along_x(-5);
  tree.each_crossing(ray, {},
                     [&](const Crossing& c) { normals.push_back(tree.normal_at(ray.at(c.t), c.primitive)); });
  CHECK(normals == std::vector<Vec3>{{-1, 0, 0}, {1, 0, 0}});
}

TEST_CASE("a CSG tree may consist of AnySurface, of instances and of a thousand nested operations") {
  CHECK(crossings_of_solid(union_of({AnySurface(ball(0)), Instance<>(ball(0), Affine{}.moved_by({1, 0, 0}))}),
                           along_x(-5)) == std::vector<double>{4, 7});
  // Each operation subtracts a slice of width 2 from the rest.
  Csg tree = slab(0, 4000);
  for (int i = 0; i < Csg::most_depth; ++i)
    tree = difference_of({std::move(tree), slab(4 * i + 1, 4 * i + 3)});
  CHECK(crossings_of_solid(tree, along_x(-1)).size() == 2002);
  const AnySurface copy = tree;
  CHECK(copy.intersect(along_x(1.5)) == 1.5);
  CHECK_THAT(message_of<std::invalid_argument>([&] {
               tree = union_of({ball(0), std::move(tree)});
             }),
             ContainsSubstring("1000 deep inside each other, and these are 1001"));
  CHECK_THAT(message_of<std::invalid_argument>([] {
               static_cast<void>(Csg(Csg::Operation::none, {ball(0), ball(9)}));
             }),
             ContainsSubstring("by either, all or first_alone, and not by none"));
  std::vector<Csg> many;
  for (int i = 0; i < 3000; ++i) many.push_back(slab(2 * i, 2 * i + 1));
  CHECK(crossings_of_solid(union_of(std::move(many)), along_x(-1)).size() == 6000);
}

TEST_CASE("numbers of primitives add up, however deep CSG trees and instances of them are nested") {
  Csg tree = ball(0, 0.5);
  for (int i = 1; i <= 100; ++i)
    tree = union_of({ball(0), Instance<>(std::move(tree), Affine{}.moved_by({4, 0, 0}))});
  CHECK(tree.primitive_count() == 101);
  std::vector<int> primitives;
  const Ray ray = along_x(-5);
  double last = -9;
  tree.each_crossing(ray, {}, [&](const Crossing& c) {
    primitives.push_back(c.primitive);
    const Vec3 n = tree.normal_at(ray.at(c.t), c.primitive);
    CHECK(n == Vec3{primitives.size() % 2 == 0 ? 1 : -1, 0, 0});
    CHECK(c.t > last);
    last = c.t;
  });
  REQUIRE(primitives.size() == 202);
  for (int i = 0; i < 202; ++i) CHECK(primitives[static_cast<std::size_t>(i)] == i / 2);
}

TEST_CASE("the bounds of a CSG tree contain what is left of its solids") {
  const auto is = [](const Bounds& b, const Point& low,
                     const Point& high) {  // a box's bounds are a bit wider
    const Vec3 below = low - b.min, above = b.max - high;
    return glm::min(below, above) == glm::abs(glm::min(below, above)) && length(below + above) < 0x1p-15;
  };
  const Box a{{0, 0, 0}, {4, 4, 4}}, b{{2, 2, -1}, {6, 3, 3}}, far{{9, 9, 9}, {10, 10, 10}};
  CHECK(is(union_of({a, b}).bounds(), {0, 0, -1}, {6, 4, 4}));
  CHECK(is(intersection_of({a, b}).bounds(), {2, 2, 0}, {4, 3, 3}));
  CHECK(is(difference_of({a, b}).bounds(), {0, 0, 0}, {4, 4, 4}));
  CHECK(is(intersection_of({HalfSpace{}, b}).bounds(), b.min, b.max));
  const Bounds none = intersection_of({a, far}).bounds();
  CHECK(none.min == none.max);
}

TEST_CASE("pictures of CSG trees are the same plain, accelerated and by tiles") {
  Random random(85);
  Scene<AnySurface> scene;
  scene.add(Box{{-50, -3, -50}, {50, -2, 50}}, Color{0.6f});
  for (int i = 0; i < 12; ++i) {
    const Point p = Vec3{0, 0, 5} + random.point(2.2);
    const auto near = [&](double far) { return p + random.point(far); };
    const Sphere outer{p, 0.7}, inner{near(0.3), 0.6};
    const Box box{p - Vec3{0.5, 0.6, 0.4}, p + Vec3{0.5, 0.6, 0.4}};
    scene.add(difference_of({outer, inner, Sphere{near(0.5), 0.4}}), random.color());
    scene.add(
        intersection_of({Sphere{p + Vec3{0, 1, 0}, 0.5}, Instance<>(box, Affine{}.moved_by({0, 0.8, 0}))}),
        Material{.texture = Checker{.first = random.color(), .second = random.color(), .size = 0.2}});
    scene.add(union_of({difference_of({box, outer}), Sphere{p, 0.2}}), random.color());
  }
  scene.add(difference_of({HalfSpace{{{0, 0, -1}, -9}}, Sphere{{0, 0, 9}, 3}}), Color{0.5f});
  scene.add(PointLight{.position = {3, 5, 0}, .power = Color{800}});
  const DrawnAlike drawn = drawn_alike(scene, Camera{}, ShadowIntegrator{});
  CHECK(drawn.lit > 1000);
  CHECK(drawn.different == 0);
}

TEST_CASE("an invalid CSG tree is refused") {
  const auto says = [](const auto& make) { return message_of<std::invalid_argument>([&] { (void)make(); }); };
  CHECK_THAT(says([] { return union_of({}); }), ContainsSubstring("needs a solid"));
  CHECK_THAT(says([] { return union_of({AnySurface(Plane{})}); }), ContainsSubstring("closed solid"));
  CHECK_THAT(says([] { return Csg(Instance(TwoPlates{}, {})); }), ContainsSubstring("closed solid"));
  CHECK_THAT(says([] {
               union_of({ball(0), ball(0, 0)}).validate();
               return 0;
             }),
             ContainsSubstring("Sphere: radius"));
  static_assert(!std::is_constructible_v<Csg, Plane> && !std::is_constructible_v<Csg, TwoPlates>);

  struct Large : HalfSpace {  // a solid of 2^30 primitives
    Vec3 normal_at(Point p, int) const { return plane.normal_at(p); }
    Departure departure(int) const { return plane.departure(); }
    int primitive_count() const { return 1 << 30; }
  };
  CHECK_NOTHROW(union_of({Large{}, ball(0)}));
  CHECK_THAT(says([] {
               return union_of({Large{}, ball(0), Large{}});
             }),
             ContainsSubstring("2^31 - 1 primitives"));
}
