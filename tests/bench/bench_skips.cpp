// Measures what tiles save by each kind of culling: pictures with all of them, without each, and ray by ray.
//
//   bench_skips [--threads N] [--runs N] [--csv FILE] [--quick]
#include <protostar/accel/render_tiles.hpp>
#include <protostar/image.hpp>
#include <protostar/integrators/shadow.hpp>
#include <stdexcept>

#include "support.hpp"
#include "support/pictures.hpp"
#include "workload.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;

namespace {

struct Way {
  const char* name;
  Skips skips = {};
  bool tiles = true;
};

const Way ways[] = {
    {"all skips"},
    {"no empty_tiles", {.empty_tiles = false}},
    {"no sure_in_float", {.sure_in_float = false}},
    {"no occluder_lists", {.occluder_lists = false}},
    {"no skips", {false, false, false}},
    {"tiles = false", {}, false},
};

void pictures(Table& table, const bench::Options& options, const std::string& name, std::size_t count,
              int width, int height) {
  const bench::Workload workload = bench::workload(count);
  const Scene<Sphere> scene = bench::scene_of(workload);
  const auto& traced = bench::traced(scene, options.threads);
  const auto draw = [&](Image& image, const Way& way, RenderStatistics* taken) {
    render(image, workload.camera, traced, ShadowIntegrator{},
           {.threads = options.threads, .tiles = way.tiles, .skips = way.skips, .statistics = taken});
  };
  std::vector<Image> images(std::size(ways), Image(width, height));
  std::vector<Work> works;
  for (std::size_t i = 0; i < std::size(ways); ++i)
    works.emplace_back([&, i] { draw(images[i], ways[i], nullptr); });
  const Times times(options, works);

  const double pixels = static_cast<double>(width) * height;
  const auto a_pixel = [&](std::uint64_t n) { return number(static_cast<double>(n) / pixels); };
  for (std::size_t i = 0; i < std::size(ways); ++i) {
    if (different_pixels(images[i], images[0]) > 0)
      throw std::runtime_error(std::string(ways[i].name) + ": another picture");
    RenderStatistics taken;
    draw(images[i], ways[i], &taken);
    Table::Cells cells{name + ways[i].name, number(1e3 * times.seconds(i)), number(times.ratio(i, 0))};
    for (const auto n : {taken.surface_tests, taken.other_rays, taken.rays_alone, taken.pixels_skipped})
      cells.push_back(ways[i].tiles ? a_pixel(n) : "");
    table.row(cells);
  }
}

void skips(const bench::Options& options) {
  Table table(options,
              {"spheres and way", "ms", "times", "tests/pixel", "shadow rays", "of them alone", "skipped"});
  const int width = options.quick ? 64 : 640, side = options.quick ? 32 : 512;
  pictures(table, options, "3 ", 3, width, width / 4 * 3);
  pictures(table, options, "1000 ", 1000, side, side);
  if (!options.quick) pictures(table, options, "100000 ", 100'000, side, side);
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, skips); }
