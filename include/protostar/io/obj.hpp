// Reads meshes from Wavefront OBJ files, through tinyobjloader. Not part of the core: link protostar::obj.
#pragma once

#if defined(TINY_OBJ_LOADER_H_)
#error "include protostar/io/obj.hpp before tiny_obj_loader.h: it needs a copy of its own, in double"
#endif

// Includes the headers of tiny_obj_loader.h first, so that it does not include them inside a namespace.
#include <array>
#include <cassert>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "../magnitude.hpp"
#include "../surfaces/mesh.hpp"
#include "text.hpp"

// Compiled in a namespace of this translation unit, where it does not conflict with another copy of
// tinyobjloader.
#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
namespace protostar::inline PROTOSTAR_ABI::detail {
namespace {
#include <tiny_obj_loader.h>
}  // namespace
}  // namespace protostar::inline PROTOSTAR_ABI::detail
#undef TINYOBJLOADER_IMPLEMENTATION
#undef TINYOBJLOADER_USE_DOUBLE
#undef TINY_OBJ_LOADER_H_
#undef IS_DIGIT
#undef IS_NEW_LINE
#undef IS_SPACE

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Builder of a mesh from what tinyobjloader finds in a file; refuses errors that it lets pass.
///
/// tinyobjloader takes words that are no numbers for 0, some numbers for others that are near, and reads an
/// index across a blank; therefore all numbers are read again, from the current line. A corner of a face has
/// a position, and may have texture coordinates and a normal; each combination that occurs becomes a vertex.
class ObjBuilder : private std::streambuf {
 public:
  /// Skips a byte order mark, with which some editors begin a text in UTF-8.
  ObjBuilder(std::string_view text, std::string file)
      : rest_(text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0)), file_(std::move(file)) {}

  [[nodiscard]] MeshData build() {
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* self, double, double, double, double) { of(self).add(position); };
    callbacks.texcoord_cb = [](void* self, double, double, double) { of(self).add(texture); };
    callbacks.normal_cb = [](void* self, double, double, double) { of(self).add(normal); };
    callbacks.index_cb = [](void* self, tinyobj::index_t*, int) { of(self).add_face(); };
    std::istream stream(this);
    stream.exceptions(std::ios::badbit);  // else memory that runs out would be taken for the end of the file
    tinyobj::LoadObjWithCallback(stream, callbacks, this);
    if (data_.triangles.empty()) throw std::runtime_error(shown(file_) + ": there is no face");
    return take();
  }

 private:
  static constexpr int none = -1, most_index = 999'999'999;

  /// Parts of a vertex, in the order of a corner.
  enum Kind : std::size_t { position, texture, normal };
  static constexpr std::array<const char*, 3> names{"vertex", "texture vertex", "normal"};

  /// Vertex: indices of its position, texture coordinates and normal.
  using Vertex = std::array<int, 3>;

  static ObjBuilder& of(void* self) { return *static_cast<ObjBuilder*>(self); }

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(shown(file_ + ": line " + std::to_string(number_) + ": " + what));
  }

  /// Hands on one line to tinyobjloader, which skips a keyword without a blank behind it, and a face without
  /// corners. Therefore it gets a corner more.
  int_type underflow() override {
    if (rest_.empty()) return traits_type::eof();
    take_line();
    handed_on_ = line_ + " 0\n";
    setg(handed_on_.data(), handed_on_.data(), handed_on_.data() + handed_on_.size());
    return traits_type::to_int_type(handed_on_[0]);
  }

  /// Moves past a line, which ends with \n, \r or \r\n, and continues in the next if it ends with a
  /// backslash. Takes its text without comments.
  void take_line() {
    number_ = next_number_;
    line_.clear();
    for (bool goes_on = true; goes_on && !rest_.empty(); ++next_number_) {
      const std::string_view line = rest_.substr(0, rest_.find_first_of("\r\n"));
      rest_.remove_prefix(line.size());
      if (!rest_.empty()) rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : 1);
      if (line.find('\0') != line.npos) refuse("there is a zero byte, which no text has");
      line_ += line.substr(0, line.find('#'));
      goes_on = line_.ends_with('\\');
      if (goes_on) line_.back() = ' ';
    }
  }

  static std::string found_instead(const std::string& what, std::size_t number, std::string_view word) {
    return what + " " + std::to_string(number) +
           (word.empty() ? " is missing" : " is \"" + beginning(std::string(word)) + "\"");
  }

  /// Adds the numbers behind the first word of the line, two or three; others are ignored. The v of texture
  /// coordinates may be missing and is turned over: in the file, v = 0 is the lower edge of a picture. 1 − v
  /// is a coordinate if v is one, as 1 more than 2^400 is 2^400 in double.
  void add(Kind kind) {
    const std::size_t least = kind == texture ? 1 : 3, most = kind == texture ? 2 : 3;
    std::string_view rest = line_;
    (void)taken_word(rest);
    std::array<double, 3> numbers{};
    for (std::size_t found = 0; found < most; ++found) {
      const std::string_view word = taken_word(rest);
      if (word.empty() && found >= least) break;
      const bool has_plus = word.starts_with('+') && !word.starts_with("+-");
      const auto number = number_of<double>(word.substr(has_plus ? 1 : 0));
      if (!number || !std::isfinite(*number))
        refuse("expected " + std::to_string(least) + (least < most ? " or more" : "") +
               " finite numbers that a double holds, and " + found_instead("number", found + 1, word));
      if (kind != normal && !is_coordinate(*number))
        refuse(std::string("the numbers of a ").append(names[kind]) + " must be " + coordinate_rule +
               ", and " + found_instead("number", found + 1, word));
      numbers[found] = *number;
    }
    const auto [x, y, z] = numbers;
    all_[kind].push_back(kind == texture ? Vec3{x, 1 - y, 0} : Vec3{x, y, z});
    if (all_[kind].size() == static_cast<std::size_t>(std::numeric_limits<int>::max()))
      refuse("there are more lines of this kind than the 2^31 - 2 that are allowed");
    if (kind == position) first_at_.push_back(none);
  }

  /// Adds a polygon, cut into triangles by its diagonals from the first corner.
  void add_face() {
    std::string_view line = line_;
    (void)taken_word(line);
    std::vector<std::uint32_t> polygon;
    for (std::string_view word = taken_word(line); !word.empty(); word = taken_word(line)) {
      Vertex corner{};
      if (!read_corner(word, corner))
        refuse("expected a face, with corners as 1, 1/2, 1//3 or 1/2/3, of indices of up to 9 digits, and " +
               found_instead("corner", polygon.size() + 1, word));
      polygon.push_back(vertex(corner));
    }
    if (polygon.size() < 3)
      refuse("a face has 3 corners or more, and this has " + std::to_string(polygon.size()));
    for (std::size_t i = 2; i < polygon.size(); ++i)
      data_.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }

  /// Reads the indices of a corner, as the file has them; 0 stays for one that is left out. Returns false for
  /// a text that is no corner.
  static bool read_corner(std::string_view word, Vertex& corner) {
    for (std::size_t field = 0; field < 3; ++field) {
      const std::size_t slash = word.find('/');
      const std::string_view index = word.substr(0, slash);
      if (!(field == 1 && slash == 0)) {
        const auto number = number_of<int>(index);
        if (!number || *number < -most_index || *number > most_index) return false;
        corner[field] = *number;
      }
      if (slash == std::string_view::npos) return true;
      word.remove_prefix(slash + 1);
    }
    return false;
  }

  /// Returns the index of a corner's vertex, an old or a new one. Indices of the file count from 1 or, if
  /// negative, back from the last.
  [[nodiscard]] std::uint32_t vertex(const Vertex& corner) {
    Vertex vertex{none, none, none};
    for (std::size_t kind = position; kind <= normal; ++kind) {
      if (kind != position && corner[kind] == 0) continue;
      const int count = static_cast<int>(all_[kind].size());
      vertex[kind] = corner[kind] < 0 ? count + corner[kind] : corner[kind] - 1;
      if (vertex[kind] < 0 || vertex[kind] >= count)
        refuse(std::string(names[kind]) + " " + std::to_string(corner[kind]) + " is not one of the " +
               std::to_string(count) + " so far");
    }
    const int number = static_cast<int>(vertices_.size());
    int& first = first_at_[static_cast<std::size_t>(vertex[0])];
    if (first != none && vertices_[static_cast<std::size_t>(first)] == vertex)
      return static_cast<std::uint32_t>(first);
    if (first == none)
      first = number;
    else if (const auto [at, is_new] = others_.try_emplace(vertex, number); !is_new)
      return static_cast<std::uint32_t>(at->second);
    vertices_.push_back(vertex);
    return static_cast<std::uint32_t>(number);
  }

  /// Returns the mesh, with texture coordinates or normals only if all vertices have them.
  [[nodiscard]] MeshData take() {
    const auto give = [&](Kind kind, auto& chosen) {
      for (const Vertex& v : vertices_)
        if (v[kind] == none) return;
      chosen.reserve(vertices_.size());
      for (const Vertex& v : vertices_) chosen.emplace_back(all_[kind][static_cast<std::size_t>(v[kind])]);
    };
    give(position, data_.vertices);
    give(texture, data_.uvs);
    give(normal, data_.normals);
    return std::move(data_);
  }

  std::string_view rest_;  ///< text behind the line
  std::string file_, line_, handed_on_;
  std::size_t number_ = 0, next_number_ = 1;  ///< number of the line, from 1, and of the next
  std::array<std::vector<Vec3>, 3> all_;      ///< positions, texture coordinates and normals so far
  std::vector<Vertex> vertices_;
  std::vector<int> first_at_;     ///< index of the first vertex at each position
  std::map<Vertex, int> others_;  ///< indices of the vertices that are not the first at their positions
  MeshData data_;
};

}  // namespace detail

/// Returns the mesh that the text of an OBJ file describes; `file` is its name in error messages. Polygons
/// are cut into triangles by their diagonals from the first corner. Normals and texture coordinates are taken
/// if all corners of all faces have them; groups, materials, lines and points are ignored. Throws
/// std::runtime_error, with the line, if a number is missing or not finite, an index is out of range, or a
/// face is invalid, and if there is no face.
[[nodiscard]] inline MeshData mesh_from_obj(std::string_view text, const std::string& file) {
  return detail::ObjBuilder(text, file).build();
}

/// Returns the mesh in an OBJ file. Throws std::system_error if it cannot be read, and std::runtime_error if
/// it is longer than most_bytes (2^31), so that a file without an end does not fill the memory, or if it is
/// wrong; all name the path.
[[nodiscard]] inline MeshData load_obj(const std::filesystem::path& path,
                                       std::size_t most_bytes = std::size_t{1} << 31) {
  return mesh_from_obj(detail::text_of<std::runtime_error>(path, most_bytes), path.string());
}

}  // namespace protostar::inline PROTOSTAR_ABI
