// Entry point and mutator for libFuzzer; tests/json_scene_errors.cpp reads the corpus, and
// tests/long/hostile.cpp draws scenes that are mutated in the same way.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

#include "draw_any_scene.hpp"
#include "hostile_numbers.hpp"
#include "read_any_bytes.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t max_size);

/// Mutates a scene: one mutation in four is libFuzzer's; the others replace numbers by hostile ones, since
/// random bytes seldom leave a scene valid.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  if (seed % 4 != 0) {
    const int count = 1 + static_cast<int>(seed / 4 % 3);
    const std::string text = with_hostile_numbers(std::string(bytes, bytes + size), seed, count);
    if (text.size() <= max_size) {
      std::copy(text.begin(), text.end(), bytes);
      return text.size();
    }
  }
  return LLVMFuzzerMutate(bytes, size, max_size);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  // Images and meshes are read from the folder of the scenes that the fuzzer starts from.
  auto file =
      read_any_bytes(std::string(bytes, bytes + size), PROTOSTAR_SOURCE_DIR "/tests/hostile/scene.json");
  if (!file) return 0;
  const std::string own = file->integrator;
  const std::string faults = faults_of_pictures(*file, {own, "depth", "normal", "transparency", "whitted"});
  if (faults.empty()) return 0;
  std::fputs(faults.c_str(), stderr);
  __builtin_trap();
}
