// Reads the distance fields of a scene file.
//
// To add a shape or an operation, write a function that reads one, beside sphere_field_at, and add a row to
// field_types; Field::Node has a list of what a field may hold.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../bounds.hpp"
#include "../fields/field.hpp"
#include "../magnitude.hpp"
#include "../vec3.hpp"
#include "json_cursor.hpp"
#include "json_tree.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Place of a field in a tree of fields that is being read.
struct FieldCursor {
  JsonCursor at;
  int depth = 1;  ///< 1 at the root

  /// Refuses keys other than these and "type"; returns the value itself.
  [[nodiscard]] const JsonCursor& with_keys(std::vector<std::string_view> allowed) const {
    allowed.insert(allowed.begin(), "type");
    return at.with_keys(allowed);
  }
};

fields::Field field_at(const FieldCursor& cursor);

/// Returns the field under the key "field".
inline fields::Field part_of(const FieldCursor& cursor) {
  return field_at({cursor.at["field"], cursor.depth + 1});
}

/// Returns the vector of a value whose numbers are sizes.
inline Vec3 sizes_at(const JsonCursor& at) {
  const JsonCursor xyz = at.with_size(3, "an array of three numbers greater than 0");
  return {xyz[0].size(), xyz[1].size(), xyz[2].size()};
}

// ---- Shapes.

inline fields::Field sphere_field_at(const FieldCursor& cursor) {
  return fields::Sphere{cursor.with_keys({"radius"})["radius"].size()};
}

inline fields::Field plane_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"normal", "distance"});
  return fields::Plane{at["normal"].direction(), at["distance"].coordinate()};
}

inline fields::Field box_field_at(const FieldCursor& cursor) {
  return fields::Box{sizes_at(cursor.with_keys({"size"})["size"])};
}

inline fields::Field rounded_box_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"size", "radius"});
  const fields::RoundedBox box{sizes_at(at["size"]), at["radius"].size()};
  at["radius"].checked([&] { box.validate(); });
  return box;
}

inline fields::Field torus_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"radius", "tube"});
  return fields::Torus{at["radius"].size(), at["tube"].size()};
}

/// Reads a shape that has a radius and a height.
template <class Shape>
fields::Field upright_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"radius", "height"});
  return Shape{at["radius"].size(), at["height"].size()};
}

inline fields::Field ellipsoid_field_at(const FieldCursor& cursor) {
  return fields::Ellipsoid{sizes_at(cursor.with_keys({"radii"})["radii"])};
}

inline fields::Field octahedron_field_at(const FieldCursor& cursor) {
  return fields::Octahedron{cursor.with_keys({"radius"})["radius"].size()};
}

inline fields::Field horn_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"end", "thickness"});
  const double end = at["end"].size();
  if (!(end > 1)) at["end"].refuse("a number greater than 1, where the mouth of the horn is");
  return fields::GabrielsHorn{end, at["thickness"].size()};
}

inline fields::Field gyroid_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"cell", "thickness"});
  return fields::Gyroid{at["cell"].size(), at["thickness"].size()};
}

inline fields::Field sponge_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"size", "levels"});
  return fields::MengerSponge{at["size"].size(),
                              at["levels"].whole_number(0, fields::MengerSponge::most_levels)};
}

inline fields::Field metaballs_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"balls", "sharpness"});
  fields::Metaballs metaballs;
  if (at.has("sharpness")) {
    metaballs.sharpness = at["sharpness"].size();
    if (!(metaballs.sharpness <= fields::Metaballs::most_sharpness))
      at["sharpness"].refuse("a number greater than 0, and at most 100");
  }
  at["balls"].each_element([&](const JsonCursor& ball) {
    ball.with_keys({"position", "radius"});
    metaballs.balls.push_back({ball["position"].point(), ball["radius"].size()});
  });
  if (metaballs.balls.empty()) at["balls"].refuse("an array of at least one ball");
  return metaballs;
}

// ---- Planar shapes, and the solids that they make.

/// Returns the vector of an array of two numbers, each of which read(cursor) returns.
inline Uv pair_at(const JsonCursor& at, std::string_view allowed, const auto& read) {
  const JsonCursor xy = at.with_size(2, allowed);
  return {read(xy[0]), read(xy[1])};
}

inline fields::PlanarField planar_field_at(const JsonCursor& at) {
  enum class Kind { circle, rectangle, polygon };
  switch (at["type"].one_of<Kind>(
      {{"circle", Kind::circle}, {"rectangle", Kind::rectangle}, {"polygon", Kind::polygon}})) {
    case Kind::circle:
      return fields::Circle{at.with_keys({"type", "radius"})["radius"].size()};
    case Kind::rectangle:
      return fields::Rectangle{pair_at(at.with_keys({"type", "size"})["size"],
                                       "an array of two numbers greater than 0",
                                       [](const JsonCursor& side) { return side.size(); })};
    case Kind::polygon:
      break;
  }
  std::vector<Uv> corners;
  at.with_keys({"type", "corners"})["corners"].each_element([&](const JsonCursor& corner) {
    corners.push_back(pair_at(corner, "an array of two numbers",
                              [](const JsonCursor& number) { return number.coordinate(); }));
  });
  return at["corners"].checked([&] { return fields::Polygon(std::move(corners)); });
}

inline fields::Field extrusion_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"shape", "height"});
  return fields::Extruded<fields::PlanarField>{planar_field_at(at["shape"]), at["height"].size()};
}

inline fields::Field revolution_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"shape", "radius"});
  return fields::Revolved<fields::PlanarField>{planar_field_at(at["shape"]),
                                               at.has("radius") ? at["radius"].coordinate() : 0};
}

// ---- Operations.

inline std::vector<fields::Field> parts_of(const FieldCursor& cursor) {
  std::vector<fields::Field> parts;
  const JsonCursor fields = cursor.at["fields"];
  fields.each_element([&](const JsonCursor& part) { parts.push_back(field_at({part, cursor.depth + 1})); });
  if (parts.empty()) fields.refuse("an array of at least one field");
  return parts;
}

/// Reads fields that are joined by a rule without numbers.
template <class Rule>
fields::Field joined_field_at(const FieldCursor& cursor) {
  static_cast<void>(cursor.with_keys({"fields"}));
  return fields::JoinedList<Rule, fields::Field>{parts_of(cursor)};
}

inline fields::Field smooth_union_field_at(const FieldCursor& cursor) {
  const double width = cursor.with_keys({"fields", "width"})["width"].size();
  return fields::JoinedList<fields::SmoothlySmaller, fields::Field>{parts_of(cursor), {width}};
}

inline fields::Field shell_field_at(const FieldCursor& cursor) {
  const double thickness = cursor.with_keys({"field", "thickness"})["thickness"].size();
  return fields::Shell<fields::Field>{part_of(cursor), thickness};
}

inline fields::Field round_field_at(const FieldCursor& cursor) {
  const double radius = cursor.with_keys({"field", "radius"})["radius"].size();
  return fields::Rounded<fields::Field>{part_of(cursor), radius};
}

inline fields::Field translate_field_at(const FieldCursor& cursor) {
  const Vec3 by = cursor.with_keys({"field", "by"})["by"].point();
  return fields::Moved<fields::Field>{part_of(cursor), by};
}

inline fields::Field rotate_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"field", "axis", "angle"});
  const Vec3 axis = at["axis"].direction();
  return fields::Rotated<fields::Field>(part_of(cursor), axis, at["angle"].number("a number of degrees"));
}

inline fields::Field scale_field_at(const FieldCursor& cursor) {
  const double factor = cursor.with_keys({"field", "factor"})["factor"].size();
  return fields::Scaled<fields::Field>{part_of(cursor), factor};
}

inline fields::Field twist_field_at(const FieldCursor& cursor) {
  const double rate = cursor.with_keys({"field", "rate"})["rate"].coordinate("a number of degrees");
  return fields::Twisted<fields::Field>{part_of(cursor), rate};
}

inline fields::Field bend_field_at(const FieldCursor& cursor) {
  const double rate = cursor.with_keys({"field", "rate"})["rate"].coordinate("a number of degrees");
  return fields::Bent<fields::Field>{part_of(cursor), rate};
}

inline fields::Field mirror_field_at(const FieldCursor& cursor) {
  const JsonCursor xyz =
      cursor.with_keys({"field", "cell"})["cell"].with_size(3, "an array of three numbers");
  Vec3 cell{0};
  for (int k = 0; k < 3; ++k) {
    const JsonCursor side = xyz[static_cast<std::size_t>(k)];
    if (side.number() != 0) cell[k] = side.size();
  }
  return fields::Mirrored<fields::Field>{part_of(cursor), cell};
}

inline fields::Field repeat_field_at(const FieldCursor& cursor) {
  const JsonCursor& at = cursor.with_keys({"field", "step", "count"});
  const Vec3 step = at["step"].point();
  const JsonCursor xyz = at["count"].with_size(3, "an array of three whole numbers");
  constexpr int most = fields::Repeated<fields::Field>::most_copies;
  const auto count = [&](std::size_t k) { return xyz[k].whole_number(1, most); };
  const fields::Repeated<fields::Field> repeated{part_of(cursor), step, {count(0), count(1), count(2)}};
  at["count"].checked([&] { repeated.validate(); });
  return repeated;
}

using FieldReader = fields::Field (*)(const FieldCursor&);

inline const std::vector<std::pair<std::string_view, FieldReader>> field_types{
    {"sphere", sphere_field_at},
    {"plane", plane_field_at},
    {"box", box_field_at},
    {"rounded-box", rounded_box_field_at},
    {"torus", torus_field_at},
    {"cylinder", upright_field_at<fields::Cylinder>},
    {"cone", upright_field_at<fields::Cone>},
    {"capsule", upright_field_at<fields::Capsule>},
    {"ellipsoid", ellipsoid_field_at},
    {"octahedron", octahedron_field_at},
    {"horn", horn_field_at},
    {"gyroid", gyroid_field_at},
    {"sponge", sponge_field_at},
    {"metaballs", metaballs_field_at},
    {"extrusion", extrusion_field_at},
    {"revolution", revolution_field_at},
    {"union", joined_field_at<fields::Smaller>},
    {"intersection", joined_field_at<fields::Larger>},
    {"difference", joined_field_at<fields::Without>},
    {"smooth-union", smooth_union_field_at},
    {"shell", shell_field_at},
    {"round", round_field_at},
    {"translate", translate_field_at},
    {"rotate", rotate_field_at},
    {"scale", scale_field_at},
    {"twist", twist_field_at},
    {"bend", bend_field_at},
    {"mirror", mirror_field_at},
    {"repeat", repeat_field_at},
};

/// Returns the field of a value, with all fields inside it.
inline fields::Field field_at(const FieldCursor& cursor) {
  if (cursor.depth > fields::Field::most_depth)
    cursor.at.refuse("possible here: at most " + std::to_string(fields::Field::most_depth) +
                     " fields are allowed inside each other");
  const FieldReader read = cursor.at["type"].one_of(field_types);
  try {
    return read(cursor);
  } catch (const std::invalid_argument& error) {  // not a SceneError, which names its own place
    cursor.at.refuse(std::string("possible: ") + error.what());
  }
}

/// Returns the box in which a field is drawn: the box in the file, or else the field's own. Its sides are
/// sizes (magnitude.hpp).
inline Bounds bounds_of_field(const JsonCursor& at, const fields::Field& field) {
  const auto has_sizes = [](const Bounds& box) {
    const Vec3 sides = box.max - box.min;
    return is_size(sides.x) && is_size(sides.y) && is_size(sides.z);
  };
  if (at.has("bounds")) {
    const JsonCursor bounds = at["bounds"].with_keys({"min", "max"});
    const Bounds box{bounds["min"].point(), bounds["max"].point()};
    if (!has_sizes(box))
      bounds["max"].refuse(std::string("greater than min in each of its numbers, by ").append(size_rule));
    return box;
  }
  const Bounds own = field.bounds();
  if (!is_coordinate(own.min) || !is_coordinate(own.max))
    at["bounds"].refuse(
        "min and max of a box; a field that has no bounds of its own, or none within 2^400 (2.6e120), needs "
        "them");
  if (!has_sizes(own))
    at["field"].refuse(
        std::string("a field with points inside of its surface, and bounds with sides ").append(size_rule));
  return own;
}

}  // namespace protostar::inline PROTOSTAR_ABI::detail
