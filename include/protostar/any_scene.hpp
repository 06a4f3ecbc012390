// A scene for surfaces of all types.
#pragma once

#include "scene.hpp"
#include "surfaces/any_surface.hpp"
#include "surfaces/parallelogram.hpp"
#include "surfaces/plane.hpp"
#include "surfaces/sphere.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Scene that takes surfaces of any type. The most frequent types have lists of their own, which are drawn
/// faster than an AnySurface. As all such scenes have one type, rendering is compiled once for all of them.
using AnyScene = Scene<Sphere, Plane, Parallelogram, AnySurface>;

}  // namespace protostar::inline PROTOSTAR_ABI
