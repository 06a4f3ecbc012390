// The surfaces that each tile of a picture may see.
#pragma once

#include "../image.hpp"
#include "../surface.hpp"
#include "accelerate.hpp"
#include "candidates.hpp"
#include "frustum.hpp"
#include "pixel_rays.hpp"
#include "sphere_around.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Candidates for the tiles of a picture: a list of all surfaces, of which a tile culls those that it cannot
/// see. In a scene of so many that their data fit in no cache, each tile finds its own in the BVH.
template <Surface... S>
class PictureCandidates {
 public:
  /// Borrows the scene and the rays.
  PictureCandidates(const Accelerated<Scene<S...>>& scene, const PixelRays& rays, Candidates::Order order)
      : scene_(scene), rays_(rays), order_(order) {
    int index = 0;
    if (!are_from_bvh()) (add_all<S>(index), ...);
    all_.sort(order);
  }

  /// Returns true if each tile finds its candidates in the BVH.
  [[nodiscard]] bool are_from_bvh() const { return scene_.scene().size() > 2048; }

  /// Finds the surfaces that the rays of a tile may hit: those of all candidates that its frustum does not
  /// cull, or those that the BVH finds in its half-spaces.
  void find(const Tile& tile, const Frustum& frustum, Candidates& candidates) const {
    candidates.clear();
    if (!are_from_bvh()) return candidates.add(all_, frustum);
    scene_.frustum_query(TileHalfSpaces(rays_, tile).side, [&](const SurfacesAround& surfaces) {
      candidates.add(surfaces.indices, surfaces.lanes, rays_.viewpoint(), surfaces.around);
    });
    candidates.sort(order_);
  }

 private:
  /// Adds all surfaces of one type; `index` is that of the first, and becomes that of the next type's.
  template <Surface T>
  void add_all(int& index) {
    for (const T& surface : scene_.scene().template surfaces<T>())
      all_.add(index++, rays_.viewpoint(), sphere_around(surface));
  }

  const Accelerated<Scene<S...>>& scene_;
  const PixelRays& rays_;
  Candidates::Order order_;
  Candidates all_;  ///< all surfaces; none if tiles find them in the BVH
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd
