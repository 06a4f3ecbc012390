// Stands for the shards of the stages in modules, whose pictures a page shares by bands (--crop) instead.
#include <stdexcept>

#include "stages/support/shard_number.hpp"
#include "stages/support/shared_render.hpp"
#include "stages/support/stage.hpp"

ShardNumber read_shard_number(std::string_view) {
  throw std::invalid_argument("is for the native programs; --crop shares a picture in a browser");
}

void Stage::begin_shared() {
  throw std::runtime_error("--checkpoint is for the native programs; --crop shares a picture in a browser");
}

// No picture is shared, so these have nothing to do.

void Stage::share(StageRenderOptions&) const {}

std::string Stage::save_shared() const { return {}; }

void Stage::keep_shared() const {}

void Stage::end_shared() {}

std::string fingerprint_of(const std::vector<std::filesystem::path>&) { return {}; }
