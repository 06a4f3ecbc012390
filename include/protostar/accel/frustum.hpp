// The region that contains the rays of a tile: planes between its pixels and others, and a cone.
#pragma once

#include <algorithm>
#include <cmath>

#include "../bvh/box_space.hpp"
#include "../camera.hpp"
#include "../image.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Cone around the middle ray of a tile, with its tip in the apex, that contains the rays of the tile.
struct TileCone {
  Vec3 axis{0};              ///< unit vector; 0 if not certain to be at less than 85° from all rays
  double cosine_square = 0;  ///< square of the half-angle's cosine; 0 if not certain

  TileCone(const PixelRays& rays, const Tile& tile) {
    using Edge = PixelRays::Edge;
    const Camera& camera = rays.camera();
    if (rays.orientation() == 0 || camera.is_orthographic()) return;
    const Vec3 columns[] = {rays.left_edge(tile.x0, &Edge::term), rays.right_edge(tile.x1, &Edge::term)},
               rows[] = {rays.upper_edge(tile.y0, &Edge::term), rays.lower_edge(tile.y1, &Edge::term)};
    const Vec3 middle = camera.forward + 0.5 * (columns[0] + columns[1]) + 0.5 * (rows[0] + rows[1]);
    const double square = dot(middle, middle);
    if (!(0x1p-200 < square && square < 0x1p200)) return;
    // Directions within an angle below 90° of an axis form a convex cone, so one that contains the corners'
    // rays contains all between them.
    double least = 1, sum = 0;
    for (const Vec3& column : columns)
      for (const Vec3& row : rows) {
        const Vec3 corner = camera.forward + column + row;
        const double along = std::max(0.0, dot(middle, corner));
        const double of_corner = along * along / (square * dot(corner, corner));
        least = std::min(least, of_corner), sum += of_corner;
      }
    cosine_square = sum >= 0 ? least : 0;  // NaN is not certain
    if (cosine_square > 0.01) axis = middle / std::sqrt(square);
  }
};

/// Half-spaces that contain the rays of a tile: its four sides, and one that excludes what lies behind. A
/// normal that is not certain is 0, so that all points are inside.
struct TileHalfSpaces {
  HalfSpace side[5];

  TileHalfSpaces(const PixelRays& rays, const Tile& tile) {
    using Edge = PixelRays::Edge;
    const Point& apex = rays.viewpoint().apex;
    side[0] = {apex, rays.left_edge(tile.x0, &Edge::normal)};
    side[1] = {apex, -rays.right_edge(tile.x1, &Edge::normal)};
    side[2] = {apex, -rays.lower_edge(tile.y1, &Edge::normal)};
    side[3] = {apex, rays.upper_edge(tile.y0, &Edge::normal)};
    side[4] = {apex, TileCone(rays, tile).axis};
    if (rays.camera().has_lens())
      start_on_lens(rays, tile);
    else if (!rays.is_pinhole())
      start_on_film(rays, tile);
  }

 private:
  /// Sets the half-spaces to those that contain the rays from all points of a lens: the sides contain their
  /// directions, and pass beside the lens.
  void start_on_lens(const PixelRays& rays, const Tile& tile) {
    const Viewpoint& viewpoint = rays.viewpoint();
    if (viewpoint.ahead == Vec3{0}) {
      for (HalfSpace& half_space : side) half_space.normal = Vec3{0};
      return;
    }
    const double margin = rays.margin(), u = rays.lens().u_shift, v = rays.lens().v_shift;
    const auto set = [&](HalfSpace& half_space, const Vec3& inwards) {
      half_space = {viewpoint.apex - (viewpoint.lens_radius + viewpoint.drift) * inwards, inwards};
    };
    set(side[0], rays.column_edge_at(tile.x0, -margin, -u).normal);
    set(side[1], -rays.column_edge_at(tile.x1, margin, u).normal);
    set(side[2], -rays.row_edge_at(tile.y1, margin, -v).normal);
    set(side[3], rays.row_edge_at(tile.y0, -margin, v).normal);
    side[4] = {viewpoint.film - viewpoint.drift * viewpoint.ahead, viewpoint.ahead};
  }

  /// Adapts the half-spaces to rays that start on a film, between two corners in this tile. The last
  /// half-space is then the one ahead of the film. Sides of parallel rays pass through a corner, each through
  /// one of the two. Every half-space is moved out by drift, by which candidates are larger.
  void start_on_film(const PixelRays& rays, const Tile& tile) {
    const Viewpoint& viewpoint = rays.viewpoint();
    side[4] = {viewpoint.film, viewpoint.ahead};
    if (rays.camera().is_orthographic()) {
      const auto start = [&](int x, int y, double position) {
        const Point at_0 = rays.camera()(rays.pixels().u(x, position), rays.pixels().v(y, position)).origin;
        return at_0 + (viewpoint.apex - rays.camera().position);  // to the middle of a moving camera's way
      };
      side[0].on = side[3].on = start(tile.x0, tile.y0, -rays.margin());
      side[1].on = side[2].on = start(tile.x1, tile.y1, rays.margin());
    }
    for (HalfSpace& half_space : side) half_space.on -= viewpoint.drift * half_space.normal;
  }
};

/// Region that contains the rays of a tile, in float: four planes, one for each side, as unit normals to the
/// inside, and a cone around the middle ray. They pass through the camera's apex; parallel rays have no apex
/// and no cone. The planes fit a tile better, and the cone tells the sky from a sphere that fills the view
/// below it. A normal that is not certain is 0, so that all points are inside.
struct Frustum {
  using Edge = PixelRays::Edge;
  using Normal = PixelRays::FloatNormal;

  Normal side[4];  ///< unit normals to the inside of the left, right, lower and upper side; 0 if not certain
  Normal cone_axis;      ///< unit vector
  float offset[4] = {};  ///< normal · x for the points x of a side, measured from the apex
  float cosine, sine;    ///< of the cone's half-angle; 0 and 1 without a cone, or above 60°

  /// The cone is optional, since it takes longer than the planes and serves few tiles. Without it, the axis
  /// is 0.
  [[gnu::noinline]] Frustum(const PixelRays& rays, const Tile& tile, bool has_cone = true)
      : side{rays.left_edge(tile.x0, &Edge::inwards), rays.right_edge(tile.x1, &Edge::outwards),
             rays.lower_edge(tile.y1, &Edge::outwards), rays.upper_edge(tile.y0, &Edge::inwards)},
        cone_axis{},
        cosine(0),
        sine(1) {
    if (has_cone) set_cone(TileCone(rays, tile));
    if (rays.camera().is_orthographic()) set_offsets(TileHalfSpaces(rays, tile), rays.viewpoint());
  }

  [[nodiscard]] bool has_cone() const { return cosine > 0; }

 private:
  void set_cone(const TileCone& cone) {
    cone_axis = PixelRays::rounded(cone.axis);
    if (!(cone.cosine_square > 0.25)) return;
    cosine = static_cast<float>(std::sqrt(cone.cosine_square));
    sine = static_cast<float>(std::sqrt(1 - cone.cosine_square));
  }

  /// Sets the offsets of parallel rays. No candidate that float holds is as far out as 2^120.
  void set_offsets(const TileHalfSpaces& half_spaces, const Viewpoint& viewpoint) {
    for (int i = 0; i < 4; ++i) {
      const HalfSpace& plane = half_spaces.side[i];
      const double from_apex = dot(plane.normal, plane.on + viewpoint.drift * plane.normal - viewpoint.apex);
      offset[i] = static_cast<float>(std::clamp(from_apex, -0x1p120, 0x1p120));
    }
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd
