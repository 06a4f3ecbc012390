// See any_surfaces.hpp.

#include "any_surfaces.hpp"

namespace protostar::inline PROTOSTAR_ABI {

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

}  // namespace protostar::inline PROTOSTAR_ABI
