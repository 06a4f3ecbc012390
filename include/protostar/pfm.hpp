// Images as PFM files: linear light as 32-bit floats.
#pragma once

#include <bit>
#include <cstddef>
#include <string>

#include "image.hpp"
#include "output_file.hpp"
#include "stop_token.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Saves an image as PFM: every float as it is, in the byte order of the machine, which the header states,
/// rows from the bottom up as in the format. Nothing is encoded or clipped.
///
/// The file is replaced as a whole or not at all (see OutputFile, also for its errors). If a stop is
/// requested, it returns early and leaves the file as it was.
inline void save_pfm(const Image& image, const FileName& path, const StopToken& stop = {}) {
  OutputFile file(path);
  file.write("PF\n" + std::to_string(image.width()) + " " + std::to_string(image.height()) + "\n" +
             (std::endian::native == std::endian::little ? "-1.0\n" : "1.0\n"));
  constexpr int block = 1 << 16;  // pixels written at a time
  for (int y = image.height() - 1; y >= 0; --y) {
    for (int x = 0; x < image.width(); x += block) {
      if (stop.stop_requested()) return;
      const int count = image.width() - x < block ? image.width() - x : block;
      file.write(&image(x, y), static_cast<std::size_t>(count) * sizeof(Color));
    }
  }
  file.commit();
}

}  // namespace protostar::inline PROTOSTAR_ABI
