// An integrator of your own: a struct with one function. No library file depends on it.
#include <protostar/protostar.hpp>

#include "scenes/three_spheres.hpp"
using namespace protostar;

/// Shows each surface in its color, lit from the camera: darker where it turns away.
struct HeadlightIntegrator {
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    if (!hit) return Color{0};
    return hit->color() * static_cast<float>(-dot(hit->facing_normal(), ray.direction));
  }
};

int main() {
  const auto scene = three_spheres();
  Image image(320, 240);
  render(image, Camera{}, scene, HeadlightIntegrator{});
  save_ppm(image, "headlight.ppm");

  // A lambda is enough if the integrator is used once.
  const auto is_red = [](const Ray& ray, const Traceable auto& traceable) {
    const auto hit = traceable.intersect(ray, Interval{});
    return hit && hit->color().r > 0.5f ? Color{1, 0, 0} : Color{0};
  };
  render(image, Camera{}, scene, is_red);
  save_ppm(image, "red.ppm");
}
