// A surface of many triangles that share their vertices, with a BVH of its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "../parallel.hpp"
#include "../render_options.hpp"
#include "../surface.hpp"
#include "mesh_data.hpp"
#include "mesh_tree.hpp"
#include "triangle.hpp"

#if __has_include("../accel/triangles_in_tile.hpp")
#include "../accel/triangles_in_tile.hpp"
#define PROTOSTAR_RASTERIZED_MESHES 1  // with accel/, meshes are rasterized into tiles
#endif

namespace protostar::inline PROTOSTAR_ABI {

/// A mesh, whose copies share their data. Its primitives are its triangles, in the order in which they are
/// given.
///
/// All triangles fit together as two that share an edge or a vertex do (Triangle): a ray that is aimed at an
/// edge of a closed mesh, or at a vertex, slips through nowhere and crosses nothing twice. Vertices are
/// compared by their coordinates, so two vertices at one position are as good as one.
class Mesh {
 public:
  /// Builds the BVH. Throws the exceptions of MeshData::validate, and std::invalid_argument if
  /// options.threads is negative.
  explicit Mesh(MeshData data, const RenderOptions& options = {})
      : contents_(std::make_shared<const Contents>(std::move(data), options)) {}

  [[nodiscard]] const MeshData& data() const { return contents_->data; }

  /// Returns true if the mesh bounds a solid (MeshData::is_closed). Takes O(n log n) time and temporary
  /// memory at each call; keep the result. A line is inside between its first crossing and its second, its
  /// third and its fourth, and so on. Normals lead out of the solid if (b − a) × (c − a) does for each
  /// triangle a, b, c: if, in right-handed coordinates, the triangles turn counterclockwise as seen from
  /// outside, and in left-handed ones clockwise.
  [[nodiscard]] bool is_solid() const { return data().is_closed(); }
  [[nodiscard]] int primitive_count() const { return static_cast<int>(data().triangles.size()); }

  /// Returns false: the inside is bounded on every ray.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  /// Returns t of the closest hit in the range.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the unit normal at a point of a triangle: the vertex normals, interpolated, or the triangle's
  /// own if there are none or they cancel.
  [[nodiscard]] Vec3 normal_at(const Point& point, int primitive) const {
    const Triangle triangle = this->triangle(primitive);
    if (!data().normals.empty()) {
      const Vec3 normal =
          normalize(of_moderate_size(between(data().normals, triangle.uv_at(point), primitive)));
      if (is_finite(normal)) return normal;
    }
    return triangle.normal_at(point);
  }

  /// Returns true if each triangle has one normal, its own.
  [[nodiscard]] bool has_flat_primitives() const { return data().normals.empty(); }

  /// Interpolates the texture coordinates of the vertices; returns barycentric coordinates if they have none.
  [[nodiscard]] Uv uv_at(const Point& point, int primitive) const {
    const Uv uv = triangle(primitive).uv_at(point);
    return data().uvs.empty() ? uv : between(data().uvs, uv, primitive);
  }

  /// Returns the directions of the texture coordinates, which are the same all over a triangle. A vector w in
  /// its plane, along the edges e and f by α and β, changes u by α e_u + β f_u, and v by α e_v + β f_v; it
  /// leaves v as it is for α = f_v, β = −e_v, and then changes u by the determinant e_u f_v − f_u e_v.
  [[nodiscard]] Tangents tangents_at(const Point& point, int primitive) const {
    const auto [e, f] = triangle(primitive).tangents_at(point);
    if (data().uvs.empty()) return {e, f};
    const auto& [a, b, c] = data().triangles[static_cast<std::size_t>(primitive)];
    const Uv of_e = data().uvs[b] - data().uvs[a], of_f = data().uvs[c] - data().uvs[a];
    const double determinant = of_e.x * of_f.y - of_f.x * of_e.y;
    const double sign = (determinant > 0) - (determinant < 0);
    const int exponent = -exponent_of({e, f});  // coordinates are up to 2^400, and so are products with them
    return {sign * (of_f.y * scaled(e, exponent) - of_e.y * scaled(f, exponent)),
            sign * (of_e.x * scaled(f, exponent) - of_f.x * scaled(e, exponent))};
  }

  /// Returns the plane of a triangle; surfaces in one plane are left together. The ray crosses this mesh as
  /// one does that starts on the triangle, however its origin is rounded (StartInTriangle): next to an edge
  /// that bends away it does not hit the other side, and next to an edge in a valley it does if it leads
  /// there.
  ///
  /// The mesh is recognized by the data that all its copies share: a ray that leaves one copy leaves all. Do
  /// not trace the ray after the last copy is destroyed; a new mesh could have the same address.
  [[nodiscard]] Departure departure(int primitive) const {
    Departure departure = triangle(primitive).departure();
    departure.primitive = primitive, departure.object = contents_.get();
    return departure;
  }

