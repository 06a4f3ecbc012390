// Declares surfaces of any type, which are compiled once for all stages (support/any_pictures.cpp).
#pragma once

#include <protostar/fields/field.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/moving.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/torus.hpp>
#include <protostar/surfaces/triangle.hpp>

namespace protostar::inline PROTOSTAR_ABI {

extern template AnySurface::AnySurface(Box);
extern template AnySurface::AnySurface(Csg);
extern template AnySurface::AnySurface(Disk);
extern template AnySurface::AnySurface(Instance<Csg>);
extern template AnySurface::AnySurface(Marched<fields::Field>);
extern template AnySurface::AnySurface(Moving<Sphere>);
extern template AnySurface::AnySurface(Parallelogram);
extern template AnySurface::AnySurface(Plane);
extern template AnySurface::AnySurface(Quadric);
extern template AnySurface::AnySurface(Sphere);
extern template AnySurface::AnySurface(Torus);
extern template AnySurface::AnySurface(Triangle);

}  // namespace protostar::inline PROTOSTAR_ABI
