// Counts of wrong cases, with the first of them in words.
#pragma once

#include <ostream>
#include <protostar/ray.hpp>
#include <protostar/vec3.hpp>
#include <ranges>
#include <sstream>
#include <string>
#include <type_traits>

#include "random.hpp"

/// Number of cases that are not as they should be, and the first of them in words. CHECK(wrong == 0) shows
/// both.
class WrongCases {
 public:
  WrongCases() = default;

  /// Names the random numbers of which the cases are made: the first wrong one is told with their seed.
  explicit WrongCases(const Random& random) : random_(&random) {}

  /// Counts a case if it is wrong. Words and values tell the first: numbers, vectors, rays, surfaces,
  /// cameras, ranges, and lists of them.
  void add(bool is_wrong, const auto&... values) {
    if (!is_wrong || ++count_ > 1) return;
    std::ostringstream words;
    words.precision(17);  // all digits, so that the case can be put into a test of its own
    if (random_) words << "seed " << random_->seed() << " after " << random_->drawn() << " numbers";
    ((words << ' ', write(words, values)), ...);
    first_ = words.str();
  }

  friend bool operator==(const WrongCases& cases, int count) { return cases.count_ == count; }
  friend std::ostream& operator<<(std::ostream& out, const WrongCases& cases) {
    out << cases.count_;
    return cases.count_ > 0 ? out << " (the first: " << cases.first_ << ')' : out;
  }

 private:
  template <class Value>
  static void write(std::ostream& out, const Value& value) {
    if constexpr (std::is_enum_v<Value>) {
      out << static_cast<int>(value);
    } else if constexpr (std::is_arithmetic_v<Value>) {
      out << +value;  // a small integer too is a number, not a letter
    } else if constexpr (requires { out << value; }) {
      out << value;
    } else if constexpr (requires { value.has_value(); }) {
      if (value) return write(out, *value);
      out << "none";
    } else if constexpr (requires { value.length(), value[0]; }) {
      for (int i = 0; i < value.length(); ++i) out << (i == 0 ? "{" : ", ") << value[i];
      out << '}';
    } else if constexpr (std::ranges::range<Value>) {
      out << '[';
      for (const char* between = ""; const auto& one : value) write(out << between, one), between = ", ";
      out << ']';
    } else {
      write_members(out, value);
    }
  }

  /// Writes what a surface, a ray and the like consist of, each member with its name.
  static void write_members(std::ostream& out, const auto& value) {
    const char* between = "(";
    const auto member = [&](const char* name, const auto& of_value) {
      write(out << between << name << ' ', of_value);
      between = ", ";
    };
    if constexpr (requires { value.origin; }) member("origin", value.origin);
    if constexpr (requires { value.direction; }) member("direction", value.direction);
    if constexpr (requires { value.position; }) member("position", value.position);
    if constexpr (requires { value.right; }) member("right", value.right);
    if constexpr (requires { value.up; }) member("up", value.up);
    if constexpr (requires { value.forward; }) member("forward", value.forward);
    if constexpr (requires { value.film_right; }) member("film_right", value.film_right);
    if constexpr (requires { value.film_up; }) member("film_up", value.film_up);
    if constexpr (requires { value.aperture; }) member("aperture", value.aperture);
    if constexpr (requires { value.focus; }) member("focus", value.focus);
    if constexpr (requires { value.center; }) member("center", value.center);
    if constexpr (requires { value.normal; }) member("normal", value.normal);
    if constexpr (requires { value.distance; }) member("distance", value.distance);
    if constexpr (requires { value.radius; }) member("radius", value.radius);
    if constexpr (requires { value.edge_u; }) member("edge_u", value.edge_u);
    if constexpr (requires { value.edge_v; }) member("edge_v", value.edge_v);
    if constexpr (requires { value.a; }) member("a", value.a);
    if constexpr (requires { value.b; }) member("b", value.b);
    if constexpr (requires { value.c; }) member("c", value.c);
    if constexpr (requires { value.min; }) member("min", value.min);
    if constexpr (requires { value.max; }) member("max", value.max);
    if constexpr (requires { value.squares; }) member("squares", value.squares);
    if constexpr (requires { value.products; }) member("products", value.products);
    if constexpr (requires { value.linear; }) member("linear", value.linear);
    if constexpr (requires { value.constant; }) member("constant", value.constant);
    if constexpr (requires { value.x; }) member("x", value.x);
    if constexpr (requires { value.y; }) member("y", value.y);
    if constexpr (requires { value.z; }) member("z", value.z);
    if constexpr (requires { value.translation; }) member("translation", value.translation);
    if constexpr (requires { value.t; }) member("t", value.t);
    if constexpr (requires { value.primitive; }) member("primitive", value.primitive);
    if constexpr (requires { value.form.squares; }) member("form", value.form);
    if constexpr (requires { value.departure.geometry; }) {
      if (value.departure.kind != protostar::Departure::Kind::none) {
        member("leaving primitive", value.departure.primitive);
        member("of", value.departure.geometry);
      }
    }
    out << ')';
  }

  const Random* random_ = nullptr;
  int count_ = 0;
  std::string first_;
};
