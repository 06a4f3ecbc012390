// Any bytes are a scene or an error in words: what libFuzzer calls with bytes of its own, and replay.cpp with
// the corpus.
#include <cstddef>
#include <cstdint>
#include <protostar/io/json_scene.hpp>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text(bytes, bytes + size);
  try {
    const protostar::SceneFile file = protostar::scene_from_json(text, "scene");
    file.camera.validate();  // nothing that was read is refused later
  } catch (const protostar::SceneError& error) {
    if (std::string(error.what()).size() > 1000) __builtin_trap();  // no message is as long as the file
  }
  return 0;
}
