// A user-defined integrator for single rays.
#pragma once

#include <protostar/intersection.hpp>
#include <protostar/interval.hpp>
#include <protostar/ray.hpp>
#include <protostar/scene.hpp>
#include <protostar/vec3.hpp>

/// User-defined integrator with a sky, hence not black for rays that miss; asks for the closest hit, any hit
/// and all hits, also of secondary rays.
struct Mirrors {
  protostar::Color radiance(const protostar::Ray& ray, const protostar::Traceable auto& scene) const {
    return radiance(ray, scene, 3);
  }
  protostar::Color radiance(const protostar::Ray& ray, const auto& scene, int left) const {
    const auto hit = scene.intersect(ray);
    protostar::Color color{protostar::Vec3{0.5 + 0.5 * ray.direction.y}};
    scene.crossings(ray, protostar::Interval{0, 4},
                    [&](const protostar::Intersection& crossing) { color *= crossing.color(); });
    if (!hit || left == 0 || scene.occluded(ray, protostar::Interval{0, 0.5})) return color;
    const protostar::Vec3 n = hit->facing_normal(), d = ray.direction;
    return hit->color() * radiance(hit->leave(d - 2 * dot(d, n) * n), scene, left - 1) + 0.1f * color;
  }
};
