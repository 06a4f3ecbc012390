// Declares load_mesh, and pictures of a mesh over a plane, which are compiled apart from the stage that draws
// them (support/load_mesh.cpp, support/pictures.cpp).
#pragma once

#include <filesystem>
#include <functional>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/plane.hpp>

#include "stage_render.hpp"

/// Returns the mesh that load_obj reads, with each vertex v moved to place(v).
protostar::Mesh load_mesh(const std::filesystem::path& path,
                          const std::function<protostar::Point(const protostar::Point&)>& place);

namespace protostar::inline PROTOSTAR_ABI {

extern template void render(Image&, const Camera&, const Scene<Mesh, Plane>&, const ShadowIntegrator&,
                            const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI

extern template struct StagePicture<protostar::Scene<protostar::Mesh, protostar::Plane>,
                                    protostar::ShadowIntegrator>;
