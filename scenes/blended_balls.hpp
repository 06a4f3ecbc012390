// Balls that flow into each other, over a floor (stage 35).
#pragma once

#include <protostar/any_scene.hpp>

protostar::AnyScene blended_balls();
