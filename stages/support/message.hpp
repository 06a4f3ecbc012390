// Formats text from elsewhere, such as the name of a file, and numbers for the lines that a program prints.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <new>
#include <protostar/shown.hpp>
#include <string>

/// Returns a text of at most `most` ≥ 5 bytes: a longer one keeps its beginning and its end, in whole
/// characters of UTF-8, with three dots between them.
inline std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  const auto continues = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80; };
  std::size_t first = most / 2, last = text.size() - (most - 3 - first);
  while (first > 0 && continues(first)) --first;
  while (last < text.size() && continues(last)) ++last;
  return text.substr(0, first) + "..." + text.substr(last);
}

/// Returns a number with so many significant digits, such as 0.1 or 1e-05.
inline std::string in_digits(double number, int digits) {
  std::array<char, 32> text;  // of 17 digits, a sign, a point and an exponent such as e-308
  std::snprintf(text.data(), text.size(), "%.*g", digits, number);
  return text.data();
}

/// Returns an error or a warning as one line: control characters are shown and not sent to the terminal, and
/// an error of more than 500 bytes, which begins with what is wrong and ends with the reason, loses its
/// middle.
inline std::string error_line(const std::string& program, const std::string& error) {
  return protostar::shown(program) + ": " + shortened(protostar::shown(error), 500) + "\n";
}

/// Prints an error or a warning to stderr; without memory for it, only that memory has run out.
inline void print_error(const std::string& program, const char* error) {
  try {
    std::fputs(error_line(program, error).c_str(), stderr);
  } catch (const std::bad_alloc&) {
    std::fputs("not enough memory\n", stderr);
  }
}
inline void print_error(const std::string& program, const std::string& error) {
  print_error(program, error.c_str());
}
