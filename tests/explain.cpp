// The explanation of a pixel, which every stage and render print: it ends with the pixel's codes in the
// picture.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/explanation_checker.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/random.hpp"
#include "support/run_stage.hpp"
#include "support/wrong_cases.hpp"
#if __has_include(<nlohmann/json.hpp>)
#include <nlohmann/json.hpp>

#include "support/run_render.hpp"
#endif

namespace {

namespace fs = std::filesystem;

using Codes = std::array<int, 3>;

const std::vector<std::string> explaining_stages {
  "01_gradient", "02_sphere", "03_scene", "04_depth", "05_normal", "06_color", "07_diffuse", "08_naive",
      "08_transparency", "09_naive", "09_shadow", "10_phong", "11_mirror", "12_glass", "13_whitted",
      "14_primitives", "15_csg", "16_environment", "18_antialiasing", "19_soft_shadows", "20_lens",
      "21_motion", "22_glossy", "23_ambient_occlusion", "24_path", "25_cornell", "26_weekend",
      "27_normal_map", "30_fixed_step", "31_sphere_tracing", "32_enhanced", "33_certified", "34_fields",
      "35_blend", "36_repetition", "37_marched_shadow", "38_fractal",
#if __has_include(<tiny_obj_loader.h>)  // otherwise this stage is not built
      "17_mesh",
#endif
};

/// Picture that a program has drawn as plain PPM.
class PlainPicture {
 public:
  explicit PlainPicture(const std::string& file) {
    std::istringstream text(file);
    std::string magic;
    int most = 0;
    text >> magic >> width >> height >> most;
    REQUIRE(magic == "P3");
    for (int code = 0; text >> code;) codes_.push_back(code);
    REQUIRE(codes_.size() == static_cast<std::size_t>(3 * width * height));
  }

  [[nodiscard]] Codes at(int x, int y) const {
    const auto i = static_cast<std::size_t>(3 * (y * width + x));
    return {codes_[i], codes_[i + 1], codes_[i + 2]};
  }

  int width = 0, height = 0;

