// Draws a scene file (docs/scene-format.md).
#include <filesystem>
#include <vector>

#include "support/scene_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  SceneFile file;
  const auto read = [&file](const std::filesystem::path& path, const ReadOptions& options) {
    file = read_scene_file(path, options);
    std::vector<std::filesystem::path> files{path};
    files.insert(files.end(), file.files.begin(), file.files.end());
    return StageDefaults{.integrator = file.integrator,
                         .width = file.width,
                         .height = file.height,
                         .transfer = file.transfer,
                         .tone = file.tone,
                         .exposure = file.exposure,
                         .samples = file.samples,
                         .error = file.error,
                         .sampler = file.sampler,
                         .filter = file.filter,
                         .seed = file.seed,
                         .files = files};
  };

  return run_stage(argc, argv, {.read_scene = read}, [&file](Stage& stage) {
    Image image = stage.image();
    draw(image, file, stage.integrator(), stage.render_options());
    expose(image, file.exposure);
    stage.save(image);
  });
}
