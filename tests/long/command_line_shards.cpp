// Shards, merge and checkpoints as a user runs them.
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <protostar/sampling/shard_file.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_stage.hpp"

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

/// Options of the small pictures below.
const std::string of_parts = "--size 32x24 --samples 8 ";

/// Draws a shard of a stage, such as 2/7, into a file.
void draw_shard(const std::string& stage, const std::string& number, const std::string& file,
                const TemporaryFolder& folder, const std::string& options = of_parts) {
  const Outcome outcome = run_stage(stage, options + " --quiet --shard " + number + " -o " + file, folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out + outcome.err == "");
}

Outcome merged(const std::string& arguments, const TemporaryFolder& folder) {
  return run_stage("merge", arguments, folder);
}

std::string whole_picture(const std::string& stage, const std::string& file,
                          const std::string& options = "") {
  return stage_picture(stage, of_parts + "--sampler sobol " + options, file);
}

/// Returns true if a shell finds a program.
bool is_installed(const std::string& program, const TemporaryFolder& folder) {
  return run({.program = "/bin/sh", .arguments = {"-c", "command -v " + program}, .folder = folder / ""})
             .status == 0;
}

std::string stage_path(const std::string& name) {
  return (fs::path(PROTOSTAR_BINARY_DIR) / "stages" / name).string();
}

}  // namespace

TEST_CASE("shards of a stage, merged in any order, are the picture, in any format") {
  const std::string stage = GENERATE("02_sphere", "08_naive", "13_whitted", "16_environment");
  CAPTURE(stage);
  const TemporaryFolder folder;
  for (const char* number : {"0", "1", "2"})
    draw_shard(stage, std::string(number) + "/3", std::string("part") + number + ".shard", folder);
  for (const char* file : {"a.ppm", "a.png", "a.pfm", "a.HDR"}) {
    CAPTURE(file);
    const Outcome outcome = merged(std::string(file) + " part2.shard part0.shard part1.shard", folder);
    CHECK(outcome.status == 0);
    CHECK(outcome.err == "");
    CHECK(outcome.out.starts_with(std::string(file) + ": 32x24, of 3 files, merged in "));
    CHECK(bytes_of(folder / file) == whole_picture(stage, file));
  }
  const std::string other = " --transfer srgb --bits 16 --plain --quiet";
  CHECK(merged("b.ppm part1.shard part2.shard part0.shard" + other, folder).out == "");
  CHECK(bytes_of(folder / "b.ppm") == whole_picture(stage, "b.ppm", other));
}

TEST_CASE("the line about a shard says how much of the picture it has") {
  const TemporaryFolder folder;
  const auto line = [&](const std::string& number) {
    return without_times(run_stage("13_whitted", of_parts + "-o a.shard --shard " + number, folder).out);
  };
  CHECK(line("1/7") == "a.shard: 2 of 12 units of 32x24, whitted, rendered in 0.0 ms, written in 0.0 ms\n");
  CHECK(line("12/13").starts_with("a.shard: 0 of 12 units of 32x24"));
  CHECK(folder.count() == 1);
}

