// A surface of many triangles that share their vertices, found by way of a tree of boxes of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../render_options.hpp"
#include "../surface.hpp"
#include "triangle.hpp"

#if __has_include("../accel/triangles_in_tile.hpp")
#include "../accel/triangles_in_tile.hpp"
#define PROTOSTAR_MESH_TREE 1
#endif

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

#if defined(PROTOSTAR_MESH_TREE)
using simd::TriangleTree;
#else
/// Without accel/, all triangles are tried in turn.
class TriangleTree {
 public:
  static constexpr std::size_t most = std::size_t{1} << 27;

  TriangleTree(std::size_t count, const auto&, const RenderOptions&)
      : count_(static_cast<std::uint32_t>(count)) {}

  void answer(auto& query, const auto& triangle) const {
    for (std::uint32_t i = 0; i < count_; ++i)
      if (query.maybe(triangle(i), i)) return;
  }
  void answer_each(std::size_t count, const auto& make, const auto& done, const auto& triangle) const {
    for (std::size_t k = 0; k < count; ++k) {
      auto query = make(k);
      answer(query, triangle);
      done(k, query);
    }
  }

 private:
  std::uint32_t count_;
};
#endif

}  // namespace detail

/// What a mesh is made of.
struct MeshData {
  std::vector<Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< by the numbers of their vertices

  /// Of each vertex, or none: then each triangle has its own. They may have any length.
  std::vector<Vec3> normals = {};
  /// Places on textures, of each vertex, or none: then each triangle has its barycentric coordinates.
  std::vector<Uv> uvs = {};

  [[nodiscard]] Triangle triangle(std::size_t i) const {
    const auto& [a, b, c] = triangles[i];
    return {vertices[a], vertices[b], vertices[c]};
  }

  /// The same as a function.
  [[nodiscard]] auto triangle_of() const {
    return [this](std::size_t i) { return triangle(i); };
  }

  /// Whether the triangles bound a solid: of each edge, as many have it in one direction as in the other.
  /// Vertices in one place are one.
  [[nodiscard]] bool is_closed() const {
    const std::vector<std::uint32_t> number = numbers_of_places();
    using Edge = std::array<std::uint32_t, 2>;
    std::vector<Edge> up, down;  // from the lower number to the higher, and back
    for (const auto& triangle : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = number[triangle[i]], to = number[triangle[(i + 1) % 3]];
        if (from < to) up.push_back({from, to});
        if (to < from) down.push_back({to, from});
      }
    std::sort(up.begin(), up.end());
    std::sort(down.begin(), down.end());
    return up == down;
  }

  /// Throws std::invalid_argument if there is no triangle or too many, if one names a vertex that there is
  /// not, if a number is not finite, or if there are other than as many normals or uvs as vertices. Triangles
  /// without area are allowed; no ray meets them.
  void validate() const {
    const auto check = [](bool holds, const auto& rule) {
      if (!holds) throw std::invalid_argument("Mesh: " + std::string(rule));
    };
    check(!triangles.empty(), "there is no triangle");
    check(triangles.size() <= detail::TriangleTree::most, "there are more than 2^27 triangles");
    const auto check_finite = [&](const auto& all, const std::string& name) {
      for (std::size_t i = 0; i < all.size(); ++i)
        if (!is_finite(all[i])) check(false, name + " " + std::to_string(i) + " must be finite");
    };
    check_finite(vertices, "vertex");
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (const std::uint32_t vertex : triangles[i])
        if (vertex >= vertices.size())
          check(false, "triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) +
                           ", and there are " + std::to_string(vertices.size()));
    const auto check_of_vertices = [&](const auto& all, const std::string& name) {
      if (!all.empty() && all.size() != vertices.size())
        check(false, "there must be as many " + name + "s as vertices, or none; there are " +
                         std::to_string(all.size()) + " and " + std::to_string(vertices.size()));
      check_finite(all, name);
    };
    check_of_vertices(normals, "normal");
    check_of_vertices(uvs, "uv");
  }

 private:
  /// Of each vertex a number, the same for those in one place.
  [[nodiscard]] std::vector<std::uint32_t> numbers_of_places() const {
    const auto place = [&](std::uint32_t i) {
      return std::array{vertices[i].x, vertices[i].y, vertices[i].z};
    };
    std::vector<std::uint32_t> in_order(vertices.size()), numbers(vertices.size());
    std::iota(in_order.begin(), in_order.end(), 0u);
    std::sort(in_order.begin(), in_order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    for (std::size_t i = 0; i < in_order.size(); ++i) {
      const bool is_new = i == 0 || place(in_order[i - 1]) != place(in_order[i]);
      numbers[in_order[i]] = is_new ? in_order[i] : numbers[in_order[i - 1]];
    }
    return numbers;
  }
};

/// A mesh, whose copies share what it is made of. Its parts are its triangles, in the order in which they are
/// given.
///
/// What holds of triangles that share an edge or a vertex (Triangle) holds of all: a ray that is aimed at an
/// edge of a closed mesh, or at a vertex, slips through nowhere and crosses nothing twice. What counts are
/// the numbers of the vertices, so that two vertices in one place are as good as one.
class Mesh {
 public:
  /// Builds the tree. Throws what MeshData::validate throws.
  explicit Mesh(MeshData data, const RenderOptions& options = {})
      : contents_(std::make_shared<const Contents>(std::move(data), options)) {}

