#include "interrupt.hpp"

#include <pthread.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <system_error>

namespace {

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGHUP);
  sigaddset(&signals, SIGALRM);
  return signals;
}

bool is_ignored(int signal) {
  struct sigaction action;
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

// All threads inherit the blocked signals, which therefore wait for the listener, an ordinary thread that may
// do what a signal handler may not.
Interrupt::Interrupt() {
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, &mask_before_);
  try {
    listener_ = std::thread([this] { listen(); });
  } catch (const std::system_error&) {
    pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
  }
}

Interrupt::~Interrupt() {
  const itimerval none{};
  setitimer(ITIMER_REAL, &none, nullptr);
  if (!listens()) return;
  done_ = true;
  pthread_kill(listener_.native_handle(), SIGTERM);  // wakes the listener, which then sees that it is done
  listener_.join();
  pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
}

void Interrupt::set_timeout(double seconds, const std::string& line) {
  timeout_line_ = line;
  const double whole = std::floor(seconds);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(whole);
  // At least one microsecond, since 0 would disable the timer.
  timer.it_value.tv_usec = std::max(static_cast<suseconds_t>((seconds - whole) * 1e6), suseconds_t{1});
  setitimer(ITIMER_REAL, &timer, nullptr);
}

int Interrupt::status() const { return signal_ == SIGALRM ? 1 : 128 + signal_; }

void Interrupt::listen() {
  using namespace std::chrono_literals;
  const sigset_t signals = stop_signals();
  int signal = 0;
  do
    if (sigwait(&signals, &signal) != 0 || done_) return;
  while (is_ignored(signal));
  signal_ = signal;
  if (signal == SIGALRM) std::fputs(timeout_line_.c_str(), stderr);
  const auto deadline = std::chrono::steady_clock::now() + grace_.load();
  while (std::chrono::steady_clock::now() < deadline) {
    if (done_) return;
    std::this_thread::sleep_for(5ms);
  }
  std::_Exit(status());
}
