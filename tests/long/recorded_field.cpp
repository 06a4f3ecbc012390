// Fields written down (exact/recorded.hpp): evaluated again, the operations give the same bits as the field.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/exact/distance_field.hpp>
#include <protostar/exact/recorded.hpp>
#include <protostar/fields/field.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string_view>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

using PlainDouble = Plain<double>;

/// Evaluates the operations of a tape at a point.
double value_of(const FieldTape& tape, const Point& p) {
  std::vector<PlainDouble> results;
  for (const FieldTape::Operation& operation : tape.operations()) {
    const std::string_view name = operation.name;
    const std::vector<std::size_t>& of = operation.of;
    const auto operand = [&](std::size_t i) { return results.at(of.at(i)); };
    const auto result = [&]() -> PlainDouble {
      if (name == "x") return p.x;
      if (name == "y") return p.y;
      if (name == "z") return p.z;
      if (name == "constant") return operation.number;
      if (name == "result") return operand(0);
      if (name == "minus") return -operand(0);
      if (name == "sum") return operand(0) + operand(1);
      if (name == "difference") return operand(0) - operand(1);
      if (name == "product") return operand(0) * operand(1);
      if (name == "quotient") return operand(0) / operand(1);
      if (name == "min") return min(operand(0), operand(1));
      if (name == "max") return max(operand(0), operand(1));
      if (name == "abs") return abs(operand(0));
      if (name == "square") return square(operand(0));
      if (name == "sqrt") return sqrt(operand(0));
      if (name == "fold") return fold(operand(0));
      if (name == "wrap") return wrap(operand(0));
      if (name == "sin") return sin(operand(0));
      if (name == "cos") return cos(operand(0));
      if (name == "exp") return exp(operand(0));
      if (name == "log") return log(operand(0));
      if (name == "smooth_min") return smooth_min(operand(0), operand(1), operation.number);
      REQUIRE(name == "length");
      if (of.size() == 2) return length(Vec2<PlainDouble>{operand(0), operand(1)});
      return length(FieldPoint<PlainDouble>{operand(0), operand(1), operand(2)});
    };
    results.push_back(result());
  }
  REQUIRE(!tape.operations().empty());
  REQUIRE(tape.operations().back().name == "result");
  return results.back().value;
}

void check_recorded(const auto& field) {
  FieldTape tape;
  tape.record(field);
  Random random(11);
  WrongCases wrong(random);
  for (int i = 0; i < 200; ++i) {
    const Point p(random.real(-3, 3), random.real(-3, 3), random.real(-3, 3));
    wrong.add(value_of(tape, p) != plain_value(field, p), "at", p.x, p.y, p.z);
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("a field that is written down has the same value, with each operation") {
  check_recorded([](const auto& p) { return length(p) - 1.0; });
  check_recorded([](const auto& p) {
    const auto a = square(p.x) + sqrt(abs(p.y)) * -p.z, b = 2.0 / (1.0 + exp(p.x)) - log(2.0 + square(p.z));
    return smooth_min(min(sin(a), cos(b)), max(fold(p.x * 0.7), wrap(p.y)), 0.5);
  });
  check_recorded([](const auto& p) {
    const auto q = abs(p) - Vec3{0.5, 0.75, 1};
    return signed_length(q) - 0.125 * signed_length(Vec2{q.x, q.z});
  });
}

TEST_CASE("a constant of a field is written down where an operation takes it, also two of them") {
  check_recorded([](const auto& p) {
    using Number = std::remove_cvref_t<decltype(p.x)>;
    const Number third = Number(1.0) / Number(3.0), none{};
    return p.x * third + none;
  });
  check_recorded([](const auto& p) {
    using Number = std::remove_cvref_t<decltype(p.x)>;
    return Number(2.5);
  });
}

TEST_CASE("operations are written down in one order, in whatever order a compiler computes arguments") {
  FieldTape left_first, right_first;
  left_first.record([](const auto& p) {
    const auto a = abs(p.x) + p.x, b = p.y * 3.0;
    return max(a, b);
  });
  right_first.record([](const auto& p) {
    [[maybe_unused]] const auto unused = p.z * p.z;
    const auto b = p.y * 3.0;
    const auto a = abs(p.x) + p.x;
    return max(a, b);
  });
  const auto names = [](const FieldTape& tape) {
    std::vector<std::string_view> all;
    for (const auto& operation : tape.operations()) all.push_back(operation.name);
    return all;
  };
  CHECK(names(left_first) ==
        std::vector<std::string_view>{"x", "y", "z", "abs", "sum", "constant", "product", "max", "result"});
  CHECK(names(right_first) == names(left_first));
  for (std::size_t i = 0; i < left_first.operations().size(); ++i)
    CHECK(right_first.operations().at(i).of == left_first.operations().at(i).of);
  CHECK_THROWS_AS(left_first.record([](const auto& p) { return p.x; }), std::logic_error);
}

TEST_CASE("a field that is put together at run time is written down by its shapes") {
  const fields::Field ball = fields::Sphere{0.75}, horn = fields::GabrielsHorn{};
  check_recorded(fields::Field(
      fields::JoinedList<fields::SmoothlySmaller, fields::Field>{{ball, horn, fields::Gyroid{}}, {0.5}}));
  check_recorded(
      fields::Field(fields::Twisted<fields::Field>{fields::Field(fields::MengerSponge{2, 2}), 40}));
}

TEST_CASE("a surface of any type that is marched writes down its field, and any other nothing") {
  const auto ball = [](const auto& p) { return length(p) - 1.0; };
  FieldTape of_surface, of_field, none;
  AnySurface(Marched{ball, Bounds{Point(-1), Point(1)}}).record_field(of_surface);
  of_field.record(ball);
  REQUIRE(of_surface.operations().size() == of_field.operations().size());
  CHECK(value_of(of_surface, {1, 2, 2}) == 2);
  AnySurface(Sphere{{0, 0, 0}, 1}).record_field(none);
  CHECK(none.operations().empty());
}
