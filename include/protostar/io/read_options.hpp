// Options for reading a scene file.
#pragma once

#include <cstdint>

#include "../image.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Options of read_scene and scene_from_json.
struct ReadOptions {
  /// True to refuse images and meshes that the scene names if they lie outside the folder of the scene, after
  /// links are resolved. For untrusted scenes, which may name any file that the program can read. The folder
  /// must not be changed meanwhile.
  bool confine = false;

  /// Largest number of pixels of all images that the scene names together. Each alone is limited to
  /// most_image_pixels.
  std::int64_t most_pixels = Image::max_pixels;

  int threads = 0;  ///< for building the BVHs of meshes, which do not depend on it; 0: all cores
};

}  // namespace protostar::inline PROTOSTAR_ABI
