// Measures light by paths: the error of pictures by their time, for samplers and ways to draw paths; what
// paths leave out; and the way of "Ray Tracing in One Weekend" (weekend_way.hpp) beside them.
//
//   bench_paths [--runs N] [--csv FILE] [--quick]
#include <protostar/accel/render_tiles.hpp>
#include <protostar/render.hpp>
#include <protostar/sampling/halton_sampler.hpp>
#include <protostar/sampling/independent_sampler.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/stratified_sampler.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "path_workload.hpp"
#include "support.hpp"

using namespace protostar;
using bench::number, bench::PathWorkload, bench::Table, bench::Times, bench::Work;

namespace {

/// Light of a picture: three channels of each pixel, cut off at 1 as a screen does.
using Light = std::vector<double>;

/// A way to draw a workload's picture, with so many samples of each pixel and a seed.
struct Way {
  std::string name;
  std::function<Light(int samples, std::uint64_t seed)> draw;
  std::function<double(int samples)> rays = {};  ///< traced for a picture, if they are counted
};

double shown(double light) { return std::min(light, 1.0); }

Light light_of(const Image& image) {
  Light light;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Color& c = image(x, y);
      light.insert(light.end(), {shown(c.r), shown(c.g), shown(c.b)});
    }
  return light;
}

/// Returns the integrator of a workload that stays in its place.
PathIntegrator integrator_of(const PathWorkload& work) {
  PathIntegrator path(work.scene);
  path.depth = work.depth;
  return path;
}

/// Counts what the paths of a picture ask, ray by ray.
bench::PathCounts counts_of(const PathWorkload& work, int samples) {
  const PathIntegrator path = integrator_of(work);
  const auto accelerated = accelerate(work.scene);
  bench::PathCounts counts;
  const LightRays before = light_rays;
  const bench::CountedScene counted(accelerated, counts);
  Image image(work.width, work.height);
  render(image, work.camera,
         [&](const Ray& ray, const PixelSampler& sampler) { return path.radiance(ray, counted, sampler); },
         {.samples = samples, .threads = 1});
  counts.light_rays_skipped = light_rays.skipped - before.skipped;
  counts.paths = static_cast<std::uint64_t>(work.width) * static_cast<std::uint64_t>(work.height) *
                 static_cast<std::uint64_t>(samples);
  return counts;
}

Way our_way(const PathWorkload& work, const std::string& name, const SamplerChoice& sampler) {
  return {name,
          [&work, sampler](int samples, std::uint64_t seed) {
            Image image(work.width, work.height);
            render(image, work.camera, work.scene, integrator_of(work),
                   {.samples = samples, .sampler = sampler, .seed = seed, .threads = 1});
            return light_of(image);
          },
          [&work](int samples) { return static_cast<double>(counts_of(work, samples).rays()); }};
}

Way books_way(const PathWorkload& work, const std::string& name, const weekend_way::Camera& camera,
              bool has_tree) {
  const auto draw = [&work, camera, world = bench::world_of(work, has_tree)](int samples,
                                                                             std::uint64_t seed) {
    weekend_way::seed_random(seed);
    Light light;
    for (const auto& c : weekend_way::render(world, camera, work.width, work.height, samples))
      light.insert(light.end(), {shown(c.x), shown(c.y), shown(c.z)});
    return light;
  };
  return {name, draw, [draw](int samples) {
            const std::uint64_t before = weekend_way::traced_rays;
            static_cast<void>(draw(samples, 0));
            return static_cast<double>(weekend_way::traced_rays - before);
          }};
}

/// Returns the true picture: the mean of the light along 16 × 16 rays of each pixel, which changes so little
/// in a pixel that the mean is exact to 10^-4.
Light true_light(const PathWorkload& work) {
  Image image(work.width, work.height);
  render(image, work.camera, work.truth, {.samples = 256, .threads = 1});
  return light_of(image);
}

/// Errors of pictures of one way with one number of samples.
struct Error {
  double whole = 0;  ///< root of the mean squared error, over pixels and channels
  double best = 0;   ///< the same over nine pixels in ten, which other pictures tell
  double calm = 0;   ///< the same over nine pixels in ten of each picture, the best of its own
  double mean = 0;   ///< mean light of the pictures
};

/// Returns the mean squared error of the nine in ten pixels of a picture that are nearest to a long picture
/// of the same way. It leaves out the tenth with the largest errors, as of pixels that a rare bright path has
/// met.
double squares_of_calm(const Light& light, const Light& long_light) {
  std::vector<double> squares;
  for (std::size_t i = 0; i < light.size(); i += 3) {
    const auto square = [&](std::size_t k) {
      return (light[k] - long_light[k]) * (light[k] - long_light[k]);
    };
    squares.push_back((square(i) + square(i + 1) + square(i + 2)) / 3);
  }
  const auto end = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() * 9 / 10);
  std::nth_element(squares.begin(), end, squares.end());
  return std::accumulate(squares.begin(), end, 0.0) / static_cast<double>(end - squares.begin());
}

/// Returns the errors of a way. Pictures with different seeds know nothing of each other, so that their
/// variance is the expected squared error of one of them, without bias and without a reference; it does not
/// see an error that all of them have, which the mean light shows and the truth, if it is known. The best
/// nine in ten pixels are those of the first half of the pictures, and the second half tells their error.
/// The calm pixels are chosen in each picture, by its difference from a long one, if there is one.
Error error_of(const Way& way, int samples, int pictures, const Light& truth, const Light& long_light) {
  std::vector<Light> all;
  for (int i = 0; i < pictures; ++i) all.push_back(way.draw(samples, 1000 + static_cast<std::uint64_t>(i)));
  const std::size_t count = all.front().size();
  Error error;
  double calm = 0;
  for (const Light& light : all) {
    error.mean += std::accumulate(light.begin(), light.end(), 0.0);
    if (!long_light.empty()) calm += squares_of_calm(light, long_light);
  }
  error.mean /= static_cast<double>(count * all.size());
  error.calm = std::sqrt(calm / static_cast<double>(all.size()));

  // The squared error of a pixel, from the pictures of a half.
  const std::size_t half = all.size() / 2;
  const auto square = [&](std::size_t pixel, std::size_t first) {
    double sum = 0;
    for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
      double mean = 0, squares = 0;
      for (std::size_t k = first; k < first + half; ++k) mean += all[k][i] / static_cast<double>(half);
      const double center = truth.empty() ? mean : truth[i];
      for (std::size_t k = first; k < first + half; ++k)
        squares += (all[k][i] - center) * (all[k][i] - center);
      sum += squares / static_cast<double>(truth.empty() ? half - 1 : half) / 3;
    }
    return sum;
  };
  std::vector<std::pair<double, double>> pixels;
  for (std::size_t pixel = 0; pixel < count / 3; ++pixel)
    pixels.emplace_back(square(pixel, 0), square(pixel, half));
  std::sort(pixels.begin(), pixels.end());
  const std::size_t best = pixels.size() * 9 / 10;
  double sum = 0, both = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    both += (pixels[i].first + pixels[i].second) / 2;
    if (i < best) sum += pixels[i].second;
  }
  error.whole = std::sqrt(both / static_cast<double>(pixels.size()));
  error.best = std::sqrt(sum / static_cast<double>(best));
  return error;
}

/// Throws if the mean light of a way differs from that of the first by more than noise: the error of a mean
/// of many pixels, by six times its deviation if pixels know nothing of each other, and 1 % for what is cut
/// off at 1, which is more where single samples are bright, and for Schlick's approximation.
void require_same_mean(const std::string& name, const Error& error, const Error& first, double pictures) {
  const double noise = std::hypot(error.whole, first.whole) / std::sqrt(pictures);
  if (std::abs(error.mean - first.mean) > 6 * noise + 0.01 * first.mean)
    throw std::runtime_error(name + ": the pictures have the mean light " + number(error.mean) +
                             ", and not " + number(first.mean));
}

/// Number of samples after which an error would be 1/255, by a line through the logarithms of two errors. The
/// rate of independent samples, -1/2, is certain for all samplers; where rare bright paths hide it, it is
/// taken.
struct Line {
  double samples, slope;
};
Line line_to_level(int few, double error_of_few, int many, double error_of_many) {
  const double slope = std::log(error_of_many / error_of_few) / std::log(static_cast<double>(many) / few);
  return {many * std::pow(error_of_many * 255, -1 / std::min(slope, -0.5)), slope};
}

void measure(const bench::Options& options, const PathWorkload& work, const std::vector<Way>& ways) {
  const int last = options.quick ? 4 : 64, pictures = options.quick ? 4 : 8,
            many = options.quick ? 64 : 1 << 13;
  const Light truth = work.truth ? true_light(work) : Light{};

  std::vector<Work> works;
  const int timed = options.quick ? 1 : 16;
  for (const Way& way : ways) works.push_back([&] { bench::keep(way.draw(timed, 1)); });
  const Times times(options, works);

  Table::Cells columns = {work.name};
  for (int samples = 1; samples <= last; samples *= 4) columns.push_back("RMSE " + std::to_string(samples));
  columns.insert(columns.end(), {"slope", "90 %", "mean", "ns/sample", "rays", "ns/ray", "s to 1/255",
                                 "ratio", "ratio 90 %", "ratio ray"});
  if (work.has_rare_light) columns.insert(columns.end(), {"calm 90 %", "ratio calm 90 %"});
  Table table(options, columns);
  const double all = static_cast<double>(work.width) * work.height;
  double first_time = 0, first_best = 0, first_calm = 0, first_ray = 0;
  Error first;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    Table::Cells cells = {ways[i].name};
    const Light long_light = work.has_rare_light ? ways[i].draw(many, 1) : Light{};
    Error before, error;
    for (int samples = 1; samples <= last; samples *= 4) {
      before = error;
      error = error_of(ways[i], samples, pictures, truth, long_light);
      cells.push_back(number(error.whole, 3));
    }
    if (i == 0) first = error;
    require_same_mean(ways[i].name, error, first, all * pictures);
    const Line whole = line_to_level(last / 4, before.whole, last, error.whole),
               best = line_to_level(last / 4, before.best, last, error.best),
               calm = line_to_level(last / 4, before.calm, last, error.calm);
    const double sample = times.ratio(i, 0) * times.seconds(0) / all / timed;
    const double rays = ways[i].rays(timed) / all / timed;
    const double time = whole.samples * sample * all, best_time = best.samples * sample * all,
                 calm_time = calm.samples * sample * all;
    if (i == 0) first_time = time, first_best = best_time, first_calm = calm_time, first_ray = sample / rays;
    cells.insert(cells.end(),
                 {number(whole.slope, 2), number(error.best), number(error.mean, 5), number(1e9 * sample),
                  number(rays), number(1e9 * sample / rays), number(time), number(time / first_time),
                  number(best_time / first_best), number(sample / rays / first_ray)});
    if (work.has_rare_light) cells.insert(cells.end(), {number(error.calm), number(calm_time / first_calm)});
    table.row(cells);
  }
}

void skips(const bench::Options& options, const std::vector<const PathWorkload*>& workloads) {
  Table table(options, {"of a path, on average", "rays", "vertices", "light rays", "not cast",
                        "lobes not drawn", "ends by chance"});
  for (const PathWorkload* work : workloads) {
    const bench::PathCounts c = counts_of(*work, options.quick ? 1 : 16);
    const auto share = [&](std::uint64_t count) {
      return number(static_cast<double>(count) / static_cast<double>(c.paths));
    };
    table.row({work->name, share(c.rays()), share(c.vertices), share(c.light_rays),
               share(c.light_rays_skipped), share(c.lobes_skipped), share(c.by_chance())});
  }
}

void paths_benchmark(const bench::Options& options) {
  PathWorkload weekend = bench::weekend_workload(), cornell = bench::cornell_workload(),
               furnace = bench::furnace_workload(), lamps = bench::lamps_workload();
  const std::vector<PathWorkload*> workloads = {&weekend, &cornell, &furnace, &lamps};
  if (options.quick)
    for (PathWorkload* work : workloads) work->width = 5, work->height = 4;

  for (const PathWorkload* work : workloads) {
    std::vector<Way> ways = {our_way(*work, "sobol", sampler_of<SobolSampler>),
                             our_way(*work, "independent", sampler_of<IndependentSampler>),
                             our_way(*work, "stratified", sampler_of<StratifiedSampler>),
                             our_way(*work, "halton", sampler_of<HaltonSampler>)};
    if (work == &weekend) {
      ways.push_back(books_way(*work, "book 1", bench::weekend_way_camera(), false));
      ways.push_back(books_way(*work, "book 1 with the tree of book 2", bench::weekend_way_camera(), true));
    } else if (work == &cornell) {
      ways.push_back(books_way(*work, "book 3", bench::weekend_way_cornell_camera(), true));
    }
    measure(options, *work, ways);
  }
  skips(options, {workloads.begin(), workloads.end()});
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, paths_benchmark); }
