// Stands for stages/support/shared_picture.hpp in modules, which share no work: docs/web/shards.cpp refuses
// it.
#pragma once

void draw_shared(const auto&...) {}
