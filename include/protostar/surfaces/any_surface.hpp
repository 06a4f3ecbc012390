// A surface of any type, held as a value: Scene<AnySurface> is the tutorial's std::vector<Surface*> (§2.3.1).
#pragma once

#include <memory>
#include <utility>

#include "../function_ref.hpp"
#include "../ray_lanes.hpp"
#include "../surface.hpp"
#include "../surface_concepts.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Holds a copy of a surface and forwards to it through virtual calls: all that decides hits, and all that is
/// known at them. Roots and departures stay as exact as they are. Members that only save time are not passed
/// on: equations of packets, normals that are computed once, rasterizing. Copying it copies the surface; a
/// moved-from one may only be assigned to.
///
/// Constructing one compiles all functions of the surface. A program that does so in several translation
/// units may compile them once: `extern template AnySurface::AnySurface(Box)`.
class AnySurface {
 public:
  template <class S>
  requires(!std::same_as<S, AnySurface> && Surface<S>) AnySurface(S surface);

  // Compilers show the line of a deleted function that is called.
  template <detail::MeantAsSurface<AnySurface> S>
  AnySurface(S) = delete;  // a Surface has intersect(const Ray&, Interval) const and normal_at(Point) const

  AnySurface(const AnySurface& other) : held_(other.held_->copy()) {}
  AnySurface(AnySurface&&) noexcept = default;
  AnySurface& operator=(const AnySurface& other) { return *this = AnySurface(other); }
  AnySurface& operator=(AnySurface&&) noexcept = default;
  ~AnySurface() = default;

