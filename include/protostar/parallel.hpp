// Loops whose iterations are shared by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include "function_ref.hpp"
#include "render_options.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Threads that are joined at the end, as std::jthread is, which libc++ 14 does not have.
class JoinedThreads {
 public:
  explicit JoinedThreads(int most) : threads_(new std::thread[static_cast<std::size_t>(most)]) {}
  JoinedThreads(const JoinedThreads&) = delete;
  JoinedThreads& operator=(const JoinedThreads&) = delete;
  ~JoinedThreads() {
    for (std::size_t i = 0; i < count_; ++i) threads_[i].join();
    delete[] threads_;
  }

  /// Starts a thread, at most `most` of them.
  void start(FunctionRef<void()> work) {
    threads_[count_] = std::thread(work);
    ++count_;
  }

 private:
  std::thread* threads_;
  std::size_t count_ = 0;  ///< of those that have started
};

/// Throws std::invalid_argument if the number of threads is negative.
inline void require_threads(const RenderOptions& options) {
  if (options.threads < 0)
    throw std::invalid_argument("RenderOptions: threads must be 0 (all cores) or more; it is " +
                                std::to_string(options.threads));
}

/// Whether a program can start threads: WebAssembly without shared memory cannot.
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
inline constexpr bool has_threads = false;
#else
inline constexpr bool has_threads = true;
#endif

/// Calls work(i) for every i in [0, count), by as many threads as the options say, with their progress and
/// stop. Threads take one i after the other, so that none waits for another. The first exception ends all of
/// them and is thrown in the caller's thread. If the options leave the number to the machine, the threads
/// that can be started share the work; if a number that was asked for cannot be started, std::system_error is
/// thrown. Without has_threads, the caller's thread does all work, whatever the options say.
[[gnu::cold]] inline void for_each_in_parallel(int count, const RenderOptions& options,
                                               FunctionRef<void(int)> work) {
  require_threads(options);
  const int thread_count = !has_threads          ? 1
                           : options.threads > 0 ? options.threads
                                                 : static_cast<int>(std::thread::hardware_concurrency());

  std::atomic<int> next = 0, done = 0;
  std::exception_ptr failure;
  std::atomic<bool> failed = false;
  const auto fail = [&](const std::exception_ptr& exception) {
    if (!failed.exchange(true)) failure = exception;
    next = count;
  };
  const auto run = [&](const auto& after_each) {
    try {
      for (int i = next++; i < count && !options.stop.stop_requested(); i = next++) {
        work(i);
        ++done;
        after_each();
      }
    } catch (...) {
      fail(std::current_exception());
    }
  };
  int reported = 0;
  const auto report = [&] {
    reported = done;
    if (options.progress) options.progress(static_cast<double>(reported) / count);
  };
  {
    const int most = std::min(thread_count, count);
    const auto help = [&] { run([] {}); };
    JoinedThreads helpers(std::max(0, most - 1));
    try {
      for (int i = 1; i < most; ++i) helpers.start(help);
    } catch (const std::system_error& error) {
      if (options.threads > 0)
        fail(std::make_exception_ptr(std::system_error(
            error.code(), "render: cannot start " + std::to_string(thread_count) + " threads; try 1 or 0")));
    } catch (...) {
      fail(std::current_exception());  // no memory: those that have started stop, too
    }
    run(report);
  }
  if (failure) std::rethrow_exception(failure);
  if (reported < done) report();  // a helper finished last
}

/// Returns options with the number of threads for so many small items, and nothing else: 1 below 8192, as
/// starting another thread takes longer than processing a few thousand.
[[nodiscard]] inline RenderOptions threads_for(std::size_t things, const RenderOptions& options) {
  return {.threads = things < 8192 ? 1 : options.threads};
}

/// Range of items in parts that do not depend on the number of threads that share them.
struct Parts {
  std::size_t first, last;

  static constexpr std::size_t size = 8192;  ///< items in a part; the last one may be smaller

  [[nodiscard]] int count() const { return static_cast<int>((last - first + size - 1) / size); }

  /// Calls work(part, first, last) for each part, by several threads.
  void each(const RenderOptions& options, const auto& work) const {
    for_each_in_parallel(count(), threads_for(last - first, options), [&](int part) {
      const std::size_t from = first + static_cast<std::size_t>(part) * size;
      work(static_cast<std::size_t>(part), from, std::min(from + size, last));
    });
  }
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
