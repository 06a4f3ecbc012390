// Menger's sponge, four levels deep, on a floor (stage 38).
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/surfaces/distance_field.hpp>

/// Field of a cube from −1 to 1 with square holes along the axes, each of its pieces with smaller ones, and
/// so on. At each level space is folded to one piece, and three square holes are taken away through its
/// middle.
struct Sponge {
  int levels = 4;

  auto operator()(const auto& p) const {
    const auto side = abs(p);
    auto result = max(max(side.x, side.y), side.z) - 1.0;
    double size = 1;  // half of the width of a piece
    for (int level = 0; level < levels; ++level) {
      const auto q = fold(p * (1 / size)) * size;
      result = max(result, -(min(min(max(q.x, q.y), max(q.y, q.z)), max(q.z, q.x)) - size / 3));
      size = size / 3;
    }
    return result;
  }
};

protostar::AnyScene sponge();
