// Light by chance whose truth is known in each pixel without sampling.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <protostar/image.hpp>
#include <protostar/ray.hpp>
#include <protostar/sampling/pixel_sampler.hpp>
#include <protostar/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

/// Light of a pixel as a function of the numbers of its samples, and its mean. The pixel is told by a share
/// between 0 and 1, by its place in its row.
struct KnownLight {
  static constexpr int width = 24, height = 16;

  std::string name;
  std::function<float(double share, const protostar::SampleSet<double>&)> light;
  std::function<double(double share)> mean;

  [[nodiscard]] static double share_of(std::uint32_t x) { return (x + 0.5) / width; }

  /// Returns the light of a sample, in channels of different brightness.
  [[nodiscard]] protostar::Color operator()(const protostar::Ray&,
                                            const protostar::PixelSampler& sampler) const {
    const float value = light(share_of(sampler.index().x), sampler(1));
    return {value, 0.5f * value, 0.25f * value};
  }

  /// Returns the squared error of a picture: the mean over pixels and channels.
  [[nodiscard]] double squared_error(const protostar::Image& image) const {
    double sum = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double truth = mean(share_of(static_cast<std::uint32_t>(x)));
        const protostar::Color color = image(x, y);
        for (const auto& [channel, share] : {std::pair{color.r, 1.0}, {color.g, 0.5}, {color.b, 0.25}})
          sum += (channel - share * truth) * (channel - share * truth);
      }
    return sum / (3.0 * width * height);
  }

  /// Returns the largest error of any channel of any pixel.
  [[nodiscard]] double largest_error(const protostar::Image& image) const {
    double largest = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        largest = std::max(largest, std::abs(image(x, y).r - mean(share_of(static_cast<std::uint32_t>(x)))));
    return largest;
  }
};

/// Returns lights as pictures have them: a curved edge; a smooth light; a diffuse wall inside a sphere that
/// glows, lit by the direction of two numbers (the mean over all places of the sphere); a penumbra; a bright
/// thing that few samples meet.
inline std::vector<KnownLight> known_lights() {
  return {
      {"edge", [](double s, const auto& n) { return n[0] * n[1] < s ? 1.0f : 0.0f; },
       [](double s) { return s - s * std::log(s); }},
      {"smooth", [](double s, const auto& n) { return static_cast<float>(s * (n[0] + n[1] + n[2] * n[3])); },
       [](double s) { return 1.25 * s; }},
      {"furnace",
       [](double s, const auto& n) {
         const double z = 1 - 2 * n[0], y = std::sqrt(1 - z * z) * std::sin(2 * std::numbers::pi * n[1]);
         return static_cast<float>(s * (0.2 + 0.9 * y * y + 0.1 * z));
       },
       [](double s) { return 0.5 * s; }},
      {"penumbra",
       [](double s, const auto& n) { return n[0] + n[1] < 2 * s ? static_cast<float>(n[2]) : 0.0f; },
       [](double s) { return 0.5 * (s < 0.5 ? 2 * s * s : 1 - 2 * (1 - s) * (1 - s)); }},
      {"rare", [](double, const auto& n) { return n[0] < 0.004 ? 1.0f : 0.1f; },
       [](double) { return 0.1036; }},
  };
}
