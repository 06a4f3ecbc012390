// Two units that both include every header link into one program, in which a function of a header is one
// function.
#include "all_headers.hpp"
#include "unit.hpp"

Function first_unit() { return reinterpret_cast<Function>(&protostar::quadratic_roots); }

int main() { return first_unit() == second_unit() ? 0 : 1; }
