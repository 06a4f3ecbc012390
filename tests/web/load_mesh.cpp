// The reader of meshes in a browser, docs/web/load_mesh.cpp: knots are those of the library's reader.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <protostar/io/obj.hpp>
#include <stdexcept>
#include <string>

#include "stages/support/mesh_pictures.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"

using namespace protostar;

TEST_CASE("in a browser, a knot has the triangles and normals that load_obj reads") {
  const std::filesystem::path knot = std::filesystem::path(PROTOSTAR_SOURCE_DIR) / "scenes" / "knot.obj";
  const Mesh mesh = load_mesh(knot, [](const Point& vertex) { return vertex; });
  const MeshData &data = mesh.data(), expected = load_obj(knot);
  REQUIRE(data.triangles.size() == 3600);
  REQUIRE(expected.triangles.size() == 3600);
  int different = 0;  // the readers number vertices differently
  for (std::size_t i = 0; i < 3600; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t one = data.triangles[i][k], other = expected.triangles[i][k];
      different +=
          data.vertices[one] != expected.vertices[other] || data.normals[one] != expected.normals[other];
    }
  CHECK(different == 0);
}

TEST_CASE("in a browser, a line of a mesh that is not of a knot is refused with its file") {
  const TemporaryFolder folder;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n";
  for (const char* const line :
       {"v 1 2", "v 1 2 x", "f 1//1 2//2", "f 1//2 2//2 3//3", "f 1/1/1 2/2/2 3/3/3", "s 1"}) {
    put_bytes(folder / "mesh.obj", corners + line + "\n");
    CHECK_THAT(message_of<std::runtime_error>(
                   [&] { load_mesh(folder / "mesh.obj", [](const Point& vertex) { return vertex; }); }),
               ContainsSubstring("mesh.obj") && ContainsSubstring(line));
  }
}
