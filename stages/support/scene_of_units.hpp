// The form of a scene in which units of work are drawn.
#pragma once

#include <protostar/render.hpp>
#include <protostar/scene.hpp>

#if __has_include(<protostar/accel/accelerate.hpp>)  // a test takes the fast path away
#include <protostar/accel/accelerate.hpp>

template <class S>
using SceneOfUnits = protostar::Accelerated<S>;

/// Returns a scene that is accelerated once, for all units.
template <class S>
SceneOfUnits<S> scene_of_units(const S& scene, const protostar::RenderOptions& options) {
  return SceneOfUnits<S>(scene, options);
}
#else
template <class S>
using SceneOfUnits = S;

template <class S>
const SceneOfUnits<S>& scene_of_units(const S& scene, const protostar::RenderOptions&) {
  return scene;
}
#endif
