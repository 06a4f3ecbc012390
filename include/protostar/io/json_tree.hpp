// Reads a JSON text into a tree, through nlohmann_json, within limits that keep it in memory.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// Largest number of values in a scene file, and as many keys. A million spheres have 12 million.
inline constexpr std::size_t most_values = std::size_t{1} << 24;

/// Searches for a value in another; if it is there, returns true and appends the way to it to the pointer.
inline bool find(const json& value, const json& from, json::json_pointer& pointer) {
  if (&value == &from) return true;
  if (!from.is_structured()) return false;
  for (const auto& inside : from.items()) {
    pointer.push_back(inside.key());
    if (find(value, inside.value(), pointer)) return true;
    pointer.pop_back();
  }
  return false;
}

/// Returns a JSON pointer that fits into a line; a very long one keeps its first and last steps.
inline std::string abridged(const std::string& pointer) {
  constexpr std::size_t most = 300, end = 120;
  if (pointer.size() <= most) return pointer;
  const std::size_t from = pointer.find('/', pointer.size() - end);
  return beginning(pointer, end) + pointer.substr(from < pointer.size() ? from : pointer.size());
}

/// Values of a JSON text, with the name of its file, which stay where they are as long as the tree exists.
struct JsonTree {
  std::string file;
  json root = {};

  explicit JsonTree(std::string name) : file(std::move(name)) {}
  JsonTree(const JsonTree&) = delete;
  JsonTree& operator=(const JsonTree&) = delete;
  ~JsonTree() { clear(root); }

  /// Throws SceneError about a value, or about one that is missing in an object under the key `absent`.
  [[noreturn]] void refuse(const json& value, const std::string& what, std::string_view absent = {}) const {
    json::json_pointer place;
    find(value, root, place);
    if (absent.data()) place.push_back(std::string(absent));
    const std::string pointer = place.to_string();
    throw SceneError(shown(file + ": " + (pointer.empty() ? "the whole" : abridged(pointer)) + ": " + what));
  }

 private:
  /// Frees what is inside of a value. The destructor of nlohmann::json takes memory for that, and ends the
  /// program if there is none.
  static void clear(json& value) noexcept {
    for (json& inside : value)
      if (inside.is_structured()) clear(inside);
    value.clear();
  }
};

/// Handler of the events of nlohmann's parser that fills an empty tree. It refuses a repeated key, which the
/// parser would let pass, deep nesting, and too many values, which no scene has.
class JsonBuilder {
 public:
  /// Takes the largest number of arrays and objects inside each other.
  JsonBuilder(JsonTree& tree, std::size_t most_open) : tree_(tree), most_open_(most_open) {}

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) { return add(value); }
  bool number_float(double value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(json::binary_t&) { return false; }  // JSON has no binary values

  bool start_object(std::size_t) { return open(json::value_t::object); }
  bool start_array(std::size_t) { return open(json::value_t::array); }
  bool end_object() { return end_array(); }
  bool end_array() {
    open_.pop_back();
    return true;
  }

  bool key(std::string& name) {
    const auto [member, is_new] = open_.back()->emplace(std::move(name), nullptr);
    if (!is_new) tree_.refuse(*member, "the key is there twice; once is allowed");
    member_ = &*member;
    return true;
  }

  bool parse_error(std::size_t, const std::string& token, const nlohmann::detail::exception& error) {
    if (dynamic_cast<const json::out_of_range*>(&error))
      tree_.refuse(next(), beginning(token) + " is not a number that a double holds, up to 1.8e308");
    // "[its name] parse error at line 1, column 2: ... last read: ..."
    const std::string what = error.what();
    throw SceneError(shown(tree_.file + ": " + beginning(what.substr(what.find("] ") + 2), 240)));
  }

 private:
  /// Returns the place of the next value.
  json& next() {
    json& place = !open_.empty() && open_.back()->is_array() ? open_.back()->emplace_back() : *member_;
    if (++count_ > most_values)
      tree_.refuse(place, "there are more than the " + std::to_string(most_values) +
                              " values that are allowed in a file");
    return place;
  }

  bool add(json&& value) {
    next() = std::move(value);
    return true;
  }

  bool open(json::value_t type) {
    json& value = next();
    if (open_.size() == most_open_)
      tree_.refuse(value, "there are " + std::to_string(most_open_ + 1) +
                              " arrays and objects inside each other; at most " + std::to_string(most_open_) +
                              " are allowed");
    value = type;
    open_.push_back(&value);
    return true;
  }

  JsonTree& tree_;
  std::size_t most_open_, count_ = 0;
  json* member_ = &tree_.root;  ///< place of the next value, if that is not in an array
  std::vector<json*> open_;     ///< arrays and objects whose end has not come
};

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
