// Makes a picture of its .shard files (docs/many_machines.md).
#include <optional>
#include <protostar/sampling/shard_file.hpp>
#include <string>
#include <vector>

#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  std::optional<Film> film;
  Finish finish;

  const auto read = [&](const std::string& program, int& status) -> std::optional<Options> {
    const auto merge = parse_merge_options(argc, argv, program, status);
    if (!merge) return std::nullopt;
    const Shard shard = merge_shards({merge->shards.begin(), merge->shards.end()});
    film = shard.film(merge->shards.size());
    finish = shard.picture().finish;

    Options options = merge->options;
    options.width = shard.picture().area.width();
    options.height = shard.picture().area.height();
    options.integrator =
        "of " + std::to_string(merge->shards.size()) + (merge->shards.size() == 1 ? " file" : " files");
    options.transfer = merge->own_transfer.value_or(finish.transfer);
    options.tone = finish.tone;
    options.plain = options.plain || finish.plain;
    return options;
  };

  return run_program(argc, argv, read, [&](Stage& stage) {
    Image image = stage.image();
    image = film->mean();
    expose(image, finish.exposure);
    stage.save(image);
  });
}