TEST_CASE("wrong shards and checkpoints are usage errors, and nothing is drawn") {
  struct Row {
    std::string arguments, text;
  };
  const std::string numbers = "' is not I/N, whole numbers with I from 0 to N - 1, nor slurm or mpi";
  std::vector<Row> rows;
  for (const char* number : {"7/7", "8/7", "-1/7", "0/0", "1", "1/", "/7", "1/7/7", "x/7", "1/x", "1.0/7",
                             "SLURM", "0/18446744073709551616", "", "+1/7"})
    if (*number != '\0')
      rows.push_back({std::string("--samples 4 -o a.shard --shard ") + number,
                      std::string("--shard: '") + number + numbers});
  const std::string part = "-o a.shard --shard 0/2 ";
  for (const Row& row : std::vector<Row>{
           {"--samples 4 --shard 0/2", "--shard: 'out.ppm' is not a .shard file, which -o has to name"},
           {"--samples 4 --shard 0/2 -o a.png", "--shard: 'a.png' is not a .shard file"},
           {"--samples 4 -o a.shard", "-o: 'a.shard' is not the file of a picture, but of a part of one"},
           {part, "--shard: shares sums of samples, and the picture has one ray through each pixel's center"},
           {part + "--samples 1",
            "and the picture has one sample a pixel; --samples N with a number N of at"},
           {part + "--samples 4 --pixel 1,1", "--shard excludes --pixel, which draws nothing"},
           {part + "--samples 4 --sampler hammersley",
            "--sampler: 'hammersley' is not possible with --shard"},
           {part + "--samples 4 --bits 16", "--bits: is for a picture, and a .shard file is none yet"},
           {part + "--samples 4 --transfer srgb", "--transfer: is for a picture"},
           {part + "--samples 4 --plain", "--plain: is for a picture"},
           {"--samples 4 --pixel 1,1 --checkpoint c", "--checkpoint excludes --pixel, which draws nothing"},
           {"--samples 4 --checkpoint out.ppm",
            "--checkpoint: 'out.ppm' is not another file than that of -o"},
           {"--samples 4 --checkpoint ./out.ppm",
            "--checkpoint: './out.ppm' is not another file than that of -o"},
           {part + "--samples 4 --checkpoint .//a.shard",
            "--checkpoint: './/a.shard' is not another file than that of -o"},
           {"--checkpoint c", "--checkpoint: shares sums of samples, and the picture has one ray"},
           {"--checkpoint c --samples 1", "--checkpoint: shares sums of samples"}})
    rows.push_back(row);
  const TemporaryFolder folder;
  for (const Row& row : rows) {
    CAPTURE(row.arguments);
    const Outcome outcome = run_stage("13_whitted", row.arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK_THAT(outcome.err, ContainsSubstring(row.text));
    CHECK(folder.count() == 0);
  }
}

TEST_CASE("a checkpoint is not the picture's file under the name of a link, even if there is no file yet") {
  const TemporaryFolder folder;
  fs::create_symlink("other", folder / "link");
  fs::create_symlink("out.ppm", folder / "other");
  const Outcome outcome = run_stage("13_whitted", "--size 8x8 --samples 4 --checkpoint link", folder);
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err, ContainsSubstring("--checkpoint: 'link' is not another file than that of -o"));
  CHECK(folder.count() == 2);
}

TEST_CASE("slurm and mpi read the number of the shard from the environment, if it is there and right") {
  struct Row {
    std::string word;
    std::vector<std::string> variables;  // NAME=VALUE
    std::string shard;                   // which these are
    std::string text;                    // of the message, if they are none
  };
  const std::vector<Row> rows{
      {"slurm", {"SLURM_ARRAY_TASK_ID=1", "SLURM_ARRAY_TASK_MIN=0", "SLURM_ARRAY_TASK_COUNT=3"}, "1/3", ""},
      {"slurm", {"SLURM_ARRAY_TASK_ID=12", "SLURM_ARRAY_TASK_MIN=10", "SLURM_ARRAY_TASK_COUNT=3"}, "2/3", ""},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=6", "SLURM_ARRAY_TASK_MIN=5", "SLURM_ARRAY_TASK_MAX=7",
        "SLURM_ARRAY_TASK_COUNT=3"},
       "1/3",
       ""},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=7", "SLURM_ARRAY_TASK_MIN=5", "SLURM_ARRAY_TASK_MAX=9",
        "SLURM_ARRAY_TASK_COUNT=3"},
       "",
       "SLURM_ARRAY_TASK_COUNT is 3 for the tasks from SLURM_ARRAY_TASK_MIN = 5 to SLURM_ARRAY_TASK_MAX = 9; "
       "allowed is an array without gaps and steps"},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=7", "SLURM_ARRAY_TASK_MIN=5", "SLURM_ARRAY_TASK_MAX=last",
        "SLURM_ARRAY_TASK_COUNT=3"},
       "",
       "SLURM_ARRAY_TASK_MAX is 'last'; allowed is a whole number of"},
      {"mpi", {"OMPI_COMM_WORLD_RANK=0", "OMPI_COMM_WORLD_SIZE=3"}, "0/3", ""},
      {"slurm", {}, "", "'slurm' asks for SLURM_ARRAY_TASK_ID, which is not set; allowed is a whole number"},
      {"slurm", {"SLURM_ARRAY_TASK_ID=1"}, "", "asks for SLURM_ARRAY_TASK_MIN, which is not set"},
      {"slurm", {"SLURM_ARRAY_TASK_ID=1", "SLURM_ARRAY_TASK_MIN=0"}, "", "SLURM_ARRAY_TASK_COUNT, which is"},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=one"},
       "",
       "SLURM_ARRAY_TASK_ID is 'one'; allowed is a whole number of"},
      {"slurm", {"SLURM_ARRAY_TASK_ID="}, "", "SLURM_ARRAY_TASK_ID is ''"},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=4", "SLURM_ARRAY_TASK_MIN=1", "SLURM_ARRAY_TASK_COUNT=3"},
       "",
       "SLURM_ARRAY_TASK_ID is 4; allowed is one of the SLURM_ARRAY_TASK_COUNT = 3 numbers from "
       "SLURM_ARRAY_TASK_MIN = 1 on"},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=0", "SLURM_ARRAY_TASK_MIN=1", "SLURM_ARRAY_TASK_COUNT=3"},
       "",
       "SLURM_ARRAY_TASK_ID is 0"},
      {"slurm",
       {"SLURM_ARRAY_TASK_ID=1", "SLURM_ARRAY_TASK_MIN=1", "SLURM_ARRAY_TASK_COUNT=0"},
       "",
       "SLURM_ARRAY_TASK_COUNT is '0'; allowed is a whole number of at least 1"},
      {"mpi", {}, "", "'mpi' asks for OMPI_COMM_WORLD_RANK, which is not set"},
      {"mpi",
       {"OMPI_COMM_WORLD_RANK=-1"},
       "",
       "OMPI_COMM_WORLD_RANK is '-1'; allowed is a whole number of at"},
      {"mpi",
       {"OMPI_COMM_WORLD_RANK=3", "OMPI_COMM_WORLD_SIZE=3"},
       "",
       "OMPI_COMM_WORLD_RANK is 3; allowed is a number below OMPI_COMM_WORLD_SIZE = 3"}};
  for (const Row& row : rows) {
    CAPTURE(row.word, row.variables);
    const TemporaryFolder folder;
    std::vector<std::string> variables = row.variables;
    const Outcome outcome =
        run_stage("13_whitted", of_parts + "--quiet -o a.shard --shard " + row.word, folder, [&variables] {
          for (std::string& variable : variables) putenv(variable.data());
        });
    CHECK(outcome.out == "");
    if (row.shard.empty()) {
      CHECK(outcome.status == 2);
      CHECK_THAT(outcome.err, ContainsSubstring("13_whitted: --shard: "));
      CHECK_THAT(outcome.err, ContainsSubstring(row.text));
      CHECK(folder.count() == 0);
    } else {
      CHECK(outcome.status == 0);
      CHECK(outcome.err == "");
      draw_shard("13_whitted", row.shard, "b.shard", folder);
      CHECK(bytes_of(folder / "a.shard") == bytes_of(folder / "b.shard"));
    }
  }
}

