// Draws a quadric, a sphere, a box, a disk, a triangle and a parallelogram on a checkered plane.
#include <protostar/any_scene.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/triangle.hpp>

#include "support/any_surfaces.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  return run_stage(argc, argv, {.integrator = "shadow"}, [](Stage& stage) {
    const Camera camera = Camera::perspective({0, 4, -6}, {0, -3, 4}, {0, 4, 3}, 60);

    AnyScene scene;  // takes surfaces of any type
    scene.add(Plane{}, Material{.texture = Checker{.first = Color{0.6f}, .second = Color{0.25f}}});
    // 2x² + y + 2z² − 2 = 0: a hill of height 2, with radius 1 on the plane
    scene.add(Quadric{{.squares = {2, 0, 2}, .linear = {0, 0.5, 0}, .constant = -2}},
              Color{0.2f, 0.7f, 0.1f});
    scene.add(Sphere{.center = {-2.5, 0.75, -1.5}, .radius = 0.75}, Color{1, 0.3f, 0});
    scene.add(Box{.min = {1.5, 0, -2.25}, .max = {2.75, 1.25, -1}}, Color{0.2f, 0.4f, 0.8f});
    scene.add(Disk{.position = {-3, 1.25, 2}, .normal = {1, 1, -2}, .radius = 1.25}, Color{0.9f, 0.7f, 0.1f});
    scene.add(Triangle{{-1, 0, -3}, {0.75, 0, -2.5}, {0.5, 1.25, -2}}, Color{1, 0.35f, 0.5f});
    scene.add(Parallelogram{.position = {2, 0, 1.5}, .edge_u = {2, 0, -1}, .edge_v = {0.5, 1.75, 0.5}},
              Color{0.1f, 0.6f, 0.6f});
    scene.add(PointLight{.position = {-3, 6, -4}, .power = Color{550}});
    scene.add(AmbientLight{Color{0.1f}});

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}
