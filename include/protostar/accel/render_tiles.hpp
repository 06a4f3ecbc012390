// Fills an image tile by tile: first what a tile may see, then its rays, a packet at a time.
//
// This is the fast way of render for a Scene, and it gives the bytes of the plain one. The candidates of a
// tile come from accel/tile.hpp; each of them is then decided by the certified roots of numeric/, for a
// packet of rays at once, and what these leave in doubt for one ray alone.
#pragma once

#include <type_traits>
#include <utility>

#include "../image.hpp"
#include "../scene.hpp"
#include "packet.hpp"
#include "tile.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// An integrator whose functions take packets as well as single rays, and says so. One that has shade is
/// black where a ray meets nothing.
template <class I>
concept PacketIntegrator = I::takes_packets;

/// An integrator that looks at what a ray meets first, and nothing else.
template <class I, class S>
concept ShadingIntegrator = requires(const I& integrator, const Intersection& hit, const S& scene) {
  { integrator.shade(hit, scene) } -> std::convertible_to<Color>;
};

/// A surface that says what sphere contains it.
template <class S>
concept SurfaceInSphere = Surface<S> && requires(const S& surface) {
  { surface.bounding_sphere().center } -> std::convertible_to<Point>;
  { surface.bounding_sphere().radius } -> std::convertible_to<double>;
};

/// A scene as one tile of a camera sees it. Rays<Point> are the camera's own, and only the candidates can
/// meet them; all others ask the whole scene.
template <Surface... S>
class TileScene {
 public:
  TileScene(const Scene<S...>& scene, const Candidates& candidates, const std::vector<int>& unbounded)
      : scene_(scene), candidates_(candidates), unbounded_(unbounded) {}

  [[nodiscard]] const std::vector<PointLight>& lights() const { return scene_.lights(); }

  /// What each ray of a packet of the camera's meets first.
  struct Closest {
    Doubles t = infinity;
    Indices surface = -1;  ///< its place in the scene's order
    Chosen met = false;
  };
  [[nodiscard]] Closest closest(const Rays<Point>& rays) const {
    Closest closest;
    Chosen in_doubt = false;
    const auto consider = [&](int index) {
      visit(index, [&](const auto& surface, const Color&) {
        const FirstCrossings first = first_crossings(surface, rays, rays.wanted, Interval{});
        // The order is sure where the errors of both t, 2^-30 of each, do not overlap.
        const Chosen sooner = first.met && first.t < (1 - 8 * Roots::relative_error) * closest.t;
        const Chosen later = first.t > (1 + 8 * Roots::relative_error) * closest.t;
        in_doubt = in_doubt || first.in_doubt || (first.met && !sooner && !later);
        if (!any(sooner)) return;
        closest.t = select(sooner, first.t, closest.t);
        closest.surface = select(sooner, Indices(index), closest.surface);
        closest.met = closest.met || sooner;
      });
    };
    for (const int index : unbounded_) consider(index);
    for (int i = 0; i < candidates_.size(); ++i) {
      // Where no ray has any way left to one of the candidates, it has none to those that follow.
      if (i > 0 && !any(rays.wanted && closest.t >= Doubles(candidates_.nearest(i)))) break;
      consider(candidates_.surface(i));
    }

    for (Bits left = bits(in_doubt); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const auto [index, crossing] = closest_by_itself(rays[lane]);
      const Chosen one = mask_of<double, double_lanes>(Bits{1} << lane);
      closest.t = select(one, Doubles(crossing.crossing.t), closest.t);
      closest.surface = select(one, Indices(index), closest.surface);
      closest.met = (closest.met && !one) || (one && Chosen(index >= 0));
    }
    return closest;
  }

  /// Which rays of a packet of the camera's meet anything.
  [[nodiscard]] Chosen occluded(const Rays<Point>& rays, Interval range) const {
    return occluded_by(rays, range, [&](const auto& try_surface) {
      for (const int index : unbounded_)
        if (!try_surface(index)) return;
      for (int i = 0; i < candidates_.size(); ++i)
        if (!try_surface(candidates_.surface(i))) return;
    });
  }

  /// Which rays of another packet meet anything.
  [[nodiscard]] Chosen occluded(const Rays<Vectors>& rays, Interval range) const {
    return occluded_by(rays, range, [&](const auto& try_surface) {
      for (int index = 0; index < count(); ++index)
        if (!try_surface(index)) return;
    });
  }

