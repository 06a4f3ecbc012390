// What is fuzzed: any bytes are a scene or an error in words.
#pragma once

#include <protostar/io/json_scene.hpp>
#include <string>

/// Reads a text as a scene file. Ends the program if what it reads or says is not as it should be.
inline void read_any_bytes(const std::string& text) {
  try {
    const protostar::SceneFile file = protostar::scene_from_json(text, "scene");
    file.camera.validate();  // nothing that was read is refused later
  } catch (const protostar::SceneError& error) {
    if (std::string(error.what()).size() > 1000) __builtin_trap();  // no message is as long as the file
  }
}
