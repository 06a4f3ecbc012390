// Reads PNG, and PPM in its binary form P6, through stb_image; and PPM in its plain form P3, with numbers up
// to 255.
#pragma once

#include <string>

#include "picture.hpp"

/// Reads a picture. Throws std::runtime_error, with the path and the reason, if it cannot be read.
Picture read_image(const std::string& path);
