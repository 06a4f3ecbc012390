// Shows diffuse surfaces in the light of spheres, with soft shadows as the distances along one ray to each
// lamp tell them: without chance.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "../area_lights.hpp"
#include "../numeric/radians.hpp"
#include "../render.hpp"
#include "../scene_fields.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Integrator of soft shadows by distance, an approximation of DirectIntegrator for lamps that are spheres.
/// The radiance of a hit is
///   L_e + ρ/π · Σ V E
/// with its emission L_e, its color as the albedo ρ, and the irradiance E of each light. E of an area light
/// is the closed form, as if nothing hid it, and V is the share of the lamp that is seen (seen_share). Lights
/// at points and in directions get exact shadow rays. The sky, or black, if there is no hit.
///
/// V is that of a straight edge, and an estimate for anything else: if two solids hide another half of a lamp
/// each, V is ½. V is 0 where one solid hides all of the lamp, and 1 where no surface comes as near to the
/// way towards its center as the outermost rays to it are; both but for things thinner than a step
/// (seen_share), and as far as bounds of distances are distances: a lower bound hides more. A lamp that the
/// horizon of the hit cuts loses its light twice, by V and by E. Lamps do not hide each other. Distances are
/// negative inside of solids, so that all is dark there: cameras and lamps belong outside.
struct DistanceShadowIntegrator : FirstHit<DistanceShadowIntegrator> {
  AreaLights lights;
  SceneDistances distances;

  /// Prepares lights and distances of a scene; pictures of that scene can then be drawn. Throws
  /// std::invalid_argument, with a message that begins with `of`, if a surface with an emission is no sphere
  /// at rest, or a surface that is no light tells no distance.
  template <Surface... S>
  explicit DistanceShadowIntegrator(const Scene<S...>& scene,
                                    const std::string& of = "DistanceShadowIntegrator: ")
      : lights(scene), distances(scene, of) {
    bool are_spheres = lights.others() == 0;
    for (const AreaLight& light : lights.lights()) are_spheres = are_spheres && light.sphere() != nullptr;
    if (!are_spheres)
      throw std::invalid_argument(
          of + "surfaces that emit light must be spheres that do not move; another is in the scene");
  }

  /// Throws std::logic_error if the scene is not the one of the lights.
  [[nodiscard]] Color shade(const Intersection& hit, const auto& scene) const {
    return lights.matte_radiance(
        hit, scene, [&](const Light& one) { return visible_irradiance(scene, hit, one); },
        [&](const AreaLight& one) {
          const double all = one.unoccluded_irradiance(hit);
          return all > 0 ? all / std::numbers::pi * seen_share(hit.point(), *one.sphere()) : 0;
        });
  }

  /// Returns the share V of a lamp that seems to be seen from a point, from 0 to 1.
  ///
  /// The lamp has the radius r and its center the distance D from the point. At the distance t on the way to
  /// the center, rays to the lamp fill a disk with a radius of about k t, k = r/D. With the distance f from
  /// the nearest surface there, the whole disk is free if f ≥ k t, and in a solid if f ≤ −k t. The least s =
  /// f/(k t) along the way decides: V is the share of a disk on one side of a straight line at s radii from
  /// its center,
  ///   V = ½ + (s √(1 − s²) + arcsin s)/π.
  ///
  /// A step from t looks for a smaller s. As f changes no faster than t, it is m k (t + δ) or more up to δ =
  /// (f − m k t)/(1 + m k), m being the least s so far. A step is not shorter than k t/8: s changes by at
  /// most (1 + k |s|)/8 in it, and V by 2/π of that, about 0.08. Nor is it shorter than t/2^13, so that the
  /// steps along one way are fewer than 1.2e5, as ln 2^20 · 2^13 is 1.14e5. The penumbra of a lamp whose
  /// radius is less than D/2^10 is therefore coarser, and what is thinner than t/2^13 may be passed.
  ///
  /// At the hit itself f and k t are both 0. The way begins at t = D/2^20, where k t is 2^-20 r. The quotient
  /// is that of the surface of the hit there, off by the rounding of f, about 2^-53 |from|: by 2^-33
  /// |from|/r. Occluders that end nearer to the hit than D/2^20 are ignored.
  [[nodiscard]] double seen_share(const Point& from, const Sphere& lamp) const {
    const Vec3 to_center = lamp.center - from;
    const double D = length(to_center), radius = std::abs(lamp.radius), k = radius / D;
    const Vec3 direction = to_center / D;
    double least = 1;
    for (double t = 0x1p-20 * D; t < D - radius;) {
      const double f = distances.distance_bound(from + t * direction);
      least = std::min(least, f / (k * t));
      if (!(least > -1)) return 0;
      t += std::max((f - least * k * t) / (1 + least * k), std::max(k, 0x1p-10) * t / 8);
    }
    const double q = std::sqrt((1 - least) * (1 + least));
    return 0.5 + (least * q + polar_angle(least, q)) / std::numbers::pi;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