  /// Calls visit for all crossings of a packet of the camera's, as Scene::crossings does. What it visits has
  /// a color() for each ray: that of the surface, or white, which leaves a product as it is, where the ray
  /// does not cross it.
  void crossings(const Rays<Point>& rays, Interval range, auto&& visit_crossing) const {
    const auto cross = [&](int index) {
      visit(index, [&](const auto& surface, const Color& color) {
        const auto tell = [&](Chosen which) {
          if (any(which)) visit_crossing(SomeCross{which, color});
        };
        each_crossing_of(surface, rays, range, tell);
      });
    };
    // Both lists are in the scene's order, and so is what is visited.
    std::size_t k = 0;
    for (int i = 0; i < candidates_.size(); ++i) {
      for (; k < unbounded_.size() && unbounded_[k] < candidates_.surface(i); ++k) cross(unbounded_[k]);
      cross(candidates_.surface(i));
    }
    for (; k < unbounded_.size(); ++k) cross(unbounded_[k]);
  }

  /// Calls visit(surface, color) for the surface at a place of the scene's order.
  void visit(int index, const auto& visit) const { static_cast<void>((visit_group<S>(index, visit) || ...)); }

  [[nodiscard]] int count() const {
    return (0 + ... + static_cast<int>(scene_.template surfaces<S>().size()));
  }

 private:
  struct SomeCross {
    Chosen which;
    const Color& surface_color;
    [[nodiscard]] Colors color() const { return select(which, surface_color, Color{1}); }
  };

  /// If the index is one of a type's surfaces, visits it; if not, makes it one that starts behind them.
  template <Surface T>
  bool visit_group(int& index, const auto& visit) const {
    const auto& surfaces = scene_.template surfaces<T>();
    const auto i = static_cast<std::size_t>(index);
    if (i < surfaces.size()) {
      visit(surfaces[i], scene_.template colors<T>()[i]);
      return true;
    }
    index -= static_cast<int>(surfaces.size());
    return false;
  }

  [[nodiscard]] auto closest_by_itself(const Ray& ray) const {
    struct {
      int index = -1;
      SurfaceCrossing crossing;
    } first;
    const auto consider = [&](int index) {
      visit(index, [&](const auto& surface, const Color& color) {
        const auto crossing = first_crossing(surface, ray, Interval{});
        if (!crossing) return;
        const SurfaceCrossing candidate = crossing_on(surface, *crossing, color);
        // Of two at equal t the scene's order decides.
        const bool sooner =
            first.index < 0 || (index < first.index ? !precedes(ray, first.crossing, candidate)
                                                    : precedes(ray, candidate, first.crossing));
        if (sooner) first = {index, candidate};
      });
    };
    for (const int index : unbounded_) consider(index);
    for (int i = 0; i < candidates_.size(); ++i) consider(candidates_.surface(i));
    return first;
  }

  template <class Origin>
  [[nodiscard]] Chosen occluded_by(const Rays<Origin>& rays, Interval range, const auto& each) const {
    Chosen found = false, left = rays.wanted;
    each([&](int index) {
      visit(index, [&](const auto& surface, const Color&) {
        const CrossedByEach<Chosen> tested = crossed_by_each(surface, rays, left, range);
        Chosen met = tested.crossed;
        for (Bits alone = bits(tested.in_doubt); alone != 0; alone &= alone - 1)
          if (const int lane = std::countr_zero(alone); first_crossing(surface, rays[lane], range))
            met = met || mask_of<double, double_lanes>(Bits{1} << lane);
        found = found || met;
        left = left && !met;
      });
      return any(left);
    });
    return found;
  }

  /// Calls tell(Chosen) for the crossings with one surface, near before far, with the rays that have one.
  template <Surface T>
  static void each_crossing_of(const T& surface, const Rays<Point>& rays, Interval range, const auto& tell) {
    Bits alone = bits(rays.wanted);
    Chosen near = false, far = false;
    if constexpr (SurfaceForPackets<T>) {
      const RootsOfEach<Doubles, Chosen> roots = surface.roots_of_each(rays, rays.wanted);
      const Inside near_inside = lies_inside(roots.near(), range),
                   far_inside = lies_inside(roots.far(), range);
      const Chosen in_doubt = roots.in_doubt || (roots.meets && ((near_inside.maybe && !near_inside.surely) ||
                                                                 (far_inside.maybe && !far_inside.surely)));
      near = roots.meets && near_inside.surely && !in_doubt;
      far = roots.meets && far_inside.surely && !in_doubt && Chosen(roots.count > 1);
      alone = bits(in_doubt);
    }
    tell(near);
    tell(far);
    for (; alone != 0; alone &= alone - 1) {
      const int lane = std::countr_zero(alone);
      each_crossing(surface, rays[lane], range,
                    [&](const Crossing&) { tell(mask_of<double, double_lanes>(Bits{1} << lane)); });
    }
  }

  const Scene<S...>& scene_;
  const Candidates& candidates_;
  const std::vector<int>& unbounded_;
};

/// What is the same for all tiles of a picture.
template <class I, Surface... S>
class TileRenderer {
 public:
  TileRenderer(Image& image, const Camera& camera, const Scene<S...>& scene, const I& integrator)
      : image_(image), scene_(scene), integrator_(integrator), rays_(camera, image.width(), image.height()) {
    int first = 0;
    (add_group<S>(first), ...);
    if constexpr (shades) candidates_.sort();
  }

  /// Fills a tile.
  void operator()(const Tile& tile) const {
    Candidates in_tile, in_part, in_block;
    in_tile.add(candidates_, Frustum(rays_, tile));
    tile.each(part_side, part_side, [&](const Tile& part) {
      in_part.clear();
      in_part.add(in_tile, Frustum(rays_, part));
      if (in_part.size() == 0 && unbounded_.empty()) {
        fill(part, background());
      } else if (in_part.size() <= 3) {
        fill_block(part, in_part);
      } else {
        part.each(std::max(8, double_lanes), 4, [&](const Tile& block) {
          in_block.clear();
          in_block.add(in_part, Frustum(rays_, block));
          fill_block(block, in_block);
        });
      }
    });
  }

 private:
  static constexpr int part_side = 16;  ///< of the parts of a tile, in pixels
  static constexpr bool shades = ShadingIntegrator<I, Scene<S...>>;

  template <Surface T>
  void add_group(int& first) {
    for (const T& surface : scene_.template surfaces<T>()) {
      if constexpr (SurfaceInSphere<T>) {
        const auto sphere = surface.bounding_sphere();
        candidates_.add(first, rays_.camera().position, sphere.center, sphere.radius);
      } else {
        unbounded_.push_back(first);
      }
      ++first;
    }
  }

  [[nodiscard]] Color background() const {
    if constexpr (shades)
      return Color{0};
    else
      return integrator_.radiance(Ray{rays_.camera().position, rays_.camera().forward}, Scene<>{});
  }

  void fill(const Tile& tile, const Color& color) const {
    for (int y = tile.y0; y < tile.y1; ++y)
      std::fill(&image_(tile.x0, y), &image_(tile.x0, y) + (tile.x1 - tile.x0), color);
  }

  [[gnu::flatten]] void fill_block(const Tile& tile, const Candidates& candidates) const {
    const TileScene<S...> scene(scene_, candidates, unbounded_);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; x += double_lanes) {
        const Rays<Point> rays = rays_.packet(tile, x, y);
        write(tile, x, y, radiance(rays, scene));
      }
  }

  [[nodiscard]] Colors radiance(const Rays<Point>& rays, const TileScene<S...>& scene) const {
    if constexpr (shades)
      return shade(rays, scene.closest(rays), scene);
    else
      return integrator_.radiance(rays, scene);
  }

  [[nodiscard]] Colors shade(const Rays<Point>& rays, const typename TileScene<S...>::Closest& closest,
                             const TileScene<S...>& scene) const {
    Colors result(Color{0});
    // One surface after the other: with its own numbers the same for all its rays, nothing has to be
    // gathered.
    Chosen left = closest.met && rays.wanted;
    for (Bits some = bits(left); some != 0; some = bits(left)) {
      const auto index = closest.surface[std::countr_zero(some)];
      const Chosen on_it = left && mask_for<double>(closest.surface == Indices(index));
      scene.visit(static_cast<int>(index), [&](const auto& surface, const Color& color) {
        const Intersections hits(rays, closest.t, on_it, surface, color);
        result = select(on_it, Colors(integrator_.shade(hits, scene)), result);
      });
      left = left && !on_it;
    }
    return result;
  }

  void write(const Tile& tile, int x, int y, const Colors& colors) const {
    const int count = std::min(double_lanes, tile.x1 - x);
    for (int i = 0; i < count; ++i) image_(x + i, y) = {colors.r[i], colors.g[i], colors.b[i]};
  }

  Image& image_;
  const Scene<S...>& scene_;
  const I& integrator_;
  PixelRays rays_;
  Candidates candidates_;       ///< in the scene's order, or, for what looks at the first only, near to far
  std::vector<int> unbounded_;  ///< surfaces of which nothing is known that a tile could be tested against
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd
