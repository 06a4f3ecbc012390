// Fuzzing of the scene reader: any bytes give a scene or an error message.
#pragma once

#include <optional>
#include <protostar/io/json_scene.hpp>
#include <string>

/// Reads a text as the scene file of a name, with the images and meshes of its folder; returns nothing if it
/// is refused. Ends the program if the scene or the message is not as it should be.
inline std::optional<protostar::SceneFile> read_any_bytes(const std::string& text,
                                                          const std::string& name = PROTOSTAR_SOURCE_DIR
                                                          "/tests/fuzz/pool/scene") {
  try {
    protostar::SceneFile file =
        protostar::scene_from_json(text, name, {.confine = true, .most_pixels = 1 << 20, .threads = 1});
    file.camera.validate();  // a scene that was read is not refused later
    return file;
  } catch (const protostar::SceneError& error) {
    // A message is shorter than long files, and contains no commands to a terminal.
    if (std::string(error.what()).size() > 2000) __builtin_trap();
    if (protostar::shown(error.what()) != error.what()) __builtin_trap();
    return std::nullopt;
  }
}
