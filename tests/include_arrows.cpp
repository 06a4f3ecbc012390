// Rules for what a header of the library includes (docs/architecture.md, "Rooms").
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
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

/// Headers that a program includes itself if it uses them: some surfaces, samplers and integrators, fields,
/// area lights and shards, with the headers that only they need.
const std::set<std::string> on_demand = {
    "exact/recorded.hpp",
    "march/field_lines.hpp",
    "march/step_rules.hpp",
    "surfaces/csg.hpp",
    "surfaces/instance.hpp",
    "surfaces/mesh_leaves.hpp",
    "accel/triangles_in_tile.hpp",
    "numeric/inner_point.hpp",
    "surfaces/mesh.hpp",
    "surfaces/mesh_data.hpp",
    "surfaces/mesh_tree.hpp",
    "surfaces/triangle.hpp",
    "numeric/quadric_equation.hpp",
    "surfaces/box.hpp",
    "surfaces/disk.hpp",
    "surfaces/quadric.hpp",
    "surfaces/torus.hpp",
    "accel/screen.hpp",
    "accel/triangles_on_screen.hpp",
    "accel/pixel_block.hpp",
    "sampling/independent_sampler.hpp",
    "sampling/stratified_sampler.hpp",
    "sampling/halton_sampler.hpp",
    "sampling/samplers.hpp",
    "sampling/finish.hpp",
    "sampling/word_file.hpp",
    "sampling/shard.hpp",
    "sampling/shard_file.hpp",
    "area_lights.hpp",
    "scene_identity.hpp",
    "path_vertex.hpp",
    "environment_image.hpp",
    "texture_image.hpp",
    "shared_image.hpp",
    "environment_light.hpp",
    "fields/field.hpp",
    "fields/operations.hpp",
    "fields/planar.hpp",
    "fields/shapes.hpp",
    "exact/distance_field.hpp",
    "exact/enclosure.hpp",
    "exact/field_point.hpp",
    "exact/functions.hpp",
    "exact/curvature.hpp",
    "exact/lipschitz.hpp",
    "exact/plain.hpp",
    "exact/polynomial_roots.hpp",
    "exact/rounding.hpp",
    "exact/slope.hpp",
    "heat_color.hpp",
    "integrators/ambient_occlusion.hpp",
    "integrators/distance_occlusion.hpp",
    "integrators/distance_shadow.hpp",
    "integrators/enclosure_width.hpp",
    "integrators/march_evaluations.hpp",
    "scene_fields.hpp",
    "surfaces/moving.hpp",
    "surfaces/distance_field.hpp",
    "surfaces/field_crossings.hpp",
    "surfaces/field_jumps.hpp",
    "surfaces/marched.hpp",
    "surfaces/plain_field.hpp",
    "march/enclosed_line.hpp",
    "march/field_bounds.hpp",
    "march/field_line.hpp",
    "march/field_roots.hpp",
    "march/hit_proof.hpp",
    "march/march.hpp",
    "march/march_steps.hpp",
    "integrators/direct.hpp",
    "light_at_hit.hpp",
    "integrators/path.hpp",
    "integrators/unoccluded.hpp",
    "irradiance.hpp",
    "lobes.hpp",
    "sampling/disk_view.hpp",
    "sampling/glossy_lobes.hpp",
    "sampling/light_sample.hpp",
    "sampling/mesh_light.hpp",
    "sampling/parallelogram_view.hpp",
    "sampling/rectangle_view.hpp",
    "sampling/shares.hpp",
    "sampling/solid_angle.hpp",
    "sampling/sphere_view.hpp",
    "sampling/triangle_view.hpp",
};

/// External headers of the core, besides the standard library: the smallest part of GLM that will do, and in
/// one header each the processor's instructions, large pages of the system, and its files.
const std::set<std::string> glm_headers = {"glm/vec2.hpp", "glm/vec3.hpp", "glm/geometric.hpp"};
const std::set<std::pair<std::string, std::string>> of_the_machine = {
    {"simd/vector_registers.hpp", "immintrin.h"},
    {"simd/vector_registers.hpp", "emmintrin.h"},
    {"simd/vector_registers.hpp", "wasm_simd128.h"},
    {"large_pages.hpp", "sys/mman.h"},
    {"system_file.hpp", "dirent.h"},
    {"system_file.hpp", "fcntl.h"},
    {"system_file.hpp", "poll.h"},
    {"system_file.hpp", "sys/file.h"},
    {"system_file.hpp", "sys/random.h"},
    {"system_file.hpp", "sys/stat.h"},
    {"system_file.hpp", "sys/xattr.h"},
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

/// Tests whether a name is that of a standard header: without folder and extension.
bool in_standard_library(const std::string& name) { return name.find_first_of("/.") == std::string::npos; }

/// Returns the folder of a header, which is empty for headers that are in none.
std::string room_of(const std::string& header) { return fs::path(header).parent_path().generic_string(); }

/// Headers outside of all rooms that know surfaces, and what is made of them.
const std::set<std::string> of_surfaces = {"surface_concepts.hpp", "surface.hpp", "intersection.hpp",
                                           "material.hpp",         "light.hpp",   "scene.hpp",
                                           "camera.hpp",           "render.hpp",  "own_intersect.hpp"};

/// Headers outside of all rooms that know scenes.
const std::set<std::string> of_scenes = {"scene.hpp", "any_scene.hpp", "scene_fields.hpp", "render.hpp"};

/// Includes of a room, as the table of docs/architecture.md has them.
struct Room {
  enum class Others { some, without_surfaces, without_scenes, all };

  std::set<std::string> rooms;         ///< whose headers may be included
  Others others = Others::some;        ///< headers in no room that may be
  std::set<std::string> headers = {};  ///< further ones; platform.hpp and vec3.hpp are allowed everywhere
};

const std::map<std::string, Room> rooms = {
    {"numeric",
     {{},
      Room::Others::some,
      {"interval.hpp", "bounds.hpp", "plain_vector.hpp", "bit_cast.hpp", "simd/opaque.hpp"}}},
    {"simd", {{}}},
    {"exact", {{"numeric", "simd"}, Room::Others::some, {"interval.hpp", "bounds.hpp"}}},
    {"sampling", {{"numeric", "simd"}, Room::Others::without_surfaces}},
    {"bvh", {{"simd"}, Room::Others::without_surfaces}},
    {"fields", {{"exact", "numeric"}, Room::Others::some, {"interval.hpp", "bounds.hpp", "magnitude.hpp"}}},
    {"march",
     {{"numeric", "exact", "simd"},
      Room::Others::some,
      {"transformed_ray.hpp", "interval.hpp", "bounds.hpp", "magnitude.hpp", "shown.hpp"}}},
    {"surfaces", {{"numeric", "march", "exact", "bvh", "simd", "accel"}, Room::Others::without_scenes}},
    {"integrators", {{"numeric", "sampling", "simd"}, Room::Others::all}}};

/// Tests whether a header may include another by the rooms of both.
bool may_include(const std::string& header, const std::string& name) {
  const auto room = rooms.find(room_of(header));
  const std::string other = room_of(name);
  if (room == rooms.end() || other == room->first) return true;
  if (name == "platform.hpp" || name == "vec3.hpp") return true;
  const Room& allowed = room->second;
  if (allowed.rooms.contains(other) || allowed.headers.contains(name)) return true;
  if (!other.empty()) return false;
  switch (allowed.others) {
    case Room::Others::some:
      return false;
    case Room::Others::without_surfaces:
      return !of_surfaces.contains(name);
    case Room::Others::without_scenes:
      return !of_scenes.contains(name);
    case Room::Others::all:
      return true;
  }
  return false;
}

bool in_core(const std::string& header) { return !header.starts_with("io/"); }

/// Returns a header that is included by way of itself, or an empty text if there is none.
std::string header_in_a_cycle(const Headers& headers) {
  enum class State { unseen, open, done };
  std::map<std::string, State> states;
  std::string found;
  const std::function<void(const std::string&)> visit = [&](const std::string& header) {
    State& state = states[header];
    if (state == State::open) found = header;
    if (state != State::unseen || !headers.contains(header)) return;
    state = State::open;
    for (const std::string& name : includes_of(header, headers.at(header)).own) visit(name);
    states[header] = State::done;
  };
  for (const auto& [header, text] : headers) visit(header);
  return found;
}

/// Returns everything that is wrong with the headers' includes, one line each.
std::vector<std::string> complaints(const Headers& headers) {
  std::vector<std::string> found;
  if (const std::string header = header_in_a_cycle(headers); !header.empty())
    found.push_back(header + " is included by way of itself");
  for (const auto& [header, text] : headers) {
    const auto complain = [&found, &of = header](const std::string& what) {
      found.push_back(of + " " + what);
    };
    const Includes includes = includes_of(header, text);
    for (const std::string& directive : includes.malformed) complain("is not to say " + directive);
    for (const std::string& name : includes.own) {
      if (!headers.contains(name)) complain("includes " + name + ", which is not a header of the library");
      if (name == "protostar.hpp") complain("includes " + name + ", which is for programs");
      if (in_core(header) && !in_core(name)) complain("includes " + name + ", which is not in the core");
      if (!may_include(header, name)) complain("includes " + name + ", which stands above its room");
      if (name.starts_with("accel/") && !header.starts_with("accel/") && header != "protostar.hpp" &&
          header != "surfaces/mesh.hpp")  // a mesh is rasterized into tiles
        complain("includes " + name + ", but that is left to protostar.hpp");
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
        std::find(includes.own.begin(), includes.own.end(), "scene.hpp") == includes.own.end() &&
        std::find(includes.own.begin(), includes.own.end(), "render.hpp") == includes.own.end())
      complain("includes neither scene.hpp, which an integrator queries, nor render.hpp");
  }
  return found;
}

}  // namespace

