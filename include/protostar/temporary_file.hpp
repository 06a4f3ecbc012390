// The names of temporary files, and errors, for both ways to write them: system_file.hpp and
// standard_file.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Reason why a file cannot be opened: an error number, 0 for none, and an addition to the system's message.
struct OpenError {
  int number = 0;
  const char* explanation = "";
};

/// Names of the temporary files for one target: a dot, the target's name, a dot, 16 random hexadecimal
/// digits, and an ending. The files that a killed process leaves behind are recognized by their names, and
/// nobody can plant a file or a link under a name that is still to come.
class TemporaryNames {
 public:
  explicit TemporaryNames(const std::string& target) {
    // File systems are known to allow at least 143 bytes for a name (eCryptfs); with 64 of the target's, a
    // whole number of UTF-8 characters, these have at most 96. Targets that begin alike share a prefix, which
    // is harmless: nobody needs a leftover.
    std::size_t length = target.size() < 64 ? target.size() : 64;
    while (length > 0 && length < target.size() &&
           (static_cast<unsigned char>(target[length]) & 0xc0) == 0x80)
      --length;
    prefix_.append(target, 0, length).append(1, '.');
  }

  /// Returns the name with these bits as digits; random ones make a name that no one can foresee.
  [[nodiscard]] std::string name(std::uint64_t bits) const {
    std::string name = prefix_;
    for (std::size_t i = 0; i < digits; ++i, bits >>= 4) name += hexadecimal[bits & 15];
    return name.append(ending);
  }

  [[nodiscard]] bool contain(std::string_view name) const {
    return name.size() == prefix_.size() + digits + ending.size() && name.starts_with(prefix_) &&
           name.ends_with(ending) &&
           name.substr(prefix_.size(), digits).find_first_not_of(hexadecimal) == std::string_view::npos;
  }

 private:
  static constexpr std::size_t digits = 16;
  static constexpr std::string_view hexadecimal = "0123456789abcdef", ending = ".protostar-tmp";
  std::string prefix_ = ".";
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
