// Measures how far light by distances is off from light by rays: ambient occlusion and soft shadows of the
// scene of stage 37, at the hit in the center of each pixel.
//
//   bench_distances [--threads N] [--csv FILE] [--quick]
#include <protostar/image.hpp>
#include <protostar/integrators/ambient_occlusion.hpp>
#include <protostar/integrators/direct.hpp>
#include <protostar/integrators/distance_occlusion.hpp>
#include <protostar/integrators/distance_shadow.hpp>
#include <protostar/integrators/unoccluded.hpp>
#include <protostar/render.hpp>
#include <protostar/sampling/sobol_sampler.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "scenes/folded_rows.hpp"
#include "support.hpp"

using namespace protostar;
using bench::Table;

namespace {

/// Shares of light at a hit, from 0 to 1, as a color: red by distances; green and blue the means of two
/// halves of the rays.
Color shares(double by_distances, const SampleIndex& pixel, std::uint32_t half, const auto& light_of_ray) {
  double mean[2] = {};
  for (std::uint32_t seed = 0; seed < 2; ++seed)
    for (std::uint32_t i = 0; i < half; ++i)
      mean[seed] += light_of_ray(SobolSampler(SampleIndex{
                        .seed = seed, .x = pixel.x, .y = pixel.y, .sample = i, .samples = half})) /
                    half;
  return {to_float(by_distances), to_float(mean[0]), to_float(mean[1])};
}

/// Adds a row of the differences at the hits of a picture, where shares(hit, pixel) tells all shares, or
/// none.
void add_row(Table& table, const bench::Options& options, const std::string& name, const AnyScene& scene,
             const auto& shares_at) {
  Image image(options.quick ? 16 : 160, options.quick ? 12 : 120);
  const Color nothing{-1};
  const auto look = [&](const Ray& ray, const PixelSampler& sampler) {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shares_at(*hit, sampler.index()).value_or(nothing) : nothing;
  };
  render(image, Camera{}, look, {.threads = options.threads});
  double count = 0, truth = 0, sum = 0, size = 0, brightest = 0, darkest = 0, noise = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Color one = image(x, y);
      if (one == nothing) continue;
      const double mean = (double{one.g} + one.b) / 2, off = one.r - mean;
      ++count, truth += mean, sum += off, size += std::abs(off);
      brightest = std::max(brightest, off), darkest = std::max(darkest, -off);
      noise += std::pow((double{one.g} - one.b) / 2, 2);
    }
  const auto share = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4f", value);
    return std::string(text);
  };
  table.row({name, bench::number(count, 6), share(truth / count), share(sum / count), share(size / count),
             share(brightest), share(darkest), share(std::sqrt(noise / count))});
}

void distances(const bench::Options& options) {
  Table table(options, {"share of light", "hits", "mean by rays", "mean off", "mean size off",
                        "most too bright", "most too dark", "noise of the rays"});
  const std::uint32_t half = options.quick ? 8 : 512;

  const double farthest = 1;  // as in stage 37
  const AnyScene rows = folded_rows();
  const DistanceOcclusionIntegrator occlusion(rows, farthest);
  const AmbientOcclusionIntegrator by_rays(farthest);
  add_row(table, options, "ambient occlusion", rows, [&](const Intersection& hit, const SampleIndex& pixel) {
    const auto open = [&](const auto& sampler) { return double{by_rays.shade(hit, rows, sampler).g}; };
    return std::optional(shares(occlusion.free_share(hit.point(), hit.facing_normal()), pixel, half, open));
  });

  const AnyScene lit = folded_rows(RowLamp::sphere);
  const DistanceShadowIntegrator shadow(lit);
  const DirectIntegrator direct(lit);
  const UnoccludedIntegrator unoccluded(lit);
  const Sphere& lamp = lit.surfaces<Sphere>().at(0);
  // Where the horizon cuts the lamp, the approximation takes that for a shadow, too.
  add_row(table, options, "light of a lamp above the horizon", lit,
          [&](const Intersection& hit, const SampleIndex& pixel) -> std::optional<Color> {
            const double height = hit.height(lamp.center - hit.point());
            if (!is_black(hit.material().emission) || !(height > lamp.radius)) return std::nullopt;
            const double all = unoccluded.shade(hit, lit).g;
            const auto seen = [&](const auto& sampler) {
              return double{direct.shade(hit, lit, sampler).g} / all;
            };
            return shares(shadow.seen_share(hit.point(), lamp), pixel, half, seen);
          });
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, distances); }
