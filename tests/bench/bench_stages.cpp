// Measures the stages against the tutorial's way: time per pixel of render, encode and write, and of whole
// processes.
//
//   bench_stages [--threads N] [--runs N] [--csv FILE] [--quick]
//
// The tutorial's way has one thread, whatever N is.
#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <protostar/protostar.hpp>

#include "scenes/four_spheres.hpp"
#include "scenes/three_spheres.hpp"
#include "spheres_and_board.hpp"
#include "stages/naive.hpp"
#include "support.hpp"
#include "support/files.hpp"
#include "tutorial.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;

namespace {

/// Prints one row: a work in both ways. units is the number of units that the work consists of.
void compare(Table& table, const bench::Options& options, const std::string& name, const std::string& unit,
             double units, const Work& theirs, const Work& ours) {
  const Times times(options, {theirs, ours});
  table.row({name, unit, number(times.seconds(0) * 1e9 / units), number(times.seconds(1) * 1e9 / units),
             number(times.ratio(0, 1))});
}

// ---- Render

/// Pictures of one size by both.
struct Pictures {
  tutorial::Image theirs;
  Image ours;

  Pictures(int width, int height) : theirs(width, height), ours(width, height) {}
  [[nodiscard]] double pixels() const { return static_cast<double>(ours.width()) * ours.height(); }
};

/// Throws if both differ in one pixel in fifty or more, which is more than float and the offset get wrong:
/// then their times would not be of the same work.
void check(const std::string& name, const Pictures& pictures) {
  int differ = 0;
  for (int y = 0; y < pictures.ours.height(); ++y)
    for (int x = 0; x < pictures.ours.width(); ++x) {
      const Color difference = abs(pictures.ours(x, y) - pictures.theirs(x, y));
      if (!(std::max({difference.r, difference.g, difference.b}) < 0x1p-8f)) ++differ;
    }
  if (50 * differ > pictures.pixels())
    throw std::runtime_error(name + ": " + std::to_string(differ) + " pixels differ from the tutorial's");
}

void renders(Table& table, const bench::Options& options, Pictures& pictures) {
  const auto their_scene = tutorial::three_spheres();
  const auto scene = three_spheres();
  const RenderOptions by{.threads = options.threads};
  const auto stage = [&](const char* name, const tutorial::Integrator& theirs, const auto& ours) {
    compare(
        table, options, name, "ns/pixel", pictures.pixels(),
        [&] { theirs.render(pictures.theirs, tutorial::Camera{}, their_scene); },
        [&] { render(pictures.ours, Camera{}, scene, ours, by); });
    check(name, pictures);
  };
  stage("03_scene", tutorial::BinaryIntegrator{}, BinaryIntegrator{});
  stage("04_depth", tutorial::DepthIntegrator{}, DepthIntegrator{});
  stage("05_normal", tutorial::NormalIntegrator{}, NormalIntegrator{});
  stage("06_color", tutorial::ColorIntegrator{}, ColorIntegrator{});
  stage("07_diffuse", tutorial::DiffuseIntegrator{}, DiffuseIntegrator{});
  stage("08_transparency", tutorial::TransparencyIntegrator{}, TransparencyIntegrator{});
  stage("09_shadow", tutorial::ShadowIntegrator{}, ShadowIntegrator{});
}

/// Measures stage 13 against its article, and against the article with no rays for mirrors and glass of
/// weight 0.
void whitted(Table& table, const bench::Options& options) {
  Pictures pictures(options.quick ? 128 : 1024, options.quick ? 96 : 768);
  auto scene = four_spheres({ivory, glass, red_rubber, mirror});
  scene.add(checker_board, checkers);
  const auto stage = [&](const char* name, const tutorial::SpheresAndBoard& theirs) {
    compare(
        table, options, name, "ns/pixel", pictures.pixels(), [&] { theirs.render(pictures.theirs); },
        [&] {
          render(pictures.ours, camera_of_four_spheres(), scene, WhittedIntegrator{.depth = 5},
                 {.threads = options.threads});
        });
    check(name, pictures);
  };
  stage("13_whitted", {});
  stage("13_whitted, needed rays", {.skips_what_weighs_nothing = true});
}

/// Measures the stages 08_naive and 09_naive, which keep the tutorial's float and offset but not its virtual
/// functions, in the library's own loop.
void naive_renders(Table& table, const bench::Options& options, Pictures& pictures) {
  const auto scene = three_spheres();
  const RenderOptions by{.threads = options.threads};
  Image naive_image(pictures.ours.width(), pictures.ours.height());
  const auto stage = [&](const char* name, const Radiance auto& naive, const auto& exact) {
    compare(
        table, options, name, "ns/pixel", pictures.pixels(),
        [&] { render(naive_image, Camera{}, naive, by); },
        [&] { render(pictures.ours, Camera{}, scene, exact, by); });
  };
  stage(
      "08_naive / 08_transparency",
      [](const Ray& ray) { return naive::transparency(naive::Ray(ray), 1e-4f); }, TransparencyIntegrator{});
  stage(
      "09_naive / 09_shadow", [](const Ray& ray) { return naive::shadow(naive::Ray(ray), 1e-4f); },
      ShadowIntegrator{});
}

// ---- Encode and write

void files(Table& table, const bench::Options& options, Pictures& pictures) {
  const TemporaryFolder folder;
  const Gamma gamma{2.2};
  tutorial::ShadowIntegrator{}.render(pictures.theirs, tutorial::Camera{}, tutorial::three_spheres());
  render(pictures.ours, Camera{}, three_spheres(), ShadowIntegrator{});

  const tutorial::Image light = pictures.theirs;
  const auto encode_theirs = [&] {
    pictures.theirs = light;  // a copy, of about 0.3 ns/pixel, since it is encoded in place
    pictures.theirs.correct_gamma();
  };
  std::vector<std::uint16_t> codes(3 * static_cast<std::size_t>(pictures.ours.width()));
  const auto encode_with = [&](const Encoder& encode) {
    for (int y = 0; y < pictures.ours.height(); ++y) {
      encode(&pictures.ours(0, y), pictures.ours.width(), codes.data());
      bench::keep(codes[0]);
    }
  };
  const auto encode_ours = [&] { encode_with(Encoder(gamma, 255)); };
  const Encoder at_hand(gamma, 255);
  const auto save_theirs = [&] {
    encode_theirs();
    pictures.theirs.save_ppm(folder / "theirs.ppm");
  };
  const auto save_ours = [&](bool plain) {
    return [&, plain] { save_ppm(pictures.ours, folder / "ours.ppm", gamma, {.plain = plain}); };
  };
  const auto row = [&](const char* name, const Work& theirs, const Work& ours) {
    compare(table, options, name, "ns/pixel", pictures.pixels(), theirs, ours);
  };
  row("encode", encode_theirs, encode_ours);
  row("encode, its table at hand", encode_theirs, [&] { encode_with(at_hand); });
  row("encode and write, P3", save_theirs, save_ours(true));
  row("encode and write, P3 / P6", save_theirs, save_ours(false));
}

// ---- Whole processes

#ifdef BENCH_STAGE

/// Starts a program and waits for its end.
void start(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  int status = 0;
  if (posix_spawn(&pid, argv[0], nullptr, nullptr, argv.data(), environ) != 0 ||
      waitpid(pid, &status, 0) != pid || status != 0)
    throw std::runtime_error(words[0] + " failed");
}

/// Measures 09_shadow as a program against the tutorial's; the start of a process that does nothing is
/// subtracted from both.
void processes(Table& table, const bench::Options& options) {
  const TemporaryFolder folder;
  const std::string file = (folder / "out.ppm").string(), threads = std::to_string(options.threads);
  const auto theirs = [&] { start({BENCH_TUTORIAL, file}); };
  const auto nothing = [&] { start({BENCH_NOTHING}); };
  const auto row = [&](const char* name, const std::vector<std::string>& further) {
    const auto ours = [&] {
      std::vector<std::string> words{BENCH_STAGE, "--quiet", "--threads", threads, "-o", file};
      words.insert(words.end(), further.begin(), further.end());
      start(words);
    };
    const Times times(options, {theirs, ours, nothing});
    std::vector<double> their_seconds, our_seconds, ratios;
    for (std::size_t i = 0; i < times[0].size(); ++i) {
      their_seconds.push_back(times[0][i] - times[2][i]);
      our_seconds.push_back(times[1][i] - times[2][i]);
      ratios.push_back(their_seconds.back() / our_seconds.back());
    }
    table.row({name, "ms", number(1e3 * bench::median(their_seconds)),
               number(1e3 * bench::median(our_seconds)), number(bench::median(ratios))});
  };
  row("process 09_shadow, P3", {"--plain"});
  row("process 09_shadow, P3 / P6", {});
}

#else

void processes(Table&, const bench::Options&) {
  std::printf("no whole processes: the stages are not built\n");
}

#endif

void stages(const bench::Options& options) {
  Pictures pictures(options.quick ? 64 : 640, options.quick ? 48 : 480);
  Table table(options, {"work", "unit", "tutorial", "protostar", "times faster"});
  renders(table, options, pictures);
  whitted(table, options);
  files(table, options, pictures);
  processes(table, options);

  Table certainty(options, {"certainty", "unit", "naive", "protostar", "times faster"});
  naive_renders(certainty, options, pictures);
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, stages); }
