// Images of linear light (§2.2.2).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "plain_vector.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Rectangle of pixels: columns [x0, x1) and rows [y0, y1).
struct Tile {
  int x0, y0, x1, y1;

  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int height() const { return y1 - y0; }
  [[nodiscard]] std::uint64_t pixel_count() const {
    return static_cast<std::uint64_t>(width()) * static_cast<std::uint64_t>(height());
  }

  /// Returns the number of tiles of at most side × side pixels that this one is made of, or the i-th of them,
  /// in rows.
  [[nodiscard]] int count(int side) const {
    return ((width() + side - 1) / side) * ((height() + side - 1) / side);
  }
  [[nodiscard]] Tile part(int i, int side) const {
    const int columns = (width() + side - 1) / side;
    const int x = x0 + i % columns * side, y = y0 + i / columns * side;
    return {x, y, std::min(x + side, x1), std::min(y + side, y1)};
  }
};

/// Array of width × height colors in rows from the top, black at first. image(x, y) is the pixel in column x
/// and row y; (0, 0) is the top left. An image that was moved from has no pixels and may only be assigned to.
class Image {
 public:
  static constexpr std::int64_t max_pixels = std::int64_t{1} << 28;

  /// Makes a black image. Throws std::invalid_argument unless it has a size (require_size); no memory is
  /// taken before that is known.
  Image(int width, int height)
      : width_(width), height_(height), pixels_(require_size("Image", width, height), Color{0}) {}

  /// Returns the number of pixels. Throws std::invalid_argument, which begins with what has the size, unless
  /// both sides are at least 1 and there are at most 2^28 pixels.
  static std::size_t require_size(const char* of, std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1 || width > max_pixels / height)
      throw std::invalid_argument(std::string(of) + ": " + std::to_string(width) + "x" +
                                  std::to_string(height) +
                                  " is not a size; sides must be at least 1 and the pixels at most 2^28");
    return static_cast<std::size_t>(width * height);
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Returns the tile of all pixels.
  [[nodiscard]] Tile tile() const { return {0, 0, width_, height_}; }

  /// Returns the pixel in column x of [0, width) and row y of [0, height). The range is not checked.
  [[nodiscard]] Color& operator()(int x, int y) { return pixels_[index(x, y)]; }
  [[nodiscard]] const Color& operator()(int x, int y) const { return pixels_[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  PlainVector<Color> pixels_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
