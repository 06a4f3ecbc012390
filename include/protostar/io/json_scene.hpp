// Scene files (docs/scene-format.md), through nlohmann_json. Not part of the core: link protostar::json.
//
// Everything is checked where it is read, by a JsonCursor, which knows the way to its value. To add a type of
// surface, write a function that makes one, beside sphere_at, and a row in surface_types; one that SceneFile
// does not name is held as AnySurface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../image.hpp"
#include "../surfaces/box.hpp"
#include "../surfaces/csg.hpp"
#include "../surfaces/disk.hpp"
#include "../surfaces/instance.hpp"
#include "../surfaces/quadric.hpp"
#include "../surfaces/triangle.hpp"
#include "image_texture.hpp"
#include "scene_file.hpp"
#include "text.hpp"

// Meshes can be read where tinyobjloader is found.
#if __has_include(<tiny_obj_loader.h>)
#include "obj.hpp"
#define PROTOSTAR_READS_MESHES 1
#endif

namespace protostar::inline PROTOSTAR_ABI {

/// What is wrong with a scene file: its name, the place in it, what was found and what is allowed.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {

using nlohmann::json;

/// Of a scene file. A million spheres take half of it.
inline constexpr std::size_t most_bytes = std::size_t{1} << 28;

/// One more step of a JSON pointer (RFC 6901), with its control characters as JSON writes them.
inline std::string step(const std::string& key) {
  std::string text = "/";
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  const std::string quoted = json(beginning(text)).dump();
  return quoted.substr(1, quoted.size() - 2);
}
inline std::string step(std::size_t index) { return "/" + std::to_string(index); }

/// A JSON pointer as a line can show it: of a very long one, the first and the last steps.
inline std::string abridged(const std::string& pointer) {
  constexpr std::size_t most = 300, end = 120;
  if (pointer.size() <= most) return pointer;
  const std::size_t from = pointer.find('/', pointer.size() - end);
  return beginning(pointer, end) + pointer.substr(from < pointer.size() ? from : pointer.size());
}

[[noreturn]] inline void refuse(const std::string& file, const std::string& pointer,
                                const std::string& what) {
  throw SceneError(file + ": " + (pointer.empty() ? "the whole" : abridged(pointer)) + ": " + what);
}

/// "a, b and c".
template <class Names>
std::string list_of(const Names& names, const std::string& last = " and ") {
  std::string text;
  std::size_t left = std::size(names);
  for (const auto& name : names) {
    text += name;
    --left;
    text += left > 1 ? ", " : left == 1 ? last : "";
  }
  return text;
}

/// Takes what nlohmann's parser reads and builds the value of it. It refuses what the parser would let pass,
/// a key that is there twice, and what would be built for nothing, a nesting that no scene has.
class JsonBuilder {
 public:
  explicit JsonBuilder(std::string file) : file_(std::move(file)) {}

  json take() { return std::move(root_); }

  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(std::int64_t value) { return put(value); }
  bool number_unsigned(std::uint64_t value) { return put(value); }
  bool number_float(double value, const std::string&) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // JSON has none

