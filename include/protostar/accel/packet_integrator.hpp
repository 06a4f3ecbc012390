// Requirements of integrators whose pictures are made of tiles and packets.
#pragma once

#include <concepts>

#include "../intersection.hpp"
#include "../ray.hpp"
#include "../render.hpp"
#include "../sampling/pixel_sampler.hpp"
#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Integrator whose functions take packets as well as single rays. It declares this for its own type only,
/// since a type derived from it may have changed a function. All rays that miss have the same radiance,
/// unless there is an environment.
template <class I>
concept PacketIntegrator = std::same_as<typename I::TakesPackets, I>;

/// Integrator of paths that begin at the closest hits of camera rays, which are found in packets, and go on
/// from hit to hit: meet(path, hit, scene, draw) returns true if the path goes on along path.ray, and
/// leave(path, scene) the light of one that hits nothing. Paths of several pixels go on together, each an
/// I::Path, whose type needs no destructor. It declares this for its own type only, as the one above.
template <class I>
concept FollowsPaths = std::same_as<typename I::FollowsPaths, I>;

/// Integrator of paths that lets several of them meet their hits at once, by meet_each() as PathIntegrator
/// has it. It declares this for its own type only, too.
template <class I>
concept MeetsTogether = FollowsPaths<I> && std::same_as<typename I::MeetsTogether, I>;

/// Integrator whose radiance of a ray is shade() of its closest hit, or background(), as FirstHit has it.
/// Camera rays are traced in packets, and each hit is shaded by itself. It declares this for its own type
/// only, too. All rays that miss have the same radiance, unless there is an environment.
template <class I>
concept ShadesEachHit = std::same_as<typename I::ShadesEachHit, I>;

/// Integrator that shades a hit by the numbers of a sampler.
template <class I, class S>
concept ShadesBySampler = requires(const I& integrator, const Intersection& hit, const S& scene,
                                   const PixelSampler& sampler) {
  { integrator.shade(hit, scene, sampler) } -> std::convertible_to<Color>;
};

/// Integrator that shades the closest hit of a ray, and has a background for a ray that misses.
template <class I, class S>
concept ShadingIntegrator = requires(const I& integrator, const Ray& ray, const Intersection& hit,
                                     const S& scene) {
  { integrator.background(ray, scene) } -> std::convertible_to<Color>;
}
&&(ShadesBySampler<I, S> || requires(const I& integrator, const Intersection& hit, const S& scene) {
  { integrator.shade(hit, scene) } -> std::convertible_to<Color>;
});

/// Integrator whose radiance of a hit is the same at all points of a surface without a texture, so that
/// shade(hit, scene) is called without a point there. It declares this for its own type only.
template <class I>
concept ShadesWithoutPoint = std::same_as<typename I::ShadesWithoutPoint, I>;

/// Integrator that asks a scene only for the crossings of a ray, in t from 0 to infinity, and for its sky,
/// and does not read the ray's own numbers. It declares this for its own type only.
template <class I>
concept AsksForCrossings = std::same_as<typename I::AsksForCrossings, I>;

/// Integrator that takes packets, or a scene of any type.
template <class I, class View>
concept TileIntegrator = PacketIntegrator<I> || Integrator<I, View>;

}  // namespace protostar::inline PROTOSTAR_ABI::simd
