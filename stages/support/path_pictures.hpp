// Declares pictures by paths, of spheres and parallelograms, which are compiled once for all stages
// (support/pictures.cpp).
#pragma once

#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/path.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>

namespace protostar::inline PROTOSTAR_ABI {

extern template void render(Image&, const Camera&, const Scene<Sphere, Parallelogram>&, const PathIntegrator&,
                            const RenderOptions&);

}  // namespace protostar::inline PROTOSTAR_ABI
