// Common parts of the image readers: errors, limits on size, big-endian numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Largest number of pixels of an image that is read, as many as 8192 × 8192 has. A pixel takes 12 bytes in
/// memory, and 4 more while it is read: about 1 GB in all, which a compressed file of 100 kB may ask for.
inline constexpr std::int64_t most_image_pixels = std::int64_t{1} << 26;

namespace detail {

/// Largest size of an image file in bytes: more than most_image_pixels take without compression, at 8 bytes
/// each in a PNG of 16 bits.
inline constexpr std::size_t most_image_bytes = std::size_t{1} << 30;

/// Returns the unsigned number that bytes hold, the most significant byte first.
inline std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes) number = number << 8 | static_cast<unsigned char>(byte);
  return number;
}

/// Reader of the bytes of an image file, or of a part of it, from the first on; and its name for error
/// messages. All that is read is checked; errors are thrown as std::runtime_error.
class ImageBytes {
 public:
  ImageBytes(std::string_view bytes, std::string_view file, std::string whole = "the file")
      : bytes_(bytes), file_(file), whole_(std::move(whole)) {}

  [[nodiscard]] std::string_view all() const { return bytes_; }
  [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }
  [[nodiscard]] std::size_t at() const { return at_; }  ///< offset of the next byte to be read

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(shown("cannot read '" + std::string(file_) + "': " + what));
  }

  /// Throws std::runtime_error: the file ends inside of the part that `where` names, such as "the header".
  [[noreturn]] void refuse_end(const std::string& where) const {
    refuse(whole_ + " ends after " + std::to_string(bytes_.size()) + " bytes, inside of " + where);
  }

  /// Returns the next `count` bytes and moves past them; refuses a file that ends before them.
  std::string_view take(std::size_t count, const std::string& where) {
    if (count > rest().size()) refuse_end(where);
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }

  /// Returns a reader of the next `count` bytes, which `where` names, and moves past them.
  ImageBytes take_part(std::size_t count, const std::string& where) {
    return {take(count, where), file_, where};
  }

  /// Returns the number in the next `count` bytes and moves past them.
  std::uint32_t number(std::size_t count, const std::string& where) { return big_endian(take(count, where)); }

  /// Returns the bytes that are left up to a delimiter, and moves past it.
  std::string_view take_until(char delimiter, const std::string& where) {
    const std::size_t size = rest().find(delimiter);
    if (size == std::string_view::npos) refuse_end(where);
    return take(size + 1, where).substr(0, size);
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
  std::string whole_;
  std::size_t at_ = 0;
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
