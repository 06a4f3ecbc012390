// Shows light, shadows, mirrors and glass by recursive rays: Whitted's picture.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "../numeric/power.hpp"
#include "../refraction.hpp"
#include "../scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Number of rays that paths may still take in this thread.
inline thread_local std::int64_t whitted_rays_left = 0;

[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_paths(std::int64_t most, int depth) {
  throw std::runtime_error(
      "WhittedIntegrator: more than " + std::to_string(most) +
      " rays follow one ray of the camera, by paths of up to " + std::to_string(depth) +
      " rays; a smaller depth, or fewer materials that both reflect and refract, take fewer");
}

}  // namespace detail

/// Integrator of the equation at Material, without glossy lobes: the emission, the light from lights that are
/// not occluded, and the radiance from the mirror direction and the refracted direction, by rays of their own
/// (Whitted 1980, "An Improved Illumination Model for Shaded Display"). The sky, or black, if there is no
/// hit.
struct WhittedIntegrator {
  using TakesPackets = WhittedIntegrator;  ///< takes packets as well as rays (accel/packet.hpp)

  /// Largest depth. Each ray of a path is a call inside the call for the ray before, on a thread's stack, of
  /// which Linux gives 8 MB: a path of 3000 rays fits, one of 10000 does not.
  static constexpr int most_depth = 1000;

  /// Largest number of rays in one path, from 0 to most_depth; 1 is the camera's alone. A path that is cut
  /// sees the sky.
  int depth = 10;

  /// Throws std::invalid_argument if depth is not in its range. render calls it; if radiance is called
  /// directly, it throws for a depth below 0 when the first path ends.
  void validate() const {
    if (depth < 0 || depth > most_depth) [[unlikely]]
      throw std::invalid_argument("WhittedIntegrator: depth must be from 0 to " + std::to_string(most_depth) +
                                  "; it is " + std::to_string(depth));
  }

  /// Largest number of rays that follow one ray of the camera, to surfaces and to lights: if a material
  /// reflects and refracts, they may double with each ray of a path, and 2^22 take about a second. radiance
  /// and shade throw std::runtime_error if there are more; for a packet of n rays, the limit is n times as
  /// high.
  std::int64_t most_rays = std::int64_t{1} << 22;

