// See pictures.hpp.

#include "pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

template class SceneTiles<WhittedIntegrator, Sphere, Parallelogram>;

}  // namespace protostar::inline PROTOSTAR_ABI::simd
