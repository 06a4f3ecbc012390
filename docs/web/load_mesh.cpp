// Reads the mesh of a stage in a browser without tinyobjloader, which needs the streams of the C++ library:
// they would be an eighth of the module.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <protostar/io/text.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "stages/support/mesh_pictures.hpp"

using namespace protostar;
using protostar::detail::number_of, protostar::detail::taken_word;

/// Reads a mesh as scenes/make_mesh writes a knot: lines `v X Y Z`, `vn X Y Z` and faces `f A//A B//B C//C`,
/// each vertex with the normal of its number; lines that begin with # are skipped. Throws std::runtime_error
/// for any other line.
static MeshData read_mesh(std::string_view text, const std::string& file) {
  MeshData mesh;
  while (!text.empty()) {
    const std::string_view whole = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(whole.size() + 1, text.size()));
    std::string_view line = whole;
    const std::string_view kind = taken_word(line);
    if (kind.empty() || kind.starts_with('#')) continue;
    const auto refuse = [&] {
      throw std::runtime_error(shown(file) + ": not a line of a vertex, a normal or a face: " + shown(whole));
    };
    if (kind == "v" || kind == "vn") {
      std::array<std::optional<double>, 3> numbers;
      for (auto& number : numbers) number = number_of<double>(taken_word(line));
      if (!numbers[0] || !numbers[1] || !numbers[2]) refuse();
      (kind == "v" ? mesh.vertices : mesh.normals).emplace_back(*numbers[0], *numbers[1], *numbers[2]);
    } else if (kind == "f") {
      std::vector<std::uint32_t> corners;
      for (std::string_view word = taken_word(line); !word.empty(); word = taken_word(line)) {
        const std::string number(word.substr(0, word.find('/')));
        if (word != number + "//" + number) refuse();
        corners.push_back(number_of<std::uint32_t>(number).value_or(0) -
                          1);  // Mesh refuses what is no vertex
      }
      if (corners.size() < 3) refuse();
      for (std::size_t i = 2; i < corners.size(); ++i)
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    } else {
      refuse();
    }
  }
  return mesh;
}

Mesh load_mesh(const std::filesystem::path& path, const std::function<Point(const Point&)>& place) {
  MeshData data = read_mesh(detail::text_of<std::runtime_error>(path, std::size_t{1} << 28), path.string());
  for (Point& vertex : data.vertices) vertex = place(vertex);
  return Mesh(data);
}