TEST_CASE("no header is included by way of itself, and each includes only what its folder may") {
  for (const std::string& complaint : complaints(headers_of_the_library())) FAIL_CHECK(complaint);
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
      GENERATE(Row{"ray.hpp", R"(#include "scene.hpp")"},                     // which includes it
               Row{"render.hpp", R"(#include "integrators/shadow.hpp")"},     // render takes any
               Row{"ppm.hpp", R"(#include "protostar.hpp")"},                 // for programs
               Row{"ppm.hpp", R"(#include "io/png.hpp")"},                    // not the core
               Row{"scene.hpp", R"(#include "../../stages/stage.hpp")"},      // not the library
               Row{"scene.hpp", R"(#include "light.h")"},                     // does not exist
               Row{"render.hpp", R"(#include "accel/render_tiles.hpp")"},     // only in protostar.hpp
               Row{"accel/candidates.hpp", "#include <immintrin.h>"},         // only in vector_registers.hpp
               Row{"sampling/sampler.hpp", R"(#include "../camera.hpp")"},    // above it
               Row{"numeric/roots.hpp", R"(#include "../ray.hpp")"},          // above it
               Row{"march/march.hpp", R"(#include "../surface.hpp")"},        // above it
               Row{"surfaces/disk.hpp", R"(#include "../scene.hpp")"},        // above it
               Row{"fields/shapes.hpp", R"(#include "../march/march.hpp")"},  // above it
               Row{"simd/simd.hpp", "#include <sys/mman.h>"},                 // only in large_pages.hpp
               Row{"output_file.hpp", "#include <fcntl.h>"},                  // only in system_file.hpp
               Row{"vec3.hpp", "#include <glm/glm.hpp>"},                     // compiles twice as long
               Row{"ppm.hpp", "#include <stb_image_write.h>"},                // another library
               Row{"vec3.hpp", "#  include <glm/ext.hpp>"},                   // not the usual form
               Row{"vec3.hpp", "#include </usr/include/glm/vec3.hpp>"},       // one machine's path
               Row{"vec3.hpp", R"(#include "/usr/include/glm/vec3.hpp")"});   // one machine's path
  Headers headers = headers_of_the_library();
  headers[row.header] += row.directive + "\n";
  INFO(row.header << ": " << row.directive);
  CHECK(!complaints(headers).empty());
}
