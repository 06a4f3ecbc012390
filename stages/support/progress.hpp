// A percentage on the terminal while the work takes long.
#pragma once

#include <chrono>

/// Shows progress on stderr if that is a terminal and the work has taken longer than a second, and clears it
/// at the end.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Takes the share that is done, from 0 to 1.
  void show(double done);

  /// Leaves the line empty.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool wanted_;
  Clock::time_point start_ = Clock::now();
  int shown_ = -1;  // per cent; -1: nothing is on the terminal
};
