// Runs `render` on scene files of the project, and on others that a test makes.
#pragma once

#include <filesystem>
#include <string>

#include "catch.hpp"
#include "files.hpp"
#include "run_stage.hpp"
#include "scenes_folder.hpp"

inline std::string scene_path(const std::string& name) { return (scenes_folder / (name + ".json")).string(); }

/// Returns the scene file of the three spheres with one text replaced.
inline std::string changed_three_spheres(const std::string& from, const std::string& to) {
  std::string text = bytes_of(scene_path("three_spheres"));
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

inline void copy_image(const std::string& name, const TemporaryFolder& folder) {
  std::filesystem::copy_file(std::filesystem::path(PROTOSTAR_SOURCE_DIR) / "tests" / name,
                             folder / std::filesystem::path(name).filename().string());
}

/// Returns a scene of a sphere with an image as its texture.
inline std::string scene_with_image(const std::string& name) {
  return R"({"settings": {"resolution-x": 16, "resolution-y": 12, "integrator": "color"},
      "camera": {"projection": "perspective", "position": [0, 0, -5], "direction": [0, 0, 1],
                 "upward": [0, 1, 0], "field-of-view": 40},
      "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 2}, "material-id": "m"}],
      "materials": {"m": {"diffuse": {"image": ")" +
         name + "\"}}}}";
}
