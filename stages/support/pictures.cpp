// See pictures.hpp.

#include "pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template class simd::SceneTiles<BinaryIntegrator, Sphere>;
template class simd::SceneTiles<ColorIntegrator, Sphere>;
template class simd::SceneTiles<DepthIntegrator, Sphere>;
template class simd::SceneTiles<DiffuseIntegrator, Sphere>;
template class simd::SceneTiles<NormalIntegrator, Sphere>;
template class simd::SceneTiles<ShadowIntegrator, Sphere>;
template class simd::SceneTiles<TransparencyIntegrator, Sphere>;

}  // namespace protostar::inline PROTOSTAR_ABI
