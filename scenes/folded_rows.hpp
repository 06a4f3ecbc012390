// Rows of columns with rings, all of which are one column in folded space (stages 36 and 37).
#pragma once

#include <protostar/any_scene.hpp>

/// Lamp of the rows: a point, or a sphere around it that lights its surroundings alike.
enum class RowLamp { point, sphere };

protostar::AnyScene folded_rows(RowLamp lamp = RowLamp::point);
