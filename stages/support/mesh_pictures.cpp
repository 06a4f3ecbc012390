// See mesh_pictures.hpp.

#include "mesh_pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template class simd::SceneTiles<ShadowIntegrator, Mesh, Plane>;

}  // namespace protostar::inline PROTOSTAR_ABI
