// Reads and checks the values of a scene file, and names the path of a wrong one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "../magnitude.hpp"
#include "../numeric/scale.hpp"
#include "../vec3.hpp"
#include "json_tree.hpp"
#include "read_options.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Returns the names as a list: "a, b and c".
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

struct LoadedFiles;

/// Scene file that is being read.
struct SceneText {
  std::string file;  ///< its path, for messages and for the folder of the files that it names
  ReadOptions options = {};
  LoadedFiles* loaded = nullptr;  ///< files that the scene names, as far as they are loaded
  JsonTree tree = {};
};

/// File that a scene names.
struct NamedFile {
  std::filesystem::path path;       ///< from the program's working directory, for messages and to be opened
  std::filesystem::path canonical;  ///< without links, the same for all names that lead to the file
};

class JsonElements;

/// Value in a scene file, or the absence of one, with the path to it. All that is read from it is checked;
/// errors are thrown as SceneError.
class JsonCursor {
 public:
  using Node = JsonTree::Node;

  /// Points to the root value of a file, which has to outlive the cursor.
  explicit JsonCursor(const SceneText& scene) : scene_(&scene), node_(0) {}

  [[noreturn]] void refuse(const std::string& allowed) const { say(found() + " is not " + allowed); }

  [[noreturn]] void refuse_beside(const std::string& other) const {
    say(found() + " is not possible beside " + other);
  }

  [[nodiscard]] const ReadOptions& options() const { return scene_->options; }
  [[nodiscard]] LoadedFiles& loaded() const { return *scene_->loaded; }

  // ---- Objects and arrays.

  /// Refuses all but an object without other keys than these; returns the cursor itself.
  const JsonCursor& with_keys(const std::vector<std::string>& allowed) const {
    require(is_object(), "an object");
    for (Node key = tree().first(node_); key != tree().behind(node_); key = tree().behind(key + 1))
      if (std::find(allowed.begin(), allowed.end(), tree().text(key)) == allowed.end())
        detail::refuse(scene_->file, pointer() + step(std::string(tree().text(key))),
                       "is not a key here; allowed are " + list_of(allowed));
    return *this;
  }

  [[nodiscard]] bool is_object() const { return exists() && tree().is_object(node_); }
  [[nodiscard]] bool is_array() const { return exists() && tree().is_array(node_); }
  [[nodiscard]] bool has(const std::string& key) const { return is_object() && find(key) != none; }

  /// Returns the value of an object under a key, or its absence.
  [[nodiscard]] JsonCursor operator[](const std::string& key) const {
    require(is_object(), "an object");
    return {*this, step(key), find(key)};
  }

  /// Returns the elements of an array, each as a cursor of its own.
  [[nodiscard]] JsonElements elements() const;

  /// Returns the elements of an array of the given size; refuses other values, naming what is `allowed`.
  [[nodiscard]] JsonElements elements(std::size_t size, const std::string& allowed) const;

  /// Calls visit(key, cursor) for each member of an object.
  void each_member(const auto& visit) const {
    require(is_object(), "an object");
    for (Node key = tree().first(node_); key != tree().behind(node_); key = tree().behind(key + 1)) {
      const std::string name(tree().text(key));
      visit(name, JsonCursor(*this, step(name), key + 1));
    }
  }

  // ---- Numbers.

  [[nodiscard]] double number(const std::string& allowed = "a number") const {
    require(exists() && tree().is_number(node_), allowed);
    return tree().number(node_);
  }

  [[nodiscard]] double number_above_0() const {
    const std::string allowed = "a number greater than 0";
    const double x = number(allowed);
    require(x > 0, allowed);
    return x;
  }

  /// Returns a coordinate: a number that places something (magnitude.hpp).
  [[nodiscard]] double coordinate(const std::string& allowed = "a number") const {
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

  [[nodiscard]] double number_between(double min, double max, const std::string& allowed) const {
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

  // ---- Vectors and colors.

  [[nodiscard]] Vec3 vector() const;

  /// Returns a vector of coordinates (magnitude.hpp).
  [[nodiscard]] Point point() const {
    const Point p = vector();
    if (!is_coordinate(p)) refuse(std::string("a vector of numbers ").append(coordinate_rule));
    return p;
  }

  /// Returns the unit vector along the one in the file.
  [[nodiscard]] Vec3 direction() const {
    const Vec3 v = vector();
    require(v != Vec3{0}, "a direction, a vector that is not 0");
    const Vec3 near_one = scaled(v, -exponent_of({v}));  // squares neither overflow nor underflow
    return near_one / length(near_one);
  }

  [[nodiscard]] Color color() const;

  // ---- Words.

  [[nodiscard]] bool is(std::string_view word) const {
    return exists() && tree().is_text(node_) && tree().text(node_) == word;
  }

  [[nodiscard]] std::string text(const std::string& allowed) const {
    require(exists() && tree().is_text(node_), allowed);
    return std::string(tree().text(node_));
  }

  /// Returns the file of a path that is relative to the folder of the scene. Refuses all but regular files: a
  /// pipe may have no end, or never begin, and a device may do anything when it is opened.
  [[nodiscard]] NamedFile named_file() const {
    namespace fs = std::filesystem;
    const std::string allowed = "the path of a file", name = text(allowed);
    require(name.find('\0') == std::string::npos, allowed);  // the system would take it for the end
    const fs::path folder = fs::path(scene_->file).parent_path(), path = folder / name;
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
  template <class Pairs>
  [[nodiscard]] auto one_of(const Pairs& pairs) const {
    std::vector<std::string> names;
    for (const auto& [name, meaning] : pairs) names.push_back('"' + std::string(name) + '"');
    const std::string allowed = list_of(names, " or "), found = text(allowed);
    for (const auto& [name, meaning] : pairs)
      if (name == found) return meaning;
    refuse(allowed);
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
  friend class JsonElements;

  static constexpr Node none = std::numeric_limits<Node>::max();

  /// Path to a value: its last step, and its parent's path, which all values inside of the parent share.
  struct Way {
    std::shared_ptr<const Way> to_parent;
    std::string last_step;
  };

  JsonCursor(const JsonCursor& parent, const std::string& last_step, Node node)
      : scene_(parent.scene_), way_(std::make_shared<const Way>(Way{parent.way_, last_step})), node_(node) {}

  [[nodiscard]] const JsonTree& tree() const { return scene_->tree; }
  [[nodiscard]] bool exists() const { return node_ != none; }

  /// Returns the node of an object's value under a key; `none` if there is none.
  [[nodiscard]] Node find(std::string_view key) const {
    for (Node in = tree().first(node_); in != tree().behind(node_); in = tree().behind(in + 1))
      if (tree().text(in) == key) return in + 1;
    return none;
  }

  [[nodiscard]] std::string pointer() const {
    std::vector<const Way*> steps;
    for (const Way* way = way_.get(); way; way = way->to_parent.get()) steps.push_back(way);
    std::string text;
    for (auto way = steps.rbegin(); way != steps.rend(); ++way) text += (*way)->last_step;
    return text;
  }

  [[noreturn]] void say(const std::string& what) const { detail::refuse(scene_->file, pointer(), what); }

  void require(bool holds, const std::string& allowed) const {
    if (!holds) refuse(allowed);
  }

  /// Returns the value as JSON writes it, shortened so that it can be read at a glance.
  [[nodiscard]] std::string found() const {
    if (!exists()) return "nothing";
    if ((is_array() || is_object()) && tree().size(node_) > 100)
      return "an array or object of " + std::to_string(tree().size(node_)) + " values";
    return tree().beginning_of(node_);
  }

  const SceneText* scene_;
  std::shared_ptr<const Way> way_;  ///< null for the root
  Node node_;                       ///< `none` for an absent value
};

/// Range of the elements of an array. Cursors are made on access, since there may be millions.
class JsonElements {
 public:
  explicit JsonElements(JsonCursor array) : array_(std::move(array)) {}

  class Iterator {
   public:
    Iterator(const JsonCursor& array, JsonTree::Node node) : array_(&array), node_(node) {}
    [[nodiscard]] JsonCursor operator*() const { return {*array_, step(index_), node_}; }
    Iterator& operator++() {
      node_ = array_->tree().behind(node_);
      ++index_;
      return *this;
    }
    [[nodiscard]] bool operator!=(const Iterator& other) const { return node_ != other.node_; }

   private:
    const JsonCursor* array_;
    JsonTree::Node node_;
    std::size_t index_ = 0;
  };

  [[nodiscard]] Iterator begin() const { return {array_, array_.tree().first(array_.node_)}; }
  [[nodiscard]] Iterator end() const { return {array_, array_.tree().behind(array_.node_)}; }

  /// Returns the i-th element in O(i) steps, for short arrays.
  [[nodiscard]] JsonCursor operator[](std::size_t i) const {
    Iterator at = begin();
    for (; i > 0; --i) ++at;
    return *at;
  }

 private:
  JsonCursor array_;
};

inline JsonElements JsonCursor::elements() const {
  require(is_array(), "an array");
  return JsonElements(*this);
}

inline JsonElements JsonCursor::elements(std::size_t size, const std::string& allowed) const {
  require(is_array() && tree().size(node_) == size, allowed);
  return elements();
}

inline Vec3 JsonCursor::vector() const {
  const auto xyz = elements(3, "a vector, an array of three numbers");
  return {xyz[0].number(), xyz[1].number(), xyz[2].number()};
}

inline Color JsonCursor::color() const {
  const auto rgb = elements(3, "a color, an array of three numbers from 0 to 3.4e38");
  return Color(Vec3{rgb[0].factor(), rgb[1].factor(), rgb[2].factor()});
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail
