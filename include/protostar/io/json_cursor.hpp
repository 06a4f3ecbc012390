// Reads and checks the values of a scene file, and names the path of a wrong one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "../magnitude.hpp"
#include "../numeric/scale.hpp"
#include "../vec3.hpp"
#include "json_tree.hpp"
#include "loaded_files.hpp"
#include "read_options.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Returns the names as a list: "a, b and c".
template <class Names>
std::string list_of(const Names& names, const std::string& last = " and ") {
  std::string text;
  std::size_t remaining = std::size(names);
  for (const auto& name : names) {
    text += name;
    --remaining;
    text += remaining > 1 ? ", " : remaining == 1 ? last : "";
  }
  return text;
}

/// Scene file that is being read.
struct SceneText {
  JsonTree tree;  ///< with the file's path, for messages and for the folder of the files that it names
  ReadOptions options = {};
  mutable LoadedFiles loaded = {};  ///< files that the scene names, as far as they are loaded
};

/// File that a scene names.
struct NamedFile {
  std::filesystem::path path;       ///< from the program's working directory, for messages and to be opened
  std::filesystem::path canonical;  ///< without links, the same for all names that lead to the file
};

/// Value in a scene file, or the absence of one. All that is read from it is checked; errors are thrown as
/// SceneError, with the path to it.
class JsonCursor {
 public:
  /// Points to the root of a file, which has to outlive the cursor.
  explicit JsonCursor(const SceneText& scene) : JsonCursor(scene, scene.tree.root) {}

  /// Throws SceneError about the value: it is not one that is `allowed`, or not possible beside another key.
  [[noreturn]] void refuse(std::string_view allowed) const {
    say(found().append(" is not ").append(allowed));
  }

  [[noreturn]] void refuse_beside(const std::string& other) const {
    say(found() + " is not possible beside " + other);
  }

  [[nodiscard]] const ReadOptions& options() const { return scene_->options; }
  [[nodiscard]] LoadedFiles& loaded() const { return scene_->loaded; }

  // ---- Objects and arrays.

  /// Refuses all but an object without other keys than these; returns the cursor itself.
  const JsonCursor& with_keys(const std::vector<std::string_view>& allowed) const {
    each_member([&](std::string_view key, const JsonCursor& value) {
      if (std::find(allowed.begin(), allowed.end(), key) == allowed.end())
        value.say("is not a key here; allowed are " + list_of(allowed));
    });
    return *this;
  }

  [[nodiscard]] bool is(json::value_t type) const { return exists() && value_->type() == type; }
  [[nodiscard]] bool has(std::string_view key) const {
    return is(json::value_t::object) && value_->contains(key);
  }

  /// Returns the value of an object under a key, or its absence; the text of the key has to outlive it.
  [[nodiscard]] JsonCursor operator[](std::string_view key) const {
    require(is(json::value_t::object), "an object");
    const auto member = value_->find(key);
    return member == value_->end() ? JsonCursor(*scene_, *value_, key) : JsonCursor(*scene_, *member);
  }

  /// Returns an element of an array that with_size has checked.
  [[nodiscard]] JsonCursor operator[](std::size_t index) const { return {*scene_, (*value_)[index]}; }

  /// Calls visit(cursor) for each element of an array.
  void each_element(auto&& visit) const {
    require(is(json::value_t::array), "an array");
    for (const json& element : *value_) visit(JsonCursor(*scene_, element));
  }

  /// Refuses all but an array of the given size, naming what is `allowed`; returns the cursor itself.
  const JsonCursor& with_size(std::size_t size, std::string_view allowed) const {
    require(is(json::value_t::array) && value_->size() == size, allowed);
    return *this;
  }

  /// Calls visit(key, cursor) for each member of an object.
  void each_member(const auto& visit) const {
    require(is(json::value_t::object), "an object");
    for (const auto& member : value_->items()) visit(member.key(), JsonCursor(*scene_, member.value()));
  }

  // ---- Numbers.

  [[nodiscard]] double number(std::string_view allowed = "a number") const {
    require(exists() && value_->is_number(), allowed);
    return value_->get<double>();
  }

  [[nodiscard]] double number_above_0() const {
    using limits = std::numeric_limits<double>;
    return number_between(limits::denorm_min(), limits::max(), "a number greater than 0");
  }

  /// Returns a coordinate: a number that places something (magnitude.hpp).
  [[nodiscard]] double coordinate(std::string_view allowed = "a number") const {
    const double x = number(allowed);
    if (!is_coordinate(x)) refuse(std::string(allowed).append(" ").append(coordinate_rule));
    return x;
  }

  /// Returns a size: a number that measures something (magnitude.hpp).
  [[nodiscard]] double size() const {
    const double x = number_above_0();
    if (!is_size(x)) refuse(std::string("a number ").append(size_rule));
    return x;
  }

  [[nodiscard]] double number_between(double min, double max, std::string_view allowed) const {
    const double x = number(allowed);
    require(min <= x && x <= max, allowed);
    return x;
  }

  /// Returns a factor on light, rounded to float, in which light is computed; hence a factor that is 0 in
  /// float is 0 at once.
  [[nodiscard]] double factor() const {
    return double{static_cast<float>(
        number_between(0, std::numeric_limits<float>::max(), "a number from 0 to 3.4e38"))};
  }

  /// Returns a length that a camera is made of. A determinant of a camera is a product of three lengths: with
  /// these limits it is from 1e-300 to 1e300, which double holds as normal numbers (2.3e-308 to 1.7e308).
  [[nodiscard]] double camera_length() const {
    return number_between(1e-100, 1e100, "a number from 1e-100 to 1e100");
  }

  [[nodiscard]] int whole_number(int min, int max) const {
    const std::string allowed = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
    const double x = number_between(min, max, allowed);
    require(x == std::floor(x), allowed);
    return static_cast<int>(x);
  }

  /// Returns a whole number of 64 binary digits. One with a point or an exponent is a double.
  [[nodiscard]] std::uint64_t whole_word() const {
    constexpr std::string_view allowed = "a whole number from 0 to 18446744073709551615";
    if (exists() && value_->is_number_unsigned()) return value_->get<std::uint64_t>();
    const double x = number_between(0, 0x1.fffffffffffffp63, allowed);
    require(x == std::floor(x), allowed);
    return static_cast<std::uint64_t>(x);
  }

  // ---- Vectors and colors.

  [[nodiscard]] Vec3 vector() const {
    const JsonCursor xyz = with_size(3, "a vector, an array of three numbers");
    return {xyz[0].number(), xyz[1].number(), xyz[2].number()};
  }

  /// Returns a vector of coordinates (magnitude.hpp).
  [[nodiscard]] Point point() const {
    const Point p = vector();
    if (!is_coordinate(p)) refuse(std::string("a vector of numbers ").append(coordinate_rule));
    return p;
  }

  /// Returns the vector in the file, which may have any length but 0; if it is very short or long, another
  /// one in its direction, whose square is in the range of double.
  [[nodiscard]] Vec3 direction_of_any_length() const {
    const Vec3 v = vector();
    require(v != Vec3{0}, "a direction, a vector that is not 0");
    return of_moderate_size(v);
  }

  /// Returns the unit vector along the one in the file.
  [[nodiscard]] Vec3 direction() const {
    const Vec3 v = direction_of_any_length();
    return v / length(v);
  }

  /// Returns a color; `or_else` tells in messages what else is allowed in its place.
  [[nodiscard]] Color color(const char* or_else = "") const {
    const JsonCursor rgb =
        with_size(3, std::string("a color, an array of three numbers from 0 to 3.4e38") + or_else);
    return Color(Vec3{rgb[0].factor(), rgb[1].factor(), rgb[2].factor()});
  }

  // ---- Words.

  [[nodiscard]] bool is(std::string_view word) const {
    return is(json::value_t::string) && value_->get_ref<const std::string&>() == word;
  }

  [[nodiscard]] const std::string& text(std::string_view allowed) const {
    require(is(json::value_t::string), allowed);
    return value_->get_ref<const std::string&>();
  }

  /// Returns the file of a path that is relative to the folder of the scene. Refuses all but regular files: a
  /// pipe may have no end, or never begin, and a device may do anything when it is opened.
  [[nodiscard]] NamedFile named_file() const {
    namespace fs = std::filesystem;
    constexpr std::string_view allowed = "the path of a file";
    const std::string& name = text(allowed);
    // The system would take a zero byte for the end.
    require(!name.empty() && name.find('\0') == std::string::npos, allowed);
    const fs::path folder = fs::path(scene_->tree.file).parent_path(), path = folder / name;
    const auto resolved = [&](const fs::path& of) {
      std::error_code error;
      const fs::path canonical = fs::canonical(of, error);
      if (error)
        say(found() + " is not possible: cannot read '" + beginning(of.string(), 200) +
            "': " + error.message());
      return canonical;
    };
    const fs::path canonical = resolved(path);
    if (options().confine) {
      const fs::path inside = resolved(folder.empty() ? fs::path(".") : folder);
      if (std::mismatch(inside.begin(), inside.end(), canonical.begin(), canonical.end()).first !=
          inside.end())
        refuse("inside of the scene's folder: it is '" + canonical.string() + "', and the folder '" +
               inside.string() + "'");
    }
    std::error_code unknown;
    if (!fs::is_regular_file(canonical, unknown))
      say(found() + " is not possible: '" + path.string() + "' is not a regular file");
    return {.path = path, .canonical = canonical};
  }

  /// Returns the second member of the pair whose first is the text in the file; refuses other texts.
  /// `or_else` tells in messages what else is allowed.
  template <class T>
  [[nodiscard]] T one_of(const std::vector<std::pair<std::string_view, T>>& pairs,
                         std::string_view or_else = {}) const {
    std::vector<std::string> names;
    for (const auto& [name, meaning] : pairs)
      if (is(name)) return meaning;
    for (const auto& [name, meaning] : pairs) names.push_back('"' + std::string(name) + '"');
    if (!or_else.empty()) names.emplace_back(or_else);
    refuse(list_of(names, " or "));
  }

  /// Returns make(), which makes an object of the library; its exceptions become a SceneError about this
  /// value, except std::bad_alloc.
  auto checked(const auto& make) const {
    try {
      return make();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      say(found() + " is not possible: " + error.what());
    }
  }

 private:
  JsonCursor(const SceneText& scene, const json& value, std::string_view absent = {})
      : scene_(&scene), value_(&value), absent_(absent) {}

  [[nodiscard]] bool exists() const { return !absent_.data(); }

  [[noreturn]] void say(const std::string& what) const { scene_->tree.refuse(*value_, what, absent_); }

  void require(bool holds, std::string_view allowed) const {
    if (!holds) refuse(allowed);
  }

  /// Returns the value as JSON writes it, shortened so that it can be read at a glance.
  [[nodiscard]] std::string found() const {
    if (!exists()) return "nothing";
    if (value_->is_structured() && value_->size() > 100)
      return "an array or object of " + std::to_string(value_->size()) + " values";
    std::string text;
    append(text, *value_);
    return beginning(text);
  }

  /// Appends a value as JSON writes it, or the beginning of a long one, of at least 64 bytes.
  static void append(std::string& text, const json& value) {
    constexpr std::size_t enough = 64;
    if (value.is_string()) {
      const json beginning = value.get_ref<const std::string&>().substr(0, 2 * enough);
      text += beginning.dump(-1, ' ', false, json::error_handler_t::replace);  // a character may be cut
      return;
    }
    if (value.is_primitive()) {
      text += value.dump();
      return;
    }
    text += value.is_array() ? '[' : '{';
    const char* separator = "";
    for (auto it = value.begin(); it != value.end() && text.size() <= enough; ++it) {
      text += std::exchange(separator, ",");
      if (value.is_object()) append(text, json(it.key())), text += ':';
      append(text, *it);
    }
    text += value.is_array() ? ']' : '}';
  }

  const SceneText* scene_;
  const json* value_;          ///< the value, or the object in which an absent value is missing
  std::string_view absent_{};  ///< key of an absent value; null for one that exists
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
