// Draws each surface in its color, lit from the camera: darker where it turns away.
#include <protostar/render.hpp>

#include "scenes/three_spheres.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "headlight"}, [](Stage& stage) {
    const Camera camera;
    const auto scene = three_spheres();
    const auto headlight = [](const Ray& ray, const Traceable auto& spheres) {
      const auto hit = spheres.intersect(ray, Interval{});
      return hit ? hit->color() * static_cast<float>(-dot(hit->facing_normal(), ray.direction)) : Color{0};
    };

    Image image = stage.image();
    render(image, camera, scene, headlight, stage.render_options());
    stage.save(image);
  });
}
