// Draws three scenes with all integrators but Whitted's, by several cameras, and a mesh. The files have the
// same bytes for every compiler, processor, optimization level and number of threads.
//
//   pictures FOLDER THREADS

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <scenes/three_spheres.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/meshes.hpp"
#include "support/random.hpp"

using namespace protostar;
namespace fs = std::filesystem;

namespace {

/// Returns a scene of a floor, which is the same plane twice, walls, and spheres that stand on the floor,
/// touch and coincide.
Scene<Sphere, Plane, AnySurface> room() {
  Scene<Sphere, Plane, AnySurface> scene;
  scene.add(Sphere{.center = {0, 0, 4}, .radius = 1}, Color{0.9f, 0.2f, 0.1f});
  scene.add(Sphere{.center = {2, 0, 4}, .radius = 1}, Color{0.3f, 0.8f, 0.2f});
  scene.add(Sphere{.center = {0, 0, 4}, .radius = 1}, Color{0.5f, 0.5f, 0.6f});
  scene.add(Sphere{.center = {-1.7, -0.25, 3.1}, .radius = -0.75}, Color{0.7f, 0.6f, 0.1f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.6f, 0.6f, 0.6f});
  scene.add(Plane{.normal = {0, 3, 0}, .distance = -3}, Color{0.2f, 0.4f, 0.8f});
  scene.add(Plane{.normal = {0.1, 0.2, -1}, .distance = -9}, Color{0.8f, 0.7f, 0.7f});
  scene.add(AnySurface(Sphere{.center = {0.5, 1.3, 3}, .radius = 0.4}), Color{0.1f, 0.9f, 0.9f});
  scene.add(AnySurface(Plane{.normal = {1, 0.01, 0}, .distance = 3.3}), Color{0.9f, 0.9f, 0.4f});
  scene.add(PointLight{.position = {1, 4, 1}, .power = Color{300, 290, 250}});
  scene.add(PointLight{.position = {-2, 2.5, 0}, .power = Color{50, 60, 80}});
  return scene;
}

/// Returns a scene of so many spheres that tiles and shadow rays find them through their own data structures.
Scene<Sphere> many() {
  Random random(1);
  Scene<Sphere> scene;
  for (int i = 0; i < 200; ++i) {
    // In separate statements, because compilers evaluate the arguments of a call in different orders.
    const Sphere sphere{.center = Vec3{0, 0, 5} + random.point(3), .radius = random.real(0.05, 0.5)};
    const Color color = random.color();
    scene.add(sphere, color);
  }
  scene.add(PointLight{.position = {1, 4, 1}, .power = Color{300, 290, 250}});
  return scene;
}

/// Returns a scene of a mesh with smooth normals, and a sphere that intersects it.
Scene<Mesh, Sphere> smooth() {
  MeshData ball = meshes::icosphere(4);
  ball.normals = ball.vertices;
  for (Point& vertex : ball.vertices) vertex += Vec3{0.3, 0.1, 3};
  Scene<Mesh, Sphere> scene;
  scene.add(Mesh(std::move(ball)), Color{0.9f, 0.5f, 0.1f});
  scene.add(Sphere{.center = {1, 0, 3}, .radius = 0.75}, Color{0.2f, 0.7f, 0.1f});
  return scene;
}

void save_pictures(const fs::path& folder, const std::string& name, const auto& scene,
                   const RenderOptions& options, const Camera& camera = {}) {
  const auto save = [&](const std::string& what, const auto& integrator) {
    Image image(160, 120);
    render(image, camera, scene, integrator, options);
    save_pfm(image, folder / (name + "_" + what + ".pfm"));
    if (what != "shadow") return;
    save_ppm(image, folder / (name + "_8.ppm"));
    save_ppm(image, folder / (name + "_16.ppm"), Gamma{}, {.bits = 16});
  };
  save("binary", BinaryIntegrator{});
  save("depth", DepthIntegrator{});
  save("normal", NormalIntegrator{});
  save("color", ColorIntegrator{});
  save("diffuse", DiffuseIntegrator{});
  save("transparency", TransparencyIntegrator{});
  save("shadow", ShadowIntegrator{});
}

/// Writes the hits in double, in which differences show that mostly vanish by rounding in pictures.
void save_hits(const fs::path& path, const auto& scene) {
  std::vector<double> numbers;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x)
      scene.crossings(Camera{}.through_pixel(x, y, 160, 120), Interval{}, [&](const Intersection& hit) {
        const Point point = hit.point();
        const Vec3 normal = hit.normal();
        numbers.insert(numbers.end(),
                       {hit.t, hit.refined(), point.x, point.y, point.z, normal.x, normal.y, normal.z});
      });
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const fs::path folder = argv[1];
  const RenderOptions options{.threads = std::atoi(argv[2])};
  fs::create_directories(folder);
  save_pictures(folder, "three_spheres", three_spheres(), options);
  save_pictures(folder, "room", room(), options);
  Image of_mesh(160, 120);
  render(of_mesh, Camera{}, smooth(), NormalIntegrator{}, options);
  save_pfm(of_mesh, folder / "smooth_normal.pfm");
  const auto spheres = many();
  const Vec3 ahead{0, 0, 1}, up{0, 1, 0};
  save_pictures(folder, "many", spheres, options);
  save_pictures(folder, "many_looked_at", spheres, options, Camera::look_at({3, 2, 0}, {0, 0, 5}, up, 50));
  save_pictures(folder, "many_sensor", spheres, options, Camera::sensor({0, 0, 4}, ahead, up, 0.7));
  save_pictures(folder, "many_orthographic", spheres, options, Camera::orthographic(Point{0}, ahead, up, 7));
  save_hits(folder / "three_spheres.hits", three_spheres());
  save_hits(folder / "room.hits", room());
}
