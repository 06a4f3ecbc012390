// The pictures of scene files, compiled apart from the program that draws them, each kind in a file of its
// own.
#pragma once

#include <filesystem>
#include <protostar/io/scene_file.hpp>
#include <protostar/render.hpp>
#include <string>

/// Reads a scene file, as protostar::read_scene does.
protostar::SceneFile read_scene_file(const std::filesystem::path& path);

/// Fills an image with what a scene's camera sees, by the integrator of that name.
void draw(protostar::Image& image, const protostar::SceneFile& file, const std::string& integrator,
          const protostar::RenderOptions& options);

/// The integrators that shade what is met first, and the others.
void draw_first_hits(protostar::Image& image, const protostar::SceneFile& file, const std::string& integrator,
                     const protostar::RenderOptions& options);
void draw_binary(protostar::Image& image, const protostar::SceneFile& file,
                 const protostar::RenderOptions& options);
void draw_transparency(protostar::Image& image, const protostar::SceneFile& file,
                       const protostar::RenderOptions& options);
void draw_whitted(protostar::Image& image, const protostar::SceneFile& file,
                  const protostar::RenderOptions& options);
