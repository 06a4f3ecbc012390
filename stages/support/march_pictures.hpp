// Declares pictures by integrators that only marched scenes have, which are compiled once for all stages
// (support/march_pictures.cpp).
#pragma once

#include <protostar/any_scene.hpp>
#include <protostar/integrators/distance_occlusion.hpp>
#include <protostar/integrators/distance_shadow.hpp>
#include <protostar/integrators/enclosure_width.hpp>
#include <protostar/integrators/march_evaluations.hpp>

#include "stage.hpp"
#include "stage_render.hpp"

extern template struct StagePicture<protostar::AnyScene, protostar::DistanceOcclusionIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::DistanceShadowIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::EnclosureWidthIntegrator>;
extern template struct StagePicture<protostar::AnyScene, protostar::MarchEvaluationsIntegrator>;

/// Draws and saves the heat map of a scene's evaluations, and prints how many a ray takes.
void draw_evaluations(Stage& stage, const protostar::Camera& camera, const protostar::AnyScene& scene);

/// Draws and saves the heat map of the widths of enclosures, and prints to how many bits hits are proven.
void draw_enclosures(Stage& stage, const protostar::Camera& camera, const protostar::AnyScene& scene);
