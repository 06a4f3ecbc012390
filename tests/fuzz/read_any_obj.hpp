// What is fuzzed: any bytes are a mesh that rays can meet, or an error in words.
#pragma once

#include <protostar/io/obj.hpp>
#include <stdexcept>
#include <string>

/// Reads a text as an OBJ file. Ends the program if what it reads or says is not as it should be.
inline void read_any_obj(const std::string& text) {
  using namespace protostar;
  try {
    const Mesh mesh(mesh_from_obj(text, "mesh"), {.threads = 1});  // nothing that was read is refused later
    mesh.each_crossing({Point{0}, {1, 2, 3}}, {}, [&](const Crossing& crossing) {
      if (crossing.part < 0 || !is_finite(mesh.data().vertices.at(0))) __builtin_trap();
    });
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).size() > 1000) __builtin_trap();  // no message is as long as the file
  }
}
