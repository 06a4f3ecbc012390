// See pictures.hpp.

#include "pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

template class SceneTiles<BinaryIntegrator, Sphere>;
template class SceneTiles<ColorIntegrator, Sphere>;
template class SceneTiles<DepthIntegrator, Sphere>;
template class SceneTiles<DiffuseIntegrator, Sphere>;
template class SceneTiles<NormalIntegrator, Sphere>;
template class SceneTiles<ShadowIntegrator, Sphere>;
template class SceneTiles<TransparencyIntegrator, Sphere>;

}  // namespace protostar::inline PROTOSTAR_ABI::simd
