// Options of render, and statistics of its work.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <type_traits>

#include "function_ref.hpp"
#include "image.hpp"
#include "sampling/pixel_sampler.hpp"
#include "sampling/reconstruction.hpp"
#include "stop_token.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Counts of the work that a picture took, and of work that was found not to be needed.
struct RenderStatistics {
  std::uint64_t camera_rays = 0;     ///< camera rays, through pixels that may see anything
  std::uint64_t other_rays = 0;      ///< rays that integrators cast: shadow, mirrored and refracted ones
  std::uint64_t rays_alone = 0;      ///< other_rays that were traced by themselves, not in a packet
  std::uint64_t float_tests = 0;     ///< tests of camera rays with surfaces in float
  std::uint64_t surface_tests = 0;   ///< tests of rays with surfaces in double, or with visibility buffers
  std::uint64_t in_doubt = 0;        ///< tests in packets that double left in doubt, decided ray by ray
  std::uint64_t exact = 0;           ///< decisions that double left in doubt, made without rounding
  std::uint64_t undecided = 0;       ///< decisions about marched surfaces and tori that more digits left open
  std::uint64_t pixels_skipped = 0;  ///< samples that have a color without a camera ray

  RenderStatistics& operator+=(const RenderStatistics& other) {
    camera_rays += other.camera_rays, other_rays += other.other_rays;
    rays_alone += other.rays_alone;
    float_tests += other.float_tests, surface_tests += other.surface_tests;
    in_doubt += other.in_doubt;
    exact += other.exact, undecided += other.undecided;
    pixels_skipped += other.pixels_skipped;
    return *this;
  }
};

/// Largest number of samples of a pixel: as many as ExactLanes adds up.
inline constexpr int most_samples_of_pixel = (1 << 22) - 1;

/// Position of an image in a larger picture, of which only the image is rendered: its upper left pixel is at
/// column x and row y of a picture of width × height pixels. By default, the image is the picture.
struct Crop {
  int x = 0, y = 0;
  int width = 0, height = 0;

  /// Returns this crop, but for the default the whole of a picture of that size.
  [[nodiscard]] Crop or_whole(int picture_width, int picture_height) const {
    return *this == Crop{} ? Crop{0, 0, picture_width, picture_height} : *this;
  }

  friend bool operator==(const Crop&, const Crop&) = default;
};

/// Work that the fast path leaves out. Each kind can be turned off to measure its saving: a picture has the
/// same bytes with any of them off.
struct Skips {
  bool empty_tiles = true;     ///< camera rays where it is certain what they see and no point of it is needed
  bool occluder_lists = true;  ///< traversals of shadow rays, if a list of occluders serves their packet
  bool sure_in_float = true;   ///< tests in double of camera rays, where float is sure what they see
};

/// Report of a picture that is drawn in passes, filled in after each pass and, if there is progress, before
/// it is told. Errors are those of channels in linear light, and the truth is the mean of infinitely many
/// samples.
struct RenderReport {
  static constexpr double unknown = std::numeric_limits<double>::infinity();

  int samples = 0;         ///< samples of each pixel so far
  double error = unknown;  ///< estimate of the RMSE over pixels and channels (PictureError)
  double bound = unknown;  ///< the RMSE is at most that, with a confidence of 95 %, of 32 pixels or more
  double pixel_error = unknown;   ///< every_pixel: no channel of any pixel is further off, with 95 %
  int least_samples = 0;          ///< every_pixel: how many samples the target takes at least
  bool is_met = false;            ///< true if the target is met, or there is none
  double seconds_left = unknown;  ///< estimate of the time until the picture is done
};

class Film;
struct RenderOptions;
struct SampleRange;

namespace detail {

/// Function that adds a range of samples to a film.
using DrawSamples = FunctionRef<void(Film&, const SampleRange&, const RenderOptions&)>;

/// Draws an image in passes (sampling/passes.hpp).
inline void draw_in_passes(Image& image, const RenderOptions& options, DrawSamples draw);

}  // namespace detail

/// Option of type T that asks for a picture in passes. It converts from and to its value. If it is given one,
/// it also points to the function that draws in passes, so that the compiler leaves this function out of
/// programs that give no such option. A program that gives one has to include render.hpp, which defines the
/// function.
template <class T>
class PassOption {
 public:
  constexpr PassOption() = default;
  PassOption(T value) : value_(value), draw_(&detail::draw_in_passes) {}

  constexpr operator T() const { return value_; }
  constexpr T operator->() const requires std::is_pointer_v<T> { return value_; }

  /// Returns the function that draws in passes, or null if no value was given.
  [[nodiscard]] auto draw() const { return draw_; }

 private:
  T value_{};
  void (*draw_)(Image&, const RenderOptions&, detail::DrawSamples) = nullptr;
};

/// Options of render. An exception that progress throws ends the render and reaches its caller; after a stop,
/// progress does not come to 1.
struct RenderOptions {
  /// Rays through each pixel, which gets their mean (PixelGrid); 0: one through its center, and through that
  /// of a lens. Of several, channels beyond ±2^47 count as ±2^47, and below 2^-48 as 0 (ExactSum).
  int samples = 0;

  /// Sampler that gives their places, and the numbers of integrators that take a sampler. By default it is
  /// SobolSampler for these integrators and for a camera with a lens or an open shutter, and
  /// HammersleySampler for others.
  SamplerChoice sampler = {};
  ReconstructionFilter filter = {};  ///< weight of the places around a pixel's center
  std::uint64_t seed = 0;            ///< samplers have other numbers for another seed, as good as these
  double clamp = 0;                  ///< if greater than 0 and finite, channels of samples lie in [0, clamp]

  /// Target of the picture's RMSE over pixels and channels, in linear light; 0: none. Samples are drawn in
  /// passes, which double their number, until the RMSE is at most that with a confidence of 95 %
  /// (PictureError); samples has to be 0. As do seconds and standard_error, it takes SobolSampler by default,
  /// and another sampler only if its even samples are independent of the odd ones, and its pixels of each
  /// other: no HammersleySampler or StratifiedSampler.
  PassOption<double> error = {};
  /// Time for the picture in seconds, which ends with the last pass that fits; 0: no limit.
  PassOption<double> seconds = {};
  int max_samples = 65536;  ///< samples at which error and seconds end at the latest, from 2 on
  /// If true, error is that of each channel of each pixel, proven; it needs a clamp.
  PassOption<bool> every_pixel = {};
  RenderReport* report = nullptr;          ///< if given, is told of passes
  PassOption<Image*> standard_error = {};  ///< if given, becomes that of each pixel's channels (PixelSums)

  Crop crop = {};       ///< picture that the image is a part of
  int threads = 0;      ///< number of threads, with the caller's; 0: one for each core, as far as they start
  StopToken stop = {};  ///< if requested, render returns early; other pixels stay as they were
  bool tiles = true;    ///< fast path for scenes; false: plain path, with the same bytes
  Skips skips = {};     ///< work left out, on the fast path only
  RenderStatistics* statistics = nullptr;          ///< if given, counts are added here, on the fast path only
  std::function<void(double done)> progress = {};  ///< called in the caller's thread with a share from 0 to 1

  /// Returns the function that draws the picture in passes, or null if no option asks for these.
  [[nodiscard]] auto passes() const {
    return error != 0       ? error.draw()
           : seconds != 0   ? seconds.draw()
           : every_pixel    ? every_pixel.draw()
           : standard_error ? standard_error.draw()
                            : nullptr;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