  [[nodiscard]] std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return first_t(*this, ray, range);
  }

  /// Returns the surface that is held if it is of type S, otherwise null.
  template <Surface S>
  [[nodiscard]] const S* target() const {
    return &held_->functions == &functions_of<S> ? static_cast<const S*>(held_->surface) : nullptr;
  }

  [[nodiscard]] bool is_moving() const { return held_->functions.at_rest != nullptr; }
  [[nodiscard]] Point at_rest(const Point& point, double time) const {
    return is_moving() ? held_->functions.at_rest(held_->surface, point, time) : point;
  }

  [[nodiscard]] bool has_primitives() const { return held_->has_primitives(); }
  [[nodiscard]] Vec3 normal_at(const Point& point, int primitive = 0) const {
    return held_->functions.normal_at(held_->surface, point, primitive);
  }
  [[nodiscard]] bool has_uv() const { return held_->has_uv(); }
  [[nodiscard]] Uv uv_at(const Point& point, int primitive = 0) const {
    return held_->functions.uv_at(held_->surface, point, primitive);
  }
  [[nodiscard]] bool has_tangents() const { return held_->has_tangents(); }
  [[nodiscard]] Tangents tangents_at(const Point& point, int primitive = 0) const {
    return held_->functions.tangents_at(held_->surface, point, primitive);
  }
  [[nodiscard]] bool has_distance_bound() const { return held_->has_distance_bound(); }
  /// Returns the bound of a surface that has one, otherwise 0, which bounds any distance.
  [[nodiscard]] double distance_bound(const Point& point) const { return held_->distance_bound(point); }
  [[nodiscard]] Departure departure(int primitive = 0) const {
    return held_->functions.departure(held_->surface, primitive);
  }
  [[nodiscard]] bool is_solid() const { return held_->is_solid(); }
  [[nodiscard]] bool ends_inside(const Ray& ray) const { return held_->ends_inside(ray); }
  [[nodiscard]] int primitive_count() const { return held_->primitive_count(); }
  [[nodiscard]] Bounds bounds() const { return held_->bounds(); }
  void validate() const { held_->validate(); }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const {
    return held_->first_crossing(ray, range);
  }
  [[nodiscard]] FirstOfLanes first_of_lanes(const RayLanes& rays, Interval range) const {
    return held_->first_of_lanes(rays, range);
  }
  [[nodiscard]] bool any_hit(const Ray& ray, Interval range) const { return held_->any_hit(ray, range); }
  void each_crossing(const Ray& ray, Interval range, auto&& visit) const {
    held_->each_crossing(ray, range, [&](const Crossing& crossing) { visit(crossing); });
  }
  [[nodiscard]] ExactRoot exact_root(const Ray& ray, const Crossing& crossing) const {
    return held_->functions.exact_root(held_->surface, ray, crossing);
  }

  /// Returns the set-up of a surface that is marched with a proof (Marched), otherwise null.
  [[nodiscard]] const MarchSetup* march_setup() const { return held_->march_setup(); }
  /// Marches to the first crossing in the range, and tells the listener of each step, if the surface is one
  /// that is marched with a proof.
  void march(const Ray& ray, Interval range, MarchListener& listener) const {
    held_->march(ray, range, listener);
  }
  /// Writes down the field of such a surface.
  void record_field(FieldTape& tape) const { held_->record_field(tape); }

 private:
  using Visitor = FunctionRef<void(const Crossing&)>;

  struct Holder {
    const SurfaceFunctions& functions;
    const void* surface = nullptr;  ///< first argument of the functions, which Held sets

    explicit Holder(const SurfaceFunctions& of_surface) : functions(of_surface) {}
    virtual ~Holder() = default;
    virtual std::unique_ptr<Holder> copy() const = 0;
    virtual std::optional<Crossing> first_crossing(const Ray&, Interval) const = 0;
    virtual FirstOfLanes first_of_lanes(const RayLanes& rays, Interval range) const {
      FirstOfLanes first{.t = infinity, .is_there = false, .in_doubt = false};
      set_one_by_one(first, rays.active, [&](int lane) { return first_crossing(rays.ray(lane), range); });
      return first;
    }
    virtual bool any_hit(const Ray&, Interval) const = 0;
    virtual void each_crossing(const Ray&, Interval, Visitor) const = 0;
    virtual bool has_primitives() const = 0;
    virtual bool has_uv() const = 0;
    virtual bool has_tangents() const = 0;
    virtual bool has_distance_bound() const = 0;
    virtual double distance_bound(const Point&) const { return 0; }
    virtual bool is_solid() const = 0;
    virtual bool ends_inside(const Ray&) const = 0;
    virtual int primitive_count() const = 0;
    virtual Bounds bounds() const = 0;
    virtual void validate() const = 0;
    virtual const MarchSetup* march_setup() const { return nullptr; }
    virtual void march(const Ray&, Interval, MarchListener&) const {}
    virtual void record_field(FieldTape&) const {}
  };

  template <class S>
  struct Held final : Holder {
    static_assert(detail::SurfaceOffers<S>::hold);

    explicit Held(S s) : Holder(functions_of<S>), one(std::move(s)) { surface = &one; }
    std::unique_ptr<Holder> copy() const override { return std::make_unique<Held>(one); }
    std::optional<Crossing> first_crossing(const Ray& ray, Interval range) const override {
      return protostar::first_crossing(one, ray, range);
    }
    FirstOfLanes first_of_lanes(const RayLanes& rays, Interval range) const override {
      if constexpr (SurfaceOfLanes<S>)
        return one.first_of_lanes(rays, range);
      else
        return Holder::first_of_lanes(rays, range);
    }
    bool any_hit(const Ray& ray, Interval range) const override {
      return protostar::any_hit(one, ray, range);
    }
    void each_crossing(const Ray& ray, Interval range, Visitor visit) const override {
      protostar::each_crossing(one, ray, range, visit);
    }
    bool has_primitives() const override { return protostar::has_primitives(one); }
    bool has_uv() const override { return protostar::has_uv(one); }
    bool has_tangents() const override { return protostar::has_tangents(one); }
    bool has_distance_bound() const override { return protostar::has_distance_bound(one); }
    double distance_bound(const Point& point) const override {
      if constexpr (knows_distance<S>) return one.distance_bound(point);
      return 0;
    }
    bool is_solid() const override { return protostar::is_solid(one); }
    bool ends_inside(const Ray& ray) const override { return protostar::ends_inside(one, ray); }
    int primitive_count() const override { return protostar::primitive_count(one); }
    Bounds bounds() const override { return bounds_of(one); }
    void validate() const override {
      if constexpr (requires { one.validate(); }) one.validate();
    }
    const MarchSetup* march_setup() const override {
      if constexpr (MarchedSurface<S>) return one.march_setup();
      return nullptr;
    }
    void march(const Ray& ray, Interval range, MarchListener& listener) const override {
      if constexpr (MarchedSurface<S>) static_cast<void>(one.march(ray, range, listener));
    }
    void record_field(FieldTape& tape) const override {
      if constexpr (MarchedSurface<S>) one.record_field(tape);
    }

    S one;
  };

  std::unique_ptr<Holder> held_;
};

template <class S>
requires(!std::same_as<S, AnySurface> && Surface<S>) AnySurface::AnySurface(S surface)
    : held_(std::make_unique<Held<S>>(std::move(surface))) {}

static_assert(CompositeSurface<AnySurface> && is_made_of_primitives<AnySurface> && Solid<AnySurface>);

}  // namespace protostar::inline PROTOSTAR_ABI
