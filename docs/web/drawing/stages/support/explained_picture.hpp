// Stands for stages/support/explained_picture.hpp in modules that only draw: docs/web/drawing/explanation.cpp
// refuses.
#pragma once

void draw_explained(const auto&...) {}
