// Declares the pictures that stages draw, which are compiled once for all of them (support/pictures.cpp), so
// that a stage's own source compiles in about a second.
#pragma once

#include <protostar/protostar.hpp>

#include "scene_of_units.hpp"

namespace protostar::inline PROTOSTAR_ABI {

extern template void render(Image&, const Camera&, const Scene<Sphere>&, const BinaryIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const ColorIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const DepthIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const DiffuseIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const NormalIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const ShadowIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere>&, const TransparencyIntegrator&,
                            const RenderOptions&);
extern template void render(Image&, const Camera&, const Scene<Sphere, Plane, Parallelogram>&,
                            const WhittedIntegrator&, const RenderOptions&);

extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const BinaryIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const ColorIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const DepthIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const DiffuseIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const NormalIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const ShadowIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&, const SceneOfUnits<Scene<Sphere>>&,
                                 const TransparencyIntegrator&, const RenderOptions&);
extern template void add_samples(Film&, const SampleRange&, const Camera&,
                                 const SceneOfUnits<Scene<Sphere, Plane, Parallelogram>>&,
                                 const WhittedIntegrator&, const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI
