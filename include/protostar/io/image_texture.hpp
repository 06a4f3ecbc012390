// Reads .png and .jpg textures through stb_image, and .hdr ones. Not part of the core: link protostar::png.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Limit on the bytes that stb_image may allocate in one piece, for each thread, and a flag that it wanted
/// more. A few compressed bytes may stand for a million times as many, which no picture needs.
struct StbMemory {
  std::size_t most = std::numeric_limits<std::size_t>::max();
  bool wanted_more = false;
};
inline thread_local StbMemory stb_memory;

/// Allocates memory for stb_image, zeroed so that no picture shows what was there before; or resizes it,
/// which does not zero the new part. Returns null above the limit.
inline void* stb_resized(void* memory, std::size_t size) {
  stb_memory.wanted_more = stb_memory.wanted_more || size > stb_memory.most;
  if (size > stb_memory.most) return nullptr;
  return memory ? std::realloc(memory, size) : std::calloc(1, size);
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail

// Compiled as static functions of this translation unit, which do not conflict with another copy of stb_image
// in a program.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_MALLOC(size) protostar::detail::stb_resized(nullptr, size)
#define STBI_REALLOC(memory, size) protostar::detail::stb_resized(memory, size)
#define STBI_FREE(memory) std::free(memory)
#include <stb_image.h>
#undef STBI_FREE
#undef STBI_REALLOC
#undef STBI_MALLOC
#undef STBI_ONLY_PNG
#undef STBI_ONLY_JPEG
#undef STB_IMAGE_IMPLEMENTATION
#undef STB_IMAGE_STATIC

#include "../encode.hpp"
#include "../environment_image.hpp"
#include "../image.hpp"
#include "../magnitude.hpp"
#include "../material.hpp"
#include "../texture_image.hpp"
#include "check_jpeg.hpp"
#include "check_png.hpp"
#include "read_hdr.hpp"
#include "text.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline bool is_image(std::string_view bytes) { return is_hdr(bytes) || is_png(bytes) || is_jpeg(bytes); }

/// Decodes a checked file with stb_image, and its codes from a transfer curve.
inline Image decoded_by_stb(std::string_view checked, const ImageBytes& file, const Transfer& transfer) {
  const auto* const bytes = reinterpret_cast<const stbi_uc*>(checked.data());
  const int size = static_cast<int>(checked.size());
  int width = 0, height = 0, channels = 0;
  stbi_info_from_memory(bytes, size, &width, &height, &channels);
  // For a PNG, stb_image allocates in one piece at most 8 bytes for each pixel and one for each row, or all
  // of its compressed data, and twice as much if there turns out to be more. For a JPEG it allocates 2 bytes
  // for each coefficient of a component, whose sides are rounded up to 32, or 4 for each pixel; and its
  // tables.
  stb_memory = {.most = 18 * static_cast<std::size_t>(width + 31) * static_cast<std::size_t>(height + 31) +
                        2 * checked.size() + (1 << 16)};
  const std::unique_ptr<stbi_uc, void (*)(void*)> codes(
      stbi_load_from_memory(bytes, size, &width, &height, &channels, 3), stbi_image_free);
  const StbMemory used = std::exchange(stb_memory, {});
  if (!codes) {
    const std::string reason = stbi_failure_reason() ? stbi_failure_reason() : "it is damaged";
    if (used.wanted_more) file.refuse("there are more pixels than its size says");
    if (reason == "outofmem") throw std::bad_alloc();
    file.refuse(reason);
  }
  std::array<float, 256> light{};
  for (std::size_t code = 0; code < light.size(); ++code)
    light[code] = static_cast<float>(
        std::visit([&](auto curve) { return decode(curve, static_cast<double>(code) / 255); }, transfer));
  Image image(width, height);
  const stbi_uc* code = codes.get();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x, code += 3) image(x, y) = {light[code[0]], light[code[1]], light[code[2]]};
  return image;
}

}  // namespace detail

/// Reads the linear light of a picture from the bytes of its file: a PNG, JPEG or Radiance HDR, recognized by
/// its first bytes. PNG and JPEG are decoded from a transfer, as a rule sRGB, with 8 bits per channel and
/// without transparency; HDR is taken as it is. All pixels are finite. `file` is the name in error messages.
///
/// Throws std::runtime_error if the bytes are no such picture or an incomplete one, and, before memory is
/// taken for pixels, if there are more than most_pixels; std::bad_alloc if there is not enough memory.
[[nodiscard]] inline Image image_from_bytes(std::string_view bytes, std::string_view file,
                                            std::int64_t most_pixels = most_image_pixels,
                                            const Transfer& transfer = Srgb{}) {
  const detail::ImageBytes image_file(bytes, file);
  if (detail::is_hdr(bytes)) return detail::HdrReader(image_file, most_pixels).image();
  if (detail::is_png(bytes))
    return detail::decoded_by_stb(detail::checked_png(image_file, most_pixels), image_file, transfer);
  if (detail::is_jpeg(bytes)) {
    detail::JpegCheck(image_file, most_pixels);
    return detail::decoded_by_stb(bytes, image_file, transfer);
  }
  image_file.refuse("the file does not begin as a PNG, a JPEG or a Radiance HDR does");
}

/// Reads the linear light of a picture from its file, as image_from_bytes does. Reading stops early if the
/// file does not begin as a picture or is longer than 2^30 bytes, so that a device without an end is refused.
/// Also throws std::system_error if the file cannot be read.
[[nodiscard]] inline Image load_image(const std::filesystem::path& path,
                                      std::int64_t most_pixels = most_image_pixels,
                                      const Transfer& transfer = Srgb{}) {
  const std::string bytes = detail::bytes_of_file<std::runtime_error>(
      path, detail::most_image_bytes,
      [](std::string_view all, std::string_view) { return !detail::is_image(all); });
  return image_from_bytes(bytes, path.string(), most_pixels, transfer);
}

/// Returns the picture in a file as a texture of the given size in units of u and v. Throws the errors of
/// load_image, and std::invalid_argument if size_u or size_v is not a size (magnitude.hpp).
[[nodiscard]] inline Texture image_texture(const std::filesystem::path& path, double size_u = 1,
                                           double size_v = 1) {
  require_rule(is_size(size_u) && is_size(size_v), "image_texture: size_u and size_v must be", size_rule);
  return ImageTexture{std::make_shared<const Image>(load_image(path)), size_u, size_v, path.string()};
}

/// Returns the picture in a file as an environment (Scene::set_environment). Throws the errors of load_image.
[[nodiscard]] inline Texture environment_image(const std::filesystem::path& path) {
  return EnvironmentImage{std::make_shared<const Image>(load_image(path)), path.string()};
}

}  // namespace protostar::inline PROTOSTAR_ABI