 private:
  std::vector<int> codes_;
};

/// Returns the codes at the end of an explanation.
Codes codes_of(const std::string& explanation) {
  Codes codes{-1, -1, -1};
  const std::size_t last = explanation.rfind(": ");
  if (last != std::string::npos)
    std::istringstream(explanation.substr(last + 2)) >> codes[0] >> codes[1] >> codes[2];
  return codes;
}

std::string pixel(int x, int y) { return " --pixel " + std::to_string(x) + "," + std::to_string(y); }

/// Compares explanations of a few pixels, by a function of the arguments, with the picture.
void compare(const PlainPicture& picture, const auto& explain) {
  Random random(7);
  WrongCases wrong(random);
  for (int i = 0; i < 5; ++i) {
    const int x = i == 0 ? picture.width / 2 : static_cast<int>(random.real(0, picture.width)),
              y = i == 0 ? picture.height / 2 : static_cast<int>(random.real(0, picture.height));
    const Outcome outcome = explain(pixel(x, y));
    wrong.add(outcome.status != 0 || !outcome.err.empty() || codes_of(outcome.out) != picture.at(x, y),
              "pixel", x, y);
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("the option --pixel tells for every stage why a pixel has the codes that it has in the picture") {
  const std::string name = GENERATE(from_range(of_built_stages(explaining_stages, std::identity{})));
  CAPTURE(name);
  const std::string size = "--size 64x48";
  const PlainPicture picture(stage_picture(name, size + " --plain"));
  const TemporaryFolder folder;
  compare(picture, [&](const std::string& of_pixel) { return run_stage(name, size + of_pixel, folder); });
  CHECK(folder.count() == 0);
}

TEST_CASE(
    "the option --pixel tells of the rays of a naive stage, and of a surface that hides the light from "
    "itself") {
  const TemporaryFolder folder;
  // A ray that starts on the surface itself hits it again in many pixels of the ground, at a t near 0.
  int near = 0;
  for (int x = 0; x < 40; ++x) {
    const Outcome outcome =
        run_stage("09_naive", "--size 64x48 --offset 0 --pixel " + std::to_string(x) + ",40", folder);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, ContainsSubstring("\n      ray from (0, 0, 0) along ") &&
                                ContainsSubstring("\n        closest hit at ("));
    const std::size_t shadow = outcome.out.find("shadow ray, stopped by a hit with t < ");
    REQUIRE(shadow != std::string::npos);
    const std::string found = ": hit at t = ";
    const std::size_t at = outcome.out.find(found, shadow);
    if (at != std::string::npos && std::stod(outcome.out.substr(at + found.size())) < 0.01) {
      ++near;
      CHECK(codes_of(outcome.out) == Codes{0, 0, 0});
    }
  }
  CHECK(near > 0);
}

#if __has_include(<nlohmann/json.hpp>)
TEST_CASE(
    "the option --pixel counts in the whole picture of a scene file, with samples, exposure, tone and crop") {
  const std::string name =
      GENERATE("scale_image", "scale_pixel", "exposure", "samples", "solids", "sensor", "spot", "image",
               "mesh", "environment", "orthographic", "csg", "normal_map");
  CAPTURE(name);
  const TemporaryFolder folder;
  const std::string size = scene_path(name) + " --size 48x36";
  REQUIRE(run_stage("render", size + " --plain --quiet -o whole.ppm", folder).status == 0);
  compare(PlainPicture(bytes_of(folder / "whole.ppm")), [&](const std::string& of_pixel) {
    return run_stage("render", size + " --crop 40,20,8,8" + of_pixel, folder);
  });
  CHECK(folder.count() == 1);
}

TEST_CASE("the option --pixel tells which arithmetic has decided where a ray hits a surface") {
  // Through pixel 1 of four leads the line x = -1, which touches the sphere. At x = -3 it misses.
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json",
            R"({"settings": {"resolution-x": 4, "resolution-y": 1, "integrator": "depth"},
      "camera": {"projection": "orthographic", "position": [0, 0, -5], "direction": [0, 0, 1],
                 "upward": [0, 1, 0], "ortho-scale": 2},
      "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 1}, "material-id": "m"}],
      "materials": {"m": {"diffuse": [1, 1, 1]}}})");
  const auto told = [&](const char* arguments) {
    return run_stage("render", std::string("scene.json ") + arguments, folder).out;
  };
  CHECK_THAT(told("--pixel 1,0"), ContainsSubstring("hit at t = 5 +- 4.7e-09, decided in exact arithmetic"));
  CHECK_THAT(told("--pixel 0,0"), ContainsSubstring("missed, decided in double"));
}
#endif

TEST_CASE("the explanation of a pixel goes from the film through the lights to the codes") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("09_shadow", "--pixel 330,200", folder);
  CHECK(outcome.status == 0);
  std::size_t at = 0;
  for (const char* text :
       {"pixel 330,200 of 640x480",
        "film point u = 0.04375, v = 0.164583333",
        "ray from (0, 0, 0) along",
        "surface 0, sphere, center (0, 0, 3), radius 1: hit at t = 2.09351108 +- 1.9e-09, decided in double",
        "surface 1, sphere",
        ", no root",
        "surface 2, sphere",
        "point (",
        "normal (",
        "color (1, 0.3, 0)",
        "light 0, a PointLight",
        "cosine 0.8395",
        "irradiance (",
        "share of the radiance (",
        "shadow ray, from",
        "left by the ray, and not hit again",
        "not occluded",
        "radiance = color *",
        "tone clip",
        "transfer gamma 2.2, times 255 and rounded: 222 129 0\n"}) {
    CAPTURE(text);
    const std::size_t next = outcome.out.find(text, at);
    REQUIRE(next != std::string::npos);
    at = next;
  }
  CHECK(folder.count() == 0);
}

