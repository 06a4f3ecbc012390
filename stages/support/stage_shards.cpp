#include <memory>
#include <protostar/sampling/shard_file.hpp>
#include <protostar/shown.hpp>
#include <stdexcept>
#include <string>

#include "shared_render.hpp"
#include "stage.hpp"

using namespace protostar;

void Stage::begin_shared() {
  shared_ = std::make_shared<SharedRender>(options_.shard.value_or(ShardNumber{}), options_.checkpoint);
}

void Stage::share(StageRenderOptions& options) const {
  std::string scene = options_.scene + ", " + options_.integrator;
  if (options_.clamp > 0) scene += ", clamp " + shown(options_.clamp);
  for (const NumberOption& own : options_.numbers) scene += ", " + own.name + " " + shown(own.value);
  options.shared = shared_.get();
  options.picture = {.seed = options_.seed,
                     .filter = options_.filter,
                     .scene = scene,
                     .finish = {.exposure = options_.exposure,
                                .tone = options_.tone,
                                .transfer = options_.transfer,
                                .plain = options_.plain}};
}

std::string Stage::save_shared() const {
  if (!shared_->shard()) throw std::logic_error("a stage draws without rays, and has not declared so");
  if (!options_.shard) return {};
  save_shard(*shared_->shard(), options_.output);
  return std::to_string(shared_->shard()->units().count()) + " of " +
         std::to_string(shared_->shard()->picture().units()) + " units of ";
}

void Stage::keep_shared() const {
  if (shared_) shared_->keep();
}

void Stage::end_shared() {
  shared_->finish();
  shared_.reset();
}
