// Reads and draws scene files; compiled apart from the program that does so.
#pragma once

#include <filesystem>
#include <protostar/io/read_options.hpp>
#include <protostar/io/scene_file.hpp>
#include <string>

#include "stage_render.hpp"

/// Reads a scene file, as protostar::read_scene does.
protostar::SceneFile read_scene_file(const std::filesystem::path& path,
                                     const protostar::ReadOptions& options = {});

/// Draws the view of a scene's camera into an image, by the integrator of that name.
void draw(protostar::Image& image, const protostar::SceneFile& file, const std::string& integrator,
          const StageRenderOptions& options);
