// Pictures of the tutorial's scene over sizes and samples: time, and error of the light on each pixel.
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>

#include "bench_error.hpp"
#include "stages/naive.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times;

namespace {

struct Size {
  int width, height;
};

/// Returns an image of larger pixels, each the average of side × side pixels of another image.
Image averaged(const Image& image, int side) {
  if (side == 1) return image;
  Image result(image.width() / side, image.height() / side);
  for (int y = 0; y < result.height(); ++y)
    for (int x = 0; x < result.width(); ++x) {
      Color sum{0};
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) sum += image(x * side + i, y * side + j);
      result(x, y) = sum / static_cast<float>(side * side);
    }
  return result;
}

/// Returns the light on each pixel: the average of (4 · shifts)² rays, 4 × 4 a pixel from each of
/// shifts × shifts cameras, whose films are shifted against each other by parts of their pixels.
Image light_on_pixels(Size size, int shifts, const auto& scene, const auto& integrator) {
  constexpr int side = 4;
  Image fine(side * size.width, side * size.height), sum(size.width, size.height);
  for (int j = 0; j < shifts; ++j)
    for (int i = 0; i < shifts; ++i) {
      const double pixel = 2.0 / fine.height();  // on the film
      Camera camera;
      camera.forward +=
          pixel * (((i + 0.5) / shifts - 0.5) * camera.right + ((j + 0.5) / shifts - 0.5) * camera.up);
      render(fine, camera, scene, integrator);
      const Image part = averaged(fine, side);
      for (int y = 0; y < sum.height(); ++y)
        for (int x = 0; x < sum.width(); ++x) sum(x, y) += part(x, y) / static_cast<float>(shifts * shifts);
    }
  return sum;
}

/// Returns the root mean square error over pixels and channels; an image of fewer pixels is shown in larger
/// ones.
double rms(const Image& image, const Image& truth) {
  const int side = truth.width() / image.width();
  double squares = 0;
  for (int y = 0; y < truth.height(); ++y)
    for (int x = 0; x < truth.width(); ++x) {
      const glm::dvec3 error = glm::dvec3(image(x / side, y / side)) - glm::dvec3(truth(x, y));
      squares += dot(error, error);
    }
  return std::sqrt(squares / (3.0 * truth.width() * truth.height()));
}

/// Measures one picture over sizes and samples, in the library's way and the naive one.
void picture_errors(const bench::Options& options, const std::string& name, const auto& integrator,
                    const Radiance auto& naive) {
  struct Row {
    std::string setting;
    bench::Measure naive, exact;
    double ratio;
  };
  const Size full = options.quick ? Size{64, 48} : Size{640, 480};
  const auto scene = three_spheres();
  const Image truth = light_on_pixels(full, options.quick ? 1 : 8, scene, integrator);
  const RenderOptions by{.threads = options.threads};

  std::vector<Row> rows;
  for (const int shrink : {8, 4, 2, 1})
    for (const int side : {1, 2, 4, 8}) {
      const Size size{full.width / shrink, full.height / shrink};
      Image naive_picture(size.width, size.height), exact_picture = naive_picture;
      Image samples(side * size.width, side * size.height);
      const Times times(options, {[&] {
                                    render(samples, Camera{}, naive, by);
                                    naive_picture = averaged(samples, side);
                                  },
                                  [&] {
                                    render(samples, Camera{}, scene, integrator, by);
                                    exact_picture = averaged(samples, side);
                                  }});
      rows.push_back({name + " " + std::to_string(size.width) + "x" + std::to_string(size.height) + ", " +
                          std::to_string(side * side) + " a pixel",
                      {1e3 * times.seconds(0), rms(naive_picture, truth)},
                      {1e3 * times.seconds(1), rms(exact_picture, truth)},
                      times.ratio(0, 1)});
    }

  std::vector<bench::Measure> all;
  for (const Row& row : rows) all.insert(all.end(), {row.naive, row.exact});
  Table table(options,
              {"picture", "naive ms", "exact ms", "times faster", "naive error", "exact error", "front"});
  for (const Row& row : rows) {
    const bool first = bench::is_on_front(row.naive, all), second = bench::is_on_front(row.exact, all);
    table.row({row.setting, number(row.naive.time), number(row.exact.time), number(row.ratio),
               number(row.naive.error), number(row.exact.error),
               first && second ? "both"
               : first         ? "naive"
               : second        ? "exact"
                               : ""});
  }
}

}  // namespace

void errors_of_pictures(const bench::Options& options) {
  picture_errors(options, "transparency", TransparencyIntegrator{},
                 [](const Ray& ray) { return naive::transparency(naive::Ray(ray), 1e-4f); });
  picture_errors(options, "shadow", ShadowIntegrator{},
                 [](const Ray& ray) { return naive::shadow(naive::Ray(ray), 1e-4f); });
}
