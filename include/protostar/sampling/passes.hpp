// Pictures drawn in passes: until their error is small enough, or their time is over.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "../image.hpp"
#include "../parallel.hpp"
#include "../pixel_grid.hpp"
#include "../render_options.hpp"
#include "../shown.hpp"
#include "every_pixel.hpp"
#include "film.hpp"
#include "hash.hpp"
#include "sampler.hpp"
#include "sobol_sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Loop over the passes of a picture. A pass adds samples to a film by the function that it is given.
class PassLoop {
 public:
  /// Borrows the image. Throws std::invalid_argument for options that make no sense together.
  PassLoop(Image& image, const RenderOptions& options, DrawSamples draw)
      : image_(image), options_(options), pass_(options), draw_(draw), film_(area_of(image, options)) {
    validate();
    if (!pass_.sampler.is_made()) pass_.sampler = sampler_of<SobolSampler>;
    pass_.error = pass_.seconds = 0, pass_.every_pixel = false;
    pass_.report = nullptr, pass_.standard_error = nullptr;
    pass_.crop = options.crop.or_whole(image.width(), image.height());
    if (options.samples == 0) pass_.samples = options.max_samples;
    if (options.progress) pass_.progress = [this](double done) { tell(done); };
  }

  /// Draws the picture. If a stop is requested, the image stays as it was.
  void operator()() {
    if (options_.every_pixel)
      draw_every_pixel();
    else
      while (draw_pass(next_end())) {
      }
    if (options_.stop.stop_requested()) return;
    image_ = film_.mean();
    if (options_.standard_error) *options_.standard_error = film_.standard_error();
    report_.is_met = report_.is_met || options_.error == 0;
    report_.seconds_left = 0;
    tell_report();
    if (options_.progress) options_.progress(1);
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Least number of samples that tell an error: one of each scrambling.
  static constexpr int fewest_samples = static_cast<int>(scramblings);

  static Tile area_of(const Image& image, const RenderOptions& options) {
    const auto& [x, y, width, height] = options.crop;
    if (width == 0 && height == 0) return image.tile();
    // PixelGrid refuses a picture that does not hold the image; of others, the sums below do not overflow.
    static_cast<void>(PixelGrid(image.width(), image.height(), {.crop = options.crop}));
    return {x, y, x + image.width(), y + image.height()};
  }

  static void require(bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("RenderOptions: " + what);
  }
  void validate() const {
    const RenderOptions& o = options_;
    const double error = o.error, seconds = o.seconds;
    require(error >= 0 && std::isfinite(error),
            "error must be finite and greater than 0, or 0 (none); it is " + shown(error));
    require(seconds >= 0 && std::isfinite(seconds),
            "seconds must be finite and greater than 0, or 0 (none); they are " + shown(seconds));
    require((o.error > 0) + (o.seconds > 0) + (o.samples > 0) <= 1,
            "only one of samples, error and seconds may be given; they are " + std::to_string(o.samples) +
                ", " + shown(o.error) + " and " + shown(o.seconds));
    const bool is_open = o.error > 0 || o.seconds > 0;
    const std::string fewest = std::to_string(fewest_samples);
    require(is_open || o.every_pixel || o.samples >= fewest_samples,
            "standard_error needs samples of at least " + fewest + ", an error or seconds");
    require(o.max_samples >= fewest_samples && o.max_samples <= most_samples_of_pixel,
            "max_samples must be from " + fewest + " to " + std::to_string(most_samples_of_pixel) +
                "; it is " + std::to_string(o.max_samples));
    require(
        !o.sampler.needs_number(),
        "error, seconds and standard_error need a sampler whose samples do not depend on their number, and "
        "the even ones not on the odd ones; HammersleySampler and StratifiedSampler are none");
    const std::uint64_t pixels = pixel_count();
    require(!(o.error > 0) || o.every_pixel || pixels >= PictureError::fewest_pixels,
            "an error can be promised to pictures of " + std::to_string(PictureError::fewest_pixels) +
                " pixels or more, or to every_pixel; this one has " + std::to_string(pixels));
    if (o.every_pixel) {
      require(o.error > 0, "every_pixel needs an error");
      require(o.clamp > 0 && std::isfinite(o.clamp),
              "every_pixel needs a clamp that is finite and greater than 0; it is " + shown(o.clamp));
      require(!o.filter.has_weights(), "every_pixel needs a filter whose weights are 1, not mitchell");
    }
  }

  [[nodiscard]] std::uint64_t pixel_count() const {
    return static_cast<std::uint64_t>(image_.width()) * static_cast<std::uint64_t>(image_.height());
  }
  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  /// Returns the number of samples at the end of the next pass; 0 for none.
  ///
  /// With a time, a pass doubles the samples if it will end in time, or else takes as many as fit, equally
  /// many of each scrambling, by the speed of the pass before and a reserve of 5 %. A last pass that would
  /// add less than a sixteenth is left out: the error would fall by 3 % at most.
  [[nodiscard]] int next_end() const {
    const int done = report_.samples;
    if (options_.samples > 0) return done == 0 ? options_.samples : 0;
    if (done >= options_.max_samples || report_.is_met) return 0;
    if (options_.error > 0)
      return done == 0 ? std::min(PictureError::first_look, options_.max_samples) : doubled(done);
    if (done == 0) return fewest_samples;
    const double fit =
        std::floor((options_.seconds - elapsed()) / (1.05 * seconds_a_sample_) / fewest_samples) *
        fewest_samples;
    if (!(fit >= std::max(fewest_samples, done / 16))) return 0;
    return fit >= done ? doubled(done) : std::min(done + static_cast<int>(fit), options_.max_samples);
  }
  [[nodiscard]] int doubled(int done) const {
    return done > options_.max_samples / 2 ? options_.max_samples : 2 * done;
  }

  /// Draws samples up to an end, and looks at the error. Returns false if there is none to draw, or a stop
  /// was requested.
  [[nodiscard]] bool draw_pass(int end) {
    if (end == 0) return false;
    end_ = end;
    const double before = elapsed();
    draw_(film_, {static_cast<std::uint32_t>(report_.samples), static_cast<std::uint32_t>(end)}, pass_);
    if (options_.stop.stop_requested()) return false;
    seconds_a_sample_ = (elapsed() - before) / (end - report_.samples);
    report_.samples = end;
    look();
    report_.is_met = options_.error > 0 && error_.is_within(options_.error);
    tell_report();
    return true;
  }

  void look() {
    error_ = film_.error();
    report_.error = error_.rmse();
    report_.bound = std::sqrt(error_.bound());
  }

  /// Draws blocks of samples until every pixel is known (EveryPixel).
  void draw_every_pixel() {
    EveryPixel pixels(options_.error, options_.clamp, film_.tile());
    const std::uint32_t block = pixels.samples_of_block();
    report_.least_samples = static_cast<int>(std::min(1e9, pixels.least_samples()));
    require(pixels.least_samples() <= options_.max_samples,
            "every_pixel takes at least " + shown(pixels.least_samples()) +
                " samples for this error and clamp, more than max_samples, " +
                std::to_string(options_.max_samples));
    pass_.samples = static_cast<int>(block);
    Film samples(film_.tile());
    for (std::uint64_t i = 0; report_.samples + static_cast<int>(block) <= options_.max_samples; ++i) {
      end_ = report_.samples + static_cast<int>(block);
      pass_.seed = EveryPixel::seed_of_block(options_.seed, i);
      const double before = elapsed();
      draw_(samples, {0, block}, pass_);
      if (options_.stop.stop_requested()) return;
      report_.pixel_error = pixels.add(samples, film_, options_);
      seconds_a_sample_ = (elapsed() - before) / block;
      report_.samples = end_;
      report_.is_met = report_.pixel_error <= options_.error;
      if (report_.is_met) break;
      tell_report();
    }
    look();
  }

  void tell_report() const {
    if (options_.report) *options_.report = report_;
  }

  /// Returns how many samples there will be at the end, as far as that is known; 0 if it is not.
  [[nodiscard]] double samples_at_end() const {
    const RenderOptions& o = options_;
    const double done = report_.samples;
    if (o.samples > 0) return o.samples;
    if (o.every_pixel) {
      const double needed = done > 0 ? done * report_.pixel_error / o.error : 0;
      return std::clamp<double>(needed, report_.least_samples, o.max_samples);
    }
    if (done == 0) return 0;
    const double share = error_.share(o.error);
    double end = done;
    while (end * share < done && end < o.max_samples) end *= 2;
    return std::min<double>(end, o.max_samples);
  }

  /// Tells progress: the pass that is drawn now is done to a share.
  void tell(double done_of_pass) {
    const double drawn = report_.samples + done_of_pass * (end_ - report_.samples);
    double done = 0;
    if (options_.seconds > 0) {
      report_.seconds_left = std::max(0.0, options_.seconds - elapsed());
      done = elapsed() / options_.seconds;
    } else if (const double end = samples_at_end(); end > 0) {
      if (seconds_a_sample_ > 0) report_.seconds_left = seconds_a_sample_ * std::max(0.0, end - drawn);
      done = drawn / end;
    }
    shown_ = std::max(shown_, std::min(done, 0.99));  // never back, and 1 at the end
    tell_report();
    options_.progress(shown_);
  }

  Image& image_;
  const RenderOptions& options_;
  RenderOptions pass_;  ///< options of a pass
  DrawSamples draw_;
  Film film_;
  PictureError error_;
  RenderReport report_;
  Clock::time_point start_ = Clock::now();
  double seconds_a_sample_ = 0;  ///< of the pass before; 0 before the first has ended
  double shown_ = 0;             ///< progress so far
  int end_ = 0;                  ///< samples at the end of the pass that is drawn
};

inline void draw_in_passes(Image& image, const RenderOptions& options, DrawSamples draw) {
  PassLoop(image, options, draw)();
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