TEST_CASE("merge refuses shards of other pictures, missing and doubled parts, and damaged files") {
  const TemporaryFolder folder;
  const std::string stage = "13_whitted";
  draw_shard(stage, "0/2", "a.shard", folder);
  draw_shard(stage, "1/2", "b.shard", folder);
  const auto draw_other = [&](const std::string& name, const std::string& options,
                              const std::string& of_stage = "13_whitted") {
    draw_shard(of_stage, "1/2", name + ".shard", folder, options);
  };
  draw_other("size", "--size 33x24 --samples 8");
  draw_other("samples", "--size 32x24 --samples 9");
  draw_other("seed", of_parts + "--seed 5");
  draw_other("sampler", of_parts + "--sampler halton");
  draw_other("filter", of_parts + "--filter tent");
  draw_other("scene", of_parts, "16_environment");
  protostar::Shard other = protostar::load_shard(folder / "b.shard");
  protostar::SharedPicture picture = other.picture();
  picture.version = "0.0.9";
  protostar::save_shard({picture, other.units(), other.bands()}, folder / "version.shard");
  std::string bytes = bytes_of(folder / "b.shard");
  put_bytes(folder / "short.shard", bytes.substr(0, 1000));
  bytes[2000] = static_cast<char>(bytes[2000] ^ 4);
  put_bytes(folder / "damaged.shard", bytes);

  struct Row {
    std::string arguments, text;
  };
  const std::string not_of_a = ".shard' is not of the picture of 'a.shard': ";
  for (const Row& row : std::vector<Row>{
           {"a.shard size.shard", "'size" + not_of_a + "size 33x24, not 32x24"},
           {"a.shard samples.shard", "'samples" + not_of_a + "samples 9, not 8"},
           {"a.shard seed.shard", "'seed" + not_of_a + "seed 5, not 0"},
           {"a.shard sampler.shard", "'sampler" + not_of_a + "sampler 'halton', not 'sobol'"},
           {"a.shard filter.shard", "'filter" + not_of_a + "filter 'tent', not 'box'"},
           {"a.shard scene.shard", "'scene" + not_of_a + "scene '16_environment, whitted, light "},
           {"a.shard version.shard", "'version" + not_of_a + "version '0.0.9', not '"},
           {"a.shard", "unit 6 (rows "},
           {"b.shard",
            "unit 0 (rows 0 to 3, samples 0 to 3) is missing; 6 of 12 units are there; missing: --shard 0/2"},
           {"a.shard b.shard a.shard",
            "'a.shard' has unit 0 (rows 0 to 3, samples 0 to 3), and 'a.shard' has"},
           {"a.shard short.shard", "'short.shard': the file ends after 1000 bytes, too early"},
           {"a.shard damaged.shard", "'damaged.shard': byte "},
           {"a.shard none.shard", "cannot read 'none.shard': No such file or directory"}}) {
    CAPTURE(row.arguments);
    put_bytes(folder / "out.png", "old");
    const Outcome outcome = merged("out.png " + row.arguments, folder);
    CHECK(outcome.status == 1);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("merge: "));
    CHECK_THAT(outcome.err, ContainsSubstring(row.text));
    CHECK(bytes_of(folder / "out.png") == "old");
  }
  for (const Row& row : std::vector<Row>{
           {"", "merge: OUT is required"},
           {"out.png", "merge: SHARD is required"},
           {"a.shard b.shard", "merge: OUT: 'a.shard' is not a file that ends in .ppm, .png, .pfm or .hdr"},
           {"out.png a.shard b.shard --bits 16",
            "--bits: '16' is not possible in .png; .ppm can have 16 bits"},
           {"out.png a.shard --size 3x3", "--size"}}) {
    CAPTURE(row.arguments);
    const Outcome outcome = merged(row.arguments, folder);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(row.text));
    CHECK(bytes_of(folder / "out.png") == "old");
  }
}

namespace {

/// Starts a stage and stops it by a signal, which has to end it; returns the units of work in its checkpoint,
/// the file "state". A busy machine may draw none of them in 300 ms: with no more than before, the
/// stage goes on for twice the time.
std::uint64_t units_until(int signal, const std::string& name, const std::string& options,
                          const TemporaryFolder& folder, std::uint64_t before) {
  std::uint64_t units = before;
  for (auto time = 300ms; units == before && time < 60s; time *= 2) {
    Process process(stage(name, words(options), folder / ""));
    process.wait_for_thread();
    std::this_thread::sleep_for(time);
    process.send(signal);
    const Outcome stopped = process.wait();
    CHECK(stopped.status == 128 + signal);
    CHECK(stopped.out + stopped.err == "");
    CHECK(folder.count() == 1);
    units = protostar::load_shard(folder / "state").units().count();
  }
  return units;
}

}  // namespace

TEST_CASE("a long render goes on from its checkpoint, also in parts, and removes it at the end") {
  const std::string part = GENERATE("", " --shard 1/2 -o a.shard");
  CAPTURE(part);
  const std::string file = part.empty() ? "out.ppm" : "a.shard";
  const TemporaryFolder folder, other;
  // A picture that takes seconds, on any machine, and with few samples a moment.
  const std::string options = "--size 320x240 --threads 1 --sampler halton" + part;
  const std::string many = options + " --samples 4000 --checkpoint state";
  CHECK(units_until(SIGTERM, "15_csg", many, folder, 0) > 0);
  const std::string state = bytes_of(folder / "state");

  const Outcome refused = run_stage("15_csg", many + " --seed 1", folder);
  CHECK(refused.status == 1);
  CHECK(refused.err ==
        "15_csg: --checkpoint: 'state' is of other work: it has seed 0, not 1; name another file, or remove "
        "it\n");
  CHECK(bytes_of(folder / "state") == state);
  CHECK(folder.count() == 1);

  const std::string few = options + " --samples 16";
  CHECK(run_stage("15_csg", few + " --checkpoint few", folder).status == 0);
  CHECK(folder.count() == 2);  // its own checkpoint is gone
  CHECK(run_stage("15_csg", few, other).status == 0);
  CHECK(bytes_of(folder / file) == bytes_of(other / file));
}

TEST_CASE("a render that is stopped twice has the bytes of one that is not", "[long]") {
  const std::string samples = std::to_string(cases(100, 800, 800));
  const std::string options = "--size 160x120 --threads 1 --filter mitchell --samples " + samples;
  const std::string expected = stage_picture("13_whitted", options);
  const TemporaryFolder folder;
  std::uint64_t units = 0;
  for (const int signal : {SIGINT, SIGHUP}) {
    const std::uint64_t before = units;
    units = units_until(signal, "13_whitted", options + " --checkpoint state", folder, before);
    CHECK(units > before);
  }
  CHECK(run_stage("13_whitted", options + " --checkpoint state", folder).status == 0);
  CHECK(bytes_of(folder / "out.ppm") == expected);
  CHECK(folder.count() == 1);
}

TEST_CASE("GNU parallel runs shards, and those again that were killed", "[long]") {
  const TemporaryFolder folder;
  if (!is_installed("parallel", folder)) {
    WARN("not tested: GNU parallel is not installed");
    return;
  }
  // At the first time, each third shard is killed.
  put_bytes(folder / "draw",
            "if [ $(($1 % 3)) = 1 ] && [ ! -e killed$1 ]; then\n  touch killed$1\n  " +
                stage_path("13_whitted") + " " + of_parts +
                " --quiet --shard $1/7 -o $1.shard & kill -KILL $!; wait $!; exit 137\nfi\nexec " +
                stage_path("13_whitted") + " " + of_parts + " --quiet --shard $1/7 -o $1.shard\n");
  const std::string line =
      "parallel --will-cite --joblog log --resume-failed 'sh draw {}' ::: 0 1 2 3 4 5 6 2>>errors";
  const auto run_line = [&] {
    return run({.program = "/bin/sh", .arguments = {"-c", line}, .folder = folder / ""}).status;
  };
  CHECK(run_line() == 2);  // so many failed
  CHECK(merged("out.png 0.shard 2.shard 3.shard 5.shard 6.shard", folder).status == 1);
  CHECK(run_line() == 0);
  CHECK(merged("out.png 6.shard 0.shard 1.shard 2.shard 4.shard 3.shard 5.shard", folder).status == 0);
  CHECK(bytes_of(folder / "out.png") == whole_picture("13_whitted", "out.png"));
}

TEST_CASE("mpirun runs shards, and those again that are missing", "[long]") {
  const TemporaryFolder folder;
  if (!is_installed("mpirun", folder)) {
    WARN("not tested: mpirun is not installed");
    return;
  }
  put_bytes(
      folder / "draw",
      "i=$OMPI_COMM_WORLD_RANK\n[ ! -e $i.shard ] || exit 0\nif [ $((i % 3)) = 1 ] && [ ! -e killed$i ]; "
      "then\n  touch killed$i\n  " +
          stage_path("13_whitted") + " " + of_parts +
          " --quiet --shard mpi -o $i.shard & kill -KILL $!; wait $!; exit 137\nfi\nexec " +
          stage_path("13_whitted") + " " + of_parts + " --quiet --shard mpi -o $i.shard\n");
  const auto run_line = [&] {
    return run({.program = "/bin/sh",
                .arguments = {"-c", "mpirun --allow-run-as-root --oversubscribe -n 7 sh draw 2>>errors"},
                .folder = folder / ""})
        .status;
  };
  int runs = 1;
  while (run_line() != 0 && runs < 8) ++runs;  // a killed process ends those that run yet
  CHECK(runs > 1);
  CHECK(merged("out.png 6.shard 0.shard 1.shard 2.shard 4.shard 3.shard 5.shard", folder).status == 0);
  CHECK(bytes_of(folder / "out.png") == whole_picture("13_whitted", "out.png"));
}
