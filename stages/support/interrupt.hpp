// Ctrl-C: asks the work to stop, and ends the process if it does not.
#pragma once

#include <atomic>
#include <csignal>
#include <stop_token>
#include <thread>

/// While one lives, SIGINT, SIGTERM and SIGHUP request a stop instead of ending the process at once, so that
/// no half-written file is left. Work that does not look at its token for a tenth of a second is ended all
/// the same: it holds no unfinished file, since whoever writes one looks at the token at every block. A
/// signal that the process was started to ignore, as nohup and the shell's & do, stays ignored. Make it
/// before any thread.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return stop_.get_token(); }

  /// The signal that came; 0: none.
  int signal() const { return signal_; }

 private:
  void listen(const std::stop_token& done);

  sigset_t mask_before_;
  std::stop_source stop_;
  std::atomic<int> signal_ = 0;
  std::jthread listener_;
};
