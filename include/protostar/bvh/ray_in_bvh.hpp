// Primitives of a BVH that a ray of the scene may meet, and the length by which its boxes are widened for the
// ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "../interval.hpp"
#include "../ray.hpp"
#include "../transformed_ray.hpp"
#include "box_space.hpp"
#include "bvh.hpp"
#include "traversal.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Returns a length by which a ray in an instance's object space is at most off from the exact one where it
/// passes a box of a tree: the error of its origin and t times that of its direction; infinite if the
/// direction is off by more than 2^-24 of itself. In the tree, which is within 1/scale of its center on each
/// axis, t |d| is at most the distance of the origin from the center and 3/scale, where |d| is the largest
/// component. Twice the sum covers the roundings here.
[[nodiscard]] inline double error_of(const RayTransform& transform, const BoxSpace& space) {
  double origin_error = 0, direction_error = 0, longest = 0, distance = 3 / space.scale;
  for (int i = 0; i < 3; ++i) {
    origin_error += transform.line.origin_error[i], direction_error += transform.line.direction_error[i];
    longest = std::max(longest, std::abs(transform.line.direction[i]));
    distance += std::abs(transform.line.origin[i] - space.center[i]);
  }
  // Distances along the ray are compared with a margin of 2^-20 of themselves (BoxRay::at_least).
  if (!(direction_error <= 0x1p-24 * longest)) return std::numeric_limits<double>::infinity();
  return 2 * (origin_error + distance * (direction_error / longest));
}

/// Returns the length, ≥ 0, in the coordinates of the primitives' bounds (not box space), by which all boxes
/// must be widened to stay conservative for a ray that departs from a sphere, or that is rounded itself;
/// infinite if boxes cannot be used.
///
/// A ray that leaves a sphere outward does not hit it again, whatever its bounds say. Any other ray that
/// departs from a sphere starts on the sphere by definition, whatever its digits say. If these put its origin
/// outside, they put the other root, 2b/A, outside too: the point there is as far from the center as the
/// origin is, at the distance D = |l|. With D ≥ r, D − r = (D² − r²)/(D + r) is at most (D² − r²)/2r. With u
/// = 2^-53, the difference of the squares is off by at most 6u D² + 2u r², and what follows rounds by 2u of
/// it and a quotient: 2^-49 = 16u covers both.
[[nodiscard, gnu::always_inline]] inline double widening(const Ray& ray, const BoxSpace& space) {
  if (ray.transform != nullptr) return error_of(*ray.transform, space);
  if (ray.departure.kind != Departure::Kind::sphere || leaves_outward(ray)) return 0;
  const auto& [x, y, z, r] = ray.departure.geometry;
  const Vec3 l = Point{x, y, z} - ray.origin;
  const double ll = dot(l, l), rr = r * r;
  return std::max(0.0, ll - rr + 0x1p-49 * (ll + rr)) * (0.5 / r);
}

/// Returns the widening for a query. If it has a distance(), its ray truly starts up to so far from the
/// origin of its ray, on each axis, as rays do that leave a triangle of a mesh.
[[nodiscard]] double widening(const auto& query, const BoxSpace& space) {
  if constexpr (requires { query.distance(); })
    return widening(query.ray, space) + query.distance();
  else
    return widening(query.ray, space);
}

/// Returns true if visit(i) is true for any of the primitives.
bool any_of(std::span<const std::uint32_t> things, const auto& visit) {
  for (const std::uint32_t i : things)
    if (visit(i)) return true;
  return false;
}

/// Returns true if the boxes may be used: the ray fits float, and range.min ≥ 0, since behind the origin
/// their ends are not widened (Slabs). Otherwise the caller visits all primitives, in time proportional to
/// their number; trace a reversed ray for t < 0, as Mesh::each_crossing does.
[[nodiscard]] inline bool helps(const BoxRay& line, const Interval& range) {
  return line.usable && range.min >= 0;
}

/// Outcome of visits: one returned true, none did and all primitives were visited, or leaves remain.
enum class Visited : std::uint8_t { until_true, all, some };

/// Calls visit(i) for the primitives that are in no leaf of a tree, or for all primitives if boxes do not
/// help, until a call returns true.
Visited each_without_box(const Bvh& bvh, const BoxRay& line, const Interval& range, const auto& visit) {
  const bool in_leaves = helps(line, range) && !bvh.order().empty();
  if (any_of(bvh.unbounded(), visit) || (!in_leaves && any_of(bvh.order(), visit)))
    return Visited::until_true;
  return in_leaves ? Visited::some : Visited::all;
}

/// Returns the search for the leaves that a ray may meet inside a range.
template <Order order>
AlongRay<order> search_along(const Bvh& bvh, const BoxRay& line, const Interval& range) {
  return {bvh, line, {line.at_least(range.min), line.at_most(range.max)}};
}

/// Calls visit(i) for the primitives that boxes tell nothing of, and visit_leaf(BoxRay, leaf, reach) for
/// every leaf that a ray may meet inside the range, until a call returns true; returns true if one did. A
/// visit may shorten the reach if near leaves come first. Calls fetch(leaf) for leaves that have to wait, and
/// prefetches nodes that do, unless fetch is Ignore.
template <Order order, class Fetch = Ignore>
[[gnu::always_inline]] inline bool each_along(const Bvh& bvh, const BoxRay& line, const Interval& range,
                                              const auto& visit, const auto& visit_leaf,
                                              const Fetch& fetch = {}) {
  const Visited visited = each_without_box(bvh, line, range, visit);
  if (visited != Visited::some) return visited == Visited::until_true;
  auto search = search_along<order>(bvh, line, range);
  const auto visit_one = [&](Leaf leaf) { return visit_leaf(line, leaf, search.reach); };
  if constexpr (std::is_same_v<Fetch, Ignore>)
    return traverse(bvh, search, visit_one);
  else
    return traverse(bvh, search, visit_one, FetchChild<Read::soon, Fetch>{bvh, fetch});
}

template <Order order, class Fetch = Ignore>
[[gnu::always_inline]] inline bool each_along(const Bvh& bvh, const Ray& ray, const Interval& range,
                                              const auto& visit, const auto& visit_leaf,
                                              const Fetch& fetch = {}) {
  return each_along<order>(bvh, BoxRay(ray, bvh.space(), widening(ray, bvh.space())), range, visit,
                           visit_leaf, fetch);
}

/// Does what each_along does for one ray, for `count` queries that take turns: while one waits for memory,
/// others go on. make(k) makes the k-th; a query has a ray and a range, and is the first argument of visit
/// and visit_leaf. Calls done(k, query) when the traversal of the k-th has ended.
template <Order order, class Fetch>
void each_along_interleaved(const Bvh& bvh, std::size_t count, const auto& make, const auto& done,
                            const auto& visit, const auto& visit_leaf, const Fetch& fetch) {
  struct Traveller {
    std::size_t number;
    decltype(make(std::size_t{0})) query;
    BoxRay line;
    AlongRay<order> search;
    Waiting<AlongRay<order>> waiting;
    Traversal<AlongRay<order>> traversal;

    Traveller(const Bvh& in, std::size_t k, decltype(make) make_query)
        : number(k),
          query(make_query(k)),  // made in place, since a ray is large
          line(query.ray, in.space(), widening(query, in.space())),
          search(search_along<order>(in, line, query.range)),
          traversal(in, waiting) {}
  };
  // Enough for prefetched data to have mostly arrived by a ray's next turn.
  constexpr std::size_t at_a_time = 16;
  std::optional<Traveller> travellers[at_a_time];

  // Replaces a query that is done by the next one that has nodes or leaves to visit.
  std::size_t next = 0, on_the_way = at_a_time;
  const auto start = [&](std::optional<Traveller>& traveller) {
    while (next < count) {
      Traveller& one = traveller.emplace(bvh, next++, make);
      if (each_without_box(bvh, one.line, one.query.range,
                           [&](std::uint32_t i) { return visit(one.query, i); }) == Visited::some)
        return;
      done(one.number, one.query);
    }
    traveller.reset();
    --on_the_way;
  };
  for (std::optional<Traveller>& traveller : travellers) start(traveller);

  const FetchChild<Read::later, Fetch> fetch_next{bvh, fetch};
  while (on_the_way > 0)
    for (std::optional<Traveller>& traveller : travellers) {
      if (!traveller) continue;
      Traveller& one = *traveller;
      const auto visit_one = [&](Leaf leaf) {
        return visit_leaf(one.query, one.line, leaf, one.search.reach);
      };
      if (!one.traversal.step(one.search, visit_one)) {
        done(one.number, one.query);
        start(traveller);
        if (!traveller) continue;
      }
      fetch_next(traveller->traversal.next());
    }
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd
