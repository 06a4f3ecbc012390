// Exact crossings of a ray with the surfaces of a scene, in their order.
#pragma once

#include <algorithm>
#include <protostar/interval.hpp>
#include <protostar/ray.hpp>
#include <vector>

#include "surface_roots.hpp"
#include "tree_roots.hpp"

namespace exact {

/// Crossing with one surface of a scene, which is given by its number.
struct Hit {
  Root root;
  int surface;
};

/// Adds the crossings of a ray and a surface of this number with 0 < t < end; left is a bool, or Left.
template <class S>
void add_hits(std::vector<Hit>& hits, const protostar::Ray& ray, const S& surface, int number, auto left,
              double end) {
  for (const Root& root : roots(ray, surface, left))
    if (root.t > 0 && (end == protostar::infinity || compare(root, root_at(end)) < 0))
      hits.push_back({root, number});
}

/// Sorts crossings in the order of t; crossings at equal t keep their order.
inline void sort(std::vector<Hit>& hits) {
  std::stable_sort(hits.begin(), hits.end(),
                   [](const Hit& a, const Hit& b) { return compare(a.root, b.root) < 0; });
}

}  // namespace exact