  bool start_object(std::size_t) { return open(json::object()); }
  bool start_array(std::size_t) { return open(json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    open_.back().key = std::move(name);
    if (open_.back().value->contains(open_.back().key))
      refuse(file_, pointer(), "the key is there twice; once is allowed");
    return true;
  }

  bool parse_error(std::size_t, const std::string& token, const nlohmann::detail::exception& error) const {
    if (dynamic_cast<const json::out_of_range*>(&error))
      refuse(file_, pointer(), beginning(token) + " is not a number that a double holds, up to 1.8e308");
    // "[its name] parse error at line 1, column 2: ... last read: ..."
    const std::string what = error.what();
    throw SceneError(file_ + ": " + printable(what.substr(what.find("] ") + 2), 240));
  }

 private:
  /// Operations on solids may be a thousand deep, each of them an object and an array; and then some.
  static constexpr std::size_t most_open = 2 * std::size_t{Csg::most_depth} + 48;

  struct Open {
    json* value;
    std::string key;  ///< of an object: the last one
  };

  bool put(json value) {
    place(std::move(value));
    return true;
  }

  bool open(json value) {
    if (open_.size() == most_open)
      refuse(file_, pointer(),
             "there are " + std::to_string(most_open + 1) +
                 " arrays and objects inside each other; at most " + std::to_string(most_open) +
                 " are allowed");
    open_.push_back({.value = &place(std::move(value)), .key = ""});
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  /// An array moves its values only when it grows, which it does not while one of them is open.
  json& place(json value) {
    if (open_.empty()) return root_ = std::move(value);
    Open& in = open_.back();
    if (in.value->is_object()) return (*in.value)[in.key] = std::move(value);
    in.value->push_back(std::move(value));
    return in.value->back();
  }

  /// The way to the value that comes next.
  [[nodiscard]] std::string pointer() const {
    std::string text;
    for (const Open& in : open_) {
      const bool innermost = &in == &open_.back();
      text += in.value->is_object() ? step(in.key) : step(in.value->size() - (innermost ? 0 : 1));
    }
    return text;
  }

  std::string file_;
  json root_;
  std::vector<Open> open_;
};

/// A value in a scene file, or the lack of one, and the way to it. Whatever is read from it is checked; what
/// is wrong throws SceneError.
class JsonCursor {
 public:
  /// The whole file. Both have to live as long as the cursor.
  JsonCursor(const json& value, const std::string& file) : file_(&file), value_(&value) {}

  [[noreturn]] void refuse(const std::string& allowed) const {
    detail::refuse(*file_, pointer(), found() + " is not " + allowed);
  }

  [[noreturn]] void refuse_beside(const std::string& other) const {
    detail::refuse(*file_, pointer(), found() + " is not possible beside " + other);
  }

  // ---- Objects and arrays.

  /// Demands an object without other keys than these.
  const JsonCursor& with_keys(const std::vector<std::string>& allowed) const {
    require(is_object(), "an object");
    for (const auto& [key, value] : value_->items())
      if (std::find(allowed.begin(), allowed.end(), key) == allowed.end())
        detail::refuse(*file_, pointer() + step(key), "is not a key here; allowed are " + list_of(allowed));
    return *this;
  }

  [[nodiscard]] bool is_object() const { return value_ && value_->is_object(); }
  [[nodiscard]] bool is_array() const { return value_ && value_->is_array(); }
  [[nodiscard]] bool has(const std::string& key) const { return is_object() && value_->contains(key); }

  /// What an object has under a key.
  [[nodiscard]] JsonCursor operator[](const std::string& key) const {
    require(is_object(), "an object");
    return {*this, step(key), has(key) ? &*value_->find(key) : nullptr};
  }

  /// What an array has, each with a cursor of its own.
  [[nodiscard]] std::vector<JsonCursor> elements() const {
    require(value_ && value_->is_array(), "an array");
    std::vector<JsonCursor> all;
    all.reserve(value_->size());
    for (const json& value : *value_) all.push_back({*this, step(all.size()), &value});
    return all;
  }

  /// The same of an array of a known size.
  [[nodiscard]] std::vector<JsonCursor> elements(std::size_t size, const std::string& allowed) const {
    require(value_ && value_->is_array() && value_->size() == size, allowed);
    return elements();
  }

  /// What an object has, by their keys.
  [[nodiscard]] std::map<std::string, JsonCursor> members() const {
    require(is_object(), "an object");
    std::map<std::string, JsonCursor> all;
    for (const auto& [key, value] : value_->items()) all.emplace(key, JsonCursor(*this, step(key), &value));
    return all;
  }

  // ---- Numbers.

  [[nodiscard]] double number(const std::string& allowed = "a number") const {
    require(value_ && value_->is_number(), allowed);
    return value_->get<double>();
  }

  [[nodiscard]] double number_above_0() const {
    const std::string allowed = "a number greater than 0";
    const double x = number(allowed);
    require(x > 0, allowed);
    return x;
  }

  [[nodiscard]] double number_between(double min, double max, const std::string& allowed) const {
    const double x = number(allowed);
    require(min <= x && x <= max, allowed);
    return x;
  }

  /// A factor on light, which is computed in float: what is 0 there is 0 from the beginning.
  [[nodiscard]] double factor() const {
    return double{static_cast<float>(
        number_between(0, std::numeric_limits<float>::max(), "a number from 0 to 3.4e38"))};
  }

  /// A length that a camera is made of, far inside of what Camera::validate allows.
  [[nodiscard]] double camera_length() const {
    return number_between(1e-100, 1e100, "a number from 1e-100 to 1e100");
  }

  [[nodiscard]] int whole_number(int min, int max) const {
    const std::string allowed = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
    const double x = number_between(min, max, allowed);
    require(x == std::floor(x), allowed);
    return static_cast<int>(x);
  }

  // ---- Threes of numbers.

  [[nodiscard]] Vec3 vector() const {
    const auto xyz = elements(3, "a vector, an array of three numbers");
    return {xyz[0].number(), xyz[1].number(), xyz[2].number()};
  }

  /// A vector of unit length along the one in the file.
  [[nodiscard]] Vec3 direction() const {
    const Vec3 v = vector();
    require(v != Vec3{0}, "a direction, a vector that is not 0");
    const Vec3 near_one = scaled(v, -exponent_of({v}));  // whose squares neither overflow nor vanish
    return near_one / length(near_one);
  }

  [[nodiscard]] Color color() const {
    const auto rgb = elements(3, "a color, an array of three numbers from 0 to 3.4e38");
    return Color(Vec3{rgb[0].factor(), rgb[1].factor(), rgb[2].factor()});
  }

  // ---- Words.

  [[nodiscard]] bool is(std::string_view word) const {
    return value_ && value_->is_string() && value_->get_ref<const std::string&>() == word;
  }

  [[nodiscard]] std::string text(const std::string& allowed) const {
    require(value_ && value_->is_string(), allowed);
    return value_->get<std::string>();
  }

  /// A file's path; what it is relative to is the folder of the scene.
  [[nodiscard]] std::filesystem::path path() const {
    const std::string allowed = "the path of a file", name = text(allowed);
    require(name.find('\0') == std::string::npos, allowed);  // which a system would take for its end
    return std::filesystem::path(*file_).parent_path() / name;
  }

  /// One of the first members of these pairs, and what belongs to it.
  template <class Pairs>
  [[nodiscard]] auto one_of(const Pairs& pairs) const {
    std::vector<std::string> names;
    for (const auto& [name, meaning] : pairs) names.push_back('"' + std::string(name) + '"');
    const std::string allowed = list_of(names, " or "), found = text(allowed);
    for (const auto& [name, meaning] : pairs)
      if (name == found) return meaning;
    refuse(allowed);
  }

  /// Calls what makes a thing of the library, whose own objection becomes one to this value.
  auto checked(const auto& make) const {
    try {
      return make();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      detail::refuse(*file_, pointer(), found() + " is not possible: " + error.what());
    }
  }

 private:
  /// The way to a value, which values inside of it share.
  struct Way {
    std::shared_ptr<const Way> to_parent;
    std::string last_step;
  };

  JsonCursor(const JsonCursor& parent, const std::string& last_step, const json* value)
      : file_(parent.file_), way_(std::make_shared<const Way>(Way{parent.way_, last_step})), value_(value) {}

  [[nodiscard]] std::string pointer() const {
    std::vector<const Way*> steps;
    for (const Way* way = way_.get(); way; way = way->to_parent.get()) steps.push_back(way);
    std::string text;
    for (auto way = steps.rbegin(); way != steps.rend(); ++way) text += (*way)->last_step;
    return text;
  }

  void require(bool holds, const std::string& allowed) const {
    if (!holds) refuse(allowed);
  }

  /// The value as JSON writes it, as far as it can be read at a glance.
  [[nodiscard]] std::string found() const {
    if (!value_) return "nothing";
    if (value_->size() > 100) return "an array or object of " + std::to_string(value_->size()) + " values";
    return beginning(value_->dump());
  }

  const std::string* file_;
  std::shared_ptr<const Way> way_;  ///< none to the whole
  const json* value_;               ///< nothing where there is none
};

// ---- Surfaces.

inline Sphere sphere_at(const JsonCursor& at) {
  at.with_keys({"type", "position", "radius"});
  return {.center = at["position"].vector(), .radius = at["radius"].number_above_0()};
}

inline Plane plane_at(const JsonCursor& at) {
  at.with_keys({"type", "normal", "distance"});
  return {.normal = at["normal"].direction(), .distance = at["distance"].number()};
}

inline Parallelogram parallelogram_at(const JsonCursor& at) {
  at.with_keys({"type", "position", "edges"});
  const auto edges = at["edges"].elements(2, "an array of two vectors");
  const Parallelogram board{
      .position = at["position"].vector(), .edge_u = edges[0].vector(), .edge_v = edges[1].vector()};
  at["edges"].checked([&] { board.validate(); });
  return board;
}

inline Triangle triangle_at(const JsonCursor& at) {
  at.with_keys({"type", "points"});
  const auto points = at["points"].elements(3, "an array of three points");
  const Triangle triangle{.a = points[0].vector(), .b = points[1].vector(), .c = points[2].vector()};
  at["points"].checked([&] { triangle.validate(); });
  return triangle;
}

#if defined(PROTOSTAR_READS_MESHES)
inline Mesh mesh_at(const JsonCursor& at) {
  at.with_keys({"type", "file", "position", "scale"});
  const std::filesystem::path path = at["file"].path();
  const Vec3 position = at.has("position") ? at["position"].vector() : Vec3{0};
  const double scale = at.has("scale") ? at["scale"].number_above_0() : 1;
  MeshData data = at["file"].checked([&] { return load_obj(path); });
  for (Point& vertex : data.vertices) {
    const Vec3 from_position = scale * vertex;
    vertex = position + from_position;
    if (!is_finite(vertex))
      at[is_finite(from_position) ? "position" : "scale"].refuse("one that leaves all vertices finite");
  }
  return at["file"].checked([&] { return Mesh(std::move(data)); });
}
#else
inline Sphere mesh_at(const JsonCursor& at) {
  return at["file"].checked([]() -> Sphere {
    throw std::runtime_error(
        "this program was built without tinyobjloader, which reads meshes (Debian: libtinyobjloader-dev)");
  });
}
#endif

inline Box box_at(const JsonCursor& at) {
  at.with_keys({"type", "min", "max"});
  const Box box{.min = at["min"].vector(), .max = at["max"].vector()};
  at["max"].checked([&] { box.validate(); });
  return box;
}

inline Disk disk_at(const JsonCursor& at) {
  at.with_keys({"type", "position", "normal", "radius"});
  const Disk disk{.position = at["position"].vector(),
                  .normal = at["normal"].vector(),
                  .radius = at["radius"].number_above_0()};
  at["normal"].checked([&] { disk.validate(); });
  return disk;
}

inline Quadric quadric_at(const JsonCursor& at) {
  at.with_keys({"type", "matrix"});
  const std::string allowed = "a symmetric matrix, an array of four rows of four numbers";
  const auto rows = at["matrix"].elements(4, allowed);
  double m[4][4] = {};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto row = rows[i].elements(4, "a row of four numbers");
    for (std::size_t j = 0; j < 4; ++j) {
      m[i][j] = row[j].number();
      if (j < i && m[i][j] != m[j][i])
        row[j].refuse("the number on the other side of the diagonal, " + json(m[j][i]).dump());
    }
  }
  const Quadric quadric{{.squares = {m[0][0], m[1][1], m[2][2]},
                         .products = {m[1][2], m[2][0], m[0][1]},
                         .linear = {m[0][3], m[1][3], m[2][3]},
                         .constant = m[3][3]}};
  at["matrix"].checked([&] { quadric.validate(); });
  return quadric;
}

AnySurface surface_at(const JsonCursor& at);

/// What is made of solids, or one of them.
inline Csg solid_at(const JsonCursor& at);

inline Csg csg_at(const JsonCursor& at) {
  at.with_keys({"type", "operation", "surfaces"});
  using Operation = Csg::Operation;
  const auto operation =
      at["operation"].one_of(std::array{std::pair{std::string_view("union"), Operation::either},
                                        std::pair{std::string_view("intersection"), Operation::all},
                                        std::pair{std::string_view("difference"), Operation::first_alone}});
  std::vector<Csg> solids;
  for (const JsonCursor& operand : at["surfaces"].elements()) solids.push_back(solid_at(operand));
  return at["surfaces"].checked([&] { return Csg(operation, std::move(solids)); });
}

/// Says what of a surface that is no closed solid makes it so.
[[noreturn]] inline void refuse_as_solid(const JsonCursor& at) {
  if (at["type"].is("instance")) refuse_as_solid(at["surface"]);
  if (at["type"].is("mesh"))
    at["file"].refuse("the file of a closed mesh, whose triangles share each edge, in opposite directions");
  at["type"].refuse("the type of a closed solid");
}

inline Csg solid_at(const JsonCursor& at) {
  if (at.has("type") && at["type"].is("csg")) return csg_at(at);
  AnySurface surface = surface_at(at);
  try {
    return Csg(std::move(surface));  // which looks at all edges of a mesh, so that it is not asked before
  } catch (const std::invalid_argument&) {
    refuse_as_solid(at);
  }
}

/// Three rows of four numbers: the linear part, and behind it the translation.
inline Affine matrix_at(const JsonCursor& at) {
  const auto rows = at.elements(3, "an array of three rows");
  Affine map;
  for (int i = 0; i < 3; ++i) {
    const auto row = rows[static_cast<std::size_t>(i)].elements(4, "a row, an array of four numbers");
    map.x[i] = row[0].number(), map.y[i] = row[1].number(), map.z[i] = row[2].number();
    map.translation[i] = row[3].number();
  }
  return map;
}

inline Affine placement_at(const JsonCursor& at) {
  if (at.has("matrix")) return matrix_at(at.with_keys({"type", "surface", "matrix"})["matrix"]);
  at.with_keys({"type", "surface", "scale", "rotate", "translate"});
  Affine map;
  if (at.has("scale")) {
    const JsonCursor scale = at["scale"];
    map = map.scaled_by(scale.is_array() ? scale.vector() : Vec3(scale.number("a number or a vector")));
  }
  if (at.has("rotate")) {
    const JsonCursor rotate = at["rotate"].with_keys({"axis", "angle"});
    map = map.rotated_about(rotate["axis"].direction(), rotate["angle"].number("a number of degrees"));
  }
  if (at.has("translate")) map = map.moved_by(at["translate"].vector());
  return map;
}

inline Instance<> instance_at(const JsonCursor& at) {
  const Affine placement = placement_at(at);
  at[at.has("matrix") ? "matrix" : "scale"].checked([&] {
    if (!AffineInverse(placement).exists())
      throw std::invalid_argument("it takes space to a plane or less, or beyond the range of double");
  });
  return {surface_at(at["surface"]), placement};
}

/// How surfaces of a type are read: into a scene, or to be held by another.
struct SurfaceReader {
  void (*add)(const JsonCursor&, const Material&, SceneFile&);
  AnySurface (*make)(const JsonCursor&);
};
template <auto some_surface_at>
inline constexpr SurfaceReader read_by{
    .add =
        [](const JsonCursor& at, const Material& material, SceneFile& file) {
          const auto surface = some_surface_at(at);
          at.checked([&] { file.scene.add(surface, material); });
        },
    .make = [](const JsonCursor& at) -> AnySurface { return some_surface_at(at); }};

inline const std::vector<std::pair<std::string_view, SurfaceReader>> surface_types{
    {"sphere", read_by<sphere_at>},
    {"plane", read_by<plane_at>},
    {"parallelogram", read_by<parallelogram_at>},
    {"triangle", read_by<triangle_at>},
    {"mesh", read_by<mesh_at>},
    {"box", read_by<box_at>},
    {"disk", read_by<disk_at>},
    {"quadric", read_by<quadric_at>},
    {"csg", read_by<csg_at>},
    {"instance", read_by<instance_at>},
};

/// A surface of any type, for one that holds it.
inline AnySurface surface_at(const JsonCursor& at) { return at["type"].one_of(surface_types).make(at); }

// ---- Materials.

inline Texture texture_at(const JsonCursor& at) {
  if (at.has("image")) {
    at.with_keys({"image", "size"});
    double size_u = 1, size_v = 1;
    if (at.has("size")) {
      const auto size = at["size"].elements(2, "an array of two numbers");
      size_u = size[0].number_above_0(), size_v = size[1].number_above_0();
    }
    const std::filesystem::path path = at["image"].path();
    return at["image"].checked([&] { return image_texture(path, size_u, size_v); });
  }
  at.with_keys({"checker", "size"});
  const auto colors = at["checker"].elements(2, "an array of two colors");
  return Checker{
      .first = colors[0].color(), .second = colors[1].color(), .size = at["size"].number_above_0()};
}

inline Material material_at(const JsonCursor& at) {
  at.with_keys({"diffuse", "specular", "shininess", "reflect", "refract", "ior"});
  Material material;
  if (at["diffuse"].is_object())
    material.texture = texture_at(at["diffuse"]);
  else if (at.has("diffuse"))
    material.diffuse = at["diffuse"].color();
  if (at.has("specular")) material.specular = at["specular"].color();
  if (at.has("shininess"))
    material.shininess =
        at["shininess"].number_between(0, std::numeric_limits<double>::max(), "a number of at least 0");
  if (at.has("reflect")) material.reflect = at["reflect"].factor();
  if (at.has("refract")) material.refract = at["refract"].factor();
  if (at.has("ior")) material.ior = at["ior"].number_above_0();
  return material;
}

using Materials = std::map<std::string, Material>;

inline Material material_of(const JsonCursor& object, const Materials& materials) {
  if (object.has("material-id") && object.has("color")) object["color"].refuse_beside("a material-id");
  if (object.has("color")) return {.diffuse = object["color"].color()};
  const std::string allowed = "the name of one of the materials";
  const auto found = materials.find(object["material-id"].text(allowed + ", and there is no color"));
  if (found != materials.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, material] : materials)
    if (names.size() < 10) names.push_back(json(beginning(name)).dump());
  if (names.size() < materials.size()) names.push_back("more");
  object["material-id"].refuse(allowed +
                               (names.empty() ? ", of which there are none" : ": " + list_of(names)));
}

// ---- Lights. The keys say which kind it is.

inline void add_light(const JsonCursor& at, SceneFile& file) {
  if (at.has("ambient")) {
    at.with_keys({"ambient"});
    file.scene.add(AmbientLight{at["ambient"].color()});
  } else if (at.has("angle") || at.has("fade") || (at.has("position") && at.has("direction"))) {
    at.with_keys({"position", "direction", "angle", "fade", "power"});
    SpotLight light{.position = at["position"].vector(), .direction = at["direction"].direction()};
    const std::string degrees = "a number of degrees above 0 and at most 180";
    light.angle = at["angle"].number_between(std::numeric_limits<double>::denorm_min(), 180, degrees);
    if (at.has("fade"))
      light.fade = at["fade"].number_between(0, std::numeric_limits<double>::max(),
                                             "a number of degrees of at least 0");
    light.power = at["power"].color();
    at.checked([&] { file.scene.add(light); });
  } else if (at.has("direction")) {
    at.with_keys({"direction", "intensity"});
    const Vec3 direction = at["direction"].direction();
    file.scene.add(DirectionalLight{.direction = direction, .intensity = at["intensity"].color()});
  } else if (at.has("power")) {
    at.with_keys({"position", "power"});
    file.scene.add(PointLight{.position = at["position"].vector(), .power = at["power"].color()});
  } else {
    at.with_keys({"position", "direction", "intensity", "power", "angle", "fade", "ambient"});
    if (!at.has("position") && !at.has("intensity"))
      at.refuse(
          "a light: position and intensity, position and power, direction and intensity, position, "
          "direction, angle "
          "and power, or ambient");
    file.scene.add(ConstantLight{.position = at["position"].vector(), .intensity = at["intensity"].color()});
  }
}

// ---- The rest.

inline Camera camera_at(const JsonCursor& at) {
  enum class Projection { perspective, orthographic };
  const auto projection = at["projection"].one_of(
      std::array{std::pair{std::string_view("perspective"), Projection::perspective},
                 std::pair{std::string_view("orthographic"), Projection::orthographic}});
  if (projection == Projection::orthographic)
    at.with_keys({"projection", "position", "direction", "upward", "ortho-scale"});
  else
    at.with_keys({"projection", "position", "direction", "upward", "field-of-view", "focal-length"});

  const Vec3 position = at["position"].vector(), direction = at["direction"].direction();
  const Vec3 upward = at["upward"].direction();
  if (!(std::abs(dot(direction, upward)) <= Camera::most_cosine))
    at["upward"].refuse("orthogonal to direction: the cosine between them is at most 1e-6");

  if (projection == Projection::orthographic) {
    const double height = at["ortho-scale"].camera_length();
    return at.checked([&] { return Camera::orthographic(position, direction, upward, height); });
  }
  if (at.has("field-of-view") && at.has("focal-length")) at["focal-length"].refuse_beside("a field-of-view");
  if (at.has("focal-length")) {
    const double focal_length = at["focal-length"].camera_length();
    return at.checked([&] { return Camera::sensor(position, direction, upward, focal_length); });
  }
  const std::string degrees = "a number of degrees from 1e-100 to below 180";  // half its tangent is a length
  if (!at.has("field-of-view")) at["field-of-view"].refuse(degrees + ", and there is no focal-length");
  const double angle = at["field-of-view"].number_between(1e-100, std::nextafter(180, 0), degrees);
  return at.checked([&] { return Camera::perspective(position, direction, upward, angle); });
}

inline Transfer transfer_at(const JsonCursor& at) {
  if (at.is_object()) return Gamma{at.with_keys({"gamma"})["gamma"].number_above_0()};
  return at.one_of(std::array{std::pair{std::string_view("srgb"), Transfer(Srgb{})},
                              std::pair{std::string_view("linear"), Transfer(Linear{})}});
}

inline Tone tone_at(const JsonCursor& at) {
  return at.one_of(std::array{std::pair{std::string_view("clip"), Tone::clip},
                              std::pair{std::string_view("scale-pixel"), Tone::scale_pixel},
                              std::pair{std::string_view("scale-image"), Tone::scale_image}});
}

inline void read_settings(const JsonCursor& at, SceneFile& file) {
  at.with_keys(
      {"resolution-x", "resolution-y", "samples", "depth", "integrator", "transfer", "tone", "exposure"});
  const int most = static_cast<int>(Image::max_pixels);
  file.width = at["resolution-x"].whole_number(1, most);
  file.height = at["resolution-y"].whole_number(1, most);
  if (std::int64_t{file.width} * file.height > Image::max_pixels)
    at.refuse("a picture of at most 2^28 pixels");
  if (at.has("samples")) file.samples = at["samples"].whole_number(0, most_samples);
  if (at.has("depth")) file.depth = at["depth"].whole_number(1, most_depth);
  if (at.has("integrator")) {
    std::vector<std::pair<std::string_view, std::string_view>> names;
    for (const std::string_view name : integrator_names) names.push_back({name, name});
    file.integrator = at["integrator"].one_of(names);
  }
  if (at.has("transfer")) file.transfer = transfer_at(at["transfer"]);
  if (at.has("tone")) file.tone = tone_at(at["tone"]);
  if (at.has("exposure")) file.exposure = at["exposure"].factor();
}

inline void read_world(const JsonCursor& at, SceneFile& file) {
  at.with_keys({"sky", "environment"});
  if (at.has("sky") && at.has("environment")) at["sky"].refuse_beside("an environment");
  if (at.has("sky")) file.scene.set_sky(at["sky"].color());
  if (at.has("environment")) {
    const std::filesystem::path path = at["environment"].path();
    file.scene.set_environment(at["environment"].checked([&] { return image_texture(path); }));
  }
}

inline SceneFile scene_at(const JsonCursor& at) {
  at.with_keys({"settings", "world", "camera", "objects", "lights", "materials"});
  SceneFile file;
  read_settings(at["settings"], file);
  if (at.has("world")) read_world(at["world"], file);
  file.camera = camera_at(at["camera"]);

  Materials materials;
  if (at.has("materials"))
    for (const auto& [name, material] : at["materials"].members())
      materials.emplace(name, material_at(material));
  for (const JsonCursor& object : at["objects"].elements()) {
    object.with_keys({"surface", "material-id", "color"});
    const JsonCursor surface = object["surface"];
    surface["type"].one_of(surface_types).add(surface, material_of(object, materials), file);
  }
  if (at.has("lights"))
    for (const JsonCursor& light : at["lights"].elements()) add_light(light, file);
  return file;
}

}  // namespace detail

/// The scene that a text describes; file is its name in what is wrong with it. Throws SceneError.
[[nodiscard]] inline SceneFile scene_from_json(const std::string& text, const std::string& file) {
  // The parser takes a zero byte for the end.
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto line = 1 + std::count(text.data(), text.data() + zero, '\n');
    const std::size_t column = zero - std::string_view(text.data(), zero).rfind('\n');  // npos is −1
    throw SceneError(file + ": parse error at line " + std::to_string(line) + ", column " +
                     std::to_string(column) + ": a zero byte, which no text has");
  }
  detail::JsonBuilder builder(file);
  nlohmann::json::sax_parse(text, &builder);
  const nlohmann::json value = builder.take();
  return detail::scene_at(detail::JsonCursor(value, file));
}

/// Reads a scene file. Throws std::system_error if it cannot be read, and SceneError for what is wrong in it.
[[nodiscard]] inline SceneFile read_scene(const std::filesystem::path& path) {
  try {
    return scene_from_json(detail::text_of<SceneError>(path, detail::most_bytes), path.string());
  } catch (const std::bad_alloc&) {
    throw SceneError(path.string() + ": not enough memory for this scene");
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI
