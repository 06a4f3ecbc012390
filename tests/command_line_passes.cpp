// Stages that draw until an error is small enough, or for some time, as a user runs them.
#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_render.hpp"
#include "support/run_stage.hpp"

namespace {

/// Returns the number at the beginning of the last line of a report.
std::string samples_told(const std::string& report) {
  const std::size_t line = report.rfind('\n', report.size() - 2) + 1;
  return report.substr(line, report.find(' ', line) - line);
}

}  // namespace

TEST_CASE("a stage with --error draws as many samples as it says, and writes the standard errors") {
  const auto& [stage, error] =
      GENERATE(std::pair{"13_whitted", "0.03"}, std::pair{"08_naive", "0.03"}, std::pair{"01_gradient", "1"});
  CAPTURE(stage);
  const TemporaryFolder folder;
  const std::string size = "--size 64x48";
  const Outcome outcome =
      run_stage(stage, size + " --error " + error + " --noise n.pfm -o a.ppm --quiet", folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out + outcome.err == "");
  CHECK(folder.count() == 2);
  const std::string noise = bytes_of(folder / "n.pfm");
  CHECK(noise.starts_with("PF\n64 48\n"));
  CHECK(noise.size() > 12 * 64 * 48);

  const Outcome told = run_stage(stage, size + " --error " + error + " -o b.ppm --threads 3", folder);
  CHECK(bytes_of(folder / "b.ppm") == bytes_of(folder / "a.ppm"));
  if (std::string(stage) == "01_gradient") {
    CHECK_THAT(told.out, ContainsSubstring("no samples, no error\n"));
    return;
  }
  CHECK_THAT(told.out, ContainsSubstring(" samples in each pixel, RMSE about "));
  CHECK_THAT(told.out, ContainsSubstring(", at most ") && ContainsSubstring(" (95 %)\n"));
}

TEST_CASE("the option --noise goes with a number of samples too") {
  const TemporaryFolder folder;
  CHECK(run_stage("13_whitted", "--size 32x24 --samples 4 --noise n.pfm -o a.ppm", folder).status == 0);
  CHECK(run_stage("13_whitted", "--size 32x24 --samples 4 --noise N.PFM -o a.ppm", folder).status == 0);
  CHECK(bytes_of(folder / "N.PFM") == bytes_of(folder / "n.pfm"));
  CHECK(bytes_of(folder / "a.ppm") ==
        stage_picture("13_whitted", "--size 32x24 --samples 4 --sampler sobol"));
  CHECK(bytes_of(folder / "n.pfm").starts_with("PF\n32 24\n"));
}

TEST_CASE("the picture is written if the standard errors cannot be") {
  if (!std::filesystem::exists("/dev/full")) {
    WARN("not tested: this system has no /dev/full");
    return;
  }
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "n.pfm");
  const Outcome outcome = run_stage("13_whitted", "--size 32x24 --samples 4 --noise n.pfm -o a.ppm", folder);
  CHECK(outcome.status == 1);
  CHECK_THAT(outcome.err, ContainsSubstring("cannot write 'n.pfm'"));
  CHECK(bytes_of(folder / "a.ppm") ==
        stage_picture("13_whitted", "--size 32x24 --samples 4 --sampler sobol"));
}

TEST_CASE("a stage with --time says with what options it draws the same bytes, and does so with these") {
  const auto& [stage, options] =
      GENERATE(std::pair{"13_whitted", ""}, std::pair{"13_whitted", " --sampler halton --filter tent"},
               std::pair{"18_antialiasing", " --clamp 0.5"}, std::pair{"19_soft_shadows", ""},
               std::pair{"20_lens", ""}, std::pair{"21_motion", ""});
  CAPTURE(stage, options);
  const std::string others = std::string("--size 32x24 --seed 5") + options;
  const TemporaryFolder folder;
  const Outcome outcome = run_stage(stage, others + " --time 0.2 -o a.ppm", folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == "");
  const std::size_t begin = outcome.out.rfind("; ") + 2,
                    end = outcome.out.rfind(" in the place of --time draws");
  REQUIRE(begin < end);
  const std::string same = outcome.out.substr(begin, end - begin);
  CHECK(same.starts_with("--samples " + samples_told(outcome.out)));
  CHECK(outcome.out.ends_with(same + " in the place of --time draws the same\n"));
  CHECK(bytes_of(folder / "a.ppm") == stage_picture(stage, others + " " + same));
}

TEST_CASE("integrators that draw by chance refuse the sampler hammersley, which has none, and say why") {
  const std::string scene = scene_path("three_spheres");
  const TemporaryFolder folder;
  for (const auto& [stage, arguments, integrator] : std::vector<std::array<std::string, 3>>{
           {"19_soft_shadows", "", "direct"},
           {"25_cornell", "", "path"},
           {"26_weekend", "", "path"},
           {"render", scene + " --integrator path ", "path"},
           {"render", scene + " --integrator direct ", "direct"},
           {"render", scene + " --integrator ambient-occlusion ", "ambient-occlusion"},
           {"render", scene_path("sampler_hammersley") + " --integrator path ", "path"}}) {
    for (const char* const samples : {"--samples 0", "--samples 4"}) {
      CAPTURE(stage, arguments, samples);
      const Outcome outcome =
          run_stage(stage, arguments + "--size 8x6 --sampler hammersley " + std::string(samples), folder);
      CHECK(outcome.status == 2);
      CHECK(outcome.out == "");
      CHECK(
          outcome.err.starts_with(stage + ": --sampler: 'hammersley' is not possible here: the integrator " +
                                  integrator + " draws by chance, and hammersley has the same numbers in "));
    }
  }
  CHECK(folder.count() == 0);
  // A lens, or a shutter, has the same points or times in every pixel: as many sharp pictures as samples.
  for (const char* const stage : {"20_lens", "21_motion", "13_whitted"})
    CHECK(run_stage(stage, "--size 8x6 --samples 2 --sampler hammersley --quiet", folder).status == 0);
}

TEST_CASE("a scene's sampler or filter that options exclude is told by the file and the key") {
  const TemporaryFolder folder;
  put_bytes(folder / "s.json", changed_three_spheres("\"resolution-x\"",
                                                     "\"sampler\": \"hammersley\", \"filter\": "
                                                     "\"mitchell\", \"resolution-x\""));
  const std::string sampler = "render: s.json: /settings/sampler: 'hammersley' is not possible ";
  for (const auto& [arguments, message] : std::vector<std::array<std::string, 2>>{
           {"--integrator path", sampler + "here: the integrator path draws by chance"},
           {"--error 1", sampler + "with --error, --time and --noise"},
           {"--samples 4 --shard 0/2 -o a.shard", sampler + "with --shard"},
           {"--sampler sobol --error 1 --clamp 1 --every-pixel",
            "render: s.json: /settings/filter: 'mitchell' is not possible with --every-pixel"},
           {"--sampler hammersley --error 1", "render: --sampler: 'hammersley' is not possible with --error"},
           {"--filter mitchell --sampler sobol --error 1 --clamp 1 --every-pixel",
            "render: --filter: 'mitchell' is not possible with --every-pixel"}}) {
    CAPTURE(arguments);
    const Outcome outcome = run_stage("render", "s.json --size 8x6 " + arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with(message));
  }
  CHECK(folder.count() == 1);
}

TEST_CASE("a target that is not met writes the picture, says its error and ends with 1") {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_stage("13_whitted", "--size 32x24 --error 1e-6 --max-samples 20 -o a.ppm", folder);
  CHECK(outcome.status == 1);
  CHECK_THAT(outcome.err,
             ContainsSubstring("13_whitted: the error is not surely at most 1e-06 after 20 samples in each "
                               "pixel, but 0.") &&
                 ContainsSubstring("; --max-samples sets how many there may be\n"));
  CHECK(bytes_of(folder / "a.ppm") ==
        stage_picture("13_whitted", "--size 32x24 --samples 20 --sampler sobol"));
}

TEST_CASE("every pixel tells its price before, and its error after") {
  const TemporaryFolder folder;
  const std::string options = "--size 16x12 --clamp 1 --every-pixel -o a.ppm --error ";
  const Outcome outcome = run_stage("13_whitted", options + "0.3", folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out.starts_with("every pixel to within 0.3 takes at least "));
  CHECK_THAT(outcome.out, ContainsSubstring(", no channel of any pixel off by more than 0."));
}

TEST_CASE("the option --clamp bounds the light of each sample") {
  const TemporaryFolder folder;
  CHECK(run_stage("13_whitted", "--size 32x24 --samples 4 --clamp 0.25 -o a.pfm", folder).status == 0);
  const std::string bytes = bytes_of(folder / "a.pfm");
  CHECK(bytes != stage_picture("13_whitted", "--size 32x24 --samples 4", "b.pfm"));
  CHECK(stage_picture("13_whitted", "--size 32x24 --samples 4 --clamp 1e30", "b.pfm") ==
        stage_picture("13_whitted", "--size 32x24 --samples 4", "b.pfm"));
}

TEST_CASE("options of errors that make no sense are refused, and nothing is drawn") {
  const std::string positive = "is not a finite number greater than 0";
  const std::vector<std::pair<std::string, std::string>> rows{
      {"--error 0", "--error: '0' " + positive},
      {"--error -1", "--error: '-1' " + positive},
      {"--error nan", "--error: 'nan' " + positive},
      {"--error inf", "--error: 'inf' " + positive},
      {"--error 1e999", "--error: '1e999' " + positive},
      {"--error a", "--error: 'a' " + positive},
      {"--time 0", "--time: '0' " + positive},
      {"--time inf", "--time: 'inf' " + positive},
      {"--clamp 0", "--clamp: '0' " + positive},
      {"--clamp nan", "--clamp: 'nan' " + positive},
      {"--error 1 --time 1", "each of --samples, --error and --time excludes the others"},
      {"--error 1 --samples 4", "each of --samples, --error and --time excludes the others"},
      {"--samples 4 --time 1", "each of --samples, --error and --time excludes the others"},
      {"--every-pixel --clamp 1", "--every-pixel requires --error E"},
      {"--every-pixel --time 1 --clamp 1", "--every-pixel requires --error E"},
      {"--every-pixel --error 1", "--every-pixel requires --clamp C"},
      {"--every-pixel --error 1 --clamp 1 --filter mitchell", "--filter: 'mitchell' is not possible"},
      {"--error 1 --sampler hammersley", "the same in every pixel and for every seed, so they tell no error"},
      {"--time 1 --sampler stratified", "depend on each other and on their number, so they tell no error"},
      {"--samples 4 --noise n.pfm --sampler hammersley", "--sampler: 'hammersley' is not possible"},
      {"--error 1 --size 31x1",
       "--error: '1' is not possible for 31x1 pixels: it takes at least 32 pixels, or --every-pixel"},
      {"--error 1 --crop 8,8,31,1", "--error: '1' is not possible for 31x1 pixels: it takes at least 32"},
      {"--every-pixel --error 1e-15 --clamp 1",
       "--every-pixel: an error of 1e-15 is not greater than 2^-48 (3.6e-15), below which light counts as "
       "black"},
      {"--every-pixel --error 0.0001 --clamp 1 --size 16x12",
       "--every-pixel: an error of 1e-04 with --clamp 1 takes at least 8571776 samples, more than the 65536 "
       "that --max-samples allows"},
      {"--max-samples 8", "--max-samples requires --error or --time"},
      {"--error 1 --max-samples 1", "--max-samples: '1' is not a whole number from 2 to 65536"},
      {"--error 1 --max-samples 65537", "--max-samples: '65537' is not a whole number from 2 to 65536"},
      {"--noise n.pfm", "--noise requires --error, --time or --samples N of at least 2"},
      {"--samples 1 --noise n.pfm", "--noise requires --error, --time or --samples N of at least 2"},
      {"--samples 4 --noise n.ppm", "--noise: 'n.ppm' is not a file that ends in .pfm"},
      {"--samples 4 --noise n.pfm -o n.pfm", "--noise: 'n.pfm' is not another file than the picture's"},
      {"--samples 4 --noise ./n.pfm -o n.pfm", "--noise: './n.pfm' is not another file than the picture's"},
      {"--pixel 1,1 --error 1", "--pixel excludes --error, --time, --noise and --clamp"},
      {"--error", "--error"},
      {"--every-pixel=1", "--every-pixel takes no value"},
  };
  for (const auto& [arguments, message] : rows) {
    CAPTURE(arguments);
    const TemporaryFolder folder;
    const Outcome outcome = run_stage("13_whitted", arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("13_whitted: "));
    CHECK_THAT(outcome.err, ContainsSubstring(message));
    CHECK(folder.count() == 0);
  }
}

TEST_CASE("a scene file's error is that of the picture, unless the command line has its own") {
  const TemporaryFolder folder;
  put_bytes(folder / "s.json",
            changed_three_spheres("\"resolution-x\"", "\"error\": 0.05, \"resolution-x\""));
  const Outcome outcome = run_stage("render", "s.json --size 64x48 -o a.ppm", folder);
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("16 samples in each pixel, RMSE about "));
  CHECK(run_stage("render", "s.json --size 64x48 -o b.ppm --samples 16 --sampler sobol", folder).status == 0);
  CHECK(bytes_of(folder / "a.ppm") == bytes_of(folder / "b.ppm"));
  const Outcome smaller = run_stage("render", "s.json --size 64x48 -o b.ppm --error 0.002", folder);
  CHECK(std::stoi(samples_told(smaller.out)) > 16);
  CHECK_THAT(run_stage("render", "s.json --sampler hammersley", folder).err,
             ContainsSubstring("--sampler: 'hammersley' is not possible with --error"));
  // The error is that before the exposure.
  put_bytes(folder / "e.json", changed_three_spheres("\"resolution-x\"",
                                                     "\"exposure\": 100, \"error\": 0.05, \"resolution-x\""));
  CHECK(samples_told(run_stage("render", "e.json --size 64x48", folder).out) == "16");
}

TEST_CASE("options that exclude an error tell that it is the scene's") {
  const TemporaryFolder folder;
  put_bytes(folder / "s.json",
            changed_three_spheres("\"resolution-x\"", "\"error\": 0.05, \"resolution-x\""));
  for (const auto& [option, arguments] : {std::pair{"--pixel", "--pixel 1,1"},
                                          {"--shard", "--shard 0/2 -o a.shard"},
                                          {"--checkpoint", "--checkpoint state"}}) {
    CAPTURE(option);
    const Outcome outcome = run_stage("render", std::string("s.json --size 64x48 ") + arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err == std::string("render: ") + option +
                             ": needs a known number of samples, and the scene asks for an error; --samples "
                             "N takes its place\nRun with --help for what is allowed.\n");
  }
  CHECK(run_stage("render", "s.json --size 64x48 --pixel 1,1 --samples 4 --quiet", folder).status == 0);
  CHECK(folder.count() == 1);
}

TEST_CASE("the progress of a picture with --time tells the remaining seconds, however many", "[long]") {
  if (!has_terminals()) {
    WARN("not tested: this system has no pseudo terminals");
    return;
  }
  const TemporaryFolder folder;
  Command command =
      stage("render", words(scene_path("three_spheres") + " --time 1e300 --timeout 2 -o a.ppm"), folder / "");
  command.terminal = true;
  const Outcome outcome = run(command);
  CHECK(outcome.status == 1);  // it has taken too long
  CHECK_THAT(outcome.err, ContainsSubstring(", 1e+300 s left"));
}

TEST_CASE("a part in the scale of a whole picture tells the error of the picture, which is drawn") {
  const TemporaryFolder folder;
  put_bytes(folder / "s.json",
            changed_three_spheres("\"resolution-x\"", "\"tone\": \"scale-image\", \"resolution-x\""));
  const Outcome outcome =
      run_stage("render", "s.json --size 64x48 --crop 30,20,2,3 --error 0.05 -o a.ppm", folder);
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.out, ContainsSubstring(": 2x3, ") && ContainsSubstring(", at most ") &&
                              ContainsSubstring(" (95 %)\n"));
}

TEST_CASE("a scene file's error for fewer than 32 pixels is told by what asks for so few") {
  const TemporaryFolder folder;
  put_bytes(folder / "s.json",
            changed_three_spheres("\"resolution-x\"", "\"error\": 0.05, \"resolution-x\""));
  put_bytes(folder / "few.json",
            changed_three_spheres(R"("resolution-x": 640, "resolution-y": 480)",
                                  R"("resolution-x": 31, "resolution-y": 1, "error": 0.05)"));
  const auto says = [&](const std::string& arguments, int status, const std::string& error) {
    CAPTURE(arguments);
    const Outcome outcome = run_stage("render", arguments + " -o a.ppm", folder);
    CHECK(outcome.status == status);
    CHECK(outcome.err.starts_with("render: " + error + ": it takes at least 32 pixels, or --every-pixel\n"));
  };
  says("s.json --size 31x1", 2, "--size: '31x1' is not possible with the scene's error");
  says("s.json --crop 8,8,31,1", 2, "--crop: '8,8,31,1' is not possible with the scene's error");
  says("few.json", 1, "few.json: /settings/error: 0.05 is not possible for 31x1 pixels");
  for (const char* const other : {"--size 32x1", "--samples 1", "--time 0.01", "--every-pixel --clamp 1"})
    CHECK(run_stage("render", std::string("few.json -o a.ppm ") + other, folder).status == 0);
}
