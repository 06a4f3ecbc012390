// Images and meshes that a scene file names: the paths to them, the files that are refused, and that each is
// read once.
#include <sys/stat.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <protostar/io/image_texture.hpp>
#include <protostar/io/json_scene.hpp>
#include <protostar/io/loaded_files.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/scene_files.hpp"

namespace fs = std::filesystem;
using namespace protostar;
using nlohmann::json;

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

TEST_CASE("the path of a texture's image is relative to the folder of the scene file") {
  const SceneFile file = read_scene(scenes_folder / "image.json");
  const Texture& painting = file.scene.materials<Parallelogram>()[0].texture;
  REQUIRE(painting);
  CHECK(painting(1.2, 0.1) != painting(1.2, 0.9));
  const TemporaryFolder folder;
  std::string text = scene_of_everything;
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

TEST_CASE("a normal map is read as linear numbers, and once, also if its image is a texture as well") {
  const std::int64_t pixels = std::int64_t{128} * 64;
  const SceneFile file = read_scene(scenes_folder / "normal_map.json", {.most_pixels = pixels});
  const NormalMap& map = file.scene.materials<Parallelogram>()[0].normal_map;
  REQUIRE(map);
  const auto number = [](int code) { return 2.0 * static_cast<float>(code / 255.0) - 1.0; };
  const Vec3 level{number(128), number(128), 1};
  CHECK(map(0.001, 0.001) == level);
  CHECK(map(1.001, 0.501) == level);  // one size farther
  // The third pixel from the left is where a brick rises: tilted to the left, by 45 degrees and a little
  // less.
  const Vec3 rising = map(2.5 / 128, 0.5 * 16.5 / 64);
  CHECK(std::abs(rising.x / rising.z - (0.06 - 1)) < 0.02);
  CHECK(std::abs(rising.y / rising.z - 0.03) < 0.02);

  CHECK_THAT(message_of<SceneError>([&] {
               static_cast<void>(read_scene(scenes_folder / "normal_map.json", {.most_pixels = pixels - 1}));
             }),
             ContainsSubstring("/materials/bricks/normal-map/image: \"bricks.png\" is not possible: "));
  const std::string twice = R"({"image": "bricks.png"})";
  std::string text =
      patched(R"({"op": "add", "path": "/materials/red/normal-map", "value": )" + twice +
              R"(}, {"op": "replace", "path": "/materials/red/diffuse", "value": )" + twice + "}");
  const SceneFile both =
      scene_from_json(text, (scenes_folder / "a.json").string(), {.most_pixels = 2 * pixels});
  const Material& red = both.scene.materials<Sphere>()[0];
  CHECK(red.normal_map(0.001, 0.001) == level);
  CHECK(red.texture(0.001, 0.001).r == 0.2158605f);  // 128 decoded from sRGB
}

TEST_CASE("a normal map with a pixel that leads into the surface is refused, with its place") {
  const std::string name = "../tests/golden/09_shadow.png";  // black at the upper left
  const std::string text =
      patched(R"({"op": "add", "path": "/materials/red/normal-map", "value": {"image": ")" + name + "\"}}");
  CHECK(message_of<SceneError>(
            [&] { static_cast<void>(scene_from_json(text, (scenes_folder / "a.json").string())); }) ==
        (scenes_folder / "a.json").string() + ": /materials/red/normal-map/image: \"" + name +
            "\" is not possible: '" + (scenes_folder / name).string() +
            "' is no normal map: the blue of pixel 0,0, counted from 0 at the upper left, is 0; allowed is "
            "above 0.5, for a normal that leads out of the surface");
}

TEST_CASE("an image that a scene file names several times, by any paths, is read once and shared") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "b");
  put_image(folder / "a.jpg");
  fs::create_symlink(folder / "a.jpg", folder / "b/link.jpg");
  put_bytes(folder / "a.json", with_images("a.jpg", "b/../a.jpg", "b/link.jpg"));
  const SceneFile file = read_scene(folder / "a.json", {.most_pixels = pixels_of_image});
  const auto image = [](const Texture& texture) {
    REQUIRE(texture.target<ImageTexture>() != nullptr);
    return &*texture.target<ImageTexture>()->image;
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
  CHECK_THAT(error(R"(, "smooth": true)"),
             ContainsSubstring("allowed are type, file, position, scale and velocity"));
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
                                              first + ", " + ball_in_json + "]}"));
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
