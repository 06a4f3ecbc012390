// Shards and checkpoints of scene files.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <protostar/sampling/shard_file.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_render.hpp"
#include "support/run_stage.hpp"

namespace fs = std::filesystem;

namespace {

const std::string three_parts = "part0.shard part1.shard part2.shard";

/// Draws a scene in three shards, and merges them into a file.
std::string merged_picture(const std::string& arguments, const std::string& file,
                           const TemporaryFolder& folder) {
  for (const char* number : {"2", "0", "1"}) {
    const Outcome outcome = run_stage(
        "render",
        arguments + " --quiet --threads 1 --shard " + number + "/3 -o part" + std::string(number) + ".shard",
        folder);
    CHECK(outcome.status == 0);
    CHECK(outcome.out + outcome.err == "");
  }
  const Outcome outcome = run_stage("merge", file + " --quiet " + three_parts, folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out + outcome.err == "");
  return bytes_of(folder / file);
}

/// Returns arguments for a small picture, which shards and checkpoints have in common.
std::string small_picture() {
  return scene_path("three_spheres") + " --size 32x16 --samples 8 --sampler sobol --quiet ";
}

/// Returns true if a file is a shard of all units of its picture.
bool has_all_units(const fs::path& path) { return !protostar::load_shard(path).missing(); }

}  // namespace

TEST_CASE("shards of a scene file are merged with its exposure, tone and transfer") {
  const std::string name = GENERATE("exposure", "scale_pixel", "scale_image");
  CAPTURE(name);
  const TemporaryFolder folder;
  const std::string text = changed_three_spheres(
      R"("transfer": {"gamma": 2.2})", name == "exposure" ? R"("transfer": {"gamma": 2.2}, "exposure": 3.5)"
                                       : name == "scale_pixel"
                                           ? R"("transfer": "linear", "exposure": 2, "tone": "scale-pixel")"
                                           : R"("transfer": {"gamma": 1.8}, "tone": "scale-image")");
  put_bytes(folder / "scene.json", text);
  const std::string arguments = "scene.json --size 32x24 --samples 6 --sampler sobol";
  for (const char* file : {"a.png", "a.pfm"}) {
    const std::string merged = merged_picture(arguments, file, folder);
    const Outcome whole = run_stage("render", arguments + " --quiet -o whole" + (file + 1), folder);
    CHECK(whole.status == 0);
    CHECK(merged == bytes_of(folder / (std::string("whole") + (file + 1))));
  }
}

TEST_CASE("shards of a part of a picture are merged into that part") {
  const TemporaryFolder folder;
  const std::string arguments =
      scene_path("three_spheres") + " --size 64x48 --samples 4 --sampler sobol --crop 11,7,30,23";
  const std::string merged = merged_picture(arguments, "a.png", folder);
  CHECK(run_stage("render", arguments + " -o whole.png", folder).status == 0);
  CHECK(merged == bytes_of(folder / "whole.png"));
  CHECK(run_stage("render", arguments + " -o again.png --checkpoint state", folder).status == 0);
  CHECK(merged == bytes_of(folder / "again.png"));

  put_bytes(folder / "scene.json",
            changed_three_spheres("\"integrator\": \"shadow\"",
                                  "\"integrator\": \"shadow\", \"tone\": \"scale-image\""));
  const std::string crop = "scene.json --size 64x48 --samples 4 --sampler sobol --crop 11,7,30,23";
  const Outcome outcome = run_stage("render", crop + " --shard 0/2 -o a.shard", folder);
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err,
             ContainsSubstring("--crop: '11,7,30,23' is not possible with --shard for the tone "));
  CHECK_THAT(run_stage("01_gradient", "--samples 2 --crop 0,0,3,3 --shard 0/2 -o a.shard", folder).err,
             ContainsSubstring("--shard: is for pictures that are drawn by rays"));
  CHECK(run_stage("render", crop + " -o whole.png", folder).status == 0);
  CHECK(run_stage("render", crop + " -o again.png --checkpoint state", folder).status == 0);
  CHECK(bytes_of(folder / "again.png") == bytes_of(folder / "whole.png"));
}

