// Options and scenes that `render` refuses: its exit status and its messages.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_render.hpp"
#include "support/run_stage.hpp"

namespace fs = std::filesystem;

TEST_CASE("wrong options of render are named, with the right ones, and nothing is drawn") {
  struct Row {
    std::string arguments, error;
  };
  const std::string crop =
                        "X,Y,W,H, whole numbers of a part of at least one pixel that lies inside the picture",
                    crop_of_size = crop + " of 640x480", samples = "a whole number from 0 to 65536",
                    integrators =
                        "one of binary, depth, normal, color, diffuse, transparency, shadow, whitted, "
                        "ambient-occlusion, direct, path, distance-occlusion, distance-shadow, evaluations, "
                        "enclosure-width";
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
                              not_allowed("--integrator", "paths", integrators),
                              not_allowed("--integrator", "Shadow", integrators),
                              {"--size 0x0", "--size: '0x0' is not WIDTHxHEIGHT"},
                              {"stray", "stray"}};
  const TemporaryFolder folder;
  for (const Row& row : rows) {
    CAPTURE(row.arguments);
    const Outcome outcome = run_stage("render", scene_path("three_spheres") + " " + row.arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("render: "));
    CHECK_THAT(outcome.err, ContainsSubstring(row.error));
  }
  const Outcome no_scene = run_stage("render", "--size 8x8", folder);
  CHECK(no_scene.status == 2);
  CHECK_THAT(no_scene.err, ContainsSubstring("scene is required"));
  CHECK(folder.count() == 0);
}

TEST_CASE("render writes no picture and no other file over an image or a mesh that its scene names") {
  const TemporaryFolder folder;
  copy_image("../scenes/bricks.png", folder);
  put_bytes(folder / "mesh.obj", "v 0 0 3\nv 1 0 3\nv 0 1 3\nf 1 2 3\n");
  std::string scene = scene_with_image("bricks.png");
  const std::string first = "\"objects\": [";
  REQUIRE(scene.find(first) != scene.npos);
  scene.insert(scene.find(first) + first.size(),
               R"({"surface": {"type": "mesh", "file": "mesh.obj"}, "color": [1, 1, 1]}, )");
  put_bytes(folder / "scene.json", scene);
  const std::string bricks = bytes_of(folder / "bricks.png"), mesh = bytes_of(folder / "mesh.obj");
  for (const auto& [arguments, error] : {std::pair{"-o bricks.png", "-o: 'bricks.png'"},
                                         {"-o ./bricks.png", "-o: './bricks.png'"},
                                         {"--pixel 1,1 --rays mesh.obj", "--rays: 'mesh.obj'"}}) {
    CAPTURE(arguments);
    const Outcome outcome = run_stage("render", std::string("scene.json --size 8x6 ") + arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err == std::string("render: ") + error +
                             " is not another file than those of the scene\nRun with --help for what is "
                             "allowed.\n");
    CHECK(bytes_of(folder / "bricks.png") == bricks);
    CHECK(bytes_of(folder / "mesh.obj") == mesh);
  }
  CHECK(run_stage("render", "scene.json --size 8x6 --pixel 1,1 --quiet -o bricks.png", folder).status == 0);
  CHECK(bytes_of(folder / "bricks.png") == bricks);
}

