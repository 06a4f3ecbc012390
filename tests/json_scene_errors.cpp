// Scene files that are wrong: the message for each kind of error.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <protostar/io/json_scene.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "fuzz/read_any_bytes.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/scene_files.hpp"

namespace fs = std::filesystem;
using namespace protostar;

namespace {

std::string without(const std::string& pointer) {
  return patched(R"({"op": "remove", "path": ")" + pointer + R"("})");
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

}  // namespace

TEST_CASE("an error in a scene file is reported with its place, what was found and what is allowed") {
  struct Row {
    std::string text, error;
  };
  const std::string
      vector = "a vector, an array of three numbers",
      most = "at most 2^400 (2.6e120) in magnitude", place = "a vector of numbers " + most,
      size = "a number from 2^-400 (3.9e-121) to 2^400 (2.6e120)", number = "a number",
      above_0 = "a number greater than 0", color = "a color, an array of three numbers from 0 to 3.4e38",
      factor = "a number from 0 to 3.4e38", share = "a number from 0 to 1",
      direction = "a direction, a vector that is not 0", side = "a whole number from 1 to 268435456",
      samples = "a whole number from 0 to 65536", depth = "a whole number from 1 to 1000",
      integrators =
          R"("binary", "depth", "normal", "color", "diffuse", "transparency", "shadow", "whitted", "ambient-occlusion", "direct", "path", "distance-occlusion", "distance-shadow", "evaluations" or "enclosure-width")",
      spot_angle = "a number of degrees above 0 and at most 180",
      view_angle = "a number of degrees from 1e-100 to below 180", shininess = "a number of at least 0",
      tone = R"("clip", "scale-pixel" or "scale-image")",
      types =
          R"("sphere", "plane", "parallelogram", "triangle", "mesh", "box", "disk", "quadric", "torus", "csg", "instance" or "field")",
      light =
          "a light: position and power; position and intensity; direction and intensity; "
          "position, direction, angle and power; or ambient";
  // Replaces the value at a pointer by one that is not allowed.
  const auto not_allowed = [](const std::string& pointer, const std::string& value,
                              const std::string& allowed) {
    return Row{replacing(pointer, value), pointer + ": " + value + " is not " + allowed};
  };
  const auto missing = [](const std::string& pointer, const std::string& allowed) {
    return Row{without(pointer), pointer + ": nothing is not " + allowed};
  };
  const auto unknown = [](const std::string& pointer, const std::string& allowed) {
    return Row{scene_with(pointer, "1"), pointer + ": is not a key here; allowed are " + allowed};
  };
  // Replaces a surface by an invalid one.
  const auto surface_row = [](const std::string& surface, const std::string& error) {
    return Row{replacing("/objects/2/surface", surface), "/objects/2/surface" + error};
  };
  // Takes the samples away, and sets an error.
  const auto error_setting = [](const std::string& value) {
    return patched(R"({"op": "remove", "path": "/settings/samples"},
                      {"op": "add", "path": "/settings/error", "value": )" +
                   value + "}");
  };
  const std::string settings_keys =
      "resolution-x, resolution-y, samples, error, sampler, filter, seed, depth, integrator, "
      "occlusion-distance, "
      "transfer, tone and exposure";
  const std::string ids = R"("black", "red" and "squares")";
  const std::vector<Row> rows{
      {"[]", "the whole: [] is not an object"},
      {"3", "the whole: 3 is not an object"},
      unknown("/Settings", "settings, world, camera, objects, lights and materials"),
      missing("/settings", "an object"),
      not_allowed("/settings", "[]", "an object"),
      unknown("/settings/resolution", settings_keys),
      missing("/settings/resolution-x", side),
      missing("/settings/resolution-y", side),
      not_allowed("/settings/resolution-x", "0", side),
      not_allowed("/settings/resolution-x", "-8", side),
      not_allowed("/settings/resolution-x", "8.5", side),
      not_allowed("/settings/resolution-x", "\"8\"", side),
      not_allowed("/settings/resolution-y", "268435457", side),
      not_allowed("/settings/resolution-y", "18446744073709551615", side),
      not_allowed("/settings/samples", "-1", samples),
      not_allowed("/settings/samples", "65537", samples),
      not_allowed("/settings/samples", "true", samples),
      {error_setting("0"), "/settings/error: 0 is not a number greater than 0"},
      {error_setting("\"1\""), "/settings/error: \"1\" is not a number greater than 0"},
      {scene_with("/settings/error", "0.5"), "/settings/error: 0.5 is not possible beside samples"},
      {error_setting("0.5"),
       "/settings/sampler: \"stratified\" is not independent, halton or sobol, which can "
       "tell the error that the settings ask for"},
      {patched(R"({"op": "replace", "path": "/settings/sampler", "value": "hammersley"},)"
               R"({"op": "replace", "path": "/settings/integrator", "value": "path"})"),
       "/settings/sampler: \"hammersley\" is not independent, stratified, halton or sobol: the integrator "
       "path "
       "draws by chance, and hammersley has the same numbers in every pixel and for every seed, so that all "
       "pixels are wrong in the same way and look as if they were right"},
      not_allowed("/settings/sampler", R"("random")",
                  "\"independent\", \"stratified\", \"halton\", \"sobol\" or \"hammersley\""),
      not_allowed("/settings/filter", "3",
                  "\"box\", \"tent\", \"gaussian\", \"mitchell\" or \"blackman-harris\""),
      not_allowed("/settings/seed", "-1", "a whole number from 0 to 18446744073709551615"),
      not_allowed("/settings/seed", "1.5", "a whole number from 0 to 18446744073709551615"),
      not_allowed("/settings/depth", "0", depth),
      not_allowed("/settings/depth", "1001", depth),
      not_allowed("/settings/depth", "1.5", depth),
      not_allowed("/settings/integrator", "\"paths\"", integrators),
      not_allowed("/settings/integrator", "null", integrators),
      not_allowed("/settings/transfer", "\"sRGB\"", R"("srgb", "linear" or {"gamma": G})"),
      not_allowed("/settings/transfer", "2.2", R"("srgb", "linear" or {"gamma": G})"),
      not_allowed("/settings/transfer/gamma", "0", above_0),
      not_allowed("/settings/transfer/gamma", "-1", above_0),
      unknown("/settings/transfer/exponent", "gamma"),
      not_allowed("/settings/tone", "\"none\"", tone),
      not_allowed("/settings/exposure", "-0.5", factor),
      not_allowed("/settings/exposure", "1e+39", factor),
      not_allowed("/world", "[]", "an object"),
      unknown("/world/ground", "sky and environment"),
      not_allowed("/world/sky", "[0,1]", color),
      not_allowed("/world/sky", "0.5", color),
      not_allowed("/world/sky/2", "-0.1", factor),
      not_allowed("/world/sky/0", "1e+39", factor),
      missing("/camera", "an object"),
      unknown("/camera/fov",
              "projection, position, direction, upward, field-of-view, focal-length, aperture, focus, "
              "shutter and velocity"),
      unknown("/camera/ortho-scale",
              "projection, position, direction, upward, field-of-view, focal-length, aperture, focus, "
              "shutter and velocity"),
      missing("/camera/projection", R"("perspective" or "orthographic")"),
      not_allowed("/camera/projection", "\"fisheye\"", R"("perspective" or "orthographic")"),
      missing("/camera/position", vector),
      missing("/camera/direction", vector),
      missing("/camera/upward", vector),
      not_allowed("/camera/position", "[0,0]", vector),
      not_allowed("/camera/position", "[0,0,0,0]", vector),
      not_allowed("/camera/position/1", "\"0\"", number),
      not_allowed("/camera/direction", "[0,0,0]", direction),
      not_allowed("/camera/upward", "[0,0,0]", direction),
      not_allowed("/camera/upward", "[0,1,0.001]",
                  "orthogonal to direction: the cosine between them is at most 1e-6"),
      not_allowed("/camera/field-of-view", "0", view_angle),
      not_allowed("/camera/field-of-view", "180", view_angle),
      not_allowed("/camera/field-of-view", "[90]", view_angle),
      not_allowed("/camera/field-of-view", "1e-130", view_angle),
      missing("/objects", "an array"),
      not_allowed("/objects", "{}", "an array"),
      not_allowed("/objects/0", "1", "an object"),
      unknown("/objects/0/material", "surface, material-id and color"),
      missing("/objects/0/surface", "an object"),
      missing("/objects/0/surface/type", types),
      not_allowed("/objects/0/surface/type", "\"cube\"", types),
      unknown("/objects/0/surface/center", "type, position, radius and velocity"),
      missing("/objects/0/surface/position", vector),
      missing("/objects/0/surface/radius", above_0),
      not_allowed("/objects/0/surface/radius", "0", above_0),
      not_allowed("/objects/0/surface/radius", "-1", above_0),
      not_allowed("/objects/0/surface/radius", "\"1\"", above_0),
      not_allowed("/objects/1/surface/normal", "[0,0,0]", direction),
      missing("/objects/1/surface/distance", number),
      unknown("/objects/1/surface/radius", "type, normal, distance and velocity"),
      missing("/objects/2/surface/edges", "an array of two vectors"),
      not_allowed("/objects/2/surface/edges", "[[1,0,0]]", "an array of two vectors"),
      not_allowed("/objects/2/surface/edges/1", "[1,0]", vector),
      {replacing("/objects/2/surface/edges", "[[1,2,3],[2,4,6]]"),
       "/objects/2/surface/edges: [[1,2,3],[2,4,6]] is not possible: Parallelogram: edge_u and edge_v must "
       "not be 0 or parallel"},
      {replacing("/objects/2/surface/edges", "[[1,2,3],[0,0,0]]"),
       "/objects/2/surface/edges: [[1,2,3],[0,0,0]] is not possible: Parallelogram: edge_u and edge_v must "
       "not be 0 or parallel"},
      surface_row(R"({"type": "box", "min": [0,0,0]})", "/max: nothing is not " + vector),
      surface_row(R"({"type": "box", "min": [0,0,0], "max": [1,-1,1]})",
                  "/max: [1,-1,1] is not possible: Box: min.y = 0 must not be above max.y = -1"),
      surface_row(R"({"type": "disk", "position": [0,0,0], "normal": [0,0,0], "radius": 1})",
                  "/normal: [0,0,0] is not a direction, a vector that is not 0"),
      surface_row(R"({"type": "disk", "position": [0,0,0], "normal": [0,0,1], "radius": 0})",
                  "/radius: 0 is not " + above_0),
      surface_row(R"({"type": "quadric", "matrix": [[1,0,0,0]]})",
                  "/matrix: [[1,0,0,0]] is not a symmetric matrix, an array of four rows of four numbers"),
      surface_row(R"({"type": "quadric", "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0]]})",
                  "/matrix/3: [0,0,0] is not a row of four numbers"),
      surface_row(R"({"type": "quadric", "matrix": [[1,2,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})",
                  "/matrix/1/0: 0 is not the number on the other side of the diagonal, 2.0"),
      surface_row(
          R"({"type": "quadric", "matrix": [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,1]]})",
          "/matrix: [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,1]] is not possible: Quadric: the form must not be "
          "constant"),
      surface_row(R"({"type": "torus", "position": [0,0,0], "axis": [0,0,0], "radius": 2, "tube": 1})",
                  "/axis: [0,0,0] is not a direction, a vector that is not 0"),
      surface_row(R"({"type": "torus", "position": [0,0,0], "radius": 1, "tube": 1})",
                  "/tube: 1 is not possible: Torus: tube must be less than radius, so that there is a hole; "
                  "it is 1"),
      surface_row(R"({"type": "torus", "position": [0,0,0], "radius": 1, "tube": 0})",
                  "/tube: 0 is not " + above_0),
      not_allowed("/objects/2/color", "[1,1]", color),
      not_allowed("/objects/0/material-id", "\"blue\"", "the name of one of the materials: " + ids),
      missing("/objects/0/material-id", "the name of one of the materials, and there is no color"),
      not_allowed("/objects/0/material-id", "3", "the name of one of the materials, and there is no color"),
      {scene_with("/objects/0/color", "[1,1,1]"),
       "/objects/0/color: [1,1,1] is not possible beside a material-id"},
      {without("/materials"),
       R"(/objects/0/material-id: "red" is not the name of one of the materials, of which there are none)"},
      not_allowed("/lights", "{}", "an array"),
      not_allowed("/lights/0", "[]", "an object"),
      not_allowed("/lights/0", "{}", light),
      {without("/lights/0/intensity"), R"(/lights/0: {"position":[0,3,0]} is not )" + light},
      {without("/lights/0/position"), R"(/lights/0: {"intensity":[1,2,3]} is not )" + light},
      unknown("/lights/0/color", "position and intensity"),
      {replacing("/lights/0", R"({"position": [0,0,0], "color": 1})"),
       "/lights/0/color: is not a key here; allowed are position, direction, intensity, power, angle, fade "
       "and ambient"},
      unknown("/lights/1/intensity", "position and power"),
      not_allowed("/lights/1/power/0", "-1", factor),
      not_allowed("/lights/2/direction", "[0,0,0]", direction),
      unknown("/lights/2/power", "direction and intensity"),
      unknown("/lights/3/intensity", "position, direction, angle, fade and power"),
      missing("/lights/3/angle", spot_angle),
      not_allowed("/lights/3/angle", "0", spot_angle),
      not_allowed("/lights/3/angle", "181", spot_angle),
      not_allowed("/lights/3/fade", "-1", "a number of degrees of at least 0"),
      unknown("/lights/4/position", "ambient"),
      not_allowed("/lights/4/ambient", "0.5", color),
      not_allowed("/materials", "[]", "an object"),
      not_allowed("/materials/red", "[1,0,0]", "an object"),
      unknown("/materials/red/color",
              "diffuse, specular, shininess, reflect, refract, ior, normal-map, emission, glossy, roughness "
              "and blur"),
      not_allowed("/materials/black", "null", "an object"),  // though no object has it
      not_allowed("/materials/red/diffuse", "\"red\"", color + ", or a texture"),
      not_allowed("/materials/red/specular", "0.5", color),
      not_allowed("/materials/red/shininess", "-1", shininess),
      not_allowed("/materials/red/reflect", "-0.1", factor),
      not_allowed("/materials/red/refract", "[1]", factor),
      not_allowed("/materials/red/ior", "0", above_0),
      {scene_with("/materials/red/emission", "2"), "/materials/red/emission: 2 is not " + color},
      {scene_with("/materials/red/emission", "[1, -1, 0]"), "/materials/red/emission/1: -1 is not " + factor},
      {scene_with("/materials/red/emission", "[1, 1e39, 0]"),
       "/materials/red/emission/1: 1e+39 is not " + factor},
      {scene_with("/materials/red/glossy", "0.5"), "/materials/red/glossy: 0.5 is not " + color},
      {scene_with("/materials/red/glossy", "[-1, 0, 0]"), "/materials/red/glossy/0: -1 is not " + factor},
      {scene_with("/materials/red/glossy", "[1, 0, 1e39]"),
       "/materials/red/glossy/2: 1e+39 is not " + factor},
      {scene_with("/materials/red/roughness", "-0.1"), "/materials/red/roughness: -0.1 is not " + share},
      {scene_with("/materials/red/roughness", "1.1"), "/materials/red/roughness: 1.1 is not " + share},
      {scene_with("/materials/red/roughness", "\"smooth\""),
       "/materials/red/roughness: \"smooth\" is not " + share},
      unknown("/materials/squares/diffuse/colors", "checker and size"),
      {replacing("/materials/squares/diffuse", R"({"colors": 1})"),
       "/materials/squares/diffuse/colors: is not a key here; allowed are checker, image and size"},
      missing("/materials/squares/diffuse/checker", "an array of two colors, and there is no image"),
      missing("/materials/squares/diffuse/size", above_0),
      not_allowed("/materials/squares/diffuse/size", "0", above_0),
      not_allowed("/materials/squares/diffuse/checker", "[[1,0,0]]", "an array of two colors"),
      not_allowed("/materials/squares/diffuse/checker/1/2", "-1", factor),
      {replacing("/materials/squares/diffuse", R"({"image": 3})"),
       "/materials/squares/diffuse/image: 3 is not the path of a file"},
      {replacing("/materials/squares/diffuse", R"({"image": ""})"),
       R"(/materials/squares/diffuse/image: "" is not the path of a file)"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png\u0000.png"})"),
       R"(/materials/squares/diffuse/image: "none.png\u0000.png" is not the path of a file)"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png", "size": [1, 0]})"),
       "/materials/squares/diffuse/size/1: 0 is not a number greater than 0"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png", "size": 1})"),
       "/materials/squares/diffuse/size: 1 is not an array of two numbers"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png"})"),
       R"(/materials/squares/diffuse/image: "none.png" is not possible: cannot read 'none.png': )"
       "No such file or directory"},
      {scene_with("/materials/red/normal-map", "\"bricks.png\""),
       "/materials/red/normal-map: \"bricks.png\" is not an object"},
      {scene_with("/materials/red/normal-map", R"({"file": "a.png"})"),
       "/materials/red/normal-map/file: is not a key here; allowed are image and size"},
      {scene_with("/materials/red/normal-map", "{}"),
       "/materials/red/normal-map/image: nothing is not the path of a file"},
      {scene_with("/materials/red/normal-map", R"({"image": 3})"),
       "/materials/red/normal-map/image: 3 is not the path of a file"},
      {scene_with("/materials/red/normal-map", R"({"image": "none.png", "size": [1, 0]})"),
       "/materials/red/normal-map/size/1: 0 is not a number greater than 0"},
      unknown("/materials/red/a~1b~0c",
              "diffuse, specular, shininess, reflect, refract, ior, normal-map, emission, glossy, roughness "
              "and blur"),
      {replacing("/settings", R"({"resolution-x": 16385, "resolution-y": 16384})"),
       R"(/settings: {"resolution-x":16385,"resolution-y":16384} is not a picture of at most 2^28 pixels)"},
      {scene_with("/camera/focal-length", "1"),
       "/camera/focal-length: 1 is not possible beside a field-of-view"},
      missing("/camera/field-of-view", view_angle + ", and there is no focal-length"),
      {scene_with("/camera/shutter", "[1, 0.5]"),
       "/camera/shutter: [1,0.5] is not an array of two times, of which the second is not before the first"},
      {scene_with("/camera/shutter", "1"), "/camera/shutter: 1 is not an array of two times"},
      {scene_with("/camera/shutter", "[0, 1e121]"), "/camera/shutter/1: 1e+121 is not a number " + most},
      {scene_with("/camera/velocity", "[0, 1e121, 0]"), "/camera/velocity: [0,1e+121,0] is not " + place},
      {scene_with("/camera/shutter", "[0, \"end\"]"), "/camera/shutter/1: \"end\" is not a number"},
      {scene_with("/objects/0/surface/velocity", "[0, 1e121, 0]"),
       "/objects/0/surface/velocity: [0,1e+121,0] is not " + place},
      {scene_with("/objects/0/surface/velocity", "3"),
       "/objects/0/surface/velocity: 3 is not a vector, an array of three numbers"},
      {scene_with("/camera/aperture", "-0.5"), "/camera/aperture: -0.5 is not a number from 0 to 1e100"},
      {scene_with("/camera/aperture", "\"wide\""),
       "/camera/aperture: \"wide\" is not a number from 0 to 1e100"},
      {scene_with("/camera/aperture", "0.5"), "/camera/focus: nothing is not a number from 1e-100 to 1e100"},
      {scene_with("/camera/focus", "3"), "/camera/aperture: nothing is not a number from 0 to 1e100"},
      {patched(R"({"op": "add", "path": "/camera/aperture", "value": 1},
                  {"op": "add", "path": "/camera/focus", "value": 0})"),
       "/camera/focus: 0 is not a number from 1e-100 to 1e100"},
      {replacing("/camera", R"({"projection": "perspective", "position": [0,0,0], "direction": [0,0,1],
          "upward": [0,1,0], "focal-length": 1, "aperture": 1, "focus": 2})"),
       "/camera/aperture: 1 is not possible beside a focal-length"},
      // Magnitudes out of range.
      not_allowed("/camera/position", "[0.0,1e+121,0.0]", place),
      not_allowed("/objects/0/surface/position", "[0.0,-1e+121,0.0]", place),
      not_allowed("/objects/0/surface/radius", "1e+121", size),
      not_allowed("/objects/0/surface/radius", "1e-121", size),
      not_allowed("/objects/1/surface/distance", "1e+121", "a number " + most),
      not_allowed("/objects/2/surface/position", "[0.0,1e+121,0.0]", place),
      not_allowed("/objects/2/surface/edges/1", "[0.0,1e+121,0.0]", place),
      {replacing("/objects/2/surface/edges", "[[1,0,0],[0,1e-121,0]]"),
       "/objects/2/surface/edges: [[1,0,0],[0,1e-121,0]] is not possible: Parallelogram: edge_u and edge_v "
       "must have largest components from 2^-400 (3.9e-121) to 2^400 (2.6e120)"},
      surface_row(R"({"type": "box", "min": [0,-1e121,0], "max": [1,1,1]})",
                  "/min: [0,-1e+121,0] is not " + place),
      surface_row(R"({"type": "disk", "position": [0,0,0], "normal": [0,0,1], "radius": 1e121})",
                  "/radius: 1e+121 is not " + size),
      surface_row(R"({"type": "quadric", "matrix": [[1,0,4e307,0],[0,1,0,0],[4e307,0,1,0],[0,0,0,-1]]})",
                  "/matrix/0/2: 4e+307 is not a number " + most),
      surface_row(R"({"type": "triangle", "points": [[0,0,0],[1,0,0],[0,1e121,0]]})",
                  "/points/2: [0,1e+121,0] is not " + place),
      surface_row(R"({"type": "csg", "operation": "union", "surfaces": [
                      {"type": "sphere", "position": [0,0,0], "radius": 1e-160}]})",
                  "/surfaces/0/radius: 1e-160 is not " + size),
      not_allowed("/lights/1/position", "[1e+300,0.0,0.0]", place),
      not_allowed("/lights/3/position", "[1e+300,0.0,0.0]", place),
      not_allowed("/materials/red/ior", "1e+121", size),
      not_allowed("/materials/squares/diffuse/size", "1e-121", size),
      // Too much work.
      {patched(R"({"op": "replace", "path": "/settings/samples", "value": 65536},
                  {"op": "replace", "path": "/lights", "value": [)" +
               repeated(R"({"direction": [0,1,0], "intensity": [1,1,1]},)", 63) +
               R"({"direction": [0,1,0], "intensity": [1,1,1]}]})"),
       "/settings/samples: 65536 is not possible: with 64 lights a pixel may take 4259840 rays, and at most "
       "4194304 are allowed"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text, row.error);
    CHECK(scene_error(row.text) == "scene.json: " + row.error);
  }
}

TEST_CASE("invalid lengths of a camera in a scene file are reported with their place") {
  const auto with_camera = [](const std::string& projection, const std::string& key,
                              const std::string& length) {
    return replacing("/camera", R"({"position": [0, 0, 0], "direction": [0, 0, 1], "upward": [0, 1, 0], )"
                                R"("projection": ")" +
                                    projection + R"(", ")" + key + "\": " + length + "}");
  };
  for (const auto& [projection, key] :
       {std::pair{"perspective", "focal-length"}, std::pair{"orthographic", "ortho-scale"}}) {
    for (const std::string length : {"0", "-1", "1e-130", "1e+130", "\"1\""})
      CHECK(scene_error(with_camera(projection, key, length)) == std::string("scene.json: /camera/") + key +
                                                                     ": " + length +
                                                                     " is not a number from 1e-100 to 1e100");
    for (const char* length : {"1e-100", "1e100"})
      CHECK(scene_error(with_camera(projection, key, length)) == "");
  }
  for (const char* angle : {"1e-100", "179.99999999999997"})
    CHECK(scene_error(with_camera("perspective", "field-of-view", angle)) == "");
}

TEST_CASE("a number beyond the range of double is reported with its place") {
  for (const std::string& number : std::vector<std::string>{"1e999", "-1e999", "1E400", repeated("9", 400)}) {
    const std::string found = number.size() > 60 ? number.substr(0, 60) + "..." : number;
    std::string text = smallest_scene;
    text.replace(text.find("\"radius\": 1") + 10, 1, number);
    CHECK(scene_error(text) == "scene.json: /objects/0/surface/radius: " + found +
                                   " is not a number that a double holds, up to 1.8e308");
  }
  CHECK_THAT(scene_error(R"({"a": [[1, 2], 1e999]})"), ContainsSubstring("scene.json: /a/1: 1e999 is not "));
}

TEST_CASE("a duplicate key is an error at any depth") {
  CHECK(scene_error(R"({"settings": 1, "settings": 2})") ==
        "scene.json: /settings: the key is there twice; once is allowed");
  CHECK(scene_error(R"({"a": [0, {"b": 1, "c": {}, "b": 1}]})") ==
        "scene.json: /a/1/b: the key is there twice; once is allowed");
  CHECK(scene_error(R"({"a": {"b": 1}, "c": {"b": 1}})").find("twice") == std::string::npos);
}

TEST_CASE("a syntax error in JSON is reported with its line and column") {
  struct Row {
    std::string text, place;
  };
  const Row row =
      GENERATE(Row{"", "line 1, column 1"}, Row{"{", "line 1, column 2"},
               Row{"{\n  \"a\": 1,\n}", "line 3, column 1"}, Row{"{\"a\": nul}", "line 1, column 10"},
               Row{"[1, 2", "line 1, column 6"}, Row{"{} {}", "line 1, column 4"},
               Row{"// no\n{}", "line 1, column 1"}, Row{"{\"a\": NaN}", "line 1, column 7"},
               Row{"{\"a\": 01}", "line 1, column 8"}, Row{"{'a': 1}", "line 1, column 2"},
               Row{"{\"a\": \"\xff\"}", "line 1, column 8"}, Row{"\xff\xfe{", "line 1, column 1"},
               Row{std::string("{}\0", 3), "line 1, column 3"}, Row{"{\n\"\xc3\"}", "line 2, column 3"});
  CAPTURE(row.text);
  const std::string error = scene_error(row.text);
  CHECK(error.substr(0, error.find(": ", 30)) == "scene.json: parse error at " + row.place);
  CHECK(std::all_of(error.begin(), error.end(), [](char c) { return c >= ' ' && c <= '~'; }));
}

TEST_CASE("invalid scene files of any kind and size give a short error message") {
  const auto check = [](const std::string& text) {
    const std::string error = scene_error(text);
    CHECK(error.starts_with("scene.json: "));
    CHECK(error.size() < 600);
  };
  check(repeated("[", 200'000));
  check(repeated("{\"a\":", 200'000));
  check(repeated("[", 200'000) + repeated("]", 200'000));
  check(std::string(1 << 20, 'a'));
  check(std::string(1 << 20, '\0'));
  check(std::string(1 << 20, '\xff'));
  check("\"" + std::string(1 << 20, 'a'));
  check("{\"" + std::string(1 << 20, 'a') + "\": 1}");
  check("{\"settings\": \"" + std::string(1 << 20, 'a') + "\"}");
  check("{\"settings\": [" + repeated("0,", 100'000) + "0]}");
  check(std::string(1 << 20, '1'));
  for (std::size_t size = 0; size + 1 < scene_of_everything.size(); size += 7)
    check(scene_of_everything.substr(0, size));
}

TEST_CASE("a scene file may be nested as deep as operations on solids may be, and no deeper") {
  CHECK(scene_error(repeated("[", 2049) + repeated("]", 2049)) ==
        "scene.json: " + repeated("/0", 60) + "..." + repeated("/0", 60) +
            ": there are 2049 arrays and objects inside each other; at most 2048 are allowed");
  CHECK_THAT(scene_error(repeated("[", 2048) + repeated("]", 2048)), ContainsSubstring("is not an object"));

  const auto of_depth = [](int depth) {
    return repeated(R"({"type": "csg", "operation": "union", "surfaces": [)", depth) + ball_in_json +
           repeated("]}", depth);
  };
  CHECK(only_surface(of_depth(1000)).intersect(Ray{}) == 2);
  const std::string error = scene_error(with_surface(of_depth(1001)));
  CHECK_THAT(error, ContainsSubstring("scene.json: /objects/0/surface/surfaces: ") &&
                        ContainsSubstring("1000 deep inside each other, and these are 1001"));
  CHECK(error.size() < 300);
  const std::string cube = repeated(R"({"type": "csg", "operation": "union", "surfaces": [)", 1000) +
                           R"({"type": "cube"})" + repeated("]}", 1000);
  CHECK_THAT(scene_error(with_surface(cube)),
             ContainsSubstring("/0/surfaces/0/type: \"cube\" is not \"sphere\""));
  CHECK(scene_error(with_surface(cube)).size() < 500);

  const std::string instances =
      repeated(R"({"type": "instance", "translate": [0, 0, 1], "surface": )", 2000) + ball_in_json +
      repeated("}", 2000);
  CHECK(only_surface(instances).intersect(Ray{}) == 2002);
}

TEST_CASE("an error in a nested surface of a scene file is reported with its place") {
  const auto says = [](const std::string& surface, const std::string& error) {
    CHECK(scene_error(with_surface(surface)) == "scene.json: /objects/0/surface" + error);
  };
  const auto csg = [](const std::string& operation, const std::string& surfaces) {
    return R"({"type":"csg","operation":)" + operation + R"(,"surfaces":)" + surfaces + "}";
  };
  says(csg("\"xor\"", "[" + ball_in_json + "]"),
       R"(/operation: "xor" is not "union", "intersection" or "difference")");
  says(csg("\"union\"", ball_in_json), "/surfaces: " + ball_in_json + " is not an array");
  says(csg("\"union\"", "[]"), "/surfaces: [] is not possible: Csg: an operation needs a solid");
  says(csg("\"union\"", "[1]"), "/surfaces/0: 1 is not an object");
  says(csg("\"union\"", "[" + ball_in_json + R"(,{"type":"plane","normal":[0,1,0],"distance":0}])"),
       R"(/surfaces/1/type: "plane" is not the type of a closed solid)");
  says(csg("\"union\"", R"([{"type":"instance","surface":{"type":"plane","normal":[0,1,0],"distance":0}}])"),
       R"(/surfaces/0/surface/type: "plane" is not the type of a closed solid)");
  says(csg("\"union\"", R"([{"type":"sphere","position":[0,0,0],"radius":0}])"),
       "/surfaces/0/radius: 0 is not a number greater than 0");
  says(R"({"type":"csg","surfaces":[]})",
       R"(/operation: nothing is not "union", "intersection" or "difference")");
  says(R"({"type":"csg","operands":[]})",
       "/operands: is not a key here; allowed are type, operation, surfaces and velocity");
  // A part does not move, and is not told that it could.
  const std::string in_part = "possible in a part of another surface: it is the whole surface that moves";
  const std::string part = R"({"type":"csg","operation":"union","surfaces":[)" + ball_in_json + "],";
  says(csg("\"union\"", R"([{"type":"sphere","center":[0,0,0],"radius":1}])"),
       "/surfaces/0/center: is not a key here; allowed are type, position and radius");
  says(csg("\"union\"", "[" + part + R"("operands":[]}])"),
       "/surfaces/0/operands: is not a key here; allowed are type, operation and surfaces");
  says(csg("\"union\"", "[" + part + R"("velocity":[1,0,0]}])"),
       "/surfaces/0/velocity: [1,0,0] is not " + in_part);
  says(R"({"type":"instance","surface":{"type":"sphere","velocity":[1,0,0]}})",
       "/surface/velocity: [1,0,0] is not " + in_part);

  const auto instance = [](const std::string& placement) {
    return R"({"type":"instance","surface":)" + ball_in_json + "," + placement + "}";
  };
  const std::string limit = "at most 2^400 (2.6e120) in magnitude";
  const std::string no_way_back =
      " is not possible: it takes space to a plane or less, or beyond the range of double";
  says(R"({"type":"instance"})", "/surface: nothing is not an object");
  says(instance(R"("shear":1)"),
       "/shear: is not a key here; allowed are type, surface, matrix, scale, rotate, translate and velocity");
  says(instance(R"("matrix":[],"scale":1)"),
       "/scale: is not a key here; allowed are type, surface, matrix and velocity");
  says(instance(R"("scale":1,"shear":1)"),
       "/shear: is not a key here; allowed are type, surface, scale, rotate, translate and velocity");
  says(instance(R"("matrix":[])"), "/matrix: [] is not an array of three rows");
  says(instance(R"("matrix":[[1,0,0,0],[0,1,0],[0,0,1,0]])"),
       "/matrix/1: [0,1,0] is not a row, an array of four numbers");
  says(instance(R"("matrix":[[1,0,0,5],[0,1,0,5],[1,1,0,5]])"),
       "/matrix: [[1,0,0,5],[0,1,0,5],[1,1,0,5]]" + no_way_back);
  says(instance(R"("scale":0)"), "/scale: 0" + no_way_back);
  says(instance(R"("scale":[1,1,1e-320])"), "/scale: [1,1,1e-320]" + no_way_back);
  const std::string steep = "[[0.5,5e-324,180,2],[0,0.9,0,1],[0,0,2.2e-308,0]]";  // its inverse overflows
  says(instance("\"matrix\":" + steep), "/matrix: " + steep + no_way_back);
  says(instance(R"("scale":1e-121)"),
       "/scale: 1e-121 is not possible: Instance: the numbers of the inverse of the map must be " + limit);
  says(instance(R"("scale":[1,1,1e121])"), "/scale: [1,1,1e+121] is not a vector of numbers " + limit);
  says(instance(R"("scale":"2")"), R"(/scale: "2" is not a number or a vector)");
  says(instance(R"("scale":[1,2])"), "/scale: [1,2] is not a vector, an array of three numbers");
  says(instance(R"("rotate":{"axis":[0,0,0],"angle":1})"),
       "/rotate/axis: [0,0,0] is not a direction, a vector that is not 0");
  says(instance(R"("rotate":{"axis":[0,0,1]})"), "/rotate/angle: nothing is not a number of degrees");
  says(instance(R"("rotate":{"degrees":1})"),
       "/rotate/degrees: is not a key here; allowed are axis and angle");
}

TEST_CASE("a scene file that cannot be read is reported with its path and the reason") {
  const TemporaryFolder folder;
  const auto error_reading = [](const fs::path& path) {
    return message_of<std::system_error>([&] { static_cast<void>(read_scene(path)); });
  };
  const auto expected = [](const fs::path& path, int reason) {
    return "cannot read '" + path.string() + "': " + std::generic_category().message(reason);
  };
  CHECK(error_reading(folder / "none.json") == expected(folder / "none.json", ENOENT));
  CHECK(error_reading(folder / "") == expected(folder / "", EISDIR));
  put_bytes(folder / "a.json", smallest_scene);
  CHECK(error_reading(folder / "a.json/b.json") == expected(folder / "a.json/b.json", ENOTDIR));
  CHECK(read_scene(folder / "a.json").width == 8);
  CHECK(error_reading("") == expected("", ENOENT));
}

TEST_CASE("messages show names, keys and values of a scene file without control characters") {
  const auto is_plain = [](const std::string& text) {
    CAPTURE(text);
    CHECK(std::none_of(text.begin(), text.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }));
    CHECK(text.find("\xc2\x9b") == std::string::npos);
  };
  const std::string bad = "\\u001b[31m\\u0007\\n\x7f\xc2\x9b";
  const auto with_name = [&](const std::string& text) {
    return std::string(text).replace(text.find("NAME"), 4, bad);
  };
  for (const std::string& text :
       {with_name(scene_with("/NAME", "1")), with_name(scene_with("/materials/NAME", "1")),
        with_name(scene_with("/settings/NAME", "1")), with_name(replacing("/settings/tone", "\"NAME\"")),
        with_name(replacing("/objects/0/material-id", "\"NAME\"")),
        with_name(replacing("/materials/red/diffuse", R"({"image": "NAME"})")),
        with_name(R"({"NAME": 1e999})"), R"({"NAME": 1, "NAME": 2})" + bad, with_name(R"({"NAME": nul)")}) {
    const std::string error = scene_error(text);
    CHECK(error.starts_with("scene.json: "));
    is_plain(error);
  }
  CHECK_THAT(scene_error(with_name(scene_with("/NAME", "1"))),
             ContainsSubstring("scene.json: /\\x1b[31m\\x07\\x0a\\x7f\\xc2\\x9b: is not a key"));
  is_plain(message_of<SceneError>([] { static_cast<void>(scene_from_json("[]", "a\x1b\n")); }));
  is_plain(
      message_of<SceneError>([] { static_cast<void>(scene_from_json(std::string(1, '\0'), "a\x1b\n")); }));
  is_plain(message_of<std::system_error>([] { static_cast<void>(read_scene("a\x1b\n")); }));
}

TEST_CASE("the message of an error in a scene file begins with its path") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.json", "{");
  const std::string path = (folder / "a.json").string();
  CHECK(message_of<SceneError>([&] {
          static_cast<void>(read_scene(path));
        }).starts_with(path + ": parse error"));
  put_bytes(folder / "a.json", "[]");
  CHECK(message_of<SceneError>([&] { static_cast<void>(read_scene(path)); }) ==
        path + ": the whole: [] is not an object");
}

TEST_CASE("the fuzzing corpus of scene files, like every scene, is read or refused with a message") {
  int files = 0;
  for (const fs::path& folder : {fs::path(PROTOSTAR_SOURCE_DIR) / "tests/fuzz/corpus", scenes_folder})
    for (const auto& entry : fs::directory_iterator(folder)) {
      INFO(entry.path());
      CHECK_NOTHROW(read_any_bytes(bytes_of(entry.path())));
      ++files;
    }
  CHECK(files > 30);
}
