// Figures of the stage 27: normal maps.
#include <cmath>
#include <protostar/integrators/whitted.hpp>
#include <protostar/normals.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "figures.hpp"
#include "scenes/waves.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// A board in the plane y = 0, seen from its edge: u goes from 0 to 1 to the right.
const Parallelogram board{.position = {0, 0, 0.5}, .edge_u = {1, 0, 0}, .edge_v = {0, 0, -1}};

void stored_normals(Drawing& drawing) {
  const NormalMap map = waves(2, 0, 0.9);
  Scene<Parallelogram> scene;
  scene.add(board, Material{.diffuse = Color{1}, .normal_map = map});
  constexpr double wide = 580;
  // A height whose slope is -x/z of the map: the normal is at a right angle to it.
  const double turn = 360 * 2;
  const auto height = [&](double u) { return 0.9 / (4 * std::numbers::pi) * cosine_of_degrees(turn * u); };
  const Sketch waved(drawing, {30, 120}, wide), flat(drawing, {30, 262}, wide);
  waved.curve([&](double u) { return Point{u, height(u), 0}; }, 0, 1, Paint::ink, Stroke::bold, 96);
  flat.line({0, 0, 0}, {1, 0, 0}, Paint::ink, Stroke::bold);
  constexpr int count = 16;
  for (int i = 0; i < count; ++i) {
    const double u = (i + 0.5) / count;
    const Ray down{.origin = {u, 1, 0}, .direction = {0, -1, 0}};
    const Vec3 n = scene.intersect(down).value().facing_normal();
    const Vec3 along{1, (height(u + 1e-6) - height(u - 1e-6)) / 2e-6, 0};  // the wave's own direction
    expect(std::abs(dot(n, along)) < 1e-6, "stored_normals");
    const Point top{u, height(u), 0}, below{u, 0, 0};
    waved.arrow(top, top + 0.075 * n, Paint::blue);
    flat.arrow(below, below + 0.075 * n, Paint::blue);
    const Vec3 stored = 0.5 * normalize(map(u, 0)) + 0.5;
    const auto code = [](double x) { return static_cast<int>(std::lround(255 * x)); };
    drawing.swatch({30 + wide * i / count, 296}, wide / count, 34,
                   {code(stored.x), code(stored.y), code(stored.z)});
  }
  drawing.words({320, 30}, "waves, and their normals", Anchor::middle, Paint::ink, true);
  drawing.words({320, 192}, "a flat surface with the same normals", Anchor::middle, Paint::ink, true);
  drawing.words({320, 354}, "the normals as colors: the normal map", Anchor::middle);
}

void tangent_space(Drawing& drawing) {
  const Sphere sphere{};
  const Camera camera = Camera::look_at({-1.7, 1.1, -2.5}, Point{0});
  const Sketch sketch(drawing, {150, 206}, 120, camera);
  sketch.circle(Point{0}, 1, Paint::gray);
  const Ray ray{.origin = {0.4, 0.4, -3}, .direction = {0, 0, 1}};
  const Point p = ray.at(sphere.intersect(ray).value());
  const Uv uv = sphere.uv_at(p);
  const auto point_at = [](double u, double v) {
    const Vec3 around = at_angle(360 * (u - 0.5)), down = at_angle(180 * v);
    return Point{down.y * around.y, down.x, down.y * around.x};
  };
  sketch.curve([&](double u) { return point_at(u, uv.y); }, uv.x - 0.16, uv.x + 0.16, Paint::green);
  sketch.curve([&](double v) { return point_at(uv.x, v); }, uv.y - 0.3, uv.y + 0.3, Paint::red);
  const auto [u, v] = sphere.tangents_at(p);
  const Vec3 n = sphere.normal_at(p), t = normalize(u), b = normalize(v);
  const Vec3 direction = normalize(Vec3{0.5, 0.3, 1});
  const Vec3 shading = out_of_tangent_space(direction, n, {u, v});
  expect(length(shading - (direction.x * t + direction.y * b + direction.z * n)) < 1e-9, "tangent_space");
  sketch.arrow(p, p + 0.75 * t, Paint::green, Stroke::bold);
  sketch.arrow(p, p + 0.75 * b, Paint::red, Stroke::bold);
  sketch.arrow(p, p + 0.75 * n, Paint::blue, Stroke::bold);
  sketch.arrow(p, p + 0.9 * shading, Paint::orange, Stroke::bold);
  sketch.words(p + 0.75 * t, {-10, 6}, "a: u grows", Paint::green, Anchor::end);
  sketch.words(p + 0.75 * b, {0, 22}, "b: v grows", Paint::red, Anchor::middle);
  sketch.words(p + 0.75 * n, {8, 0}, "n", Paint::blue);
  sketch.words(p + 0.9 * shading, {8, 6}, "n′", Paint::orange);
  drawing.words({150, 30}, "on the sphere", Anchor::middle, Paint::ink, true);

  const Camera over = Camera::look_at({-0.9, 1.2, -3}, Point{0});
  const Sketch ground(drawing, {480, 214}, 120, over);
  ground.polygon({{-0.9, 0, -0.7}, {0.9, 0, -0.7}, {0.9, 0, 0.7}, {-0.9, 0, 0.7}}, Paint::gray);
  const Vec3 x{1, 0, 0}, y{0, 0, -1}, z{0, 1, 0};
  ground.arrow(Point{0}, 0.75 * x, Paint::green, Stroke::bold);
  ground.arrow(Point{0}, 0.75 * y, Paint::red, Stroke::bold);
  ground.arrow(Point{0}, 0.75 * z, Paint::blue, Stroke::bold);
  const Vec3 tilted = direction.x * x + direction.y * y + direction.z * z;
  ground.arrow(Point{0}, 0.9 * tilted, Paint::orange, Stroke::bold);
  ground.words(0.75 * x, {8, 6}, "x", Paint::green);
  ground.words(0.75 * y, {-4, 22}, "y", Paint::red, Anchor::middle);
  ground.words(0.75 * z, {-10, 4}, "z", Paint::blue, Anchor::end);
  ground.words(0.9 * tilted, {8, 0}, "(x, y, z)", Paint::orange);
  drawing.words({480, 30}, "in the map", Anchor::middle, Paint::ink, true);
  drawing.words({320, 372}, "n′ = x a + y b + z n, made 1 long", Anchor::middle, Paint::orange);
}

void light_behind(Drawing& drawing) {
  const Sketch sketch(drawing, {200, 150}, 120);
  const Vec3 n{0, 1, 0}, tilted = at_angle(35);
  const Normals<Vec3> normals{n, tilted, true};
  const Vec3 to_front = 1.25 * at_angle(14), to_back = 1.3 * at_angle(-22);
  sketch.line({-1.7, 0, 0}, {1.7, 0, 0}, Paint::ink, Stroke::bold);
  sketch.line(1.1 * at_angle(125), 1.1 * at_angle(-55), Paint::gray, Stroke::dashed);
  sketch.words(1.1 * at_angle(-55), {10, 6}, "at a right angle to n′", Paint::gray);
  sketch.arrow(Point{0}, 0.8 * n, Paint::blue, Stroke::bold);
  sketch.words(0.8 * n, {-10, 8}, "n, of the surface", Paint::blue, Anchor::end);
  sketch.arrow(Point{0}, 0.8 * tilted, Paint::orange, Stroke::bold);
  sketch.words(0.8 * tilted, {8, -2}, "n′, of the map", Paint::orange);
  expect(normals.height(to_front) > 0 && normals.height(to_back) == 0 && dot(tilted, to_back) > 0,
         "light_behind");
  sketch.line(Point{0}, to_front, Paint::green);
  sketch.line(Point{0}, to_back, Paint::red);
  sketch.lamp(to_front);
  sketch.lamp(to_back);
  sketch.words(to_front, {20, 0}, "in front: n′·l > 0, n·l > 0", Paint::green);
  sketch.words(to_back, {20, 8}, "behind: n′·l > 0, n·l < 0", Paint::red);
}

void mirrored_into_surface(Drawing& drawing) {
  const Sketch sketch(drawing, {240, 190}, 140);
  const Vec3 n{0, 1, 0}, tilted = at_angle(50);
  const Vec3 direction = -at_angle(150);  // of a ray that comes from the upper left
  const Vec3 by_map = reflected(direction, tilted), by_surface = reflected(direction, n);
  expect(dot(n, by_map) < 0 && dot(n, by_surface) > 0, "mirrored_into_surface");
  sketch.line({-1.7, 0, 0}, {1.7, 0, 0}, Paint::ink, Stroke::bold);
  sketch.arrow(-1.4 * direction, Point{0}, Paint::blue, Stroke::bold);
  sketch.eye(-1.4 * direction, direction);
  sketch.arrow(Point{0}, 0.8 * n, Paint::gray);
  sketch.words(0.8 * n, {-8, 8}, "n", Paint::gray, Anchor::end);
  sketch.arrow(Point{0}, 0.8 * tilted, Paint::orange, Stroke::bold);
  sketch.words(0.8 * tilted, {8, 0}, "n′", Paint::orange);
  sketch.arrow(Point{0}, 1.0 * by_map, Paint::red, Stroke::bold);
  sketch.words(1.0 * by_map, {10, 10}, "mirrored by n′: into the surface", Paint::red);
  sketch.arrow(Point{0}, 1.2 * by_surface, Paint::green, Stroke::bold);
  sketch.words(1.2 * by_surface, {8, 0}, "mirrored by n instead", Paint::green);
}

}  // namespace

std::vector<StageFigure> normal_map_figures() {
  return {
      {"stored_normals", "27_normal_map",
       "Waves with their normals, a flat surface with the same normals, and these as colors", 374,
       stored_normals},
      {"tangent_space", "27_normal_map",
       "A direction of the map between x, y and z, and on a sphere between a, b and n", 392, tangent_space},
      {"light_behind", "27_normal_map",
       "A lamp before the surface, and one behind it that the tilted normal would see", 300, light_behind},
      {"mirrored_into_surface", "27_normal_map",
       "A ray that a tilted normal mirrors into the surface, and the surface's own normal does not", 330,
       mirrored_into_surface},
  };
}

}  // namespace figures