  /// Returns the radiance along a camera's ray, which begins a path.
  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    detail::whitted_rays_left = most_rays;
    return trace_path(ray, scene, depth);
  }

  template <class R>
  [[nodiscard]] typename R::Light background(const R& ray, const auto& scene) const {
    return sky_of(ray, scene, Color{0});
  }

  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto& scene) const {
    if (depth < 1) return end_of_path(hit.leave(hit.direction()), scene);
    const std::int64_t n = std::max(count_of(hit.leave(hit.direction())), 1);
    detail::whitted_rays_left = most_rays > std::numeric_limits<std::int64_t>::max() / n
                                    ? std::numeric_limits<std::int64_t>::max()
                                    : most_rays * n;
    return from_hit(hit, scene, depth);
  }

 private:
  /// Returns the radiance of a ray at the depth limit, which is not traced.
  template <class R>
  [[nodiscard]] typename R::Light end_of_path(const R& ray, const auto& scene) const {
    validate();
    return background(ray, scene);
  }

  /// Returns the number of active rays of a packet, or 1 for a single ray: the factor on most_rays.
  static int count_of(const auto& rays) {
    if constexpr (requires { rays.active; })
      return std::popcount(bits(rays.active));
    else
      return 1;
  }

  /// Traces the ray; returns the radiance from its closest hit, or of the sky. The path takes at most `rays`
  /// rays, this one included.
  template <class R>
  [[nodiscard]] typename R::Light trace_path(const R& ray, const auto& scene, int rays) const {
    if (rays < 1) return end_of_path(ray, scene);
    const auto sky = [&] { return background(ray, scene); };
    const auto shade_hit = [&](const auto& hit) { return from_hit(hit, scene, rays); };
    // A packet takes several times the stack of one ray, so only the first rays of a path are traced as
    // packets.
    constexpr int together = 32;
    if (depth - rays < together) return follow(ray, scene, sky, shade_hit);
    return follow_each(ray, scene, sky, shade_hit);
  }

  /// Returns the radiance of a hit along its ray.
  template <class Hit>
  [[nodiscard]] typename Hit::Light from_hit(const Hit& hit, const auto& scene, int rays) const {
    return outgoing_radiance(hit.leave(normalize(hit.direction())), hit.normals(), hit.color(),
                             hit.material(), scene, rays);
  }

  /// Returns the radiance that a surface sends back along a ray, given the ray as it would go on from the
  /// hit, with a unit direction. No type of surface is left in it, so that it is compiled once for all of
  /// them.
  template <class R>
  [[nodiscard, gnu::noinline]] typename R::Light outgoing_radiance(const R& onward, const auto& outside,
                                                                   const typename R::Light& color,
                                                                   const Material& material,
                                                                   const auto& scene, int rays) const {
    // Counts the ray that led here and one to each light, at the most; a packet counts as one ray.
    if ((detail::whitted_rays_left -= 1 + std::ssize(scene.lights())) < 0)
      detail::refuse_paths(most_rays, depth);
    const auto& direction = onward.direction;
    const auto enters = dot(outside.surface, direction) <= 0.0;
    const auto normals = outside.facing(direction);
    R mirrored = onward.with_direction(reflected(direction, normals.shading));
    auto result = direct_radiance(mirrored, normals, color, material, scene);
    result += material.emission;
    // Rays that are traced must not lead into the surface.
    const auto normal = mirroring_normal(normals, direction);
    if (normals.is_mapped) mirrored = onward.with_direction(reflected(direction, normal));
    // Shares are floats: a share that rounds to 0 adds nothing, whatever is in the mirror.
    const float reflect = to_float(material.reflect), refract = to_float(material.refract);
    if (reflect > 0) result += reflect * trace_path(mirrored, scene, rays - 1);
    if (refract > 0) {
      const auto ratio = select(enters, 1 / material.ior, material.ior);
      auto [passes, bent] = refracted(direction, normal, ratio);
      if (normals.is_mapped) passes = passes && dot(normals.surface, bent) < 0.0;
      if (any(passes)) {
        const auto seen = trace_path(masked(passes, onward.with_direction(bent)), scene, rays - 1);
        result = select(passes, result + refract * seen, result);
      }
    }
    return clamped(result);
  }

  /// Returns the radiance that comes from the lights. The angle between the mirror image of the direction to
  /// the light and the direction to the eye is that between the direction to the light and the mirrored ray,
  /// which is used.
  template <class R>
  [[nodiscard, gnu::noinline]] static typename R::Light direct_radiance(const R& mirrored,
                                                                        const auto& normals,
                                                                        const typename R::Light& color,
                                                                        const Material& material,
                                                                        const auto& scene) {
    typename R::Light result = color * ambient_of(scene);
    const auto lit = !is_black(color) || !is_black(material.specular);
    if (!any(lit)) return result;  // no light can be reflected here

    for (const auto& light : scene.lights()) {
      const auto to_light = light.towards(mirrored.origin);
      const auto height = normals.height(to_light);
      const auto in_front = lit && height > 0.0;
      if (!any(in_front)) continue;  // a light behind the surface needs no shadow ray
      auto sent = color * light.received(to_light, height);
      if (!is_black(material.specular)) {
        const auto share = lobe(dot(mirrored.direction, to_light) / length(to_light), material.shininess);
        if (const auto shines = share > 0.0f; any(shines)) {
          const auto highlight = material.specular * light.perpendicular_irradiance(mirrored.origin) * share;
          sent = select(shines, sent + highlight, sent);
        }
      }
      // Light that adds nothing needs no shadow ray.
      const auto counts = in_front && !is_black(sent);
      if (!any(counts)) continue;
      const auto visible = counts && !scene.occluded(masked(counts, mirrored.with_direction(to_light)),
                                                     light.occlusion_range());
      result = select(visible, result + sent, result);
    }
    return result;
  }

  /// Returns cos^shininess, rounded to float; 0 if the cosine is not positive.
  template <class Number>
  [[nodiscard]] static auto lobe(const Number& cosine, double shininess) {
    using std::min;
    const auto ahead = cosine > 0.0;
    const Number x = select(ahead, min(cosine, 1.0), Number(0.0));
    if (const int n = static_cast<int>(std::min(shininess, 0x1p16)); n == shininess) {
      // If the nearest float is certain, double is enough. The error is below n u, with n + 3 for the
      // roundings here.
      const Number power = whole_power(x, n), error = (n + 3) * 0x1p-53 * power;
      const auto least = to_float(power - error), most = to_float(power + error);
      if (!any(least < most)) return select(ahead, most, to_float(Number(0.0)));
    }
    return to_float(of_each(x, [&](double one) { return exact_lobe(one, shininess); }));
  }

  /// Returns cosine^shininess, rounded to float from double-double, for a cosine of at most 1; 0 if it is not
  /// positive.
  [[nodiscard, gnu::noinline, gnu::cold]] static float exact_lobe(double cosine, double shininess) {
    // Below 2^-150 the power is 0 as a float. It is at most e^(−shininess · (1 − cos)), as ln cos ≤ cos − 1.
    if (!(cosine > 0) || shininess * (1 - cosine) > 150 * std::numbers::ln2) return 0;
    constexpr double normal_least = std::numeric_limits<double>::min();  // pow takes no less
    return static_cast<float>(
        static_cast<double>(pow(DoubleDouble(std::max(cosine, normal_least)), DoubleDouble(shininess))));
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
