// Declares the numbers of surfaces, and of their equations along a ray, for the explanation of a pixel.
#pragma once

#include <protostar/environment.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "explanation.hpp"

/// Returns the numbers that define a surface; for a type that is not known here, its name alone. A field that
/// is marched is a list of operations (exact/recorded.hpp).
Facts facts_of(const protostar::AnySurface& surface);
Facts facts_of(const protostar::Sphere& surface);
Facts facts_of(const protostar::Plane& surface);
Facts facts_of(const protostar::Parallelogram& surface);
Facts facts_of(const protostar::Mesh& surface);

inline Facts facts_of(const auto&) { return {.type = "surface"}; }

/// Returns the numbers in double of the equation of a surface and a ray's line, or of each of its parts.
Facts equation_of(const protostar::AnySurface& surface, const protostar::Ray& ray);
Facts equation_of(const protostar::Sphere& surface, const protostar::Ray& ray);
Facts equation_of(const protostar::Plane& surface, const protostar::Ray& ray);
Facts equation_of(const protostar::Parallelogram& surface, const protostar::Ray& ray);
Facts equation_of(const protostar::Mesh& surface, const protostar::Ray& ray);
inline Facts equation_of(const auto&, const protostar::Ray&) { return {.type = "surface"}; }

/// Returns the steps of a march to the first crossing in the range, each of which proves a part of the ray:
/// "from" and "to" are its ends, and the numbers are those that it is proven by. They are:
/// - ball: value of the field at from;
/// - two balls: values at from and at to;
/// - bend: values at from, at to, and at "before", before from; second derivatives of the field bound it;
/// - segment and precise segment: enclosures of value and slope over it, and the values at both ends;
/// - deflation: enclosure of the slope over it;
/// - sign change: slope over it, or the value at "behind", behind to, by which second derivatives prove that
///   the field falls; and the values at min and to, which enclose t;
/// - touch: none; the field comes nearer to 0 at from than double-double tells.
Facts march_of(const protostar::AnySurface& surface, const protostar::Ray& ray, protostar::Interval range);

/// Returns the numbers of the primitive of a surface that a ray hits: the triangle of a mesh, with the
/// normals and the texture coordinates of its vertices if it has some; nothing for surfaces whose
/// primitives are told by facts_of.
Facts primitive_of(const protostar::AnySurface& surface, int primitive);
Facts primitive_of(const protostar::Mesh& surface, int primitive);
inline Facts primitive_of(const auto&, int) { return {}; }

/// Returns how the radiance of an environment at u and v follows: for an image, its file and size, the four
/// pixels around the place, first those of the upper row, and their colors; for a function, its name.
Facts look_up_of(const protostar::Environment& environment, const protostar::Uv& uv);
