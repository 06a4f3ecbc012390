// Stores a JSON text as a tree in one sequence, each value before those inside of it, through nlohmann_json's
// parser. Freeing it takes no memory and no stack, unlike that of nlohmann::json, whose destructor allocates
// and thus ends the program if memory has run out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
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
inline std::string step(std::string_view key) {
  std::string text = "/";
  for (const char c : beginning(std::string(key)))
    text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
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
  enum class Kind : std::uint8_t { null, no, yes, integer, natural, real, text, array, object };

  [[nodiscard]] Kind kind(Node node) const { return values_[node].kind; }
  [[nodiscard]] bool is_number(Node node) const {
    return Kind::integer <= kind(node) && kind(node) <= Kind::real;
  }
  [[nodiscard]] double number(Node node) const {
    return kind(node) == Kind::integer   ? static_cast<double>(values_[node].integer)
           : kind(node) == Kind::natural ? static_cast<double>(values_[node].natural)
                                         : values_[node].real;
  }
  [[nodiscard]] std::string_view text(Node node) const {
    return std::string_view(texts_).substr(values_[node].range.begin, values_[node].range.size);
  }

  /// Returns the node that follows a value and all values inside of it.
  [[nodiscard]] Node behind(Node node) const {
    return kind(node) == Kind::array || kind(node) == Kind::object ? values_[node].end : node + 1;
  }

  /// Calls visit(node) for each element of an array, and for each key of an object, a text that the key's
  /// value follows.
  void each_in(Node node, auto&& visit) const {
    const Node to_value = kind(node) == Kind::object ? 1 : 0;
    for (Node in = node + 1; in != behind(node); in = behind(in + to_value)) visit(in);
  }

  /// Returns the number of elements of an array, or of members of an object.
  [[nodiscard]] std::size_t size(Node node) const {
    std::size_t count = 0;
    each_in(node, [&](Node) { ++count; });
    return count;
  }

  /// Returns the JSON pointer to a value; or to the next one, while the text is read.
  [[nodiscard]] std::string pointer_to(Node node) const {
    std::string pointer;
    for (Node at = 0; at < node;) {
      const Node to_value = kind(at) == Kind::object ? 1 : 0;
      std::size_t index = 0;
      Node in = at + 1;
      for (; in + to_value < node && behind(in + to_value) <= node; in = behind(in + to_value)) ++index;
      pointer += to_value != 0 ? step(text(in)) : step(index);
      at = in + to_value;
    }
    return pointer;
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
  struct Value {
    Kind kind = Kind::null;
    union {
      std::int64_t integer;
      std::uint64_t natural;
      double real;
      Range range;  ///< for a text
      Node end;     ///< for an array or object: behind(); the largest number while it is read
    };
  };
  static_assert(sizeof(Value) == 16);

  /// Appends a value as JSON to a text, until the text is too long to be shown.
  void write(Node node, std::string& text) const {
    constexpr std::size_t most = 64;
    if (is_number(node)) {
      text += (kind(node) == Kind::integer   ? json(values_[node].integer)
               : kind(node) == Kind::natural ? json(values_[node].natural)
                                             : json(values_[node].real))
                  .dump();
    } else if (kind(node) == Kind::text) {
      text += json(beginning(std::string(this->text(node).substr(0, most + 1)), most)).dump();
    } else if (kind(node) < Kind::integer) {
      text += kind(node) == Kind::null ? "null" : kind(node) == Kind::yes ? "true" : "false";
    } else {
      const bool is_object = kind(node) == Kind::object;
      const std::size_t begin = text.size();
      each_in(node, [&](Node in) {
        if (text.size() > most) return;
        text += text.size() == begin ? "" : ",";
        write(in, text);
        if (is_object) write(in + 1, text += ':');
      });
      text.insert(begin, 1, is_object ? '{' : '[') += is_object ? '}' : ']';
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

  bool null() { return add({.kind = Kind::null, .natural = 0}); }
  bool boolean(bool value) { return add({.kind = value ? Kind::yes : Kind::no, .natural = 0}); }
  bool number_integer(std::int64_t value) { return add({.kind = Kind::integer, .integer = value}); }
  bool number_unsigned(std::uint64_t value) { return add({.kind = Kind::natural, .natural = value}); }
  bool number_float(double value, const std::string&) { return add({.kind = Kind::real, .real = value}); }
  bool string(std::string& value) { return add(text(value)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // JSON has no binary values

  bool start_object(std::size_t) { return open(Kind::object); }
  bool start_array(std::size_t) { return open(Kind::array); }
  bool end_array() {
    tree_.values_[open_.back()].end = size();
    open_.pop_back();
    return true;
  }
  bool end_object() {
    const Node object = open_.back();
    end_array();
    refuse_repeated_keys(object);
    return true;
  }

  /// Adds a key, which does not count as a value.
  bool key(std::string& name) {
    tree_.values_.push_back(text(name));
    return true;
  }

  bool parse_error(std::size_t, const std::string& token, const nlohmann::detail::exception& error) const {
    if (dynamic_cast<const json::out_of_range*>(&error))
      refuse_next(beginning(token) + " is not a number that a double holds, up to 1.8e308");
    // "[its name] parse error at line 1, column 2: ... last read: ..."
    const std::string what = error.what();
    throw SceneError(shown(file_ + ": " + beginning(what.substr(what.find("] ") + 2), 240)));
  }

 private:
  using Kind = JsonTree::Kind;
  using Node = JsonTree::Node;
  using Value = JsonTree::Value;

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
      refuse_next("there are more than the " + std::to_string(most_values) +
                  " values that are allowed in a file");
    tree_.values_.push_back(value);
    return true;
  }

  bool open(Kind kind) {
    if (open_.size() == most_open_)
      refuse_next("there are " + std::to_string(most_open_ + 1) +
                  " arrays and objects inside each other; at most " + std::to_string(most_open_) +
                  " are allowed");
    open_.push_back(size());
    return add({.kind = kind, .end = std::numeric_limits<Node>::max()});
  }

  /// Throws SceneError if a key is repeated in an object.
  void refuse_repeated_keys(Node object) {
    keys_.clear();
    tree_.each_in(object, [&](Node key) { keys_.push_back(key); });
    std::sort(keys_.begin(), keys_.end(),
              [&](Node a, Node b) { return std::pair(tree_.text(a), a) < std::pair(tree_.text(b), b); });
    const auto same = [&](Node a, Node b) { return tree_.text(a) == tree_.text(b); };
    const auto repeated = std::adjacent_find(keys_.begin(), keys_.end(), same);
    if (repeated != keys_.end())
      refuse(file_, tree_.pointer_to(*repeated + 1), "the key is there twice; once is allowed");
  }

  [[noreturn]] void refuse_next(const std::string& what) const {
    refuse(file_, tree_.pointer_to(size()), what);
  }

  JsonTree& tree_;
  const std::string& file_;
  std::size_t most_open_, count_ = 0;
  std::vector<Node> open_;  ///< arrays and objects whose end has not come
  std::vector<Node> keys_;  ///< keys of the object that ends
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
