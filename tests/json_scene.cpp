// Scene files: their meaning, and the message for each kind of error.
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <protostar/io/json_scene.hpp>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "fuzz/read_any_bytes.hpp"
#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;
using namespace protostar;
using nlohmann::json;

namespace {

const fs::path scenes = fs::path(PROTOSTAR_SOURCE_DIR) / "scenes";

/// The smallest scene, with one of each required item.
const std::string smallest = R"({
  "settings": {"resolution-x": 8, "resolution-y": 6},
  "camera": {"projection": "perspective", "position": [0, 0, 0], "direction": [0, 0, 1], "upward": [0, 1, 0],
             "field-of-view": 90},
  "objects": [{"surface": {"type": "sphere", "position": [0, 0, 3], "radius": 1}, "color": [1, 0.5, 0]}]
})";

/// A scene with one of everything, into which tests put errors.
const std::string everything = R"({
  "settings": {"resolution-x": 8, "resolution-y": 6, "samples": 4, "depth": 3, "integrator": "shadow",
               "transfer": {"gamma": 2.2}, "tone": "scale-pixel", "exposure": 0.5},
  "world": {"sky": [0.1, 0.2, 0.3]},
  "camera": {"projection": "perspective", "position": [1, 2, 3], "direction": [0, 0, 2], "upward": [0, 3, 0],
             "field-of-view": 60},
  "objects": [
    {"surface": {"type": "sphere", "position": [0, 0, 3], "radius": 1}, "material-id": "red"},
    {"surface": {"type": "plane", "normal": [0, 2, 0], "distance": -1}, "material-id": "squares"},
    {"surface": {"type": "parallelogram", "position": [1, 1, 1], "edges": [[2, 0, 0], [0, 0, 3]]},
     "color": [1, 0.5, 0]}
  ],
  "lights": [
    {"position": [0, 3, 0], "intensity": [1, 2, 3]},
    {"position": [0, 3, 0], "power": [4, 5, 6]},
    {"direction": [0, 2, 0], "intensity": [7, 8, 9]},
    {"position": [0, 3, 0], "direction": [0, -2, 0], "angle": 30, "fade": 10, "power": [1, 1, 1]},
    {"ambient": [0.1, 0.1, 0.2]}
  ],
  "materials": {
    "red": {"diffuse": [0.8, 0.1, 0.1], "specular": [0.5, 0.6, 0.7], "shininess": 20, "reflect": 0.25,
            "refract": 0.5, "ior": 1.33},
    "squares": {"diffuse": {"checker": [[1, 0, 0], [0, 0, 1]], "size": 2}},
    "black": {}
  }
})";

SceneFile read(const std::string& text) { return scene_from_json(text, "scene.json"); }

std::string error_of(const std::string& text) {
  return message_of<SceneError>([&] { static_cast<void>(read(text)); });
}

/// Returns the scene with everything after a JSON Patch (RFC 6902).
std::string patched(const std::string& patch) {
  return json::parse(everything).patch(json::parse("[" + patch + "]")).dump();
}

std::string replacing(const std::string& pointer, const std::string& value) {
  return patched(R"({"op": "replace", "path": ")" + pointer + R"(", "value": )" + value + "}");
}

std::string without(const std::string& pointer) {
  return patched(R"({"op": "remove", "path": ")" + pointer + R"("})");
}

std::string with(const std::string& pointer, const std::string& value) {
  return patched(R"({"op": "add", "path": ")" + pointer + R"(", "value": )" + value + "}");
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// A surface, and functions that replace the surface of the smallest scene.
const std::string ball = R"({"position":[0,0,3],"radius":1,"type":"sphere"})";
std::string with_surface(const std::string& surface) {
  const std::string sphere = R"({"type": "sphere", "position": [0, 0, 3], "radius": 1})";
  return std::string(smallest).replace(smallest.find(sphere), sphere.size(), surface);
}
AnySurface only_surface(const std::string& surface) {
  return read(with_surface(surface)).scene.surfaces<AnySurface>().at(0);
}

/// Tests whether two cameras have the same rays.
bool same_camera(const Camera& a, const Camera& b) {
  return a.position == b.position && a.right == b.right && a.up == b.up && a.forward == b.forward &&
         a.film_right == b.film_right && a.film_up == b.film_up;
}

}  // namespace

TEST_CASE("a scene file needs a resolution, a camera and objects; all else has a default") {
  const SceneFile file = read(smallest);
  CHECK(file.width == 8);
  CHECK(file.height == 6);
  CHECK(file.samples == 0);
  CHECK(file.depth == 10);
  CHECK(file.integrator == "whitted");
  CHECK(std::holds_alternative<Srgb>(file.transfer));
  CHECK(file.tone == Tone::clip);
  CHECK(file.exposure == 1);
  CHECK(!file.scene.sky());
  CHECK(file.scene.ambient() == Color{0});
  CHECK(file.scene.lights().empty());
  CHECK(same_camera(file.camera, Camera{}));
  REQUIRE(file.scene.size() == 1);
  CHECK(file.scene.materials<Sphere>()[0].diffuse == Color{1, 0.5f, 0});

  const SceneFile plain = read(replacing("/objects/0/material-id", R"("black")"));
  const Material& material = plain.scene.materials<Sphere>()[0];
  CHECK(material.diffuse == Color{0});
  CHECK(!material.texture);
  CHECK(material.specular == Color{0});
  CHECK(material.shininess == 50);
  CHECK(material.reflect == 0);
  CHECK(material.refract == 0);
  CHECK(material.ior == 1.5);
}

TEST_CASE("all properties of a scene can be given in a scene file") {
  const SceneFile file = read(everything);
  CHECK(file.samples == 4);
  CHECK(file.depth == 3);
  CHECK(file.integrator == "shadow");
  REQUIRE(std::holds_alternative<Gamma>(file.transfer));
  CHECK(std::get<Gamma>(file.transfer).exponent == 2.2);
  CHECK(file.tone == Tone::scale_pixel);
  CHECK(file.exposure == 0.5);
  CHECK(file.scene.sky() == Color{0.1f, 0.2f, 0.3f});
  CHECK(same_camera(file.camera, Camera::perspective({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 60)));

  const auto& spheres = file.scene.surfaces<Sphere>();
  REQUIRE(spheres.size() == 1);
  CHECK(spheres[0].center == Point{0, 0, 3});
  CHECK(spheres[0].radius == 1);
  const Material& red = file.scene.materials<Sphere>()[0];
  CHECK(red.diffuse == Color{0.8f, 0.1f, 0.1f});
  CHECK(red.specular == Color{0.5f, 0.6f, 0.7f});
  CHECK(red.shininess == 20);
  CHECK(red.reflect == 0.25);
  CHECK(red.refract == 0.5);
  CHECK(red.ior == 1.33);

  const auto& planes = file.scene.surfaces<Plane>();
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].normal == Vec3{0, 1, 0});  // normalized: the distance is along the unit normal
  CHECK(planes[0].distance == -1);
  const Texture& squares = file.scene.materials<Plane>()[0].texture;
  REQUIRE(squares);
  CHECK(squares(1, 1) == Color{1, 0, 0});
  CHECK(squares(3, 1) == Color{0, 0, 1});

  const auto& boards = file.scene.surfaces<Parallelogram>();
  REQUIRE(boards.size() == 1);
  CHECK(boards[0].position == Point{1, 1, 1});
  CHECK(boards[0].edge_u == Vec3{2, 0, 0});
  CHECK(boards[0].edge_v == Vec3{0, 0, 3});
  CHECK(file.scene.materials<Parallelogram>()[0].diffuse == Color{1, 0.5f, 0});

  const Point below{0, 2, 0}, aside{0.1, 2, 0};
  const Vec3 up{0, 1, 0};
  const auto& lights = file.scene.lights();
  REQUIRE(lights.size() == 4);
  CHECK(lights[0].irradiance(below, up) == Color{1, 2, 3});
  CHECK(lights[1].irradiance(aside, up) == Light(PointLight{{0, 3, 0}, {4, 5, 6}}).irradiance(aside, up));
  CHECK(lights[2].irradiance(below, up) == Color{7, 8, 9});
  const SpotLight spot{
      .position = {0, 3, 0}, .direction = {0, -1, 0}, .angle = 30, .power = Color{1}, .fade = 10};
  const Point in_fade{0.5, 2, 0};  // 26.6° off the axis
  CHECK(lights[3].irradiance(in_fade, up) == Light(spot).irradiance(in_fade, up));
  CHECK(file.scene.ambient() == Color{0.1f, 0.1f, 0.2f});
}

TEST_CASE("boxes, disks and quadrics of a scene file are read correctly") {
  const auto only = [](const std::string& surface) {
    const SceneFile file =
        read(replacing("/objects", R"([{"color": [1, 1, 1], "surface": )" + surface + "}]"));
    REQUIRE(file.scene.surfaces<AnySurface>().size() == 1);
    return file.scene.surfaces<AnySurface>()[0];
  };
  const AnySurface box = only(R"({"type": "box", "min": [-1, 0, 2], "max": [1, 3, 5]})");
  CHECK(box.bounds().min == Point{-1, 0, 2});
  CHECK(box.bounds().max == Point{1, 3, 5});
  const AnySurface disk =
      only(R"({"type": "disk", "position": [1, 2, 5], "normal": [0, 0, -7], "radius": 2})");
  CHECK(disk.intersect({{3, 2, 0}, {0, 0, 1}}) == 5);
  CHECK_FALSE(disk.intersect({{3.01, 2, 0}, {0, 0, 1}}));
  CHECK(disk.normal_at({1, 2, 5}) == Vec3{0, 0, -1});
  // x² + 2y² + 3z² + 2 (4xy + 5zx + 6yz) + 2 (7x + 8y + 9z) − 10
  const AnySurface quadric =
      only(R"({"type": "quadric", "matrix": [[1, 4, 5, 7], [4, 2, 6, 8], [5, 6, 3, 9], [7, 8, 9, -10]]})");
  const Quadric same{{.squares = {1, 2, 3}, .products = {6, 5, 4}, .linear = {7, 8, 9}, .constant = -10}};
  for (const Ray& ray : {Ray{{0, 0, 0}, {1, 2, -3}}, Ray{{1, 0, 2}, {-1, 1, 1}}, Ray{{0, -3, 1}, {2, 5, 1}}})
    CHECK(quadric.intersect(ray) == same.intersect(ray));
}

TEST_CASE("a scene file may have one of three kinds of cameras") {
  const std::string sensor = R"({"projection": "perspective", "position": [1, 2, 3], "direction": [0, 0, 1],
      "upward": [0, 1, 0], "focal-length": 3})";
  CHECK(same_camera(read(replacing("/camera", sensor)).camera,
                    Camera::sensor({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 3)));
  const std::string orthographic = R"({"projection": "orthographic", "position": [1, 2, 3],
      "direction": [0, 0, 1], "upward": [0, 1, 0], "ortho-scale": 4})";
  CHECK(same_camera(read(replacing("/camera", orthographic)).camera,
                    Camera::orthographic({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 4)));
}

TEST_CASE("names in a scene file may be any text, and numbers may have any form of JSON") {
  CHECK(read(replacing("/settings/resolution-x", "8.0")).width == 8);
  CHECK(read(replacing("/settings/resolution-x", "0.8e1")).width == 8);
  CHECK(read(replacing("/settings/transfer", R"("srgb")")).transfer.index() == Transfer(Srgb{}).index());
  CHECK(read(replacing("/settings/transfer", R"("linear")")).transfer.index() == Transfer(Linear{}).index());
  CHECK(read(replacing("/settings/tone", R"("scale-image")")).tone == Tone::scale_image);
  CHECK(read(replacing("/settings/tone", R"("clip")")).tone == Tone::clip);
  for (const std::string_view name : integrator_names)
    CHECK(read(replacing("/settings/integrator", json(name).dump())).integrator == name);
  CHECK(read(replacing("/objects", "[]")).scene.size() == 0);
  CHECK(read(with("/materials/~1~0 \xc3\xa4\\n", "{}")).scene.size() == 3);
  CHECK(read("\xef\xbb\xbf" + smallest).width == 8);  // a byte order mark
}

TEST_CASE("an error in a scene file is reported with its place, what was found and what is allowed") {
  struct Row {
    std::string text, error;
  };
  const std::string
      vector = "a vector, an array of three numbers",
      most = "at most 2^400 (2.6e120) in magnitude", place = "a vector of numbers " + most,
      size = "a number from 2^-400 (3.9e-121) to 2^400 (2.6e120)", number = "a number",
      above_0 = "a number greater than 0", color = "a color, an array of three numbers from 0 to 3.4e38",
      factor = "a number from 0 to 3.4e38", direction = "a direction, a vector that is not 0",
      side = "a whole number from 1 to 268435456", samples = "a whole number from 0 to 65536",
      depth = "a whole number from 1 to 1000", spot_angle = "a number of degrees above 0 and at most 180",
      view_angle = "a number of degrees from 1e-100 to below 180", shininess = "a number of at least 0",
      tone = R"("clip", "scale-pixel" or "scale-image")",
      types =
          R"("sphere", "plane", "parallelogram", "triangle", "mesh", "box", "disk", "quadric", "csg" or "instance")",
      light =
          "a light: position and intensity, position and power, direction and intensity, "
          "position, direction, angle and power, or ambient";
  // Replaces the value at a pointer by one that is not allowed.
  const auto not_allowed = [](const std::string& pointer, const std::string& value,
                              const std::string& allowed) {
    return Row{replacing(pointer, value), pointer + ": " + value + " is not " + allowed};
  };
  const auto missing = [](const std::string& pointer, const std::string& allowed) {
    return Row{without(pointer), pointer + ": nothing is not " + allowed};
  };
  const auto unknown = [](const std::string& pointer, const std::string& allowed) {
    return Row{with(pointer, "1"), pointer + ": is not a key here; allowed are " + allowed};
  };
  // Replaces a surface by an invalid one.
  const auto surface_row = [](const std::string& surface, const std::string& error) {
    return Row{replacing("/objects/2/surface", surface), "/objects/2/surface" + error};
  };
  const std::string settings_keys =
      "resolution-x, resolution-y, samples, depth, integrator, transfer, tone and exposure";
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
      not_allowed("/settings/depth", "0", depth),
      not_allowed("/settings/depth", "1001", depth),
      not_allowed("/settings/depth", "1.5", depth),
      not_allowed(
          "/settings/integrator", "\"path\"",
          R"("binary", "depth", "normal", "color", "diffuse", "transparency", "shadow" or "whitted")"),
      not_allowed(
          "/settings/integrator", "null",
          R"("binary", "depth", "normal", "color", "diffuse", "transparency", "shadow" or "whitted")"),
      not_allowed("/settings/transfer", "\"sRGB\"", R"("srgb" or "linear")"),
      not_allowed("/settings/transfer", "2.2", R"("srgb" or "linear")"),
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
      unknown("/camera/fov", "projection, position, direction, upward, field-of-view and focal-length"),
      unknown("/camera/ortho-scale",
              "projection, position, direction, upward, field-of-view and focal-length"),
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
      unknown("/objects/0/surface/center", "type, position and radius"),
      missing("/objects/0/surface/position", vector),
      missing("/objects/0/surface/radius", above_0),
      not_allowed("/objects/0/surface/radius", "0", above_0),
      not_allowed("/objects/0/surface/radius", "-1", above_0),
      not_allowed("/objects/0/surface/radius", "\"1\"", above_0),
      not_allowed("/objects/1/surface/normal", "[0,0,0]", direction),
      missing("/objects/1/surface/distance", number),
      unknown("/objects/1/surface/radius", "type, normal and distance"),
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
                  "/normal: [0,0,0] is not possible: Disk: normal must be finite and not zero"),
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
      not_allowed("/objects/2/color", "[1,1]", color),
      not_allowed("/objects/0/material-id", "\"blue\"", "the name of one of the materials: " + ids),
      missing("/objects/0/material-id", "the name of one of the materials, and there is no color"),
      not_allowed("/objects/0/material-id", "3", "the name of one of the materials, and there is no color"),
      {with("/objects/0/color", "[1,1,1]"), "/objects/0/color: [1,1,1] is not possible beside a material-id"},
      {without("/materials"),
       R"(/objects/0/material-id: "red" is not the name of one of the materials, of which there are none)"},
      not_allowed("/lights", "{}", "an array"),
      not_allowed("/lights/0", "[]", "an object"),
      not_allowed("/lights/0", "{}", light),
      missing("/lights/0/intensity", color),
      missing("/lights/0/position", vector),
      unknown("/lights/0/color", "position, direction, intensity, power, angle, fade and ambient"),
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
      unknown("/materials/red/color", "diffuse, specular, shininess, reflect, refract and ior"),
      not_allowed("/materials/black", "null", "an object"),  // though no object has it
      not_allowed("/materials/red/diffuse", "\"red\"", color),
      not_allowed("/materials/red/specular", "0.5", color),
      not_allowed("/materials/red/shininess", "-1", shininess),
      not_allowed("/materials/red/reflect", "-0.1", factor),
      not_allowed("/materials/red/refract", "[1]", factor),
      not_allowed("/materials/red/ior", "0", above_0),
      unknown("/materials/squares/diffuse/colors", "checker and size"),
      missing("/materials/squares/diffuse/size", above_0),
      not_allowed("/materials/squares/diffuse/size", "0", above_0),
      not_allowed("/materials/squares/diffuse/checker", "[[1,0,0]]", "an array of two colors"),
      not_allowed("/materials/squares/diffuse/checker/1/2", "-1", factor),
      {replacing("/materials/squares/diffuse", R"({"image": 3})"),
       "/materials/squares/diffuse/image: 3 is not the path of a file"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png\u0000.png"})"),
       R"(/materials/squares/diffuse/image: "none.png\u0000.png" is not the path of a file)"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png", "size": [1, 0]})"),
       "/materials/squares/diffuse/size/1: 0 is not a number greater than 0"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png", "size": 1})"),
       "/materials/squares/diffuse/size: 1 is not an array of two numbers"},
      {replacing("/materials/squares/diffuse", R"({"image": "none.png"})"),
       R"(/materials/squares/diffuse/image: "none.png" is not possible: cannot read 'none.png': )"
       "No such file or directory"},
      unknown("/materials/red/a~1b~0c", "diffuse, specular, shininess, reflect, refract and ior"),
      {replacing("/settings", R"({"resolution-x": 16385, "resolution-y": 16384})"),
       R"(/settings: {"resolution-x":16385,"resolution-y":16384} is not a picture of at most 2^28 pixels)"},
      {with("/camera/focal-length", "1"), "/camera/focal-length: 1 is not possible beside a field-of-view"},
      missing("/camera/field-of-view", view_angle + ", and there is no focal-length"),
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
    CHECK(error_of(row.text) == "scene.json: " + row.error);
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
      CHECK(error_of(with_camera(projection, key, length)) == std::string("scene.json: /camera/") + key +
                                                                  ": " + length +
                                                                  " is not a number from 1e-100 to 1e100");
    for (const char* length : {"1e-100", "1e100"})
      CHECK(error_of(with_camera(projection, key, length)) == "");
  }
  for (const char* angle : {"1e-100", "179.99999999999997"})
    CHECK(error_of(with_camera("perspective", "field-of-view", angle)) == "");
}

TEST_CASE("factors on light that underflow in float are read as 0") {
  const SceneFile file = read(patched(R"({"op": "replace", "path": "/materials/red/reflect", "value": 1e-60},
      {"op": "replace", "path": "/materials/red/refract", "value": 1e-60},
      {"op": "replace", "path": "/settings/exposure", "value": 1e-60})"));
  CHECK(file.scene.materials<Sphere>()[0].reflect == 0);
  CHECK(file.scene.materials<Sphere>()[0].refract == 0);
  CHECK(file.exposure == 0);
}

TEST_CASE("the sum of ambient lights is clamped to the limit of irradiance") {
  const SceneFile file =
      read(replacing("/lights", R"([{"ambient": [3e38, 1, 0]}, {"ambient": [3e38, 1, 0]}])"));
  CHECK(file.scene.ambient() == Color{most_irradiance, 2, 0});
}

TEST_CASE("a number beyond the range of double is reported with its place") {
  for (const std::string& number : std::vector<std::string>{"1e999", "-1e999", "1E400", repeated("9", 400)}) {
    const std::string found = number.size() > 60 ? number.substr(0, 60) + "..." : number;
    std::string text = smallest;
    text.replace(text.find("\"radius\": 1") + 10, 1, number);
    CHECK(error_of(text) == "scene.json: /objects/0/surface/radius: " + found +
                                " is not a number that a double holds, up to 1.8e308");
  }
  CHECK_THAT(error_of(R"({"a": [[1, 2], 1e999]})"), ContainsSubstring("scene.json: /a/1: 1e999 is not "));
}

TEST_CASE("a duplicate key is an error at any depth") {
  CHECK(error_of(R"({"settings": 1, "settings": 2})") ==
        "scene.json: /settings: the key is there twice; once is allowed");
  CHECK(error_of(R"({"a": [0, {"b": 1, "c": {}, "b": 1}]})") ==
        "scene.json: /a/1/b: the key is there twice; once is allowed");
  CHECK(error_of(R"({"a": {"b": 1}, "c": {"b": 1}})").find("twice") == std::string::npos);
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
  const std::string error = error_of(row.text);
  CHECK(error.substr(0, error.find(": ", 30)) == "scene.json: parse error at " + row.place);
  CHECK(std::all_of(error.begin(), error.end(), [](char c) { return c >= ' ' && c <= '~'; }));
}

TEST_CASE("invalid scene files of any kind and size give a short error message") {
  const auto check = [](const std::string& text) {
    const std::string error = error_of(text);
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
  for (std::size_t size = 0; size + 1 < everything.size(); size += 7) check(everything.substr(0, size));
}

TEST_CASE("a scene file may be nested as deep as operations on solids may be, and no deeper") {
  CHECK(error_of(repeated("[", 2049) + repeated("]", 2049)) ==
        "scene.json: " + repeated("/0", 60) + "..." + repeated("/0", 60) +
            ": there are 2049 arrays and objects inside each other; at most 2048 are allowed");
  CHECK_THAT(error_of(repeated("[", 2048) + repeated("]", 2048)), ContainsSubstring("is not an object"));

  const auto of_depth = [](int depth) {
    return repeated(R"({"type": "csg", "operation": "union", "surfaces": [)", depth) + ball +
           repeated("]}", depth);
  };
  CHECK(only_surface(of_depth(1000)).intersect(Ray{}) == 2);
  const std::string error = error_of(with_surface(of_depth(1001)));
  CHECK_THAT(error, ContainsSubstring("scene.json: /objects/0/surface/surfaces: ") &&
                        ContainsSubstring("1000 deep inside each other, and these are 1001"));
  CHECK(error.size() < 300);
  const std::string cube = repeated(R"({"type": "csg", "operation": "union", "surfaces": [)", 1000) +
                           R"({"type": "cube"})" + repeated("]}", 1000);
  CHECK_THAT(error_of(with_surface(cube)),
             ContainsSubstring("/0/surfaces/0/type: \"cube\" is not \"sphere\""));
  CHECK(error_of(with_surface(cube)).size() < 500);

  const std::string instances =
      repeated(R"({"type": "instance", "translate": [0, 0, 1], "surface": )", 2000) + ball +
      repeated("}", 2000);
  CHECK(only_surface(instances).intersect(Ray{}) == 2002);
}

TEST_CASE("operations in a scene file combine solids") {
  const auto crossings = [](const std::string& operation, const std::string& others) {
    std::vector<double> all;
    const AnySurface surface = only_surface(R"({"type": "csg", "operation": ")" + operation +
                                            R"(", "surfaces": [)" + ball + others + "]}");
    surface.each_crossing(Ray{}, {}, [&](const Crossing& crossing) { all.push_back(crossing.t); });
    return all;
  };
  const std::string other = R"(, {"type": "sphere", "position": [0, 0, 4], "radius": 1})";
  const std::string moved = R"(, {"type": "instance", "translate": [0, 0, 1], "surface": )" + ball + "}";
  for (const std::string& second : {other, moved}) {
    CHECK(crossings("union", second) == std::vector<double>{2, 5});
    CHECK(crossings("intersection", second) == std::vector<double>{3, 4});
    CHECK(crossings("difference", second) == std::vector<double>{2, 3});
  }
  CHECK(crossings("union", "") == std::vector<double>{2, 4});
}

TEST_CASE("an instance in a scene file is scaled, then rotated, then moved, or mapped by a matrix") {
  const auto of = [](const std::string& placement) {
    return only_surface(R"({"type": "instance", "surface": )" + ball + placement + "}");
  };
  CHECK(of("").intersect(Ray{}) == 2);
  CHECK(of(R"(, "scale": 2)").intersect(Ray{}) == 4);
  CHECK(of(R"(, "scale": [1, 1, -2])").intersect(Ray{{0, 0, 0}, {0, 0, -1}}) == 4);
  CHECK(of(R"(, "translate": [0, 0, 1])").intersect(Ray{}) == 3);
  CHECK(of(R"(, "rotate": {"axis": [0, 2, 0], "angle": 90})").intersect(Ray{{0, 0, 0}, {1, 0, 0}}) == 2);
  CHECK(of(R"(, "translate": [1, 0, 0], "rotate": {"axis": [0, 1, 0], "angle": 90}, "scale": [1, 1, 2])")
            .intersect(Ray{{0, 0, 0}, {1, 0, 0}}) == 5);
  CHECK(
      of(R"(, "matrix": [[0, 0, 2, 1], [0, 1, 0, 0], [1, 0, 0, 0]])").intersect(Ray{{0, 0, 0}, {1, 0, 0}}) ==
      5);
}

TEST_CASE("an error in a nested surface of a scene file is reported with its place") {
  const auto says = [](const std::string& surface, const std::string& error) {
    CHECK(error_of(with_surface(surface)) == "scene.json: /objects/0/surface" + error);
  };
  const auto csg = [](const std::string& operation, const std::string& surfaces) {
    return R"({"type":"csg","operation":)" + operation + R"(,"surfaces":)" + surfaces + "}";
  };
  says(csg("\"xor\"", "[" + ball + "]"),
       R"(/operation: "xor" is not "union", "intersection" or "difference")");
  says(csg("\"union\"", ball), "/surfaces: " + ball + " is not an array");
  says(csg("\"union\"", "[]"), "/surfaces: [] is not possible: Csg: an operation needs a solid");
  says(csg("\"union\"", "[1]"), "/surfaces/0: 1 is not an object");
  says(csg("\"union\"", "[" + ball + R"(,{"type":"plane","normal":[0,1,0],"distance":0}])"),
       R"(/surfaces/1/type: "plane" is not the type of a closed solid)");
  says(csg("\"union\"", R"([{"type":"instance","surface":{"type":"plane","normal":[0,1,0],"distance":0}}])"),
       R"(/surfaces/0/surface/type: "plane" is not the type of a closed solid)");
  says(csg("\"union\"", R"([{"type":"sphere","position":[0,0,0],"radius":0}])"),
       "/surfaces/0/radius: 0 is not a number greater than 0");
  says(R"({"type":"csg","surfaces":[]})",
       R"(/operation: nothing is not "union", "intersection" or "difference")");
  says(R"({"type":"csg","operands":[]})",
       "/operands: is not a key here; allowed are type, operation and surfaces");

  const auto instance = [](const std::string& placement) {
    return R"({"type":"instance","surface":)" + ball + "," + placement + "}";
  };
  const std::string limit = "at most 2^400 (2.6e120) in magnitude";
  const std::string no_way_back =
      " is not possible: it takes space to a plane or less, or beyond the range of double";
  says(R"({"type":"instance"})", "/surface: nothing is not an object");
  says(instance(R"("shear":1)"),
       "/shear: is not a key here; allowed are type, surface, scale, rotate and translate");
  says(instance(R"("matrix":[],"scale":1)"),
       "/scale: is not a key here; allowed are type, surface and matrix");
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
  put_bytes(folder / "a.json", smallest);
  CHECK(error_reading(folder / "a.json/b.json") == expected(folder / "a.json/b.json", ENOTDIR));
  CHECK(read_scene(folder / "a.json").width == 8);
  CHECK(error_reading("") == expected("", ENOENT));
}

TEST_CASE("the path of a texture's image is relative to the folder of the scene file") {
  const SceneFile file = read_scene(scenes / "image.json");
  const Texture& painting = file.scene.materials<Parallelogram>()[0].texture;
  REQUIRE(painting);
  CHECK(painting(1.2, 0.1) != painting(1.2, 0.9));
  const TemporaryFolder folder;
  std::string text = everything;
  text.replace(text.find("{\"checker\""),
               std::string(R"({"checker": [[1, 0, 0], [0, 0, 1]], "size": 2})").size(),
               R"({"image": "a.png"})");
  put_bytes(folder / "a.json", text);
  put_bytes(folder / "a.png", "no picture");
  const std::string error = message_of<SceneError>([&] { static_cast<void>(read_scene(folder / "a.json")); });
  CHECK_THAT(error,
             ContainsSubstring("/materials/squares/diffuse/image: \"a.png\" is not possible: cannot read '" +
                               (folder / "a.png").string() + "': "));
}

namespace {

/// Returns the scene with everything, in which two materials and the environment have images of these names.
std::string with_images(const std::string& first, const std::string& second, const std::string& environment) {
  const auto image = [](const std::string& name) { return R"({"image": )" + json(name).dump() + "}"; };
  return patched(R"({"op": "replace", "path": "/materials/red/diffuse", "value": )" + image(first) +
                 R"(}, {"op": "replace", "path": "/materials/squares/diffuse", "value": )" + image(second) +
                 R"(}, {"op": "replace", "path": "/world", "value": {"environment": )" +
                 json(environment).dump() + "}}");
}

void put_image(const fs::path& path) {
  fs::copy_file(fs::path(PROTOSTAR_SOURCE_DIR) / "tests/fuzz/corpus_image/baseline.jpg", path);
}
constexpr std::int64_t pixels_of_image = std::int64_t{33} * 19;

}  // namespace

TEST_CASE("an image that a scene file names several times, by any paths, is read once and shared") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "b");
  put_image(folder / "a.jpg");
  fs::create_symlink(folder / "a.jpg", folder / "b/link.jpg");
  put_bytes(folder / "a.json", with_images("a.jpg", "b/../a.jpg", "b/link.jpg"));
  const SceneFile file = read_scene(folder / "a.json", {.most_pixels = pixels_of_image});
  const auto image = [](const Texture& texture) {
    REQUIRE(texture.target<ImageTexture>() != nullptr);
    return texture.target<ImageTexture>()->image.get();
  };
  CHECK(image(file.scene.materials<Sphere>()[0].texture) == image(file.scene.materials<Plane>()[0].texture));

  put_image(folder / "b.jpg");
  put_bytes(folder / "a.json", with_images("a.jpg", "b.jpg", "a.jpg"));
  CHECK(read_scene(folder / "a.json", {.most_pixels = 2 * pixels_of_image}).width == 8);
  CHECK_THAT(
      message_of<SceneError>([&] {
        static_cast<void>(read_scene(folder / "a.json", {.most_pixels = 2 * pixels_of_image - 1}));
      }),
      ContainsSubstring("/materials/squares/diffuse/image: \"b.jpg\" is not possible: cannot read '" +
                        (folder / "b.jpg").string() +
                        "': the picture has 33x19 pixels; allowed are sides of at least 1 and at most 626"));
}

TEST_CASE("a scene file may name files anywhere, or only inside its folder if it is confined") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "scene/images");
  fs::create_directory(folder / "scene and more");
  put_image(folder / "outside.jpg");
  put_image(folder / "scene and more/a.jpg");
  put_image(folder / "scene/images/a.jpg");
  put_image(folder / "scene/..a.jpg");
  fs::create_symlink(folder / "outside.jpg", folder / "scene/link.jpg");
  fs::create_symlink("images/a.jpg", folder / "scene/inner_link.jpg");
  fs::create_directory_symlink(folder / "scene", folder / "scene_link");
  const std::string real = fs::canonical(folder / "").string() + "/";
  const auto error = [&](const std::string& scene, const std::string& name, bool confine) {
    put_bytes(folder / scene, with_images(name, name, name));
    return message_of<SceneError>(
        [&] { static_cast<void>(read_scene(folder / scene, {.confine = confine})); });
  };
  for (const std::string scene : {"scene/a.json", "scene_link/a.json"}) {
    for (const std::string& name :
         {std::string("images/a.jpg"), std::string("./images/../images/a.jpg"), std::string("inner_link.jpg"),
          std::string("..a.jpg"), std::string("../scene/images/a.jpg"), real + "scene/images/a.jpg"}) {
      CAPTURE(scene, name);
      CHECK(error(scene, name, false) == "");
      CHECK(error(scene, name, true) == "");
    }
    for (const std::string& name :
         {std::string("../outside.jpg"), std::string("images/../../outside.jpg"), std::string("link.jpg"),
          std::string("../scene and more/a.jpg"), real + "outside.jpg"}) {
      CAPTURE(scene, name);
      CHECK(error(scene, name, false) == "");
      const std::string file =
          name.find("more") == std::string::npos ? "outside.jpg" : "scene and more/a.jpg";
      CHECK(error(scene, name, true) == (folder / scene).string() + ": /world/environment: \"" + name +
                                            "\" is not inside of the scene's folder: it is '" + real + file +
                                            "', and the folder '" + real + "scene'");
    }
  }
}

TEST_CASE("files that a scene file names must be regular files, so that reading ends") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  fs::create_directory(folder / "folder");
  fs::create_symlink("/dev/zero", folder / "zero");
  const auto error = [&](const std::string& text) {
    put_bytes(folder / "a.json", text);
    return message_of<SceneError>([&] { static_cast<void>(read_scene(folder / "a.json")); });
  };
  for (const std::string name : {"pipe", "folder", "zero", "/dev/zero", "/dev/urandom"}) {
    const std::string why =
        "\"" + name + "\" is not possible: '" + (folder / "").string() + name + "' is not a regular file";
    CAPTURE(name);
    if (name[0] != '/')
      CHECK_THAT(error(with_images(name, name, name)), ContainsSubstring("/world/environment: " + why));
    CHECK_THAT(error(replacing("/world", R"({"environment": ")" + name + "\"}")),
               ContainsSubstring("' is not a regular file"));
#if defined(PROTOSTAR_READS_MESHES)
    CHECK_THAT(error(with_surface(R"({"type": "mesh", "file": ")" + name + "\"}")),
               ContainsSubstring("' is not a regular file"));
#endif
  }
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
       {with_name(with("/NAME", "1")), with_name(with("/materials/NAME", "1")),
        with_name(with("/settings/NAME", "1")), with_name(replacing("/settings/tone", "\"NAME\"")),
        with_name(replacing("/objects/0/material-id", "\"NAME\"")),
        with_name(replacing("/materials/red/diffuse", R"({"image": "NAME"})")),
        with_name(R"({"NAME": 1e999})"), R"({"NAME": 1, "NAME": 2})" + bad, with_name(R"({"NAME": nul)")}) {
    const std::string error = error_of(text);
    CHECK(error.starts_with("scene.json: "));
    is_plain(error);
  }
  CHECK_THAT(error_of(with_name(with("/NAME", "1"))),
             ContainsSubstring("scene.json: /\\x1b[31m\\x07\\x0a\\x7f\\xc2\\x9b: is not a key"));
  is_plain(message_of<SceneError>([] { static_cast<void>(scene_from_json("[]", "a\x1b\n")); }));
  is_plain(
      message_of<SceneError>([] { static_cast<void>(scene_from_json(std::string(1, '\0'), "a\x1b\n")); }));
  is_plain(message_of<std::system_error>([] { static_cast<void>(read_scene("a\x1b\n")); }));
}

TEST_CASE("the path of an environment is relative to the folder of the scene file, and excludes a sky") {
  const TemporaryFolder folder;
  const auto written = [&](const std::string& world) {
    put_bytes(folder / "a.json", replacing("/world", world));
    return folder / "a.json";
  };
  // A Radiance file of two pixels: 128 with the exponent byte 129 is 128 · 2^(129−128−8) = 1.
  put_bytes(folder / "a.hdr", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                                  "\x80\x40\x20\x81" + "\x20\x40\x80\x82");
  const SceneFile file = read_scene(written(R"({"environment": "a.hdr"})"));
  CHECK(!file.scene.sky());
  CHECK(sky_of(Ray{Point{0}, {-1, 0, 0}}, file.scene, Color{0}) == Color{1, 0.5f, 0.25f});
  CHECK(sky_of(Ray{Point{0}, {1, 0, 0}}, file.scene, Color{0}) == Color{0.5f, 1, 2});

  const auto error_in = [&](const std::string& world) {
    return message_of<SceneError>([&] { static_cast<void>(read_scene(written(world))); });
  };
  CHECK_THAT(error_in(R"({"environment": "b.hdr"})"),
             ContainsSubstring("/world/environment: \"b.hdr\" is not possible: cannot read '" +
                               (folder / "b.hdr").string() + "': "));
  CHECK_THAT(error_in(R"({"environment": 3})"), ContainsSubstring(": 3 is not the path of a file"));
  CHECK_THAT(error_in(R"({"environment": "a.hdr", "sky": [1, 1, 1]})"),
             ContainsSubstring("/world/sky: [1,1,1] is not possible beside an environment"));
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

TEST_CASE("all scenes of the project can be read") {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    INFO(entry.path());
    CHECK(read_scene(entry.path()).scene.size() > 0);
    ++count;
  }
  CHECK(count >= 15);
}

TEST_CASE("the three spheres are the same from the scene file and from the header") {
  const SceneFile file = read_scene(scenes / "three_spheres.json");
  const auto expected = three_spheres();
  CHECK(same_camera(file.camera, Camera{}));
  CHECK(!file.scene.sky());
  CHECK(file.scene.size() == expected.size());
  REQUIRE(file.scene.surfaces<Sphere>().size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(file.scene.surfaces<Sphere>()[i].center == expected.surfaces<Sphere>()[i].center);
    CHECK(file.scene.surfaces<Sphere>()[i].radius == expected.surfaces<Sphere>()[i].radius);
    CHECK(file.scene.materials<Sphere>()[i].diffuse == expected.materials<Sphere>()[i].diffuse);
  }
  REQUIRE(file.scene.lights().size() == 1);
  const Point point{0.3, 0.2, 2};
  const Vec3 up{0, 1, 0};
  CHECK(file.scene.lights()[0].towards(point) == expected.lights()[0].towards(point));
  CHECK(file.scene.lights()[0].irradiance(point, up) == expected.lights()[0].irradiance(point, up));
}

namespace {

/// Keys, or words, by the kind of place where they stand.
using Vocabulary = std::map<std::string, std::set<std::string>>;

/// Returns the kind of place that a JSON pointer leads to: * stands for the index or the name of one of many.
/// A nested surface has the kind of the surface that contains it.
std::string kind_of(const std::string& pointer) {
  std::string kind;
  std::istringstream steps(pointer);
  steps.get();  // the first slash
  for (std::string step; std::getline(steps, step, '/');)
    if (step == "surfaces")
      std::getline(steps, step, '/');
    else if (step != "surface" || !kind.ends_with("/surface"))
      kind += '/' + (kind == "/materials" || (step[0] >= '0' && step[0] <= '9') ? "*" : step);
  return kind;
}

/// Returns the names in a message's list, "a, b and c" or "a, b or c".
std::set<std::string> list_in(const std::string& error) {
  std::set<std::string> names;
  std::string name;
  std::istringstream words(error);
  while (words >> name) {
    std::erase_if(name, [](char c) { return c == ',' || c == '"'; });
    if (name != "and" && name != "or") names.insert(name);
  }
  return names;
}

/// Adds to `allowed` the keys and words that a file may have at its places, which the reader lists when it is
/// given others, and to `used` those that the file has there.
void look_at(const fs::path& path, const std::string& text, Vocabulary& allowed, Vocabulary& used) {
  const json scene = json::parse(text), flat = scene.flatten();
  const auto list_after = [&](const json& wrong, const std::string& before) {
    const std::string error =
        message_of<SceneError>([&] { static_cast<void>(scene_from_json(wrong.dump(), path.string())); });
    CAPTURE(error);
    const std::size_t begin = error.find(before);
    REQUIRE(begin != std::string::npos);
    return list_in(error.substr(begin + before.size()));
  };

  std::set<std::string> objects;
  for (const auto& [pointer, value] : flat.items()) {
    for (json::json_pointer in(pointer); !in.empty();) {
      in = in.parent_pointer();
      if (scene[in].is_object()) objects.insert(in.to_string());
    }
    const bool is_name = pointer.ends_with("/material-id") || pointer.ends_with("/image") ||
                         pointer.ends_with("/file") || pointer.ends_with("/environment");
    if (!value.is_string() || is_name) continue;
    json wrong = scene;
    wrong[json::json_pointer(pointer)] = "?";
    allowed[kind_of(pointer)].merge(list_after(wrong, "\"?\" is not "));
    used[kind_of(pointer)].insert(value);
  }
  objects.erase("/materials");  // its keys are names
  for (const std::string& pointer : objects) {
    json wrong = scene;
    wrong[json::json_pointer(pointer)]["?"] = 0;
    std::set<std::string> keys = list_after(wrong, "/?: is not a key here; allowed are ");
    // Objects that may have the same keys are one kind of place, as all spheres are. Lights are one kind
    // together, since the keys that one may have depend on those that it has.
    std::string kind = kind_of(pointer);
    if (kind != "/lights/*")
      for (const std::string& key : keys) kind += ' ' + key;
    allowed[kind].merge(keys);
    for (const auto& [key, value] : scene[json::json_pointer(pointer)].items()) used[kind].insert(key);
  }
}

}  // namespace

TEST_CASE("every key and word of a scene file has an example in a scene of the project, and is documented") {
  Vocabulary allowed, used, elsewhere;
  look_at("scene.json", everything, allowed, elsewhere);
  for (const auto& entry : fs::directory_iterator(scenes))
    if (entry.path().extension() == ".json") look_at(entry.path(), bytes_of(entry.path()), allowed, used);
  const std::string docs = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "scene-format.md");
  int count = 0;
  for (const auto& [kind, words] : allowed)
    for (const std::string& word : words) {
      CAPTURE(kind, word);
      CHECK(used[kind].contains(word));
      CHECK((docs.find('`' + word + '`') != std::string::npos ||
             docs.find('"' + word + '"') != std::string::npos));
      ++count;
    }
  CHECK(count > 60);
}

TEST_CASE("the examples in the documentation of scene files can be read") {
  std::ifstream page(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "scene-format.md");
  std::vector<std::string> examples;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```json") examples.emplace_back();
    if (inside && line != "```") examples.back() += line + "\n";
    inside = line == "```json" || (inside && line != "```");
  }
  REQUIRE(!examples.empty());
  for (const std::string& example : examples) {
    INFO(example);
    CHECK(error_of(example) == "");
  }
}

TEST_CASE("the errors and the limits in the documentation of scene files agree with the reader") {
  const std::string docs = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "scene-format.md");
  const std::string sphere =
      R"({"surface": {"type": "sphere", "position": [0, 0, 0], "radius": -1}, "color": [1, 1, 1]})";
  for (const std::string& text : {with("/objects/3", sphere), std::string("{\n  \"a\": 1,\n}")})
    CHECK_THAT(docs, ContainsSubstring("\nrender: " + error_of(text) + "\n"));
  CHECK_THAT(docs, ContainsSubstring("from 1 to " + std::to_string(most_depth)));
  CHECK_THAT(docs, ContainsSubstring("from 0 to " + std::to_string(most_samples)));
  CHECK_THAT(docs, ContainsSubstring("`depth` at most " + std::to_string(most_depth)));
  CHECK_THAT(docs, ContainsSubstring("`samples` at most " + std::to_string(most_samples)));
  CHECK_THAT(docs, ContainsSubstring("at most 2^24 values in a file"));
  CHECK(protostar::detail::most_values == 1 << 24);
  CHECK_THAT(docs, ContainsSubstring("an image of at most 2^26 pixels"));
  CHECK(most_image_pixels == 1 << 26);
  CHECK_THAT(docs, ContainsSubstring("together 2^28"));
  CHECK(ReadOptions{}.most_pixels == 1 << 28);
}

TEST_CASE("a scene file of Luminosity is read without changes") {
  // Keys and their forms are those of the scene that comes with Luminosity; the numbers are ours.
  const SceneFile file = read(R"({
	"settings": {"resolution-x": 192, "resolution-y": 108, "samples": 0, "depth": 10},
	"world": {"sky": [1, 1, 1]},
	"camera": {"projection": "perspective", "position": [0, 2, -12], "direction": [0, 0, 1],
		"upward": [0, 1, 0], "focal-length": 2.5},
	"objects": [
		{"surface": {"type": "sphere", "position": [0, 2.5, 0], "radius": 1}, "material-id": "ball"},
		{"surface": {"type": "plane", "normal": [1, 0, -1], "distance": -3}, "material-id": "wall"}],
	"lights": [{"position": [4, 7, -6], "intensity": [0.9, 0.9, 0.8]}],
	"materials": {"ball": {"diffuse": [0.8, 0.7, 0], "reflect": 0.2},
		"wall": {"diffuse": [0.5, 0.5, 0.5], "reflect": 0.4}}
})");
  CHECK(file.integrator == "whitted");
  CHECK(std::holds_alternative<Srgb>(file.transfer));
  CHECK(same_camera(file.camera, Camera::sensor({0, 2, -12}, {0, 0, 1}, {0, 1, 0}, 2.5)));
  // The distance is along the unit normal.
  CHECK(file.scene.surfaces<Plane>()[0].distance == -3);
  CHECK(length(file.scene.surfaces<Plane>()[0].normal - Vec3{1, 0, -1} / std::sqrt(2.0)) < 1e-15);
  // A light with an intensity is equally bright at any distance.
  const Vec3 up{0, 1, 0};
  CHECK(file.scene.lights()[0].irradiance(Point{4, 0, -6}, up) == Color{0.9f, 0.9f, 0.8f});
  CHECK(file.scene.lights()[0].irradiance(Point{4, -100, -6}, up) == Color{0.9f, 0.9f, 0.8f});
}

TEST_CASE("triangles of a scene file are given by three points, and are two-sided") {
  const auto surface = [](const std::string& points) {
    return replacing("/objects/2/surface", R"({"type": "triangle", "points": )" + points + "}");
  };
  const SceneFile file = read(surface("[[0, 0, 1], [2, 0, 1], [0, 2, 1]]"));
  CHECK(file.scene.surfaces<AnySurface>().at(0).intersect({{0.5, 0.5, 0}, {0, 0, 1}}) == 1);
  for (const auto& [points, error] : std::vector<std::pair<std::string, std::string>>{
           {"[[0,0,1],[2,0,1]]", "[[0,0,1],[2,0,1]] is not an array of three points"},
           {"[[0,0,1],[1,1,1],[2,2,1]]", "is not possible: Triangle: a, b and c must not be on one line"}})
    CHECK_THAT(error_of(surface(points)),
               ContainsSubstring("/objects/2/surface/points: ") && ContainsSubstring(error));
}

#if defined(PROTOSTAR_READS_MESHES)
TEST_CASE(
    "the path of a mesh is relative to the folder of the scene file, and the mesh is scaled, then moved") {
  const TemporaryFolder folder;
  const auto scene = [&](const std::string& more) {
    put_bytes(folder / "a.json",
              replacing("/objects/2/surface", R"({"type": "mesh", "file": "a.obj")" + more + "}"));
    return folder / "a.json";
  };
  put_bytes(folder / "a.obj", "v 0 0 1\nv 3 0 1\nv 0 2 1\nf 1 2 3\n");
  const auto bounds = [&](const std::string& more) {
    return read_scene(scene(more)).scene.surfaces<AnySurface>().at(0).bounds();
  };
  CHECK(bounds("").max == Point{3, 2, 1});
  CHECK(bounds(R"(, "scale": 0.5, "position": [10, 0, -1])").min == Point{10, 0, -0.5});
  const auto error = [&](const std::string& more) {
    return message_of<SceneError>([&] { (void)read_scene(scene(more)); });
  };
  CHECK_THAT(error(R"(, "scale": 0)"),
             ContainsSubstring("/objects/2/surface/scale: 0 is not a number greater than 0"));
  CHECK_THAT(error(R"(, "scale": 1e120)"),
             ContainsSubstring("/objects/2/surface/scale: 1e+120 is not one that leaves the numbers of all "
                               "vertices at most 2^400"));
  CHECK_THAT(error(R"(, "scale": 8e119, "position": [1e120, 0, 0])"),
             ContainsSubstring("/objects/2/surface/position: [1e+120,0,0] is not one that leaves the "
                               "numbers of all vertices at most 2^400"));
  CHECK_THAT(error(R"(, "smooth": true)"), ContainsSubstring("allowed are type, file, position and scale"));
  put_bytes(folder / "a.obj", "v 0 0 1\nf 1 2 3\n");
  CHECK_THAT(error(""), ContainsSubstring(R"(/objects/2/surface/file: "a.obj" is not possible: )" +
                                          (folder / "a.obj").string() +
                                          ": line 2: vertex 2 is not one of the 1 so far"));
  fs::remove(folder / "a.obj");
  CHECK_THAT(error(""),
             ContainsSubstring("/objects/2/surface/file: \"a.obj\" is not possible: cannot read '"));
}

TEST_CASE(
    "a mesh that a scene file names several times is read once, and shared if scale and position are equal") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.obj", "v 0 0 1\nv 2 0 1\nv 0 2 1\nf 1 2 3\n");
  fs::create_symlink("a.obj", folder / "b.obj");
  const auto mesh = [](const std::string& more) {
    return R"({"color": [1, 1, 1], "surface": {"type": "mesh", "file": )" + more + "}}";
  };
  put_bytes(folder / "a.json",
            replacing("/objects", "[" + mesh(R"("a.obj")") + "," + mesh(R"("b.obj", "scale": 1)") + "," +
                                      mesh(R"("a.obj", "scale": 2)") + "," +
                                      mesh(R"("./b.obj", "position": [0, 0, 1], "scale": 2)") + "," +
                                      mesh(R"("./b.obj", "position": [0, 0, 1], "scale": 2)") + "]"));
  const SceneFile file = read_scene(folder / "a.json");
  const auto& meshes = file.scene.surfaces<AnySurface>();
  REQUIRE(meshes.size() == 5);
  const auto contents = [&](std::size_t i) { return meshes[i].departure(0).object; };
  CHECK(contents(0) == contents(1));
  CHECK(contents(0) != contents(2));
  CHECK(contents(2) != contents(3));
  CHECK(contents(3) == contents(4));
  CHECK(meshes[1].bounds().max == Point{2, 2, 1});
  CHECK(meshes[2].bounds().max == Point{4, 4, 2});
  CHECK(meshes[4].bounds().max == Point{4, 4, 3});
}

TEST_CASE("a mesh in a scene file may be cut with other solids if it is closed") {
  const TemporaryFolder folder;
  const auto read_cut = [&](const std::string& first) {
    put_bytes(folder / "a.json", with_surface(R"({"type": "csg", "operation": "difference", "surfaces": [)" +
                                              first + ", " + ball + "]}"));
    return read_scene(folder / "a.json");
  };
  const std::string mesh = R"({"type": "mesh", "file": "a.obj", "scale": 2})";
  const std::string open = "v -5 -5 1\nv 5 -5 1\nv 0 5 1\nv 0 0 4 # the top\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";
  put_bytes(folder / "a.obj", open + "f 3 1 4\n");
  std::vector<double> crossings;
  read_cut(mesh).scene.surfaces<AnySurface>().at(0).each_crossing(
      Ray{}, {}, [&](const Crossing& crossing) { crossings.push_back(crossing.t); });
  CHECK(crossings == std::vector<double>{4, 8});  // from 2 to 4 the ball is subtracted
  put_bytes(folder / "a.obj", open);
  const auto error = [&](const std::string& first) {
    return message_of<SceneError>([&] { (void)read_cut(first); });
  };
  CHECK_THAT(error(mesh),
             ContainsSubstring("/objects/0/surface/surfaces/0/file: \"a.obj\" is not the file of a closed "
                               "mesh, whose triangles share each edge"));
  CHECK_THAT(error(R"({"type": "instance", "surface": )" + mesh + "}"),
             ContainsSubstring("/surfaces/0/surface/file: \"a.obj\" is not the file of a closed mesh"));
}
#endif

TEST_CASE("the fuzzing corpus of scene files, like every scene, is read or refused with a message") {
  int files = 0;
  for (const fs::path& folder : {fs::path(PROTOSTAR_SOURCE_DIR) / "tests/fuzz/corpus", scenes})
    for (const auto& entry : fs::directory_iterator(folder)) {
      INFO(entry.path());
      CHECK_NOTHROW(read_any_bytes(bytes_of(entry.path())));
      ++files;
    }
  CHECK(files > 30);
}
