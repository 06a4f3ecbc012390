// Measures what limits the time of pictures and rays: roots and quotients, and waiting for memory.
//
//   bench_limits [--runs N] [--csv FILE] [--quick]
//
// A picture of closest hits needs a square root and a quotient of double for each direction, and another pair
// for the t of each hit; these are slow operations of a processor. A query that is repeated at once finds all
// that it needs in the cache.
#include <array>
#include <functional>
#include <protostar/accel/pixel_rays.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/image.hpp>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/surfaces/mesh.hpp>

#include "mesh_workload.hpp"
#include "support.hpp"
#include "workload.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;
using simd::Colors, simd::Doubles, simd::double_lanes, simd::Vectors;

namespace {

// ---- Pictures of three spheres

/// Fills a picture packet by packet, in parts as render does, with color(directions), in steps: all
/// directions of a part, then all colors.
void fill(Image& image, const Camera& camera, const auto& color) {
  const simd::PixelRays rays(camera, PixelGrid(image.width(), image.height()), image.width(), image.height());
  constexpr int side = 16, most = side * ((side + double_lanes - 1) / double_lanes);
  const Tile all{0, 0, image.width(), image.height()};
  for (int k = 0; k < all.count(side); ++k) {
    const Tile part = all.part(k, side);
    const auto each_packet = [&](const auto& visit) {
      std::size_t i = 0;
      for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; x += double_lanes) visit(i++, x, y);
    };
    std::array<Vectors, most> directions;
    each_packet([&](std::size_t i, int x, int y) { directions[i] = color.direction(rays, x, y); });
    each_packet([&](std::size_t i, int x, int y) {
      const Colors colors = color.of(directions[i]);
      for (int lane = 0; lane < std::min(double_lanes, part.x1 - x); ++lane)
        image(x + lane, y) = {colors.r[lane], colors.g[lane], colors.b[lane]};
    });
  }
}

/// Writes black pixels.
struct Written {
  static Vectors direction(const simd::PixelRays&, int, int) { return Vec3{0}; }
  static Colors of(const Vectors& d) { return Colors(d); }
};

/// Writes directions as colors: a root and a quotient for each packet.
struct Directions {
  static Vectors direction(const simd::PixelRays& rays, int x, int y) { return rays.directions(x, y); }
  static Colors of(const Vectors& d) { return Colors(d); }
};

/// Takes another root and another quotient for each packet, of numbers as they are for a sphere.
struct Hits : Directions {
  static Colors of(const Vectors& d) {
    const Doubles b = dot(d, Vectors(Vec3{0, 0, 3})), c = 8.0, q = b + sqrt(abs(b * b - c));
    return Colors(to_float(c / q));
  }
};

void pictures(const bench::Options& options) {
  const auto scene = three_spheres();
  const int width = options.quick ? 64 : 640, height = width / 4 * 3;
  Image image(width, height);
  const auto drawn = [&](const auto& integrator) {
    return [&] { render(image, Camera{}, scene, integrator, RenderOptions{.threads = 1}); };
  };
  const std::vector<std::string> names{
      "pixels written", "a root and a quotient each", "two of both each", "03_scene", "04_depth", "06_color"};
  const Times times(
      options, {[&] { fill(image, Camera{}, Written{}); }, [&] { fill(image, Camera{}, Directions{}); },
                [&] { fill(image, Camera{}, Hits{}); }, drawn(BinaryIntegrator{}), drawn(DepthIntegrator{}),
                drawn(ColorIntegrator{})});
  Table table(options, {"picture of three spheres", "ns/pixel", "of 06_color"});
  for (std::size_t i = 0; i < names.size(); ++i)
    table.row({names[i], number(1e9 * times.seconds(i) / width / height), number(times.ratio(i, 5))});
}

// ---- Many spheres, and meshes of many triangles