TEST_CASE("the explanation of a pixel tells the emission of a surface apart from the light that lights add") {
  const TemporaryFolder folder;
  put_bytes(folder / "a.json", R"({
    "settings": {"resolution-x": 8, "resolution-y": 8},
    "camera": {"projection": "perspective", "position": [0, 0, 0], "direction": [0, 0, 1], "upward": [0, 1, 0],
               "field-of-view": 60},
    "objects": [{"surface": {"type": "plane", "normal": [0, 0, 1], "distance": 3}, "material-id": "lamp"}],
    "lights": [{"direction": [0, 0, -1], "intensity": [0.5, 0.5, 0.5]},
               {"direction": [0, 3, -4], "intensity": [0.25, 0.25, 0.25]}],
    "materials": {"lamp": {"diffuse": [0.5, 0.5, 0.5], "emission": [0.125, 0.25, 0.5], "specular": [0.1, 0, 0],
                           "shininess": 1e9, "refract": 0.5, "ior": 1.25}}
  })");
  const Outcome outcome = run_stage("render", "a.json --pixel 4,4 --explain b.json", folder);
  REQUIRE(outcome.status == 0);
  std::size_t at = 0;
  for (const char* text :
       {"    emission (0.125, 0.25, 0.5)\n", "    specular (0.1, 0, 0), shininess 1e+09\n",
        "share of the radiance (0.25, 0.25, 0.25)\n", "share of the radiance (0.1, 0.1, 0.1)\n",
        "refracted ray, refract = 0.5, ior = 1.25, from", "radiance = emission + color * ambient light +",
        ": (0.475, 0.6, 0.85)\n"}) {
    CAPTURE(text);
    const std::size_t next = outcome.out.find(text, at);
    REQUIRE(next != std::string::npos);
    at = next;
  }
  const Outcome checked =
      run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""});
  CAPTURE(checked.err);
  CHECK((checked.status == 0 || checked.status == 127));  // 127: python3 is not installed
}

TEST_CASE("the explanation of a pixel tells on which side of a ray's range a surface is crossed") {
  const TemporaryFolder folder;
  // The point at (0, 0, 4) is in the big sphere, whose center is behind it on the way to the light.
  put_bytes(folder / "a.json", R"({
    "settings": {"resolution-x": 9, "resolution-y": 9, "integrator": "shadow"},
    "camera": {"projection": "perspective", "position": [0, 0, 0], "direction": [0, 0, 1], "upward": [0, 1, 0],
               "field-of-view": 60},
    "objects": [{"surface": {"type": "sphere", "position": [0, 0, 5], "radius": 1}, "color": [1, 1, 1]},
                {"surface": {"type": "sphere", "position": [0, 0, 5], "radius": 100}, "color": [1, 1, 1]},
                {"surface": {"type": "sphere", "position": [0, 0, 9], "radius": 1}, "color": [1, 1, 1]},
                {"surface": {"type": "plane", "normal": [0, 1, 0], "distance": -9}, "color": [1, 1, 1]}],
    "lights": [{"position": [0, 0, -5], "power": [1, 1, 1]}]
  })");
  const Outcome outcome = run_stage("render", "a.json --pixel 4,4", folder);
  REQUIRE(outcome.status == 0);
  std::size_t at = 0;
  for (const char* text :
       {"t = -9 / 0: parallel to the ray\n", "shadow ray, from", "sphere, center (0, 0, 5), radius 100",
        ", no root in that range\n", "sphere, center (0, 0, 9)", ", roots below 0\n"}) {
    CAPTURE(text);
    const std::size_t next = outcome.out.find(text, at);
    REQUIRE(next != std::string::npos);
    at = next;
  }
}

#if __has_include(<nlohmann/json.hpp>)
TEST_CASE("the file of an explanation is JSON whatever the names of images are") {
  const TemporaryFolder folder;
  const std::string name = "a\n\x1b\"\\\xc3\xa9.png";
  // A byte that is no character of UTF-8, as which some file systems allow no name.
  std::error_code refused;
  fs::create_directory(folder / "\xff", refused);
  for (const auto& [of, written_of] : {std::pair<std::string, std::string>{"", ""}, {"\xff/", R"(\\xff/)"}}) {
    if (!of.empty() && refused) continue;
    fs::copy_file(fs::path(PROTOSTAR_SOURCE_DIR) / "tests" / "fuzz" / "pool" / "a.png", folder / (of + name));
    put_bytes(folder / (of + "a.json"), scene_with_image(R"(a\n\u001b\"\\\u00e9.png)"));
    REQUIRE(run_stage("render", of + "a.json --pixel 8,6 --explain e.json --quiet", folder).status == 0);
    const auto written = nlohmann::json::parse(bytes_of(folder / "e.json"), nullptr, false);
    REQUIRE(!written.is_discarded());
    CHECK_THAT(written.dump(),
               ContainsSubstring(R"("file":")" + written_of + "a\\n\\u001b\\\"\\\\\xc3\xa9.png\""));
    if (!of.empty()) continue;  // whose name JSON does not hold
    const auto check = [&] {
      return run({.program = explanation_checker, .arguments = {"e.json"}, .folder = folder / ""});
    };
    if (check().status == 127) continue;  // python3 is not installed
    CHECK(check().out == "e.json: right\n");
    std::string text = bytes_of(folder / "e.json");
    put_bytes(folder / "e.json", text.replace(text.find("\\u001b"), 6, "\\q"));
    CHECK(check().status == 2);
    CHECK_THAT(check().err, ContainsSubstring("/image/file is not a word of JSON"));
  }
}
#endif

TEST_CASE("the explanation of a pixel tells what a normal map makes of the normal") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("27_normal_map", "--pixel 500,400", folder);
  CHECK(outcome.status == 0);
  std::size_t at = 0;
  for (const char* text :
       {"    normal (0.407592, 0.617415, -0.672806)\n",
        "    the normal map holds the direction (0, 0.129935, 1) at u = 0.913311, v = 0.28818\n",
        "      tangents: u grows along (-0.672806, 0, -0.407592), v along (0.251653, -0.618799, -0.4154)\n",
        "      shading normal (0.445415, 0.510908, -0.73524)\n", "cosine 0.576439\n",
        "irradiance (0.576439, 0.576439, 0.576439) = (1, 1, 1) * cosine\n"}) {
    CAPTURE(text);
    const std::size_t next = outcome.out.find(text, at);
    REQUIRE(next != std::string::npos);
    at = next;
  }
}

TEST_CASE("the option --rays draws the rays of a pixel as SVG or OBJ") {
  const TemporaryFolder folder;
  for (const char* name : {"a.svg", "a.obj"})
    CHECK(run_stage("09_shadow", std::string("--pixel 330,200 --quiet --rays ") + name, folder).status == 0);
  const std::string svg = bytes_of(folder / "a.svg"), obj = bytes_of(folder / "a.obj");
  CHECK(svg.starts_with("<svg xmlns="));
  CHECK(svg.ends_with("</svg>\n"));
  CHECK_THAT(svg, ContainsSubstring("from above"));
  CHECK_THAT(svg, ContainsSubstring("from the side"));
  // A ray of the camera and one to the light.
  CHECK_THAT(obj, ContainsSubstring("v 0 0 0\n"));
  CHECK_THAT(obj, ContainsSubstring("v 0 3 0\n"));
  CHECK(obj.ends_with("g camera\nl 1 2\ng shadow\nl 3 4\n"));
  CHECK(folder.count() == 2);
}

TEST_CASE("a file of an explanation that cannot be written is an error, and none is left") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("09_shadow", "--pixel 330,200 --explain no/a.json --quiet", folder);
  CHECK(outcome.status == 1);
  CHECK(outcome.err == cannot_write("09_shadow", "no/a.json", ENOENT));
  CHECK(folder.count() == 0);
}

TEST_CASE("the explanations in docs/explain.md are those that the stages print") {
  const std::string page = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "explain.md");
  const std::string mark = "<!-- output: ", end_of_mark = " -->\n```text\n", end = "```\n<!-- /output -->";
  int count = 0;
  for (std::size_t at = page.find(mark); at != std::string::npos; at = page.find(mark, at + 1)) {
    const std::size_t begin = at + mark.size(), text = page.find(end_of_mark, begin) + end_of_mark.size();
    const std::string command = page.substr(begin, text - end_of_mark.size() - begin);
    CAPTURE(command);
    const TemporaryFolder folder;
    const std::size_t space = command.find(' ');
    const Outcome outcome = run_stage(command.substr(0, space), command.substr(space), folder);
    CHECK(page.substr(text, page.find(end, text) - text) == outcome.out);
    ++count;
  }
  CHECK(count > 0);
}

TEST_CASE("docs/figures/rays.svg is the drawing of docs/explain.md") {
  const TemporaryFolder folder;
  CHECK(run_stage("13_whitted", "--pixel 400,400 --quiet --rays rays.svg", folder).status == 0);
  CHECK(bytes_of(folder / "rays.svg") ==
        bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "figures" / "rays.svg"));
}
