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
#include "prepared_scene.hpp"
#include "scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Listener that counts the evaluations of a march, and keeps the enclosure of t if the march ends with a
/// crossing.
class CountedMarch final : public MarchListener {
 public:
  void evaluated(Evaluation kind, double a, double b, const Result&) override {
    counts_.evaluated(kind, a, b);
  }
  void proven(MarchProof proof, double a, double b) override {
    is_hit_ = proof == MarchProof::sign_change || proof == MarchProof::touch;
    enclosure_ = {a, b};
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

/// Fields of a scene's surfaces. They are made once for a picture, and valid as long as the scene lives,
/// stays in its place and gets no further surfaces. Threads may share them.
///
/// Marches are known for surfaces that are marched with a proof: Marched of a DistanceField, in AnySurface
/// too. Distances are known for these, for boxes, spheres and planes, and for all surfaces with a
/// distance_bound.
class SceneFields {
 public:
  template <Surface... S>
  explicit SceneFields(const Scene<S...>& scene) : scene_(scene) {
    (add(scene.template surfaces<S>(), scene.template materials<S>()), ...);
  }

  /// Calls visit(surface, const CountedMarch&) with the march of a ray along each field, as far as the
  /// closest hit of the scene needs it: along the field that is hit, up to the hit; along each other field,
  /// until the march is past that hit, or misses. The surface is named by its address in the scene.
  void each_march(const Ray& ray, const std::optional<Intersection>& hit, const auto& visit) const {
    for (const Field& field : fields_) {
      if (field.march == nullptr) continue;
      const bool is_hit = hit && hit->surface() == field.surface;
      CountedMarch counted;
      field.march(field.surface, ray, Interval{0, hit && !is_hit ? hit->t : infinity}, counted);
      visit(field.surface, counted);
    }
  }

  /// Returns a bound of the distance from a point to the nearest surface that emits no light: none
  /// is nearer, up to rounding. Less than 0 inside of solids; ∞ if there are no surfaces. Requires
  /// require_distances() to have passed.
  [[nodiscard]] double distance_bound(const Point& point) const {
    double least = infinity;
    for (const Field& field : fields_)
      if (!field.emits) least = std::min(least, field.distance_bound(field.surface, point));
    return least;
  }

  /// Throws std::invalid_argument, in the name of an integrator, if no distance is known for a surface that
  /// emits no light.
  void require_distances(const std::string& integrator) const {
    for (std::size_t i = 0; i < fields_.size(); ++i)
      if (!fields_[i].emits && fields_[i].distance_bound == nullptr)
        throw std::invalid_argument(
            integrator + ": surface " + std::to_string(i) +
            " of the scene, counted from 0 in the order of its types, tells no distance; marched surfaces, "
            "boxes, spheres and planes do, and surfaces with double distance_bound(const Point&) const");
  }

  /// Throws std::invalid_argument, in the name of an integrator, if no surface is marched.
  void require_marches(const std::string& integrator) const {
    for (const Field& field : fields_)
      if (field.march != nullptr) return;
    throw std::invalid_argument(integrator +
                                ": no surface of the scene is marched with a proof, so that there is nothing "
                                "to show; surfaces of distance fields are");
  }

  /// Throws std::logic_error if a scene, or a view of it, is not the one of these fields, or has other
  /// surfaces than when they were made.
  void require(const auto& scene) const { scene_.require(scene, "SceneFields"); }

 private:
  /// Surface with its functions for marches and distances, which are null if it has none.
  struct Field {
    const void* surface;
    bool emits;
    void (*march)(const void* surface, const Ray& ray, Interval range, MarchListener& listener);
    double (*distance_bound)(const void* surface, const Point& point);
  };

  template <class T>
  void add(const SceneVector<T>& surfaces, const SceneVector<Material>& materials) {
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      Field field{&surfaces[i], !is_black(materials[i].emission), nullptr, nullptr};
      if constexpr (MarchedSurface<T>)
        if (surfaces[i].march_setup() != nullptr)
          field.march = [](const void* s, const Ray& ray, Interval range, MarchListener& listener) {
            static_cast<void>(static_cast<const T*>(s)->march(ray, range, listener));
          };
      if constexpr (knows_distance<T>)
        if (has_distance_bound(surfaces[i]) && !is_moving(surfaces[i]))
          field.distance_bound = [](const void* s, const Point& point) {
            return static_cast<const T*>(s)->distance_bound(point);
          };
      fields_.push_back(field);
    }
  }

  PreparedScene scene_;
  std::vector<Field> fields_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
