// The pictures that stages draw, compiled once for all of them (support/pictures.cpp, support/whitted.cpp),
// so that a stage's own source compiles in about a second.
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
extern template class SceneTiles<WhittedIntegrator, Sphere, Plane, Parallelogram>;

}  // namespace protostar::inline PROTOSTAR_ABI::simd
