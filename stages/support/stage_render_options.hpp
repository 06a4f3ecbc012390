// Options of render for a stage: those of any program, and what else the stage is asked for.
#pragma once

#include <functional>
#include <protostar/render_options.hpp>
#include <protostar/sampling/shard.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <utility>

struct Explanation;
struct SampleRecord;
class SharedRender;

/// Options of render for a stage.
struct StageRenderOptions : protostar::RenderOptions {
  StageRenderOptions(protostar::RenderOptions common) : RenderOptions(std::move(common)) {}

  bool draws = true;                   ///< true if the picture is needed
  Explanation* explanation = nullptr;  ///< if given, a pixel is explained

  /// Sphere that a function of a ray intersects, if that is all that it does; for the explanation.
  const protostar::Sphere* sphere = nullptr;

  /// Tells the steps of a function of a ray for the ray of a sample; for the explanation.
  std::function<void(SampleRecord&)> tell = {};

  SharedRender* shared = nullptr;         ///< if given, the work is drawn in units
  protostar::SharedPicture picture = {};  ///< with this fingerprint and finish
};
