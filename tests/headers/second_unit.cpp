#include <protostar/numeric/roots.hpp>

#include "unit.hpp"

Function second_unit() { return reinterpret_cast<Function>(&protostar::quadratic_roots); }
