// The fields of a scene: marches along all of its marched surfaces, and distances from all of its surfaces.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "march/march_steps.hpp"
#include "scene.hpp"
#include "scene_identity.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Listener that counts the evaluations of a march, and keeps the enclosure of t if the march ends with a
/// crossing.
class CountedMarch final : public MarchListener {
 public:
  void evaluated(Evaluation kind, const DoubleDouble& a, const DoubleDouble& b, const Result&) override {
    counts_.evaluated(kind, a.hi, b.hi);
  }
  void proven(MarchProof proof, const DoubleDouble& a, const DoubleDouble& b) override {
    is_hit_ = proof == MarchProof::sign_change || proof == MarchProof::touch;
    enclosure_ = {double_below(a), double_above(b)};
  }

  [[nodiscard]] const MarchCounts& counts() const { return counts_; }
  [[nodiscard]] bool is_hit() const { return is_hit_; }

  /// Returns the interval that contains t, if the march ended with a crossing. Both ends are equal at a
  /// touch, of which nothing is proven.
  [[nodiscard]] const Interval& enclosure() const { return enclosure_; }

 private:
  MarchCounts counts_;
  Interval enclosure_{0, 0};
  bool is_hit_ = false;
};

/// Marches along the fields of a scene's surfaces: those of Marched of a DistanceField, in AnySurface too,
/// which are marched with a proof. They are made once for a picture, and valid as long as the scene lives,
/// stays in its place and gets no further surfaces. Threads may share them.
class SceneMarches {
 public:
  /// Throws std::invalid_argument, with a message that begins with `of`, if no surface is marched.
  template <Surface... S>
  SceneMarches(const Scene<S...>& scene, const std::string& of) : scene_(scene) {
    (add(scene.template surfaces<S>()), ...);
    if (fields_.empty())
      throw std::invalid_argument(
          of +
          "no surface of the scene is marched with a proof, so that there is nothing to show; surfaces of "
          "distance fields are");
  }

  /// Calls visit(surface, const CountedMarch&) with the march of a ray along each field, as far as the
  /// closest hit of the scene needs it: along the field that is hit, up to the hit; along each other field,
  /// until the march is past that hit, or misses. The surface is named by its address in the scene.
  void each_march(const Ray& ray, const std::optional<Intersection>& hit, const auto& visit) const {
    for (const auto& [surface, march] : fields_) {
      const bool is_hit = hit && hit->surface() == surface;
      CountedMarch counted;
      march(surface, ray, Interval{0, hit && !is_hit ? hit->t : infinity}, counted);
      visit(surface, counted);
    }
  }

  /// Throws std::logic_error if a scene, or a view of it, is not the one of these marches, or has other
  /// surfaces than when they were made.
  void require(const auto& scene) const { scene_.require(scene, "SceneMarches"); }

 private:
  struct Field {
    const void* surface;
    void (*march)(const void* surface, const Ray& ray, Interval range, MarchListener& listener);
  };

  template <class T>
  void add(const SceneVector<T>& surfaces) {
    if constexpr (MarchedSurface<T>)
      for (const T& surface : surfaces)
        if (surface.march_setup() != nullptr)
          fields_.push_back(
              {&surface, [](const void* s, const Ray& ray, Interval range, MarchListener& heard) {
                 static_cast<void>(static_cast<const T*>(s)->march(ray, range, heard));
               }});
  }

  SceneIdentity scene_;
  std::vector<Field> fields_;
};

/// Distances from the surfaces of a scene that emit no light: marched surfaces, boxes, spheres and planes,
/// and all surfaces with a distance_bound, that do not move. Valid as long as SceneMarches are.
class SceneDistances {
 public:
  /// Throws std::invalid_argument, with a message that begins with `of`, if a surface that emits no light
  /// tells no distance.
  template <Surface... S>
  SceneDistances(const Scene<S...>& scene, const std::string& of) : scene_(scene) {
    std::size_t index = 0;
    (add(scene.template surfaces<S>(), scene.template materials<S>(), of, index), ...);
  }

  /// Returns a lower bound of the distance, in scene units, from a point to the nearest surface that emits no
  /// light, up to rounding. It is less than 0 inside of solids, and ∞ if there are no such surfaces.
  [[nodiscard]] double distance_bound(const Point& point) const {
    double least = infinity;
    for (const Field& field : fields_)
      if (!field.is_surely_farther(point, least))
        least = std::min(least, field.distance_bound(field.surface, point));
    return least;
  }

  /// Throws std::logic_error if a scene, or a view of it, is not the one of these distances, or has other
  /// surfaces than when they were made.
  void require(const auto& scene) const { scene_.require(scene, "SceneDistances"); }

 private:
  struct Field {
    const void* surface;
    double (*distance_bound)(const void* surface, const Point& point);
    Bounds box;  ///< contains the surface, with a margin for the rounding of distances

    /// Tests whether the box is surely farther from a point than a distance: then the surface is, too, and
    /// need not tell its distance. 2^-40 covers the roundings of the squares, each of 2^-53.
    [[nodiscard]] bool is_surely_farther(const Point& point, double distance) const {
      const Vec3 gap = max(max(box.min - point, point - box.max), Vec3{0});
      const double least = std::max(distance, 0.0);
      return dot(gap, gap) > (1 + 0x1p-40) * least * least;
    }
  };

  /// Returns bounds that are wider by 2^-40 of their sides and coordinates. Distances from spheres and boxes
  /// are off by less than 2^-50 of these and of themselves.
  static Bounds with_margin(const Bounds& box) {
    const Vec3 margin = 0x1p-40 * (abs(box.min) + abs(box.max));
    return {box.min - margin, box.max + margin};
  }

  /// Adds those of some surfaces that emit no light. `index` is that of the first in the scene, and becomes
  /// that behind the last.
  template <class T>
  void add(const SceneVector<T>& surfaces, const SceneVector<Material>& materials, const std::string& of,
           std::size_t& index) {
    for (std::size_t i = 0; i < surfaces.size(); ++i, ++index) {
      if (!is_black(materials[i].emission)) continue;
      if constexpr (knows_distance<T>)
        if (has_distance_bound(surfaces[i]) && !is_moving(surfaces[i])) {
          fields_.push_back({&surfaces[i],
                             [](const void* s, const Point& point) {
                               return static_cast<const T*>(s)->distance_bound(point);
                             },
                             with_margin(bounds_of(surfaces[i]))});
          continue;
        }
      throw std::invalid_argument(
          of + "surface " + std::to_string(index) +
          " of the scene, counted from 0 in the order of its types, tells no distance; marched surfaces, "
          "boxes, spheres and planes do, and surfaces with double distance_bound(const Point&) const");
    }
  }

  SceneIdentity scene_;
  std::vector<Field> fields_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
