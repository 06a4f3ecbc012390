#include <protostar/bvh/bvh.hpp>
#include <protostar/bvh/node.hpp>
#include <protostar/bvh/ray_in_bvh.hpp>
#include <protostar/bvh/traversal.hpp>
#include <protostar/surfaces/sphere.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;
using simd::AlongRay;
using simd::BoxRay;
using simd::Bvh;
using simd::Leaf;
using simd::Order;
using simd::Reach;

namespace {

Bvh tree_of(const std::vector<Bounds>& bounds, simd::LeafSize leaf_size = {.most = 4}, int threads = 1) {
  return Bvh(bounds.size(), [&](std::size_t i) { return bounds[i]; }, leaf_size, {.threads = threads});
}

std::vector<Bounds> random_bounds(Random& random, int count, double size, const Point& around = Point{0}) {
  std::vector<Bounds> bounds;
  for (int i = 0; i < count; ++i) {
    const Point center = around + random.point(1);
    const Vec3 half = abs(random.point(size));
    bounds.push_back({center - half, center + half});
  }
  return bounds;
}

/// Returns the primitives that a traversal visits, in order of their indices; checks that none is visited
/// twice.
std::vector<std::uint32_t> visited(const Bvh& tree, const auto& walk) {
  std::vector<std::uint32_t> found;
  walk([&](Leaf leaf) {
    for (std::uint32_t i = 0; i < leaf.count; ++i) found.push_back(tree.order()[leaf.first + i]);
  });
  std::sort(found.begin(), found.end());
  CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
  return found;
}

/// Returns the primitives visited along a ray in a range; checks that they are the same for each Order.
std::vector<std::uint32_t> along(const Bvh& tree, const Ray& ray, Interval range) {
  const BoxRay line(ray, tree.space(), 0);
  REQUIRE(line.usable);
  const Reach reach{line.at_least(range.min), line.at_most(range.max)};
  const auto in_order = [&]<simd::Order order>(std::integral_constant<simd::Order, order>) {
    return visited(tree, [&](const auto& visit) {
      simd::traverse(tree, AlongRay<order>(tree, line, reach), [&](Leaf leaf) {
        visit(leaf);
        return false;
      });
    });
  };
  const auto found = in_order(std::integral_constant<simd::Order, simd::Order::near_first>());
  CHECK(in_order(std::integral_constant<simd::Order, simd::Order::any>()) == found);
  return found;
}

/// Tests whether a ray is in a box at some t of the range. Computes in long double, which keeps what double
/// rounds.
bool meets(const Ray& ray, Interval range, const Bounds& box) {
  long double from = range.min, until = range.max;
  for (int axis = 0; axis < 3; ++axis) {
    const long double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < box.min[axis] || o > box.max[axis]) return false;
      continue;
    }
    const long double a = (box.min[axis] - o) / d, b = (box.max[axis] - o) / d;
    from = std::max(from, std::min(a, b));
    until = std::min(until, std::max(a, b));
  }
  return from <= until;
}

}  // namespace

TEST_CASE("no end of a box is a subnormal float, which some processors multiply slowly") {
  const simd::BoxSpace space(Bounds{{-2, -2, -2}, {2, 2, 2}});
  for (const double other : {1.5, 0x1p-40, 0.0}) {
    const simd::Box box = space(Bounds{{0, -other, 0}, {0, 0, other}});
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(std::isnormal(box.min[axis]));
      CHECK(std::isnormal(box.max[axis]));
      CHECK(box.min[axis] < box.max[axis]);
    }
  }
}

TEST_CASE("the whole scene is between -1 and 1 in box space, however large or small it is") {
  for (const double size : {0x1p-1074, 0x1p-1022, 0x1p-1000, 0x1p-400, 1.0, 1.5, 0x1p400, 0x1p999, 0x1p1001,
                            0x1.8p1010, 0x1p1023, std::numeric_limits<double>::max()}) {
    CAPTURE(size);
    const Bounds everything{{-size, 0, -size / 2}, {size, size, size / 2}};
    const simd::BoxSpace space(everything);
    const simd::Box box = space(everything);
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(std::abs(space(everything.max)[axis]) <= 1);
      CHECK(std::abs(space(everything.min)[axis]) <= 1);
      // A box is larger by 2^-23 of itself, two roundings and 2^-126.
      CHECK(std::abs(box.min[axis]) <= 1 + 0x1p-22f);
      CHECK(std::abs(box.max[axis]) <= 1 + 0x1p-22f);
    }
    // At least a quarter, unless that takes a scale beyond 2^1000.
    if (size >= 0x1p-1000) CHECK(space(everything.max).x >= 0.25);
  }
}

