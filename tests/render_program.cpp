// Tests of the program `render` as a user runs it: the picture of a scene file, and options for it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <protostar/encode.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "compare_images/picture.hpp"
#include "compare_images/read_image.hpp"
#include "reference/spheres_on_ground.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/random.hpp"
#include "support/run_render.hpp"
#include "support/run_stage.hpp"

namespace fs = std::filesystem;
using namespace protostar;

namespace {

std::string rendered(const std::string& name, const std::string& options,
                     const std::string& file = "out.ppm") {
  return stage_picture("render", scene_path(name) + " " + options, file);
}

/// Binary PPM of 8 bits, or PFM, as rows of bytes from the top.
struct PictureRows {
  int width = 0, height = 0;
  std::vector<std::string> rows;
};

PictureRows rows_of(const std::string& file) {
  PictureRows picture;
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

TEST_CASE("pictures of 300 random spheres over a plane match a long double computation, within one level",
          "[bytes]") {
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
    CHECK(run_stage("render", "scene.json -o a.png --integrator " + integrator, folder).status == 0);
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
        stage_picture(row.stage, "--size 320x240"));
  CHECK(rendered("three_spheres", "--size 160x120 --integrator " + row.integrator, "out.pfm") ==
        stage_picture(row.stage, "--size 160x120", "out.pfm"));
}

TEST_CASE("the scene file of stage 13 gives the whole picture of stage 13", "[bytes]") {
  CHECK(rendered("whitted", "") == stage_picture("13_whitted", ""));
}

TEST_CASE("WhittedIntegrator and ShadowIntegrator draw matte surfaces alike") {
  CHECK(rendered("three_spheres", "--integrator whitted") ==
        rendered("three_spheres", "--integrator shadow"));
}

TEST_CASE("a scene file sets the size, the integrator and the transfer; options override it") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("render", scene_path("three_spheres"), folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == "");
  CHECK(outcome.out.starts_with("out.ppm: 640x480, shadow, rendered in "));
  CHECK(bytes_of(folder / "out.ppm") == stage_picture("09_shadow", ""));

  const Outcome other = run_stage(
      "render", "--size 64x48 --integrator color --transfer linear -o a.ppm " + scene_path("three_spheres"),
      folder);
  CHECK(other.out.starts_with("a.ppm: 64x48, color, rendered in "));
  CHECK(bytes_of(folder / "a.ppm") == stage_picture("06_color", "--size 64x48 --transfer linear"));
}

// After an intended change: build/stages/render scenes/NAME.json -o tests/golden/scenes/NAME.png
TEST_CASE("every scene file gives its golden picture, and the gallery shows it", "[bytes]") {
  const std::string gallery = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "gallery.md");
  for (const auto& entry : fs::directory_iterator(scenes_folder)) {
    if (entry.path().extension() != ".json") continue;
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    CHECK_THAT(gallery, ContainsSubstring("../scenes/" + name + ".json"));
    if (name == "three_spheres" || name == "whitted") continue;  // covered by stages
    CHECK_THAT(gallery, ContainsSubstring("../tests/golden/scenes/" + name + ".png"));
    const Picture golden = read_image(
        (fs::path(PROTOSTAR_SOURCE_DIR) / "tests" / "golden" / "scenes" / (name + ".png")).string());
    // The long form draws the whole picture, the short form two rows in its middle.
    // A part of a picture with an error target has an error of its own.
    const bool has_error = bytes_of(entry.path()).find("\"error\"") != std::string::npos;
    const int width = golden.width, height = has_error ? golden.height : cases(2, golden.height);
    const int top = (golden.height - height) / 2;
    const TemporaryFolder folder;
    const std::string crop =
        "0," + std::to_string(top) + "," + std::to_string(width) + "," + std::to_string(height);
    CHECK(run_stage("render", scene_path(name) + " --crop " + crop + " -o a.png", folder).status == 0);
    const Picture expected = part_of(golden, 0, top, width, height),
                  drawn = read_image((folder / "a.png").string());
    REQUIRE(same_size(expected, drawn));
    CHECK(difference(expected, drawn).pixels == 0);
  }
}

TEST_CASE("every scene file of the project is drawn in any size") {
  for (const auto& entry : fs::directory_iterator(scenes_folder)) {
    if (entry.path().extension() != ".json") continue;
    const PictureRows drawn = rows_of(rendered(entry.path().stem().string(), "--size 40x30 --samples 0"));
    INFO(entry.path());
    bool varies = false;
    for (const std::string& row : drawn.rows) varies = varies || row != drawn.rows[0];
    CHECK(varies);
  }
}

TEST_CASE("without a depth, a path is cut after 100 bounces and one of whitted after 10 rays") {
  // Inside of a ball that shines, light is a geometric series in .8, of which each bounce adds a term.
  const auto drawn = [](const std::string& integrator, const std::string& share, const std::string& depth) {
    const TemporaryFolder folder;
    put_bytes(folder / "scene.json", R"({
      "settings": {"resolution-x": 8, "resolution-y": 6, "samples": 16, "integrator": ")" +
                                         integrator + "\"" + depth + R"(},
      "camera": {"projection": "perspective", "position": [0, 0.5, 0], "direction": [0, 0, 1],
                 "upward": [0, 1, 0], "field-of-view": 90},
      "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 2}, "material-id": "a"}],
      "materials": {"a": {"emission": [0.1, 0.1, 0.1], )" +
                                         share + "}}}");
    CHECK(run_stage("render", "scene.json -o a.pfm", folder).status == 0);
    return bytes_of(folder / "a.pfm");
  };
  const auto [integrator, share, ten, hundred] =
      GENERATE(std::array{"path", R"("diffuse": [0.8, 0.8, 0.8])", "", "default"},
               std::array{"whitted", R"("reflect": 0.8)", "default", ""});
  CAPTURE(integrator);
  const std::string by_default = drawn(integrator, share, "");
  const std::string of_ten = drawn(integrator, share, R"(, "depth": 10)");
  const std::string of_hundred = drawn(integrator, share, R"(, "depth": 100)");
  CHECK(of_ten != of_hundred);
  CHECK((by_default == of_ten) == (std::string(ten) == "default"));
  CHECK((by_default == of_hundred) == (std::string(hundred) == "default"));
}

TEST_CASE("a crop has the bytes of the same part of the whole picture") {
  const std::string name =
      GENERATE("whitted", "mirror_walls", "orthographic", "three_spheres", "scale_image");
  const std::string samples = GENERATE("0", "3"), file = GENERATE("a.ppm", "a.pfm");
  CAPTURE(name, samples, file);
  const std::string options = "--size 150x90 --samples " + samples;
  const PictureRows whole = rows_of(rendered(name, options, file));
  const std::size_t pixel = whole.rows[0].size() / 150;
  struct Crop {
    int x, y, width, height;
  };
  for (const Crop& crop :
       {Crop{0, 0, 150, 90}, Crop{61, 33, 71, 50}, Crop{149, 89, 1, 1}, Crop{0, 40, 150, 1}}) {
    const PictureRows part =
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
  const PictureRows wide = rows_of(rendered("three_spheres", "--size 256x64")),
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
    CHECK(run_stage("render", "scene.json -o a.pfm --integrator " + integrator, folder).status == 0);
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

TEST_CASE("render --help names its own options") {
  const TemporaryFolder folder;
  const Outcome help = run_stage("render", "--help", folder);
  CHECK(help.status == 0);
  for (const char* text : {"SCENE.json", "--integrator I", "--samples N", "--crop X,Y,W,H", "[the scene's]"})
    CHECK_THAT(help.out, ContainsSubstring(text));
}
