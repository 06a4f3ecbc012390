// Declares pictures by integrators that draw light by chance, which are compiled once for all stages
// (support/chance_pictures.cpp).
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/integrators/ambient_occlusion.hpp>
#include <protostar/integrators/direct.hpp>
#include <protostar/integrators/path.hpp>

#include "stage_render.hpp"

namespace protostar::inline PROTOSTAR_ABI {

extern template AreaLights::AreaLights(const AnyScene&);
extern template AreaLights::AreaLights(const Scene<Sphere, Parallelogram>&);
extern template EnvironmentLight::EnvironmentLight(const AnyScene&);
extern template EnvironmentLight::EnvironmentLight(const Scene<Sphere, Parallelogram>&);

extern template void render(Image&, const Camera&, const AnyScene&, const AmbientOcclusionIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const DirectIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const AnyScene&, const PathIntegrator&,
                            const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI

extern template struct StagePicture<protostar::AnyScene, protostar::AmbientOcclusionIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::DirectIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::PathIntegrator>;

extern template struct StagePicture<protostar::Scene<protostar::Sphere, protostar::Parallelogram>,
                                    protostar::PathIntegrator>;
