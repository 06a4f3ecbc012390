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
  JpegCheck(const ImageBytes& jpeg, std::int64_t most_pixels) : jpeg_(jpeg) {
    jpeg_.take(2, "the start marker of a JPEG");
    for (std::uint32_t marker = take_marker(jpeg_); marker != end_of_image; marker = take_marker(jpeg_)) {
      if (is_restart(marker)) continue;  // read_scan counts those of a scan; before one, they are skipped
      ImageBytes segment = next_segment();
      if (0xc0 <= marker && marker <= 0xc2)
        read_frame(segment, marker == 0xc2, most_pixels);
      else if (marker == 0xc4)
        read_huffman_tables(segment);
      else if (marker == 0xdb)
        read_quantizers(segment);
      else if (marker == 0xdd)
        restart_interval_ = segment.number(2, "the restart interval");
      else if (marker == 0xda)
        read_scan(segment);
    }
    if (components_.empty()) jpeg_.refuse("a JPEG without a frame that is read, SOF0, SOF1 or SOF2");
    for (const Component& component : components_)
      if (!component.is_there)
        jpeg_.refuse("no scan of a JPEG has its component " + std::to_string(component.id));
  }

 private:
  static constexpr std::uint32_t end_of_image = 0xd9;

  struct Component {
    std::uint32_t id, h, v, quantizer;  ///< a minimum coded unit has h × v blocks of it
    bool is_there = false;
  };

  static bool is_restart(std::uint32_t marker) { return 0xd0 <= marker && marker <= 0xd7; }

  /// Moves past the next marker, an 0xff and a byte that is neither 0 nor 0xff, and returns that byte.
  static std::uint32_t take_marker(ImageBytes& from) {
    std::uint32_t marker = 0;
    while (marker == 0) {
      from.take_until('\xff', "a JPEG, whose last marker is FF D9");
      do marker = from.number(1, "a marker of a JPEG");
      while (marker == 0xff);
    }
    return marker;
  }

  /// Returns the segment that follows a marker, without its length field, and moves past it.
  ImageBytes next_segment() {
    const std::string where = "a segment of a JPEG";
    const std::uint32_t length = jpeg_.number(2, where);
    if (length < 2) jpeg_.refuse(where + " has a length below 2");
    return jpeg_.take_part(length - 2, where);
  }

  void read_frame(ImageBytes& frame, bool is_progressive, std::int64_t most_pixels) {
    const std::string where = "its frame";
    if (!components_.empty()) jpeg_.refuse("a JPEG with two frames");
    is_progressive_ = is_progressive;
    frame.take(1, where);
    height_ = frame.number(2, where);
    width_ = frame.number(2, where);
    jpeg_.require_pixels(width_, height_, most_pixels);
    for (std::uint32_t remaining = frame.number(1, where); remaining > 0; --remaining) {
      const std::uint32_t id = frame.number(1, where), sampling = frame.number(1, where);
      components_.push_back({id, sampling >> 4, sampling & 15, frame.number(1, where)});
      most_h_ = std::max<std::int64_t>(most_h_, sampling >> 4);
      most_v_ = std::max<std::int64_t>(most_v_, sampling & 15);
    }
  }

  void read_huffman_tables(ImageBytes& tables) {
    const std::string where = "a Huffman table";
    while (!tables.rest().empty()) {
      has_huffman_[tables.number(1, where)] = true;
      std::uint32_t symbols = 0;
      for (int length = 1; length <= 16; ++length) symbols += tables.number(1, where);
      if (symbols > 256) jpeg_.refuse("a Huffman table of a JPEG has more than 256 symbols");
      tables.take(symbols, where);
    }
  }

  void read_quantizers(ImageBytes& tables) {
    const std::string where = "a quantization table";
    while (!tables.rest().empty()) {
      const std::uint32_t precision_and_number = tables.number(1, where);
      has_quantizer_[precision_and_number & 15] = true;
      tables.take(precision_and_number < 16 ? 64 : 128, where);
    }
  }

  /// Returns the number of minimum coded units in a scan of components, which for one component are its
  /// blocks without those in the margin.
  [[nodiscard]] std::int64_t units(std::int64_t h, std::int64_t v) const {
    const auto ratio_up = [](std::int64_t a, std::int64_t b) { return (a + b - 1) / b; };
    return ratio_up(ratio_up(width_ * h, most_h_), 8) * ratio_up(ratio_up(height_ * v, most_v_), 8);
  }

  void read_scan(ImageBytes& scan) {
    const std::string place = "the scan of a JPEG at byte " + std::to_string(jpeg_.at()), where = "its scan";
    const std::uint32_t count = scan.number(1, where);
    ImageBytes selected = scan.take_part(std::size_t{2} * count, where);
    const std::uint32_t first_coefficient = scan.number(1, where), last = scan.number(1, where);
    const bool is_refinement = scan.number(1, where) >> 4 != 0;
    const bool has_dc = !is_progressive_ || (first_coefficient == 0 && !is_refinement);
    const bool has_ac = !is_progressive_ || last > 0;
    std::int64_t blocks_in_mcu = 0, mcus = 0;
    while (!selected.rest().empty()) {
      const std::uint32_t id = selected.number(1, where), tables = selected.number(1, where);
      const auto found = std::find_if(components_.begin(), components_.end(),
                                      [&](const Component& component) { return component.id == id; });
      if (found == components_.end()) jpeg_.refuse(place + " names a component that its frame does not have");
      if ((has_dc && !has_huffman_[tables >> 4]) || (has_ac && !has_huffman_[16 + (tables & 15)]) ||
          !has_quantizer_[found->quantizer])
        jpeg_.refuse(place + " needs a table that is not there");
      found->is_there = found->is_there || has_dc;
      blocks_in_mcu += count == 1 ? 1 : std::int64_t{found->h} * found->v;
      mcus = count == 1 ? units(found->h, found->v) : units(1, 1);
    }
    ImageBytes behind = jpeg_;
    std::int64_t restarts = 0;
    while (is_restart(take_marker(behind))) ++restarts;
    const std::size_t size = behind.at() - 2 - jpeg_.at();
    const std::int64_t wanted = restart_interval_ > 0 ? (mcus - 1) / restart_interval_ : 0;
    // An encoder may write one more restart marker at the end.
    if (restarts < wanted || restarts > (restart_interval_ > 0 ? wanted + 1 : 0))
      jpeg_.refuse(place + " has " + std::to_string(restarts) + " restart markers, and not " +
                   std::to_string(wanted));
    // A block takes at least one bit for its DC coefficient, and one for all others, which a progressive JPEG
    // may leave to another scan.
    if (has_dc)
      jpeg_.require_bytes(mcus * blocks_in_mcu * (is_progressive_ ? 1 : 2) / 8,
                          static_cast<std::int64_t>(size), "a scan");
  }

  ImageBytes jpeg_;
  std::int64_t width_ = 0, height_ = 0, most_h_ = 1, most_v_ = 1;
  bool is_progressive_ = false;
  std::int64_t restart_interval_ = 0;  ///< in minimum coded units; 0: none
  std::vector<Component> components_;
  std::array<bool, 256> has_huffman_{};    ///< by number, plus 16 for those of AC coefficients
  std::array<bool, 256> has_quantizer_{};  ///< by number
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
