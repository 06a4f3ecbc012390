#include "shard_number.hpp"

#include <cstddef>
#include <cstdlib>
#include <optional>
#include <protostar/io/text.hpp>
#include <stdexcept>

#include "message.hpp"

using protostar::detail::number_of;

namespace {

/// Throws a usage error: what was found, and what is allowed.
[[noreturn]] void refuse_shard(const std::string& found, const std::string& allowed) {
  throw std::invalid_argument(found + "; allowed is " + allowed);
}

/// Returns the number in a variable of the environment, of which `least` is the least.
std::uint64_t variable(const char* name, std::string_view word, std::uint64_t least) {
  const std::string allowed =
      "a whole number of at least " + std::to_string(least) + ", as " +
      (word == "slurm" ? "Slurm sets it for each task of an array (sbatch --array=0-99)"
                       : "Open MPI's mpirun sets it for each process");
  const char* const text = std::getenv(name);
  if (text == nullptr)
    refuse_shard("'" + std::string(word) + "' asks for " + name + ", which is not set", allowed);
  const auto value = number_of<std::uint64_t>(text);
  if (!value || *value < least)
    refuse_shard(std::string(name) + " is '" + shortened(text, 100) + "'", allowed);
  return *value;
}

}  // namespace

ShardNumber read_shard_number(std::string_view text) {
  ShardNumber shard;
  std::string found, allowed;
  if (text == "slurm") {
    const std::uint64_t id = variable("SLURM_ARRAY_TASK_ID", text, 0),
                        first = variable("SLURM_ARRAY_TASK_MIN", text, 0);
    shard.count = variable("SLURM_ARRAY_TASK_COUNT", text, 1);
    if (std::getenv("SLURM_ARRAY_TASK_MAX") != nullptr)
      if (const std::uint64_t last = variable("SLURM_ARRAY_TASK_MAX", text, 0);
          last - first != shard.count - 1)
        refuse_shard("SLURM_ARRAY_TASK_COUNT is " + std::to_string(shard.count) +
                         " for the tasks from SLURM_ARRAY_TASK_MIN = " + std::to_string(first) +
                         " to SLURM_ARRAY_TASK_MAX = " + std::to_string(last),
                     "an array without gaps and steps");
    found = "SLURM_ARRAY_TASK_ID is " + std::to_string(id);
    allowed = "one of the SLURM_ARRAY_TASK_COUNT = " + std::to_string(shard.count) +
              " numbers from SLURM_ARRAY_TASK_MIN = " + std::to_string(first) + " on";
    if (id < first) refuse_shard(found, allowed);
    shard.index = id - first;
  } else if (text == "mpi") {
    shard = {variable("OMPI_COMM_WORLD_RANK", text, 0), variable("OMPI_COMM_WORLD_SIZE", text, 1)};
    found = "OMPI_COMM_WORLD_RANK is " + std::to_string(shard.index);
    allowed = "a number below OMPI_COMM_WORLD_SIZE = " + std::to_string(shard.count);
  } else {
    const std::size_t slash = text.find('/');
    const auto index = number_of<std::uint64_t>(text.substr(0, slash));
    const auto count =
        number_of<std::uint64_t>(slash == std::string_view::npos ? "" : text.substr(slash + 1));
    found = "'" + shortened(std::string(text), 100) + "'";
    if (!index || !count || *index >= *count)
      throw std::invalid_argument(found +
                                  " is not I/N, whole numbers with I from 0 to N - 1, nor slurm or mpi");
    shard = {*index, *count};
  }
  if (shard.index >= shard.count) refuse_shard(found, allowed);
  return shard;
}