TEST_CASE("every leaf whose box a ray hits is visited, and none twice") {
  struct Row {
    int count;
    double size, away;  // size of the boxes, distance of the scene from the coordinate origin
  };
  const auto row = GENERATE(Row{1, 0.5, 0}, Row{3, 0.5, 0}, Row{100, 0.2, 0}, Row{100, 0, 0},
                            Row{9000, 0.02, 0}, Row{3000, 0.05, 65537}, Row{300, 1e-9, 1e9});
  CAPTURE(row.count, row.size, row.away);
  Random random(static_cast<std::uint64_t>(row.count));
  const Point center(row.away, -row.away, row.away);
  const auto bounds = random_bounds(random, row.count, row.size, center);
  const Bvh tree = tree_of(bounds);
  int met = 0, needless = 0;
  for (int i = 0; i < 600; ++i) {
    Point origin = center + random.point(2);
    Vec3 direction = random.direction() * std::exp2(random.real(-40, 40));
    if (i % 3 == 0) {  // towards a corner of a box
      const Bounds& box = bounds[random.bits() % bounds.size()];
      direction = Point{box.min.x, box.max.y, box.min.z} - origin;
    }
    if (i % 3 == 1) {  // close to a corner, where float no longer tells it from the origin
      const Bounds& box = bounds[random.bits() % bounds.size()];
      const Vec3 step = random.direction();
      direction = step;
      origin = Point{box.min.x, box.max.y, box.min.z} - std::exp2(random.real(-40, -10)) * step;
    }
    if (i % 5 == 0) direction[i % 3] = i % 2 ? 0.0 : -0.0;
    const Ray ray{origin, direction};
    const Interval range = i % 4 ? Interval{} : Interval{0, 1};
    const auto found = along(tree, ray, range);
    for (std::uint32_t k = 0; k < bounds.size(); ++k) {
      const bool is_met = meets(ray, range, bounds[k]);
      const bool is_visited = std::binary_search(found.begin(), found.end(), k);
      if (is_met && !is_visited) FAIL("ray " << i << " misses box " << k);
      met += is_met;
      needless += is_visited && !is_met;
    }
  }
  CHECK(met > 0);
  if (row.count >= 3000) CHECK(needless < 600 * row.count / 10);  // most boxes that are missed are culled
}

TEST_CASE("a ray along an edge of a leaf's box visits the leaf") {
  const std::vector<Bounds> bounds{{Point{0}, Point{1}}, {Point{2}, Point{3}}};
  const Bvh tree = tree_of(bounds, {.most = 1});
  const double edge = GENERATE(0.0, 1.0);
  for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{1, -0.0, 0.0}, Vec3{-1, 0.0, -0.0}}) {
    const Ray ray{Point{-5 * direction.x, edge, edge}, direction};
    CHECK(along(tree, ray, {}) == std::vector<std::uint32_t>{0});
  }
}

TEST_CASE("a ray that is widened to hit all boxes visits all leaves") {
  Random random(1);
  const Bvh tree = tree_of(random_bounds(random, 1000, 0), {.most = 1});
  const Ray ray{.origin = {-5, 0, 0}, .direction = {1, 0, 0}};
  const BoxRay line(ray, tree.space(), 1);  // widened by 1, it hits all boxes
  int count = 0;
  simd::traverse(tree, AlongRay<Order::near_first>(tree, line, {0, line.at_most(infinity)}),
                 [&](Leaf) { return ++count > 1000; });
  CHECK(count == 1000);
}

TEST_CASE("traversal ends where a visit has shortened the reach, and when a visit returns true") {
  std::vector<Bounds> bounds;
  for (int i = 0; i < 100; ++i) bounds.push_back({Point(i, 0, 0), Point(i + 0.5, 1, 1)});
  const Bvh tree = tree_of(bounds, {.most = 1});
  const Ray ray{.origin = {-1, 0.5, 0.5}, .direction = {1, 0, 0}};
  const BoxRay line(ray, tree.space(), 0);
  std::vector<std::uint32_t> found;
  AlongRay<Order::near_first> search(tree, line, {0, line.at_most(infinity)});
  simd::traverse(tree, search, [&](Leaf leaf) {
    found.push_back(tree.order()[leaf.first]);
    if (found.size() == 3) search.reach.until = line.at_most(4.25);  // inside the fourth box
    return false;
  });
  CHECK(found == std::vector<std::uint32_t>{0, 1, 2, 3});

  int visits = 0;
  CHECK(simd::traverse(tree, AlongRay<Order::any>(tree, line, {0, line.at_most(infinity)}),
                       [&](Leaf) { return ++visits == 2; }));
  CHECK(visits == 2);
}

