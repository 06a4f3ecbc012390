// What the headers below leave to be compiled once, and in one piece: pictures have most of their code in
// common, whatever the integrator and the surfaces.
#include "pictures.hpp"
#include "any_surfaces.hpp"
#include "mesh_pictures.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template class simd::SceneTiles<BinaryIntegrator, Sphere>;
template class simd::SceneTiles<ColorIntegrator, Sphere>;
template class simd::SceneTiles<DepthIntegrator, Sphere>;
template class simd::SceneTiles<DiffuseIntegrator, Sphere>;
template class simd::SceneTiles<NormalIntegrator, Sphere>;
template class simd::SceneTiles<ShadowIntegrator, Sphere>;
template class simd::SceneTiles<TransparencyIntegrator, Sphere>;
template class simd::SceneTiles<WhittedIntegrator, Sphere, Plane, Parallelogram>;

template AnySurface::AnySurface(Box);
template AnySurface::AnySurface(Csg);
template AnySurface::AnySurface(Disk);
template AnySurface::AnySurface(Instance<Csg>);
template AnySurface::AnySurface(Parallelogram);
template AnySurface::AnySurface(Plane);
template AnySurface::AnySurface(Quadric);
template AnySurface::AnySurface(Sphere);
template AnySurface::AnySurface(Triangle);

template class simd::SceneTiles<ShadowIntegrator, Plane, AnySurface>;

template class simd::SceneTiles<ShadowIntegrator, Mesh, Plane>;

}  // namespace protostar::inline PROTOSTAR_ABI
