// Cases of a stress program, in chunks that several threads share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <protostar/parallel.hpp>

#include "options.hpp"
#include "support/random.hpp"

/// Number of cases of each kind, number of threads, and the seeds.
struct Work {
  std::uint64_t cases;
  int threads;
  Random seeds;

  /// Takes threads and seed from --threads and --seed, by default 1; all_cases is the number for all kinds
  /// together.
  Work(const Options& options, std::uint64_t all_cases, std::uint64_t kinds)
      : cases((all_cases + kinds - 1) / kinds),
        threads(static_cast<int>(options.number("--threads", 1))),
        seeds(options.number("--seed", 1)) {}

  /// Calls visit(random, count) for the cases of a kind in chunks, each with its own random numbers, so that
  /// nothing depends on the number of threads.
  void in_chunks(std::uint64_t size, const auto& visit) {
    const std::uint64_t seed = seeds.bits();
    const auto chunks = static_cast<int>((cases + size - 1) / size);
    protostar::detail::for_each_in_parallel(chunks, {.threads = threads}, [&](int chunk) {
      const auto i = static_cast<std::uint64_t>(chunk);
      Random random(seed + i);
      visit(random, std::min(size, cases - i * size));
    });
  }

  /// Returns the sum of judged(random, count) over all chunks.
  template <class Tally>
  Tally summed(std::uint64_t size, const auto& judged) {
    Tally sum;
    std::mutex adding;
    in_chunks(size, [&](Random& random, std::uint64_t count) {
      const Tally chunk = judged(random, count);
      const std::lock_guard lock(adding);
      sum.add(chunk);
    });
    return sum;
  }
};
