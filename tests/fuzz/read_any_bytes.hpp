// What is fuzzed: any bytes are a scene or an error in words.
#pragma once

#include <optional>
#include <protostar/io/json_scene.hpp>
#include <string>

/// Reads a text as a scene file of a name, beside the images and meshes of its folder; nothing if it is
/// refused. Ends the program if what it reads or says is not as it should be.
inline std::optional<protostar::SceneFile> read_any_bytes(const std::string& text,
                                                          const std::string& name = PROTOSTAR_SOURCE_DIR
                                                          "/tests/fuzz/pool/scene") {
  try {
    protostar::SceneFile file =
        protostar::scene_from_json(text, name, {.confine = true, .most_pixels = 1 << 20, .threads = 1});
    file.camera.validate();  // nothing that was read is refused later
    return file;
  } catch (const protostar::SceneError& error) {
    // No message is as long as the file, nor gives orders to a terminal.
    if (std::string(error.what()).size() > 2000) __builtin_trap();
    if (protostar::shown(error.what()) != error.what()) __builtin_trap();
    return std::nullopt;
  }
}
