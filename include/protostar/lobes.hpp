// Lobes: the ways in which a surface scatters light.
//
// The light that a surface sends back along a ray is a sum of lobes. A path follows one of them, and each has
// a function `sample` that draws the direction in which the path goes on: a matte and a glossy lobe by two
// numbers, glass by one, which decides between two directions, and a mirror, which has one direction, by
// none.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "intersection.hpp"
#include "normals.hpp"
#include "refraction.hpp"
#include "sampling/glossy_lobes.hpp"
#include "sampling/sampler.hpp"
#include "sampling/warp.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Place where a surface scatters a path, as the path's ray from the eye sees it.
struct Vertex {
  Vec3 direction;         ///< unit vector along the ray, towards the surface
  Normals<Vec3> normals;  ///< unit normals, on the side that the ray comes from
  bool enters;            ///< true if that side is the surface's outside, so that a refracted ray enters

  [[gnu::always_inline]] explicit Vertex(const Intersection& hit)
      : direction(normalize(hit.direction())), normals(hit.normals()) {
    enters = dot(normals.surface, direction) <= 0;
    if (!enters) normals.turn();
  }
};

/// Direction in which a path goes on, and the factor on the light that it meets there. A path of the weight 0
/// does not go on.
struct Bounce {
  Vec3 direction{0, 0, 1};
  /// Factor on the light from there: the lobe's function · cos θ/density; for a mirror and glass, which draw
  /// no direction by a density, the share of the light.
  Color weight{0};

  /// Density that is weighed against that of rays to lights in multiple importance sampling
  /// (power_heuristic). It is the density with which the direction was drawn for a glossy lobe alone: it is
  /// infinite for a mirror and glass, whose one direction rays to lights miss, and 0 for a matte surface,
  /// which leaves the light of lights to them, whatever its density.
  double weighed_density = std::numeric_limits<double>::infinity();

  /// Returns true if the path goes on.
  [[nodiscard]] bool goes_on() const { return !is_black(weight); }
};

/// Returns the largest channel.
[[nodiscard]] inline double largest(const Color& c) { return std::max({c.r, c.g, c.b}); }

/// Returns a color times a factor, each product rounded once from double to float, and at most the largest
/// float.
[[nodiscard]] inline Color times(const Color& c, double factor) {
  return clamped({to_float(c.r * factor), to_float(c.g * factor), to_float(c.b * factor)});
}

/// Answers yes with a probability, by a number in [0, 1), and replaces the number by its place among those
/// with this answer: again a number in [0, 1), for the next question. Samplers have 2^32 different numbers,
/// so an answer may be too likely by 2^-32, divided by the probability of the answers before.
[[nodiscard]] inline bool decide(double& number, double probability) {
  const bool yes = number < probability;
  const double place = yes ? number / probability : (number - probability) / (1 - probability);
  number = std::min(place, 1 - 0x1p-53);
  return yes;
}

/// Light that is scattered alike in all directions: albedo/π of the irradiance by the shading normal.
struct DiffuseLobe {
  Color albedo{0};

  /// Returns the share of light that the lobe sends back, as far as it is known before a direction is drawn.
  [[nodiscard]] double share() const { return largest(albedo); }

  /// Draws a direction with a density in proportion to its cosine, which cancels that of the irradiance. A
  /// path that it leads into the surface, as beside a tilted normal, does not go on.
  [[nodiscard]] Bounce sample(const Vertex& vertex, const SampleSet<double>& numbers) const {
    return along(vertex, cosine_hemisphere(numbers[0], numbers[1]).direction);
  }

  /// Returns the bounce in a local direction that cosine_hemisphere has drawn.
  [[nodiscard]] Bounce along(const Vertex& vertex, const Vec3& local) const {
    const Vec3 direction = frame_around(vertex.normals.shading)(local);
    const bool is_inside = vertex.normals.is_mapped && !(dot(vertex.normals.surface, direction) > 0);
    return {copied(direction), is_inside ? Color{0} : albedo, 0};
  }
};

/// Blurred mirror at a vertex: the GGX or Phong lobe of its material around the shading normal, or around the
/// surface's own where the shading normal faces away.
class GlossyLobeAt {
 public:
  GlossyLobeAt(const Vertex& vertex, const Material& material)
      : ggx_{material.glossy, material.roughness},
        phong_{material.glossy, material.shininess},
        is_phong_(material.blur == Blur::phong),
        surface_(vertex.normals.surface) {
    const bool is_seen = dot(vertex.normals.shading, vertex.direction) <= 0;
    frame_ = frame_around(is_seen ? vertex.normals.shading : surface_);
    view_ = frame_.local(-vertex.direction);
    view_.z = std::max(view_.z, 0.0);
  }

  /// Returns the share of light that a mirror of the material would reflect to the viewer.
  [[nodiscard]] double share() const { return largest(is_phong_ ? phong_.color : ggx_.reflectance(view_.z)); }

  /// Returns the radiance that is reflected to the viewer per radiance from a unit direction and steradian;
  /// black if the direction leads into the surface.
  [[nodiscard]] Color reflection(const Vec3& direction) const {
    if (!(dot(surface_, direction) > 0)) return Color{0};
    const Vec3 light = frame_.local(direction);
    return is_phong_ ? phong_.reflection(view_, light) : ggx_.reflection(view_, light);
  }

  /// Returns the density, in 1/steradian, with which sample draws a unit direction.
  [[nodiscard]] double density(const Vec3& direction) const {
    const Vec3 light = frame_.local(direction);
    return is_phong_ ? phong_.density(view_, light) : ggx_.density(view_, light);
  }

  /// Draws a direction that the lobe reflects from. A path that it leads into the surface does not go on.
  [[nodiscard]] Bounce sample(double u, double v) const {
    const LobeSample drawn = is_phong_ ? phong_.sample(view_, u, v) : ggx_.sample(view_, u, v);
    const Vec3 direction = frame_(drawn.direction);
    return {direction, dot(surface_, direction) > 0 ? drawn.weight : Color{0}, drawn.density};
  }

 private:
  GgxLobe ggx_;
  PhongLobe phong_;
  bool is_phong_;
  Vec3 surface_, view_;  // view_ is local
  Frame frame_;
};

/// Perfect mirror.
struct MirrorLobe {
  float reflect = 0;  ///< share of light that is mirrored

  /// Returns the share of light that the lobe sends back.
  [[nodiscard]] double share() const { return reflect; }

  /// Returns the bounce in the mirror direction, by the normal of mirroring_normal.
  [[nodiscard]] Bounce sample(const Vertex& vertex) const {
    const Vec3 normal = mirroring_normal(vertex.normals, vertex.direction);
    return {reflected(vertex.direction, normal), Color{reflect}};
  }
};

/// Smooth boundary of a transparent solid: light is reflected or refracted, by Fresnel's equations.
///
/// The light that a path carries is radiance over the square of the index of refraction, which refraction
/// leaves as it is. Outside, where the index is 1, both are the same.
struct GlassLobe {
  float refract = 0;  ///< share of light that is reflected or refracted
  double ior = 1;     ///< index of refraction inside

  /// Returns the share of light that the lobe sends on.
  [[nodiscard]] double share() const { return refract; }

  /// Reflects or refracts, decided by a number from [0, 1), which is replaced by one for the next question
  /// (decide). The probabilities are Fresnel's shares, which therefore are no factors of the weight. If no
  /// angle satisfies Snell's law, all light is reflected.
  [[nodiscard]] Bounce sample(const Vertex& vertex, double& number) const {
    const Vec3 normal = mirroring_normal(vertex.normals, vertex.direction);
    const double ratio = vertex.enters ? 1 / ior : ior;
    auto [passes, bent] = refracted(vertex.direction, normal, ratio);
    if (vertex.normals.is_mapped) passes = passes && dot(vertex.normals.surface, bent) < 0;
    const double share =
        passes ? fresnel_reflectance(-dot(normal, vertex.direction), -dot(normal, bent), ratio) : 1;
    const bool reflects = decide(number, share);
    return {reflects ? reflected(vertex.direction, normal) : bent, Color{refract}};
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
