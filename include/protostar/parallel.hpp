// Loops whose iterations are shared by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <future>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "render_options.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Throws std::invalid_argument if the number of threads is negative.
inline void require_threads(const RenderOptions& options) {
  if (options.threads < 0)
    throw std::invalid_argument("RenderOptions: threads must be 0 (all cores) or more; it is " +
                                std::to_string(options.threads));
}

/// Calls work(i) for every i in [0, count), by as many threads as the options say, with their progress and
/// stop. Threads take one i after the other, so that none waits for another. An exception ends all of them
/// and is thrown in the caller's thread; if several threads throw, one of theirs is. If the options leave the
/// number to the machine, the threads that can be started share the work; if a number that was asked for
/// cannot be started, std::system_error is thrown.
inline void for_each_in_parallel(int count, const RenderOptions& options,
                                 const std::function<void(int)>& work) {
  require_threads(options);
  const int thread_count =
      options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());

  std::atomic<int> next = 0, done = 0;
  const auto run = [&](const auto& after_each) {
    try {
      for (int i = next++; i < count && !options.stop.stop_requested(); i = next++) {
        work(i);
        ++done;
        after_each();
      }
    } catch (...) {
      next = count;
      throw;
    }
  };
  int reported = 0;
  const auto report = [&] {
    reported = done;
    if (options.progress) options.progress(static_cast<double>(reported) / count);
  };
  std::vector<std::future<void>> helpers;  // waited for at the end, also after an exception
  try {
    for (int i = 1; i < std::min(thread_count, count); ++i)
      helpers.push_back(std::async(std::launch::async, [&] { run([] {}); }));
  } catch (const std::system_error& error) {
    if (options.threads > 0) {
      next = count;
      throw std::system_error(
          error.code(), "render: cannot start " + std::to_string(thread_count) + " threads; try 1 or 0");
    }
  }
  run(report);
  for (std::future<void>& helper : helpers) helper.get();
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
