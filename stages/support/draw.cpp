#include <protostar/io/json_scene.hpp>

#include "any_surfaces.hpp"
#include "scene_pictures.hpp"

using namespace protostar;

SceneFile read_scene_file(const std::filesystem::path& path) { return read_scene(path); }

void draw(Image& image, const SceneFile& file, const std::string& integrator, const RenderOptions& options) {
  if (integrator == "binary") return draw_binary(image, file, options);
  if (integrator == "transparency") return draw_transparency(image, file, options);
  if (integrator == "whitted") return draw_whitted(image, file, options);
  draw_first_hits(image, file, integrator, options);
}
