// Pictures of meshes by tiles, which rasterize them, are those drawn ray by ray.
#include <array>
#include <cmath>
#include <cstring>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <type_traits>
#include <utility>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/following.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// Scene type of all tests, since every integrator is compiled anew for each type of scene.
using SpheresAndMeshes = Scene<Sphere, Mesh>;

/// Returns the number of pixels that differ between the plain scene, ray by ray, and tiles.
int drawn_otherwise(const SpheresAndMeshes& scene, const Camera& camera, const auto& integrator,
                    RenderOptions options = {}, int width = 75, int height = 70) {
  Image plain(width, height), tiles(width, height);
  options.tiles = false;
  render(
      plain, camera, [&](const Ray& ray) { return integrator.radiance(ray, scene); }, options);
  options.tiles = true;
  render(tiles, camera, scene, integrator, options);
  return different_bytes(plain, tiles);
}

Mesh mesh_of(const MeshData& data) { return Mesh(data, {.threads = 1}); }

/// Returns a scene of meshes, smooth and flat, colored and textured, one of glass that also mirrors, and a
/// sphere.
SpheresAndMeshes many_things() {
  SpheresAndMeshes scene;
  MeshData ball = meshes::moved(meshes::icosphere(3), 0.9, {-0.8, 0, 4});
  for (const Point& p : ball.vertices) ball.normals.push_back(p - Vec3{-0.8, 0, 4});
  for (const Point& p : ball.vertices) ball.uvs.push_back({p.x, p.y * p.z});
  Material checkered;
  checkered.texture = Checker{.first = Color{1}, .second = Color{0.1f}, .size = 0.25};
  scene.add(mesh_of(ball), checkered);
  scene.add(mesh_of(meshes::moved(meshes::torus(30, 12), 0.7, {0.9, 0, 4.2})), Color{0.2f, 0.7f, 0.3f});
  Material glass{.diffuse = Color{0.1f}, .reflect = 0.4, .refract = 0.5, .ior = 1.5};
  scene.add(mesh_of(meshes::moved(meshes::icosphere(2), 0.5, {0.2, -0.7, 2.9})), glass);
  // The torus once more in the same place, hence at equal t, and a sphere in between.
  scene.add(mesh_of(meshes::moved(meshes::torus(30, 12), 0.7, {0.9, 0, 4.2})), Color{1, 0, 0});
  scene.add(Sphere{.center = {0.9, 0, 4.2}, .radius = 0.6}, Color{0.3f, 0.3f, 0.9f});
  scene.add(PointLight{.position = {1, 4, 1}, .power = Color{400}});
  return scene;
}

/// Returns random triangles of all sizes, some of them twice, and some again slightly displaced.
MeshData soup(Random& random, int count, double size) {
  MeshData data;
  for (int i = 0; i < count; ++i) {
    const Point at = random.point(1);
    const double reach = size * std::exp2(random.real(-3, 0));
    for (int k = 0; k < 3; ++k) data.vertices.push_back(at + reach * random.point(1));
    const auto first = static_cast<std::uint32_t>(data.vertices.size() - 3);
    data.triangles.push_back({first, first + 1, first + 2});
    if (i % 9 == 0) data.triangles.push_back({first + 1, first, first + 2});
    if (i % 11 == 0) data.triangles.push_back({first + 1, first, first + 1});
    if (i % 3 != 0) continue;
    for (std::uint32_t k = 0; k < 3; ++k)
      data.vertices.push_back(data.vertices[first + k] + reach * std::exp2(-20 - i % 10) * random.point(1));
    data.triangles.push_back({first + 3, first + 5, first + 4});
  }
  return data;
}

}  // namespace

TEST_CASE("by tiles, meshes among other surfaces have the same picture as ray by ray") {
  const SpheresAndMeshes scene = many_things();
  const Camera camera{.position = {0, 0.2, 0}};
  CHECK(drawn_otherwise(scene, camera, BinaryIntegrator{}) == 0);
  CHECK(drawn_otherwise(scene, camera, NormalIntegrator{}) == 0);
  CHECK(drawn_otherwise(scene, camera, TransparencyIntegrator{}) == 0);
  CHECK(drawn_otherwise(scene, camera, TransparencyIntegrator{}, {.samples = 3}) == 0);
  CHECK(drawn_otherwise(scene, camera, WhittedIntegrator{.depth = 5}) == 0);
  CHECK(drawn_otherwise(scene, camera, Following{}) == 0);
}

