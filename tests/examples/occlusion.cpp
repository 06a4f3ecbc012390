// Ambient occlusion: an integrator that takes a sampler, for rays in random directions.
#include <protostar/protostar.hpp>
#include <protostar/sampling/warp.hpp>

#include "scenes/three_spheres.hpp"
using namespace protostar;

/// Shows a surface as bright as the share of the sky that its point sees. Directions near the normal are
/// drawn more often than others, as their light counts more.
struct OcclusionIntegrator : FirstHit<OcclusionIntegrator> {
  Color shade(const auto& hit, const Traceable auto& scene, const auto& sampler) const {
    const auto [u, v, w, z] = sampler(1);  // the numbers of set 1; set 0 is the place in the pixel
    const Vec3 towards = cosine_hemisphere(hit.facing_normal(), u, v).direction;
    return scene.occluded(hit.leave(towards), Interval{}) ? Color{0} : Color{1};
  }
};

int main() {
  Image image(320, 240);
  const RenderOptions options{.samples = 16, .filter = ReconstructionFilter::gaussian(), .seed = 1};
  render(image, Camera{}, three_spheres(), OcclusionIntegrator{}, options);
  save_ppm(image, "occlusion.ppm");

  // A function of a ray may take a sampler too: here each sample is a random gray.
  render(
      image, Camera{},
      [](const Ray&, const PixelSampler& sampler) { return Color(static_cast<float>(sampler(1)[0])); },
      options);
}
