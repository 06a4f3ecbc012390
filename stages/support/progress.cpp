#include "progress.hpp"

#include <unistd.h>

#include <cstdio>

Progress::Progress(bool quiet) : wanted_(!quiet && isatty(STDERR_FILENO) != 0) {}

void Progress::operator()(double done) {
  if (!wanted_ || Clock::now() - start_ < std::chrono::seconds(1)) return;
  const int percent = static_cast<int>(100 * done);
  if (percent == shown_) return;
  shown_ = percent;
  if (done < 1)
    std::fprintf(stderr, "\r%3d %%", percent);
  else
    std::fputs("\r     \r", stderr);
  std::fflush(stderr);
}