TEST_CASE("merge refuses shards of a scene file that was changed, or with a file of it that was") {
  const TemporaryFolder folder;
  copy_image("../scenes/bricks.png", folder);
  const std::string scene = scene_with_image("bricks.png");
  const auto draw = [&](const std::string& number, const std::string& options = "") {
    const Outcome outcome = run_stage(
        "render",
        "scene.json --samples 4 --quiet --shard " + number + "/2 -o " + number + ".shard " + options, folder);
    CHECK(outcome.err == "");
    CHECK(outcome.status == 0);
  };
  const auto merge = [&] { return run_stage("merge", "out.png 0.shard 1.shard", folder); };
  put_bytes(folder / "scene.json", scene);
  draw("0");
  draw("1");
  CHECK(merge().status == 0);

  const auto check_refused = [&](const std::string& difference) {
    const Outcome outcome = merge();
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.err, ContainsSubstring("'1.shard' is not of the picture of '0.shard': " + difference));
  };
  put_bytes(folder / "scene.json", scene + " ");
  draw("1");
  check_refused("scene 'files ");
  put_bytes(folder / "scene.json", scene);
  draw("1");
  CHECK(merge().status == 0);
  const std::string image = bytes_of(folder / "bricks.png");
  put_bytes(folder / "bricks.png", image + "x");  // the same pixels
  draw("1");
  check_refused("scene 'files ");
  put_bytes(folder / "bricks.png", image);
  draw("1", "--integrator normal");
  check_refused("scene 'files ");
  draw("1", "--clamp 0.5");
  check_refused("scene 'files ");

  put_bytes(folder / "spheres.json", bytes_of(scene_path("three_spheres")));
  const Outcome piped =
      run({.program = "/bin/sh",
           .arguments = {"-c", "cat spheres.json | '" PROTOSTAR_BINARY_DIR
                               "/stages/render' /dev/stdin --samples 4 --shard 0/2 -o a.shard"},
           .folder = folder / ""});
  CHECK(piped.status == 1);
  CHECK_THAT(piped.err, ContainsSubstring("'/dev/stdin' is no regular file: it cannot be read twice"));
}

TEST_CASE("a scene that asks for an error has no known samples to be shared") {
  const TemporaryFolder folder;
  put_bytes(folder / "scene.json", changed_three_spheres("\"integrator\": \"shadow\"",
                                                         "\"integrator\": \"shadow\", \"error\": 0.1"));
  const std::string arguments = "scene.json --size 32x24 --shard 0/2 -o a.shard";
  const Outcome outcome = run_stage("render", arguments, folder);
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err,
             ContainsSubstring("--shard: needs a known number of samples, and the scene asks for"));
  CHECK(run_stage("render", arguments + " --samples 4", folder).status == 0);
}

TEST_CASE("merge writes no picture over one of its parts") {
  const TemporaryFolder folder;
  CHECK(run_stage("render", small_picture() + "--shard 0/2 -o 0.shard", folder).status == 0);
  CHECK(run_stage("render", small_picture() + "--shard 1/2 -o 1.shard", folder).status == 0);
  const std::string bytes = bytes_of(folder / "1.shard");
  put_bytes(folder / "1.ppm", bytes);
  fs::create_symlink("1.shard", folder / "link.png");
  for (const auto& [out, part] :
       {std::pair{"1.ppm", "1.ppm"}, {"./1.ppm", "1.ppm"}, {"link.png", "1.shard"}}) {
    CAPTURE(out);
    const Outcome outcome = run_stage("merge", std::string(out) + " 0.shard " + part, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err == "merge: OUT: '" + std::string(out) +
                             "' is not another file than those of the parts\nRun with --help for what is "
                             "allowed.\n");
    CHECK((bytes_of(folder / part) == bytes));
  }
  CHECK(run_stage("merge", "out.png 0.shard 1.ppm --quiet", folder).status == 0);
}

TEST_CASE("of a checkpoint that is a symbolic link, the file is removed at the end, and the link stays") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "elsewhere");
  fs::create_symlink("elsewhere/state", folder / "link");
  CHECK(run_stage("render", small_picture() + "--shard 0/2 -o half.shard", folder).status == 0);
  fs::rename(folder / "half.shard", folder / "elsewhere/state");
  for (const std::string time : {"first", "second"}) {  // the second time it leads to no file
    CAPTURE(time);
    const Outcome outcome = run_stage("render", small_picture() + "--checkpoint link -o out.ppm", folder);
    CHECK(outcome.err == "");
    CHECK(outcome.status == 0);
    CHECK(fs::is_symlink(folder / "link"));
    CHECK(fs::is_empty(folder / "elsewhere"));
  }
}

TEST_CASE("the state of the work is saved if the picture cannot be written") {
  const TemporaryFolder folder;
  const auto failed = [&](const std::string& options, const std::string& file) {
    const Outcome outcome =
        run_stage("render", small_picture() + "--checkpoint state " + options + " -o " + file, folder);
    CHECK(outcome.status == 1);
    CHECK(outcome.err == cannot_write("render", file, ENOSPC));
  };
  failed("", "/dev/full");
  CHECK(has_all_units(folder / "state"));
  CHECK(run_stage("render", small_picture() + "-o a.ppm --checkpoint state", folder).status == 0);
  CHECK(run_stage("render", small_picture() + "-o b.ppm", folder).status == 0);
  CHECK((bytes_of(folder / "a.ppm") == bytes_of(folder / "b.ppm")));

  fs::remove(folder / "state");
  fs::create_symlink("/dev/full", folder / "full.shard");
  failed("--shard 1/2", "full.shard");
  CHECK(run_stage("render", small_picture() + "--shard 1/2 -o a.shard", folder).status == 0);
  CHECK((bytes_of(folder / "state") == bytes_of(folder / "a.shard")));
}

TEST_CASE("the state of the work is saved if a signal comes while the picture is written") {
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const std::string options = " --size 320x240 --samples 2 --checkpoint state -o pipe";
  Process process(stage("render", words(scene_path("three_spheres") + options), folder / ""));
  const int reader = open(pipe.c_str(), O_RDONLY);
  std::array<char, 1 << 16> bytes{};
  CHECK(read(reader, bytes.data(), 1) == 1);  // the rest is more than a pipe holds
  process.send(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  while (read(reader, bytes.data(), bytes.size()) > 0) continue;
  CHECK(process.wait().status == 128 + SIGINT);
  close(reader);
  CHECK(fs::exists(folder / "state"));
  CHECK(has_all_units(folder / "state"));
}

TEST_CASE("the state of the work is saved if nobody reads on from the pipe of the picture") {
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const std::string options = " --size 320x240 --samples 2 --quiet -o pipe";
  const auto outcome_of = [&](const std::string& more) {
    Process process(stage("render", words(scene_path("three_spheres") + options + more), folder / ""));
    const int reader = open(pipe.c_str(), O_RDONLY);
    char byte = 0;
    CHECK(read(reader, &byte, 1) == 1);  // the rest is more than a pipe holds
    close(reader);
    return process.wait();
  };
  CHECK(outcome_of("").status == -SIGPIPE);
  const Outcome kept = outcome_of(" --checkpoint state");
  CHECK(kept.status == 1);
  CHECK(kept.err == cannot_write("render", "pipe", EPIPE));
  CHECK(fs::exists(folder / "state"));
  CHECK(has_all_units(folder / "state"));
}

TEST_CASE("a checkpoint that is no file to be replaced is refused at once") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  fs::create_directory(folder / "folder");
  put_bytes(folder / "file", "old");
  const auto to_file = [&] { dup2(open("file", O_RDWR), STDOUT_FILENO); };
  for (const std::string name : {"pipe", "folder", "/dev/null", "/dev/stdout"}) {
    CAPTURE(name);
    const Outcome outcome =
        run_stage("render", small_picture() + "-o out.ppm --checkpoint " + name, folder, to_file);
    CHECK(outcome.status == 1);
    CHECK(outcome.out == "");
    CHECK(outcome.err ==
          "render: --checkpoint: '" + name + "' is no regular file: it cannot be read again and replaced\n");
  }
  CHECK(folder.count() == 3);
  CHECK(bytes_of(folder / "file") == "old");
}
