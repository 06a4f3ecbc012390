// Lights as seen from a point, drawn by solid angle: spheres, triangles, rectangles, parallelograms, disks,
// meshes.
//
// A view is made of a point and a light, and can be asked for any number of directions:
//   const SphereView view(point, center, radius);
//   const LightSample light = view.sample(u, v);     // u, v in (0, 1)
//   radiance · cosine / light.density                // estimates the irradiance, if nothing is between
#pragma once

#include "disk_view.hpp"
#include "mesh_light.hpp"
#include "parallelogram_view.hpp"
#include "rectangle_view.hpp"
#include "sphere_view.hpp"
#include "triangle_view.hpp"
