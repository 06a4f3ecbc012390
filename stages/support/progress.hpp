// Shows a percentage on the terminal while the work takes long.
#pragma once

#include <chrono>

/// Display of progress on stderr, shown if that is a terminal and the work has taken longer than a second,
/// and cleared at the end.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows the share that is done, from 0 to 1, in percent.
  void show(double done);

  /// Clears the line, if something is shown.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool wanted_;
  Clock::time_point start_ = Clock::now();
  int shown_ = -1;  // percent; -1: nothing is on the terminal
};
