// Surfaces that the camera rays of a tile can hit, by their index in the scene's order.
#pragma once

#include <bit>
#include <optional>
#include <tuple>
#include <type_traits>
#include <vector>

#include "../scene.hpp"
#include "../simd/prefetch.hpp"
#include "candidates.hpp"
#include "drawn.hpp"
#include "packet.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Surfaces of a scene that the rays of a tile can hit: the tile's candidates, some of which may be
/// rasterized, and surfaces without bounds.
template <Surface... S>
class TileSurfaces {
 public:
  using Drawn = std::tuple<VisibilityBuffers<S>...>;
  static constexpr bool draws = (RasterizedSurface<S> || ...);         ///< true if any type can be rasterized
  static constexpr bool has_crossings = (is_made_of_parts<S> || ...);  ///< true if any type has primitives

  TileSurfaces(const Scene<S...>& scene, const Candidates& candidates, const std::vector<int>& unbounded,
               const Drawn& drawn, RenderStatistics& statistics)
      : scene_(scene),
        candidates_(candidates),
        unbounded_(unbounded),
        drawn_(drawn),
        statistics_(statistics) {
    if constexpr (draws)
      if (candidates.size() == 1 && unbounded.empty()) {
        const int place = candidates.place(0);
        visit(place, [&]<class T>(const T&, const Material&) {
          if constexpr (RasterizedSurface<T>)
            if (buffer_at<T>(place)) only_buffer_ = place;
        });
      }
  }

  [[nodiscard]] const std::vector<Light>& lights() const { return scene_.lights(); }
  [[nodiscard]] const Color& ambient() const { return scene_.ambient(); }
  [[nodiscard]] const std::optional<Color>& sky() const { return scene_.sky(); }
  [[nodiscard]] const Texture& environment() const { return scene_.environment(); }

  // Members of Scene beyond those of Traceable.
  [[nodiscard]] std::size_t size() const { return scene_.size(); }
  template <class T>
  [[nodiscard]] const std::vector<T>& surfaces() const {
    return scene_.template surfaces<T>();
  }
  template <class T>
  [[nodiscard]] const std::vector<Material>& materials() const {
    return scene_.template materials<T>();
  }

  /// Sets the pixel at which the camera's next packet begins, and the index of its sample.
  void set_first_pixel(int x, int y, int sample = 0) const {
    if constexpr (draws) first_x_ = x, first_y_ = y, sample_ = sample;
  }

  /// Calls visit(surface, material) for the surface with this index in the scene's order.
  void visit(int place, const auto& visit) const {
    auto i = static_cast<std::size_t>(place);
    static_cast<void>((visit_group<S>(i, visit) || ...));
  }

  /// Returns true if the surface with this index has a texture.
  [[nodiscard]] bool has_texture(int place) const {
    bool has = false;
    visit(place, [&](const auto&, const Material& material) { has = static_cast<bool>(material.texture); });
    return has;
  }

  /// Returns true if only one surface can be hit, and that is rasterized; with_buffer(f) then calls
  /// f(visibility buffer, material).
  [[nodiscard]] bool sees_one_buffer() const { return only_buffer_ >= 0; }
  void with_buffer(const auto& f) const {
    visit(only_buffer_, [&]<class T>(const T&, const Material& material) {
      if constexpr (RasterizedSurface<T>) f(*buffer_at<T>(only_buffer_), material);
    });
  }

  /// Prefetches these candidates.
  void fetch(const Candidates& candidates) const {
    for (int i = 0; i < candidates.size(); ++i)
      visit(candidates.place(i), [](const auto& surface, const Material&) { prefetch(&surface); });
  }

 protected:
  template <class R>
  static constexpr bool are_of_pinhole = std::same_as<std::remove_cvref_t<R>, CameraPacket<Point>>;

  /// Returns the index, in the scene's order, of the i-th candidate, or for i < 0 of a surface without
  /// bounds.
  [[nodiscard]] int place_of(int i) const {
    return i >= 0 ? candidates_.place(i) : unbounded_[static_cast<std::size_t>(i + unbounded())];
  }
  [[nodiscard]] int unbounded() const { return static_cast<int>(unbounded_.size()); }

  /// Calls visit_place(index) for all surfaces that camera rays may hit.
  void each_candidate(const auto& visit_place) const {
    for (int i = -unbounded(); i < candidates_.size(); ++i) visit_place(place_of(i));
  }

  /// Returns the visibility buffer of the surface with this index; null if it has none.
  template <RasterizedSurface T>
  [[nodiscard]] const typename T::Drawn* buffer_at(int place) const {
    return std::get<VisibilityBuffers<T>>(drawn_).at(place, sample_);
  }

  static LaneMask one(int lane) { return mask_of<double, double_lanes>(Bits{1} << lane); }

  void count_tests(LaneMask which) const {
    statistics_.surface_tests += static_cast<std::uint64_t>(std::popcount(bits(which)));
  }

  /// Closest hit of one ray among some surfaces, and the index of its surface; −1 if it misses.
  struct PlacedCrossing {
    int place = -1;
    SurfaceCrossing crossing;
  };
  [[nodiscard, gnu::noinline]] PlacedCrossing closest_by_itself(const Ray& ray,
                                                                const auto& each_place) const {
    PlacedCrossing first;
    each_place([&](int place) {
      visit(place, [&](const auto& surface, const Material& material) {
        const auto crossing = first_crossing(surface, ray, Interval{});
        if (!crossing) return;
        const SurfaceCrossing candidate = crossing_on(surface, *crossing, material);
        if (first.place < 0 || precedes(ray, candidate, place, first.crossing, first.place))
          first = {place, candidate};
      });
    });
    return first;
  }

  const Scene<S...>& scene_;
  const Candidates& candidates_;
  const std::vector<int>& unbounded_;
  const Drawn& drawn_;
  RenderStatistics& statistics_;
  int only_buffer_ = -1;  ///< index of the only surface that can be hit, if it is rasterized; or −1
  mutable int first_x_ = 0, first_y_ = 0, sample_ = 0;

 private:
  /// Visits the i-th surface of one type and returns true; if there is none, subtracts their number from i.
  template <Surface T>
  bool visit_group(std::size_t& i, const auto& visit) const {
    const auto& surfaces = scene_.template surfaces<T>();
    if (i < surfaces.size()) {
      visit(surfaces[i], scene_.template materials<T>()[i]);
      return true;
    }
    i -= surfaces.size();
    return false;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd
