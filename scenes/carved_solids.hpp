// Three solids made of solids, over a floor: a rounded cube with holes, a bowl and a lens. They are compiled
// apart from the stage that draws them (scenes/carved_solids.cpp).
#pragma once

#include <protostar/surfaces/csg.hpp>

protostar::Csg rounded_cube_with_holes();
protostar::Csg bowl();
protostar::Csg lens();