  [[nodiscard]] Bounds bounds() const { return contents_->bounds; }

  /// Returns the closest hit in the range, in exact order. If triangles are crossed at equal t, the one with
  /// the lowest index counts.
  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    Query<const Ray&, true> query{*this, ray, range};
    contents_->tree.answer(query, data().triangle_of());
    return query.crossing;
  }

  /// Returns true if there is any hit in the range.
  [[nodiscard]] bool any_hit(const Ray& ray, Interval range) const {
    Query<const Ray&, false> query{*this, ray, range};
    contents_->tree.answer(query, data().triangle_of());
    return query.crossing.has_value();
  }

  /// Finds first_crossing of many rays, the k-th of `count` being ray(k), and calls tell(k,
  /// std::optional<Crossing>) for each, in any order. The traversals are interleaved: while one ray waits for
  /// memory, others go on. This pays for rays that lead to different places of a mesh larger than the cache
  /// (bench_meshes).
  void first_crossings(std::size_t count, const auto& ray, Interval range, const auto& tell) const {
    contents_->tree.answer_each(
        count,
        [&](std::size_t k) {
          return Query<Ray, true>{*this, ray(k), range};
        },
        [&](std::size_t k, const auto& query) { tell(k, query.crossing); }, data().triangle_of());
  }

  /// Tests many rays for any hit in the range, the k-th of `count` being ray(k), and calls tell(k, bool) for
  /// each, in any order. Interleaved like first_crossings.
  void any_hits(std::size_t count, const auto& ray, Interval range, const auto& tell) const {
    contents_->tree.answer_each(
        count,
        [&](std::size_t k) {
          return Query<Ray, false>{*this, ray(k), range};
        },
        [&](std::size_t k, const auto& query) { tell(k, query.crossing.has_value()); }, data().triangle_of());
  }

  /// Calls visit(const Crossing&) for every crossing in the range, near to far.
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    std::vector<Crossing> crossings;
    const Start start = start_of(ray);
    // The BVH traces rays, not lines: crossings behind the origin lie ahead on the reversed ray.
    const auto find_along = [&](const Ray& half, double length, bool is_behind) {
      All all{{*this, half, {std::max(is_behind ? -range.max : range.min, 0.0), length}},
              [&](const Triangle& triangle, std::uint32_t i) {
                const auto crossing = crossing_with(triangle, i, ray, start, range);
                if (crossing && (crossing->t < 0) == is_behind) crossings.push_back(*crossing);
              }};
      contents_->tree.answer(all, data().triangle_of());
    };
    if (range.max > 0) find_along(ray, range.max, false);
    if (range.min < 0) find_along(ray.reversed(), -range.min, true);
    std::sort(crossings.begin(), crossings.end(),
              [&](const Crossing& a, const Crossing& b) { return comes_before(ray, start, a, b); });
    for (const Crossing& crossing : crossings) visit(crossing);
  }

#if defined(PROTOSTAR_RASTERIZED_MESHES)
  /// Visibility buffer of a tile, filled for all pixels at once (RasterizedSurface).
  using Drawn = simd::TrianglesInTile;
  void draw(Drawn& drawn, const simd::PixelRays& rays, int sample, const simd::TileHalfSpaces& half_spaces,
            const Tile& tile) const {
    drawn.draw(contents_->tree, rays, sample, half_spaces, tile);
  }
#endif

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    const Triangle one = triangle(crossing.primitive);
    if (const Start start = start_of(ray)) return start->exact_root(ray, one);
    return exact_root_of(one, ray, crossing.root);
  }

 private:
  /// Start of a ray that leaves a triangle of this mesh; empty for other rays.
  using Start = std::optional<StartInTriangle>;

  /// Query to the BVH (TriangleTree) for the closest hit of a ray, or for any hit. R is Ray, or a reference
  /// to one.
  template <class R, bool closest>
  struct Query {
    static constexpr bool near_first = closest;

    const Mesh& mesh;
    R ray;
    Interval range;
    Start start;
    RoundedLine line;  ///< line that crosses the triangles, with the errors of its numbers
    std::optional<Crossing> crossing = {};

    Query(const Mesh& of, const Ray& of_ray, const Interval& in_range)
        : mesh(of),
          ray(of_ray),
          range(in_range),
          start(of.start_of(of_ray)),
          line(start ? start->line(of_ray) : rounded_line(of_ray)) {}

    /// Returns how far the ray's start may be from its origin, on each axis.
    [[nodiscard]] double distance() const { return start ? start->distance() : 0; }

    bool found(double t, std::uint32_t i) { return take({.t = t, .primitive = static_cast<int>(i)}); }
    bool maybe(const Triangle& triangle, std::uint32_t i) {
      const auto other = mesh.crossing_with(triangle, i, ray, start, range);
      return other && take(*other);
    }

   private:
    /// Takes a crossing if it is the closest so far; returns true if any is enough.
    bool take(const Crossing& other) {
      if (closest && crossing && !mesh.comes_before(ray, start, other, *crossing)) return false;
      crossing = other;
      // Crossings that may come before it, given its error, stay in the range.
      range.max = std::min(range.max, upper_bound_of(other.t));
      return !closest;
    }
  };

  /// Query that calls look_at(triangle, i) for all triangles that the ray may cross.
  template <class LookAt>
  struct All : Query<const Ray&, false> {
    LookAt look_at;

    bool found(double, std::uint32_t i) { return maybe(this->mesh.data().triangle(i), i); }
    bool maybe(const Triangle& triangle, std::uint32_t i) {
      look_at(triangle, i);
      return false;
    }
  };
  template <class LookAt>
  All(Query<const Ray&, false>, LookAt) -> All<LookAt>;

  /// Data that copies share.
  struct Contents {
    MeshData data;
    simd::TriangleTree tree;
    Bounds bounds{Point{infinity}, Point{-infinity}};

    Contents(MeshData given, const RenderOptions& options)
        : data(validated(std::move(given))), tree(data.triangles.size(), data.triangle_of(), options) {
      detail::require_threads(options);  // checked here since few triangles are sorted by one thread
      for (std::size_t i = 0; i < data.triangles.size(); ++i) {
        const Bounds of_one = data.triangle(i).bounds();
        bounds = {min(bounds.min, of_one.min), max(bounds.max, of_one.max)};
      }
    }
  };

  static MeshData validated(MeshData data) {
    data.validate();
    return data;
  }

  [[nodiscard]] Triangle triangle(int primitive) const {
    return data().triangle(static_cast<std::size_t>(primitive));
  }

  /// Interpolates a vertex attribute at (u, v) of a triangle.
  template <class T>
  [[nodiscard]] T between(const std::vector<T>& of_vertices, const Uv& uv, int primitive) const {
    const auto& [a, b, c] = data().triangles[static_cast<std::size_t>(primitive)];
    return (1 - uv.x - uv.y) * of_vertices[a] + uv.x * of_vertices[b] + uv.y * of_vertices[c];
  }

  [[nodiscard]] bool leaves_this(const Ray& ray) const {
    return ray.departure.is_planar() && ray.departure.object == contents_.get();
  }
  [[nodiscard]] Start start_of(const Ray& ray) const {
    return leaves_this(ray) ? Start(std::in_place, ray, triangle(ray.departure.primitive)) : std::nullopt;
  }

  /// Returns the crossing with the i-th triangle in the range, if there is one.
  [[nodiscard]] std::optional<Crossing> crossing_with(const Triangle& one, std::uint32_t i, const Ray& ray,
                                                      const Start& start, const Interval& range) const {
    const int primitive = static_cast<int>(i);
    if (!start) {
      auto crossing = protostar::first_crossing(one, ray, range);
      if (crossing) crossing->primitive = primitive;
      return crossing;
    }
    if (primitive == ray.departure.primitive) return {};
    for (const double t : start->roots(ray, one))
      if (const Crossing crossing{.t = t, .primitive = primitive}; lies_inside(*this, ray, crossing, range))
        return crossing;
    return {};
  }

  [[nodiscard]] bool comes_before(const Ray& ray, const Start& start, const Crossing& a,
                                  const Crossing& b) const {
    if (start) {
      const int sign = start->order_of(ray, triangle(a.primitive), a.t, triangle(b.primitive), b.t);
      return sign < 0 || (sign == 0 && a.primitive < b.primitive);
    }
    const auto on_mesh = [&](const Crossing& crossing) {
      return SurfaceCrossing{.crossing = crossing, .surface = this, .functions = &functions_of<Mesh>};
    };
    return precedes(ray, on_mesh(a), a.primitive, on_mesh(b), b.primitive);
  }

  std::shared_ptr<const Contents> contents_;
};

static_assert(CompositeSurface<Mesh> && is_made_of_primitives<Mesh> && SurfaceWithBounds<Mesh> &&
              knows_uv<Mesh> && Solid<Mesh>);

}  // namespace protostar::inline PROTOSTAR_ABI
