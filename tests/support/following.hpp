// Integrator for packets that shades the closest hit by follow.
#pragma once

#include <protostar/ray.hpp>
#include <protostar/scene.hpp>
#include <protostar/vec3.hpp>

/// Integrator that takes packets and has no function shade: follow traces the rays, and shades their closest
/// hits by color and distance.
struct Following {
  using TakesPackets = Following;

  template <class R>
  [[nodiscard]] typename R::Light radiance(const R& ray, const auto& scene) const {
    using protostar::to_float;  // and that of packets, which is found by its argument
    return protostar::follow(
        ray, scene, [] { return protostar::Color{0.5f}; },
        [](const auto& hit) { return hit.color() * to_float(1 / hit.t); });
  }
};
