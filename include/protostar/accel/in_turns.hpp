// Many rays through one tree of boxes, some of them on their way at a time: what one of them needs next comes
// from memory while the others go on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bvh.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// What each_along does for one ray, for those of many queries. make(k) makes the k-th of `count`; a query
/// has a ray and a range, and is the first that visit and visit_leaf get. done(k, query) is called when all
/// that the k-th asks for was visited.
template <Order order>
void each_along_in_turns(const Bvh& bvh, std::size_t count, const auto& make, const auto& done,
                         const auto& visit, const auto& visit_leaf, const auto& soon) {
  using Query = decltype(make(std::size_t{0}));
  struct Traveller {
    std::size_t number;
    Query query;
    BoxRay line;
    Bvh::Walk<order> walk;

    Traveller(const Bvh& bvh, std::size_t k, decltype(make) make_query)
        : number(k),
          query(make_query(k)),  // in its place, since a ray is large
          line(query.ray, bvh.space(), widening(query, bvh.space())),
          walk(bvh, line, {line.at_least(query.range.min), line.at_most(query.range.max)}) {}
  };
  // Enough that what is fetched has mostly come when its turn is.
  constexpr std::size_t at_a_time = 16;
  std::optional<Traveller> travellers[at_a_time];

  // Puts the next query that has a way to go in the place of one that is done.
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
