#include "progress.hpp"

#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <utility>

Progress::Progress(bool quiet) : wanted_(!quiet && isatty(STDERR_FILENO) != 0) {}

void Progress::show(double done, const std::string& note) {
  if (!wanted_ || Clock::now() - start_ < std::chrono::seconds(1)) return;
  std::array<char, 8> percent;
  std::snprintf(percent.data(), percent.size(), "%3d %%", static_cast<int>(100 * done));
  std::string text = percent.data() + note;
  if (text == shown_) return;
  const std::size_t rest = shown_.size() > text.size() ? shown_.size() - text.size() : 0;
  std::fputs(("\r" + text + std::string(rest, ' ')).c_str(), stderr);
  std::fflush(stderr);
  shown_ = std::move(text);
}

void Progress::clear() {
  if (shown_.empty()) return;
  const std::string blank(shown_.size() + 2, ' ');  // clears the two characters of a ^C too
  std::fputs(("\r" + blank + "\r").c_str(), stderr);
  std::fflush(stderr);
  shown_.clear();
}
