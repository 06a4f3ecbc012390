// Shows how much of the space over surfaces is free, by rays that are drawn by chance.
#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>

#include "../lobes.hpp"
#include "../render.hpp"
#include "../sampling/sampler.hpp"
#include "../shown.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of ambient occlusion: the share of the light of a white sky that comes to a hit, where only
/// surfaces within a distance are in its way,
///   1/π ∫ V cos θ dω,
/// with the visibility V, 1 or 0, of the sky along a direction. White if there is no hit. It is the light of
/// PathIntegrator on white surfaces in a white sky after one bounce, at the surface that is seen.
struct AmbientOcclusionIntegrator : FirstHit<AmbientOcclusionIntegrator> {
  /// Says that camera rays may be traced in packets (accel/packet_integrator.hpp). It names its own type.
  using ShadesEachHit = AmbientOcclusionIntegrator;

  /// Distance in scene units from which on surfaces occlude nothing.
  double distance = std::numeric_limits<double>::infinity();

  AmbientOcclusionIntegrator() = default;
  explicit AmbientOcclusionIntegrator(double farthest) : distance(farthest) {}

  /// Throws std::invalid_argument unless the distance is greater than 0. render calls it.
  void validate() const {
    if (!(distance > 0)) [[unlikely]]
      throw std::invalid_argument("AmbientOcclusionIntegrator: distance must be greater than 0; it is " +
                                  shown(distance));
  }

  [[nodiscard]] Color background(const auto&, const auto&) const { return Color{1}; }

  /// Returns the light of the sky along one direction, drawn by two numbers of the sampler's set 1: white, or
  /// black where a surface within the distance is in its way.
  [[nodiscard]] Color shade(const Intersection& hit, const auto& scene, const auto& sampler) const {
    const Bounce bounce = DiffuseLobe{Color{1}}.sample(Vertex(hit), sampler(1));
    const bool sees_sky =
        bounce.goes_on() && !scene.occluded(hit.leave(bounce.direction), Interval{.min = 0, .max = distance});
    return sees_sky ? bounce.weight : Color{0};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
