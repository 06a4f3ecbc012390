// A header includes only headers of lower layers of the library (docs/architecture.md), so that its reader
// needs to know nothing that comes after it.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"

namespace {

namespace fs = std::filesystem;

/// Headers by layers: each includes only headers of the lines above its own. A new header gets a place here,
/// and in the list of docs/architecture.md.
const std::vector<std::vector<std::string>> layers = {
    {"platform.hpp", "version.hpp"},
    {"bit_cast.hpp", "stop_token.hpp"},
    {"vec3.hpp", "interval.hpp", "render_options.hpp", "shown.hpp", "system_file.hpp",
     "accel/large_pages.hpp", "accel/simd.hpp"},
    {"bounds.hpp", "magnitude.hpp", "parallel.hpp", "numeric/double_double.hpp"},
    {"material.hpp", "ray.hpp", "numeric/exact_number.hpp", "numeric/roots.hpp", "numeric/scale.hpp"},
    {"numeric/rounded_number.hpp", "numeric/exact_root.hpp", "numeric/power.hpp", "numeric/vector_of.hpp",
     "accel/box_space.hpp"},
    {"intersection.hpp", "numeric/equation.hpp", "numeric/plane_through.hpp", "numeric/trigonometry.hpp",
     "accel/bvh_build.hpp"},
    {"light.hpp", "numeric/affine.hpp", "numeric/box_roots.hpp", "numeric/disk_roots.hpp",
     "numeric/inner_point.hpp", "numeric/parallelogram_roots.hpp", "numeric/plane_roots.hpp",
     "numeric/quadric_roots.hpp", "numeric/sphere_roots.hpp", "numeric/triangle_roots.hpp"},
    {"numeric/quadric_bounds.hpp", "surface.hpp", "surfaces/coordinates.hpp", "transformed_ray.hpp"},
    {"surface_requirements.hpp"},
    {"closest_hit.hpp", "surfaces/any_surface.hpp", "surfaces/box.hpp", "surfaces/disk.hpp",
     "surfaces/parallelogram.hpp", "surfaces/plane.hpp", "surfaces/quadric.hpp", "surfaces/sphere.hpp",
     "surfaces/triangle.hpp", "accel/bvh.hpp"},
    {"scene.hpp", "surfaces/csg.hpp", "surfaces/instance.hpp", "accel/in_turns.hpp",
     "accel/sphere_around.hpp"},
    {"camera.hpp", "image.hpp", "accel/packet.hpp", "integrators/binary.hpp", "integrators/color.hpp",
     "integrators/depth.hpp", "integrators/diffuse.hpp", "integrators/normal.hpp", "integrators/shadow.hpp",
     "integrators/transparency.hpp", "integrators/whitted.hpp"},
    {"pixels.hpp", "accel/sphere_leaves.hpp", "accel/triangle_leaves.hpp"},
    {"integrator.hpp", "tone.hpp", "accel/accelerate.hpp", "accel/occluders.hpp", "accel/tile.hpp",
     "accel/triangle_tree.hpp"},
    {"accel/drawn.hpp", "accel/screen.hpp"},
    {"accel/tile_scene.hpp", "accel/pixel_block.hpp"},
    {"accel/render_tiles.hpp", "accel/triangles_in_front.hpp", "accel/triangles_on_screen.hpp"},
    {"render.hpp", "encode.hpp", "output_file.hpp", "accel/coverage.hpp"},
    {"accel/triangles_in_tile.hpp", "pfm.hpp", "ppm.hpp", "io/image_file.hpp", "io/read_options.hpp",
     "io/scene_file.hpp", "io/stb_image_write.hpp", "io/text.hpp"},
    {"surfaces/mesh.hpp", "io/json_tree.hpp", "io/check_jpeg.hpp", "io/check_png.hpp", "io/read_hdr.hpp"},
    {"io/image_texture.hpp", "io/json_cursor.hpp", "io/obj.hpp"},
    // None of these includes another, and nothing in the core includes any of io/.
    {"protostar.hpp", "io/hdr.hpp", "io/json_scene.hpp", "io/png.hpp"},
};

/// Headers that a program includes itself if it uses them: some surfaces, with the headers that only they
/// need.
const std::set<std::string> on_demand = {
    "surfaces/csg.hpp",
    "surfaces/instance.hpp",
    "accel/triangle_leaves.hpp",
    "accel/triangle_tree.hpp",
    "accel/triangles_in_tile.hpp",
    "numeric/inner_point.hpp",
    "numeric/triangle_roots.hpp",
    "surfaces/mesh.hpp",
    "surfaces/triangle.hpp",
    "numeric/box_roots.hpp",
    "numeric/disk_roots.hpp",
    "numeric/quadric_roots.hpp",
    "surfaces/box.hpp",
    "numeric/quadric_bounds.hpp",
    "surfaces/disk.hpp",
    "surfaces/quadric.hpp",
    "accel/in_turns.hpp",
    "accel/screen.hpp",
    "accel/coverage.hpp",
    "accel/triangles_on_screen.hpp",
    "accel/pixel_block.hpp",
    "accel/triangles_in_front.hpp",
};

/// External headers of the core, besides the standard library: the smallest part of GLM that will do, and in
/// one header each the processor's instructions, large pages of the system, and its files.
const std::set<std::string> glm_headers = {"glm/vec2.hpp", "glm/vec3.hpp", "glm/geometric.hpp"};
const std::set<std::pair<std::string, std::string>> of_the_machine = {
    {"accel/simd.hpp", "immintrin.h"}, {"accel/large_pages.hpp", "sys/mman.h"},
    {"system_file.hpp", "dirent.h"},   {"system_file.hpp", "fcntl.h"},
    {"system_file.hpp", "poll.h"},     {"system_file.hpp", "sys/file.h"},
    {"system_file.hpp", "sys/stat.h"}, {"system_file.hpp", "sys/xattr.h"},
    {"system_file.hpp", "unistd.h"}};

/// The texts of headers by their paths inside include/protostar.
using Headers = std::map<std::string, std::string>;

Headers headers_of_the_library() {
  Headers headers;
  const fs::path root = fs::path(PROTOSTAR_SOURCE_DIR) / "include" / "protostar";
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path());
    headers[entry.path().lexically_relative(root).generic_string()] =
        std::string(std::istreambuf_iterator<char>(file), {});
  }
  return headers;
}