TEST_CASE(
    "by tiles, meshes have the same picture as ray by ray for any camera, for crops and for several samples "
    "a pixel") {
  const SpheresAndMeshes scene = many_things();
  const Vec3 ahead{0, 0, 1}, up{0, 1, 0};
  for (const Camera& camera :
       {Camera::sensor(Point{0}, ahead, up, 0.5), Camera::viewport(Point{0}, ahead, up, 2, 2, 3.5),
        Camera::orthographic(Point{0}, ahead, up, 3), Camera{.position = {-0.8, 0, 4}},  // inside the ball
        Camera{.right = {1, 0.5, 0}, .up = {0.2, -1, 0}, .forward = {0.3, 0, 1.2}},
        Camera{.right = {1, 0, 0}, .up = {0, 1, 0}, .forward = {0.9999, 0, 0.01}}}) {
    CHECK(drawn_otherwise(scene, camera, NormalIntegrator{}) == 0);
    CHECK(drawn_otherwise(scene, camera, NormalIntegrator{}, {.samples = 3}) == 0);
  }
  const RenderOptions part{.crop = {.x = 211, .y = 163, .width = 500, .height = 400}};
  CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, part) == 0);
  for (const int samples : {2, 4, 9})
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, {.samples = samples}) == 0);
}

TEST_CASE("by tiles, rays that are aimed at edges and vertices of a mesh have the same hits as ray by ray") {
  // With 64 × 64 pixels, centers are at odd multiples of 1/64 on the film: at distance 2, rays of this camera
  // pass through vertices of the grid, and of the straight one through its diagonals.
  const Camera camera{.position = {0.03125, 0.03125, -4}};
  for (const double scale : {0.25, 1.0}) {
    if (scale == 1 && cases(0, 1, 1) == 0) continue;
    SpheresAndMeshes scene, alone;
    scene.add(mesh_of(meshes::moved(meshes::box(4), scale, {0, 0, 0})), Color{1});
    for (const double z : {-3.0, -2.0}) {
      MeshData grid;
      for (std::uint32_t y = 0; y < 33; ++y)
        for (std::uint32_t x = 0; x < 33; ++x) {
          grid.vertices.push_back({(x - 16.0) / 16, (y - 16.0) / 16, z});
          const std::uint32_t i = 33 * y + x;
          if (x == 32 || y == 32 || (x + y) % 3 == 0) continue;
          grid.triangles.push_back({i, i + 1, i + 34});
          grid.triangles.push_back({i, i + 34, i + 33});
        }
      scene.add(mesh_of(grid), Color{static_cast<float>(-z), 1, 1});
      if (alone.size() == 0) alone.add(mesh_of(grid), Color{1});
    }
    Camera straight = camera;
    straight.position = {0, 0, -4};
    for (const Camera& one : {camera, straight}) {
      CHECK(drawn_otherwise(scene, one, NormalIntegrator{}, {}, 64, 64) == 0);
      CHECK(drawn_otherwise(scene, one, NormalIntegrator{}, {}, 65, 65) == 0);
      CHECK(drawn_otherwise(alone, one, ColorIntegrator{}, {}, 64, 64) == 0);
      CHECK(drawn_otherwise(scene, one, BinaryIntegrator{}, {}, 64, 64) == 0);
      CHECK(drawn_otherwise(scene, one, TransparencyIntegrator{}, {}, 64, 64) == 0);
    }
  }
}

TEST_CASE("by tiles, triangles of any size around a camera have the same picture as ray by ray") {
  Random random(51);
  int drawn = 0;
  std::uint64_t in_doubt = 0;
  const int rounds = cases(15, 30);  // each factor below occurs in both forms
  for (int round = 0; round < rounds; ++round) {
    const double size = std::exp2(random.real(-9, 1)), scale = std::exp2(random.real(-30, 30));
    const Vec3 offset = round % 3 == 0 ? scale * 1e4 * random.point(1) : Vec3{0};
    const Mesh mesh = mesh_of(meshes::moved(soup(random, round % 3 == 1 ? 2000 : 200, size), scale, offset));
    SpheresAndMeshes scene;
    scene.add(mesh, Color{1});
    if (round % 4 == 0) scene.add(mesh, Color{2});
    Camera camera = Camera::look_at(offset + scale * random.point(round % 2 == 0 ? 3 : 0.5),
                                    offset + scale * random.point(0.2), random.direction(),
                                    round % 5 == 0 ? 2 : random.real(20, 110));
    if (round % 7 == 0) camera.forward *= 1e-3, camera.right *= 1e-3, camera.up *= 1e-3;
    Image plain(cases(49, 97), cases(33, 66)), tiles(plain.width(), plain.height());
    RenderStatistics taken;
    render(tiles, camera, scene, NormalIntegrator{}, {.threads = 1, .statistics = &taken});
    render(plain, camera, scene, NormalIntegrator{}, {.tiles = false});
    CAPTURE(round);
    CHECK(different_bytes(plain, tiles) == 0);
    if (round % 4 != 0) in_doubt += taken.in_doubt;
    // In one color no t is needed.
    render(tiles, camera, scene, ColorIntegrator{}, {.threads = 1});
    render(plain, camera, scene, ColorIntegrator{}, {.tiles = false});
    CHECK(different_bytes(plain, tiles) == 0);
    drawn += count_pixels(plain, [&](int x, int y) { return plain(x, y) != Color{0}; });
  }
  CHECK(drawn > cases(250, 1000) * rounds);
  CHECK(in_doubt < 20000);
}

TEST_CASE("by tiles, triangles whose edges pass through pixel centers have the same picture as ray by ray") {
  // Up to rounding in double, edges pass through pixel centers: no filter can decide on which side these are.
  constexpr int size = 80;
  Random random(53);
  int drawn = 0;
  for (int round = 0; round < 60; ++round) {
    const Camera camera = Camera::look_at(random.point(9), random.point(1), random.direction(), 70);
    const double length = std::exp2(random.real(-6, 0));
    MeshData data;
    for (std::uint32_t i = 0; i < 40; ++i) {
      const auto [x, y] = std::pair(random.bits() % size, random.bits() % size);
      const Ray middle = camera.through_pixel(static_cast<int>(x), static_cast<int>(y), size, size);
      const Vec3 along = length * random.point(1), aside = length * random.point(1);
      data.vertices.push_back(middle.at(random.real(2, 3)) + along);
      data.vertices.push_back(middle.at(random.real(2, 3)) - random.real(0.1, 1) * along);
      data.vertices.push_back(middle.at(2.5) + aside);
      data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    SpheresAndMeshes scene;
    scene.add(mesh_of(data), Color{1});
    CAPTURE(round);
    CHECK(drawn_otherwise(scene, camera, ColorIntegrator{}, {}, size, size) == 0);
    CHECK(drawn_otherwise(scene, camera, DepthIntegrator{}, {}, size, size) == 0);
    Image image(size, size);
    render(image, camera, scene, BinaryIntegrator{});
    drawn += count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; });
  }
  CHECK(drawn > 10000);
}

TEST_CASE("by tiles, meshes of sizes beyond the range of float have the same picture as ray by ray") {
  for (const double size : {0x1p-300, 0x1p-100, 0x1p100, 0x1p300}) {
    CAPTURE(size);
    SpheresAndMeshes scene;
    scene.add(mesh_of(meshes::moved(meshes::icosphere(1), size, {0, 0, 3 * size})), Color{1});
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, {}, 20, 15) == 0);
    scene.add(mesh_of(meshes::icosphere(1)), Color{1});
    CHECK(drawn_otherwise(scene, Camera{.position = {0, 0, -3}}, NormalIntegrator{}, {}, 20, 15) == 0);
  }
}

