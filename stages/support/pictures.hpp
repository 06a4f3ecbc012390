// The pictures that stages draw, compiled once for all of them (support/pictures.cpp), so that a stage's own
// source compiles in about a second.
#pragma once

#include <protostar/protostar.hpp>

namespace protostar::inline PROTOSTAR_ABI {

extern template class simd::SceneTiles<BinaryIntegrator, Sphere>;
extern template class simd::SceneTiles<ColorIntegrator, Sphere>;
extern template class simd::SceneTiles<DepthIntegrator, Sphere>;
extern template class simd::SceneTiles<DiffuseIntegrator, Sphere>;
extern template class simd::SceneTiles<NormalIntegrator, Sphere>;
extern template class simd::SceneTiles<ShadowIntegrator, Sphere>;
extern template class simd::SceneTiles<TransparencyIntegrator, Sphere>;
extern template class simd::SceneTiles<WhittedIntegrator, Sphere, Plane, Parallelogram>;

}  // namespace protostar::inline PROTOSTAR_ABI
