#include "shared_picture.hpp"

#include <cstdint>
#include <protostar/sampling/samplers.hpp>
#include <string>

#include "explanation.hpp"

using namespace protostar;

void render_shared(Image& image, const StageRenderOptions& options, const SamplerChoice& otherwise,
                   const std::function<void(Image&, const RenderOptions&)>& light,
                   const std::function<void(Film&, const SampleRange&, const RenderOptions&)>& add) {
  const Crop whole = options.crop.or_whole(image.width(), image.height());
  SharedPicture picture = options.picture;
  picture.width = whole.width, picture.height = whole.height;
  picture.area = {whole.x, whole.y, whole.x + image.width(), whole.y + image.height()};
  picture.samples = static_cast<std::uint32_t>(options.samples);
  picture.seed = options.seed;
  picture.sampler = name_of(options.sampler.is_made() ? options.sampler : otherwise);
  picture.cut();

  RenderOptions few = options;
  few.samples = 0, few.crop = {}, few.stop = {}, few.progress = {}, few.threads = 1;
  Image seen(32, 24);
  light(seen, few);
  picture.scene += ", light " + hexadecimal(word_of_light(seen));

  RenderOptions of_unit = options;
  of_unit.crop = {0, 0, whole.width, whole.height};
  of_unit.threads = 1, of_unit.progress = {};
  options.shared->draw(picture, options, [&](Film& film, const WorkUnit& unit) {
    add(film, SampleRange{unit.first_sample, unit.last_sample}, of_unit);
  });
  const Shard& shard = *options.shared->shard();
  if (!shard.missing()) image = shard.film().mean();
}
