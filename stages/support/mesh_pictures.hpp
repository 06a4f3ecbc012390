// Pictures of a mesh over a plane, compiled apart from the stage that draws them (support/mesh_pictures.cpp).
#pragma once

#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/plane.hpp>

namespace protostar::inline PROTOSTAR_ABI {

extern template class simd::SceneTiles<ShadowIntegrator, Mesh, Plane>;

}  // namespace protostar::inline PROTOSTAR_ABI
