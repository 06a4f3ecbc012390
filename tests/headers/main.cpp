// A unit that includes every header links into one program with one for each header (each_header), and with a
// second one in which a function of a header is the same function.
#include "all_headers.hpp"
#include "unit.hpp"

Function first_unit() { return reinterpret_cast<Function>(&protostar::quadratic_roots); }

int main() { return first_unit() == second_unit() ? 0 : 1; }
