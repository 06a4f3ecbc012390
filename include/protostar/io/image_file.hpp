// Common parts of the image readers: errors, limits on size, big-endian numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Largest number of pixels of an image that is read, as many as 8192 × 8192 has. A pixel takes 12 bytes in
/// memory, and 4 more while it is read: about 1 GB in all, which a compressed file of 100 kB may ask for.
inline constexpr std::int64_t most_image_pixels = std::int64_t{1} << 26;

namespace detail {

/// Largest size of an image file in bytes: more than most_image_pixels take without compression, at 8 bytes
/// each in a PNG of 16 bits.
inline constexpr std::size_t most_image_bytes = std::size_t{1} << 30;

/// Bytes of an image file, and its name for error messages. All that is read from them is checked; errors are
/// thrown as std::runtime_error.
class ImageBytes {
 public:
  ImageBytes(std::string_view bytes, std::string_view file) : bytes_(bytes), file_(file) {}

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] bool starts_with(std::string_view text) const { return bytes_.starts_with(text); }
  [[nodiscard]] std::string_view all() const { return bytes_; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(shown("cannot read '" + std::string(file_) + "': " + what));
  }

  /// Throws std::runtime_error: the file ends inside of the part that `where` names, such as "the header".
  [[noreturn]] void refuse_end(const std::string& where) const {
    refuse("the file ends after " + std::to_string(size()) + " bytes, inside of " + where);
  }

  /// Returns `count` bytes from an offset on; refuses a file that ends before them.
  [[nodiscard]] std::string_view part(std::size_t offset, std::size_t count, const std::string& where) const {
    if (offset > size() || count > size() - offset) refuse_end(where);
    return bytes_.substr(offset, count);
  }

  /// Refuses sides below 1 and more than `most` pixels. Call it before memory is taken for them.
  void require_pixels(std::int64_t width, std::int64_t height, std::int64_t most) const {
    if (width < 1 || height < 1 || width > most / height)
      refuse("the picture has " + std::to_string(width) + "x" + std::to_string(height) +
             " pixels; allowed are sides of at least 1 and at most " + std::to_string(most) + " pixels");
  }

  /// Refuses a file that has fewer bytes than the `least` that a picture of its size takes.
  void require_bytes(std::int64_t least, std::int64_t found, const std::string& what) const {
    if (found < least)
      refuse("there are " + std::to_string(found) + " bytes of " + what + "; a picture of this size takes " +
             std::to_string(least) + " or more");
  }

 private:
  std::string_view bytes_, file_;
};

/// Returns the unsigned number that bytes hold, the most significant byte first.
inline std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes) number = number << 8 | static_cast<unsigned char>(byte);
  return number;
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