TEST_CASE("each primitive is in one leaf, and no leaf is too large, for any arrangement") {
  const auto leaf_size =
      GENERATE(simd::LeafSize{1}, simd::LeafSize{4}, simd::LeafSize{16}, simd::LeafSize{16, 8});
  const int kind = GENERATE(0, 1, 2, 3, 4, 5, 6, 7);
  CAPTURE(leaf_size.most, leaf_size.enough, kind);
  Random random(7);
  std::vector<Bounds> bounds;
  switch (kind) {
    case 0:
      break;
    case 1:
      bounds = {{Point{1}, Point{1}}};
      break;
    case 2:
      bounds.assign(5000, {Point{1}, Point{2}});
      break;  // all the same
    case 3:
      bounds.assign(5000, {Point{3}, Point{3}});
      break;  // all the same point
    case 4:   // each half as large as the last
      for (int i = 0; i < 1000; ++i) bounds.push_back({Point{0}, Point{std::exp2(-i)}});
      break;
    case 5:  // each half as far away as the last
      for (int i = 0; i < 2000; ++i) bounds.push_back({Point{std::exp2(-i)}, Point{std::exp2(-i)}});
      break;
    case 6:  // the largest numbers and the smallest
      for (const double x : {-1e308, -1e-308, 5e-324, 1e-300, 1.0, 1e308})
        bounds.push_back({Point{x}, Point{x}});
      bounds.push_back({Point{-1e308}, Point{1e308}});
      break;
    default:
      bounds = random_bounds(random, 3000, 0.1);
  }
  const Bvh tree = tree_of(bounds, leaf_size);
  const auto found = visited(tree, [&](const auto& visit) {
    tree.each_leaf([&](Leaf leaf) {
      CHECK(leaf.count >= 1);
      CHECK(leaf.count <= leaf_size.most);
      visit(leaf);
    });
  });
  CHECK(found.size() == bounds.size());
  CHECK(tree.order().size() == bounds.size());

  // A ray through a point of the first box visits that box.
  if (!bounds.empty() && kind != 6) {
    const Vec3 direction = random.direction();
    const auto met = along(tree, {bounds[0].max - direction, direction}, {});
    CHECK(std::binary_search(met.begin(), met.end(), 0u));
  }
}

/// Search for all leaves, with the children of each node at distances in no particular order. It counts the
/// nodes and children that it looks at, and keeps the distance of the last child that was not hidden.
struct Unordered {
  using Key = int;

  struct Children {
    simd::Bits met = 0;
    int operator[](int k) const { return (5 * k + 3) % 16; }
  };
  [[nodiscard]] Children look(const simd::Node& node) const {
    Children all;
    for (int k = 0; k < simd::node_width; ++k)
      if (node.has(k)) all.met |= simd::Bits{1} << k;
    ++nodes, children += std::popcount(all.met);
    return all;
  }
  [[nodiscard]] bool precedes(int a, int b) const { return a < b; }
  [[nodiscard]] bool is_hidden(int key) const { return last = key, key > farthest; }

  int farthest = 15;
  mutable int nodes = 0, children = 0, last = 0;
};

TEST_CASE("children are visited near to far, and hidden ones not at all") {
  Random random(8);
  const Bvh tree = tree_of(random_bounds(random, simd::node_width, 0.1), {.most = 1});
  Unordered search;
  std::vector<int> found;
  simd::traverse(tree, search, [&](Leaf) {
    found.push_back(search.last);
    if (found.size() == 2) search.farthest = 9;
    return false;
  });
  CHECK(search.nodes == 1);
  std::vector<int> expected;
  for (int k = 0; k < simd::node_width; ++k)
    if (const int key = Unordered::Children{}[k]; key <= 9) expected.push_back(key);
  std::sort(expected.begin(), expected.end());
  CHECK(found == expected);
}

