// Which part of a picture's work a run draws.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Number of a shard, below the number of shards.
struct ShardNumber {
  std::uint64_t index = 0, count = 1;
};

/// Returns the shard that an option names: I/N, or the word slurm or mpi for what these programs tell each
/// process of a job in its environment, which is read for these words only. Throws std::invalid_argument for
/// any other text, and for variables that are missing or wrong; it names what was found and what is allowed.
ShardNumber read_shard_number(std::string_view text);
