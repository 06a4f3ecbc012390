// Draws a mesh from a file: a knot of 3600 triangles, which looks smooth by its vertex normals.
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/plane.hpp>

#include "support/mesh_pictures.hpp"
#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const char* const file = PROTOSTAR_SCENES "/knot.obj";
  return run_stage(argc, argv, {.integrator = "shadow", .files = {file}}, [file](Stage& stage) {
    const Camera camera;
    const Mesh knot = load_mesh(file, [](const Point& p) { return 0.5 * p + Point{0, 0.25, 2.75}; });

    Scene<Mesh, Plane> scene;
    scene.add(knot, Color{0.9f, 0.5f, 0.1f});
    scene.add(Plane{.normal = {0, 1, 0}, .distance = -1.75}, Color{0.3f, 0.35f, 0.4f});
    scene.add(PointLight{.position = {-1.2, 0.5, -1.5}, .power = Color{250}});
    scene.add(AmbientLight{Color{0.08f}});
    scene.set_sky({0.05f, 0.1f, 0.2f});

    Image image = stage.image();
    render(image, camera, scene, ShadowIntegrator{}, stage.render_options());
    stage.save(image);
  });
}
