// Area lights of a scene: its surfaces that emit light, prepared for drawing directions to them.
//
// A surface emits light if its material has an emission, L_e. It sends out this radiance from both of its
// sides and alike in all directions. A ray that hits it sees L_e, whatever the surface is. Spheres,
// parallelograms, disks, triangles and meshes also light other surfaces, at rest or Moving, and in AnySurface
// too: directions to them can be drawn. No directions are drawn to other surfaces with an emission (planes,
// boxes, quadrics, instances, solids of several): only rays in directions into which a material scatters find
// their light, those of PathIntegrator and of glossy lobes in DirectIntegrator.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "irradiance.hpp"
#include "light.hpp"
#include "light_at_hit.hpp"
#include "numeric/scale.hpp"
#include "sampling/solid_angle.hpp"
#include "scene.hpp"
#include "scene_identity.hpp"
#include "surfaces/disk.hpp"
#include "surfaces/mesh.hpp"
#include "surfaces/moving.hpp"
#include "surfaces/parallelogram.hpp"
#include "surfaces/sphere.hpp"
#include "surfaces/triangle.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// A surface of a scene that lights others. If it moves, directions to it are those from a moved point to
/// where it was made, as for rays that meet it (surfaces/moving.hpp).
class AreaLight {
 public:
  /// Triangles of a mesh, and whether they bound a solid.
  struct Triangles {
    MeshLight light;
    bool is_closed;
  };
  /// Parallelogram, and what the directions to it have in common.
  struct PreparedParallelogram : Parallelogram {
    ParallelogramLight light;
    explicit PreparedParallelogram(const Parallelogram& p)
        : Parallelogram(p), light(p.position, p.edge_u, p.edge_v) {}
  };
  using Shape = std::variant<Sphere, PreparedParallelogram, Disk, Triangle, std::shared_ptr<const Triangles>>;

  /// Makes a light of a shape, at the place where it was made, that moves as `motion` says. `surface` is the
  /// surface's address in its scene, by which hits on it are recognized.
  AreaLight(Shape shape, const Color& emission, const void* surface, const Motion& motion = {})
      : shape_(std::move(shape)), emission_(emission), surface_(surface), motion_(motion) {}

  /// Returns the radiance that the light sends out, and the address of its surface in the scene.
  [[nodiscard]] const Color& emission() const { return emission_; }
  [[nodiscard]] const void* surface() const { return surface_; }

  /// Returns the light if it is a sphere that does not move, otherwise null.
  [[nodiscard]] const Sphere* sphere() const { return is_moving() ? nullptr : std::get_if<Sphere>(&shape_); }

 private:
  [[nodiscard]] auto visit(const auto& f) const {
    return std::visit(
        [&]<class T>(const T& shape) {
          if constexpr (std::is_same_v<T, std::shared_ptr<const Triangles>>)
            return f(*shape);
          else
            return f(shape);
        },
        shape_);
  }

 public:
  /// Draws a direction from a point at a time with two numbers from [0, 1). The result's `triangle` is the
  /// primitive of the light to which it leads; 0 for a light without primitives.
  [[nodiscard]] MeshSample sample(const Point& from, double u, double v, double time = 0) const {
    const Point at_rest = motion_.at_rest(from, time);
    return visit([&]<class T>(const T& shape) -> MeshSample {
      if constexpr (std::is_same_v<T, Triangles>)
        return shape.light.sample(at_rest, u, v);
      else
        return {view(shape, at_rest).sample(u, v)};
    });
  }

  /// Returns the light if it is a rectangle that does not move, otherwise null: RectangleView::sample_each
  /// draws directions to it from several points at once.
  [[nodiscard]] const RectangleLight* rectangle() const {
    const auto* const shape = is_moving() ? nullptr : std::get_if<PreparedParallelogram>(&shape_);
    return shape != nullptr && shape->light.rectangle ? &*shape->light.rectangle : nullptr;
  }

  /// Returns true if a hit, or its crossing, is on this light, on the given primitive of it.
  [[nodiscard]] bool is_hit(const SurfaceCrossing& hit, std::size_t triangle) const {
    return hit.surface == surface_ && static_cast<std::size_t>(hit.crossing.primitive) == triangle;
  }
  [[nodiscard]] bool is_hit(const Intersection& hit, std::size_t triangle) const {
    return is_hit(hit.crossing(), triangle);
  }

  /// Returns the density, in 1/steradian, with which sample draws the direction from a point to a hit on this
  /// light; on a mesh, the density for the triangle that is hit.
  [[nodiscard]] double density(const Point& from, const Intersection& hit) const {
    const Point at_rest = motion_.at_rest(from, hit.time());
    return visit([&]<class T>(const T& shape) {
      if constexpr (std::is_same_v<T, Triangles>)
        return shape.light.density(at_rest, static_cast<std::size_t>(hit.primitive()));
      else
        return 1 / view(shape, at_rest).solid_angle();
    });
  }

  /// Returns the radiance of this light if a hit, or its crossing, is on the given primitive of it, otherwise
  /// black.
  [[nodiscard]] Color shown_by(const auto& seen, std::size_t primitive) const {
    return is_hit(seen, primitive) ? emission_ : Color{0};
  }

  /// Returns an estimate of the light that a hit reflects from this light, by one ray to it. Two numbers from
  /// [0, 1) draw a direction. If the ray along it meets the light first, the light counts times the weight: 1
  /// over the expected number of rays to this light.
  [[nodiscard]] ReflectedLight light_by_ray(const Reflector& at, const auto& scene, const Uv& numbers,
                                            double weight) const {
    const auto [drawn, triangle] = sample(at.hit.point(), numbers.x, numbers.y, at.hit.time());
    const Vec3& direction = drawn.direction;
    return at.light_by_ray(direction, drawn.density, weight, [&, primitive = triangle] {
      return follow(
          at.hit.leave(direction), scene, [] { return Color{0}; },
          [&](const Intersection& seen) { return shown_by(seen, primitive); });
    });
  }

  /// Returns the irradiance that the light would bring with radiance 1 to a hit, by its shading normal, if
  /// nothing were between: from 0 to π, or more for a mesh some of whose triangles are behind each other, as
  /// these do not hide each other either. A closed mesh is seen through twice, by triangles that turn their
  /// outside to the point and by such that turn their inside to it; the larger sum of the two counts, which
  /// is right for a convex mesh, from outside and from inside.
  [[nodiscard]] double unoccluded_irradiance(const Intersection& hit) const {
    const Vec3 normal = hit.facing_normal();
    const Point at_rest = motion_.at_rest(hit.point(), hit.time());
    return visit([&]<class T>(const T& shape) {
      if constexpr (std::is_same_v<T, Triangles>)
        return irradiance_of_mesh(shape, hit, at_rest, normal);
      else if (hit.surface() == surface_ ||
               (!is_moving() && hit.leave(normal).departure == shape.departure()))
        return irradiance_on_itself(shape, hit);
      else
        return irradiance_of(shape, at_rest, normal);
    });
  }

  /// Returns the area that the light covers in a viewer's sight, across the line of sight and on average over
  /// all directions of that line, in square units (Cauchy). It is a quarter of the area of a sphere or of a
  /// convex closed mesh, and half of the area, counted once, of a flat shape. Triangles of other meshes count
  /// as if they did not hide each other, except that half of those of a closed one are turned away.
  [[nodiscard]] double visible_area() const {
    return visit([]<class T>(const T& shape) -> double {
      if constexpr (std::is_same_v<T, Sphere>)
        return std::numbers::pi * shape.radius * shape.radius;
      else if constexpr (std::is_same_v<T, Disk>)
        return std::numbers::pi / 2 * shape.radius * shape.radius;
      else if constexpr (std::is_same_v<T, PreparedParallelogram>)
        return area_along(shape.edge_u, shape.edge_v) / 2;
      else if constexpr (std::is_same_v<T, Triangle>)
        return area_along(shape.b - shape.a, shape.c - shape.a) / 4;
      else {
        double sum = 0;
        for (const auto& [a, b, c] : shape.light.triangles()) sum += area_along(b - a, c - a) / 4;
        return shape.is_closed ? sum / 2 : sum;
      }
    });
  }

 private:
  /// Returns the area |u × v| between two edges. The length of the product is computed of edges of about 1,
  /// since the squares of an area's components may leave the range of double.
  static double area_along(const Vec3& u, const Vec3& v) {
    const int of_u = exponent_of({u}), of_v = exponent_of({v});
    const double area = length(cross(scaled(u, -of_u), scaled(v, -of_v)));
    return scaled(scaled(area, of_u), of_v);
  }

  static SphereView view(const Sphere& s, const Point& from) { return {from, s.center, s.radius}; }
  static DiskView view(const Disk& d, const Point& from) { return {from, d.position, d.normal, d.radius}; }
  static TriangleView view(const Triangle& t, const Point& from) { return {from, t.a, t.b, t.c}; }
  static ParallelogramView view(const PreparedParallelogram& p, const Point& from) { return {from, p.light}; }

  static double irradiance_of(const Sphere& s, const Point& point, const Vec3& normal) {
    return sphere_irradiance(point, normal, s.center, s.radius);
  }
  static double irradiance_of(const Disk& d, const Point& point, const Vec3& normal) {
    return disk_irradiance(point, normal, d.position, d.normal, d.radius);
  }
  static double irradiance_of(const Triangle& t, const Point& point, const Vec3& normal) {
    return triangle_irradiance(point, normal, t.a, t.b, t.c);
  }
  static double irradiance_of(const Parallelogram& p, const Point& point, const Vec3& normal) {
    return parallelogram_irradiance(point, normal, p.position, p.edge_u, p.edge_v);
  }

  /// Returns the irradiance of a point that lies on the light itself, whatever its digits say: from inside of
  /// a sphere the light is everywhere, and otherwise it is below the horizon.
  static double irradiance_on_itself(const auto&, const Intersection&) { return 0; }
  static double irradiance_on_itself(const Sphere& sphere, const Intersection& hit) {
    const bool leads_along_normal = dot(hit.surface_normal(), hit.direction()) > 0;
    const bool is_inside =
        leads_along_normal == (sphere.radius > 0);  // a negative radius turns normals inward
    return is_inside ? std::numbers::pi : 0;
  }

  [[nodiscard]] bool is_moving() const { return !(motion_.velocity == Vec3{0}); }

  [[nodiscard]] double irradiance_of_mesh(const Triangles& shape, const Intersection& hit, const Point& point,
                                          const Vec3& normal) const {
    double outside = 0, inside = 0;
    for (std::size_t i = 0; i < shape.light.triangles().size(); ++i) {
      if (is_hit(hit, i)) continue;
      const auto& [a, b, c] = shape.light.triangles()[i];
      const int exponent = exponent_of({a - point, b - a, c - a});
      const Vec3 e = scaled(b - a, -exponent), f = scaled(c - a, -exponent);
      const bool is_front = dot(cross(e, f), scaled(a - point, -exponent)) < 0;
      (is_front ? outside : inside) += triangle_irradiance(point, normal, a, b, c);
    }
    return shape.is_closed ? std::max(outside, inside) : outside + inside;
  }

  Shape shape_;
  Color emission_;
  const void* surface_;
  Motion motion_;
};

/// The area lights of a scene, in the scene's order. They are made once for a picture, and valid as long as
/// the scene lives, stays in its place and gets no further surfaces. Threads may share them.
class AreaLights {
 public:
  template <Surface... S>
  explicit AreaLights(const Scene<S...>& scene);

  /// Returns the lights, in the scene's order.
  [[nodiscard]] const std::vector<AreaLight>& lights() const { return lights_; }

  /// Returns how many surfaces emit light, but are none of the lights, as no directions are drawn to them.
  [[nodiscard]] std::size_t others() const { return others_; }

  /// Returns the lights' shares by their power, the product of visible_area and the sum of the emission's
  /// channels, to choose one of them.
  [[nodiscard]] const Shares& by_power() const { return shares_; }

  /// Returns true if any of the lights is a rectangle (AreaLight::rectangle).
  [[nodiscard]] bool has_rectangles() const { return has_rectangles_; }

  /// Densities with which a direction to a light is drawn.
  struct Drawn {
    double density = 0;      ///< by the light's sample, in 1/steradian
    double probability = 0;  ///< of the light, by by_power
  };

  /// Returns how the direction from a point to a hit is drawn; zeros if the hit is on no area light.
  [[nodiscard]] Drawn drawn(const Point& from, const Intersection& hit) const {
    const std::pair<const void*, std::size_t> wanted{hit.surface(), 0};
    const auto found = std::lower_bound(by_surface_.begin(), by_surface_.end(), wanted, is_before);
    if (found == by_surface_.end() || found->first != hit.surface()) return {};
    return {lights_[found->second].density(from, hit), shares_.probability(found->second)};
  }

  /// Throws std::logic_error if a scene, or a view of it, is not the one of these lights, or has other
  /// surfaces than when they were made.
  void require(const auto& scene) const { scene_.require(scene, "AreaLights"); }

  /// Returns the radiance of a matte surface, L_e + ρ/π · Σ E, with its emission L_e and its color as the
  /// albedo ρ. irradiance_of(light) returns the irradiance E of a Light of the scene, and share_of(light)
  /// that of an AreaLight if its radiance were 1, over π. Throws std::logic_error as require does.
  [[nodiscard]] Color matte_radiance(const Intersection& hit, const auto& scene, const auto& irradiance_of,
                                     const auto& share_of) const {
    require(scene);
    const Material& material = hit.material();
    const Color albedo = hit.color();
    if (is_black(albedo)) return material.emission;
    Color light = ambient_of(scene);
    for (const Light& one : scene.lights()) light += irradiance_of(one);
    light *= to_float(1 / std::numbers::pi);
    for (const AreaLight& one : lights_) light += one.emission() * to_float(share_of(one));
    return clamped(material.emission + albedo * clamped(light));
  }

 private:
  template <class T>
  void add(const SceneVector<T>& surfaces, const SceneVector<Material>& materials) {
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      if (const Color& emission = materials[i].emission; !is_black(emission)) {
        if (auto found = shape_in(surfaces[i]))
          lights_.emplace_back(std::move(found->shape), emission, &surfaces[i], found->motion);
        else
          ++others_;
      }
  }

  struct ShapeInMotion {
    AreaLight::Shape shape;
    Motion motion;
  };

  /// Returns the shape of a surface that directions can be drawn to, also of one that moves, or that is held
  /// by AnySurface, or both.
  template <class T>
  [[nodiscard]] static std::optional<ShapeInMotion> shape_in(const T& surface) {
    std::optional<ShapeInMotion> shape;
    const auto try_as = [&]<class Known>(std::type_identity<Known>) {
      if (const Known* const still = as<Known>(surface)) shape.emplace(ShapeInMotion{shape_as(*still), {}});
      if (const Moving<Known>* const moving = as<Moving<Known>>(surface))
        shape.emplace(ShapeInMotion{shape_as(moving->surface()), moving->motion()});
    };
    try_as(std::type_identity<Sphere>{});
    try_as(std::type_identity<Parallelogram>{});
    try_as(std::type_identity<Disk>{});
    try_as(std::type_identity<Triangle>{});
    try_as(std::type_identity<Mesh>{});
    if (const Moving<>* const moving = as<Moving<>>(surface))
      if ((shape = shape_in(moving->surface()))) shape->motion = moving->motion();
    return shape;
  }

  /// Returns the surface if it has a type, or holds one of this type; otherwise null.
  template <class Wanted, class T>
  [[nodiscard]] static const Wanted* as(const T& surface) {
    if constexpr (std::is_same_v<T, Wanted>)
      return &surface;
    else if constexpr (requires { surface.template target<Wanted>(); })
      return surface.template target<Wanted>();
    else
      return nullptr;
  }

  [[nodiscard]] static AreaLight::Shape shape_as(const auto& surface) { return surface; }
  [[nodiscard]] static AreaLight::Shape shape_as(const Parallelogram& p) {
    return AreaLight::PreparedParallelogram(p);
  }
  [[nodiscard]] static AreaLight::Shape shape_as(const Mesh& mesh) {
    const MeshData& data = mesh.data();
    std::vector<TriangleCorners> triangles;
    triangles.reserve(data.triangles.size());
    for (std::size_t i = 0; i < data.triangles.size(); ++i) {
      const Triangle t = data.triangle(i);
      triangles.push_back({t.a, t.b, t.c});
    }
    return std::make_shared<const AreaLight::Triangles>(
        AreaLight::Triangles{MeshLight(std::move(triangles)), data.is_closed()});
  }

  static bool is_before(const std::pair<const void*, std::size_t>& a,
                        const std::pair<const void*, std::size_t>& b) {
    return std::less<>{}(a.first, b.first);
  }

  SceneIdentity scene_;
  std::vector<AreaLight> lights_;
  std::size_t others_ = 0;
  bool has_rectangles_ = false;
  Shares shares_{0};
  std::vector<std::pair<const void*, std::size_t>>
      by_surface_;  ///< sorted by address, with the light's index
};

// Not inline, so that programs may compile it once for a scene type: `extern template`.
template <Surface... S>
AreaLights::AreaLights(const Scene<S...>& scene) : scene_(scene) {
  (add(scene.template surfaces<S>(), scene.template materials<S>()), ...);
  for (const AreaLight& light : lights_) {
    const Color& e = light.emission();
    has_rectangles_ = has_rectangles_ || light.rectangle() != nullptr;
    shares_.add(light.visible_area() * (double{e.r} + e.g + e.b));
  }
  for (std::size_t i = 0; i < lights_.size(); ++i) by_surface_.emplace_back(lights_[i].surface(), i);
  std::sort(by_surface_.begin(), by_surface_.end(), is_before);
}

}  // namespace protostar::inline PROTOSTAR_ABI
