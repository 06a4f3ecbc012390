// A light of your own: an integrator has it, and asks the scene what hides it.
#include <protostar/protostar.hpp>

#include "scenes/three_spheres.hpp"
using namespace protostar;

/// Lamp at a point that shines most straight down, by the cosine of the angle from there, and not upwards.
struct Downlight {
  Point position{0};
  double intensity = 0;  ///< power per solid angle, straight down

  /// Returns the irradiance of a surface with a unit normal, at the end of a way from the lamp.
  double irradiance(const Vec3& way, const Vec3& normal) const {
    const double distance = length(way), down = -way.y / distance, cosine = -dot(way, normal) / distance;
    return down > 0 && cosine > 0 ? intensity * down * cosine / (distance * distance) : 0;
  }
};

/// Shows matte surfaces in the light of the lamp, with shadows.
struct DownlightIntegrator : FirstHit<DownlightIntegrator> {
  Downlight lamp;

  Color shade(const auto& hit, const Traceable auto& scene) const {
    const Vec3 to_lamp = lamp.position - hit.point();
    if (scene.occluded(hit.leave(to_lamp), {.min = 0, .max = 1})) return Color{0};
    return hit.color() * static_cast<float>(lamp.irradiance(-to_lamp, hit.facing_normal()));
  }
};

int main() {
  Image image(320, 240);
  render(image, Camera{}, three_spheres(), DownlightIntegrator{{}, {.position = {0, 3, 3}, .intensity = 10}});
  save_ppm(image, "light.ppm");
}
