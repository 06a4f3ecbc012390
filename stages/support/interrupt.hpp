// Stops the work on Ctrl-C or a timeout, and ends the process if the work does not stop.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <protostar/stop_token.hpp>
#include <string>
#include <thread>

/// Catcher of SIGINT, SIGTERM and SIGHUP: during its lifetime they request a stop. Code that writes a file
/// looks at the token at every block, and removes an incomplete file. If the work has not ended a tenth of a
/// second later (set_grace), the process is ended all the same, so that without set_grace it outlives the
/// signal by half a second at most. It may then leave a temporary file, of which it was writing a block; as
/// after SIGKILL, SIGQUIT and all else that is not caught, the next OutputFile for the same target removes
/// it. A signal that the process was started to ignore, as by nohup or the shell's &, stays ignored.
///
/// A thread waits for the signals. If the system cannot start it, listens() is false, and a signal ends the
/// process at once, as without an Interrupt. Construct it before any other thread, so that all threads block
/// the signals.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Requests a stop after the given number of seconds, by SIGALRM, and prints the line; the process then
  /// ends with status 1. Call it once, before the work begins.
  void set_timeout(double seconds, const std::string& line);

  /// Gives the work so much time to end after a stop was requested. Call it before the work begins.
  void set_grace(std::chrono::milliseconds grace) { grace_ = grace; }

  /// Makes it an error (EPIPE) to write into a pipe that nobody reads, in place of a signal that ends the
  /// process. It stays so after the lifetime of the Interrupt.
  static void ignore_broken_pipes() { std::signal(SIGPIPE, SIG_IGN); }

  /// Returns true if the listener runs, so that signals request a stop.
  bool listens() const { return listener_.joinable(); }

  /// Tells whether the system has signals at all; WebAssembly has none, and its pages end their workers.
#if defined(__EMSCRIPTEN__)
  static constexpr bool has_signals = false;
#else
  static constexpr bool has_signals = true;
#endif

  protostar::StopToken token() const {
    return [this] { return came(); };
  }

  /// Returns true if a stop was requested.
  bool came() const { return signal_ != 0; }

  /// Returns the exit status of a stopped program: 128 plus the number of the signal, or 1 after the timeout.
  int status() const;

 private:
  void listen();

  sigset_t mask_before_;
  std::string timeout_line_;
  std::atomic<std::chrono::milliseconds> grace_ = std::chrono::milliseconds(100);
  std::atomic<int> signal_ = 0;
  std::atomic<bool> done_ = false;
  std::thread listener_;
};
