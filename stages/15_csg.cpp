// Draws solids made of solids, each rotated and moved to its position: a cube with holes, a bowl and a lens.
#include <protostar/any_scene.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>
#include <protostar/surfaces/instance.hpp>

#include "scenes/carved_solids.hpp"
#include "support/any_surfaces.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow"}, [](Stage& stage) {
    const Camera camera = Camera::perspective({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60);
    const auto turned = [](const Vec3& axis, double degrees) {
      return Affine{}.rotated_about(axis, degrees);
    };

    AnyScene scene;
    scene.add(Plane{.normal = {0, 1, 0}, .distance = -1.5}, Color{0.6f});
    scene.add(Instance(rounded_cube_with_holes(),
                       turned({0, 1, 0}, 35).rotated_about({1, 0, 0}, -25).moved_by({0, 0, 5})),
              Color{1, 0.3f, 0});
    scene.add(Instance(bowl(), turned({2, 0, 1}, -40).moved_by({-2.5, -0.5, 6})), Color{0.2f, 0.7f, 0.1f});
    scene.add(Instance(lens(), turned({0, 1, 0}, 75).moved_by({2.5, -0.5, 5.5})), Color{0.2f, 0.4f, 0.8f});
    scene.add(PointLight{.position = {-2, 4, 0}, .power = Color{600}});
    scene.add(AmbientLight{Color{0.1f}});

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}