TEST_CASE("more than nine tenths of all child slots are used, also if leaves would be slightly too large") {
  Random random(9);
  for (const int count : {20'000, 40'000, 70'000}) {
    CAPTURE(count);
    const Bvh tree = tree_of(random_bounds(random, count, 0.02), {.most = simd::node_width});
    const Unordered search;
    int leaves = 0;
    simd::traverse(tree, search, [&](Leaf) { return ++leaves, false; });
    CHECK(search.children == search.nodes - 1 + leaves);
    CHECK(search.children > search.nodes * simd::node_width * 9 / 10);
  }
}

TEST_CASE("a million coincident primitives have a tree like any others", "[long]") {
  const Bvh tree(1'000'000,
                 [](std::size_t) {
                   return Bounds{Point{1}, Point{1}};
                 },
                 {.most = 8}, {.threads = 2});
  std::size_t count = 0;
  tree.each_leaf([&](Leaf leaf) { count += leaf.count; });
  CHECK(count == 1'000'000);
  CHECK(along(tree, {Point{0}, Vec3{1}}, {}).size() == 1'000'000);
}

TEST_CASE("primitives without finite bounds are in no leaf") {
  const std::vector<Bounds> bounds{{Point{0}, Point{1}},
                                   {Point{-infinity}, Point{infinity}},
                                   {Point{0}, Point{1, infinity, 1}},
                                   {Point{std::nan("")}, Point{1}},
                                   {Point{2}, Point{3}}};
  const Bvh tree = tree_of(bounds);
  CHECK(std::vector(tree.unbounded().begin(), tree.unbounded().end()) == std::vector<std::uint32_t>{1, 2, 3});
  CHECK(visited(tree, [&](const auto& visit) { tree.each_leaf(visit); }) == std::vector<std::uint32_t>{0, 4});
}

TEST_CASE("a BVH is the same for any number of threads") {
  Random random(3);
  const auto bounds = random_bounds(random, 100000, 0.02);
  const Bvh one = tree_of(bounds, {.most = 4}, 1), several = tree_of(bounds, {.most = 4}, 3);
  const auto &order = one.order(), &other = several.order();
  CHECK(std::equal(order.begin(), order.end(), other.begin(), other.end()));
  std::vector<std::uint32_t> firsts[2];
  one.each_leaf([&](Leaf leaf) { firsts[0].push_back(leaf.first * 32 + leaf.count); });
  several.each_leaf([&](Leaf leaf) { firsts[1].push_back(leaf.first * 32 + leaf.count); });
  CHECK(firsts[0] == firsts[1]);
  // The boxes are compared by the leaves that rays visit.
  WrongCases differ(random);
  for (int i = 0; i < 1000; ++i) {
    const Ray ray{random.point(1), random.direction()};
    const auto leaves = [&](const Bvh& tree) {
      std::vector<std::uint32_t> along;
      const Reach unbounded{0, std::numeric_limits<float>::infinity()};
      simd::traverse(tree, AlongRay<Order::near_first>(tree, BoxRay(ray, tree.space(), 0), unbounded),
                     [&](Leaf leaf) {
                       along.push_back(leaf.first);
                       return false;
                     });
      return along;
    };
    differ.add(leaves(one) != leaves(several), ray);
  }
  CHECK(differ == 0);
}

TEST_CASE("a ray's direction in box space has length 1, however long it is in the world") {
  const Bvh tree = tree_of({{Point{-1}, Point{1}}});
  const double scale = tree.space().scale;
  Random random(21);
  for (int i = 0; i < 4000; ++i) {
    const double length =
        i % 2 ? 1 + (i % 4 - 2) * std::exp2(random.real(-50, -10)) : std::exp2(random.real(-40, 40));
    Vec3 direction = random.direction();
    if (i % 3 == 0) direction[i % 9 / 3] *= std::exp2(random.real(-100, 0));
    direction = normalize(direction) * length;
    const BoxRay line({Point{0}, direction}, tree.space(), 0);
    const double exact = glm::length(direction);
    // BoxRay's length is off by 2^-41 at most; a component by u = 2^-24 of its rounding, and by 2^-39.
    CHECK(line.length == Approx(exact * scale).epsilon(0x1p-40));
    for (int axis = 0; axis < 3; ++axis) {
      const double d = direction[axis] / exact, limit = std::max(std::abs(d), 0x1p-60);
      CHECK(std::abs(line.direction[axis] - d) <= 0x1.001p-24 * std::abs(d));
      CHECK(std::abs(line.inverse[axis] - std::copysign(1 / limit, d)) <= 0x1.001p-24 / limit);
    }
  }
}

TEST_CASE("boxes are widened by at least the error of a rounded line where it passes the tree") {
  Random random(22);
  WrongCases wrong(random);
  const AffineInverse same{Affine{}};
  const Ray outer;
  RayTransform transform(outer, same);
  for (int i = 0; i < 4000; ++i) {
    const Point middle = std::exp2(random.real(-10, 10)) * random.point(1);
    const Vec3 half = std::exp2(random.real(-10, 10)) * (random.point(0.5) + Vec3(0.5));
    const simd::BoxSpace space({middle - half, middle + half});
    // Lines from anywhere, and from the other side of the coordinate origin.
    const Point inside = middle + half * random.point(1);
    const Point origin = i % 2 ? -middle : inside + std::exp2(random.real(-10, 10)) * random.direction();
    const double t = std::exp2(random.real(-5, 5));
    const Vec3 direction = (inside - origin) / t, size = abs(direction);
    const double smallest = std::min({size.x, size.y, size.z});
    transform.line = {origin, direction, 0x1p-50 * abs(random.point(1)),
                      std::exp2(random.real(-53, -27)) * smallest * abs(random.point(1))};
    const Vec3 off = transform.line.origin_error + t * transform.line.direction_error;
    wrong.add(!(simd::widening(transform.ray(), space) >= length(off)), origin, direction, off);
  }
  CHECK(wrong == 0);
}

TEST_CASE("boxes are widened for a ray that leaves a sphere inward, and not for one that leaves it outward") {
  const simd::BoxSpace space;  // of objects that are as small as the world's unit
  for (const double r : {1.0, 0x1p60, 0x1p200}) {
    const Sphere ground{{0, -r, 0}, r};
    Ray ray{.origin = {0, 0x1p-60 * r, 0}, .direction = {0.6, 0.8, 0}, .departure = departure_of(ground)};
    CHECK(simd::widening(ray, space) == 0);  // else each ray from a large ground would visit all leaves
    ray.direction = {0.6, -0.8, 0};
    // The origin is 2^-60 r above the sphere, and so is the point at which the ray leaves it below.
    CHECK(simd::widening(ray, space) >= ray.origin.y);
  }
}

TEST_CASE("a ray that float cannot represent is marked as not usable") {
  const Bvh tree = tree_of({{Point{-1}, Point{1}}});
  const auto usable = [&](const Ray& ray) { return BoxRay(ray, tree.space(), 0).usable; };
  CHECK(usable({Point{3}, Vec3{1e-50, 0, 0}}));
  CHECK(usable({Point{3}, Vec3{1e100, 0, 1}}));
  CHECK_FALSE(usable({Point{3}, Vec3{0}}));
  CHECK_FALSE(usable({Point{3}, Vec3{1e-200, 0, 0}}));
  CHECK_FALSE(usable({Point{3}, Vec3{0, 1e200, 0}}));
  CHECK_FALSE(usable({Point{3}, Vec3{0, infinity, 0}}));
  CHECK_FALSE(usable({Point{3}, Vec3{0, std::nan(""), 0}}));
  CHECK_FALSE(usable({Point{1e30}, Vec3{1}}));
  CHECK_FALSE(usable({Point{0, 0, infinity}, Vec3{1}}));
  CHECK_FALSE(usable({Point{0, std::nan(""), 0}, Vec3{1}}));

  // In huge trees, unit vectors are held, and others if they are long enough, and have squares.
  const auto usable_among = [](double size, const Vec3& direction) {
    return BoxRay({Point{0.5 * size}, direction}, simd::BoxSpace({Point{-size}, Point{size}}), 0).usable;
  };
  for (const double size : {0x1p399, 0x1p401, 0x1p1000, 0x1p1023}) CHECK(usable_among(size, {0, 0.6, 0.8}));
  CHECK(usable_among(0x1p398, {0, 6, 8}));
  CHECK_FALSE(usable_among(0x1p403, {0, 6, 8}));
  CHECK(usable_among(0x1p900, {0, 0x1p511, 0}));
  CHECK_FALSE(usable_among(0x1p900, {0, 0x1p512, 0}));
}

TEST_CASE("a sphere's bounds contain it, rounding included") {
  Random random(11);
  for (int i = 0; i < 1000; ++i) {
    const Sphere sphere{random.point(std::exp2(random.real(-60, 60))),
                        std::exp2(random.real(-60, 60)) * (i % 2 ? 1 : -1)};
    const Bounds bounds = sphere.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      // The differences from the center are exact as double-doubles.
      const DoubleDouble below = two_sum(sphere.center[axis], -bounds.min[axis]);
      const DoubleDouble above = two_sum(bounds.max[axis], -sphere.center[axis]);
      CHECK((below - DoubleDouble(std::abs(sphere.radius))).sign() >= 0);
      CHECK((above - DoubleDouble(std::abs(sphere.radius))).sign() >= 0);
    }
  }
}
