// See pictures.hpp.

#include "pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

template class SceneTiles<WhittedIntegrator, Sphere, Plane, Parallelogram>;

}  // namespace protostar::inline PROTOSTAR_ABI::simd
