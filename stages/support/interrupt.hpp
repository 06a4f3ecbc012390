// Ctrl-C and the end of the time: both ask the work to stop, and end the process if it does not.
#pragma once

#include <atomic>
#include <csignal>
#include <protostar/stop_token.hpp>
#include <string>
#include <thread>

/// While one lives, SIGINT, SIGTERM and SIGHUP request a stop: whoever writes a file looks at the token at
/// every block, and removes what is not complete. If the work has not ended a tenth of a second later, the
/// process is ended all the same, so that it lives for half a second at most. It may then have a temporary
/// file, of which it was writing a block; as after SIGKILL, SIGQUIT and whatever else is not caught, the next
/// OutputFile for the same target removes that. A signal that the process was started to ignore, as nohup and
/// the shell's & do, stays ignored.
///
/// A thread waits for the signals. If the system starts none, listens() is false, and a signal ends the
/// process at once, as it does one without an Interrupt. Make it before any other thread, so that all have
/// the signals blocked.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Requests a stop when so many seconds have passed, by SIGALRM, and prints the line; the process then ends
  /// with the status 1. Call it once, before the work begins.
  void set_timeout(double seconds, const std::string& line);

  /// Whether a signal requests a stop.
  bool listens() const { return listener_.joinable(); }

  protostar::StopToken token() const {
    return [this] { return came(); };
  }

  /// Whether a stop was requested.
  bool came() const { return signal_ != 0; }

  /// Returns the exit status of a program that was stopped: 128 and the number of the signal; 1 after the
  /// timeout.
  int status() const;

 private:
  void listen();

  sigset_t mask_before_;
  std::string timeout_line_;
  std::atomic<int> signal_ = 0;
  std::atomic<bool> done_ = false;
  std::thread listener_;
};
