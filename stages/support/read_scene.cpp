#include <protostar/io/json_scene.hpp>

#include "any_surfaces.hpp"
#include "scene_pictures.hpp"

using namespace protostar;

SceneFile read_scene_file(const std::filesystem::path& path, const ReadOptions& options) {
  return read_scene(path, options);
}
