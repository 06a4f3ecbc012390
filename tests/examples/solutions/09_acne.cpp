// Solution: an integrator whose shadow rays do not know what they leave.
//
// g++ -O2 -std=c++20 -I../../include -I../.. 09_acne.cpp -o 09_acne -pthread && ./09_acne
#include <cstdio>
#include <protostar/protostar.hpp>

#include "scenes/three_spheres.hpp"
using namespace protostar;

struct ForgetfulIntegrator {
  Color radiance(const Ray& ray, const auto& scene) const {
    const auto hit = scene.intersect(ray);
    if (!hit) return Color{0};
    Color irradiance{0};
    for (const Light& light : scene.lights()) {
      Ray shadow_ray = hit->leave(light.towards(hit->point()));
      shadow_ray.departure = {};  // forgets the surface
      if (scene.occluded(shadow_ray, light.occlusion_range())) continue;
      irradiance += light.irradiance(hit->point(), hit->facing_normal());
    }
    return hit->color() * irradiance;
  }
};

int main() {
  const auto scene = three_spheres();
  Image image(320, 240), exact = image;
  render(image, Camera{}, scene, ForgetfulIntegrator{});
  render(exact, Camera{}, scene, ShadowIntegrator{});
  save_ppm(image, "out.ppm", Gamma{2.2});

  int lit = 0, dark = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (exact(x, y) != Color{0}) {
        ++lit;
        dark += image(x, y) == Color{0};
      }
  std::printf("%d of 100 lit pixels go dark\n", (100 * dark + lit / 2) / lit);
}
