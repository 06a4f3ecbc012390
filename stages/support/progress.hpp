// A percentage on the terminal while the work takes long.
#pragma once

#include <chrono>

/// Shows progress on stderr if that is a terminal and the work has taken longer than a second, and clears it
/// at its end.
class Progress {
 public:
  explicit Progress(bool quiet);

  /// Takes the share that is done, from 0 to 1.
  void operator()(double done);

 private:
  using Clock = std::chrono::steady_clock;

  bool wanted_;
  Clock::time_point start_ = Clock::now();
  int shown_ = -1;  // per cent; -1: nothing is on the terminal
};
