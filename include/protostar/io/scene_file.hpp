// What a scene file holds: a scene, a camera, and how the picture is drawn. It says nothing about the file's
// form.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "../camera.hpp"
#include "../encode.hpp"
#include "../scene.hpp"
#include "../surfaces/any_surface.hpp"
#include "../surfaces/parallelogram.hpp"
#include "../surfaces/plane.hpp"
#include "../surfaces/sphere.hpp"
#include "../tone.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// The integrators that a file can ask for.
inline constexpr std::array<std::string_view, 8> integrator_names{
    "binary", "depth", "normal", "color", "diffuse", "transparency", "shadow", "whitted"};

/// The most that a file can ask for. WhittedIntegrator calls itself for each ray of a path, so that the depth
/// is held below what fits on a thread's stack, of which Linux gives 8 MB.
inline constexpr int most_samples = 1 << 16, most_depth = 1000;

/// A scene, and the settings of its picture; they begin with what a file need not say.
struct SceneFile {
  Scene<Sphere, Plane, Parallelogram, AnySurface> scene;
  Camera camera;
  int width = 640, height = 480;       ///< in pixels
  int samples = 0;                     ///< in a pixel; 0: its center
  int depth = 10;                      ///< WhittedIntegrator's
  std::string integrator = "whitted";  ///< one of integrator_names
  Transfer transfer = Srgb{};
  Tone tone = Tone::clip;
  double exposure = 1;  ///< a factor on the light, before tone and transfer
};

}  // namespace protostar::inline PROTOSTAR_ABI
