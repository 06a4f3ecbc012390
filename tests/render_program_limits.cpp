// Limits of `render`, whatever a scene asks for: the time and the memory that it takes, and the threads that
// it starts.
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include "stages/support/options.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_render.hpp"
#include "support/run_stage.hpp"
#include "support/sanitizers.hpp"

namespace {

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
  return changed_three_spheres(R"("objects": [)", R"("objects": [{"surface": {"type": "mesh", "file": ")" +
                                                      file + R"("}, "color": [1, 1, 1]},)");
}

}  // namespace

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
      Row{"a tile, alone", scene_path("whitted"), "--size 64x48 --samples 65536 --threads 1", 128 + SIGINT},
      Row{"a tile, of several threads", scene_path("whitted"), "--size 64x48 --samples 65536 --threads 3",
          128 + SIGINT},
      Row{"many tiles", scene_path("three_spheres"), "--size 4000x4000 --samples 64 --threads 1",
          128 + SIGINT},
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
  CHECK(run_stage("render", "a.json --size 64x48 --quiet", folder).status == 0);
  const bool is_alike = bytes_of(folder / "alone.ppm") == bytes_of(folder / "out.ppm");
  CHECK(is_alike);
}

TEST_CASE("an endless scene file is refused") {
  const TemporaryFolder folder;
  const Outcome zeros = run_stage("render", "/dev/zero", folder);
  CHECK(zeros.status == 1);
  CHECK(zeros.err == "render: /dev/zero: parse error at line 1, column 1: a zero byte, which no text has\n");

  const std::string program = stage("render", {}, folder / "").program.string();
  const Outcome outcome = run({.program = "/bin/sh",
                               .arguments = {"-c", "yes '' | '" + program + "' /dev/stdin"},
                               .folder = folder / ""});
  CHECK(outcome.status == 1);
  CHECK(outcome.err == "render: /dev/stdin: the file is longer than the 268435456 bytes that are allowed\n");
}

TEST_CASE(
    "render gives up a picture that takes longer than --timeout, by default ten seconds for each pixel") {
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json", changed_three_spheres("", ""));
  const auto start = std::chrono::steady_clock::now();
  const Outcome late =
      run_stage("render", "scene.json --size 4000x4000 --samples 1000 --timeout 0.2", folder);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  CHECK(late.status == 1);
  CHECK(late.out == "");
  CHECK(late.err ==
        "render: the picture is not done after 0.2 seconds; --timeout sets how many it may take\n");
  CHECK(time.count() < 2);
  CHECK(folder.count() == 1);

  CHECK(run_stage("render", "scene.json --size 8x6 --timeout 0", folder).status == 0);
  CHECK(run_stage("render", "scene.json --size 8x6 --timeout 1e9", folder).status == 0);
  for (const char* seconds : {"-1", "nan", "1e10", "1s"}) {
    CAPTURE(seconds);
    const Outcome refused = run_stage("render", "scene.json --timeout " + std::string(seconds), folder);
    CHECK(refused.status == 2);
    CHECK_THAT(refused.err, ContainsSubstring("--timeout: '" + std::string(seconds) +
                                              "' is not a number of seconds from 0 to 1e9"));
  }
  CHECK(run_stage("09_shadow", "--timeout 1", folder).status == 2);
}

TEST_CASE("the default timeout of render is ten seconds for each pixel, and those of --time") {
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
  CHECK(timeout("--size 1x1 --time 12") == 22);
  CHECK(timeout("--time 1e300") == 1e9 + 6000);  // the system's timer cannot be set to more than 2^63
  CHECK(timeout("--time 12 --timeout 7") == 7);
}

TEST_CASE("render does not wait for a pipe that a scene names") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe.png").c_str(), 0600) == 0);
  put_bytes(folder / "scene.json", scene_with_image("pipe.png"));
  const Outcome outcome = run_stage("render", "scene.json", folder);
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

TEST_CASE("small files that promise large images or repeat their files take little memory", "[long]") {
  const TemporaryFolder folder;
  const rlim_t limit = 200'000'000;
  const auto check_refused = [&](const std::string& scene, const std::string& error) {
    put_bytes(folder / "scene.json", scene);
    const Outcome outcome = run_within(limit, "scene.json", folder);
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.err, ContainsSubstring(error));
  };
  copy_image("images/bomb12000.png", folder);
  check_refused(scene_with_image("bomb12000.png"), "the picture has 12000x12000 pixels");
  put_bytes(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 10000\n");
  check_refused(scene_with_image("a.hdr"), "the picture has 10000x10000 pixels");
  put_bytes(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 8000\n");
  check_refused(scene_with_image("a.hdr"), "there are 0 bytes of pixels; a picture of this size takes ");

  // A hundred materials name one image of 6 MB in memory, and a hundred objects one mesh of 100,000
  // triangles.
  put_bytes(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65536 +X 7\n" +
                                  std::string(std::size_t{4} * 7 * 65536, '\x80'));
  // Behind the camera: it is read, and no ray has to find the first of equal triangles.
  std::string mesh = "v 0 0 -9\nv 2 0 -9\nv 0 2 -9\n";
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

TEST_CASE("the values of a scene file are counted before they take memory", "[long]") {
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

TEST_CASE("running out of memory while a scene is read ends render with status 1 and one line", "[long]") {
  const TemporaryFolder folder;
  // Behind the camera: it is read, and no ray has to find the first of equal surfaces.
  const std::string sphere = R"({"surface": {"type": "csg", "operation": "union", "surfaces": [
      {"type": "sphere", "position": [0, 0, -3], "radius": 0.1}]}, "color": [1, 1, 1]},)";
  std::string spheres;
  for (int i = 0; i < 8'000; ++i) spheres += sphere;
  put_bytes(folder / "spheres.json", changed_three_spheres("\"objects\": [", "\"objects\": [" + spheres));
  std::string mesh = "v 0 0 -1\nv 2 0 -1\nv 0 2 -1\n";
  for (int i = 0; i < 60'000; ++i) mesh += "f 1 2 3\n";
  put_bytes(folder / "a.obj", mesh);
  put_bytes(folder / "mesh.json",
            changed_three_spheres(
                "\"objects\": [",
                R"("objects": [{"surface": {"type": "mesh", "file": "a.obj"}, "color": [1, 1, 1]},)"));
  put_bytes(folder / "a.hdr",
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 500000 +X 7\n" + std::string(14'000'000, '\x80'));
  put_bytes(folder / "image.json", scene_with_image("a.hdr"));
  for (const char* scene : {"spheres.json", "mesh.json", "image.json"}) {
    int refused = 0;
    // Limits grow by a half or a sixth, from less than an idle program takes.
    for (rlim_t limit = 10'000'000; limit < 200'000'000; limit += limit / cases(2, 6)) {
      CAPTURE(scene, limit);
      const Outcome outcome = run_within(limit, scene, folder);
      if (outcome.status == 127) continue;  // the program could not be loaded
      check_one_line(outcome);
      refused += outcome.err == "render: " + std::string(scene) + ": not enough memory for this scene\n";
    }
    CHECK(refused > cases(0, 2));
    CHECK(run_within(RLIM_INFINITY, scene, folder).status == 0);
  }
}

#endif
