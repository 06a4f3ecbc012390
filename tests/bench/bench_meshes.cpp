// Measures meshes of many triangles against Embree's robust ones: camera rays, rays of every direction,
// occlusion; building.
//
//   bench_meshes [--threads N] [--runs N] [--csv FILE] [--quick] [--mesh FILE]
//
// The meshes are toruses, or the one of an OBJ file, which should lie in the cube of ±1.5, where the rays
// are. Rates are millions of rays a second. Both get the same rays and vertices, which are made of floats;
// only "render" makes its own rays, in double, if it needs any, and tells only hits from misses: pictures by
// the color integrator, which shows whether the mesh is hit, and of the depth, for which t is computed.
// Queries ray by ray are "single"; in the rows without the word the mesh gets all rays together. Embree is
// judged by the best of its three modes. Its answers are in float, so a few differ from ours, which are
// exact.
#include <algorithm>
#include <optional>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/image.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <stdexcept>
#include <vector>

#ifdef BENCH_OBJ
#include <protostar/io/obj.hpp>
#endif

#include "embree.hpp"
#include "mesh_workload.hpp"
#include "support.hpp"
#include "support/random.hpp"

using namespace protostar;
using bench::camera_of_torus, bench::Embree, bench::FloatRay, bench::Index, bench::Mode, bench::number,
    bench::pixels_by_tile, bench::Table, bench::Times, bench::torus, bench::Work;

namespace {

Ray in_double(const FloatRay& ray) { return {Point(ray.origin), Vec3(ray.direction)}; }

class Contest {
 public:
  Contest(Table& table, const bench::Options& options, const MeshData& data)
      : table_(table),
        options_(options),
        mesh_(data, {.threads = options.threads}),
        embree_(data.vertices, data.triangles, options.threads),
        image_(options.quick ? 64 : 1024, options.quick ? 64 : 1024) {
    scene_.add(mesh_, Color{1});
  }

  void run() {
    std::vector<FloatRay> camera_rays, incoherent, segments;
    const auto pixels = pixels_by_tile(image_.width());
    for (const auto& [x, y] : pixels)
      camera_rays.push_back(of(camera_of_torus().through_pixel(x, y, image_.width(), image_.height())));
    Random random(1);
    for (std::size_t i = 0; i < camera_rays.size(); ++i) {
      const Point origin = random.point(1.5), target = random.point(1.5);
      incoherent.push_back(of({origin, random.direction()}));
      segments.push_back(of({origin, target - origin}));
      segments.back().max = 1;
    }
    const auto rendered = [&](const std::string& name, const auto& integrator) {
      row(
          name, camera_rays, &Embree::closest, true,
          [&] { render(image_, camera_of_torus(), scene_, integrator, {.threads = options_.threads}); },
          [&](std::size_t i) {
            return image_(pixels[i].first, pixels[i].second) == Color{0} ? bench::nothing : Index{0};
          },
          true);
    };
    rendered("primary, render", ColorIntegrator{});
    rendered("primary, render depth", DepthIntegrator{});
    const auto first = [&](const FloatRay& ray) {
      const auto crossing = mesh_.first_crossing(in_double(ray), {});
      return crossing ? static_cast<Index>(crossing->primitive) : bench::nothing;
    };
    row_of_single("primary, single", camera_rays, &Embree::closest, true, first);
    const auto is_met = [&](const FloatRay& ray) {
      return mesh_.any_hit(in_double(ray), {0, 1}) ? Index{0} : bench::nothing;
    };
    row_of_single("incoherent, single", incoherent, &Embree::closest, false, first);
    row_of_single("occlusion, single", segments, &Embree::any, false, is_met);
    row_of_many("incoherent", incoherent, &Embree::closest,
                [&](std::size_t count, const auto& ray, const auto& tell) {
                  mesh_.first_crossings(
                      count, ray, {}, [&](std::size_t k, const std::optional<Crossing>& crossing) {
                        tell(k, crossing ? static_cast<Index>(crossing->primitive) : bench::nothing);
                      });
                });
    row_of_many("occlusion", segments, &Embree::any,
                [&](std::size_t count, const auto& ray, const auto& tell) {
                  mesh_.any_hits(count, ray, {0, 1},
                                 [&](std::size_t k, bool met) { tell(k, met ? Index{0} : bench::nothing); });
                });
  }

 private:
  using Query = void (Embree::*)(Mode, bool, const std::vector<FloatRay>&, std::size_t, std::size_t,
                                 std::vector<Index>&) const;

  static FloatRay of(const Ray& ray) {
    return {.origin = glm::vec3(ray.origin), .direction = glm::vec3(ray.direction)};
  }

  /// Prints a row of rays that are traced one by one.
  void row_of_single(const std::string& name, const std::vector<FloatRay>& rays, Query query, bool coherent,
                     const auto& answer) {
    std::vector<Index> ours(rays.size());
    const auto trace = [&] {
      bench::in_parts(rays.size(), options_.threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ours[i] = answer(rays[i]);
      });
    };
    row(name, rays, query, coherent, trace, [&](std::size_t i) { return ours[i]; });
  }

  /// Prints a row of rays that are traced together.
  void row_of_many(const std::string& name, const std::vector<FloatRay>& rays, Query query, const auto& ask) {
    std::vector<Index> ours(rays.size());
    const auto trace = [&] {
      bench::in_parts(rays.size(), options_.threads, [&](std::size_t begin, std::size_t end) {
        ask(
            end - begin, [&](std::size_t k) { return in_double(rays[begin + k]); },
            [&](std::size_t k, Index answer) { ours[begin + k] = answer; });
      });
    };
    row(name, rays, query, false, trace, [&](std::size_t i) { return ours[i]; });
  }

  /// Prints a row of any work; `answer(i)` is its answer for the i-th ray.
  void row(const std::string& name, const std::vector<FloatRay>& rays, Query query, bool coherent,
           const Work& ours, const auto& answer, bool only_whether = false) {
    std::vector<Index> embrees(rays.size());
    std::vector<Work> works;
    for (const Mode mode : {Mode::single, Mode::packet, Mode::stream})
      works.push_back([&, mode] {
        if (mode == Mode::stream && !Embree::has_streams) return;
        bench::in_parts(rays.size(), options_.threads, [&](std::size_t begin, std::size_t end) {
          (embree_.*query)(mode, coherent, rays, begin, end, embrees);
        });
      });
    works.push_back(ours);
    const Times times(options_, works);
    const auto rate = [&](std::size_t i) {
      return number(1e-6 * static_cast<double>(rays.size()) / times.seconds(i));
    };
    std::size_t best = 0, differ = 0, hits = 0;
    for (std::size_t i = 1; i < (Embree::has_streams ? 3 : 2); ++i)
      if (times.seconds(i) < times.seconds(best)) best = i;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool met = answer(i) != bench::nothing;
      differ += only_whether ? (embrees[i] != bench::nothing) != met : embrees[i] != answer(i);
      hits += met;
    }
    const bool both = Embree::is_there;
    if (both && differ > rays.size() / 1000)  // more than rounding explains: they do not do the same work
      throw std::runtime_error(name + ": " + std::to_string(differ) + " answers differ from Embree's");
    table_.row({std::to_string(mesh_.data().triangles.size()) + " " + name, std::to_string(rays.size()),
                both ? rate(0) : "-", both ? rate(1) : "-", Embree::has_streams ? rate(2) : "-", rate(3),
                both ? number(times.ratio(best, 3)) : "-", std::to_string(hits),
                both ? std::to_string(differ) : "-"});
  }

  Table& table_;
  const bench::Options& options_;
  Mesh mesh_;
  Embree embree_;
  Scene<Mesh> scene_;
  Image image_;
};

void build(Table& table, const bench::Options& options, const MeshData& data) {
  const Times times(options, {[&] { bench::keep(Embree(data.vertices, data.triangles, options.threads)); },
                              [&] { bench::keep(Mesh(data, {.threads = options.threads})); }});
  const bool both = Embree::is_there;
  table.row({std::to_string(data.triangles.size()), both ? number(1e3 * times.seconds(0)) : "-",
             number(1e3 * times.seconds(1)), both ? number(times.ratio(0, 1)) : "-"});
}

/// Measures pictures of one mesh in all sizes: if it has many more triangles than pixels, tiles are not
/// rasterized.
void pictures(Table& table, const bench::Options& options, const MeshData& data) {
  Scene<Mesh> scene;
  scene.add(Mesh(data, {.threads = options.threads}), Color{1});
  const auto accelerated = accelerate(scene);
  for (int side = 16; side <= (options.quick ? 64 : 1024); side *= 2) {
    Image image(side, side);
    const auto draw = [&](bool tiles) {
      return [&image, &accelerated, &options, tiles] {
        render(image, camera_of_torus(), accelerated, ColorIntegrator{},
               {.threads = options.threads, .tiles = tiles});
      };
    };
    const Times times(options, {draw(false), draw(true)});
    const auto nanoseconds = [&](std::size_t i) { return number(1e9 * times.seconds(i) / (side * side)); };
    table.row(
        {std::to_string(data.triangles.size()) + ", " + std::to_string(side) + "x" + std::to_string(side),
         nanoseconds(0), nanoseconds(1), number(times.ratio(0, 1))});
  }
}

/// Returns the one mesh that the options name, or toruses.
std::vector<MeshData> meshes_of(const bench::Options& options) {
  if (options.mesh.empty())
    return options.quick ? std::vector{torus(1000)} : std::vector{torus(100000), torus(1000000)};
#ifdef BENCH_OBJ
  return {bench::in_floats(load_obj(options.mesh))};
#else
  throw std::runtime_error("--mesh " + options.mesh +
                           ": no OBJ file can be read, since tinyobjloader is not installed (Debian: "
                           "libtinyobjloader-dev)");
#endif
}

void meshes_of_triangles(const bench::Options& options) {
  if (!Embree::is_there) std::printf("Embree is not installed, so there is nothing to compare with\n");
  const std::vector<MeshData> all = meshes_of(options);
  {
    Table table(options, {"triangles and rays", "rays", "Embree single", "packet", "stream", "protostar",
                          "times faster", "hits", "differ"});
    for (const MeshData& data : all) Contest(table, options, data).run();
  }
  {
    Table table(options,
                {"triangles and picture", "ray by ray ns/pixel", "by tiles ns/pixel", "times faster"});
    for (const MeshData& data : all) pictures(table, options, data);
  }
  Table table(options, {"triangles to build", "Embree ms", "protostar ms", "times faster"});
  for (const MeshData& data : all) build(table, options, data);
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, meshes_of_triangles); }
