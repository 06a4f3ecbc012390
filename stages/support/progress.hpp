// Shows a percentage on the terminal while the work takes long.
#pragma once

#include <chrono>
#include <string>

/// Display of progress on stderr, shown if that is a terminal and the work has taken longer than a second,
/// and cleared at the end.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows the share that is done, from 0 to 1, in percent, and a note after it.
  void show(double done, const std::string& note = "");

  /// Clears the line, if something is shown.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool wanted_;
  Clock::time_point start_ = Clock::now();
  std::string shown_;  // empty: nothing is on the terminal
};
