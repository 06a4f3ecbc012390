// See pictures.hpp.

#include "pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template class simd::SceneTiles<WhittedIntegrator, Sphere, Plane, Parallelogram>;

}  // namespace protostar::inline PROTOSTAR_ABI
