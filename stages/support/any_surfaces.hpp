// Declares surfaces of any type, and pictures of them on a plane, which are compiled once for all stages
// (support/pictures.cpp).
#pragma once

#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/sampling/film.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>

#include "scene_of_units.hpp"

namespace protostar::inline PROTOSTAR_ABI {

extern template AnySurface::AnySurface(Box);
extern template AnySurface::AnySurface(Csg);
extern template AnySurface::AnySurface(Disk);
extern template AnySurface::AnySurface(Instance<Csg>);
extern template AnySurface::AnySurface(Parallelogram);
extern template AnySurface::AnySurface(Plane);
extern template AnySurface::AnySurface(Quadric);
extern template AnySurface::AnySurface(Sphere);
extern template AnySurface::AnySurface(Triangle);

extern template void render(Image&, const Camera&, const Scene<Plane, AnySurface>&, const ShadowIntegrator&,
                            const RenderOptions&);

extern template void add_samples(Film&, const SampleRange&, const Camera&,
                                 const SceneOfUnits<Scene<Plane, AnySurface>>&, const ShadowIntegrator&,
                                 const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI
