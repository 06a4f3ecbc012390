// Scene files: their meaning.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <protostar/io/json_scene.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/scene_files.hpp"

namespace fs = std::filesystem;
using namespace protostar;
using nlohmann::json;

namespace {

/// Tests whether two cameras have the same rays.
bool same_camera(const Camera& a, const Camera& b) {
  return a.position == b.position && a.right == b.right && a.up == b.up && a.forward == b.forward &&
         a.film_right == b.film_right && a.film_up == b.film_up && a.aperture == b.aperture &&
         a.focus == b.focus;
}

}  // namespace

TEST_CASE("a scene file needs a resolution, a camera and objects; all else has a default") {
  const SceneFile file = scene_of_text(smallest_scene);
  CHECK(file.width == 8);
  CHECK(file.height == 6);
  CHECK(file.samples == 0);
  CHECK(file.sampler.empty());
  CHECK(file.filter == "box");
  CHECK(file.seed == 0);
  CHECK(!file.depth);
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

  const SceneFile plain = scene_of_text(replacing("/objects/0/material-id", R"("black")"));
  const Material& material = plain.scene.materials<Sphere>()[0];
  CHECK(material.diffuse == Color{0});
  CHECK(!material.texture);
  CHECK(material.specular == Color{0});
  CHECK(material.shininess == 50);
  CHECK(material.reflect == 0);
  CHECK(material.refract == 0);
  CHECK(material.ior == 1.5);
  CHECK(material.emission == Color{0});
  CHECK(material.glossy == Color{0});
  CHECK(material.roughness == 0.5);
}

TEST_CASE("a scene file may have an error in the place of samples") {
  CHECK(scene_of_text(scene_of_everything).error == 0);
  const SceneFile file = scene_of_text(patched(R"({"op": "remove", "path": "/settings/samples"},
                 {"op": "add", "path": "/settings/error", "value": 0.25},
                 {"op": "replace", "path": "/settings/sampler", "value": "independent"})"));
  CHECK(file.error == 0.25);
  CHECK(file.samples == 0);
}

TEST_CASE("a scene file chooses sampler, filter and seed") {
  const SceneFile file =
      scene_of_text(patched(R"({"op": "add", "path": "/settings/sampler", "value": "halton"},
                 {"op": "add", "path": "/settings/filter", "value": "blackman-harris"},
                 {"op": "add", "path": "/settings/seed", "value": 18446744073709551615})"));
  CHECK(file.sampler == "halton");
  CHECK(file.filter == "blackman-harris");
  CHECK(file.seed == 18446744073709551615u);
}

TEST_CASE("all properties of a scene can be given in a scene file") {
  const SceneFile file = scene_of_text(scene_of_everything);
  CHECK(file.samples == 4);
  CHECK(file.sampler == "stratified");
  CHECK(file.filter == "tent");
  CHECK(file.seed == 7);
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
  CHECK(red.emission == Color{0.25f, 0, 2});
  CHECK(red.glossy == Color{0.9f, 0.5f, 0});
  CHECK(red.roughness == 0.125);

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

TEST_CASE("boxes, disks, quadrics and tori of a scene file are read correctly") {
  const auto only = [](const std::string& surface) {
    const SceneFile file =
        scene_of_text(replacing("/objects", R"([{"color": [1, 1, 1], "surface": )" + surface + "}]"));
    REQUIRE(file.scene.surfaces<AnySurface>().size() == 1);
    return file.scene.surfaces<AnySurface>()[0];
  };
  const AnySurface box = only(R"({"type": "box", "min": [-1, 0, 2], "max": [1, 3, 5]})");
  CHECK(box.intersect({{0, 1, 0}, {0, 0, 1}}) == 2);
  CHECK(box.intersect({{0, 1, 7}, {0, 0, -1}}) == 2);
  CHECK(box.intersect({{-3, 1, 3}, {1, 0, 0}}) == 2);
  CHECK(box.intersect({{3, 1, 3}, {-1, 0, 0}}) == 2);
  CHECK(box.intersect({{0, -2, 3}, {0, 1, 0}}) == 2);
  CHECK(box.intersect({{0, 5, 3}, {0, -1, 0}}) == 2);
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
  const AnySurface torus =
      only(R"({"type": "torus", "position": [1, 2, 3], "axis": [2, 0, 0], "radius": 2, "tube": 0.5})");
  CHECK(torus.intersect({{-9, 2, 5}, {1, 0, 0}}) == 9.5);
  CHECK_FALSE(torus.intersect({{-9, 2, 4}, {1, 0, 0}}));
  for (const std::string length : {"1e-320", "1e308"}) {  // directions of any length but 0
    const AnySurface along_x = only(R"({"type": "torus", "position": [1, 2, 3], "axis": [)" + length +
                                    R"(, 0, 0], "radius": 2, "tube": 0.5})");
    CHECK(along_x.intersect({{-9, 2, 5}, {1, 0, 0}}) == 9.5);
    const AnySurface facing_z =
        only(R"({"type": "disk", "position": [1, 2, 5], "normal": [0, 0, -)" + length + R"(], "radius": 2})");
    CHECK(facing_z.intersect({{3, 2, 0}, {0, 0, 1}}) == 5);
  }
  const AnySurface upright = only(R"({"type": "torus", "position": [0, 0, 0], "radius": 2, "tube": 0.5})");
  CHECK(upright.intersect({{0, -9, 2}, {0, 1, 0}}) == 8.5);
}

TEST_CASE("the camera of a scene file may have a lens, and one of aperture 0 is a pinhole") {
  const auto with_lens = [](const std::string& aperture) {
    return scene_of_text(replacing("/camera", R"({"projection": "perspective", "position": [1, 2, 3],
        "direction": [0, 0, 1], "upward": [0, 1, 0], "field-of-view": 50, "focus": 4, "aperture": )" +
                                                  aperture + "}"))
        .camera;
  };
  CHECK(same_camera(with_lens("0.25"), Camera::thin_lens({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 50, 0.25, 4)));
  CHECK(with_lens("0").is_pinhole());
}

TEST_CASE("surfaces of a scene file may move while the camera's shutter is open") {
  const auto hit_at = [](const std::string& shutter, double time) {
    const SceneFile file =
        scene_of_text(patched(R"({"op": "add", "path": "/camera/shutter", "value": )" + shutter + R"(},
           {"op": "replace", "path": "/objects", "value": [{"surface": {"type": "instance", "surface":
              {"type": "sphere", "position": [0, 0, 0], "radius": 1}, "translate": [0, 0, 5],
              "velocity": [0, 0, 2]}, "color": [1, 1, 1]}]})"));
    return file.scene.intersect(Ray{.time = time}, Interval{}).value().t;
  };
  CHECK(hit_at("[0, 1]", 0) == 4);
  CHECK(hit_at("[0, 1]", 0.5) == 5);
  CHECK(hit_at("[0, 1]", 7) == 6);
  CHECK(hit_at("[2, 3]", 2.5) == 9);
  CHECK(hit_at("[-1, -1]", 0) == 2);
  CHECK(scene_of_text(patched(R"({"op": "add", "path": "/camera/shutter", "value": [0.25, 0.5]})"))
            .camera.shutter == Shutter{0.25, 0.5});
  CHECK(scene_of_text(smallest_scene).camera.shutter == Shutter{});
  CHECK(scene_error(patched(R"({"op": "replace", "path": "/objects/0/surface", "value": {"type": "instance",
          "surface": {"type": "sphere", "position": [0, 0, 0], "radius": 1, "velocity": [1, 0, 0]},
          "translate": [0, 0, 5]}})")) ==
        "scene.json: /objects/0/surface/surface/velocity: [1,0,0] is not possible in a part of another "
        "surface: it is the whole surface that moves");
}

TEST_CASE("the camera of a scene file may move while its shutter is open") {
  const auto camera_with = [](const std::string& keys) { return scene_of_text(patched(keys)).camera; };
  const std::string shutter = R"({"op": "add", "path": "/camera/shutter", "value": [0.25, 0.5]})",
                    velocity = R"({"op": "add", "path": "/camera/velocity", "value": [1, -2, 0.5]})";
  const Camera moving = camera_with(shutter + "," + velocity);
  CHECK(moving.velocity == Vec3{1, -2, 0.5});
  CHECK(moving.shutter == Shutter{0.25, 0.5});
  CHECK(camera_with(velocity).velocity == Vec3{1, -2, 0.5});
  CHECK(!camera_with(shutter).is_moving());
}

TEST_CASE("a scene file chooses the lobe of a blurred mirror") {
  const auto material_with = [](const std::string& keys) {
    const SceneFile file = scene_of_text(
        patched(R"({"op": "add", "path": "/materials", "value": {"m": {"glossy": [1, 1, 1])" + keys +
                R"(}}}, {"op": "replace", "path": "/objects", "value": [{"surface": {"type": "sphere",
           "position": [0, 0, 5], "radius": 1}, "material-id": "m"}]})"));
    return file.scene.intersect(Ray{}, Interval{}).value().material();
  };
  CHECK(material_with("").blur == Blur::ggx);
  CHECK(material_with(R"(, "blur": "ggx", "shininess": 1e10)").blur == Blur::ggx);
  const Material phong = material_with(R"(, "blur": "phong", "shininess": 12)");
  CHECK(phong.blur == Blur::phong);
  CHECK(phong.shininess == 12);
}

TEST_CASE("a scene file may have one of three kinds of cameras") {
  const std::string sensor = R"({"projection": "perspective", "position": [1, 2, 3], "direction": [0, 0, 1],
      "upward": [0, 1, 0], "focal-length": 3})";
  CHECK(same_camera(scene_of_text(replacing("/camera", sensor)).camera,
                    Camera::sensor({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 3)));
  const std::string orthographic = R"({"projection": "orthographic", "position": [1, 2, 3],
      "direction": [0, 0, 1], "upward": [0, 1, 0], "ortho-scale": 4})";
  CHECK(same_camera(scene_of_text(replacing("/camera", orthographic)).camera,
                    Camera::orthographic({1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 4)));
}

TEST_CASE("names in a scene file may be any text, and numbers may have any form of JSON") {
  CHECK(scene_of_text(replacing("/settings/resolution-x", "8.0")).width == 8);
  CHECK(scene_of_text(replacing("/settings/resolution-x", "0.8e1")).width == 8);
  CHECK(scene_of_text(replacing("/settings/transfer", R"("srgb")")).transfer.index() ==
        Transfer(Srgb{}).index());
  CHECK(scene_of_text(replacing("/settings/transfer", R"("linear")")).transfer.index() ==
        Transfer(Linear{}).index());
  CHECK(scene_of_text(replacing("/settings/tone", R"("scale-image")")).tone == Tone::scale_image);
  CHECK(scene_of_text(replacing("/settings/tone", R"("clip")")).tone == Tone::clip);
  for (const std::string_view name : integrator_names) {
    // Some need distances from all surfaces, or marched ones (json_scene_fields.cpp).
    if (name.starts_with("distance-") || name == "evaluations" || name == "enclosure-width") continue;
    CHECK(scene_of_text(replacing("/settings/integrator", json(name).dump())).integrator == name);
  }
  CHECK(scene_of_text(replacing("/objects", "[]")).scene.size() == 0);
  CHECK(scene_of_text(scene_with("/materials/~1~0 \xc3\xa4\\n", "{}")).scene.size() == 3);
  CHECK(scene_of_text("\xef\xbb\xbf" + smallest_scene).width == 8);  // a byte order mark
}

TEST_CASE("factors on light that underflow in float are read as 0") {
  const SceneFile file =
      scene_of_text(patched(R"({"op": "replace", "path": "/materials/red/reflect", "value": 1e-60},
      {"op": "replace", "path": "/materials/red/refract", "value": 1e-60},
      {"op": "replace", "path": "/settings/exposure", "value": 1e-60})"));
  CHECK(file.scene.materials<Sphere>()[0].reflect == 0);
  CHECK(file.scene.materials<Sphere>()[0].refract == 0);
  CHECK(file.exposure == 0);
}

TEST_CASE("the sum of ambient lights is clamped to the limit of irradiance") {
  const SceneFile file =
      scene_of_text(replacing("/lights", R"([{"ambient": [3e38, 1, 0]}, {"ambient": [3e38, 1, 0]}])"));
  CHECK(file.scene.ambient() == Color{most_irradiance, 2, 0});
}

TEST_CASE("operations in a scene file combine solids") {
  const auto crossings = [](const std::string& operation, const std::string& others) {
    std::vector<double> all;
    const AnySurface surface = only_surface(R"({"type": "csg", "operation": ")" + operation +
                                            R"(", "surfaces": [)" + ball_in_json + others + "]}");
    surface.each_crossing(Ray{}, {}, [&](const Crossing& crossing) { all.push_back(crossing.t); });
    return all;
  };
  const std::string other = R"(, {"type": "sphere", "position": [0, 0, 4], "radius": 1})";
  const std::string moved =
      R"(, {"type": "instance", "translate": [0, 0, 1], "surface": )" + ball_in_json + "}";
  for (const std::string& second : {other, moved}) {
    CHECK(crossings("union", second) == std::vector<double>{2, 5});
    CHECK(crossings("intersection", second) == std::vector<double>{3, 4});
    CHECK(crossings("difference", second) == std::vector<double>{2, 3});
  }
  CHECK(crossings("union", "") == std::vector<double>{2, 4});
}

TEST_CASE("an instance in a scene file is scaled, then rotated, then moved, or mapped by a matrix") {
  const auto of = [](const std::string& placement) {
    return only_surface(R"({"type": "instance", "surface": )" + ball_in_json + placement + "}");
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

TEST_CASE("all scenes of the project can be read") {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(scenes_folder)) {
    if (entry.path().extension() != ".json") continue;
    INFO(entry.path());
    CHECK(read_scene(entry.path()).scene.size() > 0);
    ++count;
  }
  CHECK(count >= 15);
}

TEST_CASE("the three spheres are the same from the scene file and from the header") {
  const SceneFile file = read_scene(scenes_folder / "three_spheres.json");
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

TEST_CASE("a scene file of Luminosity is read without changes") {
  // Keys and their forms are those of the scene that comes with Luminosity; the numbers are ours.
  const SceneFile file = scene_of_text(R"({
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
  CHECK(file.scene.surfaces<Plane>()[0].normal == Vec3{1, 0, -1} / std::sqrt(2.0));
  // A light with an intensity is equally bright at any distance.
  const Vec3 up{0, 1, 0};
  CHECK(file.scene.lights()[0].irradiance(Point{4, 0, -6}, up) == Color{0.9f, 0.9f, 0.8f});
  CHECK(file.scene.lights()[0].irradiance(Point{4, -100, -6}, up) == Color{0.9f, 0.9f, 0.8f});
}

TEST_CASE("triangles of a scene file are given by three points, and are two-sided") {
  const auto surface = [](const std::string& points) {
    return replacing("/objects/2/surface", R"({"type": "triangle", "points": )" + points + "}");
  };
  const SceneFile file = scene_of_text(surface("[[0, 0, 1], [2, 0, 1], [0, 2, 1]]"));
  CHECK(file.scene.surfaces<AnySurface>().at(0).intersect({{0.5, 0.5, 0}, {0, 0, 1}}) == 1);
  for (const auto& [points, error] : std::vector<std::pair<std::string, std::string>>{
           {"[[0,0,1],[2,0,1]]", "[[0,0,1],[2,0,1]] is not an array of three points"},
           {"[[0,0,1],[1,1,1],[2,2,1]]", "is not possible: Triangle: a, b and c must not be on one line"}})
    CHECK_THAT(scene_error(surface(points)),
               ContainsSubstring("/objects/2/surface/points: ") && ContainsSubstring(error));
}
