// Surfaces of many shapes on a floor, each a function of a point (stage 34).
#pragma once

#include <protostar/any_scene.hpp>

protostar::AnyScene field_shapes();
