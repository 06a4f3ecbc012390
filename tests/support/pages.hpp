// The pages of docs/, for tests that compare what they state with what is so.
#pragma once

#include <algorithm>
#include <string>

#include "files.hpp"

/// Returns the text of a page, such as stages/09_shadow, in one line.
inline std::string page_in_one_line(const std::string& name) {
  std::string text = bytes_of(std::string(PROTOSTAR_SOURCE_DIR) + "/docs/" + name + ".md");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}
