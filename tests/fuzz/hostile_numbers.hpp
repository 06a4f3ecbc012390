// Scenes with hostile numbers: valid scenes, some of whose numbers are replaced.
#pragma once

#include <cctype>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Numbers at the ends of double and float, at the limits of scene files and just beyond them, and numbers
/// whose squares, cubes and quotients overflow, vanish or lose all their digits. Most of them are allowed in
/// most places.
inline constexpr std::string_view hostile_numbers[] = {
    "0", "-0.0", "1", "-1", "0.5", "2", "-3", "1e-3", "1000", "90", "180", "179.99999999999997",
    // double
    "4.9406564584124654e-324", "-4.9406564584124654e-324", "2.2250738585072011e-308",
    "1.7976931348623157e308", "1e-300", "-1e300", "1.4916681462400413e-154", "1e-160",
    // the limits 2^400 and 2^-400
    "2.5822498780869086e120", "-2.5822498780869086e120", "2.5822498780869082e120", "2.5822498780869091e120",
    "3.8725919148493183e-121", "3.8725919148493178e-121", "-3.8725919148493183e-121",
    // roots of the limits of double, and numbers far from 1
    "1e120", "-1e120", "1e-120", "1e102", "1e100", "-1e100", "1e-100", "1e77", "-1e77", "1e-77", "1e60",
    "-1e60", "1e-60", "1e30", "-1e30", "1e-30", "1e20", "-1e20", "1e-20", "1e15", "1e-15", "1e10",
    // float
    "3.4028234663852886e38", "3.4028235677973366e38", "1e38", "1e-38", "1.4012984643248171e-45", "1e-46",
    // integers
    "18446744073709551616", "9223372036854775807", "9007199254740993", "4294967296", "2147483648", "65537",
    // next to 1
    "1.0000000000000002", "0.99999999999999989"};

/// Returns the positions of the numbers in a JSON text: pairs of begin and end. Digits inside of strings
/// count, too, which does no harm.
inline std::vector<std::pair<std::size_t, std::size_t>> numbers_in(const std::string& text) {
  const auto is_part = [](char c) {
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E';
  };
  std::vector<std::pair<std::size_t, std::size_t>> numbers;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = (text[i] == '-' || (text[i] >= '0' && text[i] <= '9')) &&
                        (i == 0 || std::string_view("[:, \n").find(text[i - 1]) != std::string_view::npos);
    if (!begins) continue;
    const std::size_t begin = i;
    while (i < text.size() && is_part(text[i])) ++i;
    numbers.emplace_back(begin, i);
  }
  return numbers;
}

/// Returns the text with count of its numbers, drawn at random, replaced by hostile ones; equal for equal
/// seeds.
inline std::string with_hostile_numbers(std::string text, std::uint32_t seed, int count) {
  std::minstd_rand random(seed + 1);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) / 7 % n; };
  for (int i = 0; i < count; ++i) {
    const auto numbers = numbers_in(text);
    if (numbers.empty()) return text;
    const auto [begin, end] = numbers[below(numbers.size())];
    // One in four is another number of the text, so that surfaces coincide.
    const auto [from, to] = numbers[below(numbers.size())];
    const std::string other = below(4) == 0 ? text.substr(from, to - from)
                                            : std::string(hostile_numbers[below(std::size(hostile_numbers))]);
    text.replace(begin, end - begin, other);
  }
  return text;
}
