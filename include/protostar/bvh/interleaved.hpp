// Interleaved traversal of one BVH by many rays: while one waits for memory, others go on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bvh.hpp"
#include "ray_in_bvh.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Does what each_along does for one ray, for `count` queries. make(k) makes the k-th; a query has a ray and
/// a range, and is the first argument of visit and visit_leaf. Calls done(k, query) when the traversal of the
/// k-th has ended: all was visited, or a visit returned true.
template <Order order>
void each_along_interleaved(const Bvh& bvh, std::size_t count, const auto& make, const auto& done,
                            const auto& visit, const auto& visit_leaf, const auto& soon) {
  using Query = decltype(make(std::size_t{0}));
  struct Traveller {
    std::size_t number;
    Query query;
    BoxRay line;
    Bvh::Walk<order> walk;

    Traveller(const Bvh& bvh, std::size_t k, decltype(make) make_query)
        : number(k),
          query(make_query(k)),  // made in place, since a ray is large
          line(query.ray, bvh.space(), widening(query, bvh.space())),
          walk(bvh, line, {line.at_least(query.range.min), line.at_most(query.range.max)}) {}
  };
  // Enough for prefetched data to have mostly arrived by a ray's next turn.
  constexpr std::size_t at_a_time = 16;
  std::optional<Traveller> travellers[at_a_time];

  // Replaces a query that is done by the next one that has nodes or leaves to visit.
  std::size_t next = 0, on_the_way = 0;
  const auto start = [&](std::optional<Traveller>& traveller) {
    while (next < count) {
      const std::size_t k = next++;
      Traveller& one = traveller.emplace(bvh, k, make);
      const auto visit_one = [&](std::uint32_t i) { return visit(one.query, i); };
      if (!any_of(bvh.unbounded(), visit_one)) {
        if (!helps(one.line, one.query.range))
          any_of(bvh.order(), visit_one);
        else if (!one.walk.has_ended())
          return;
      }
      done(k, one.query);
    }
    traveller.reset();
    --on_the_way;
  };
  for (std::optional<Traveller>& traveller : travellers) {
    ++on_the_way;
    start(traveller);
  }

  while (on_the_way > 0)
    for (std::optional<Traveller>& traveller : travellers) {
      if (!traveller) continue;
      auto& [number, query, line, walk] = *traveller;
      bool is_content = false;
      if (!walk.is_at_leaf())
        walk.open();
      else if (visit_leaf(query, line, walk.leaf(), walk.reach))
        is_content = true;
      else
        walk.leave();
      if (is_content || walk.has_ended()) {
        done(number, query);
        start(traveller);
        if (!traveller) continue;
      }
      walk.fetch_next(soon);
    }
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd
