// Measures how the time of a picture grows with pixels, surfaces, lights and threads, and the cost of an
// empty pixel.
//
//   bench_scaling [--threads N] [--runs N] [--csv FILE] [--quick]
//
// The exponent is the slope of log time over log n, fitted by least squares: 1 if time grows with n, 0 if it
// does not, −1 if n threads take an n-th of it.
#include <memory>
#include <numbers>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/image.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/shadow.hpp>

#include "support.hpp"
#include "workload.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;

namespace {

/// Returns the exponent of n in the times.
double exponent(const std::vector<int>& n, const std::vector<double>& seconds) {
  double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  const double count = static_cast<double>(n.size());
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double x = std::log(n[i]), y = std::log(seconds[i]);
    sum_x += x, sum_y += y, sum_xx += x * x, sum_xy += x * y;
  }
  return (count * sum_xy - sum_x * sum_y) / (count * sum_xx - sum_x * sum_x);
}

/// Prints the rows of a series, a time for each n; the exponent stands in the last.
void print(Table& table, const std::string& name, const std::vector<int>& n,
           const std::vector<double>& seconds) {
  for (std::size_t i = 0; i < n.size(); ++i)
    table.row({name, std::to_string(n[i]), number(1e3 * seconds[i]), number(seconds[i] / seconds[0]),
               i + 1 == n.size() && i > 0 ? number(exponent(n, seconds), 2) : ""});
}

/// Measures a series of works, one for each n.
void series(Table& table, const bench::Options& options, const std::string& name, const std::vector<int>& n,
            const std::vector<Work>& works) {
  const Times times(options, works);
  std::vector<double> seconds;
  for (std::size_t i = 0; i < n.size(); ++i) seconds.push_back(times.seconds(i));
  print(table, name, n, seconds);
}

std::vector<Image> images(std::size_t count, int width, int height) {
  return std::vector<Image>(count, Image(width, height));
}

void pixels(Table& table, const bench::Options& options) {
  const auto scene = three_spheres();
  std::vector<Image> pictures;
  std::vector<int> n;
  for (int width = options.quick ? 16 : 160; width <= (options.quick ? 32 : 1280); width *= 2) {
    pictures.emplace_back(width, width / 4 * 3);
    n.push_back(width * (width / 4 * 3));
  }
  std::vector<Work> works;
  for (Image& picture : pictures)
    works.emplace_back(
        [&] { render(picture, Camera{}, scene, ShadowIntegrator{}, {.threads = options.threads}); });
  series(table, options, "pixels, 09_shadow", n, works);
}

/// Measures random spheres that cover the same part of the picture at any count.
void surfaces(Table& table, const bench::Options& options) {
  const int most = options.quick ? 100 : bench::is_accelerated ? 1'000'000 : 1000;
  std::vector<int> n;
  std::vector<bench::Workload> workloads;
  for (int count = 10; count <= most; count *= 10) {
    n.push_back(count);
    workloads.push_back(bench::workload(static_cast<std::size_t>(count)));
  }
  std::vector<Scene<Sphere>> scenes;
  for (const bench::Workload& workload : workloads) scenes.push_back(bench::scene_of(workload));
  const int side = options.quick ? 16 : bench::is_accelerated ? 1024 : 128;
  auto pictures = images(n.size(), side, side);

  // No scene is moved or copied once it is accelerated.
  using Traced = decltype(bench::traced(scenes[0], 1));
  struct Prepared {
    Traced scene;
    Prepared(const Scene<Sphere>& from, int threads) : scene(bench::traced(from, threads)) {}
  };
  std::vector<std::unique_ptr<Prepared>> traced;
  for (const auto& scene : scenes) traced.push_back(std::make_unique<Prepared>(scene, options.threads));

  std::vector<Work> works;
  for (std::size_t i = 0; i < n.size(); ++i)
    works.emplace_back([&, i] {
      render(pictures[i], workloads[i].camera, traced[i]->scene, ColorIntegrator{},
             {.threads = options.threads});
    });
  series(table, options, "surfaces, color", n, works);
}

/// Measures lamps in a circle above the tutorial's scene.
void lights(Table& table, const bench::Options& options) {
  std::vector<int> n;
  std::vector<Scene<Sphere>> scenes;
  for (int count = 1; count <= (options.quick ? 2 : 64); count *= 2) {
    Scene<Sphere>& scene = scenes.emplace_back();
    for (const auto& [sphere, color] : the_three_spheres) scene.add(sphere, color);
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      scene.add(PointLight{.position = {std::sin(angle), 3, std::cos(angle)},
                           .power = light_of_the_three_spheres.power / static_cast<float>(count)});
    }
    n.push_back(count);
  }
  auto pictures = images(n.size(), options.quick ? 16 : 320, options.quick ? 12 : 240);
  std::vector<Work> works;
  for (std::size_t i = 0; i < n.size(); ++i)
    works.emplace_back([&, i] {
      render(pictures[i], Camera{}, scenes[i], ShadowIntegrator{}, {.threads = options.threads});
    });
  series(table, options, "lights, shadow", n, works);
}

void threads(Table& table, const bench::Options& options) {
  const auto scene = three_spheres();
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<int> n;
  for (int count = 1; count < cores; count *= 2) n.push_back(count);
  n.push_back(cores);
  auto pictures = images(n.size(), options.quick ? 16 : 1280, options.quick ? 12 : 960);
  std::vector<Work> works;
  for (std::size_t i = 0; i < n.size(); ++i)
    works.emplace_back(
        [&, i] { render(pictures[i], Camera{}, scene, ShadowIntegrator{}, {.threads = n[i]}); });
  const Times times(options, works);
  std::vector<double> seconds;
  for (std::size_t i = 0; i < n.size(); ++i) seconds.push_back(times.shortest(i));
  print(table, "threads, 09_shadow, shortest turn", n, seconds);
}

/// Measures additions that wait for nothing, by one thread and by as many as there are cores: two threads
/// that share a core gain hardly anything here, and more if they wait for memory.
void additions(Table& table, const bench::Options& options) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<int> n{1};
  if (cores > 1) n.push_back(cores);
  std::vector<Work> works;
  for (const int count : n)
    works.emplace_back([count, &options] {
      bench::in_parts(options.quick ? 1000 : 100'000'000, count, [](std::size_t begin, std::size_t end) {
        std::size_t a = 0, b = 0, c = 0, d = 0, e = 0, f = 0;
        for (std::size_t i = begin; i < end; ++i) {
          a += i, b += i, c += i, d += i, e += i, f += i;
          asm volatile("" : "+r"(a), "+r"(b), "+r"(c), "+r"(d), "+r"(e), "+r"(f));  // each, and in a register
        }
      });
    });
  const Times times(options, works);
  std::vector<double> seconds;
  for (std::size_t i = 0; i < n.size(); ++i) seconds.push_back(times.shortest(i));
  print(table, "threads, additions, shortest turn", n, seconds);
}

/// Measures a pixel that sees nothing against one that is only written.
void empty_pixels(const bench::Options& options) {
  Scene<Sphere> scene;
  for (const auto& [sphere, color] : the_three_spheres) scene.add(sphere, color);
  const Camera upwards{.up = {0, 0, -1}, .forward = {0, 1, 0}};  // the ground is all around below
  Image drawn(options.quick ? 64 : 640, options.quick ? 48 : 480), filled = drawn;
  Color background{0};
  const Times times(options, {[&] { render(drawn, upwards, scene, ColorIntegrator{}, {.threads = 1}); },
                              [&] {
                                bench::keep(background);  // hides from the compiler that it is 0
                                for (int y = 0; y < filled.height(); ++y)
                                  for (int x = 0; x < filled.width(); ++x) filled(x, y) = background;
                                bench::keep(filled(0, 0));
                              }});
  const double count = static_cast<double>(drawn.width()) * drawn.height();
  Table table(options, {"empty pixel", "ns drawn", "ns filled", "times"});
  table.row({"all spheres below the view", number(1e9 * times.seconds(0) / count),
             number(1e9 * times.seconds(1) / count), number(times.ratio(0, 1))});
}

void scaling(const bench::Options& options) {
  {
    Table table(options, {"time against", "n", "ms", "to the first", "exponent"});
    pixels(table, options);
    surfaces(table, options);
    lights(table, options);
    threads(table, options);
    additions(table, options);
  }
  empty_pixels(options);
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, scaling); }
