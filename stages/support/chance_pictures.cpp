// Instantiates pictures by integrators that draw light by chance, once.
#include "chance_pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template AreaLights::AreaLights(const AnyScene&);
template AreaLights::AreaLights(const Scene<Sphere, Parallelogram>&);
template EnvironmentLight::EnvironmentLight(const AnyScene&);
template EnvironmentLight::EnvironmentLight(const Scene<Sphere, Parallelogram>&);

template void render(Image&, const Camera&, const AnyScene&, const AmbientOcclusionIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const DirectIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const PathIntegrator&, const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI

using namespace protostar;

template struct StagePicture<AnyScene, AmbientOcclusionIntegrator>;
template struct StagePicture<AnyScene, DirectIntegrator>;
template struct StagePicture<AnyScene, PathIntegrator>;

template struct StagePicture<Scene<Sphere, Parallelogram>, PathIntegrator>;
