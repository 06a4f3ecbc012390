// How much of the machine works, and who is told about it.
#pragma once

#include <cstdint>
#include <functional>

#include "stop_token.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// What a picture took: work that was done, and work that was found not to be needed.
struct RenderStatistics {
  std::uint64_t camera_rays = 0;    ///< through pixels that may see anything
  std::uint64_t other_rays = 0;     ///< that integrators cast: shadow rays
  std::uint64_t rays_alone = 0;     ///< those of them that went by themselves, not with a packet
  std::uint64_t surface_tests = 0;  ///< of rays with surfaces, in double, or with the drawing of one
  std::uint64_t in_doubt = 0;  ///< tests that double could not decide for a packet, so that a ray went alone
  std::uint64_t exact = 0;     ///< questions that double did not decide, answered without rounding
  std::uint64_t pixels_skipped = 0;  ///< that had no ray: of parts of tiles that see nothing, or all the same

  RenderStatistics& operator+=(const RenderStatistics& other) {
    camera_rays += other.camera_rays, other_rays += other.other_rays;
    rays_alone += other.rays_alone;
    surface_tests += other.surface_tests, in_doubt += other.in_doubt;
    exact += other.exact;
    pixels_skipped += other.pixels_skipped;
    return *this;
  }
};

/// Where an image lies in a larger picture, of which it is drawn: its upper left pixel is at column x and row
/// y of a picture of width × height pixels. Without a size, the image is the picture.
struct Crop {
  int x = 0, y = 0;
  int width = 0, height = 0;
};

/// What is not done by tiles, each to be turned off so that what it saves can be measured: a picture has the
/// same bytes with any of them off.
struct Skips {
  bool empty_tiles = true;       ///< rays through pixels that see nothing, or the same all over
  bool farther_surfaces = true;  ///< tests of camera rays with what is surely behind all that they met
  bool last_occluder = true;     ///< tests with other surfaces, where that which shadowed last does so again
  bool occluder_lists = true;    ///< walks of shadow rays through the tree, where a list serves their packet
  bool passed_surfaces = true;   ///< tests of camera rays with what float says that they pass
};

/// How render works. An exception that progress throws ends the render and reaches its caller; after a stop,
/// progress does not come to 1.
struct RenderOptions {
  int samples = 0;  ///< rays through each pixel, of which it gets the mean (pixels.hpp); 0, as 1, its center
  Crop crop = {};   ///< the picture that the image is a part of
  int threads = 0;  ///< how many work, the caller among them; 0: one for each core, as far as they start
  StopToken stop = {};  ///< asked for, render returns early; other pixels stay as they were
  bool tiles = true;    ///< scenes are rendered by tiles and packets; without, ray by ray: the same picture
  Skips skips = {};     ///< what tiles do not do; by tiles only
  RenderStatistics* statistics = nullptr;  ///< if given, what the picture took is added here; by tiles only
  std::function<void(double done)> progress = {};  ///< called in the caller's thread with a share from 0 to 1
};

}  // namespace protostar::inline PROTOSTAR_ABI