TEST_CASE("by tiles, triangles behind the eye are not seen, and others as far as they are in front of it") {
  // All in one leaf: a small triangle in front; one behind, whose mirror image would fill the picture; and
  // one that begins in front and ends behind.
  MeshData data;
  data.vertices = {{-1, 0, 3},  {-0.5, 0, 3}, {-0.5, 0.5, 3}, {-9, -9, -2}, {9, -9, -2},
                   {0, 18, -2}, {0.5, -1, 4}, {1.5, -1, 4},   {0.5, -1, -4}};
  const std::array<std::uint32_t, 3> triangles[] = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  for (int which = 1; which < 8; ++which) {
    data.triangles.clear();
    for (int i = 0; i < 3; ++i)
      if ((which >> i & 1) != 0) data.triangles.push_back(triangles[i]);
    SpheresAndMeshes scene;
    scene.add(mesh_of(data), Color{0.5f});
    RenderStatistics taken;
    CHECK(drawn_otherwise(scene, Camera{}, ColorIntegrator{}, {.statistics = &taken}) == 0);
    CHECK(taken.in_doubt < 100);
    CHECK(drawn_otherwise(scene, Camera{}, BinaryIntegrator{}) == 0);
    CHECK(drawn_otherwise(scene, Camera{}, TransparencyIntegrator{}) == 0);
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}) == 0);
  }
}

TEST_CASE(
    "by tiles, more meshes than a tile rasterizes, and thousands, have the same picture as ray by ray") {
  Random random(52);
  const MeshData ball = meshes::icosphere(0);
  for (const int count : {30, 2100}) {
    SpheresAndMeshes scene;
    for (int i = 0; i < count; ++i)
      scene.add(mesh_of(meshes::moved(ball, 0.1, Vec3{0, 0, 3} + random.point(1))), random.color());
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, {}, 30, 20) == 0);
  }
}

TEST_CASE("a tile with many more triangles than pixels is traced ray by ray, with the same picture") {
  SpheresAndMeshes scene;
  scene.add(mesh_of(meshes::moved(meshes::icosphere(5), 1, {0, 0, 3})), Color{1});
  for (const int size : {8, 24, 100}) {
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, {.samples = 2}, size, size) == 0);
    CHECK(drawn_otherwise(scene, Camera{}, ColorIntegrator{}, {}, size, size) == 0);
  }
}

TEST_CASE("a tile that exceeds its limit of tested triangles is traced ray by ray, with the same picture") {
  // Needles, which hide little of each other, in front of a large triangle.
  MeshData data;
  Random random(9);
  const auto add = [&](const Point& a, const Point& b, const Point& c) {
    const auto first = static_cast<std::uint32_t>(data.vertices.size());
    data.vertices.insert(data.vertices.end(), {a, b, c});
    data.triangles.push_back({first, first + 1, first + 2});
  };
  const auto near_the_axis = [&](double z) {
    return Point{random.real(-0.03, 0.03), random.real(-0.03, 0.03), z};
  };
  for (int i = 0; i < 20'000; ++i) {
    const Point tip = near_the_axis(random.real(3, 4)), end = near_the_axis(tip.z);
    add(tip, end, end + Vec3{1e-5, 1e-5, 0});
  }
  add({-9, -9, 5}, {9, -9, 5}, {0, 9, 5});
  SpheresAndMeshes scene;
  scene.add(mesh_of(data), Color{1});
  const RenderOptions part{.crop = {.x = 504, .y = 504, .width = 1024, .height = 1024}};
  CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, part, 16, 16) == 0);
  CHECK(drawn_otherwise(scene, Camera{}, ColorIntegrator{}, part, 16, 16) == 0);
}

TEST_CASE("tiles that are drawn one after the other in the same buffers show nothing of the one before") {
  // Some tiles see nothing but a mesh, of which no t is needed, some a sphere as well; tiles at the
  // edges are smaller.
  SpheresAndMeshes scene;
  scene.add(mesh_of(meshes::moved(meshes::torus(30, 12), 0.7, {0, 0, 3})), Color{0.2f, 0.7f, 0.3f});
  scene.add(Sphere{.center = {0.8, 0.2, 2.5}, .radius = 0.1}, Color{1});
  for (const int width : {300, 333})
    CHECK(drawn_otherwise(scene, Camera{}, ColorIntegrator{}, {.threads = 1}, width, 270) == 0);
}

