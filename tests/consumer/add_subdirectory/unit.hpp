// Functions that are compiled for two instruction sets, each time in a namespace of their own.
#pragma once

#include <protostar/protostar.hpp>
#include <vector>

using Function = void (*)();

#define DECLARE_UNIT(name)                 \
  namespace name {                         \
  const char* scene_type();                \
  Function inline_function();              \
  std::vector<protostar::Color> picture(); \
  }
