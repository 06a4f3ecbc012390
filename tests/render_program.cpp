// Tests of the program `render` as a user runs it: the picture of a scene file, options, and errors.
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <protostar/encode.hpp>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "compare_images/picture.hpp"
#include "compare_images/read_image.hpp"
#include "reference/spheres_on_ground.hpp"
#include "stages/support/options.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/random.hpp"
#include "support/sanitizers.hpp"

namespace fs = std::filesystem;
using namespace protostar;

namespace {

const fs::path scenes = fs::path(PROTOSTAR_SOURCE_DIR) / "scenes";

std::string scene(const std::string& name) { return (scenes / (name + ".json")).string(); }

Outcome run_program(const std::string& name, const std::string& arguments, const TemporaryFolder& folder) {
  return run(stage(name, words(arguments), folder / ""));
}

/// Returns the file that a program writes; checks that it prints nothing.
std::string picture(const std::string& name, const std::string& arguments,
                    const std::string& file = "out.ppm") {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(name, arguments + " --quiet -o " + file, folder);
  CAPTURE(arguments);
  CHECK(outcome.status == 0);
  CHECK(outcome.out + outcome.err == "");
  return bytes_of(folder / file);
}

std::string rendered(const std::string& name, const std::string& options,
                     const std::string& file = "out.ppm") {
  return picture("render", scene(name) + " " + options, file);
}

/// Binary PPM of 8 bits, or PFM, as rows of bytes from the top.
struct Rows {
  int width = 0, height = 0;
  std::vector<std::string> rows;
};

Rows rows_of(const std::string& file) {
  Rows picture;
  std::size_t begin = 0;
  std::vector<std::string> header;
  for (int i = 0; i < 3; ++i) {
    const std::size_t end = file.find('\n', begin);
    header.push_back(file.substr(begin, end - begin));
    begin = end + 1;
  }
  const bool is_pfm = header[0] == "PF";
  picture.width = std::stoi(header[1]);
  picture.height = std::stoi(header[1].substr(header[1].find(' ')));
  const std::size_t size = static_cast<std::size_t>(picture.width) * (is_pfm ? 12 : 3);
  for (int y = 0; y < picture.height; ++y) {
    const int row = is_pfm ? picture.height - 1 - y : y;
    picture.rows.push_back(file.substr(begin + static_cast<std::size_t>(row) * size, size));
  }
  CHECK(file.size() == begin + static_cast<std::size_t>(picture.height) * size);
  return picture;
}

/// Returns the channels of a PFM, rows from the top.
std::vector<float> light_of(const std::string& file) {
  std::vector<float> light;
  for (const std::string& row : rows_of(file).rows)
    for (std::size_t i = 0; i < row.size(); i += sizeof(float)) {
      float channel = 0;
      std::memcpy(&channel, row.data() + i, sizeof channel);
      light.push_back(channel);
    }
  return light;
}

/// Returns the scene file of the three spheres with one text replaced.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = bytes_of(scene("three_spheres"));
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

/// Returns a mesh as an OBJ file: a square behind the three spheres, cut into side × side squares.
std::string flat_mesh(int side) {
  std::string mesh;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x)
      mesh += "v " + std::to_string(x - side / 2) + " " + std::to_string(y - side / 2) + " 50\n";
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int first = y * (side + 1) + x + 1;
      mesh += "f " + std::to_string(first) + " " + std::to_string(first + 1) + " " +
              std::to_string(first + side + 2) + " " + std::to_string(first + side + 1) + "\n";
    }
  return mesh;
}

/// Returns the scene file of the three spheres with a mesh added.
std::string with_mesh(const std::string& file) {
  return changed(R"("objects": [)", R"("objects": [{"surface": {"type": "mesh", "file": ")" + file +
                                        R"("}, "color": [1, 1, 1]},)");
}

/// Returns a scene of 300 spheres with radii from 0.002 to 2 in equal ratios, in front of the tutorial's
/// camera; small ones are near, so that most are as large as some pixels. Their centers and radii are
/// multiples of 2^-16.
reference::SpheresOnGround random_spheres() {
  const std::int64_t parts = 1 << 16;
  const auto whole = [&](double x) { return std::llround(x * static_cast<double>(parts)); };
  Random random(5);
  const auto color = [&] {
    const auto share = [&] { return 0.25L + static_cast<long double>(random.bits() % 192) / 256; };
    const long double red = share(), green = share();
    return reference::Vector{red, green, share()};
  };
  reference::SpheresOnGround scene;
  for (int i = 0; i < 300; ++i) {
    const double radius = 0.002 * std::pow(1000, i / 299.0);
    const double z = std::min(radius / random.real(0.01, 0.1), 8.0);
    const double x = z * random.real(-1.3, 1.3), y = z * random.real(-0.9, 0.9);
    scene.spheres.push_back({.center_parts = {whole(x), whole(y), whole(z)},
                             .radius_parts = whole(radius),
                             .color = color(),
                             .parts = parts});
  }
  // Slanted, so that no ray of a picture with even sides is parallel to it: the components of such directions
  // are odd, odd and even multiples of one number, so their product with the normal is odd.
  scene.ground = {.normal = {1, 16, -2}, .distance = -1.5, .color = color()};
  scene.light = {3, 5, -1};
  scene.power = {700, 600, 500};
  scene.sky = {0.25, 0.5, 0.75};
  return scene;
}

/// Returns the scene as a file.
std::string json_of(const reference::SpheresOnGround& scene, double exposure, int width, int height) {
  std::ostringstream text;
  text.precision(17);
  const auto vector = [](const reference::Vector& v) {
    std::ostringstream three;
    three.precision(17);
    three << '[' << v.x << ", " << v.y << ", " << v.z << ']';
    return three.str();
  };
  text << R"({"settings": {"resolution-x": )" << width << R"(, "resolution-y": )" << height
       << R"(, "exposure": )" << exposure << R"(}, "world": {"sky": )" << vector(scene.sky)
       << R"(}, "camera": {"projection": "perspective", "position": [0, 0, 0], "direction": [0, 0, 1],
       "upward": [0, 1, 0], "field-of-view": 90}, "objects": [)";
  for (const reference::Sphere& sphere : scene.spheres)
    text << R"({"surface": {"type": "sphere", "position": )" << vector(sphere.center()) << R"(, "radius": )"
         << sphere.radius() << R"(}, "color": )" << vector(sphere.color) << "},\n";
  text << R"({"surface": {"type": "plane", "normal": )" << vector(scene.ground.normal.real())
       << R"(, "distance": )" << scene.ground.distance << R"(}, "color": )" << vector(scene.ground.color)
       << R"(}], "lights": [{"position": )" << vector(scene.light) << R"(, "power": )" << vector(scene.power)
       << "}]}";
  return text.str();
}

}  // namespace

TEST_CASE("pictures of 300 random spheres over a plane match a long double computation, within one level") {
  const int width = 160, height = 120;
  const reference::SpheresOnGround scene = random_spheres();
  std::vector<reference::SpheresOnGround::Seen> seen;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      seen.push_back(scene.along(reference::through_pixel(x, y, width, height)));
  const TemporaryFolder folder;
  for (const auto& [integrator, light] : reference::lights_along) {
    CAPTURE(integrator);
    const double exposure = integrator == "depth" ? 0.125 : 1;
    put_bytes(folder / "scene.json", json_of(scene, exposure, width, height));
    CHECK(run_program("render", "scene.json -o a.png --integrator " + integrator, folder).status == 0);
    const Picture drawn = read_image((folder / "a.png").string());
    Picture expected{width, height, {}};
    for (const auto& pixel : seen) {
      const reference::Vector exposed = exposure * (pixel.*light);
      expected.pixels.push_back({reference::encode_srgb(exposed.x), reference::encode_srgb(exposed.y),
                                 reference::encode_srgb(exposed.z)});
    }
    REQUIRE(same_size(drawn, expected));
    CHECK(difference(drawn, expected).largest <= 1);
  }

  // Checks that the comparison covers many spheres and shadows.
  std::set<const reference::Sphere*> visible;
  int in_shadow = 0;
  for (const auto& pixel : seen) {
    visible.insert(pixel.sphere);
    in_shadow += pixel.shadow.x != pixel.diffuse.x;
  }
  CHECK(visible.size() > 200);
  CHECK(in_shadow > 1000);
}

TEST_CASE("the scene file of the three spheres gives the pictures of the stages, byte for byte") {
  struct Row {
    std::string integrator, stage;
  };
  const Row row = GENERATE(Row{"binary", "03_scene"}, Row{"depth", "04_depth"}, Row{"normal", "05_normal"},
                           Row{"color", "06_color"}, Row{"diffuse", "07_diffuse"},
                           Row{"transparency", "08_transparency"}, Row{"shadow", "09_shadow"});
  CAPTURE(row.integrator);
  CHECK(rendered("three_spheres", "--size 320x240 --integrator " + row.integrator) ==
        picture(row.stage, "--size 320x240"));
  CHECK(rendered("three_spheres", "--size 160x120 --integrator " + row.integrator, "out.pfm") ==
        picture(row.stage, "--size 160x120", "out.pfm"));
}

TEST_CASE("the scene file of stage 13 gives the whole picture of stage 13") {
  CHECK(rendered("whitted", "") == picture("13_whitted", ""));
}

TEST_CASE("WhittedIntegrator and ShadowIntegrator draw matte surfaces alike") {
  CHECK(rendered("three_spheres", "--integrator whitted") ==
        rendered("three_spheres", "--integrator shadow"));
}

TEST_CASE("a scene file sets the size, the integrator and the transfer; options override it") {
  const TemporaryFolder folder;
  const Outcome outcome = run_program("render", scene("three_spheres"), folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == "");
  CHECK(outcome.out.starts_with("out.ppm: 640x480, shadow, rendered in "));
  CHECK(bytes_of(folder / "out.ppm") == picture("09_shadow", ""));

  const Outcome other = run_program(
      "render", "--size 64x48 --integrator color --transfer linear -o a.ppm " + scene("three_spheres"),
      folder);
  CHECK(other.out.starts_with("a.ppm: 64x48, color, rendered in "));
  CHECK(bytes_of(folder / "a.ppm") == picture("06_color", "--size 64x48 --transfer linear"));
}

// After an intended change: build/stages/render scenes/NAME.json -o tests/golden/scenes/NAME.png
TEST_CASE("every scene file gives its golden picture, and the gallery shows it") {
  const std::string gallery = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "gallery.md");
  for (const auto& entry : fs::directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    CHECK_THAT(gallery, ContainsSubstring("../scenes/" + name + ".json"));
    if (name == "three_spheres" || name == "whitted") continue;  // covered by stages
    const Picture golden = read_image(
        (fs::path(PROTOSTAR_SOURCE_DIR) / "tests" / "golden" / "scenes" / (name + ".png")).string());
    const TemporaryFolder folder;
    CHECK(run_program("render", scene(name) + " -o a.png", folder).status == 0);
    const Picture drawn = read_image((folder / "a.png").string());
    REQUIRE(same_size(golden, drawn));
    CHECK(difference(golden, drawn).pixels == 0);
  }
}

TEST_CASE("every scene file of the project is drawn in any size") {
  for (const auto& entry : fs::directory_iterator(scenes)) {
    if (entry.path().extension() != ".json") continue;
    const Rows drawn = rows_of(rendered(entry.path().stem().string(), "--size 40x30 --samples 0"));
    INFO(entry.path());
    bool varies = false;
    for (const std::string& row : drawn.rows) varies = varies || row != drawn.rows[0];
    CHECK(varies);
  }
}

TEST_CASE("a crop has the bytes of the same part of the whole picture") {
  const std::string name =
      GENERATE("whitted", "mirror_walls", "orthographic", "three_spheres", "scale_image");
  const std::string samples = GENERATE("0", "3"), file = GENERATE("a.ppm", "a.pfm");
  CAPTURE(name, samples, file);
  const std::string options = "--size 150x90 --samples " + samples;
  const Rows whole = rows_of(rendered(name, options, file));
  const std::size_t pixel = whole.rows[0].size() / 150;
  struct Crop {
    int x, y, width, height;
  };
  for (const Crop& crop :
       {Crop{0, 0, 150, 90}, Crop{61, 33, 71, 50}, Crop{149, 89, 1, 1}, Crop{0, 40, 150, 1}}) {
    const Rows part =
        rows_of(rendered(name,
                         options + " --crop " + std::to_string(crop.x) + "," + std::to_string(crop.y) + "," +
                             std::to_string(crop.width) + "," + std::to_string(crop.height),
                         file));
    REQUIRE(part.width == crop.width);
    REQUIRE(part.height == crop.height);
    for (int y = 0; y < crop.height; ++y)
      CHECK(part.rows[static_cast<std::size_t>(y)] ==
            whole.rows[static_cast<std::size_t>(crop.y + y)].substr(
                static_cast<std::size_t>(crop.x) * pixel, static_cast<std::size_t>(crop.width) * pixel));
  }
}

TEST_CASE("another aspect ratio changes the width of the view, and not its height") {
  const Rows wide = rows_of(rendered("three_spheres", "--size 256x64")),
             narrow = rows_of(rendered("three_spheres", "--size 64x64"));
  // Sides that are powers of 2, so nothing is rounded.
  for (std::size_t y = 0; y < 64; ++y) CHECK(wide.rows[y].substr(96 * 3, 64 * 3) == narrow.rows[y]);
}

TEST_CASE("exposure scales the light, also of a PFM; tone changes only encoded values") {
  const std::string size = "--size 64x48";
  const std::vector<float> light = light_of(rendered("clip", size, "a.pfm"));
  CHECK(light_of(rendered("scale_pixel", size, "a.pfm")) == light);
  CHECK(light_of(rendered("scale_image", size, "a.pfm")) == light);
  const std::vector<float> exposed = light_of(rendered("exposure", size, "a.pfm"));
  REQUIRE(exposed.size() == light.size());
  for (std::size_t i = 0; i < light.size(); ++i) CHECK(exposed[i] == light[i] * 0.2f);

  // Compares the codes of each file with the linear light.
  const auto codes = [&](const std::string& name) {
    std::string all;
    for (const std::string& row : rows_of(rendered(name, size)).rows) all += row;
    return all;
  };
  const std::string clip = codes("clip"), pixel = codes("scale_pixel"), image = codes("scale_image");
  float largest = 0;
  for (const float channel : light) largest = std::max(largest, channel);
  REQUIRE(largest > 1);
  const Encoder encode(Srgb{}, 255);
  const auto code = [](const std::string& all, std::size_t i) {
    return static_cast<int>(static_cast<unsigned char>(all[i]));
  };
  int scaled = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    const std::size_t first = i / 3 * 3;
    const float most = std::max({light[first], light[first + 1], light[first + 2], 1.0f});
    CHECK(code(clip, i) == encode(light[i]));
    CHECK(code(pixel, i) == encode(light[i] / most));
    CHECK(code(image, i) == encode(light[i] / largest));
    scaled += most > 1;
  }
  CHECK(scaled > 0);
}

TEST_CASE("light beyond float makes no pixel NaN, and leaves channels black that surfaces do not reflect") {
  // Surfaces that reflect red light only, and 1e-60 of the light from mirror and refraction rays, in light of
  // every kind.
  const std::string scene = R"({"settings": {"resolution-x": 33, "resolution-y": 25, "exposure": EXPOSURE},
      "world": {"sky": [3e38, 3e38, 3e38]},
      "camera": {"projection": "perspective", "position": [0, 0, 0], "direction": [0, 0, 1],
                 "upward": [0, 1, 0], "field-of-view": 90},
      "objects": [{"surface": {"type": "sphere", "position": [0, 0, 3], "radius": 1}, "material-id": "red"},
                  {"surface": {"type": "sphere", "position": [0, 0, 3], "radius": 0.5}, "material-id": "red"},
                  {"surface": {"type": "plane", "normal": [0, 1, 0], "distance": -1}, "material-id": "red"}],
      "lights": [LIGHT, LIGHT, LIGHT],
      "materials": {"red": {"diffuse": [3e38, 0, 0], "specular": [3e38, 0, 0], "shininess": 1,
                            "reflect": 1e-60, "refract": 1e-60}}})";
  const std::string light = GENERATE(as<std::string>(), R"({"ambient": [3e38, 3e38, 3e38]})",
                                     R"({"position": [0, 3, 0], "power": [3e38, 3e38, 3e38]})",
                                     R"({"position": [0, 0, 1.9999999999], "power": [3e38, 3e38, 3e38]})",
                                     R"({"position": [0, 3, 0], "intensity": [3e38, 3e38, 3e38]})",
                                     R"({"direction": [0, 1, -1], "intensity": [3e38, 3e38, 3e38]})");
  const std::string exposure = GENERATE("1", "0", "1e-60");
  std::string text = scene;
  const auto replace_all = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from))
      text.replace(at, from.size(), to);
  };
  replace_all("LIGHT", light);
  replace_all("EXPOSURE", exposure);
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json", text);
  for (const std::string integrator : {"color", "diffuse", "transparency", "shadow", "whitted"}) {
    CAPTURE(light, exposure, integrator);
    CHECK(run_program("render", "scene.json -o a.pfm --integrator " + integrator, folder).status == 0);
    const std::vector<float> pixels = light_of(bytes_of(folder / "a.pfm"));
    const std::size_t on_sphere = 3 * (12 * 33 + 16);  // a light may be in front of it
    CHECK(std::none_of(pixels.begin(), pixels.end(), [](float x) { return std::isnan(x); }));
    CHECK(pixels[on_sphere + 1] == 0);
    CHECK((pixels[on_sphere] > 0) == (exposure == "1"));
  }
}

TEST_CASE("the option --samples sets the number of samples, and one sample is the pixel's center") {
  const std::string center = rendered("three_spheres", "--size 64x48");
  CHECK(rendered("three_spheres", "--size 64x48 --samples 0") == center);
  CHECK(rendered("three_spheres", "--size 64x48 --samples 1") == center);
  CHECK(rendered("three_spheres", "--size 64x48 --samples 5") != center);
  CHECK(rendered("samples", "--size 64x48 --samples 64") == rendered("samples", "--size 64x48"));
}

TEST_CASE("the picture of a scene file does not depend on the number of threads") {
  const std::string expected = rendered("whitted", "--size 130x98 --threads 1");
  CHECK(rendered("whitted", "--size 130x98 --threads 7") == expected);
}

TEST_CASE("wrong options of render are named, with the right ones, and nothing is drawn") {
  struct Row {
    std::string arguments, error;
  };
  const std::string crop =
                        "X,Y,W,H, whole numbers of a part of at least one pixel that lies inside the picture",
                    crop_of_size = crop + " of 640x480", samples = "a whole number from 0 to 65536",
                    integrators =
                        "one of binary, depth, normal, color, diffuse, transparency, shadow, whitted";
  const auto not_allowed = [](const std::string& option, const std::string& found,
                              const std::string& allowed) {
    return Row{option + " " + found, option + ": '" + found + "' is not " + allowed};
  };
  const std::vector<Row> rows{not_allowed("--crop", "0,0,641,480", crop_of_size),
                              not_allowed("--crop", "0,0,640,481", crop_of_size),
                              not_allowed("--crop", "640,0,1,1", crop_of_size),
                              not_allowed("--crop", "0,480,1,1", crop_of_size),
                              not_allowed("--crop", "0,0,0,1", crop),
                              not_allowed("--crop", "0,0,1,0", crop),
                              not_allowed("--crop", "0,-1,1,1", crop),
                              not_allowed("--crop", "2147483647,0,2147483647,1", crop_of_size),
                              not_allowed("--crop", "1,1,1", crop),
                              not_allowed("--crop", "1,1,1,1,1", crop),
                              not_allowed("--crop", "1,1,1,1,", crop),
                              not_allowed("--crop", "1;1;1;1", crop),
                              not_allowed("--crop", "1,1,1,1.5", crop),
                              not_allowed("--crop", "a", crop),
                              not_allowed("--samples", "-1", samples),
                              not_allowed("--samples", "1.5", samples),
                              not_allowed("--samples", "65537", samples),
                              not_allowed("--samples", "x", samples),
                              not_allowed("--integrator", "path", integrators),
                              not_allowed("--integrator", "Shadow", integrators),
                              {"--size 0x0", "--size: '0x0' is not WIDTHxHEIGHT"},
                              {"stray", "stray"}};
  const TemporaryFolder folder;
  for (const Row& row : rows) {
    CAPTURE(row.arguments);
    const Outcome outcome = run_program("render", scene("three_spheres") + " " + row.arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("render: "));
    CHECK_THAT(outcome.err, ContainsSubstring(row.error));
  }
  const Outcome no_scene = run_program("render", "--size 8x8", folder);
  CHECK(no_scene.status == 2);
  CHECK_THAT(no_scene.err, ContainsSubstring("scene is required"));
  CHECK(folder.count() == 0);
}

TEST_CASE("wrong options of render are reported before the scene is read, except a crop that is too large") {
  const TemporaryFolder folder;
  put_bytes(folder / "wrong.json", "{");
  const auto outcome_of = [&](const std::string& path, const std::string& options) {
    CAPTURE(path, options);
    const Outcome outcome = run_program("render", path + " " + options, folder);
    CHECK(outcome.out == "");
    CHECK(folder.count() == 1);
    return outcome;
  };
  for (const char* path : {"none.json", "wrong.json"}) {
    for (const char* options :
         {"--bad-option", "--tone clip", "stray", "--integrator path", "--crop 1,1,1", "--crop 0,0,0,1",
          "--size 8x8 --crop 0,0,9,1", "--samples -1", "--size 0x0", "--threads -1", "--transfer x",
          "--bits 9", "-o a.txt", "-o a.png --bits 16", "-o a.png --plain", "-o a.pfm --transfer srgb"}) {
      const Outcome outcome = outcome_of(path, options);
      CHECK(outcome.status == 2);
      CHECK(outcome.err.find(".json") == std::string::npos);
    }
    const Outcome large = outcome_of(path, "--crop 0,0,9,1");
    CHECK(large.status == 1);
    CHECK_THAT(large.err, ContainsSubstring(path));
  }
}

TEST_CASE("the stages refuse render's options for scene files") {
  const TemporaryFolder folder;
  for (const char* arguments : {"--samples 4", "--crop 0,0,1,1", "--integrator color"})
    CHECK(run_program("09_shadow", arguments, folder).status == 2);
}

TEST_CASE("render --help names its own options") {
  const TemporaryFolder folder;
  const Outcome help = run_program("render", "--help", folder);
  CHECK(help.status == 0);
  for (const char* text : {"SCENE.json", "--integrator I", "--samples N", "--crop X,Y,W,H", "[the scene's]"})
    CHECK_THAT(help.out, ContainsSubstring(text));
}

TEST_CASE("an invalid scene ends render with status 1 and one line of explanation") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& text, const std::string& error) {
    CAPTURE(error);
    put_bytes(folder / "scene.json", text);
    const Outcome outcome = run_program("render", "scene.json", folder);
    CHECK(outcome.status == 1);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("render: scene.json: " + error));
    CHECK(outcome.err.find('\n') == outcome.err.size() - 1);
    CHECK(folder.count() == 1);
  };
  check(changed("\"radius\": 1}", "\"radius\": -1}"),
        "/objects/0/surface/radius: -1 is not a number greater than 0\n");
  check(changed("\"radius\": 1}", "\"radius\": 1e999}"), "/objects/0/surface/radius: 1e999 is not a number");
  check(changed("\"lights\"", "\"lamps\""), "/lamps: is not a key here");
  check(changed("]\n}", "]\n"), "parse error at line ");
  check("", "parse error at line 1, column 1");
  check("\xff\xfe\xfd", "parse error at line 1, column 1");
  std::string brackets(200'000, '[');
  check(brackets, "/0/0/0");
  check(brackets + std::string(200'000, ']'), "/0/0/0");
  std::string garbage(std::size_t{64} << 20, 'x');
  check(garbage, "parse error at line 1, column 1");
  std::uint32_t random = 1;
  for (char& c : garbage) c = static_cast<char>((random = random * 1664525 + 1013904223) >> 24);
  check(garbage, "parse error at line 1, column ");
  std::fill(garbage.begin(), garbage.end(), ' ');
  check(garbage, "parse error at line 1, column ");
}

TEST_CASE("a scene that cannot be read ends render with status 1, the path and the reason") {
  struct Row {
    std::string path;
    int reason;
  };
  const Row row = GENERATE(Row{"none.json", ENOENT}, Row{".", EISDIR}, Row{"file/a.json", ENOTDIR});
  const TemporaryFolder folder;
  put_bytes(folder / "file", "");
  const Outcome outcome = run_program("render", row.path, folder);
  CHECK(outcome.status == 1);
  CHECK(outcome.out == "");
  CHECK(outcome.err ==
        "render: cannot read '" + row.path + "': " + std::generic_category().message(row.reason) + "\n");
  CHECK(folder.count() == 1);
}

TEST_CASE("a signal ends render within half a second, whatever render is doing") {
  using namespace std::chrono_literals;
  struct Row {
    std::string doing, scene, options;
    int status;  // exit status after SIGINT, or −SIGINT if the signal kills it
  };
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  put_bytes(folder / "a.obj", flat_mesh(400));  // takes about a second to read
  put_bytes(folder / "mesh.json", with_mesh("a.obj"));
  const Row row = GENERATE_COPY(
      // All pixels are in one tile, which takes hours, during which the stop token is not checked.
      Row{"a tile, alone", scene("whitted"), "--size 64x48 --samples 65536 --threads 1", 128 + SIGINT},
      Row{"a tile, of several threads", scene("whitted"), "--size 64x48 --samples 65536 --threads 3",
          128 + SIGINT},
      Row{"many tiles", scene("three_spheres"), "--size 4000x4000 --samples 64 --threads 1", 128 + SIGINT},
      // Before the picture is begun, there is nothing to clean up.
      Row{"waiting for a scene", "pipe", "", -SIGINT},
      Row{"reading a scene", "mesh.json", "--size 64x48 --samples 65536", -SIGINT});
  CAPTURE(row.doing);
  const auto before = folder.count();
  Process process(stage("render", words(row.scene + " " + row.options), folder / ""));
  if (row.status > 0) process.wait_for_thread();
  std::this_thread::sleep_for(300ms);
  const auto start = std::chrono::steady_clock::now();
  process.send(SIGINT);
  const Outcome outcome = process.wait();
  CHECK(std::chrono::steady_clock::now() - start < 500ms);
  // A fast machine has read the scene by then and is drawing it.
  const bool is_drawn = row.scene == "mesh.json" && outcome.status == 128 + SIGINT;
  if (!is_drawn) CHECK(outcome.status == row.status);
  CHECK(outcome.out + outcome.err == "");
  CHECK(folder.count() == before);
}

TEST_CASE("a large mesh is drawn without creating threads if --threads is 1") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.obj", flat_mesh(80));  // 12800 triangles: a tree that several threads would build
  put_bytes(folder / "a.json", with_mesh("a.obj"));
  Command command =
      stage("render", words("a.json --size 64x48 --threads 1 --quiet -o alone.ppm"), folder / "");
  command.before = forbid_threads;
  const Outcome outcome = run(command);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == "");
  CHECK(run_program("render", "a.json --size 64x48 --quiet", folder).status == 0);
  const bool is_alike = bytes_of(folder / "alone.ppm") == bytes_of(folder / "out.ppm");
  CHECK(is_alike);
}

TEST_CASE("an endless scene file is refused") {
  const TemporaryFolder folder;
  const Outcome zeros = run_program("render", "/dev/zero", folder);
  CHECK(zeros.status == 1);
  CHECK(zeros.err == "render: /dev/zero: parse error at line 1, column 1: a zero byte, which no text has\n");

  const std::string program = stage("render", {}, folder / "").program.string();
  const Outcome outcome = run({.program = "/bin/sh",
                               .arguments = {"-c", "yes '' | '" + program + "' /dev/stdin"},
                               .folder = folder / ""});
  CHECK(outcome.status == 1);
  CHECK(outcome.err == "render: /dev/stdin: the file is longer than the 268435456 bytes that are allowed\n");
}

namespace {

void copy_image(const std::string& name, const TemporaryFolder& folder) {
  fs::copy_file(fs::path(PROTOSTAR_SOURCE_DIR) / "tests" / name, folder / fs::path(name).filename().string());
}

/// Returns a scene of a sphere with an image as its texture.
std::string with_image(const std::string& name) {
  return R"({"settings": {"resolution-x": 16, "resolution-y": 12, "integrator": "color"},
      "camera": {"projection": "perspective", "position": [0, 0, -5], "direction": [0, 0, 1],
                 "upward": [0, 1, 0], "field-of-view": 40},
      "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 2}, "material-id": "m"}],
      "materials": {"m": {"diffuse": {"image": ")" +
         name + "\"}}}}";
}

}  // namespace

TEST_CASE("an image that is truncated or too large ends render with status 1 and one line of explanation") {
  struct {
    std::string file, error;
  } const rows[] = {
      {"images/half.hdr", "there are 19884 bytes of pixels; a picture of this size takes 38912 or more"},
      {"images/hdrtrunc0.hdr", "there are 0 bytes of pixels; a picture of this size takes 2800 or more"},
      {"images/bomb12000.png",
       "the picture has 12000x12000 pixels; allowed are sides of at least 1 and at most 67108864 pixels"},
  };
  for (const auto& row : rows) {
    const TemporaryFolder folder;
    copy_image(row.file, folder);
    const std::string name = fs::path(row.file).filename().string();
    put_bytes(folder / "scene.json", with_image(name));
    const Outcome outcome = run_program("render", "scene.json", folder);
    CHECK(outcome.status == 1);
    CHECK(outcome.err == "render: scene.json: /materials/m/diffuse/image: \"" + name +
                             "\" is not possible: cannot read '" + name + "': " + row.error + "\n");
    CHECK(folder.count() == 2);
  }
}

TEST_CASE("names from a scene are printed with their control characters escaped") {
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json", with_image("a\\u001b[31m\\u0007red\\nline.png"));
  CHECK(run_program("render", "scene.json", folder).err ==
        "render: scene.json: /materials/m/diffuse/image: \"a\\u001b[31m\\u0007red\\nline.png\" is not "
        "possible: "
        "cannot read 'a\\x1b[31m\\x07red\\x0aline.png': No such file or directory\n");
  CHECK(run(stage("render", {"a\x1b[31m\n.json"}, folder / "")).err ==
        "render: cannot read 'a\\x1b[31m\\x0a.json': No such file or directory\n");
  CHECK(run(stage("render", {"scene.json", "-o", "no\x1b/out.ppm"}, folder / "")).err.find('\x1b') ==
        std::string::npos);
  put_bytes(folder / "scene.json", with_image("a.png"));
  copy_image("fuzz/pool/a.png", folder);
  const Outcome drawn = run(stage("render", {"scene.json", "-o", "a\x1b[31m.ppm"}, folder / ""));
  CHECK(drawn.out.starts_with("a\\x1b[31m.ppm: 16x12, "));
  CHECK(drawn.status == 0);
}

TEST_CASE("render --confine refuses files outside of the scene's folder") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "scene");
  copy_image("fuzz/pool/a.png", folder);
  fs::copy_file(folder / "a.png", folder / "scene/a.png");
  put_bytes(folder / "scene/inside.json", with_image("a.png"));
  put_bytes(folder / "scene/outside.json", with_image("../a.png"));
  CHECK(run_program("render", "scene/inside.json", folder).status == 0);
  CHECK(run_program("render", "scene/outside.json", folder).status == 0);
  CHECK(run_program("render", "--confine scene/inside.json", folder).status == 0);
  const std::string real = fs::canonical(folder / "").string();
  const Outcome refused = run_program("render", "scene/outside.json --confine", folder);
  CHECK(refused.status == 1);
  CHECK(refused.err ==
        "render: scene/outside.json: /materials/m/diffuse/image: \"../a.png\" is not inside of the "
        "scene's folder: it is '" +
            real + "/a.png', and the folder '" + real + "/scene'\n");
  CHECK_THAT(run_program("render", "--help", folder).out, ContainsSubstring("--confine"));
  CHECK(run_program("09_shadow", "--confine", folder).status == 2);
}

TEST_CASE(
    "render gives up a picture that takes longer than --timeout, by default ten seconds for each pixel") {
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json", changed("", ""));
  const auto start = std::chrono::steady_clock::now();
  const Outcome late =
      run_program("render", "scene.json --size 4000x4000 --samples 1000 --timeout 0.2", folder);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  CHECK(late.status == 1);
  CHECK(late.out == "");
  CHECK(late.err ==
        "render: the picture is not done after 0.2 seconds; --timeout sets how many it may take\n");
  CHECK(time.count() < 2);
  CHECK(folder.count() == 1);

  CHECK(run_program("render", "scene.json --size 8x6 --timeout 0", folder).status == 0);
  CHECK(run_program("render", "scene.json --size 8x6 --timeout 1e9", folder).status == 0);
  for (const char* seconds : {"-1", "nan", "1e10", "1s"}) {
    CAPTURE(seconds);
    const Outcome refused = run_program("render", "scene.json --timeout " + std::string(seconds), folder);
    CHECK(refused.status == 2);
    CHECK_THAT(refused.err, ContainsSubstring("--timeout: '" + std::string(seconds) +
                                              "' is not a number of seconds from 0 to 1e9"));
  }
  CHECK(run_program("09_shadow", "--timeout 1", folder).status == 2);
}

TEST_CASE("the default timeout of render is ten seconds for each pixel") {
  const auto timeout = [](const std::string& arguments) {
    const std::vector<std::string> line = words("render scene.json " + arguments);
    std::vector<const char*> argv;
    for (const std::string& word : line) argv.push_back(word.c_str());
    const auto read = [](const auto&, const auto&) { return StageDefaults{.width = 30, .height = 20}; };
    int status = 0;
    return parse_options(static_cast<int>(argv.size()), argv.data(), {.read_scene = read}, "render", status)
        .value()
        .timeout;
  };
  CHECK(timeout("") == 6000);
  CHECK(timeout("--size 4x3") == 120);
  CHECK(timeout("--crop 1,2,3,4") == 120);
  CHECK(timeout("--timeout 7") == 7);
  CHECK(timeout("--timeout 0") == 0);
}

TEST_CASE("render does not wait for a pipe that a scene names") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe.png").c_str(), 0600) == 0);
  put_bytes(folder / "scene.json", with_image("pipe.png"));
  const Outcome outcome = run_program("render", "scene.json", folder);
  CHECK(outcome.status == 1);
  CHECK_THAT(outcome.err,
             ContainsSubstring("\"pipe.png\" is not possible: 'pipe.png' is not a regular file\n"));
}

#if !defined(ADDRESS_SANITIZER)  // AddressSanitizer alone takes more than the limits

namespace {

/// Runs render in a folder with one thread and at most the given number of bytes of memory.
Outcome run_within(rlim_t bytes, const std::string& scene, const TemporaryFolder& folder) {
  Command command = stage("render", {scene, "--threads", "1", "--size", "8x6", "-o", "out.ppm"}, folder / "");
  command.before = [bytes] {
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  };
  return run(command);
}

/// Checks that render has drawn a scene, or refused it with one line.
void check_one_line(const Outcome& outcome) {
  CAPTURE(outcome.status, outcome.err);
  CHECK((outcome.status == 0 || outcome.status == 1));
  if (outcome.status == 0) return;
  CHECK(outcome.out == "");
  CHECK(outcome.err.find('\n') == outcome.err.size() - 1);
}

}  // namespace

TEST_CASE("small files that promise large images or repeat their files take little memory") {
  const TemporaryFolder folder;
  const rlim_t limit = 200'000'000;
  const auto check_refused = [&](const std::string& scene, const std::string& error) {
    put_bytes(folder / "scene.json", scene);
    const Outcome outcome = run_within(limit, "scene.json", folder);
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.err, ContainsSubstring(error));
  };
  copy_image("images/bomb12000.png", folder);
  check_refused(with_image("bomb12000.png"), "the picture has 12000x12000 pixels");
  put_bytes(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 10000\n");
  check_refused(with_image("a.hdr"), "the picture has 10000x10000 pixels");
  put_bytes(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 8000\n");
  check_refused(with_image("a.hdr"), "there are 0 bytes of pixels; a picture of this size takes ");

  // A hundred materials name one image of 6 MB in memory, and a hundred objects one mesh of 100,000
  // triangles.
  put_bytes(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65536 +X 7\n" +
                                  std::string(std::size_t{4} * 7 * 65536, '\x80'));
  std::string mesh = "v 0 0 1\nv 2 0 1\nv 0 2 1\n";
  for (int i = 0; i < 100'000; ++i) mesh += "f 1 2 3\n";
  put_bytes(folder / "a.obj", mesh);
  std::string materials, objects;
  for (int i = 0; i < 100; ++i) {
    const std::string comma = i == 0 ? "" : ",", name = "\"" + std::to_string(i) + "\"";
    materials += comma + name + R"(: {"diffuse": {"image": "a.hdr"}})";
    objects += comma + R"({"surface": {"type": "mesh", "file": "a.obj"}, "material-id": )" + name + "}";
  }
  put_bytes(folder / "scene.json",
            R"({"settings": {"resolution-x": 8, "resolution-y": 6, "integrator": "color"},
      "camera": {"projection": "perspective", "position": [0, 0, -5], "direction": [0, 0, 1], "upward": [0, 1, 0],
                 "field-of-view": 40}, "materials": {)" +
                materials + R"(}, "objects": [)" + objects + "]}");
  const Outcome shared = run_within(limit, "scene.json", folder);
  CHECK(shared.err == "");
  CHECK(shared.status == 0);
}

TEST_CASE("the values of a scene file are counted before they take memory") {
  const TemporaryFolder folder;
  std::string values = "[";
  values.reserve(std::size_t{1} << 26);
  for (int i = 0; i < 1 << 16; ++i) values += "0,";
  for (int i = 0; i < 8; ++i) values += values.substr(1);  // 2^24 zeros, and the array itself
  values.back() = ']';
  put_bytes(folder / "scene.json", values);
  const Outcome refused = run_within(500'000'000, "scene.json", folder);
  CHECK(refused.status == 1);
  CHECK(
      refused.err ==
      "render: scene.json: /16777215: there are more than the 16777216 values that are allowed in a file\n");
  values.replace(values.size() - 3, 3, "]");
  put_bytes(folder / "scene.json", values);
  CHECK(run_within(500'000'000, "scene.json", folder).err ==
        "render: scene.json: the whole: an array or object of 16777215 values is not an object\n");
}

TEST_CASE("running out of memory while a scene is read ends render with status 1 and one line") {
  const TemporaryFolder folder;
  const std::string sphere = R"({"surface": {"type": "csg", "operation": "union", "surfaces": [
      {"type": "sphere", "position": [0, 0, 3], "radius": 0.1}]}, "color": [1, 1, 1]},)";
  std::string spheres;
  for (int i = 0; i < 8'000; ++i) spheres += sphere;
  put_bytes(folder / "spheres.json", changed("\"objects\": [", "\"objects\": [" + spheres));
  std::string mesh = "v 0 0 1\nv 2 0 1\nv 0 2 1\n";
  for (int i = 0; i < 60'000; ++i) mesh += "f 1 2 3\n";
  put_bytes(folder / "a.obj", mesh);
  put_bytes(folder / "mesh.json",
            changed("\"objects\": [",
                    R"("objects": [{"surface": {"type": "mesh", "file": "a.obj"}, "color": [1, 1, 1]},)"));
  put_bytes(folder / "a.hdr",
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 500000 +X 7\n" + std::string(14'000'000, '\x80'));
  put_bytes(folder / "image.json", with_image("a.hdr"));
  for (const char* scene : {"spheres.json", "mesh.json", "image.json"}) {
    int refused = 0;
    // Limits grow by a sixth, from less than an idle program takes.
    for (rlim_t limit = 10'000'000; limit < 200'000'000; limit += limit / 6) {
      CAPTURE(scene, limit);
      const Outcome outcome = run_within(limit, scene, folder);
      if (outcome.status == 127) continue;  // the program could not be loaded
      check_one_line(outcome);
      refused += outcome.err == "render: " + std::string(scene) + ": not enough memory for this scene\n";
    }
    CHECK(refused > 2);
    CHECK(run_within(RLIM_INFINITY, scene, folder).status == 0);
  }
}

#endif
