#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "figures.hpp"
#include "sketch.hpp"
#include "svg.hpp"

using namespace protostar;

namespace figures {

namespace {

const Sphere ground{.center = {0, -6, 0}, .radius = 6};

/// The part of the plane z = 0 that half of the drawing shows.
struct View {
  double left;  ///< in pixels

  static constexpr double scale = 66;

  [[nodiscard]] Place of(const Point& p) const {
    return {left + scale * (p.x + 3.75), 40 + scale * (2.3 - p.y)};
  }
};

/// Draws a part of the ground, where the library's rays from above meet it.
void draw_ground(Drawing& drawing, const View& view) {
  std::vector<Place> outline;
  for (double x = -3.75; x <= 0.85; x += 0.1) {
    const Ray down{.origin = {x, 9, 0}, .direction = {0, -1, 0}};
    outline.push_back(view.of(down.at(ground.intersect(down).value())));
  }
  drawing.polyline(outline, Paint::ink, Stroke::bold);
}

/// Draws a hit point that is rounded to whole numbers. The start of the shadow ray is lifted, but not enough.
void draw_too_small(Drawing& drawing, const View& view) {
  constexpr double offset = 0.2;
  const Ray from_camera{.origin = {-3.2, 1.6, 0}, .direction = {0.8, -2.1, 0}};
  const Point hit = from_camera.at(ground.intersect(from_camera).value());
  const Point stored{std::round(hit.x), std::round(hit.y), 0};
  const Ray to_light{.origin = stored + offset * ground.normal_at(stored), .direction = {0.766, 0.643, 0}};
  const double again = ground.intersect(to_light).value();
  expect(length(to_light.origin - ground.center) < ground.radius, "epsilon");

  for (int x = -3; x <= 0; ++x)
    for (int y = -1; y <= 2; ++y) drawing.circle(view.of(Point(x, y, 0)), 2, Paint::gray, Fill::full);
  draw_ground(drawing, view);
  drawing.arrow(view.of(from_camera.origin), view.of(hit), Paint::gray);
  drawing.line(view.of(to_light.origin), view.of(to_light.at(again)), Paint::red, Stroke::bold);
  drawing.arrow(view.of(to_light.at(again)), view.of(to_light.at(3.2)), Paint::orange, Stroke::dashed);
  drawing.line(view.of(hit), view.of(stored), Paint::gray, Stroke::dashed);
  drawing.circle(view.of(hit), 5, Paint::ink, Fill::none);
  drawing.circle(view.of(stored), 5, Paint::red, Fill::full);
  drawing.line(view.of(stored), view.of(to_light.origin), Paint::red, Stroke::bold);
  drawing.cross(view.of(to_light.at(again)), Paint::red);
  drawing.words({view.left + 152, 24}, "ε too small: acne", Anchor::middle, Paint::ink, true);
  drawing.words({view.left + 8, view.of({0, 1.75, 0}).y}, "camera");
  const Place light = view.of(to_light.at(3.2));
  drawing.words({light.x - 14, light.y}, "light", Anchor::end, Paint::orange);
  const Place start = view.of(stored), met = view.of(to_light.at(again));
  drawing.words({start.x + 12, start.y + 16}, "hit, as rounded:", Anchor::start, Paint::red);
  drawing.words({start.x + 12, start.y + 36}, "below the surface", Anchor::start, Paint::red);
  drawing.words({met.x - 10, met.y + 26}, "meets what it left", Anchor::start, Paint::red);
}

/// Draws a shadow ray that starts beyond a small sphere on the ground.
void draw_too_large(Drawing& drawing, const View& view) {
  constexpr double offset = 1.1, small = 0.45;
  const Sphere resting{.center = ground.center + (ground.radius + small) * normalize(Vec3{-0.345, 1, 0}),
                       .radius = small};
  Scene<Sphere> scene;
  scene.add(ground, Color{1});
  scene.add(resting, Color{1});
  const Ray from_camera{.origin = {-3.6, 0.75, 0}, .direction = {1.3, -1.21, 0}};
  const auto hit = scene.intersect(from_camera);
  const Point point = hit.value().point();
  const Ray exact = hit.value().leave({-0.1, 0.995, 0}),
            lifted{.origin = point + offset * ground.normal_at(point), .direction = exact.direction};
  const Roots skipped = roots_of(resting, exact);
  expect(scene.occluded(exact, {}) && !scene.occluded(lifted, {}) && skipped.count() == 2, "epsilon");

  draw_ground(drawing, view);
  drawing.circle(view.of(resting.center), View::scale * small, Paint::blue, Fill::soft);
  drawing.arrow(view.of(from_camera.origin), view.of(point), Paint::gray);
  drawing.line(view.of(point), view.of(exact.at(skipped[1])), Paint::gray, Stroke::dashed);
  drawing.line(view.of(point), view.of(lifted.origin), Paint::red, Stroke::bold);
  drawing.arrow(view.of(lifted.origin), view.of(lifted.at(1.3)), Paint::orange, Stroke::dashed);
  drawing.circle(view.of(point), 5, Paint::ink, Fill::none);
  drawing.circle(view.of(lifted.origin), 5, Paint::red, Fill::full);
  for (const double t : skipped) drawing.cross(view.of(exact.at(t)), Paint::blue);
  drawing.words({view.left + 152, 24}, "ε too large: light leaks", Anchor::middle, Paint::ink, true);
  drawing.words({view.left + 54, view.of({0, 0.88, 0}).y}, "camera", Anchor::end);
  const Place light = view.of(lifted.at(1.3));
  drawing.words({light.x + 12, light.y + 12}, "light", Anchor::start, Paint::orange);
  const Place start = view.of(lifted.origin);
  drawing.words({start.x + 14, start.y - 28}, "starts beyond", Anchor::start, Paint::red);
  drawing.words({start.x + 14, start.y - 8}, "what is in its way", Anchor::start, Paint::red);
  const Place ball = view.of(resting.center);
  drawing.words({ball.x + 38, ball.y + 2}, "casts no shadow", Anchor::start, Paint::blue);
}

}  // namespace

std::string epsilon() {
  Drawing drawing(640, 310, "An epsilon that is too small, and one that is too large");
  draw_too_small(drawing, {.left = 4});
  draw_too_large(drawing, {.left = 328});
  return drawing.text();
}

}  // namespace figures
