// The name of a file, as a function takes it that writes one.
#pragma once

#include <string>
#include <utility>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Name of a file: a text, or anything with string(), such as a std::filesystem::path, whose header takes
/// long to compile.
class FileName {
 public:
  FileName(const char* text) : text_(text) {}
  FileName(std::string text) : text_(std::move(text)) {}

  template <class Path>
  requires requires(const Path& path) { std::string(path.string()); }
  FileName(const Path& path) : text_(path.string()) {}

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
