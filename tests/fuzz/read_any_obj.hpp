// Fuzzing of the OBJ reader: any bytes give a mesh that rays can hit, or an error message.
#pragma once

#include <protostar/io/obj.hpp>
#include <stdexcept>
#include <string>

/// Reads a text as an OBJ file. Ends the program if the mesh or the message is not as it should be.
inline void read_any_obj(const std::string& text) {
  using namespace protostar;
  try {
    const Mesh mesh(mesh_from_obj(text, "mesh"), {.threads = 1});  // a mesh that was read is not refused
    mesh.each_crossing({Point{0}, {1, 2, 3}}, {}, [&](const Crossing& crossing) {
      if (crossing.primitive < 0 || !is_finite(mesh.data().vertices.at(0))) __builtin_trap();
    });
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).size() > 1000) __builtin_trap();  // a message is shorter than long files
  }
}
