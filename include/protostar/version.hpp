// The version of the library, for the preprocessor and for programs. CMakeLists.txt reads it from here.
#pragma once

#define PROTOSTAR_VERSION_MAJOR 0
#define PROTOSTAR_VERSION_MINOR 1
#define PROTOSTAR_VERSION_PATCH 0
#define PROTOSTAR_VERSION "0.1.0"