TEST_CASE("render writes explanations to files of any case of their endings, but not over its scene") {
  const TemporaryFolder folder;
  const std::string scene = bytes_of(scene_path("three_spheres"));
  put_bytes(folder / "scene.json", scene);
  fs::create_symlink("scene.json", folder / "link.json");
  for (const std::string name : {"scene.json", "./scene.json", "link.json"}) {
    CAPTURE(name);
    const Outcome outcome = run_stage("render", "scene.json --pixel 1,1 --explain " + name, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK_THAT(outcome.err,
               ContainsSubstring("--explain: '" + name + "' is not another file than those of the scene"));
    CHECK(bytes_of(folder / "scene.json") == scene);
  }
  CHECK(run_stage("render", "scene.json --pixel 1,1 --explain other.json --quiet", folder).status == 0);
  const Outcome upper =
      run_stage("render", "scene.json --pixel 1,1 --explain O.JSON --rays R.SVG --quiet", folder);
  CHECK(upper.err == "");
  CHECK(upper.status == 0);
  CHECK(bytes_of(folder / "O.JSON") == bytes_of(folder / "other.json"));
  CHECK(bytes_of(folder / "R.SVG").starts_with("<svg "));
}

TEST_CASE("wrong options of render are reported before the scene is read, except a crop that is too large") {
  const TemporaryFolder folder;
  put_bytes(folder / "wrong.json", "{");
  const auto outcome_of = [&](const std::string& path, const std::string& options) {
    CAPTURE(path, options);
    const Outcome outcome = run_stage("render", path + " " + options, folder);
    CHECK(outcome.out == "");
    CHECK(folder.count() == 1);
    return outcome;
  };
  for (const char* path : {"none.json", "wrong.json"}) {
    for (const char* options :
         {"--bad-option", "--tone clip", "stray", "--integrator paths", "--crop 1,1,1", "--crop 0,0,0,1",
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

TEST_CASE("an integrator for which a scene lacks something is refused by the option that asks for it") {
  struct Row {
    std::string integrator, why;
  };
  const std::string no_march =
      "no surface of the scene is marched with a proof, so that there is nothing to show; surfaces of "
      "distance fields are";
  const std::vector<Row> rows{{"evaluations", no_march},
                              {"enclosure-width", no_march},
                              {"distance-shadow",
                               "surface 1 of the scene, counted from 0 in the order of its types, tells no "
                               "distance; marched surfaces, boxes, spheres and planes do, and surfaces with "
                               "double distance_bound(const Point&) const"},
                              {"distance-occlusion", "the settings have no occlusion-distance"}};
  const TemporaryFolder folder;
  for (const Row& row : rows) {
    CAPTURE(row.integrator);
    const Outcome outcome =
        run_stage("render", scene_path("mesh") + " --size 8x6 --integrator " + row.integrator, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err == "render: --integrator: '" + row.integrator + "' is not possible with this scene: " +
                             row.why + "\nRun with --help for what is allowed.\n");
  }
  CHECK(folder.count() == 0);
}

TEST_CASE("the stages refuse render's option for the integrator of a scene file") {
  const TemporaryFolder folder;
  CHECK(run_stage("09_shadow", "--integrator color", folder).status == 2);
}

TEST_CASE("an invalid scene ends render with status 1 and one line of explanation") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& text, const std::string& error) {
    CAPTURE(error);
    put_bytes(folder / "scene.json", text);
    const Outcome outcome = run_stage("render", "scene.json", folder);
    CHECK(outcome.status == 1);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("render: scene.json: " + error));
    CHECK(outcome.err.find('\n') == outcome.err.size() - 1);
    CHECK(folder.count() == 1);
  };
  check(changed_three_spheres("\"radius\": 1}", "\"radius\": -1}"),
        "/objects/0/surface/radius: -1 is not a number greater than 0\n");
  check(changed_three_spheres("\"radius\": 1}", "\"radius\": 1e999}"),
        "/objects/0/surface/radius: 1e999 is not a number");
  check(changed_three_spheres("\"lights\"", "\"lamps\""), "/lamps: is not a key here");
  check(changed_three_spheres("]\n}", "]\n"), "parse error at line ");
  check("", "parse error at line 1, column 1");
  check("\xff\xfe\xfd", "parse error at line 1, column 1");
  std::string brackets(200'000, '[');
  check(brackets, "/0/0/0");
  check(brackets + std::string(200'000, ']'), "/0/0/0");
  std::string garbage(static_cast<std::size_t>(cases(8, 64)) << 20, 'x');
  check(garbage, "parse error at line 1, column 1");
  std::uint32_t random = 1;
  for (char& c : garbage) c = static_cast<char>((random = random * 1664525 + 1013904223) >> 24);
  check(garbage, "parse error at line 1, column ");
  std::fill(garbage.begin(), garbage.end(), ' ');
  check(garbage, "parse error at line 1, column ");
}

TEST_CASE("samples that are too many for the lights of a scene are told by the option that asks for them") {
  const TemporaryFolder folder;
  std::string lights = R"({"position": [0, 9, 0], "power": [1, 1, 1]})";
  for (int i = 0; i < 12; ++i) lights += "," + lights;  // 4096 of them
  put_bytes(folder / "scene.json", changed_three_spheres(R"("lights": [)", R"("lights": [)" + lights + ","));
  const std::string many =
      ": with 4097 lights a pixel may take 4196352 rays, and at most 4194304 are allowed\n"
      "Run with --help for what is allowed.\n";
  const auto says = [&](const std::string& options, const std::string& error) {
    const Outcome outcome = run_stage("render", "scene.json --size 8x8 " + options, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.err == "render: " + error);
  };
  says("--samples 1024", "--samples" + many);
  says("--error 0.1", "--max-samples" + many);
  says("--time 9 --max-samples 1024", "--max-samples" + many);
}

TEST_CASE("a scene that cannot be read ends render with status 1, the path and the reason") {
  struct Row {
    std::string path;
    int reason;
  };
  const Row row = GENERATE(Row{"none.json", ENOENT}, Row{".", EISDIR}, Row{"file/a.json", ENOTDIR});
  const TemporaryFolder folder;
  put_bytes(folder / "file", "");
  const Outcome outcome = run_stage("render", row.path, folder);
  CHECK(outcome.status == 1);
  CHECK(outcome.out == "");
  CHECK(outcome.err ==
        "render: cannot read '" + row.path + "': " + std::generic_category().message(row.reason) + "\n");
  CHECK(folder.count() == 1);
}

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
    put_bytes(folder / "scene.json", scene_with_image(name));
    const Outcome outcome = run_stage("render", "scene.json", folder);
    CHECK(outcome.status == 1);
    CHECK(outcome.err == "render: scene.json: /materials/m/diffuse/image: \"" + name +
                             "\" is not possible: cannot read '" + name + "': " + row.error + "\n");
    CHECK(folder.count() == 2);
  }
}

TEST_CASE("names from a scene are printed with their control characters escaped") {
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json", scene_with_image("a\\u001b[31m\\u0007red\\nline.png"));
  CHECK(run_stage("render", "scene.json", folder).err ==
        "render: scene.json: /materials/m/diffuse/image: \"a\\u001b[31m\\u0007red\\nline.png\" is not "
        "possible: "
        "cannot read 'a\\x1b[31m\\x07red\\x0aline.png': No such file or directory\n");
  CHECK(run(stage("render", {"a\x1b[31m\n.json"}, folder / "")).err ==
        "render: cannot read 'a\\x1b[31m\\x0a.json': No such file or directory\n");
  CHECK(run(stage("render", {"scene.json", "-o", "no\x1b/out.ppm"}, folder / "")).err.find('\x1b') ==
        std::string::npos);
  put_bytes(folder / "scene.json", scene_with_image("a.png"));
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
  put_bytes(folder / "scene/inside.json", scene_with_image("a.png"));
  put_bytes(folder / "scene/outside.json", scene_with_image("../a.png"));
  CHECK(run_stage("render", "scene/inside.json", folder).status == 0);
  CHECK(run_stage("render", "scene/outside.json", folder).status == 0);
  CHECK(run_stage("render", "--confine scene/inside.json", folder).status == 0);
  const std::string real = fs::canonical(folder / "").string();
  const Outcome refused = run_stage("render", "scene/outside.json --confine", folder);
  CHECK(refused.status == 1);
  CHECK(refused.err ==
        "render: scene/outside.json: /materials/m/diffuse/image: \"../a.png\" is not inside of the "
        "scene's folder: it is '" +
            real + "/a.png', and the folder '" + real + "/scene'\n");
  CHECK_THAT(run_stage("render", "--help", folder).out, ContainsSubstring("--confine"));
  CHECK(run_stage("09_shadow", "--confine", folder).status == 2);
}
