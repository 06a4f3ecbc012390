// Light sources, and the light that a scene has for a hit or for a ray that misses.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "environment.hpp"
#include "interval.hpp"
#include "magnitude.hpp"
#include "material.hpp"
#include "numeric/scale.hpp"
#include "numeric/trigonometry.hpp"
#include "ray.hpp"
#include "surfaces/coordinates.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Light that shines from one point alike in all directions (§2.3.2, A.1.4). At a distance r it brings an
/// irradiance of Φ/(4π r²) to a surface that faces it.
struct PointLight {
  Point position{0};
  Color power{0};  ///< Φ, the flux per channel, in watts; not negative. The tutorial calls it intensity.
};

/// Light at a point that brings the same irradiance at every distance, as no real one does.
struct ConstantLight {
  Point position{0};
  Color intensity{0};  ///< irradiance of a surface that faces it, in watts per square unit; not negative
};

/// Light infinitely far away, as the sun nearly is.
struct DirectionalLight {
  Vec3 direction{0, 1, 0};  ///< direction towards the light, of any length but 0
  Color intensity{0};       ///< irradiance of a surface that faces it, in watts per square unit; not negative
};

/// Point light that shines into a cone: inside as a PointLight of the same power does, outside not at all.
struct SpotLight {
  Point position{0};
  Vec3 direction{0, 0, 1};  ///< axis of the cone, away from the light, of any length but 0
  double angle = 30;        ///< angle from the axis to the edge, in degrees, above 0 and at most 180
  Color power{0};           ///< Φ, as if it shone in all directions; not negative
  double fade = 0;  ///< degrees before the edge over which the light falls to 0, by a smoothstep; if more
                    ///< than angle, the axis is dimmed, too
};

/// Light from everywhere: it is added to the irradiance of every point, and nothing occludes it.
struct AmbientLight {
  Color intensity{0};  ///< irradiance, in watts per square unit; not negative
};

/// Largest irradiance that one light brings to a point, in any channel: two million such lights add up to
/// less than the largest float, 2^128. Hence their sum is finite, and black stays black in any light, with no
/// 0 · ∞, which is NaN.
inline constexpr float most_irradiance = 0x1p107f;

/// Light of any kind that comes from one place, with the functions that an integrator needs.
class Light {
 public:
  /// Takes a light of one kind. Throws std::invalid_argument if a number is not finite, one of a position is
  /// no coordinate (magnitude.hpp), a color is negative, a direction is 0, or angle or fade is out of its
  /// range.
  Light(const PointLight& light)
      : Light("PointLight", light.position, "power", light.power, Falloff::square) {}
  Light(const ConstantLight& light)
      : Light("ConstantLight", light.position, "intensity", light.intensity, Falloff::none) {}
  Light(const DirectionalLight& light)
      : Light("DirectionalLight", Point{0}, "intensity", light.intensity, Falloff::none) {
    position_ = checked_unit(light.direction);
    w_ = 0;
  }
  Light(const SpotLight& light) : Light("SpotLight", light.position, "power", light.power, Falloff::square) {
    axis_ = checked_unit(light.direction);
    check(0 < light.angle && light.angle <= 180, "angle must be above 0 and at most 180 degrees");
    check(light.fade >= 0 && std::isfinite(light.fade), "fade must be finite and not negative");
    is_spot_ = true;
    angle_ = light.angle;
    fade_ = light.fade;
  }

  /// Returns the vector from a point, or from several, to the light. The ray along it is at the light at t =
  /// 1, or only at infinity if the light is infinitely far away; hits in the range occlusion_range() occlude
  /// the light.
  template <class V = Vec3>
  [[nodiscard]] V towards(const V& point) const {
    return position_ - w_ * point;
  }
  [[nodiscard]] Interval occlusion_range() const { return {.min = 0, .max = w_ == 0 ? infinity : 1}; }

  /// Returns the name of the type that it was made of, and its power or intensity.
  [[nodiscard]] const char* type() const { return type_; }
  [[nodiscard]] const Color& color() const { return color_; }

  /// Returns the unit axis of a spotlight, and its angle and fade in degrees; 0 for any other light.
  [[nodiscard]] const Vec3& axis() const { return axis_; }
  [[nodiscard]] double angle() const { return angle_; }
  [[nodiscard]] double fade() const { return fade_; }

  /// Returns the irradiance that the light, if nothing occludes it, brings to a point with this unit normal:
  ///   E = E⊥ · cos θ   with   cos θ = n·l/|l|,   l = towards(point);
  /// 0 if the light is behind the surface or in its plane. Very near a light it grows beyond all bounds, and
  /// is clamped to most_irradiance. Nearer than 2^-537, where |l|² is 0, cos θ counts as 1 before the
  /// surface, and the angle from a spotlight's axis as 0 or 180 degrees: sizes in a scene are 2^-400 or more
  /// (magnitude.hpp).
  template <class V = Vec3>
  [[nodiscard]] auto irradiance(const V& point, const V& normal) const {
    const V l = towards(point);
    return received(l, dot(normal, l));
  }

