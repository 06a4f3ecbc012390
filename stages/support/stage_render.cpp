#include "stage_render.hpp"

using namespace protostar;

template struct FunctionPicture<Color(const Ray&)>;
