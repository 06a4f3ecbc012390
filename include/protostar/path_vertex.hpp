// Vertex of a path of PathIntegrator: its numbers, its ray to an area light, and how the path goes on.
#pragma once

#include <cstddef>
#include <new>
#include <optional>

#include "area_lights.hpp"
#include "intersection.hpp"
#include "light_at_hit.hpp"
#include "lobes.hpp"
#include "material.hpp"
#include "ray.hpp"
#include "sampling/light_sample.hpp"
#include "sampling/sampler.hpp"
#include "sampling/warp.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Numbers of a set, and the local direction of cosine_hemisphere to which the first two lead.
struct VertexNumbers : SampleSet<double> {
  Vec3 hemisphere;
  VertexNumbers(const SampleSet<double>& set, const Vec3& direction)
      : SampleSet<double>(set), hemisphere(direction) {}
  explicit VertexNumbers(const SampleSet<double>& set)
      : VertexNumbers(set, cosine_hemisphere(set[0], set[1]).direction) {}
};

/// Shares of light that a material's lobes send back (their share()), as weights for the choice of a lobe.
struct LobeShares {
  enum class Lobe { none, diffuse, glossy, mirror, glass };
  double diffuse, glossy, mirror, glass;

  LobeShares(const Material& material, const Color& albedo, const Reflector& at)
      : diffuse(DiffuseLobe{albedo}.share()),
        glossy(at.glossy ? at.glossy->share() : 0),
        mirror(MirrorLobe{to_float(material.reflect)}.share()),
        glass(GlassLobe{to_float(material.refract), material.ior}.share()) {}

  [[nodiscard]] double sharp() const { return mirror + glass; }
  [[nodiscard]] double whole() const { return diffuse + glossy + sharp(); }

  struct Choice {
    Lobe lobe;
    double share;
  };

  /// Chooses a lobe by a number in [0, 1), with a probability in proportion to its share; none if all shares
  /// are 0. The number becomes one for the next question (decide), or stays if there was no choice.
  [[nodiscard]] Choice choose(double& number) const {
    if (!(whole() > 0)) return {Lobe::none, whole()};
    if (diffuse == whole()) return {Lobe::diffuse, diffuse};  // the number stays as it is
    if (decide(number, diffuse / whole())) return {Lobe::diffuse, diffuse};
    if (glossy > 0 && decide(number, glossy / (glossy + sharp()))) return {Lobe::glossy, glossy};
    if (decide(number, mirror / sharp())) return {Lobe::mirror, mirror};
    return {Lobe::glass, glass};
  }
};

/// Choice of the light to which a ray leads.
struct ChosenLight {
  const AreaLight* area = nullptr;  ///< null: the environment, or none if the probability is 0
  double probability = 0;
  double rest = 0;  ///< number in [0, 1) for a direction to the light
};

/// Vertex of a path, at a hit whose material scatters light, and its light from an area light. Borrows the
/// hit. The integrator sets `chosen`, and then calls aim().
struct PathVertex {
  const Intersection& hit;
  VertexNumbers numbers;
  Color albedo;
  Reflector at;
  LobeShares shares;
  ChosenLight chosen;
  std::optional<LightSample> drawn;  ///< direction to the chosen area light, if one is drawn already
  LightShare share;                  ///< of the light from there
  std::size_t primitive = 0;         ///< primitive of that light, to which the ray leads

  /// Takes the hit, and the numbers that draw() returns.
  PathVertex(const Intersection& met, const auto& draw)
      : hit(met), numbers(draw()), albedo(met.color()), at(met, albedo), shares(met.material(), albedo, at) {
    if (at.glossy) at.glossy_probability = shares.glossy / shares.whole();
  }

  /// Makes the ray to the chosen light, at a place for it: in the direction that is drawn, or else in one
  /// drawn by the rest of the third number and the fourth. Returns false, and makes none, if that is no area
  /// light, or if its light would not count.
  [[nodiscard]] bool aim(Ray* place) {
    const AreaLight* const area = chosen.area;
    if (area == nullptr) return false;
    const auto [sample, triangle] =
        drawn ? MeshSample{*drawn} : area->sample(hit.point(), chosen.rest, numbers[3], hit.time());
    share = at.share_of_ray(sample.direction, sample.density, 1 / chosen.probability);
    primitive = triangle;
    if (!share.counts()) return false;
    new (place) Ray(hit.leave(copied(sample.direction)));
    return true;
  }

  /// Returns the radiance that the ray to the chosen area light finds where it hits: that of the light, or
  /// black if it hits another surface.
  [[nodiscard]] Color shown_by(const auto& seen) const { return chosen.area->shown_by(seen, primitive); }

  /// Chooses one of the material's lobes by a number and draws a direction by it. A path does not go on if
  /// the material scatters no light, or the direction leads into the surface. The bounce is made in the place
  /// of the result: a copy would wait for numbers that have just been stored (copied).
  [[nodiscard]] Bounce scatter(double& number) const {
    using Lobe = LobeShares::Lobe;
    const double whole = shares.whole();
    const Material& material = hit.material();
    const auto [lobe, of_lobe] = shares.choose(number);
    Bounce onward = lobe == Lobe::none      ? Bounce{}
                    : lobe == Lobe::diffuse ? DiffuseLobe{albedo}.along(at.vertex, numbers.hemisphere)
                    : lobe == Lobe::glossy  ? at.glossy->sample(numbers[0], numbers[1])
                    : lobe == Lobe::mirror
                        ? MirrorLobe{to_float(material.reflect)}.sample(at.vertex)
                        : GlassLobe{to_float(material.refract), material.ior}.sample(at.vertex, number);
    if (lobe == Lobe::glossy) onward.weighed_density *= of_lobe / whole;
    if (of_lobe < whole) onward.weight = times(onward.weight, whole / of_lobe);
    return onward;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
