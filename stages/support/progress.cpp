#include "progress.hpp"

#include <unistd.h>

#include <cstdio>

Progress::Progress(bool quiet) : wanted_(!quiet && isatty(STDERR_FILENO) != 0) {}

void Progress::show(double done) {
  if (!wanted_ || Clock::now() - start_ < std::chrono::seconds(1)) return;
  const int percent = static_cast<int>(100 * done);
  if (percent == shown_) return;
  shown_ = percent;
  std::fprintf(stderr, "\r%3d %%", percent);
  std::fflush(stderr);
}

void Progress::clear() {
  if (shown_ < 0) return;
  shown_ = -1;
  std::fputs("\r       \r", stderr);  // clears five characters, and the two of a ^C
  std::fflush(stderr);
}
