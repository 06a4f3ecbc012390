// The fields of scene files: their values, and the message for each kind of error.
#include <cmath>
#include <nlohmann/json.hpp>
#include <protostar/fields/field.hpp>
#include <protostar/io/json_scene.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/scene_files.hpp"

using namespace protostar;
using fields::Field;
using nlohmann::json;

namespace {

std::string surface_of_field(const std::string& field, const std::string& rest = "") {
  return R"({"type": "field", "field": )" + field + rest + "}";
}

const std::string any_box = R"(, "bounds": {"min": [-1, -1, -1], "max": [1, 1, 1]})";

/// Returns the error of a scene with a field, without the name of the file and the pointer to its surface.
std::string field_error(const std::string& field, const std::string& rest = "") {
  const std::string error = scene_error(with_surface(surface_of_field(field, rest)));
  const std::string before = "scene.json: /objects/0/surface";
  return error.starts_with(before) ? error.substr(before.size()) : error;
}

/// Returns a field in a number of others, each of which rounds it.
std::string rounded(const std::string& field, int times) {
  std::string begin, end;
  for (int i = 0; i < times; ++i) begin += R"({"type": "round", "radius": 0.01, "field": )", end += "}";
  return begin + field + end;
}

const std::string ball_field = R"({"type": "sphere", "radius": 0.5})";

std::string union_of_balls(int count) {
  std::string fields = ball_field;
  for (int i = 1; i < count; ++i) fields += "," + ball_field;
  return R"({"type": "union", "fields": [)" + fields + "]}";
}

}  // namespace

TEST_CASE("a field of a scene file is the field that the library makes of the same numbers") {
  const AnySurface surface = only_surface(surface_of_field(
      R"({"type": "difference", "fields": [
            {"type": "twist", "rate": 30, "field": {"type": "box", "size": [1, 2, 1]}},
            {"type": "translate", "by": [0, 1, 0], "field": {"type": "torus", "radius": 0.5, "tube": 0.125}}]})"));
  const auto* const marched = surface.target<Marched<Field>>();
  REQUIRE(marched != nullptr);
  const Field expected = fields::JoinedList<fields::Without, Field>{
      {fields::Twisted<Field>{fields::Box{{1, 2, 1}}, 30},
       fields::Moved<Field>{fields::Torus{0.5, 0.125}, {0, 1, 0}}}};
  for (const Point& p : {Point{0.1, 0.2, 0.3}, Point{0.5, 1, 0.1}, Point{-0.4, -0.9, 0.4}})
    CHECK(plain_value(marched->field(), p) == plain_value(expected, p));
}

TEST_CASE("a ray hits a field of a scene file where it is 0, and its bounds cut it") {
  const Ray down{{0.25, 5, 0}, {0, -1, 0}};
  const auto t_of = [&](const std::string& surface) { return only_surface(surface).intersect(down); };
  const auto t = t_of(surface_of_field(R"({"type": "cylinder", "radius": 1, "height": 3})"));
  REQUIRE(t);
  CHECK(std::abs(*t - 3.5) <= 0x1p-29);
  const auto plane =
      t_of(surface_of_field(R"({"type": "plane", "normal": [0, 2, 0], "distance": 0.5})", any_box));
  REQUIRE(plane);
  CHECK(std::abs(*plane - 4.5) <= 0x1p-29);
  CHECK(!t_of(surface_of_field(R"({"type": "plane", "normal": [0, 2, 0], "distance": 1.5})", any_box)));
}

TEST_CASE("a wrong field is reported with its place, what was found and what is allowed") {
  struct Row {
    std::string error, expected;
  };
  const std::string sizes = "from 2^-400 (3.9e-121) to 2^400 (2.6e120)", size = "a number " + sizes,
                    above_0 = "a number greater than 0";
  for (
      const auto& [error, expected] : std::vector<Row>{
          {field_error(R"({"type": "sphere", "radius": 0})"), "/field/radius: 0 is not " + above_0},
          {field_error(R"({"type": "sphere", "radius": -1})"), "/field/radius: -1 is not " + above_0},
          {field_error(R"({"type": "sphere", "radius": 1e-300})"), "/field/radius: 1e-300 is not " + size},
          {field_error(R"({"type": "sphere", "radius": "1"})"), "/field/radius: \"1\" is not " + above_0},
          {field_error(R"({"type": "sphere"})"), "/field/radius: nothing is not " + above_0},
          {field_error(R"({"type": "sphere", "radius": 1, "center": [0, 0, 0]})"),
           "/field/center: is not a key here; allowed are type and radius"},
          {field_error("3"), "/field: 3 is not an object"},
          {field_error(R"({"type": "sphere", "radius": 1e999})"),
           "/field/radius: 1e999 is not a number that a double holds, up to 1.8e308"},
          {field_error(R"({"type": "union", "fields": []})"),
           "/field/fields: [] is not an array of at least one field"},
          {field_error(R"({"type": "union", "fields": [)" + ball_field +
                       R"(, {"type": "shell", "thickness": 0, "field": )" + ball_field + "}]}"),
           "/field/fields/1/thickness: 0 is not " + above_0},
          {field_error(R"({"type": "box", "size": [1, 0, 1]})"), "/field/size/1: 0 is not " + above_0},
          {field_error(R"({"type": "box", "size": 1})"),
           "/field/size: 1 is not an array of three numbers greater than 0"},
          {field_error(R"({"type": "rounded-box", "size": [1, 1, 1], "radius": 0.75})"),
           "/field/radius: 0.75 is not possible: fields::RoundedBox: radius must be at most half the "
           "shortest side; "
           "it is 0.75"},
          {field_error(R"({"type": "horn", "end": 1, "thickness": 0.1})"),
           "/field/end: 1 is not a number greater than 1, where the mouth of the horn is"},
          {field_error(R"({"type": "sponge", "size": 1, "levels": 13})"),
           "/field/levels: 13 is not a whole number from 0 to 12"},
          {field_error(R"({"type": "metaballs", "balls": []})"),
           "/field/balls: [] is not an array of at least one ball"},
          {field_error(
               R"({"type": "metaballs", "sharpness": 101, "balls": [{"position": [0, 0, 0], "radius": 1}]})"),
           "/field/sharpness: 101 is not a number greater than 0, and at most 100"},
          {field_error(R"({"type": "extrusion", "height": 1, "shape": {"type": "star"}})"),
           R"(/field/shape/type: "star" is not "circle", "rectangle" or "polygon")"},
          {field_error(
               R"({"type": "extrusion", "height": 1, "shape": {"type": "polygon", "corners": [[0,0],[0,1],[1,0]]}})"),
           "/field/shape/corners: [[0,0],[0,1],[1,0]] is not possible: fields::Polygon: corners must be "
           "three or "
           "more of a convex polygon, counterclockwise"},
          {field_error(R"({"type": "repeat", "step": [1, 0, 0], "count": [40, 40, 1], "field": )" +
                       ball_field + "}"),
           "/field/count: [40,40,1] is not possible: fields::Repeated: count must be above 0 along each "
           "axis, and 1024 in all at most; it is (40, 40, 1)"},
          {field_error(R"({"type": "scale", "factor": 0, "field": )" + ball_field + "}"),
           "/field/factor: 0 is not " + above_0},
          {field_error(R"({"type": "plane", "normal": [0, 1, 0], "distance": 0})"),
           "/bounds: nothing is not min and max of a box; a field that has no bounds of its own, or none "
           "within 2^400 (2.6e120), needs them"},
          {field_error(R"({"type": "mirror", "cell": [1, 0, 0], "field": )" + ball_field + "}"),
           "/bounds: nothing is not min and max of a box; a field that has no bounds of its own, or none "
           "within 2^400 (2.6e120), needs them"},
          {field_error(ball_field, R"(, "bounds": {"min": [0, 0, 0], "max": [1, 0, 1]})"),
           "/bounds/max: [1,0,1] is not greater than min in each of its numbers, by " + sizes},
          {field_error(ball_field, R"(, "bounds": {"min": [0, 0, -2e120], "max": [1, 1, 2e120]})"),
           "/bounds/max: [1,1,2e+120] is not greater than min in each of its numbers, by " + sizes},
          {field_error(R"({"type": "sphere", "radius": 2e120})"),
           R"(/field: {"radius":2e+120,"type":"sphere"} is not a field with points inside of its surface, and )"
           "bounds with sides " +
               sizes},
          {field_error(ball_field, R"(, "bounds": {"min": [0, 0, 0]})"),
           "/bounds/max: nothing is not a vector, an array of three numbers"}}) {
    CAPTURE(expected);
    CHECK(error == expected);
  }
  CHECK_THAT(field_error(R"({"type": "blob", "radius": 1})"),
             Catch::Matchers::StartsWith(R"(/field/type: "blob" is not "sphere", "plane", "box")"));
}

TEST_CASE("a field of a scene file may be 64 deep and take 4096 shapes and operations") {
  CHECK(field_error(rounded(ball_field, 63)) == "");
  CHECK_THAT(field_error(rounded(ball_field, 64)),
             ContainsSubstring("is not possible here: at most 64 fields"));
  CHECK(field_error(union_of_balls(4095)) == "");
  CHECK_THAT(field_error(union_of_balls(4096)),
             Catch::Matchers::EndsWith(
                 "is not possible: Field: an evaluation takes 4097 shapes and operations; at most 4096 are "
                 "allowed"));
}

TEST_CASE("an integrator of fields is refused for a scene that lacks what it needs, with the reason") {
  const auto error_of = [](const std::string& integrator, const std::string& surface,
                           const std::string& material, const json& farthest = nullptr) {
    json scene = json::parse(with_surface(surface));
    scene["settings"]["integrator"] = integrator;
    if (!farthest.is_null()) scene["settings"]["occlusion-distance"] = farthest;
    scene["objects"][0].erase("color");
    scene["objects"][0]["material-id"] = "only";
    scene["materials"]["only"][material] = {1, 1, 1};
    return scene_error(scene.dump());
  };
  const auto refused = [](const std::string& integrator, const std::string& why) {
    return R"(scene.json: /settings/integrator: ")" + integrator + R"(" is not possible: )" + why;
  };
  const std::string
      field = surface_of_field(ball_field),
      diffuse = "diffuse", emits = "emission",
      moves = surface_of_field(ball_field, R"(, "velocity": [0, 0, 1])"),
      board = R"({"type": "parallelogram", "position": [0, 0, 3], "edges": [[1, 0, 0], [0, 1, 0]]})";
  const std::string no_march =
      "no surface of the scene is marched with a proof, so that there is nothing to show; surfaces of "
      "distance fields are";
  const std::string no_distance =
      "surface 0 of the scene, counted from 0 in the order of its types, tells no distance; marched "
      "surfaces, boxes, spheres and planes do, and surfaces with double distance_bound(const Point&) const";
  for (const std::string integrator : {"evaluations", "enclosure-width", "distance-shadow"})
    CHECK(error_of(integrator, field, diffuse) == "");
  CHECK(error_of("distance-occlusion", field, diffuse, 1) == "");
  CHECK(error_of("distance-shadow", ball_in_json, emits) == "");
  CHECK(error_of("distance-occlusion", board, emits, 1) == "");
  CHECK(error_of("evaluations", ball_in_json, diffuse) == refused("evaluations", no_march));
  CHECK(error_of("enclosure-width", board, diffuse) == refused("enclosure-width", no_march));
  CHECK(error_of("distance-shadow", board, diffuse) == refused("distance-shadow", no_distance));
  CHECK(error_of("distance-shadow", board, emits) ==
        refused("distance-shadow",
                "surfaces that emit light must be spheres that do not move; another is in the scene"));
  CHECK(error_of("distance-occlusion", moves, diffuse, 1) == refused("distance-occlusion", no_distance));
  CHECK(error_of("distance-occlusion", field, diffuse) ==
        refused("distance-occlusion", "the settings have no occlusion-distance"));
  CHECK(scene_of_text(scene_with("/settings/occlusion-distance", "2")).occlusion_distance == 2);
  CHECK(error_of("distance-occlusion", field, diffuse, 0) ==
        "scene.json: /settings/occlusion-distance: 0 is not a number greater than 0");
  CHECK_THAT(bytes_of(std::string(PROTOSTAR_SOURCE_DIR) + "/docs/scene-format.md"),
             ContainsSubstring("render: " + error_of("evaluations", ball_in_json, diffuse) + "\n"));
}
