// Fields that are put together at run time, as those of scene files.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "../bounds.hpp"
#include "../exact/field_point.hpp"
#include "operations.hpp"
#include "planar.hpp"
#include "shapes.hpp"

namespace protostar::inline PROTOSTAR_ABI::fields {

/// Planar shape of any type, held as a value.
class PlanarField {
 public:
  using Shape = std::variant<Circle, Rectangle, Polygon>;

  /// Holds a planar shape. Throws std::invalid_argument if it is not valid.
  template <class S>
  requires(std::constructible_from<Shape, S> && !std::same_as<S, PlanarField>) PlanarField(S shape)
      : shape_(std::move(shape)) {
    validate_each(std::get<S>(shape_));
  }

  template <class T>
  [[nodiscard]] T operator()(const Vec2<T>& p) const {
    return std::visit([&p](const auto& shape) -> T { return shape(p); }, shape_);
  }
  [[nodiscard]] PlanarBounds bounds(double level = 0) const {
    return std::visit([level](const auto& shape) { return shape.bounds(level); }, shape_);
  }

  /// Returns the number of shapes that an evaluation counts as: one for each corner of a polygon, and 1 for
  /// other shapes.
  [[nodiscard]] std::size_t size() const {
    const auto* const polygon = std::get_if<Polygon>(&shape_);
    return polygon != nullptr ? polygon->corners().size() : 1;
  }

 private:
  Shape shape_;
};

/// Shape or operation of fields/, held as a value: a tree of them is a field like any other, and is evaluated
/// with all number types by the functions of its shapes and operations. Copies share the tree, which never
/// changes.
class Field {
 public:
  /// Largest depth of a tree, and largest size.
  static constexpr int most_depth = 64;
  static constexpr std::size_t most_nodes = 4096;

  struct Node;

  /// Holds a shape, or an operation on fields of type Field. Throws std::invalid_argument if it is not valid,
  /// or the tree is too deep or too large.
  template <class S>
  requires(!std::same_as<S, Field>) Field(S shape);

  template <class T>
  [[nodiscard]] T operator()(const FieldPoint<T>& p) const;

  /// Returns a box that contains all points where the field is at most `level` ≥ 0, but for roundings;
  /// infinite if there is none.
  [[nodiscard]] Bounds bounds(double level = 0) const;

  /// Returns the number of shapes and operations on the way from the root to the farthest shape.
  [[nodiscard]] int depth() const { return depth_; }

  /// Returns the number of shapes and operations that an evaluation takes. A repeated field counts once for
  /// each copy, metaballs once for each ball, a sponge once for each level, a polygon once for each corner.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  /// Adds a field that is a part of this one to depth and size. An evaluation of this field takes `times` of
  /// the part.
  void add_part(const Field& part, std::size_t times) {
    depth_ = std::max(depth_, part.depth_ + 1);
    size_ += times * part.size_;  // at most 1024 · 4096 for each, and a list has as many as memory holds
  }

  std::shared_ptr<const Node> node_;
  int depth_ = 1;
  std::size_t size_ = 1;
};

/// Shape or operation at a node of the tree.
struct Field::Node {
  using Shape = std::variant<Sphere, Plane, Box, RoundedBox, Torus, Cylinder, Cone, Capsule, Ellipsoid,
                             Octahedron, GabrielsHorn, Gyroid, MengerSponge, Metaballs, Extruded<PlanarField>,
                             Revolved<PlanarField>, JoinedList<Smaller, Field>, JoinedList<Larger, Field>,
                             JoinedList<Without, Field>, JoinedList<SmoothlySmaller, Field>, Shell<Field>,
                             Rounded<Field>, Moved<Field>, Rotated<Field>, Scaled<Field>, Twisted<Field>,
                             Bent<Field>, Mirrored<Field>, Repeated<Field>>;
  Shape shape;
};

template <class S>
requires(!std::same_as<S, Field>) Field::Field(S shape) {
  validate_each(shape);
  if constexpr (requires { shape.fields; })
    for (const Field& part : shape.fields) add_part(part, 1);
  else if constexpr (requires { shape.copies(); })
    add_part(shape.field, static_cast<std::size_t>(shape.copies()));
  else if constexpr (requires {
                       { shape.field() } -> std::same_as<const Field&>;
                     })
    add_part(shape.field(), 1);
  else if constexpr (requires {
                       { shape.field } -> std::same_as<Field&>;
                     })
    add_part(shape.field, 1);
  else if constexpr (requires { shape.field.size(); })
    size_ += shape.field.size();
  else if constexpr (requires { shape.balls; })
    size_ = shape.balls.size();
  else if constexpr (requires { shape.levels; })
    size_ += static_cast<std::size_t>(shape.levels);
  if (depth_ > most_depth)
    throw std::invalid_argument("Field: the tree is " + std::to_string(depth_) +
                                " shapes and operations deep; at most " + std::to_string(most_depth) +
                                " are allowed");
  if (size_ > most_nodes)
    throw std::invalid_argument("Field: an evaluation takes " + std::to_string(size_) +
                                " shapes and operations; at most " + std::to_string(most_nodes) +
                                " are allowed");
  constexpr bool is_held = std::constructible_from<Node::Shape, S>;
  static_assert(is_held,
                "Field: the type is neither a shape of fields/ nor an operation of fields/ on fields "
                "of type Field, such as Moved<Field>");
  if constexpr (is_held) node_ = std::make_shared<const Node>(Node{std::move(shape)});
}

template <class T>
T Field::operator()(const FieldPoint<T>& p) const {
  return std::visit([&p](const auto& shape) -> T { return shape(p); }, node_->shape);
}

inline Bounds Field::bounds(double level) const {
  return std::visit([level](const auto& shape) { return shape.bounds(level); }, node_->shape);
}

}  // namespace protostar::inline PROTOSTAR_ABI::fields
