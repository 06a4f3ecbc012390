// The pixels of an image on the film of a camera, with the places of their samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "camera.hpp"
#include "function_ref.hpp"
#include "plain_vector.hpp"
#include "render_options.hpp"
#include "sampling/film.hpp"
#include "sampling/hammersley_sampler.hpp"
#include "sampling/pixel_sampler.hpp"
#include "sampling/reconstruction.hpp"
#include "sampling/warp.hpp"
#include "sampling/warp_lanes.hpp"
#include "shown.hpp"
#include "simd/simd.hpp"
#include "simd/vectors.hpp"
#include "simd/words.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Samples [first, last) of each pixel.
struct SampleRange {
  std::uint32_t first = 0, last = 0;
};

/// Light of sample i of a pixel, which is at a place. It is no parameter of a template, so that an integrator
/// is compiled once and not for each use of its light.
using LightOfSample = FunctionRef<Color(int i, const FilteredPlace<double>& place)>;

/// Pixels of an image, which is a whole picture or a part of one, and their samples, or a range of these.
///
/// The place of a sample is where the filter takes the first two numbers of the sampler's set 0, and its
/// point of the lens is where the concentric map takes the other two. These belong to the pixel of the whole
/// picture, so that a part of it has the same numbers. Its time is by the first number of set_of_time. If no
/// number of samples is given, the only ray passes the centers of the pixel and of the lens, so that its
/// picture is a pinhole's, halfway through the shutter's time.
class PixelGrid {
 public:
  /// Takes the sampler of the options, or `otherwise` if they have none, and all samples, or a range that has
  /// any. Throws std::invalid_argument if the number of samples is negative or too large or ends before the
  /// range, if the picture that the image is cropped from does not contain it, or for a clamp that is
  /// negative or NaN.
  [[gnu::cold]] PixelGrid(int width, int height, const RenderOptions& options = {},
                          const SamplerChoice& otherwise = sampler_of<HammersleySampler>,
                          const SampleRange& range = {})
      : crop_(options.crop.or_whole(width, height)),
        sampler_(options.sampler.is_made() ? options.sampler : otherwise),
        filter_(options.filter),
        seed_(options.seed) {
    if (options.samples < 0 || options.samples > most_samples_of_pixel)
      throw std::invalid_argument("RenderOptions: samples must be from 0 to " +
                                  std::to_string(most_samples_of_pixel) + "; it is " +
                                  std::to_string(options.samples));
    const auto holds = [](int whole, int first, int size) {
      return first >= 0 && first <= whole && size <= whole - first;
    };
    if (!holds(crop_.width, crop_.x, width) || !holds(crop_.height, crop_.y, height))
      throw std::invalid_argument(
          "RenderOptions: crop must be the size of a picture that holds the image; " + std::to_string(width) +
          "x" + std::to_string(height) + " at " + std::to_string(crop_.x) + ", " + std::to_string(crop_.y) +
          " is not inside " + std::to_string(crop_.width) + "x" + std::to_string(crop_.height));
    if (!(options.clamp >= 0))
      throw std::invalid_argument("RenderOptions: clamp must be 0 (none) or greater; it is " +
                                  shown(options.clamp));
    if (options.samples > 0) samples_ = options.samples, has_only_centers_ = false;
    last_ = samples_;
    if (range.last > static_cast<std::uint32_t>(samples_))
      throw std::invalid_argument("render: samples must end at the " + std::to_string(samples_) +
                                  " of the options or before; they end at " + std::to_string(range.last));
    if (range.first < range.last)
      first_ = static_cast<int>(range.first), last_ = static_cast<int>(range.last);
    if (options.clamp > 0 && std::isfinite(options.clamp)) clamp_ = largest_float_below(options.clamp);
    set_common_places(options.samples);
  }

  /// Returns the film's u at a position in column x of the image, or v in row y; position 0 is the left or
  /// upper edge, 1 the other. In lanes, columns follow each other.
  [[nodiscard]] double u(int x, double position) const {
    return Camera::u_at(column(x) + position, crop_.width, crop_.height);
  }
  [[nodiscard]] double v(int y, double position) const {
    return Camera::v_at(row(y) + position, crop_.height);
  }
  [[nodiscard]] simd::Doubles u(int x, simd::Doubles position) const {
    return Camera::u_at(simd::Doubles(column(x)) + simd::iota<double, simd::double_lanes>() + position,
                        crop_.width, crop_.height);
  }
  [[nodiscard]] simd::Doubles v(int y, simd::Doubles position) const {
    return Camera::v_at(simd::Doubles(row(y)) + position, crop_.height);
  }

  /// Returns the largest u of any ray, and the largest v: those at the right and at the upper edge of the
  /// whole picture, moved out as far as the filter reaches.
  [[nodiscard]] double largest_u() const {
    return Camera::u_at(crop_.width + margin(), crop_.width, crop_.height);
  }
  [[nodiscard]] double largest_v() const { return Camera::v_at(-margin(), crop_.height); }

  /// Returns how far places of samples may be outside of their pixel, in pixels.
  [[nodiscard]] double margin() const {
    return filter_.radius() > 0.5 && !(samples_ == 1 && has_common_places()) ? filter_.radius() - 0.5 : 0;
  }

  /// Returns how many samples a pixel has in all; those of the range are first() to last() − 1.
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int last() const { return last_; }
  /// Returns how many samples the range has.
  [[nodiscard]] std::uint64_t drawn() const { return static_cast<std::uint64_t>(last_ - first_); }

  /// Returns light with each channel clamped to [0, clamp], if the options have one; NaN becomes 0.
  template <class Light>
  [[nodiscard]] Light bounded(const Light& light) const {
    if (clamp_ == 0) [[likely]]
      return light;
    return {bounded_channel(light.r), bounded_channel(light.g), bounded_channel(light.b)};
  }

  /// Returns true if the only ray of a pixel passes its center, and that of the lens.
  [[nodiscard]] bool has_only_centers() const { return has_only_centers_; }

  /// Returns true if the mean of a pixel's samples is the light of the only one, unchanged.
  [[nodiscard]] bool keeps_light() const { return samples_ == 1 && !has_weights(); }

  /// Returns true if any sample has another weight than 1.
  [[nodiscard]] bool has_weights() const {
    return filter_.has_weights() && !(samples_ == 1 && has_common_places());
  }

  /// Returns true if the places and weights are the same in every pixel.
  [[nodiscard]] bool has_common_places() const { return !places_.empty(); }

  /// Returns the place of sample i, if it is the same in every pixel.
  [[nodiscard]] const FilteredPlace<double>& common_place(int i) const {
    return places_[static_cast<std::size_t>(i)];
  }

  /// Returns the place of sample i of pixel (x, y) of the image.
  [[nodiscard]] FilteredPlace<double> place(int x, int y, int i) const {
    if (has_common_places()) return common_place(i);
    const SampleSet<double> numbers = sampler(x, y, i)(0);
    return filter_(numbers[0], numbers[1]);
  }

  /// Returns the places of sample i of some pixels; `numbers` is set 0 of their samplers, one pixel in each
  /// lane, and not read if all pixels have the same places.
  [[nodiscard]] FilteredPlace<simd::Doubles> places(int i, const SampleSet<simd::Doubles>& numbers) const {
    if (has_common_places()) return {common_place(i).x, common_place(i).y, common_place(i).weight};
    return filter_(numbers[0], numbers[1]);
  }

  /// Returns the sampler of sample i of pixel (x, y) of the image.
  [[nodiscard]] PixelSampler sampler(int x, int y, int i) const {
    return {sampler_,
            {seed_, word(crop_.x + x), word(crop_.y + y), static_cast<std::uint32_t>(i),
             static_cast<std::uint32_t>(samples_)}};
  }

  /// Returns the samplers of sample i of some pixels of the image.
  [[nodiscard]] PacketSampler samplers(simd::Words x, simd::Words y, int i) const {
    return {sampler_,
            {seed_, x + simd::Words(word(crop_.x)), y + simd::Words(word(crop_.y)),
             static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(samples_)}};
  }
  /// Returns those of the pixels from (x, y) on to the right.
  [[nodiscard]] PacketSampler samplers(int x, int y, int i) const {
    return samplers(simd::Words(word(x)) + simd::iota<std::uint32_t, simd::double_lanes>(),
                    simd::Words(word(y)), i);
  }

  /// Returns the point of the lens, in the unit disk, through which the ray of sample i of pixel (x, y)
  /// passes.
  [[nodiscard]] Uv lens_point(int x, int y, int i) const {
    const SampleSet<double> numbers = sampler(x, y, i)(0);
    return concentric_disk(numbers[2], numbers[3]);
  }

  /// Returns the coordinates of the points of the lens of some pixels; `numbers` is set 0 of their samplers.
  [[nodiscard]] static std::array<simd::Doubles, 2> lens_points(const SampleSet<simd::Doubles>& numbers) {
    return simd::concentric_disk(numbers[2], numbers[3]);
  }

  /// Returns the ray of a camera for sample i of pixel (x, y), which is at a place.
  [[nodiscard]] Ray ray(const Camera& camera, int x, int y, int i, const FilteredPlace<double>& place) const {
    const double on_film[] = {u(x, place.x), v(y, place.y)};
    Ray ray = has_only_centers() || !camera.has_lens() ? camera(on_film[0], on_film[1])
                                                       : camera(on_film[0], on_film[1], lens_point(x, y, i));
    ray.time = time(camera.shutter, x, y, i);
    if (camera.is_moving()) ray.origin = camera.origin_at(ray.time, ray.origin);
    return ray;
  }