/// Prints a row for a work on a number of rays: all once, and each part twice in turn. The difference is the
/// time of the second pass, with everything in the cache.
void row(Table& table, const bench::Options& options, const std::string& name, double rays,
         const std::function<void(int times)>& work) {
  const Times times(options, {[&] { work(1); }, [&] { work(2); }});
  std::vector<double> again, share;
  for (std::size_t run = 0; run < times[0].size(); ++run) {
    again.push_back(times[1][run] - times[0][run]);
    share.push_back(times[0][run] / again.back());
  }
  const auto ns = [&](double seconds) { return number(1e9 * seconds / rays); };
  table.row({name, ns(times.seconds(0)), ns(bench::median(again)), number(bench::median(share))});
}

/// Measures the tiles of a picture, each as a picture of its own: up to 2048 surfaces, all are tested anew
/// for each tile, in both passes.
void camera_rays(Table& table, const bench::Options& options, const std::string& name, const Camera& camera,
                 const auto& traced, const auto& integrator) {
  constexpr int tile = 64;
  const int side = options.quick ? tile : 1024;
  Image image(tile, tile);
  row(table, options, name + " camera rays, by tiles", 1.0 * side * side, [&](int times) {
    for (int y = 0; y < side; y += tile)
      for (int x = 0; x < side; x += tile)
        for (int i = 0; i < times; ++i)
          render(image, camera, traced, integrator, RenderOptions{.crop = {x, y, side, side}, .threads = 1});
  });
}

/// Measures rays of any direction, one by one, in parts of 256; from points inside a box around all surfaces,
/// and from beyond them, to where nothing is.
void single_rays(Table& table, const bench::Options& options, const std::string& name, const Bounds& box,
                 const auto& first_hit) {
  constexpr std::size_t part = 256;
  Random random(1);
  std::vector<Ray> inside(options.quick ? part : 1 << 20), beyond(inside.size());
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const Vec3 direction = random.direction();
    const Point origin = box.min + (random.point(0.5) + 0.5) * (box.max - box.min);
    inside[i] = {origin, direction};
    beyond[i] = {origin + 5.0 * direction, direction};
  }
  const auto ask = [&](const std::string& which, const std::vector<Ray>& rays) {
    row(table, options, name + which, static_cast<double>(rays.size()), [&](int times) {
      for (std::size_t begin = 0; begin < rays.size(); begin += part)
        for (int i = 0; i < times; ++i)
          for (std::size_t k = begin; k < begin + part; ++k) bench::keep(first_hit(rays[k]));
    });
  };
  ask(" incoherent", inside);
  ask(" past everything", beyond);
}

void spheres(Table& table, const bench::Options& options, std::size_t count) {
  const bench::Workload work = bench::workload(count);
  const auto scene = bench::scene_of(work);
  const auto& traced = bench::traced(scene, options.threads);
  const std::string name = std::to_string(work.spheres.size()) + " spheres,";
  camera_rays(table, options, name, work.camera, traced, DepthIntegrator{});
  single_rays(table, options, name, {Point(work.corner), Point(work.corner + work.size)},
              [&](const Ray& ray) { return traced.intersect(ray, Interval{}); });
}

void triangles(Table& table, const bench::Options& options, std::size_t count) {
  const Mesh mesh(bench::torus(count), {.threads = options.threads});
  Scene<Mesh> scene;
  scene.add(mesh, Color{1});
  const std::string name = std::to_string(mesh.data().triangles.size()) + " triangles,";
  camera_rays(table, options, name, bench::camera_of_torus(), accelerate(scene), ColorIntegrator{});
  single_rays(table, options, name, {Point{-1.5}, Point{1.5}},
              [&](const Ray& ray) { return mesh.first_crossing(ray, {}); });
}

void limits(const bench::Options& options) {
  pictures(options);
  Table table(options, {"surfaces and rays", "ns/ray", "again ns/ray", "times longer"});
  for (const std::size_t count : {1000u, 100000u, 1000000u})
    if (!options.quick || count == 1000) spheres(table, options, count);
  for (const std::size_t count : {1000u, 100000u, 1000000u})
    if (!options.quick || count == 1000) triangles(table, options, count);
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, limits); }
