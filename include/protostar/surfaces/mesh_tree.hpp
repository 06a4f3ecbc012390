// BVH over the triangles of a mesh, from accel/, or a list in a library without that folder.
//
// PROTOSTAR_MESH_TREE is defined if there is accel/, and a mesh can then be rasterized into a tile.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../render_options.hpp"

#if __has_include("../accel/triangles_in_tile.hpp")
#include "../accel/triangles_in_tile.hpp"
#define PROTOSTAR_MESH_TREE 1
#endif

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

#if defined(PROTOSTAR_MESH_TREE)
using simd::TriangleTree;
#else
/// Stands in for the BVH without accel/: tries all triangles in turn.
class TriangleTree {
 public:
  static constexpr std::size_t most = std::size_t{1} << 27;

  TriangleTree(std::size_t count, const auto&, const RenderOptions&)
      : count_(static_cast<std::uint32_t>(count)) {}

  void answer(auto& query, const auto& triangle) const {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (query.maybe(triangle(i), i)) return;
  }
  void answer_each(std::size_t count, const auto& make, const auto& done, const auto& triangle) const {
    for (std::size_t k = 0; k < count; ++k) {
      auto query = make(k);
      answer(query, triangle);
      done(k, query);
    }
  }

 private:
  std::uint32_t count_;
};
#endif

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
