// Common parts of the image readers: errors, the limit on pixels, numbers in bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The most pixels of an image that is read, as many as 8192 × 8192 has. In memory each takes 12 bytes, and 4
/// more while it is read: about 1 GB in all, which a compressed file of 100 kB may ask for.
inline constexpr std::int64_t most_image_pixels = std::int64_t{1} << 26;

namespace detail {

/// The most bytes of an image's file: more than most_image_pixels take if nothing is compressed, which is 8
/// bytes each in a PNG of 16 bits.
inline constexpr std::size_t most_image_bytes = std::size_t{1} << 30;

/// The bytes of an image's file, and its name in what is wrong with it. Whatever is read from them is
/// checked; what is wrong throws std::runtime_error.
class ImageBytes {
 public:
  ImageBytes(std::string_view bytes, std::string_view file) : bytes_(bytes), file_(file) {}

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] bool starts_with(std::string_view text) const { return bytes_.starts_with(text); }
  [[nodiscard]] std::string_view all() const { return bytes_; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(shown("cannot read '" + std::string(file_) + "': " + what));
  }

  /// Says that the file ends too early; where names a part of it, such as "the header".
  [[noreturn]] void refuse_end(const std::string& where) const {
    refuse("the file ends after " + std::to_string(size()) + " bytes, inside of " + where);
  }

  /// So many bytes from an offset on; refuses a file that ends before.
  [[nodiscard]] std::string_view part(std::size_t offset, std::size_t count, const std::string& where) const {
    if (offset > size() || count > size() - offset) refuse_end(where);
    return bytes_.substr(offset, count);
  }

  /// Refuses sides below 1 and more pixels than are allowed. To be called before memory is taken for them.
  void require_pixels(std::int64_t width, std::int64_t height, std::int64_t most) const {
    if (width < 1 || height < 1 || width > most / height)
      refuse("the picture has " + std::to_string(width) + "x" + std::to_string(height) +
             " pixels; allowed are sides of at least 1 and at most " + std::to_string(most) + " pixels");
  }

  /// Refuses a file that is too short for its picture, which takes at least so many bytes.
  void require_bytes(std::int64_t least, std::int64_t found, const std::string& what) const {
    if (found < least)
      refuse("there are " + std::to_string(found) + " bytes of " + what + "; a picture of this size takes " +
             std::to_string(least) + " or more");
  }

 private:
  std::string_view bytes_, file_;
};

/// The whole number that bytes are, the first of them the highest.
inline std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes) number = number << 8 | static_cast<unsigned char>(byte);
  return number;
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
