// Has headers of the library compiled for size in modules that draw: what is done once for a picture, as the
// building of trees, and what is seldom done, as arithmetic with more digits. CMake includes this file before
// all others.
#pragma once

// Headers that those below include, and that are meant to be fast.
#include <protostar/bvh/box_space.hpp>
#include <protostar/bvh/node.hpp>
#include <protostar/image.hpp>
#include <protostar/numeric/rounded_equation.hpp>
#include <protostar/sampling/pixel_sampler.hpp>

#pragma clang attribute push(__attribute__((minsize)), apply_to = function)
#pragma clang attribute push(__attribute__((cold)), apply_to = function)
#include <protostar/bvh/box_slices.hpp>
#include <protostar/bvh/build.hpp>
#include <protostar/camera.hpp>
#include <protostar/numeric/affine.hpp>
#include <protostar/numeric/radians.hpp>
#include <protostar/shown.hpp>
#pragma clang attribute pop
#pragma clang attribute pop