  [[nodiscard]] const MeshData& data() const { return contents_->data; }

  /// Whether it bounds a solid (MeshData::is_closed), which takes a look at all edges. Inside is what a line
  /// is in between its first crossing and its second, its third and its fourth, and so on. Normals lead out
  /// of it if the triangles turn counterclockwise as seen from there.
  [[nodiscard]] bool is_solid() const { return data().is_closed(); }
  [[nodiscard]] int part_count() const { return static_cast<int>(data().triangles.size()); }

  /// What is inside has an end on every ray.
  [[nodiscard]] bool ends_inside(const Ray&) const { return false; }

  /// Where a ray crosses the mesh first inside the range.
  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    const auto crossing = first_crossing(ray, range);
    return crossing ? std::optional(crossing->t) : std::nullopt;
  }

  /// The unit normal at a point of a triangle: that between those of its vertices, or where there are none or
  /// they cancel, the triangle's own.
  [[nodiscard]] Vec3 normal_at(const Point& point, int part) const {
    const Triangle triangle = this->triangle(part);
    if (!data().normals.empty()) {
      const Vec3 normal = normalize(of_moderate_size(between(data().normals, triangle.uv_at(point), part)));
      if (is_finite(normal)) return normal;
    }
    return triangle.normal_at(point);
  }

  /// Whether each triangle has one normal, its own.
  [[nodiscard]] bool has_flat_parts() const { return data().normals.empty(); }

  /// The place between those of the vertices; or if they have none, barycentric coordinates.
  [[nodiscard]] Uv uv_at(const Point& point, int part) const {
    const Uv uv = triangle(part).uv_at(point);
    return data().uvs.empty() ? uv : between(data().uvs, uv, part);
  }

  /// That of a triangle: what lies in its plane is left together, and what cannot be crossed from anywhere on
  /// it is not crossed (only_seems_crossed).
  [[nodiscard]] Departure departure(int part) const {
    Departure departure = triangle(part).departure();
    departure.part = part, departure.object = contents_.get();
    return departure;
  }

  [[nodiscard]] Bounds bounds() const { return contents_->bounds; }

  /// The first crossing inside the range, in exact order. Of triangles that are crossed at equal t, the
  /// earlier one's is the first.
  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    First<const Ray&> first{*this, ray, range};
    contents_->tree.answer(first, data().triangle_of());
    return first.crossing;
  }

  /// Whether there is any crossing inside the range.
  [[nodiscard]] bool is_met(const Ray& ray, Interval range) const {
    Any<const Ray&> any{*this, ray, range};
    contents_->tree.answer(any, data().triangle_of());
    return any.is_met;
  }

  /// first_crossing of many rays, the k-th of `count` being ray(k): tell(k, std::optional<Crossing>) is
  /// called for each, in any order. While one ray waits for memory others go on: worth while for rays that
  /// lead to different places of a mesh that the cache does not hold (bench_meshes).
  void first_crossings(std::size_t count, const auto& ray, Interval range, const auto& tell) const {
    contents_->tree.answer_each(
        count,
        [&](std::size_t k) {
          return First<Ray>{*this, ray(k), range};
        },
        [&](std::size_t k, const auto& first) { tell(k, first.crossing); }, data().triangle_of());
  }

  /// The same of is_met: tell(k, bool).
  void are_met(std::size_t count, const auto& ray, Interval range, const auto& tell) const {
    contents_->tree.answer_each(
        count,
        [&](std::size_t k) {
          return Any<Ray>{*this, ray(k), range};
        },
        [&](std::size_t k, const auto& any) { tell(k, any.is_met); }, data().triangle_of());
  }

  /// Calls visit(const Crossing&) for every crossing inside the range, near to far.
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    std::vector<Crossing> crossings;
    // The tree knows rays and no lines: what is behind the origin lies ahead of a ray that is turned around.
    const auto find_along = [&](const Ray& half, double length, bool is_behind) {
      All all{half,
              {std::max(is_behind ? -range.max : range.min, 0.0), length},
              data(),
              [&](const Triangle& triangle, std::uint32_t i) {
                const auto crossing = crossing_with(triangle, i, ray, range);
                if (crossing && (crossing->t < 0) == is_behind) crossings.push_back(*crossing);
              }};
      contents_->tree.answer(all, data().triangle_of());
    };
    if (range.max > 0) find_along(ray, range.max, false);
    if (range.min < 0) find_along(ray.turned(-ray.direction), -range.min, true);
    std::sort(crossings.begin(), crossings.end(),
              [&](const Crossing& a, const Crossing& b) { return comes_before(ray, a, b); });
    for (const Crossing& crossing : crossings) visit(crossing);
  }

#if defined(PROTOSTAR_MESH_TREE)
  /// What a tile of a picture sees of it, found for all pixels at once (SurfaceForTiles).
  using Drawn = simd::TrianglesInTile;
  void draw(Drawn& drawn, const simd::PixelRays& rays, int sample, const simd::Frustum& frustum,
            const Tile& tile, simd::Asked asked) const {
    drawn.draw(contents_->tree, rays, sample, frustum, tile, asked);
  }
#endif

  [[nodiscard]] RefinedCrossing refine(const Ray& ray, const Crossing& crossing, Precision precision) const {
    return protostar::refine(triangle(crossing.part), ray, crossing, precision);
  }

  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return triangle(crossing.part).exact_root(ray, crossing.root);
  }

 private:
  // What the tree is asked (TriangleTree).

  /// What a ray crosses first; R is Ray, or a reference to one.
  template <class R>
  struct First {
    static constexpr bool near_first = true;

    const Mesh& mesh;
    R ray;
    Interval range;
    std::optional<Crossing> crossing = {};

    bool found(double t, std::uint32_t i) {
      take({.t = t, .part = static_cast<int>(i)});
      return false;
    }
    bool maybe(const Triangle& triangle, std::uint32_t i) {
      if (const auto other = mesh.crossing_with(triangle, i, ray, range)) take(*other);
      return false;
    }

   private:
    void take(const Crossing& other) {
      if (crossing && !mesh.comes_before(ray, other, *crossing)) return;
      crossing = other;
      // What might be before it, given its error, stays in.
      range.max = std::min(range.max, latest(other.t));
    }
  };

  /// Whether it crosses anything.
  template <class R>
  struct Any {
    static constexpr bool near_first = false;

    const Mesh& mesh;
    R ray;
    Interval range;
    bool is_met = false;

    bool found(double, std::uint32_t) { return is_met = true; }
    bool maybe(const Triangle& triangle, std::uint32_t i) {
      return is_met = mesh.crossing_with(triangle, i, ray, range).has_value();
    }
  };

  /// All that it may cross: look_at(triangle, i).
  template <class LookAt>
  struct All {
    static constexpr bool near_first = false;

    const Ray& ray;
    Interval range;
    const MeshData& data;
    LookAt look_at;

    bool found(double, std::uint32_t i) { return maybe(data.triangle(i), i); }
    bool maybe(const Triangle& triangle, std::uint32_t i) {
      look_at(triangle, i);
      return false;
    }
  };
  template <class LookAt>
  All(const Ray&, Interval, const MeshData&, LookAt) -> All<LookAt>;

  /// What copies share.
  struct Contents {
    MeshData data;
    detail::TriangleTree tree;
    Bounds bounds{Point{infinity}, Point{-infinity}};

    Contents(MeshData given, const RenderOptions& options)
        : data(validated(std::move(given))), tree(data.triangles.size(), data.triangle_of(), options) {
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

  [[nodiscard]] Triangle triangle(int part) const { return data().triangle(static_cast<std::size_t>(part)); }

  /// Of what the vertices of a triangle have, that at its place u and v.
  template <class T>
  [[nodiscard]] T between(const std::vector<T>& of_vertices, const Uv& uv, int part) const {
    const auto& [a, b, c] = data().triangles[static_cast<std::size_t>(part)];
    return (1 - uv.x - uv.y) * of_vertices[a] + uv.x * of_vertices[b] + uv.y * of_vertices[c];
  }

  /// The crossing with the i-th triangle. A ray that leaves a triangle of this mesh says which by its number,
  /// and so it must not be asked after its mesh is gone.
  [[nodiscard]] std::optional<Crossing> crossing_with(const Triangle& one, std::uint32_t i, const Ray& ray,
                                                      const Interval& range) const {
    auto crossing = protostar::first_crossing(one, ray, range);
    if (!crossing) return {};
    const Departure& left = ray.departure;
    if (left.is_planar() && left.object == contents_.get() &&
        only_seems_crossed(triangle(left.part), one, ray, crossing->t))
      return {};
    crossing->part = static_cast<int>(i);
    return crossing;
  }

  [[nodiscard]] bool comes_before(const Ray& ray, const Crossing& a, const Crossing& b) const {
    const auto on_mesh = [&](const Crossing& crossing) {
      return SurfaceCrossing{.crossing = crossing, .surface = this, .functions = &functions_of<Mesh>};
    };
    return precedes(ray, on_mesh(a), a.part, on_mesh(b), b.part);
  }

  std::shared_ptr<const Contents> contents_;
};

static_assert(CompositeSurface<Mesh> && SurfaceWithParts<Mesh> && SurfaceWithBounds<Mesh> &&
              SurfaceWithUv<Mesh> && Solid<Mesh>);

}  // namespace protostar::inline PROTOSTAR_ABI
