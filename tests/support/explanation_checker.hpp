// The program that checks explanations of pixels.
#pragma once

#include <filesystem>

/// Path of docs/check_explanation. It needs python3, without which its exit status is 127.
inline const std::filesystem::path explanation_checker =
    std::filesystem::path(PROTOSTAR_SOURCE_DIR) / "docs" / "check_explanation";
