// Instantiates surfaces of any type, and pictures of them, once.
#include "any_surfaces.hpp"
#include "pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template AnySurface::AnySurface(Box);
template AnySurface::AnySurface(Csg);
template AnySurface::AnySurface(Disk);
template AnySurface::AnySurface(Instance<Csg>);
template AnySurface::AnySurface(Marched<fields::Field>);
template AnySurface::AnySurface(Moving<Sphere>);
template AnySurface::AnySurface(Parallelogram);
template AnySurface::AnySurface(Plane);
template AnySurface::AnySurface(Quadric);
template AnySurface::AnySurface(Sphere);
template AnySurface::AnySurface(Torus);
template AnySurface::AnySurface(Triangle);

template void render(Image&, const Camera&, const AnyScene&, const BinaryIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const ColorIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const DepthIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const DiffuseIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const NormalIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const ShadowIntegrator&, const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const TransparencyIntegrator&,
                     const RenderOptions&);
template void render(Image&, const Camera&, const AnyScene&, const WhittedIntegrator&, const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI

using namespace protostar;

template struct StagePicture<AnyScene, BinaryIntegrator>;
template struct StagePicture<AnyScene, ColorIntegrator>;
template struct StagePicture<AnyScene, DepthIntegrator>;
template struct StagePicture<AnyScene, DiffuseIntegrator>;
template struct StagePicture<AnyScene, NormalIntegrator>;
template struct StagePicture<AnyScene, ShadowIntegrator>;
template struct StagePicture<AnyScene, TransparencyIntegrator>;
template struct StagePicture<AnyScene, WhittedIntegrator>;
