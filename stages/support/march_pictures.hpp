// Declares pictures by the integrators of marched scenes, which are compiled once for all stages
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

/// Draws and saves the heat map of the evaluations that each ray of a scene takes, and prints their range.
void draw_evaluations(Stage& stage, const protostar::Camera& camera, const protostar::AnyScene& scene);

/// Draws and saves the heat map of the bits to which each hit is proven, and prints their range.
void draw_enclosures(Stage& stage, const protostar::Camera& camera, const protostar::AnyScene& scene);