  /// Returns E⊥, the irradiance of a surface that faces the light; 0 nearer than 2^-537, where |l|² is 0, so
  /// that highlights, whose angles are not known there, are left out.
  template <class V = Vec3>
  [[nodiscard]] auto perpendicular_irradiance(const V& point) const {
    using std::sqrt;
    const V l = towards(point);
    return received(l, sqrt(dot(l, l)));
  }

  /// Returns the irradiance, given l = towards(point) and the light's height n·l over the surface: the
  /// light's color times height/|l| · g, with g = 1/(4π |l|²) for a power and 1 for an irradiance, and times
  /// share(l) for a spotlight.
  template <class V, class Number>
  [[nodiscard]] auto received(const V& l, const Number& height) const {
    using std::min, std::sqrt;
    const Number r2 = dot(l, l);
    const Number weight =
        falloff_ == Falloff::square ? Number(4 * std::numbers::pi * r2 * sqrt(r2)) : Number(sqrt(r2));
    const Number factor = select(height > 0.0, min(height / weight, largest_factor_), Number(0.0));
    return color_ * to_float(is_spot_ ? factor * share(l) : factor);
  }

 private:
  enum class Falloff { none, square };

  Light(const char* type, const Point& position, const char* quantity, const Color& color, Falloff falloff)
      : type_(type),
        position_(position),
        color_(color),
        // Of an irradiance the factor is a cosine, also where the square of the distance underflows. For a
        // dark power it is up to 2^127, which still is a float.
        largest_factor_(std::min(most_irradiance / std::max({color.r, color.g, color.b, 0x1p-20f}),
                                 falloff == Falloff::none ? 1.0f : 0x1p127f)),
        falloff_(falloff) {
    check(is_coordinate(position), "position must have numbers ", coordinate_rule);
    check(is_light(color), quantity, " must be finite and not negative");
  }

  void check(bool holds, const char* rule, const char* limit = "") const {
    if (!holds) throw std::invalid_argument(std::string(type_).append(": ").append(rule).append(limit));
  }

  [[nodiscard]] Vec3 checked_unit(const Vec3& direction) const {
    check(is_finite(direction) && direction != Vec3{0}, "direction must be finite and not zero");
    const Vec3 size = abs(direction);  // squares of quotients by the largest neither overflow nor vanish
    return normalize(direction / std::max({size.x, size.y, size.z}));
  }

  /// Returns the share of a spotlight's light, from 0 to 1, that goes in the direction of −l.
  template <class V>
  [[nodiscard, gnu::noinline, gnu::cold]] auto share(const V& l) const {
    using std::sqrt;
    return of_each(-dot(l, axis_) / sqrt(dot(l, l)), [this](double cosine) {
      const double inside = angle_ - 180 / std::numbers::pi * arc_cosine(cosine);
      if (!(inside >= 0)) return 0.0;
      if (inside >= fade_) return 1.0;
      const double x = inside / fade_;
      return x * x * (3 - 2 * x);
    });
  }

  const char* type_;
  Vec3 position_;  ///< position, or unit direction of a light infinitely far away
  double w_ = 1;   ///< homogeneous coordinate of position_: 1 for a position, 0 for a direction
  Color color_;
  double largest_factor_;  ///< largest factor of the color
  Falloff falloff_;
  bool is_spot_ = false;
  Vec3 axis_{0};
  double angle_ = 0, fade_ = 0;  ///< in degrees
};

/// Returns the ambient irradiance of a scene; 0 if it has none.
[[nodiscard]] Color ambient_of(const auto& scene) {
  if constexpr (requires { scene.ambient(); })
    return scene.ambient();
  else
    return Color{0};
}

/// Returns the radiance of an environment along a ray.
[[nodiscard, gnu::noinline]] inline Color environment_radiance(const Environment& environment,
                                                               const Ray& ray) {
  return environment(normalize(of_moderate_size(ray.direction)));
}

/// Returns the radiance of a ray that hits nothing: the environment's, the sky's, or `fallback` if there is
/// neither.
template <class R>
[[nodiscard]] typename R::Light sky_of(const R& ray, const auto& scene, const Color& fallback) {
  if constexpr (requires { scene.environment(); })
    if (scene.environment()) [[unlikely]]
      return environment_radiance(scene.environment(), ray);
  if constexpr (requires { scene.sky(); })
    return scene.sky().value_or(fallback);
  else
    return fallback;
}

/// Returns V · E for a light: E is its irradiance of the surface at the hit, by the shading normal, and V,
/// the visibility, is 1 if nothing is between, else 0. A light behind the surface has E = 0, and no shadow
/// ray is traced to it.
template <class Hit>
[[nodiscard]] typename Hit::Light visible_irradiance(const auto& scene, const Hit& hit, const Light& light) {
  const auto to_light = light.towards(hit.point());
  const auto height = hit.height(to_light);
  const auto in_front = height > 0.0;
  if (!any(in_front)) return typename Hit::Light(0);
  // The direction is not normalized: a light at a finite distance is at t = 1, and occluders lie in (0, 1);
  // for a light in a direction, they lie in (0, ∞).
  const auto visible =
      in_front && !scene.occluded(masked(in_front, hit.leave(to_light)), light.occlusion_range());
  if (!any(visible)) return typename Hit::Light(0);
  return select(visible, light.received(to_light, height), typename Hit::Light(0));
}

}  // namespace protostar::inline PROTOSTAR_ABI
