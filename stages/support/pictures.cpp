// Instantiates the templates of the headers below once, and in one unit: pictures have most of their code in
// common, with any integrator and surfaces.
#include "pictures.hpp"
#include "any_surfaces.hpp"
#include "mesh_pictures.hpp"
#include "path_pictures.hpp"

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
template void render(Image&, const Camera&, const Scene<Sphere, Plane, Parallelogram>&,
                     const WhittedIntegrator&, const RenderOptions&);

template AnySurface::AnySurface(Box);
template AnySurface::AnySurface(Csg);
template AnySurface::AnySurface(Disk);
template AnySurface::AnySurface(Instance<Csg>);
template AnySurface::AnySurface(Parallelogram);
template AnySurface::AnySurface(Plane);
template AnySurface::AnySurface(Quadric);
template AnySurface::AnySurface(Sphere);
template AnySurface::AnySurface(Triangle);

template void render(Image&, const Camera&, const Scene<Plane, AnySurface>&, const ShadowIntegrator&,
                     const RenderOptions&);

template void render(Image&, const Camera&, const Scene<Mesh, Plane>&, const ShadowIntegrator&,
                     const RenderOptions&);

template void render(Image&, const Camera&, const Scene<Sphere, Parallelogram>&, const PathIntegrator&,
                     const RenderOptions&);

template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const BinaryIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const ColorIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const DepthIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const DiffuseIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const NormalIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const ShadowIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                          const TransparencyIntegrator&, const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&,
                          const SceneOfUnits<Scene<Sphere, Plane, Parallelogram>>&, const WhittedIntegrator&,
                          const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&,
                          const SceneOfUnits<Scene<Plane, AnySurface>>&, const ShadowIntegrator&,
                          const RenderOptions&);
template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Mesh, Plane>>&,
                          const ShadowIntegrator&, const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI
