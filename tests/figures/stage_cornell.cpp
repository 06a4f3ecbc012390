// Figures of stage 25: light that takes color from a wall, and light that a ball of glass gathers.
#include <algorithm>
#include <cmath>
#include <protostar/refraction.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <vector>

#include "figures.hpp"
#include "scenes/cornell_box.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Shows the room as the camera does, cut open behind the ball and the front of the box.
void color_bleeding(Drawing& drawing) {
  constexpr double side = 555, cut = 280, scale = 0.5;
  const auto scene = cornell_box();
  const Sketch room(drawing, {160, 310}, scale);
  const auto shown = [](const Point& p) { return Point{side - p.x, p.y, 0}; };  // the camera looks along z
  const auto line = [&](const Point& from, const Point& to, Paint paint, Stroke stroke = Stroke::thin) {
    room.line(shown(from), shown(to), paint, stroke);
  };
  line({0, 0, cut}, {side, 0, cut}, Paint::ink, Stroke::bold);
  line({0, side, cut}, {side, side, cut}, Paint::ink, Stroke::bold);
  line({0, 0, cut}, {0, side, cut}, Paint::red, Stroke::bold);
  line({side, 0, cut}, {side, side, cut}, Paint::green, Stroke::bold);
  line({213, 549, cut}, {343, 549, cut}, Paint::orange, Stroke::bold);

  const Point on_floor{110, 0, cut}, in_lamp{278, 554, cut};
  const auto floor = scene.intersect({.origin = {110, 1, cut}, .direction = {0, -1, 0}}, Interval{});
  expect(floor && std::abs(floor->point().y) < 1e-9, "color_bleeding");
  const auto wall = scene.intersect(floor->leave({-1, 2, 0}), Interval{});
  expect(wall && std::abs(wall->point().x) < 1e-9 && wall->color().r > 10 * wall->color().g,
         "color_bleeding");
  const Point on_wall = wall->point();
  const auto lamp = scene.intersect(wall->leave(normalize(in_lamp - on_wall)), Interval{});
  expect(lamp && !is_black(lamp->material().emission), "color_bleeding");
  room.arrow(shown(in_lamp), shown(on_wall), Paint::orange, Stroke::bold);
  room.arrow(shown(on_wall), shown(on_floor), Paint::red, Stroke::bold);
  room.arrow(shown(on_floor), shown({300, 200, cut}), Paint::red);
  room.arrow(shown(in_lamp), shown(on_floor), Paint::orange);
  room.mark(shown(on_floor), Paint::ink);
  room.mark(shown(on_wall), Paint::ink);
  room.words(shown({300, 200, cut}), {-8, -8}, "to the eye", Paint::ink, Anchor::end);
  room.words(shown({278, side, cut}), {0, -12}, "the lamp", Paint::orange, Anchor::middle);
  room.words(shown(on_wall), {14, 0}, "sends on the red part", Paint::red);
  room.words(shown({side, 300, cut}), {-10, 0}, "green wall", Paint::green, Anchor::end);
  room.words(shown(on_floor), {0, 26}, "white floor", Paint::ink, Anchor::middle);
}

/// Shows rays of the lamp's middle that go through the ball, in the plane of both and its center.
void caustic(Drawing& drawing) {
  const Sphere ball{.center = {0, 90, 0}, .radius = 90};
  const Point lamp{std::hypot(278.0 - 190, 279.5 - 190), 554, 0};
  Scene<Sphere, Plane> scene;
  scene.add(ball, Material{.refract = 1, .ior = 1.5});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{1});
  const Sketch sketch(drawing, {300, 330}, 0.53);
  sketch.circle(ball.center, ball.radius, Paint::blue);
  sketch.line({-330, 0, 0}, {330, 0, 0}, Paint::ink, Stroke::bold);
  constexpr int rays = 11;
  const Vec3 axis = normalize(ball.center - lamp), across{-axis.y, axis.x, 0};
  double least = 1e9, most = -1e9;
  for (int i = 0; i < rays; ++i) {
    const Point aim = ball.center + 0.8 * ball.radius * (2.0 * i / (rays - 1) - 1) * across;
    Ray ray{.origin = lamp, .direction = normalize(aim - lamp)};
    for (int step = 0; step < 3; ++step) {
      const auto hit = scene.intersect(ray, Interval{});
      expect(hit.has_value(), "caustic");
      sketch.line(ray.origin, hit->point(), Paint::orange);
      if (step == 2) {
        expect(std::abs(hit->point().y) < 1e-9, "caustic");
        least = std::min(least, hit->point().x);
        most = std::max(most, hit->point().x);
        break;
      }
      const Vec3 outside = normalize(hit->point() - ball.center);
      const auto [passes, bent] =
          refracted(ray.direction, step == 0 ? outside : -outside, step == 0 ? 1 / 1.5 : 1.5);
      expect(passes, "caustic");
      ray = hit->leave(normalize(bent));
    }
  }
  expect(most - least < 0.6 * ball.radius, "caustic");  // gathered from 1.6 radii
  sketch.line({least, 0, 0}, {most, 0, 0}, Paint::red, Stroke::bold);
  sketch.lamp(lamp);
  sketch.words(lamp, {22, 6}, "the lamp", Paint::orange);
  sketch.words(ball.center, {-44, -46}, "glass", Paint::blue, Anchor::end);
  sketch.words({(least + most) / 2, 0, 0}, {0, 24}, "the caustic", Paint::red, Anchor::middle);
  // A path from the eye draws directions out of the floor alike; few lead through the ball to the lamp.
  const Point place{(least + most) / 2, 0, 0};
  for (const double degrees : {15.0, 45.0, 135.0, 165.0})
    sketch.arrow(place, place + 190.0 * at_angle(degrees), Paint::gray);
}

}  // namespace

std::vector<StageFigure> cornell_figures() {
  return {
      {"color_bleeding", "25_cornell", "Light of the lamp falls on the red wall, and red light on the floor",
       350, color_bleeding},
      {"caustic", "25_cornell", "Rays of the lamp that a ball of glass gathers on a small piece of the floor",
       364, caustic},
  };
}

}  // namespace figures
