// Checks that a unit that includes every header links with a unit for each header (each_header) and with a
// second unit, and that an inline function of a header is the same function in both.
#include "all_headers.hpp"
#include "unit.hpp"

Function first_unit() { return reinterpret_cast<Function>(&protostar::quadratic_roots); }

int main() { return first_unit() == second_unit() ? 0 : 1; }
