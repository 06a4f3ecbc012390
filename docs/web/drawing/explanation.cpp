// Stands for the explanation of a pixel in modules that only draw.
#include <stdexcept>

#include "stages/support/stage.hpp"

void Stage::begin_explanation() {
  throw std::runtime_error("--pixel: this module only draws; another one explains (docs/web/stages.mjs)");
}

void Stage::tell(const protostar::Image&) {}
