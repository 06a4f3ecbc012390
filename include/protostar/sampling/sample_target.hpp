// Where the light of a render's samples goes: into an image, or into a film.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "../image.hpp"
#include "../pixel_grid.hpp"
#include "../render_options.hpp"
#include "film.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Target of a render: an image, whose pixels get the mean of all of their samples, or a film, to whose
/// pixels a range of samples is added. Columns and rows are counted from those of the image, or of the film's
/// tile.
class SampleTarget {
 public:
  /// Borrows the image, or the film and the samples that are added to it.
  explicit SampleTarget(Image& image) : image_(&image), area_(image.tile()) {}
  SampleTarget(Film& film, const SampleRange& samples) : film_(&film), area_(film.tile()), range_(samples) {}

  [[nodiscard]] int width() const { return area_.width(); }
  [[nodiscard]] int height() const { return area_.height(); }

  /// Returns the tile of all pixels.
  [[nodiscard]] Tile tile() const { return {0, 0, width(), height()}; }

  /// Returns the image; null if the target is a film.
  [[nodiscard]] Image* image() const { return image_; }

  /// Returns the sums of a film's pixel.
  [[nodiscard]] PixelSums& sums(int x, int y) const { return (*film_)(area_.x0 + x, area_.y0 + y); }

  /// Returns the pixels with the samples to be drawn; `otherwise` is the sampler if the options name none.
  /// Notes in a film if these samples tell no error (Film::lose_error). Throws std::invalid_argument for
  /// options of passes with a film, for samples that end beyond most_samples_of_pixel, and as PixelGrid does.
  [[nodiscard]] PixelGrid grid(RenderOptions options, const SamplerChoice& otherwise) const {
    if (image_) return {width(), height(), options, otherwise};
    if (options.error != 0 || options.seconds != 0 || options.every_pixel || options.standard_error)
      throw std::invalid_argument(
          "render: error, seconds, every_pixel and standard_error are options of an image, not of a film");
    options.crop = options.crop.or_whole(area_.x1, area_.y1);
    options.crop.x = area_.x0, options.crop.y = area_.y0;
    if (options.samples == 0) {
      if (range_.last > std::uint32_t{most_samples_of_pixel})
        throw std::invalid_argument("render: samples must end at " + std::to_string(most_samples_of_pixel) +
                                    " or before; they end at " + std::to_string(range_.last));
      options.samples = static_cast<int>(range_.last);
    }
    const SamplerChoice& sampler = options.sampler.is_made() ? options.sampler : otherwise;
    if (sampler.needs_number() && range_.first < range_.last) film_->lose_error();
    return {width(), height(), options, sampler, range_};
  }

  /// Returns how many sums a pixel has: 1 in an image, and in a film one for each scrambling (scrambling_of).
  [[nodiscard]] int sums_of_pixel() const { return image_ ? 1 : static_cast<int>(scramblings); }

  /// Draws pixel (x, y): calls light(i, place) for each sample i, and sets the pixel of an image to the mean
  /// of that light, or adds it to the sums of a film's pixel.
  void draw(const PixelGrid& pixels, int x, int y, LightOfSample light) const {
    if (image_)
      (*image_)(x, y) = pixels.mean(x, y, light);
    else
      pixels.add(x, y, light, sums(x, y));
  }

 private:
  Image* image_ = nullptr;
  Film* film_ = nullptr;
  Tile area_;
  SampleRange range_;
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
