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

const fs::path explanation_checker = fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "check_explanation";

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

/// Returns a text with another digit in the number that follows a key, in which "..." stands for any text.
std::string with_another_digit(std::string text, const std::string& key) {
  std::size_t at = 0;
  for (std::size_t begin = 0; begin <= key.size();) {
    const std::size_t end = std::min(key.find("...", begin), key.size());
    const std::string part = key.substr(begin, end - begin);
    at = text.find(part, at);
    REQUIRE(at != std::string::npos);
    at += part.size();
    begin = end + 3;
  }
  char& digit = text[text.find_first_of("123456789", at)];
  digit = digit == '5' ? '6' : '5';
  return text;
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

TEST_CASE("the option --explain writes a file that docs/check_explanation finds right, wrong or unreadable") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  CHECK(run_stage("09_shadow", "--pixel 330,200 --explain a.json --quiet", folder).out == "");
  const std::string text = bytes_of(folder / "a.json");
  const auto check = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    REQUIRE(at != std::string::npos);
    put_bytes(folder / "b.json", changed.replace(at, from.size(), to));
    return run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""});
  };
  CHECK(check("", "").status == 0);
  struct Row {
    std::string from, to, path;
  };
  for (const auto& [from, to, path] :
       {Row{"\"codes\": [222", "\"codes\": [223", "/codes/0 is 223"},
        Row{"[0, 0, 3]", "[0, 0, 4]", "equation"}, Row{"\"taken\": 0", "\"taken\": 1", "/taken is 1"},
        Row{"2.2,", "2.3,", "/codes/"}}) {
    CAPTURE(from);
    const Outcome outcome = check(from, to);
    CHECK(outcome.status == 1);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("b.json:"));
    CHECK_THAT(outcome.err, ContainsSubstring(path));
  }
  CHECK(check("{", "[").status == 2);
  CHECK(check("\"samples\"", "\"sample\"").status == 2);
  CHECK(run({.program = explanation_checker, .arguments = {"none.json"}, .folder = folder / ""}).status == 2);
  CHECK(run({.program = explanation_checker, .arguments = {}, .folder = folder / ""}).status == 2);
}

TEST_CASE(
    "an explanation has the sampler's numbers that an integrator takes, and the checker computes them") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  for (const std::string sampler : {"independent", "sobol", "halton", "stratified"}) {
    CAPTURE(sampler);
    const std::string options =
        "--pixel 320,400 --samples 6 --seed 18446744073709551615 --explain a.json --sampler " + sampler;
    const std::string told = run_stage("19_soft_shadows", options, folder).out;
    CHECK_THAT(told, ContainsSubstring("set 1 of the sampler: 0."));
    const std::string text = bytes_of(folder / "a.json");
    const std::size_t set = text.find("\"set\": 1,"), numbers = text.find("\"numbers\": [0.", set);
    REQUIRE(numbers < text.size());
    const auto status_with = [&](std::size_t at, std::size_t size, const std::string& replacement) {
      put_bytes(folder / "b.json", std::string(text).replace(at, size, replacement));
      return run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""}).status;
    };
    const std::size_t first = numbers + std::string("\"numbers\": [").size();
    CHECK(status_with(0, 0, "") == 0);
    const auto with_another_digit = [&](std::size_t at) {
      return status_with(at, 1, text[at] == '5' ? "6" : "5");
    };
    CHECK(with_another_digit(first + 4) == 1);
    if (sampler != "independent") continue;  // the rest is the same for all
    CHECK(with_another_digit(text.find("0.", text.find("\"position\": [")) + 4) == 1);
    CHECK(status_with(set, 8, "\"set\": 2") == 1);
    CHECK(status_with(first, 2, "1.") == 1);
  }
}

TEST_CASE(
    "an explanation has the steps of a naive stage, fields, hits in colored glass, light by chance and the "
    "pixels of an environment, and the checker computes them",
    "[long]") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  struct Row {
    std::string program, arguments;
    /// Texts before numbers, each of which must be refused with another digit; "..." stands for any text.
    std::vector<std::string> keys;
    /// What the message for each of them says, where a number has a check of its own: later ones would refuse
    /// it, too.
    std::vector<std::string> messages{};
  };
  const std::string constant = "\"type\": \"constant\"...",
                    third_constant = constant + constant + constant + "\"number\": ";
  std::vector<Row> rows{
      {"08_naive", "--pixel 330,200", {"\"offset\": ", "\"normal\": ["}},
      {"09_naive", "--pixel 330,200", {"\"power\": [", "\"end\": "}},
      {"08_transparency", "--pixel 330,200", {"\"color\": ["}},
      {"16_environment", "--pixel 10,10", {"\"radiance\": ["}},
      {"33_certified",
       "--pixel 330,200",
       {"\"to\": ", "\"from\": ", third_constant},
       {"/to ", "/from ", "/value is "}},
      {"19_soft_shadows",
       "--size 160x120 --pixel 42,53 --samples 4",
       {"\"emission\": [", "\"query\": \"closest\"...\"query\": \"closest\"...\"direction\": ["},
       {"/material/emission/0 is ", "/direction/0 is "}},
      {"22_glossy", "--size 160x120 --pixel 80,59 --samples 4", {"\"roughness\": "}, {"/direction/0 is "}},
      {"21_motion",
       "--size 160x120 --pixel 54,102 --samples 4",
       {"\"type\": \"moving\"...\"velocity\": ["},
       {"/equation/parts/0/b is "}},
      {"31_sphere_tracing",
       "--pixel 330,200",
       {"\"field\": ", "\"power\": [", "\"color\": ["},
       {"/field is ", "/radiance/0 is ", "/radiance/0 is "}},
      // Paths that end at the lamp, which asks for no numbers.
      {"25_cornell",
       "--size 160x120 --pixel 99,108 --samples 2",
       {"\"emission\": ["},
       {"/material/emission/0 is "}},
      {"23_ambient_occlusion",
       "--pixel 320,400 --samples 1",
       {"\"query\": \"any\"...\"direction\": ["},
       {"/direction/0 is "}},
      {"26_weekend",
       "--pixel 320,400 --samples 1",
       {"\"query\": \"closest\"...\"query\": \"closest\"...\"direction\": ["},
       {"/direction/0 is "}},
      {"18_antialiasing",
       "--pixel 330,200 --samples 2 --filter mitchell",
       {"\"position\": [0.", "\"weight\": "},
       {", up to which the filter has ", "/weight is "}}};
#if __has_include(<nlohmann/json.hpp>)
  rows.push_back({"render", scene_path("environment") + " --pixel 5,5", {"\"color\": ["}});
  rows.push_back({"render", scene_path("torus") + " --pixel 330,260", {"\"radius\": ", "\"tube\": "}});
  // Under total reflection, the share that is refracted has no effect: only other hits of that glass tell it.
  rows.push_back({"render",
                  PROTOSTAR_SOURCE_DIR "/tests/explain/normal_maps.json --pixel 43,105",
                  {"\"refract\": 0.6...\"refract\": 0."},
                  {"/rays/2/hit/material/refract is "}});
#endif
#if __has_include(<tiny_obj_loader.h>)
  rows.push_back({"17_mesh", "--pixel 300,260", {"\"normal_b\": ["}, {"/primitive/normal_b/0 is "}});
#endif
  for (const auto& [program, arguments, keys, messages] :
       of_built_stages(rows, [](const Row& row) { return row.program; })) {
    CAPTURE(program);
    REQUIRE(run_stage(program, arguments + " --explain a.json --quiet", folder).status == 0);
    const std::string text = bytes_of(folder / "a.json");
    const auto check = [&](const std::string& file) {
      put_bytes(folder / "b.json", file);
      return run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""});
    };
    const Outcome right = check(text);
    CHECK(right.status == 0);
    CHECK(right.out.find("taken from the file: the radiance") == std::string::npos);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::string& key = keys[i];
      CAPTURE(key);
      const Outcome wrong = check(with_another_digit(text, key));
      CHECK(wrong.status == 1);
      CHECK(wrong.err.starts_with("b.json:"));
      if (!messages.empty()) CHECK_THAT(wrong.err, ContainsSubstring(messages[i]));
    }
  }
}

TEST_CASE("the checker refuses a glossy color without what blurs it, as a black one has none") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  REQUIRE(run_stage("19_soft_shadows", "--size 160x120 --pixel 42,53 --samples 1 --explain a.json --quiet",
                    folder)
              .status == 0);
  std::string text = bytes_of(folder / "a.json");
  const std::string black = "\"glossy\": [0, 0, 0]";
  REQUIRE(text.find(black) != std::string::npos);
  put_bytes(folder / "b.json", text.replace(text.find(black), black.size(), "\"glossy\": [0, 0.5, 0]"));
  const Outcome wrong = run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""});
  CHECK(wrong.status == 1);
  CHECK_THAT(wrong.err, ContainsSubstring("/material/glossy must be black"));
}

#if __has_include(<nlohmann/json.hpp>)
TEST_CASE("the checker proves marches of fields with edges, from near and from far away") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  struct Row {
    std::string field, camera, angle, pixel;
    std::string key, message;  // of a number that is refused with another digit
  };
  const std::string box = R"({"type": "box", "size": [2, 2, 2]})";
  const std::string far_box = R"({"type": "translate", "by": [0, 0, 35184372088832], "field": )"
                              R"({"type": "rotate", "axis": [1, 0, 0], "angle": 30, "field": )" +
                              box + "}}";
  const std::string rounded = R"({"type": "rounded-box", "size": [2, 2, 1.5], "radius": 0.25})";
  const auto along_z = [](const std::string& z) {
    return R"("position": [0, 0, )" + z + R"(], "direction": [0, 0, 1], "upward": [0, 1, 0])";
  };
  const auto row = GENERATE_COPY(
      Row{box, along_z("-5"), "30", "16,16", "\"sign change\"...\"min\": ", "/value_at_min"},
      Row{box, along_z("-35184372088832"), "5e-12", "16,16", "\"sign change\"...\"min\": ", "/value_at_min"},
      // Both ends of a value in double-double are one double.
      Row{box,
          R"("position": [-123534654146333, -7266744361549, 1119078631678546], )"
          R"("direction": [17, 1, -154], "upward": [0, 154, 1])",
          "1.12e-13", "20,12", "\"sign change\"...\"min\": ", "/value_at_min"},
      // The point of the hit is rounded, by so much that the field does not change around it.
      Row{R"({"type": "metaballs", "sharpness": 2, "balls": [{"position": [0, 0, 0], "radius": 1}]})",
          R"("position": [-1031204342808898700, 0, -515602171404449340], )"
          R"("direction": [2, 0, 1], "upward": [0, 1, 0])",
          "1.1e-16", "16,16", "\"hit\"...\"normal\": [", "/normal/2 is"},
      // Points of a mirrored ray tell no values in double, and slopes prove that it leads away.
      Row{far_box, along_z("0"), "7e-12", "10,12", "-infinity...\"from\": ", "/from is"},
      // What is known of the field behind the origin of a mirrored ray counts to its last digits.
      Row{rounded, along_z("-1152921504606846976"), "2.2e-16", "22,15", "\"deflation\"...\"slopes\": [..., ",
          "must prove"});
  CAPTURE(row.field, row.camera);
  put_bytes(folder / "scene.json",
            R"({"settings": {"resolution-x": 32, "resolution-y": 32}, "camera": {)"
            R"("projection": "perspective", "field-of-view": )" +
                row.angle + ", " + row.camera + R"(}, "objects": [{"surface": {"type": "field", "field": )" +
                row.field +
                R"(}, "material-id": "a"}], "materials": {"a": {"diffuse": [1, 1, 1], "reflect": 0.5}}})");
  REQUIRE(
      run_stage("render", "scene.json --pixel " + row.pixel + " --explain a.json --quiet", folder).status ==
      0);
  const std::string text = bytes_of(folder / "a.json");
  const auto check = [&](const std::string& file) {
    put_bytes(folder / "b.json", file);
    return run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""});
  };
  const Outcome right = check(text);
  CHECK(right.err.empty());
  CHECK(right.status == 0);
  const Outcome wrong = check(with_another_digit(text, row.key));
  CHECK(wrong.status == 1);
  CHECK_THAT(wrong.err, ContainsSubstring(row.message));
}
#endif

#if __has_include(<tiny_obj_loader.h>)
TEST_CASE("an explanation has all triangles of a mesh, and the checker finds those that a ray crosses") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  REQUIRE(run_stage("17_mesh", "--pixel 300,260 --explain a.json --quiet", folder).status == 0);
  const std::string text = bytes_of(folder / "a.json");
  const auto status_of = [&](const std::string& file) {
    put_bytes(folder / "b.json", file);
    return run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""}).status;
  };
  CHECK(status_of(text) == 0);

  // A vertex of the triangle that is hit, among all vertices.
  const std::string before = "\"a\": [";
  const std::size_t corner = text.find(before, text.find("\"primitive\"")) + before.size();
  REQUIRE(corner < text.size());
  const std::string vertex = text.substr(corner, text.find(']', corner) - corner);
  const std::size_t place = text.find(vertex, text.find("\"vertices\": ["));
  REQUIRE(place < corner);
  std::string changed = text;
  char& digit = changed[changed.find_first_of("123456789", place)];
  digit = digit == '5' ? '6' : '5';
  CHECK(status_of(changed) == 1);

  // Another triangle, in front of all.
  const auto append = [&](const std::string& list, const std::string& numbers) {
    const std::size_t begin = changed.find("\"" + list + "\": ["), end = changed.find(']', begin);
    REQUIRE(end < changed.size());
    changed.insert(end, ", " + numbers);
    return std::count(changed.begin() + static_cast<std::ptrdiff_t>(begin),
                      changed.begin() + static_cast<std::ptrdiff_t>(end), ',');
  };
  changed = text;
  const auto count = (append("vertices", "-9, -9, 0.5, 9, -9, 0.5, 0, 9, 0.5") + 1) / 3;
  append("normals", "0, 0, 1, 0, 0, 1, 0, 0, 1");
  CHECK(status_of(changed) == 0);  // three more vertices, of no triangle
  append("corners",
         std::to_string(count) + ", " + std::to_string(count + 1) + ", " + std::to_string(count + 2));
  const std::string triangles = "\"triangles\": 3600";
  CHECK(status_of(changed) == 1);  // which is one more than the file says
  changed.replace(changed.find(triangles), triangles.size(), "\"triangles\": 3601");
  CHECK(status_of(changed) == 1);
}
#endif

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
