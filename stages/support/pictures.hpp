// The pictures that stages draw of spheres, compiled once for all of them (support/pictures.cpp), so that a
// stage's own source compiles in about a second.
#pragma once

#include <protostar/protostar.hpp>

namespace protostar::inline PROTOSTAR_ABI::simd {

extern template class SceneTiles<BinaryIntegrator, Sphere>;
extern template class SceneTiles<ColorIntegrator, Sphere>;
extern template class SceneTiles<DepthIntegrator, Sphere>;
extern template class SceneTiles<DiffuseIntegrator, Sphere>;
extern template class SceneTiles<NormalIntegrator, Sphere>;
extern template class SceneTiles<ShadowIntegrator, Sphere>;
extern template class SceneTiles<TransparencyIntegrator, Sphere>;

}  // namespace protostar::inline PROTOSTAR_ABI::simd
