// The folder of the project's scene files.
#pragma once

#include <filesystem>

inline const std::filesystem::path scenes_folder = std::filesystem::path(PROTOSTAR_SOURCE_DIR) / "scenes";
