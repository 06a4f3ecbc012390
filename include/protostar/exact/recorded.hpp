// Fields written down: a number type that keeps the operations of a field in place of numbers.
//
//   FieldTape tape;
//   tape.record([](const auto& p) { return length(p) - 1.0; });
//   // x, y, z, length, constant, difference, result
//
// A field has no branches that depend on values, since its number types have no comparisons (plain.hpp). So
// one call writes down all that it ever does, and another program can evaluate it, in any arithmetic.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "field_point.hpp"

namespace protostar::inline PROTOSTAR_ABI {

class Recorded;

/// List of the operations of a field, each after those whose results it takes.
class FieldTape {
 public:
  /// Operation by its name, the indices of its operands, and a number.
  ///
  /// Without operands: "x", "y", "z", the coordinates of the point, and "constant". With one: "minus", "abs",
  /// "square", "sqrt", "fold", "wrap", "sin", "cos", "exp", "log", and "result", the value of the field. With
  /// two: "sum", "difference", "product", "quotient", "min", "max", "smooth_min". With one or more: "length".
  struct Operation {
    std::string_view name;
    std::vector<std::size_t> of;  ///< indices of the operations whose results it takes
    double number = 0;            ///< value of a constant, width k of a smooth minimum, otherwise 0
  };

  /// Writes down a field, once for each tape. The first operations are x, y and z, and the last is "result".
  /// Those between stand as a walk from the result through the operands meets them, from left to right, so
  /// that their order depends on no compiler: C++ leaves open which of a function's arguments is computed
  /// first. What the result does not take is dropped. Throws std::logic_error if the tape has a field
  /// already.
  void record(const auto& field);

  [[nodiscard]] const std::vector<Operation>& operations() const { return operations_; }

 private:
  friend class Recorded;

  std::size_t add(std::string_view name, std::vector<std::size_t> of, double number = 0) {
    operations_.push_back({name, std::move(of), number});
    return operations_.size() - 1;
  }

  /// Puts the operations in the order that record() promises.
  void put_in_order() {
    constexpr std::size_t open = static_cast<std::size_t>(-1);
    std::vector<std::size_t> position(operations_.size(), open);  // of each operation in the new order
    std::vector<Operation> ordered;
    const auto append = [&](std::size_t i) {
      for (std::size_t& operand : operations_[i].of) operand = position[operand];
      position[i] = ordered.size();
      ordered.push_back(std::move(operations_[i]));
    };
    for (std::size_t i = 0; i < 3; ++i) append(i);
    std::vector<std::size_t> way = {operations_.size() - 1};  // from the result, operand by operand
    while (!way.empty()) {
      const std::size_t i = way.back();
      const std::vector<std::size_t>& of = operations_[i].of;
      const auto next =
          std::find_if(of.begin(), of.end(), [&](std::size_t k) { return position[k] == open; });
      if (next != of.end()) {
        way.push_back(*next);
      } else {
        way.pop_back();
        append(i);
      }
    }
    operations_ = std::move(ordered);
  }

  std::vector<Operation> operations_;
};

/// Number type that writes operations down: the result of an operation on the tape that this thread writes,
/// or a constant that is not on the tape yet. Operations are allowed only inside of FieldTape::record.
class Recorded {
 public:
  Recorded() = default;
  Recorded(double number) : number_(number) {}

  friend Recorded operator-(const Recorded& a) { return of("minus", a); }
  friend Recorded operator+(const Recorded& a, const Recorded& b) { return of("sum", a, b); }
  friend Recorded operator-(const Recorded& a, const Recorded& b) { return of("difference", a, b); }
  friend Recorded operator*(const Recorded& a, const Recorded& b) { return of("product", a, b); }
  friend Recorded operator/(const Recorded& a, const Recorded& b) { return of("quotient", a, b); }
  friend Recorded min(const Recorded& a, const Recorded& b) { return of("min", a, b); }
  friend Recorded max(const Recorded& a, const Recorded& b) { return of("max", a, b); }
  friend Recorded abs(const Recorded& a) { return of("abs", a); }
  friend Recorded square(const Recorded& a) { return of("square", a); }
  friend Recorded sqrt(const Recorded& a) { return of("sqrt", a); }
  friend Recorded fold(const Recorded& a) { return of("fold", a); }
  friend Recorded wrap(const Recorded& a) { return of("wrap", a); }
  friend Recorded sin(const Recorded& a) { return of("sin", a); }
  friend Recorded cos(const Recorded& a) { return of("cos", a); }
  friend Recorded exp(const Recorded& a) { return of("exp", a); }
  friend Recorded log(const Recorded& a) { return of("log", a); }
  friend Recorded smooth_min(const Recorded& a, const Recorded& b, double k) {
    return written("smooth_min", {a.index(), b.index()}, k);
  }

  template <std::size_t n>
  friend Recorded length_of(const Recorded (&v)[n]) {
    std::vector<std::size_t> all;
    for (const Recorded& x : v) all.push_back(x.index());
    return written("length", std::move(all));
  }
  template <std::size_t n>
  friend Recorded signed_length_of(const Recorded (&q)[n]) {
    Recorded outside[n], largest = q[0];
    for (std::size_t i = 0; i < n; ++i) outside[i] = max(q[i], 0.0);
    for (std::size_t i = 1; i < n; ++i) largest = max(largest, q[i]);
    return length_of(outside) + min(largest, 0.0);
  }

 private:
  friend class FieldTape;

  static Recorded written(std::string_view name, std::vector<std::size_t> of, double number = 0) {
    Recorded result;
    result.index_ = tape_->add(name, std::move(of), number), result.is_written_ = true;
    return result;
  }
  static Recorded of(std::string_view name, const auto&... operands) {
    return written(name, {operands.index()...});
  }

  /// Returns the operation; writes down a constant first.
  [[nodiscard]] std::size_t index() const {
    return is_written_ ? index_ : tape_->add("constant", {}, number_);
  }

  static inline thread_local FieldTape* tape_ = nullptr;

  bool is_written_ = false;
  std::size_t index_ = 0;
  double number_ = 0;
};

void FieldTape::record(const auto& field) {
  if (!operations_.empty()) throw std::logic_error("FieldTape: a tape records one field");
  struct Restored {
    FieldTape* before;
    ~Restored() { Recorded::tape_ = before; }
  };
  const Restored restored{std::exchange(Recorded::tape_, this)};  // also if the field throws
  const Recorded x = Recorded::of("x"), y = Recorded::of("y"), z = Recorded::of("z");
  const Recorded value = field(FieldPoint<Recorded>{x, y, z});
  add("result", {value.index()});
  put_in_order();
}

}  // namespace protostar::inline PROTOSTAR_ABI
