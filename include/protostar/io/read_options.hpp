// What the reader of a scene file can be told.
#pragma once

#include <cstdint>

#include "../image.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// How a scene file is read.
struct ReadOptions {
  /// Whether images and meshes that the scene names are refused if they lie outside the folder of the scene,
  /// after links are resolved. For scenes from others, who may name any file that the program can read. The
  /// folder must not be changed meanwhile.
  bool confine = false;

  /// The most pixels of all images that the scene names together. Of one it is most_image_pixels.
  std::int64_t most_pixels = Image::max_pixels;

  int threads = 0;  ///< for the trees of meshes, on which no tree depends; 0: all cores
};

}  // namespace protostar::inline PROTOSTAR_ABI
