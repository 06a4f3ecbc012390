// Texts that come from files: how they are read, and how they are shown in what is wrong with them.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// The bytes of a file, up to its end, or to the end of a block with a zero byte, which no text has and its
/// reader has to refuse: so /dev/zero is refused, which has no end. Throws std::system_error if they cannot
/// be read, and Error if there are more than `most`.
template <class Error>
std::string text_of(const std::filesystem::path& path, std::size_t most) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.string().c_str(), "rb"),
                                                             std::fclose);
  const auto fail = [&] {
    throw std::system_error(errno, std::generic_category(), "cannot read '" + path.string() + "'");
  };
  if (!file) fail();
  std::string text;
  std::vector<char> block(1 << 16);
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    text.append(block.data(), count);
    if (std::memchr(block.data(), '\0', count)) return text;
    if (text.size() > most)
      throw Error(path.string() + ": the file is longer than the " + std::to_string(most) +
                  " bytes that are allowed");
  }
  if (std::ferror(file.get())) fail();
  return text;
}

/// The beginning of a text that may be of any length, whole characters of UTF-8.
inline std::string beginning(const std::string& text, std::size_t most = 60) {
  if (text.size() <= most) return text;
  while ((static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
  return text.substr(0, most) + "...";
}

/// The beginning of bytes that may be anything, with a question mark for what is not to be shown as it is.
inline std::string printable(const std::string& bytes, std::size_t most = 60) {
  std::string text = bytes.substr(0, most + 1);
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return beginning(text, most);
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail
