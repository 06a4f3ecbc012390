// Makes text from elsewhere, such as the name of a file, safe to show in a message; and numbers and types
// readable there.
#pragma once

#include <version>

#if defined(__cpp_lib_to_chars)
#include <charconv>
#else
#include <clocale>
#include <cstdio>
#include <cstdlib>
#endif

#include <cstddef>
#include <string>
#include <string_view>
#ifndef __GNUC__
#include <typeinfo>
#endif

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Returns the number of bytes of the UTF-8 character at the beginning of a text; 0 if there is none.
inline std::size_t bytes_of_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (text.empty()) return 0;
  const unsigned lead = byte(0);
  const std::size_t size = lead < 0x80   ? 1
                           : lead < 0xc2 ? 0
                           : lead < 0xe0 ? 2
                           : lead < 0xf0 ? 3
                           : lead < 0xf5 ? 4
                                         : 0;
  if (size > text.size()) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  // Excluded are characters that have a shorter form (RFC 3629), surrogates, and any above U+10FFFF.
  if ((lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xed && byte(1) >= 0xa0) ||
      (lead == 0xf0 && byte(1) < 0x90) || (lead == 0xf4 && byte(1) >= 0x90))
    return 0;
  return size;
}

}  // namespace detail

/// Returns a text with \xNN in place of each byte that belongs to a control character (U+0000 to U+001F and
/// U+007F to U+009F) or to no character of UTF-8, so that it stays in its line and cannot give orders to a
/// terminal. All other characters stay as they are, and so does a text that was shown before.
inline std::string shown(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result;
  while (!text.empty()) {
    const std::size_t size = detail::bytes_of_character(text);
    const unsigned char first = static_cast<unsigned char>(text[0]);
    const bool is_control = (size == 1 && (first < 0x20 || first == 0x7f)) ||
                            (size == 2 && first == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0);
    for (const char c : text.substr(0, size == 0 ? 1 : size)) {
      const unsigned char byte = static_cast<unsigned char>(c);
      if (size == 0 || is_control)
        result.append("\\x").append({digits[byte / 16u], digits[byte % 16u]});
      else
        result += c;
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return result;
}

/// Returns a number with so many digits that no other double reads the same, such as 0.1; in any locale with
/// a point.
[[nodiscard]] inline std::string shown(double number) {
  char digits[32]{};  // -2.2250738585072014e-308, as long as any, has 24
#if defined(__cpp_lib_to_chars)
  std::to_chars(digits, digits + sizeof digits, number);
  return digits;
#else  // libc++ 14; 17 digits tell all doubles apart
  for (int count = 1; count <= 17; ++count) {
    std::snprintf(digits, sizeof digits, "%.*g", count, number);
    if (std::strtod(digits, nullptr) == number) break;
  }
  std::string text = digits;
  const std::string_view point = std::localeconv()->decimal_point;
  if (const std::size_t at = text.find(point); at != text.npos) text.replace(at, point.size(), ".");
  return text;
#endif
}

/// Returns the name of a type, as the compiler writes it.
template <class T>
[[nodiscard]] auto name_of_type() {
#ifdef __GNUC__  // g++ and clang: "auto …::name_of_type() [with T = NAME]" or "[T = NAME]"
  const std::string_view text = __PRETTY_FUNCTION__, before = "T = ";
  const std::size_t begin = text.find(before) + before.size();
  return text.substr(begin, text.size() - 1 - begin);
#else
  return std::string_view(typeid(T).name());
#endif
}

}  // namespace protostar::inline PROTOSTAR_ABI
