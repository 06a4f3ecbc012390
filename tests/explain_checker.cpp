// Explanations that docs/check_explanation finds right, and changed ones that it has to refuse.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/explanation_checker.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_stage.hpp"
#if __has_include(<nlohmann/json.hpp>)
#include "support/run_render.hpp"
#endif

namespace {

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

/// Returns what the checker says of an explanation, which it finds as b.json in a folder.
Outcome checked(const TemporaryFolder& folder, const std::string& explanation) {
  put_bytes(folder / "b.json", explanation);
  return run({.program = explanation_checker, .arguments = {"b.json"}, .folder = folder / ""});
}

}  // namespace

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
    return checked(folder, changed.replace(at, from.size(), to));
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
  rows.push_back({"render",
                  scene_path("environment") + " --integrator path --samples 4 --pixel 300,200",
                  {"\"color\": ["}});
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
  const Outcome right = checked(folder, text);
  CHECK(right.err.empty());
  CHECK(right.status == 0);
  const Outcome wrong = checked(folder, with_another_digit(text, row.key));
  CHECK(wrong.status == 1);
  CHECK_THAT(wrong.err, ContainsSubstring(row.message));
}
#endif

#if __has_include(<nlohmann/json.hpp>)
TEST_CASE("the checker takes the rays of a hit in the order in which the integrator traces them") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  const std::string integrator = GENERATE("path", "direct");  // whose orders differ
  CAPTURE(integrator);
  // A ball in the light of a lamp, which is a ball, too, and of a light at a point.
  put_bytes(folder / "scene.json", R"({
    "settings": {"resolution-x": 24, "resolution-y": 30, "samples": 2, "integrator": ")" +
                                       integrator + R"("},
    "camera": {"projection": "perspective", "position": [0, 0.5, -4], "direction": [0, 0, 1],
               "upward": [0, 1, 0], "field-of-view": 60},
    "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 1}, "color": [0.04, 0.73, 0]},
                {"surface": {"type": "sphere", "position": [1, 2, -2], "radius": 0.5}, "material-id": "lamp"}],
    "lights": [{"position": [-1, 3, -1], "power": [50, 50, 50]}],
    "materials": {"lamp": {"emission": [5, 5, 5]}}
  })");
  REQUIRE(run_stage("render", "scene.json --pixel 12,15 --explain a.json --quiet", folder).status == 0);
  const std::string text = bytes_of(folder / "a.json");
  CHECK(checked(folder, text).err == "");
  CHECK(checked(folder, text).out == "b.json: right\n");
  // The directions of the shadow ray, and of the ray to the lamp.
  for (const std::string key : {"\"query\": \"any\"...\"direction\": [",
                                "\"query\": \"closest\"...\"query\": \"closest\"...\"direction\": ["})
    CHECK(checked(folder, with_another_digit(text, key)).status == 1);
}
#endif

#if __has_include(<nlohmann/json.hpp>)
TEST_CASE("an explanation of several lights in one direction tells which shadow ray is whose") {
  const TemporaryFolder folder;
  struct Row {
    std::string integrator, lights;
    std::vector<std::string> shadow_rays;  ///< of the lights
  };
  const std::string at_point = R"({"position": [0, 3, -3], "power": [50, 50, 50]})",
                    dark = R"({"position": [0, 3, -3], "power": [0, 0, 0]})",
                    along = R"({"direction": [0, 3, -3], "intensity": [1, 1, 1]})";
  const auto row = GENERATE_COPY(Row{"shadow", at_point + ", " + at_point, {"0", "1"}},
                                 Row{"shadow", along + ", " + at_point + ", " + along, {"0", "1", "2"}},
                                 Row{"direct", at_point + ", " + at_point, {"0", "1"}},
                                 // A light that adds nothing has no ray, not even the next one's.
                                 Row{"whitted", dark + ", " + at_point, {"null", "0"}});
  CAPTURE(row.integrator, row.lights);
  put_bytes(folder / "scene.json", R"({"settings": {"resolution-x": 8, "resolution-y": 6, "integrator": ")" +
                                       row.integrator + R"("}, "lights": [)" + row.lights + R"(],
    "camera": {"projection": "perspective", "position": [0, 0, -3], "direction": [0, 0, 1],
               "upward": [0, 1, 0], "field-of-view": 60},
    "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 1}, "color": [1, 1, 1]}]})");
  const Outcome outcome = run_stage("render", "scene.json --pixel 4,3 --explain a.json", folder);
  REQUIRE(outcome.status == 0);
  CHECK(outcome.out.find("refracted ray, ") == std::string::npos);
  const std::string text = bytes_of(folder / "a.json"), key = "\"shadow_ray\": ";
  std::vector<std::string> shadow_rays;
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1))
    shadow_rays.push_back(text.substr(at + key.size(), text.find('\n', at) - at - key.size()));
  CHECK(shadow_rays == row.shadow_rays);
  const Outcome right = checked(folder, text);
  if (right.status == 127) return;  // python3 is not installed
  CHECK(right.err == "");
  CHECK(right.status == 0);
  std::string changed = text;
  const Outcome wrong = checked(folder, changed.replace(changed.rfind(key) + key.size(), 1, "7"));
  CHECK(wrong.status == 1);
  CHECK_THAT(wrong.err, ContainsSubstring("/shadow_ray is 7"));
}

TEST_CASE("an explanation tells the time of rays with the shutter, though it be closed") {
  const TemporaryFolder folder;
  const auto& [camera, time] =
      GENERATE(table<std::string, std::string>({{R"("shutter": [2, 2])", "2"},
                                                {R"("velocity": [0.25, 0, 0])", "0"},
                                                {R"("shutter": [2, 2], "velocity": [0.25, 0, 0])", "2"}}));
  CAPTURE(camera);
  put_bytes(folder / "scene.json",
            R"({"settings": {"resolution-x": 8, "resolution-y": 6, "integrator": "shadow", "samples": 2},
    "camera": {"projection": "perspective", "position": [0, 0, -3], "direction": [0, 0, 1],
               "upward": [0, 1, 0], "field-of-view": 60, )" +
                camera + R"(},
    "objects": [{"surface": {"type": "sphere", "position": [0, 0, 0], "radius": 1}, "color": [1, 1, 1]}],
    "lights": [{"position": [0, 3, -3], "power": [50, 50, 50]}]})");
  const Outcome outcome = run_stage("render", "scene.json --pixel 4,3 --explain a.json", folder);
  REQUIRE(outcome.status == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("\n    time " + time + "\n"));
  const std::string text = bytes_of(folder / "a.json");
  const Outcome right = checked(folder, text);
  if (right.status == 127) return;  // python3 is not installed
  CHECK(right.err == "");
  CHECK(right.status == 0);
  std::string changed = text;
  const std::string before = "\"time\": " + time;
  const Outcome wrong =
      checked(folder, changed.replace(changed.find(before), before.size(), "\"time\": 0.5"));
  CHECK(wrong.status == 1);
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
  const auto status_of = [&](const std::string& file) { return checked(folder, file).status; };
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

TEST_CASE("docs/check_explanation refuses what no step of the light depends on") {
  const TemporaryFolder folder;
  if (run({.program = explanation_checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  struct Row {
    std::string stage, from, to;
    int status;
    std::string message;
  };
  const std::string lamp = "\"area_lights\": [\n    {\n      \"surface\": ";
  const std::vector<Row> rows{
      Row{"13_whitted", "\"type\": \"ConstantLight\"", "\"type\": \"Light\"", 1, "/type must be that"},
      Row{"09_shadow", "\"radiance\": null", "\"radiance\": 1", 1, "/radiance must be null"},
      Row{"24_path", "\"radiance\": null", "\"radiance\": [1, 1, 1]", 1, "/radiance must be null"},
      Row{"24_path", lamp + "3", lamp + "4", 1, "/area_lights/0/surface must name a surface"},  // a plane
      Row{"24_path", "_has_places\": false", "_has_places\": 0", 2, "must be true or false"},
  };
  for (const auto& [stage, from, to, status, message] :
       of_built_stages(rows, [](const Row& row) { return row.stage; })) {
    CAPTURE(stage, from);
    CHECK(run_stage(stage, "--size 160x120 --samples 1 --pixel 80,90 --explain a.json --quiet", folder).out ==
          "");
    std::string text = bytes_of(folder / "a.json");
    const auto check = [&] {
      return run({.program = explanation_checker, .arguments = {"a.json"}, .folder = folder / ""});
    };
    CHECK(check().status == 0);
    const std::size_t at = text.rfind(from);
    REQUIRE(at != std::string::npos);
    put_bytes(folder / "a.json", text.replace(at, from.size(), to));
    const Outcome outcome = check();
    CHECK(outcome.status == status);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  }
}