  /// Returns the time of sample i of pixel (x, y).
  [[nodiscard]] double time(const Shutter& shutter, int x, int y, int i) const {
    if (!shutter.is_open()) return shutter.opens;
    return shutter.at(has_only_centers() ? 0.5 : sampler(x, y, i)(set_of_time)[0]);
  }

  /// Returns the times of sample i of the pixels from (x, y) on to the right.
  [[nodiscard]] simd::Doubles times(const Shutter& shutter, int x, int y, int i) const {
    if (!shutter.is_open()) return shutter.opens;
    if (has_only_centers()) return shutter.at(0.5);
    return shutter.at(samplers(x, y, i)(set_of_time)[0]);
  }

  /// Returns the sums of equal lights of all samples of the range, if places are the same in every pixel or
  /// all weights are 1.
  [[nodiscard]] PixelSums sums_of_equal(const Color& light) const {
    PixelSums sums;
    for (int i = first_; i < last_; ++i)
      sums.add(static_cast<std::uint32_t>(i),
               bounded(light) * (has_common_places() ? static_cast<float>(common_place(i).weight) : 1.0f));
    return sums;
  }

  /// Returns their mean.
  [[nodiscard]] Color mean_of_equal(const Color& light) const {
    return keeps_light() ? bounded(light) : sums_of_equal(light).mean();
  }

  /// Adds light(i, place) of the samples i of pixel (x, y) in the range, times their weights, to sums.
  void add(int x, int y, LightOfSample light, PixelSums& sums) const {
    for (int i = first_; i < last_; ++i) {
      const FilteredPlace<double> at = place(x, y, i);
      sums.add(static_cast<std::uint32_t>(i), bounded(light(i, at)) * static_cast<float>(at.weight));
    }
  }

  /// Returns the mean of light(i, place) over the samples i of pixel (x, y), times their weights: a single
  /// one of weight 1 as it is, otherwise an exact sum, divided and rounded once.
  [[nodiscard]] Color mean(int x, int y, LightOfSample light) const {
    if (keeps_light()) return bounded(light(0, place(x, y, 0)));
    PixelSums sums;
    add(x, y, light, sums);
    return sums.mean();
  }

 private:
  /// Returns the column or row of the whole picture: in double, as packets and tables of rays go on behind
  /// its end, which may be the largest int.
  [[nodiscard]] double column(int x) const { return static_cast<double>(crop_.x) + x; }
  [[nodiscard]] double row(int y) const { return static_cast<double>(crop_.y) + y; }

  [[nodiscard]] float bounded_channel(float x) const { return x > 0 ? std::min(x, clamp_) : 0; }
  [[nodiscard]] simd::Floats bounded_channel(simd::Floats x) const {
    const simd::Floats most = clamp_, none = 0.0f;
    return select(x > none, select(x < most, x, most), none);
  }

  /// Returns the largest float that is not above x > 0, or the smallest float above 0 if there is none.
  [[gnu::cold]] static float largest_float_below(double x) {
    const float nearest = to_float(std::min<double>(x, std::numeric_limits<float>::max()));
    return std::max(nearest > x ? std::nextafter(nearest, 0.0f) : nearest,
                    std::numeric_limits<float>::denorm_min());
  }

  static std::uint32_t word(int x) { return static_cast<std::uint32_t>(x); }

  /// Computes the places, if they are the same in every pixel; a single one is the center. Their weights are
  /// divided by the mean weight, which is 1 for random places only, and only on average: otherwise all of the
  /// picture would be darker or brighter by that factor.
  [[gnu::cold]] void set_common_places(int samples) {
    if (samples > 0 && !sampler_.has_common_places()) return;
    if (samples <= 1) {
      places_.push_back({0.5, 0.5, 1});
      return;
    }
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
      const SampleSet<double> numbers = sampler(0, 0, i)(0);
      sum += places_.push_back(filter_(numbers[0], numbers[1])).weight;
    }
    if (filter_.has_weights())
      for (FilteredPlace<double>& place : places_) place.weight *= samples / sum;
  }

  Crop crop_;
  SamplerChoice sampler_;
  ReconstructionFilter filter_;
  std::uint64_t seed_;
  int samples_ = 1, first_ = 0, last_ = 1;
  bool has_only_centers_ = true;
  float clamp_ = 0;                            ///< 0: none
  PlainVector<FilteredPlace<double>> places_;  ///< of the samples; empty if each pixel has its own
};

}  // namespace protostar::inline PROTOSTAR_ABI
