// Checks that a JPEG (ITU-T T.81) is complete; stb_image fills the missing part of a truncated one with gray.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "image_file.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

inline bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8\xff"); }

/// Checker of JPEGs, by their markers and without decoding. The constructor throws std::runtime_error unless
/// all of the picture can be there: the end marker, a scan of each component with the tables that it names,
/// as many restart markers in a scan as its size asks for, and at least the shortest code for each block of 8
/// × 8. A file that no decoder reads at all is left to stb_image to refuse.
class JpegCheck {
 public:
  JpegCheck(const ImageBytes& jpeg, std::int64_t most_pixels) : jpeg_(jpeg), most_pixels_(most_pixels) {
    at_ = 2;  // past the start marker
    for (int marker = next_marker(); marker != end_of_image; marker = next_marker()) {
      switch (marker) {
        case 0xc0:
        case 0xc1:
        case 0xc2:
          read_frame(marker == 0xc2);
          break;
        case 0xc4:
          read_huffman_tables();
          break;
        case 0xdb:
          read_quantizers();
          break;
        case 0xdd:
          restart_interval_ = big_endian(part(segment(), 0, 2));
          break;
        case 0xda:
          read_scan();
          break;
        default:
          (void)segment();
      }
    }
    if (components_.empty()) jpeg_.refuse("a JPEG without a frame that is read, SOF0, SOF1 or SOF2");
    for (const Component& component : components_)
      if (!component.is_there)
        jpeg_.refuse("no scan of a JPEG has its component " + std::to_string(component.id));
  }

  /// Returns an upper bound for the bytes that a decoder allocates in one piece, which holds two for each
  /// coefficient of the largest component, or four for each pixel, plus a hundred of overhead; or the
  /// decoder's tables.
  [[nodiscard]] std::size_t most_block() const {
    return static_cast<std::size_t>(2 * 64 * mcus_x() * most_h_ * mcus_y() * most_v_ +
                                    4 * std::int64_t{width_} * height_ + (1 << 16));
  }

 private:
  static constexpr int end_of_image = 0xd9;

  struct Component {
    int id = 0, h = 0, v = 0, quantizer = 0;  ///< a minimum coded unit has h × v blocks of it
    bool is_there = false;
  };

  /// Moves past the next marker, an 0xff and a byte that is neither 0 nor 0xff, and returns that byte.
  int next_marker() {
    for (;;) {
      at_ = jpeg_.all().find('\xff', at_);
      if (at_ == std::string_view::npos) jpeg_.refuse_end("a JPEG, whose last marker is FF D9");
      const int next = static_cast<unsigned char>(jpeg_.part(at_, 2, "a marker of a JPEG")[1]);
      at_ += next == 0xff ? 1 : 2;
      if (next != 0 && next != 0xff) return next;
    }
  }

  /// Returns the bytes of the segment that follows a marker, without its length field, and moves past it.
  std::string_view segment() {
    const std::string where = "a segment of a JPEG";
    const std::size_t length = big_endian(jpeg_.part(at_, 2, where));
    if (length < 2) refuse_segment();
    const std::string_view bytes = jpeg_.part(at_ + 2, length - 2, where);
    at_ += length;
    return bytes;
  }

  [[noreturn]] void refuse_segment() const {
    jpeg_.refuse("a segment of a JPEG that ends at byte " + std::to_string(at_) + " is too short, or wrong");
  }

  [[nodiscard]] std::string_view part(std::string_view segment, std::size_t offset, std::size_t count) const {
    if (offset > segment.size() || count > segment.size() - offset) refuse_segment();
    return segment.substr(offset, count);
  }
  [[nodiscard]] int byte(std::string_view segment, std::size_t offset) const {
    return static_cast<unsigned char>(part(segment, offset, 1)[0]);
  }

  void read_frame(bool is_progressive) {
    const std::string_view frame = segment();
    if (!components_.empty()) jpeg_.refuse("a JPEG with two frames");
    is_progressive_ = is_progressive;
    height_ = static_cast<int>(big_endian(part(frame, 1, 2)));
    width_ = static_cast<int>(big_endian(part(frame, 3, 2)));
    jpeg_.require_pixels(width_, height_, most_pixels_);
    const std::size_t count = static_cast<std::size_t>(byte(frame, 5));
    for (std::size_t i = 0; i < count; ++i) {
      const int sampling = byte(frame, 7 + 3 * i);
      const Component component{.id = byte(frame, 6 + 3 * i),
                                .h = sampling >> 4,
                                .v = sampling & 15,
                                .quantizer = byte(frame, 8 + 3 * i)};
      if (component.h < 1 || component.h > 4 || component.v < 1 || component.v > 4 || component.quantizer > 3)
        refuse_segment();
      most_h_ = std::max(most_h_, component.h);
      most_v_ = std::max(most_v_, component.v);
      components_.push_back(component);
    }
  }

  void read_huffman_tables() {
    const std::string_view tables = segment();
    for (std::size_t at = 0; at < tables.size();) {
      const std::size_t of_ac = static_cast<std::size_t>(byte(tables, at)) >> 4,
                        number = static_cast<std::size_t>(byte(tables, at) & 15);
      std::size_t symbols = 0;
      for (std::size_t i = 1; i <= 16; ++i) symbols += static_cast<std::size_t>(byte(tables, at + i));
      if (of_ac > 1 || number > 3 || symbols > 256) refuse_segment();
      (void)part(tables, at + 17, symbols);
      has_huffman_[of_ac][number] = true;
      at += 17 + symbols;
    }
  }

  void read_quantizers() {
    const std::string_view tables = segment();
    for (std::size_t at = 0; at < tables.size();) {
      const std::size_t bytes = byte(tables, at) >> 4 != 0 ? 2 : 1,
                        number = static_cast<std::size_t>(byte(tables, at) & 15);
      if (number > 3) refuse_segment();
      (void)part(tables, at + 1, 64 * bytes);
      has_quantizer_[number] = true;
      at += 1 + 64 * bytes;
    }
  }

  [[nodiscard]] static std::int64_t ratio_up(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }
  [[nodiscard]] std::int64_t mcus_x() const { return ratio_up(width_, std::int64_t{8} * most_h_); }
  [[nodiscard]] std::int64_t mcus_y() const { return ratio_up(height_, std::int64_t{8} * most_v_); }

  void read_scan() {
    const std::string_view scan = segment();
    const std::string place = "the scan of a JPEG at byte " + std::to_string(at_);
    const std::size_t count = static_cast<std::size_t>(byte(scan, 0));
    const int first_coefficient = byte(scan, 1 + 2 * count), last = byte(scan, 2 + 2 * count);
    const bool is_refinement = byte(scan, 3 + 2 * count) >> 4 != 0;
    const bool has_dc = !is_progressive_ || (first_coefficient == 0 && !is_refinement);
    const bool has_ac = !is_progressive_ || last > 0;
    std::int64_t blocks_in_mcu = 0, mcus = mcus_x() * mcus_y();
    for (std::size_t i = 0; i < count; ++i) {
      const int id = byte(scan, 1 + 2 * i), tables = byte(scan, 2 + 2 * i);
      const auto found = std::find_if(components_.begin(), components_.end(),
                                      [&](const Component& component) { return component.id == id; });
      if (found == components_.end()) jpeg_.refuse(place + " names a component that its frame does not have");
      const std::size_t dc = static_cast<std::size_t>(tables >> 4),
                        ac = static_cast<std::size_t>(tables & 15);
      if (dc > 3 || ac > 3 || (has_dc && !has_huffman_[0][dc]) || (has_ac && !has_huffman_[1][ac]) ||
          !has_quantizer_[static_cast<std::size_t>(found->quantizer)])
        jpeg_.refuse(place + " needs a table that is not there");
      found->is_there = found->is_there || has_dc;
      blocks_in_mcu += std::int64_t{found->h} * found->v;
      if (count == 1) {  // a unit is then one block, and blocks in the margin are left out
        mcus = ratio_up(ratio_up(std::int64_t{width_} * found->h, most_h_), 8) *
               ratio_up(ratio_up(std::int64_t{height_} * found->v, most_v_), 8);
        blocks_in_mcu = 1;
      }
    }
    const std::size_t start = at_;
    std::int64_t restarts = 0;
    for (int marker = next_marker();; marker = next_marker()) {
      if (marker < 0xd0 || 0xd7 < marker) break;
      ++restarts;
    }
    at_ -= 2;  // back to the marker that ended the scan
    const std::int64_t wanted = restart_interval_ > 0 ? (mcus - 1) / restart_interval_ : 0;
    // An encoder may write one more restart marker at the end.
    if (restarts < wanted || restarts > (restart_interval_ > 0 ? wanted + 1 : 0))
      jpeg_.refuse(place + " has " + std::to_string(restarts) + " restart markers, and not " +
                   std::to_string(wanted));
    // A block takes at least one bit for its DC coefficient, and one for all others, which a progressive JPEG
    // may leave to another scan.
    if (has_dc)
      jpeg_.require_bytes(mcus * blocks_in_mcu * (is_progressive_ ? 1 : 2) / 8,
                          static_cast<std::int64_t>(at_ - start), "a scan");
  }

  ImageBytes jpeg_;
  std::int64_t most_pixels_;
  std::size_t at_ = 0;  ///< offset of the next byte to be read
  int width_ = 0, height_ = 0, most_h_ = 1, most_v_ = 1;
  bool is_progressive_ = false;
  std::int64_t restart_interval_ = 0;  ///< in minimum coded units; 0: none
  std::vector<Component> components_;
  std::array<std::array<bool, 4>, 2> has_huffman_{};  ///< by class (0: DC, 1: AC) and number
  std::array<bool, 4> has_quantizer_{};
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
