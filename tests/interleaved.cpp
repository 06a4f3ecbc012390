#include <protostar/bvh/node.hpp>
#include <protostar/bvh/ray_in_bvh.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"

using namespace protostar;
using simd::BoxRay;
using simd::Leaf;
using simd::Order;
using simd::Reach;

namespace {

/// Query that records the primitives that it is shown, and is done after `enough` of them.
struct Query {
  Ray ray;
  Interval range;
  std::size_t enough;
  std::vector<std::uint32_t> seen = {};

  bool see(std::uint32_t thing) {
    seen.push_back(thing);
    return seen.size() == enough;
  }
};

std::vector<Bounds> boxes(Random& random, int count) {
  std::vector<Bounds> bounds;
  for (int i = 0; i < count; ++i) {
    const Point center = random.point(1);
    const Vec3 half = abs(random.point(0.1));
    bounds.push_back({center - half, center + half});
  }
  return bounds;
}

/// Compares the primitives that each query sees by itself with those of the interleaved traversal.
template <Order order>
void compare(const simd::Bvh& tree, const std::vector<Query>& queries) {
  const auto visit = [](Query& query, std::uint32_t i) { return query.see(i); };
  const auto visit_leaf = [&](Query& query, const BoxRay&, Leaf leaf, Reach&) {
    for (std::uint32_t i = 0; i < leaf.count; ++i)
      if (query.see(tree.order()[leaf.first + i])) return true;
    return false;
  };
  std::vector<int> done(queries.size());
  std::size_t fetched = 0, seen = 0;
  int any_seen = 0, same_first = 0;
  simd::each_along_interleaved<order>(
      tree, queries.size(), [&](std::size_t k) { return queries[k]; },
      [&](std::size_t k, const Query& query) {
        ++done[k];
        Query alone = queries[k];
        simd::each_along<order>(
            tree, alone.ray, alone.range, [&](std::uint32_t i) { return visit(alone, i); },
            [&](const BoxRay& line, Leaf leaf, Reach& left) { return visit_leaf(alone, line, leaf, left); });
        if (order == Order::near_first && !alone.seen.empty() && tree.unbounded().empty()) {
          ++any_seen;
          same_first += query.seen.front() == alone.seen.front();
        }
        // The order may differ, and queries that end early may have seen any of their primitives.
        CHECK(query.seen.size() == alone.seen.size());
        auto interleaved = query.seen;
        std::sort(interleaved.begin(), interleaved.end());
        std::sort(alone.seen.begin(), alone.seen.end());
        CHECK((interleaved == alone.seen || query.seen.size() == query.enough));
        seen += query.seen.size();
      },
      visit, visit_leaf, [&](Leaf) { ++fetched; });
  CHECK(std::all_of(done.begin(), done.end(), [](int times) { return times == 1; }));
  CHECK((seen > 0) == !queries.empty());
  if (tree.nodes().size() > 1 && !queries.empty()) CHECK(fetched > 0);
  // The nearest child comes first, and only waiting children may have another order.
  CHECK(same_first >= 0.8 * any_seen);
}

}  // namespace

TEST_CASE(
    "interleaved rays visit the primitives that each of them visits by itself, and near ones first if "
    "requested") {
  const int count = GENERATE(1, 3, 500), without_bounds = GENERATE(0, 2);
  const std::size_t rays = GENERATE(0u, 1u, 16u, 200u);
  CAPTURE(count, without_bounds, rays);
  Random random(5);
  auto bounds = boxes(random, count);
  for (int i = 0; i < without_bounds; ++i) bounds.push_back({Point{-infinity}, Point{infinity}});
  const simd::Bvh tree(bounds.size(), [&](std::size_t i) { return bounds[i]; }, {.most = 4}, {.threads = 1});
  std::vector<Query> queries;
  for (std::size_t k = 0; k < rays; ++k) {
    const Point origin = 3.0 * random.direction(),
                target = k == 0 ? 0.5 * (bounds[0].min + bounds[0].max) : random.point(1);
    queries.push_back({.ray = {origin, target - origin},
                       .range = k % 5 == 1 ? Interval{-1, 1} : Interval{},
                       .enough = k % 3 == 1 ? 2u : 1000u});
    if (k % 7 == 3) queries.back().ray.origin.x = 1e300;  // float cannot represent it, so boxes do not help
  }
  compare<Order::near_first>(tree, queries);
  compare<Order::any>(tree, queries);
}

TEST_CASE("interleaved rays visit nothing in an empty tree") {
  const simd::Bvh tree(0, [](std::size_t) { return Bounds{}; }, {.most = 4}, {.threads = 1});
  int done = 0;
  simd::each_along_interleaved<Order::any>(
      tree, 20,
      [](std::size_t) {
        return Query{.ray = {{}, {1, 0, 0}}, .range = {}, .enough = 1};
      },
      [&](std::size_t, const Query& query) { done += query.seen.empty(); },
      [](Query&, std::uint32_t) { return true; }, [](Query&, const BoxRay&, Leaf, Reach&) { return true; },
      [](Leaf) {});
  CHECK(done == 20);
}