TEST_CASE("by tiles triangles that almost touch the eye have the same picture as ray by ray") {
  for (const double size : {1e-310, 1e-300, 1e-200, 1e-100}) {
    MeshData data;
    data.vertices = {{-9, -9, 5},      {9, -9, 5},         {0, 18, 5},
                     {0, -size, size}, {size, size, size}, {2 * size, 0, size}};
    data.triangles = {{0, 1, 2}, {3, 4, 5}};
    SpheresAndMeshes scene;
    scene.add(mesh_of(data), Color{1});
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}) == 0);
    CHECK(drawn_otherwise(scene, Camera{}, ColorIntegrator{}) == 0);
  }
}

TEST_CASE(
    "by tiles, a mesh alone has the same picture as ray by ray, in one color, with a texture, under a sky") {
  const Camera camera{.position = {0.2, 0.1, 0}};
  const Texture checker = Checker{.first = Color{1, 0.5f, 0}, .second = Color{0.1f}, .size = 0.25};
  // The torus in front of the eye, far away, and around the eye, where some vertices are behind it.
  for (const Point& center : {Point{0.4, 0, 3}, Point{0, 0, 40}, Point{0.9, 0, 0.2}})
    for (const bool has_texture : {false, true})
      for (const int sky : {0, 1, 2}) {
        SpheresAndMeshes scene;
        Material material{.diffuse = {0.2f, 0.7f, 0.3f}};
        if (has_texture) material.texture = checker;
        scene.add(mesh_of(meshes::moved(meshes::torus(30, 12), 0.7, center)), material);
        if (sky == 1) scene.set_sky(Color{0.1f, 0.2f, 0.3f});
        if (sky == 2) scene.set_environment(checker);
        CHECK(drawn_otherwise(scene, camera, ColorIntegrator{}) == 0);
        CHECK(drawn_otherwise(scene, camera, NormalIntegrator{}) == 0);
      }
}

TEST_CASE("a tile that sees nothing but a mesh of one color takes no rays") {
  const auto skipped = [](const SpheresAndMeshes& scene) {
    Image image(64, 64);
    RenderStatistics taken;
    render(image, Camera{}, scene, ColorIntegrator{}, {.statistics = &taken});
    CHECK(taken.pixels_skipped + taken.camera_rays == 64 * 64);
    return static_cast<int>(taken.pixels_skipped);
  };
  MeshData wall;
  wall.vertices = {{-90, -90, 9}, {90, -90, 9}, {0, 180, 9}};
  wall.triangles = {{0, 1, 2}};
  SpheresAndMeshes alone, textured, with_ball;
  alone.add(mesh_of(wall), Color{1});
  CHECK(skipped(alone) == 64 * 64);
  Material material;
  material.texture = Checker{.first = Color{1}, .second = Color{0.1f}, .size = 0.25};
  textured.add(mesh_of(wall), material);
  CHECK(skipped(textured) == 0);
  with_ball.add(mesh_of(wall), Color{1});
  with_ball.add(Sphere{.center = {0, 0, 3}, .radius = 0.2}, Color{1});
  const int beside_ball = skipped(with_ball);
  CHECK((beside_ball > 1000 && beside_ball < 64 * 64 - 10));
}

TEST_CASE("by tiles, parts with many surfaces in front of a mesh have the same picture as ray by ray") {
  // Spheres in the upper rows of each part of 8 × 8 pixels; its last row sees nothing but the mesh.
  SpheresAndMeshes scene;
  MeshData wall;
  wall.vertices = {{-90, -90, 9}, {90, -90, 9}, {0, 180, 9}};
  wall.triangles = {{0, 1, 2}};
  scene.add(mesh_of(wall), Color{1, 1, 0});
  const Camera camera;
  for (int y = 0; y < 64; y += 8)
    for (int x = 0; x < 64; x += 8)
      for (int i = 0; i < 20; ++i) {
        const Ray ray = camera.through_pixel(x + i % 7, y + i / 7, 64, 64);
        scene.add(Sphere{.center = ray.at(4), .radius = 0.01}, Color{0.01f * static_cast<float>(i), 0, 1});
      }
  CHECK(drawn_otherwise(scene, camera, ColorIntegrator{}, {}, 64, 64) == 0);
}

TEST_CASE("by tiles, a needle has the same depth as ray by ray") {
  // A needle 2^23 times as long as it is wide: double leaves t in doubt, but not which pixels its wide end
  // covers.
  const Vec3 ahead = normalize(Vec3{1, 2, 3}), right = normalize(Vec3{2, -1, 0}), up = cross(ahead, right);
  const double width = 0x1p-14;
  MeshData needle;
  needle.vertices = {-0x1p10 * right, -width * up, width * up};
  needle.triangles = {{0, 1, 2}};
  SpheresAndMeshes scene;
  scene.add(mesh_of(needle), Color{1});
  const Camera camera{.position = -width * ahead, .right = right, .up = up, .forward = ahead};
  CHECK(drawn_otherwise(scene, camera, DepthIntegrator{}) == 0);
  Image image(16, 16);
  render(image, camera, scene, ColorIntegrator{});
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) == Color{1}; }) > 100);
}

TEST_CASE("by tiles, a floor at a grazing angle has the same depth as ray by ray") {
  // The eye is 1 above the floor: most pixels see it at angles of 2^-20 and less, where n·d leaves t in
  // doubt.
  const Vec3 up = normalize(Vec3{1, 2, 3}), ahead = normalize(Vec3{2, -1, 0}), right = cross(up, ahead);
  const double far = 0x1p22;
  MeshData floor;
  floor.vertices = {-ahead, far * (ahead - 0.125 * right), far * (ahead + 0.125 * right)};
  floor.triangles = {{0, 1, 2}};
  SpheresAndMeshes scene;
  scene.add(mesh_of(floor), Color{1});
  const Camera camera{.position = up, .right = 0x1p-4 * right, .up = 0x1p-15 * up, .forward = ahead};
  RenderStatistics taken;
  CHECK(drawn_otherwise(scene, camera, DepthIntegrator{}, {.statistics = &taken}) == 0);
  CHECK(taken.in_doubt > 1000);
}

TEST_CASE("in a packet that leaves a mesh, each ray departs from its own triangle") {
  const Mesh mesh = mesh_of(meshes::torus(30, 12));
  const simd::Indices parts = simd::Indices::of_each([](int lane) { return 7 * lane; });
  const simd::RayPacket rays(simd::Vectors(Point{0}), simd::Vectors(Vec3{0, 0, 1}), true, &mesh,
                             functions_of<Mesh>, parts);
  const simd::RayPacket turned = rays.with_direction(simd::Vectors(Vec3{0, 1, 0}));
  CHECK(rays.leave_primitives());
  CHECK_FALSE(simd::RayPacket(simd::Vectors(Point{0}), simd::Vectors(Vec3{0, 0, 1})).leave_primitives());
  for (int lane = 0; lane < simd::double_lanes; ++lane) {
    CHECK(rays[lane].departure == mesh.departure(7 * lane));
    CHECK(turned[lane].departure == mesh.departure(7 * lane));
    CHECK(turned[lane].departure.surface == &mesh);
  }
}

TEST_CASE("a tile that rasterizes a mesh leaves few rays in doubt") {
  SpheresAndMeshes scene;
  MeshData ring = meshes::torus(300, 60);
  scene.add(mesh_of(ring), Color{1});
  const Camera camera = Camera::look_at({0, -2, 1.5}, {0, 0, 0}, {0, 0, 1}, 60);
  Image image(320, 240);
  RenderStatistics taken;
  render(image, camera, scene, NormalIntegrator{}, {.statistics = &taken});
  CHECK(taken.surface_tests < 320 * 240 + 1);
  CHECK(taken.in_doubt < 320 * 240 / 100);
}

TEST_CASE("triangles of any size in one color need few camera rays") {
  const Camera camera = Camera::look_at({0, -2, 1.5}, {0, 0, 0}, {0, 0, 1}, 60);
  for (const std::uint32_t parts : {6u, 30u, 120u, 300u}) {
    SpheresAndMeshes scene;
    scene.add(mesh_of(meshes::torus(parts, parts / 2)), Color{1});
    Image image(320, 240);
    RenderStatistics taken;
    render(image, camera, scene, ColorIntegrator{}, {.statistics = &taken});
    CAPTURE(parts);
    CHECK(taken.camera_rays < 320 * 240 / 100);  // next to edges, where two triangles are equally near
  }
}

TEST_CASE("rays that surely miss a rasterized mesh are not tested for crossings with it") {
  SpheresAndMeshes scene, textured;
  const Mesh ring = mesh_of(meshes::torus(300, 60));
  scene.add(ring, Color{0.5f});
  Material material;
  material.texture = Checker{.first = Color{0.9f}, .second = Color{0.1f}, .size = 0.25};
  textured.add(ring, material);
  const Camera camera = Camera::look_at({0, -2, 1.5}, {0, 0, 0}, {0, 0, 1}, 60);
  for (const SpheresAndMeshes* one : {&scene, &textured}) {
    RenderStatistics taken;
    Image image(cases(160, 320), cases(120, 240));
    const auto pixels = static_cast<std::uint64_t>(image.width() * image.height());
    CHECK(drawn_otherwise(*one, camera, TransparencyIntegrator{}, {.statistics = &taken}, image.width(),
                          image.height()) == 0);
    render(image, camera, *one, BinaryIntegrator{});
    const auto met = static_cast<std::uint64_t>(
        count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; }));
    CHECK((met > pixels / 8 && met < pixels / 2));
    // The visibility buffer is queried for all rays; those that may hit the mesh are then tested for
    // crossings.
    const std::uint64_t tested = taken.surface_tests - pixels;
    CAPTURE(tested, met);
    CHECK((tested >= met && tested < met + pixels / 100));
  }
}

TEST_CASE("a floor whose plane contains the eye leaves few rays in doubt, as do triangles without area") {
  // The floor reaches behind the eye, so it is not in front as a whole; a wall is behind it.
  const auto in_doubt = [](bool on_a_line) {
    MeshData data;
    data.vertices = {{1, 0, -9}, {19, 0, -9}, {10, 0, 9}, {-9, -9, 12}, {9, -9, 12}, {0, 18, 12}};
    data.triangles = {{0, 1, 2}, {3, 4, 5}};
    if (on_a_line) data.triangles[0] = {0, 2, 0};
    SpheresAndMeshes scene;
    scene.add(mesh_of(data), Color{1});
    RenderStatistics taken;
    CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}, {.statistics = &taken}) == 0);
    return taken.in_doubt;
  };
  CHECK(in_doubt(false) < 200);
  CHECK(in_doubt(true) < 200);
}

TEST_CASE("a floor just below the eye is seen by the rays that lead down, whatever its orientation") {
  for (const double height : {0x1p-30, 0x1p-44, 0x1p-60})
    for (const bool is_turned : {false, true}) {
      MeshData floor;
      floor.vertices = {{-9, -height, -9}, {9, -height, -9}, {0, -height, 9}};
      floor.triangles = {{0, 1, 2}};
      if (is_turned) std::swap(floor.triangles[0][1], floor.triangles[0][2]);
      SpheresAndMeshes scene;
      scene.add(mesh_of(floor), Color{1});
      CHECK(drawn_otherwise(scene, Camera{}, NormalIntegrator{}) == 0);
      CHECK(drawn_otherwise(scene, Camera{}, ColorIntegrator{}) == 0);
    }
}

TEST_CASE("no camera ray is made where only a mesh of one color is seen, or nothing") {
  SpheresAndMeshes scene;
  scene.add(mesh_of(meshes::moved(meshes::torus(30, 12), 0.7, {0.4, 0, 3})), Color{1});
  const auto taken = [&](const auto& integrator, bool skips) {
    RenderStatistics statistics;
    CHECK(drawn_otherwise(scene, Camera{}, integrator,
                          {.skips = {.empty_tiles = skips}, .statistics = &statistics}) == 0);
    CHECK(statistics.camera_rays + statistics.pixels_skipped == 75 * 70);
    return statistics.camera_rays;
  };
  CHECK(taken(ColorIntegrator{}, true) < 100);
  CHECK(taken(ColorIntegrator{}, false) == 75 * 70);
  const auto of_hits = taken(NormalIntegrator{}, true);
  CHECK((of_hits > 75 * 70 / 20 && of_hits < 75 * 70 / 2));
}
