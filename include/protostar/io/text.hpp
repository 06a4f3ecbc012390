// Reads files and numbers, and shortens text for messages.
#pragma once

#include <version>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <clocale>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include "../error_number.hpp"
#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Reads the bytes of a file, up to its end, or to the end of the first block after which is_enough(all bytes
/// read, the block) is true. Throws std::system_error if they cannot be read, and Error if there are more
/// than `most`; for a file of known size, before any memory is taken.
template <class Error>
std::string bytes_of_file(const std::filesystem::path& path, std::size_t most, const auto& is_enough) {
  const auto fail = [&] {
    throw std::system_error(error_number(), std::generic_category(),
                            "cannot read '" + shown(path.string()) + "'");
  };
  const auto require_at_most = [&](std::uintmax_t size) {
    if (size > most)
      throw Error(shown(path.string()) + ": the file is longer than the " + std::to_string(most) +
                  " bytes that are allowed");
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.string().c_str(), "rb"),
                                                             std::fclose);
  if (!file) fail();
  std::string bytes;
  std::error_code unknown;  // set if there is no size, as for a pipe or a device
  if (const std::uintmax_t size = std::filesystem::file_size(path, unknown); !unknown) {
    require_at_most(size);
    bytes.reserve(static_cast<std::size_t>(size));
  }
  std::vector<char> block(1 << 16);
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    bytes.append(block.data(), count);
    if (is_enough(std::string_view(bytes), std::string_view(block.data(), count))) return bytes;
    require_at_most(bytes.size());
  }
  if (std::ferror(file.get())) fail();
  return bytes;
}

/// Reads the bytes of a text file, up to its end or to the end of the first block with a zero byte, which no
/// text has and the caller has to refuse. Hence /dev/zero, which has no end, is refused at once.
template <class Error>
std::string text_of(const std::filesystem::path& path, std::size_t most) {
  return bytes_of_file<Error>(path, most, [](std::string_view, std::string_view block) {
    return block.find('\0') != std::string_view::npos;
  });
}

/// Reads a text that is one decimal number, such as -1.5e3, in any locale; rounds to the nearest. Returns
/// nothing for any other text, and for a number beyond the range of its type; inf and nan are read by some
/// standard libraries only.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
#if !defined(__cpp_lib_to_chars)  // from_chars of libc++ 14 reads whole numbers only
  if constexpr (std::is_same_v<Number, double>) {
    // strtod also reads blanks, a +, hexadecimal digits, inf and nan, and takes the point of the locale.
    if (text.empty() || text[0] == '+' || text.find_first_not_of("0123456789.eE+-") != text.npos)
      return std::nullopt;
    std::string digits(text);
    if (const std::size_t point = digits.find('.'); point != digits.npos)
      digits.replace(point, 1, std::localeconv()->decimal_point);
    char* end = nullptr;
    errno = 0;
    value = std::strtod(digits.c_str(), &end);
    const bool is_number = *end == '\0' && std::isfinite(value) && (errno == 0 || value != 0);
    return is_number ? std::optional(value) : std::nullopt;
  } else
#endif
  {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
  }
}

/// Removes and returns the next word of a line, up to a blank or a tab; empty if there is none.
inline std::string_view taken_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

/// Returns the beginning of a text in whole UTF-8 characters: at most `most` bytes, and "..." if it is cut.
inline std::string beginning(const std::string& text, std::size_t most = 60) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
  return text.substr(0, most) + "...";
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail
