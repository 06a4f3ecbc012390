// Stores a JSON text as a tree in one sequence, each value before those inside of it, through nlohmann_json's
// parser. Freeing it takes no memory and no stack, unlike that of nlohmann::json, whose destructor allocates
// and thus ends the program if memory has run out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../shown.hpp"
#include "text.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Error in a scene file: file name, place, the value found and the values allowed.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

namespace detail {

using nlohmann::json;

/// Largest size of a scene file, in bytes. A million spheres take half of it.
inline constexpr std::size_t most_bytes = std::size_t{1} << 28;

/// Largest number of values in a scene file, of 16 bytes each, and as many keys. A million spheres have 12
/// million.
inline constexpr std::size_t most_values = std::size_t{1} << 24;

/// Returns one step of a JSON pointer (RFC 6901).
inline std::string step(const std::string& key) {
  std::string text = "/";
  for (const char c : beginning(key)) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}
inline std::string step(std::size_t index) { return "/" + std::to_string(index); }

/// Returns a JSON pointer that fits into a line; a very long one keeps its first and last steps.
inline std::string abridged(const std::string& pointer) {
  constexpr std::size_t most = 300, end = 120;
  if (pointer.size() <= most) return pointer;
  const std::size_t from = pointer.find('/', pointer.size() - end);
  return beginning(pointer, end) + pointer.substr(from < pointer.size() ? from : pointer.size());
}

[[noreturn]] inline void refuse(const std::string& file, const std::string& pointer,
                                const std::string& what) {
  throw SceneError(shown(file + ": " + (pointer.empty() ? "the whole" : abridged(pointer)) + ": " + what));
}

/// Values of a JSON text by their numbers. The root is number 0.
class JsonTree {
 public:
  using Node = std::uint32_t;
  enum class Kind : std::uint8_t { null, boolean, integer, natural, real, text, array, object };

  [[nodiscard]] Kind kind(Node node) const { return values_[node].kind; }
  [[nodiscard]] bool is_object(Node node) const { return kind(node) == Kind::object; }
  [[nodiscard]] bool is_array(Node node) const { return kind(node) == Kind::array; }
  [[nodiscard]] bool is_text(Node node) const { return kind(node) == Kind::text; }
  [[nodiscard]] bool is_number(Node node) const {
    return kind(node) == Kind::integer || kind(node) == Kind::natural || kind(node) == Kind::real;
  }

  /// Returns the number of elements of an array, or of members of an object.
  [[nodiscard]] std::size_t size(Node node) const { return values_[node].inside.count; }

  /// Returns the first value of an array, or the first key of an object, a text whose value comes next.
  [[nodiscard]] Node first(Node node) const { return node + 1; }

  /// Returns the node that follows a value and all values inside of it.
  [[nodiscard]] Node behind(Node node) const {
    return is_array(node) || is_object(node) ? values_[node].inside.end : node + 1;
  }

  [[nodiscard]] double number(Node node) const {
    const Value& value = values_[node];
    return kind(node) == Kind::integer   ? static_cast<double>(value.integer)
           : kind(node) == Kind::natural ? static_cast<double>(value.natural)
                                         : value.real;
  }

  [[nodiscard]] std::string_view text(Node node) const {
    const Value& value = values_[node];
    return std::string_view(texts_).substr(value.range.begin, value.range.size);
  }

  /// Returns a value as JSON writes it, shortened so that it can be read at a glance.
  [[nodiscard]] std::string beginning_of(Node node) const {
    std::string text;
    write(node, text);
    return beginning(text);
  }

 private:
  friend class JsonBuilder;

  struct Range {
    std::uint32_t begin, size;
  };
  struct Inside {
    Node end;
    std::uint32_t count;
  };
  struct Value {
    Kind kind = Kind::null;
    union {
      bool boolean;
      std::int64_t integer;
      std::uint64_t natural;
      double real;
      Range range;    ///< for a text
      Inside inside;  ///< for an array or object
    };
  };
  static_assert(sizeof(Value) == 16);

  /// Appends a value as JSON to a text, until the text is too long to be shown.
  void write(Node node, std::string& text) const {
    constexpr std::size_t most = 64;
    const Value& value = values_[node];
    switch (kind(node)) {
      case Kind::null:
        text += "null";
        break;
      case Kind::boolean:
        text += value.boolean ? "true" : "false";
        break;
      case Kind::integer:
        text += std::to_string(value.integer);
        break;
      case Kind::natural:
        text += std::to_string(value.natural);
        break;
      case Kind::real:
        text += json(value.real).dump();
        break;
      case Kind::text:
        text += json(beginning(std::string(this->text(node).substr(0, most + 1)), most)).dump();
        break;
      case Kind::array:
      case Kind::object:
        text += is_array(node) ? '[' : '{';
        for (Node in = first(node); in != behind(node) && text.size() <= most; in = behind(in)) {
          if (in != first(node)) text += ',';
          write(in, text);
          if (is_array(node)) continue;
          text += ':';
          write(++in, text);
        }
        text += is_array(node) ? ']' : '}';
    }
  }

  std::deque<Value> values_;  // a deque grows without copying them
  std::string texts_;
};

/// Handler of the events of nlohmann's parser that builds a JsonTree. It refuses a repeated key, which the
/// parser would let pass, deep nesting, and too many values, which no scene has.
class JsonBuilder {
 public:
  /// Takes an empty tree; most_open is the largest number of arrays and objects inside each other.
  JsonBuilder(JsonTree& tree, const std::string& file, std::size_t most_open)
      : tree_(tree), file_(file), most_open_(most_open) {}

  bool null() { return add({.kind = Kind::null, .boolean = false}); }
  bool boolean(bool value) { return add({.kind = Kind::boolean, .boolean = value}); }
  bool number_integer(std::int64_t value) { return add({.kind = Kind::integer, .integer = value}); }
  bool number_unsigned(std::uint64_t value) { return add({.kind = Kind::natural, .natural = value}); }
  bool number_float(double value, const std::string&) { return add({.kind = Kind::real, .real = value}); }
  bool string(std::string& value) { return add(text(value)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // JSON has no binary values

  bool start_object(std::size_t) { return open(Kind::object); }
  bool start_array(std::size_t) { return open(Kind::array); }
  bool end_object() {
    refuse_repeated_keys();
    return end_array();
  }
  bool end_array() {
    tree_.values_[open_.back().node].inside.end = size();
    open_.pop_back();
    return true;
  }

  /// Adds a key, which does not count as a value.
  bool key(std::string& name) {
    open_.back().key = size();
    tree_.values_.push_back(text(name));
    return true;
  }

  bool parse_error(std::size_t, const std::string& token, const nlohmann::detail::exception& error) const {
    if (dynamic_cast<const json::out_of_range*>(&error))
      refuse(file_, pointer(), beginning(token) + " is not a number that a double holds, up to 1.8e308");
    // "[its name] parse error at line 1, column 2: ... last read: ..."
    const std::string what = error.what();
    throw SceneError(shown(file_ + ": " + beginning(what.substr(what.find("] ") + 2), 240)));
  }

 private:
  using Kind = JsonTree::Kind;
  using Node = JsonTree::Node;
  using Value = JsonTree::Value;

  /// Array or object whose end has not come, and for an object the key that came last.
  struct Open {
    Node node, key;
  };

  [[nodiscard]] Node size() const { return static_cast<Node>(tree_.values_.size()); }

  /// Stores a text. All texts together are no longer than the file, whose size fits into 32 bits.
  Value text(const std::string& value) {
    const std::size_t begin = tree_.texts_.size();
    tree_.texts_ += value;
    return {.kind = Kind::text,
            .range = {.begin = static_cast<std::uint32_t>(begin),
                      .size = static_cast<std::uint32_t>(value.size())}};
  }

  bool add(const Value& value) {
    if (++count_ > most_values)
      refuse(file_, pointer(),
             "there are more than the " + std::to_string(most_values) + " values that are allowed in a file");
    tree_.values_.push_back(value);
    if (!open_.empty()) ++tree_.values_[open_.back().node].inside.count;
    return true;
  }

  bool open(Kind kind) {
    if (open_.size() == most_open_)
      refuse(file_, pointer(),
             "there are " + std::to_string(most_open_ + 1) +
                 " arrays and objects inside each other; at most " + std::to_string(most_open_) +
                 " are allowed");
    add({.kind = kind, .inside = {.end = 0, .count = 0}});
    open_.push_back({.node = size() - 1, .key = size()});
    return true;
  }

  /// Throws SceneError if a key is repeated in the object that ends.
  void refuse_repeated_keys() {
    keys_.clear();
    for (Node key = open_.back().node + 1; key != size(); key = tree_.behind(key + 1)) keys_.push_back(key);
    std::sort(keys_.begin(), keys_.end(),
              [&](Node a, Node b) { return std::pair(tree_.text(a), a) < std::pair(tree_.text(b), b); });
    const auto same = [&](Node a, Node b) { return tree_.text(a) == tree_.text(b); };
    const auto repeated = std::adjacent_find(keys_.begin(), keys_.end(), same);
    if (repeated == keys_.end()) return;
    open_.back().key = *repeated;
    refuse(file_, pointer(), "the key is there twice; once is allowed");
  }

  /// Returns the JSON pointer to the next value.
  [[nodiscard]] std::string pointer() const {
    std::string way;
    for (const Open& in : open_) {
      const bool is_innermost = &in == &open_.back();
      way += tree_.is_object(in.node) ? step(std::string(tree_.text(in.key)))
                                      : step(tree_.size(in.node) - (is_innermost ? 0 : 1));
    }
    return way;
  }

  JsonTree& tree_;
  const std::string& file_;
  std::size_t most_open_, count_ = 0;
  std::vector<Open> open_;
  std::vector<Node> keys_;  ///< keys of the object that ends
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
