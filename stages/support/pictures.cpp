// Instantiates pictures of spheres and of a mesh once, and in one unit: pictures have most of their code in
// common, with any integrator and surfaces.
#include "pictures.hpp"
#include "mesh_pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template void render(Image&, const Camera&, const Scene<Sphere>&, const BinaryIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Sphere>&, const ColorIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Sphere>&, const DepthIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Sphere>&, const DiffuseIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Sphere>&, const NormalIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Sphere>&, const ShadowIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Sphere>&, const TransparencyIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const Scene<Mesh, Plane>&, const ShadowIntegrator&,
                     const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI

using namespace protostar;

template struct StagePicture<Scene<Sphere>, BinaryIntegrator>;
template struct StagePicture<Scene<Sphere>, ColorIntegrator>;
template struct StagePicture<Scene<Sphere>, DepthIntegrator>;
template struct StagePicture<Scene<Sphere>, DiffuseIntegrator>;
template struct StagePicture<Scene<Sphere>, NormalIntegrator>;
template struct StagePicture<Scene<Sphere>, ShadowIntegrator>;
template struct StagePicture<Scene<Sphere>, TransparencyIntegrator>;

template struct StagePicture<Scene<Mesh, Plane>, ShadowIntegrator>;
