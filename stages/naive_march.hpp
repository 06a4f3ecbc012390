// Finds the three spheres without their equation, by three ways to march that depend on a length epsilon, for
// the stages 30 to 32 (§3.2).
//
// Nothing here is part of the library. Each march is that of its publication, and each misses surfaces or
// finds some that are not there. The march of the stage 33_certified decides all rays of this scene.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/render.hpp>
#include <string>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/explanation.hpp"
#include "support/stage.hpp"

namespace naive_march {

using protostar::Color;
using protostar::Point;
using protostar::Ray;
using protostar::Vec3;

inline double distance(const ColoredSphere& one, const Point& p) {
  return length(p - one.sphere.center) - one.sphere.radius;
}

/// Returns the sphere that is nearest to a point.
inline const ColoredSphere& nearest(const Point& p) {
  return *std::min_element(
      the_three_spheres.begin(), the_three_spheres.end(),
      [&](const ColoredSphere& a, const ColoredSphere& b) { return distance(a, p) < distance(b, p); });
}

/// Returns the distance from a point to the nearest sphere, less than 0 in its inside.
inline double field(const Point& p) { return distance(nearest(p), p); }

/// Returns the direction in which the field grows fastest, from its differences over a short way.
inline Vec3 normal_at(const Point& p) {
  constexpr double h = 1e-4;  // in scene units: the width of the differences in the plain ray tracers
  const Vec3 x{h, 0, 0}, y{0, h, 0}, z{0, 0, h};
  return normalize(
      Vec3{field(p + x) - field(p - x), field(p + y) - field(p - y), field(p + z) - field(p - z)});
}

/// The t at which a ray ends, in scene units. The horizon of the ground is nearer: at 44.7.
constexpr double far = 50;

/// Listener to the steps of a march, which hears nothing.
struct Silent {
  void operator()(double, double) const {}
};

/// Marches by steps of the length epsilon, of which it takes 100,000 at most, until a point is not outside.
/// Returns the t of that point, or none. The listener is told each t with the value of the field there.
template <class Listener = Silent>
std::optional<double> fixed_step(const Ray& ray, double epsilon, const Listener& tell = {}) {
  double t = epsilon;
  for (int i = 0; i < 100'000 && t < far; ++i, t += epsilon) {
    const double value = field(ray.at(t));
    tell(t, value);
    if (value <= 0) return t;
  }
  return std::nullopt;
}

/// The number of steps after which the other marches give up.
constexpr int most_steps = 512;

/// Marches by steps as long as the distance to the nearest surface (Hart 1996). Returns the first t at which
/// this distance is less than epsilon, or none.
template <class Listener = Silent>
std::optional<double> sphere_tracing(const Ray& ray, double epsilon, const Listener& tell = {}) {
  double t = 0;
  for (int i = 0; i < most_steps && t < far; ++i) {
    const double free = field(ray.at(t));
    tell(t, free);
    if (free < epsilon) return t;
    t += free;
  }
  return std::nullopt;
}

/// Marches by steps of 1.6 times the distance to the nearest surface (Keinert et al. 2014). If the balls
/// around the two ends of a step, which have these distances for radii, leave a gap between them, the ray
/// goes back to the edge of the first ball, and from there by steps of 1 times the distance. Returns the
/// first t at which the distance is less than epsilon, or none.
template <class Listener = Silent>
std::optional<double> enhanced(const Ray& ray, double epsilon, const Listener& tell = {}) {
  double t = 0, before = 0, step = 0, relaxation = 1.6;
  for (int i = 0; i < most_steps && t < far; ++i) {
    const double free = field(ray.at(t));
    tell(t, free);
    if (relaxation > 1 && before + std::abs(free) < step) {
      t += before - step;
      step = before;
      relaxation = 1;
      continue;
    }
    if (free < epsilon) return t;
    before = free;
    step = relaxation * free;
    t += step;
  }
  return std::nullopt;
}

/// Returns the light that a matte sphere sends along the ray from the point that a march has found.
inline Color diffuse(const Ray& ray, const std::optional<double>& t) {
  if (!t) return Color{0};
  const Point point = ray.at(*t);
  const Vec3 normal = normal_at(point);
  const Vec3 facing = dot(normal, ray.direction) <= 0 ? normal : -normal;
  static const protostar::Light light(light_of_the_three_spheres);
  return nearest(point).color * light.irradiance(point, facing);
}

/// Draws the three spheres by a march with the stage's epsilon, and prints how many pixels are wrong,
/// compared with the picture that the spheres' equation gives.
inline void draw(Stage& stage, const auto& march) {
  const protostar::Camera camera;
  const double epsilon = stage.number("--epsilon");

  protostar::Image image = stage.image();
  StageRenderOptions options = stage.render_options();
  options.tell = [&](SampleRecord& sample) {
    const auto list = [](const auto& v) { return std::vector<double>{v.x, v.y, v.z}; };
    sample.steps.push_back({.type = "marched spheres"});
    for (const auto& [sphere, color] : the_three_spheres)
      sample.steps[0].parts.push_back(
          {"sphere", {{"center", list(sphere.center)}, {"radius", {sphere.radius}}, {"color", list(color)}}});
    const auto add = [&](double t, double value) {
      char line[80];
      std::snprintf(line, sizeof line, "t = %.17g: the field is %.17g", t, value);
      sample.told.emplace_back(line);
      sample.steps.push_back({"value", {{"t", {t}}, {"field", {value}}}});
    };
    const auto t = march(sample.ray, epsilon, add);
    const auto& light = light_of_the_three_spheres;
    sample.steps[0].numbers = {{"epsilon", {epsilon}},
                               {"hits", {t ? 1.0 : 0.0}},
                               {"position", list(light.position)},
                               {"power", list(light.power)}};
    sample.told.emplace_back(t ? "hit at the last of these t" : "no hit");
  };
  render(
      image, camera, [&](const Ray& ray) { return diffuse(ray, march(ray, epsilon, Silent{})); }, options);
  stage.save(image);

  protostar::Image exact = stage.image();
  render(exact, camera, three_spheres(), protostar::DiffuseIntegrator{}, stage.render_options());
  stage.compare(image, exact);
}

}  // namespace naive_march