/// Includes of a header: names in quotes as paths inside include/protostar, others as they are.
struct Includes {
  std::vector<std::string> own, other, malformed;
};

Includes includes_of(const std::string& header, const std::string& text) {
  Includes includes;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t hash = line.find_first_not_of(" \t");
    if (hash == std::string::npos || line[hash] != '#') continue;
    const std::size_t word = line.find_first_not_of(" \t", hash + 1);
    if (word == std::string::npos || line.compare(word, 7, "include") != 0) continue;

    const bool quoted = line.starts_with("#include \""), angled = line.starts_with("#include <");
    const std::size_t start = std::string("#include <").size();
    const std::size_t end = quoted || angled ? line.find(quoted ? '"' : '>', start) : std::string::npos;
    if (end == std::string::npos || line[start] == '/') {
      includes.malformed.push_back(line);
      continue;
    }
    const std::string name = line.substr(start, end - start);
    if (quoted)
      includes.own.push_back((fs::path(header).parent_path() / name).lexically_normal().generic_string());
    else
      includes.other.push_back(name);
  }
  return includes;
}

/// Returns the index of the header's layer, or the number of layers if it has none.
std::size_t layer_of(const std::string& header) {
  const auto layer = std::find_if(layers.begin(), layers.end(), [&](const auto& names) {
    return std::find(names.begin(), names.end(), header) != names.end();
  });
  return static_cast<std::size_t>(layer - layers.begin());
}

/// Tests whether a name is that of a standard header: without folder and extension.
bool in_standard_library(const std::string& name) { return name.find_first_of("/.") == std::string::npos; }

/// Returns the list in docs/architecture.md in the form of `layers`: all names in backquotes in its numbered
/// lines, and for a folder its headers that no line names.
std::vector<std::set<std::string>> layers_of_the_page(const Headers& headers) {
  std::istringstream page(bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "architecture.md"));
  std::string line;
  while (std::getline(page, line) && line != "## Layers") continue;
  std::vector<std::set<std::string>> found;
  std::set<std::string> named;
  while (std::getline(page, line) && !line.starts_with("## ")) {
    if (!line.starts_with(std::to_string(found.size() + 1) + ". `")) continue;
    std::istringstream pieces(line);
    found.emplace_back();
    for (std::string prose, name; std::getline(pieces, prose, '`') && std::getline(pieces, name, '`');)
      named.insert(*found.back().insert(name.ends_with('/') ? name : name + ".hpp").first);
  }
  for (auto& layer : found)
    for (const std::set<std::string> names = layer; const std::string& name : names) {
      if (!name.ends_with('/')) continue;
      layer.erase(name);
      for (const auto& [header, text] : headers)
        if (header.starts_with(name) && !named.contains(header)) layer.insert(header);
    }
  return found;
}

bool in_core(const std::string& header) { return !header.starts_with("io/"); }

/// Returns everything that is wrong with the headers' includes, one line each.
std::vector<std::string> complaints(const Headers& headers) {
  std::vector<std::string> found;
  for (const auto& [header, text] : headers) {
    const auto complain = [&found, &header = header](const std::string& what) {
      found.push_back(header + " " + what);
    };
    if (layer_of(header) == layers.size()) complain("has no place in the layers");
    const Includes includes = includes_of(header, text);
    for (const std::string& directive : includes.malformed) complain("is not to say " + directive);
    for (const std::string& name : includes.own) {
      if (!headers.contains(name))
        complain("includes " + name + ", which is not a header of the library");
      else if (layer_of(name) >= layer_of(header))
        complain("includes " + name + ", which is not below it");
      if (name.starts_with("accel/") && !header.starts_with("accel/") && header != "render.hpp" &&
          header != "surfaces/mesh.hpp")  // a mesh has its own tree
        complain("includes " + name + ", but that is left to render.hpp");
      if (header == "render.hpp" && name.starts_with("integrators/"))
        complain("includes " + name + ", but render takes any integrator");
    }
    for (const std::string& name : includes.other) {
      if (name.starts_with("protostar/"))
        complain("is to include " + name + " by its relative path");
      else if (of_the_machine.contains({header, name}))
        continue;
      else if (in_core(header) && !glm_headers.contains(name) && !in_standard_library(name))
        complain("includes " + name + ", but the core needs GLM and nothing else");
    }
    if (header.starts_with("integrators/") &&
        std::find(includes.own.begin(), includes.own.end(), "scene.hpp") == includes.own.end())
      complain("does not include scene.hpp, whose questions an integrator asks");
  }
  return found;
}

}  // namespace

TEST_CASE("a header includes only headers of lower layers") {
  for (const std::string& complaint : complaints(headers_of_the_library())) FAIL_CHECK(complaint);
}

TEST_CASE("every header in the table of layers exists") {
  const Headers headers = headers_of_the_library();
  for (const auto& layer : layers)
    for (const std::string& header : layer) {
      INFO(header);
      CHECK(headers.contains(header));
    }
}

TEST_CASE("the table of layers agrees with docs/architecture.md") {
  const auto page = layers_of_the_page(headers_of_the_library());
  REQUIRE(page.size() == layers.size());
  for (std::size_t i = 0; i < layers.size(); ++i) {
    INFO("layer " << i + 1 << ", on the page and here");
    CHECK(page[i] == std::set<std::string>(layers[i].begin(), layers[i].end()));
  }
}

TEST_CASE("protostar.hpp includes the whole core except surfaces on demand, and nothing else") {
  Headers headers = headers_of_the_library();
  std::set<std::string> reached;
  std::vector<std::string> next = {"protostar.hpp"};
  while (!next.empty()) {
    const std::string header = next.back();
    next.pop_back();
    if (!reached.insert(header).second) continue;
    for (const std::string& name : includes_of(header, headers[header]).own) next.push_back(name);
  }
  for (const auto& [header, text] : headers) {
    INFO(header);
    CHECK(reached.contains(header) == (in_core(header) && !on_demand.contains(header)));
  }
}

TEST_CASE("an include that breaks a rule is found") {
  struct Row {
    std::string header, directive;
  };
  const auto row =
      GENERATE(Row{"ray.hpp", R"(#include "scene.hpp")"},                    // a layer above
               Row{"vec3.hpp", R"(#include "interval.hpp")"},                // its own layer
               Row{"render.hpp", R"(#include "integrators/shadow.hpp")"},    // render takes any
               Row{"ppm.hpp", R"(#include "protostar.hpp")"},                // everything
               Row{"ppm.hpp", R"(#include "io/png.hpp")"},                   // not the core
               Row{"surfaces/torus.hpp", R"(#include "../surface.hpp")"},    // has no layer
               Row{"scene.hpp", R"(#include "../../stages/stage.hpp")"},     // not the library
               Row{"scene.hpp", R"(#include "light.h")"},                    // does not exist
               Row{"protostar.hpp", R"(#include "accel/bvh.hpp")"},          // only in render.hpp
               Row{"accel/tile.hpp", "#include <immintrin.h>"},              // only in simd.hpp
               Row{"accel/simd.hpp", "#include <sys/mman.h>"},               // only in large_pages.hpp
               Row{"output_file.hpp", "#include <fcntl.h>"},                 // only in system_file.hpp
               Row{"vec3.hpp", "#include <glm/glm.hpp>"},                    // compiles twice as long
               Row{"ppm.hpp", "#include <stb_image_write.h>"},               // another library
               Row{"vec3.hpp", "#  include <glm/ext.hpp>"},                  // not the usual form
               Row{"vec3.hpp", "#include </usr/include/glm/vec3.hpp>"},      // one machine's path
               Row{"vec3.hpp", R"(#include "/usr/include/glm/vec3.hpp")"});  // one machine's path
  Headers headers = headers_of_the_library();
  headers[row.header] += row.directive + "\n";
  INFO(row.header << ": " << row.directive);
  CHECK(complaints(headers).size() == 1);
}
