// Figures of stage 21: times of rays, and surfaces that move.
#include <cmath>
#include <cstdint>
#include <protostar/camera.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/surfaces/moving.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Returns a ball that goes to the right.
Moving<Sphere> ball_to_the_right(double x, double speed) {
  return {Sphere{.center = {x, 0, 5}, .radius = 1}, {speed, 0, 0}};
}

/// Returns true if the ray along z at x meets the ball at a time.
bool is_met(const Moving<Sphere>& ball, double x, double time) {
  Ray ray{.origin = {x, 0, 0}, .direction = {0, 0, 1}};
  ray.time = time;
  return ball.intersect(ray).has_value();
}

// ---- Idea

void world_lines(Drawing& drawing) {
  // To the right: x. Upwards: the time, of which 1 is shown in 2.6 units.
  constexpr double scale = 52, tall = 3.4, left = -1.6, right = 9.4;
  const Sketch sketch(drawing, {110, 250}, scale);
  const Moving<Sphere> standing = ball_to_the_right(0, 0), moving = ball_to_the_right(3.6, 3);
  const auto draw = [&](const Moving<Sphere>& ball, Paint paint) {
    const double x = ball.surface().center.x, way = ball.velocity().x;
    sketch.polygon({{x - 1, 0, 0}, {x + 1, 0, 0}, {x + way + 1, tall, 0}, {x + way - 1, tall, 0}}, paint);
  };
  draw(standing, Paint::orange);
  draw(moving, Paint::green);
  for (const double y : {0.0, tall}) sketch.line({left, y, 0}, {right, y, 0}, Paint::gray, Stroke::dashed);
  sketch.arrow({left, 0, 0}, {left, tall + 0.5, 0}, Paint::ink);
  sketch.words({left, tall + 0.5, 0}, {-8, 6}, "χ", Paint::ink, Anchor::end);
  sketch.words({right, tall, 0}, {0, -8}, "the shutter closes", Paint::gray, Anchor::end);
  sketch.words({right, 0, 0}, {0, 18}, "it opens", Paint::gray, Anchor::end);
  // The rays of three pixels, at random times
  constexpr std::uint32_t rays = 16;
  std::vector<int> hits;
  for (const double x : {0.3, 3.6, 5.3}) {
    sketch.line({x, 0, 0}, {x, tall, 0}, Paint::blue);
    int met = 0;
    for (std::uint32_t i = 0; i < rays; ++i) {
      const double time =
          SobolSampler({.seed = 4, .x = 1, .y = 0, .sample = i, .samples = rays})(set_of_time)[0];
      const bool is_hit = is_met(standing, x, time) || is_met(moving, x, time);
      if (is_hit) ++met;
      sketch.mark({x, tall * time, 0}, Paint::blue, is_hit ? Fill::full : Fill::none);
    }
    hits.push_back(met);
    sketch.words({x, 0, 0}, {0, 62}, std::to_string(met) + "/16", Paint::blue, Anchor::middle);
  }
  // The first pixel sees the standing ball always; the others see the moving one for 1/3 and 2/3 of the time.
  expect(hits[0] == 16 && std::abs(hits[1] - 16 / 3.0) < 2 && std::abs(hits[2] - 32 / 3.0) < 2,
         "world_lines");
  // Shares of the time, as the picture shows them
  constexpr int steps = 110, times = 400;
  for (int i = 0; i < steps; ++i) {
    const double x = left + (right - left) * (i + 0.5) / steps;
    int of_standing = 0, of_moving = 0;
    for (int k = 0; k < times; ++k) {
      const double time = (k + 0.5) / times;
      if (is_met(standing, x, time))
        ++of_standing;
      else if (is_met(moving, x, time))
        ++of_moving;
    }
    const auto a = static_cast<float>(of_standing) / times, b = static_cast<float>(of_moving) / times;
    const Color sky{0.75f, 0.85f, 0.95f}, first{0.7f, 0.25f, 0.04f}, second{0.05f, 0.4f, 0.1f};
    const Place corner = sketch.of({left + (right - left) * i / steps, 0, 0});
    drawing.swatch({corner.x, corner.y + 72}, scale * (right - left) / steps + 0.5, 20,
                   shown_color(first * a + second * b + sky * (1 - a - b)));
  }
  sketch.words({left, 0, 0}, {0, 62}, "picture", Paint::ink);
}

// ---- The ray is moved instead

void moved_ray(Drawing& drawing) {
  const Moving<Sphere> ball({.center = {2.3, 0.2, 0}, .radius = 0.8}, {1.1, 0.9, 0});
  constexpr double time = 0.7;
  const auto draw = [&](double left, bool is_moved) {
    const Sketch sketch(drawing, {left, 225}, 66);
    const Vec3 way = time * ball.velocity();
    const Sphere rest = ball.surface();
    Ray ray{.origin = {0, 0.3, 0}, .direction = normalize(Vec3{1, 0.12, 0})};
    ray.time = time;
    const double t = ball.intersect(ray).value();
    const Ray shifted{.origin = ray.origin - way, .direction = ray.direction};
    // Both ways have the same t: the point is another one, by the way of the ball.
    expect(std::abs(rest.intersect(shifted).value() - t) < 1e-12, "moved_ray");
    expect(length(ball.at_rest(ray.at(t), time) - shifted.at(t)) < 1e-12, "moved_ray");
    sketch.circle(rest.center, rest.radius, Paint::green, is_moved ? Fill::soft : Fill::none,
                  is_moved ? Stroke::thin : Stroke::dashed);
    sketch.circle(rest.center + way, rest.radius, Paint::green, is_moved ? Fill::none : Fill::soft,
                  is_moved ? Stroke::dashed : Stroke::thin);
    const Ray& drawn = is_moved ? shifted : ray;
    sketch.ray(drawn, t, Paint::blue, Stroke::bold);
    sketch.mark(drawn.at(t), Paint::red);
    sketch.mark(drawn.origin, Paint::ink);
    if (is_moved) {
      sketch.line(ray.origin, ray.at(t), Paint::blue, Stroke::dashed);
      sketch.arrow(ray.origin, shifted.origin, Paint::orange);
      sketch.words(0.5 * (ray.origin + shifted.origin), {-12, -6}, "− χ ċ", Paint::orange, Anchor::end);
    } else {
      sketch.arrow(rest.center, rest.center + way, Paint::orange);
      sketch.words(rest.center + 0.5 * way, {6, 18}, "χ ċ", Paint::orange);
    }
    sketch.words(drawn.at(0.5 * t), {0, -10}, "t", Paint::blue, Anchor::middle);
    const Point title{1.7, -1.15, 0};
    sketch.words(title, {0, 24}, is_moved ? "the same at rest" : "at the time χ", Paint::ink, Anchor::middle);
  };
  draw(20, false);
  draw(370, true);
}

}  // namespace

std::vector<StageFigure> motion_figures() {
  return {
      {"world_lines", "21_motion", "The ways of two balls through the time, and rays at random times", 352,
       world_lines},
      {"moved_ray", "21_motion", "A ray to a moved ball, and the ray that is moved instead", 336, moved_ray},
  };
}

}  // namespace figures
