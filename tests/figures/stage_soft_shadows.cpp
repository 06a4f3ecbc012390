// Figures of stage 19: lamps of any size, the caps of directions that they fill, and soft shadows.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <protostar/area_lights.hpp>
#include <protostar/integrators/direct.hpp>
#include <protostar/irradiance.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/solid_angle.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Returns numbers that are spread evenly.
SampleSet<double> numbers_of(std::uint32_t i, std::uint32_t samples) {
  return SobolSampler({.seed = 2, .x = 0, .y = 0, .sample = i, .samples = samples})(1);
}

// ---- Idea

/// A lamp over a long board that hides a part of it, both seen from their edge, and a floor.
struct LampOverBoard {
  Sphere lamp;
  Parallelogram board;

  [[nodiscard]] Scene<Plane, Parallelogram, Sphere> scene() const {
    Scene<Plane, Parallelogram, Sphere> scene;
    scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{1});
    scene.add(board, Color{0});
    scene.add(lamp, Material{.emission = Color{1}});
    return scene;
  }

  /// Returns the share of the lamp that is seen from a point of the floor.
  [[nodiscard]] double share(const Scene<Plane, Parallelogram, Sphere>& of, double x) const {
    constexpr std::uint32_t samples = 256;
    const AreaLights lights(of);
    const auto hit = of.intersect({.origin = {x, 0.1, 0}, .direction = {0, -1, 0}}, Interval{});
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const SampleSet<double> numbers = numbers_of(i, samples);
      const Vec3 direction =
          lights.lights().front().sample(hit.value().point(), numbers[0], numbers[1]).light.direction;
      const auto met = of.intersect(hit.value().leave(direction), Interval{});
      if (met && lights.lights().front().is_hit(met.value(), 0)) ++seen;
    }
    return static_cast<double>(seen) / samples;
  }
};

/// Returns where the line that touches the lamp on its left (side −1) or right (side 1) and passes the point
/// meets y = 0. The point of touch is at a right angle to the line: for the unit vector to the lamp's center,
/// turned by the angle of sin = R/d.
double edge_on_floor(const Sphere& lamp, const Point& past, int side) {
  const Vec3 to = lamp.center - past;
  const double sine = side * lamp.radius / length(to), cosine = std::sqrt(1 - sine * sine);
  const Vec3 along{cosine * to.x + sine * to.y, cosine * to.y - sine * to.x, 0};
  return past.x - along.x / along.y * past.y;
}

void soft_shadow(Drawing& drawing) {
  const auto draw = [&](double left, double radius, double board_height, const char* title) {
    const LampOverBoard over{
        .lamp = {.center = {0, 4.9, 0}, .radius = radius},
        .board = {.position = {-0.9, board_height, -50}, .edge_u = {1.8, 0, 0}, .edge_v = {0, 0, 100}}};
    const auto scene = over.scene();
    constexpr double scale = 45, wide = 3.1;
    const Sketch sketch(drawing, {left, 290}, scale);
    const Point a{-0.9, board_height, 0}, b{0.9, board_height, 0};
    // The umbra ends where the lamp's other side begins to be seen past an edge.
    const double outer = edge_on_floor(over.lamp, b, -1), inner = edge_on_floor(over.lamp, b, 1);
    expect(0 < inner && inner < outer && outer < wide, "soft_shadow");
    expect(over.share(scene, inner - 0.02) == 0 && over.share(scene, inner + 0.06) > 0, "soft_shadow");
    expect(over.share(scene, outer - 0.06) < 1 && over.share(scene, outer + 0.02) == 1, "soft_shadow");
    sketch.polygon({a, b, {inner, 0, 0}, {-inner, 0, 0}}, Paint::gray);
    for (const int side : {-1, 1}) {
      const Point end{side * 0.9, board_height, 0};
      for (const double foot : {side * outer, side * inner}) {
        // The line goes on to the point where it touches the lamp.
        const Vec3 up = normalize(end - Point{foot, 0, 0});
        const Point touch = end + dot(over.lamp.center - end, up) * up;
        expect(std::abs(length(touch - over.lamp.center) - radius) < 1e-9, "soft_shadow");
        sketch.line(touch, {foot, 0, 0}, foot == side * outer ? Paint::orange : Paint::blue);
      }
    }
    sketch.circle(over.lamp.center, radius, Paint::orange, Fill::full);
    sketch.line(a, b, Paint::ink, Stroke::bold);
    constexpr int steps = 62;
    for (int i = 0; i < steps; ++i) {
      const double x = wide * (2 * (i + 0.5) / steps - 1);
      const Place corner = sketch.of({x - wide / steps, 0, 0});
      drawing.swatch(corner, 2 * wide / steps * scale, 22,
                     shown_color(Color{static_cast<float>(0.02 + 0.9 * over.share(scene, x))}));
    }
    sketch.line({-wide, 0, 0}, {wide, 0, 0}, Paint::ink);
    drawing.words({left, 26}, title, Anchor::middle, Paint::ink, true);
    return std::array{inner, outer};
  };
  const auto [inner, outer] = draw(165, 0.7, 2, "a large lamp");
  const auto small = draw(475, 0.15, 2, "a small lamp");
  expect(small[1] - small[0] < (outer - inner) / 4, "soft_shadow");
  for (const double left : {165.0, 475.0}) drawing.words({left, 334}, "umbra", Anchor::middle);
  drawing.words({165 + 45 * (inner + outer) / 2, 356}, "penumbra", Anchor::middle, Paint::blue);
  drawing.words({165 - 45 * (inner + outer) / 2, 356}, "penumbra", Anchor::middle, Paint::blue);
}

// ---- The cap

void light_cap(Drawing& drawing) {
  const Point from{0, 0, 0};
  const Sphere lamp{.center = 2.9 * at_angle(50), .radius = 0.95};
  const SphereView view(from, lamp.center, lamp.radius);
  const double sine = lamp.radius / 2.9, half = std::asin(sine) * 180 / std::numbers::pi;
  // The view's solid angle is that of a cap of this angle.
  expect(std::abs(view.solid_angle() - 2 * std::numbers::pi * (1 - std::sqrt(1 - sine * sine))) < 1e-12,
         "light_cap");
  const Sketch sketch(drawing, {200, 300}, 92);
  sketch.line({-1.8, 0, 0}, {4.4, 0, 0}, Paint::ink, Stroke::bold);
  sketch.curve([](double a) { return at_angle(a); }, 0, 180, Paint::gray, Stroke::dashed, 60);
  sketch.circle(lamp.center, lamp.radius, Paint::orange, Fill::soft);
  for (const int side : {-1, 1}) {
    const Vec3 rim = at_angle(50 + side * half);
    const double t = dot(lamp.center, rim);
    expect(std::abs(length(t * rim - lamp.center) - lamp.radius) < 1e-9, "light_cap");
    sketch.line(from, t * rim, Paint::orange);
    if (side > 0) {
      sketch.line(lamp.center, t * rim, Paint::ink);
      sketch.words(0.5 * (lamp.center + t * rim), {6, -4}, "R", Paint::ink);
    }
  }
  sketch.line(from, lamp.center, Paint::ink, Stroke::dashed);
  sketch.curve([&](double a) { return at_angle(a); }, 50 - half, 50 + half, Paint::red, Stroke::bold, 32);
  sketch.arrow(from, {0, 1.55, 0}, Paint::green);
  sketch.words({0, 1.55, 0}, {-8, 4}, "n", Paint::green, Anchor::end);
  sketch.angle(from, 0.42, {0, 1, 0}, at_angle(50), Paint::green);
  sketch.words(0.52 * at_angle(72), {-2, 0}, "θ", Paint::green);
  sketch.angle(from, 0.66, at_angle(50), at_angle(50 + half), Paint::ink);
  sketch.words(0.72 * at_angle(57), {2, -2}, "γ");
  sketch.words(1.95 * at_angle(50), {10, 12}, "r");
  sketch.mark(from, Paint::ink);
  sketch.mark(lamp.center, Paint::ink);
  sketch.words(at_angle(50 - half), {12, 12}, "the cap, ω", Paint::red);
  sketch.words(lamp.center, {102, 4}, "the lamp", Paint::orange);
  sketch.words(at_angle(160), {-14, -22}, "all directions:", Paint::gray, Anchor::middle);
  sketch.words(at_angle(160), {-14, 0}, "radius 1", Paint::gray, Anchor::middle);
}

void projected_cap(Drawing& drawing) {
  const Sphere lamp{.center = 2.6 * at_angle(56), .radius = 1.25};
  const double sine = lamp.radius / 2.6, half = std::asin(sine) * 180 / std::numbers::pi;
  const Sketch sketch(drawing, {130, 250}, 190);
  const Vec3 rims[] = {at_angle(56 - half), at_angle(56 + half)};
  sketch.line({-0.5, 0, 0}, {1.3, 0, 0}, Paint::ink, Stroke::bold);
  sketch.curve([](double a) { return at_angle(a); }, 0, 122, Paint::gray, Stroke::dashed, 60);
  // Small parts of the cap and their widths on the floor
  constexpr int parts = 9;
  for (int i = 0; i <= parts; ++i) {
    const Vec3 at = at_angle(56 - half + 2 * half * i / parts);
    sketch.line(at, {at.x, 0, 0}, i == 0 || i == parts ? Paint::red : Paint::gray);
  }
  sketch.curve([&](double a) { return at_angle(a); }, 56 - half, 56 + half, Paint::red, Stroke::bold, 32);
  sketch.line(rims[0], rims[1], Paint::blue, Stroke::bold);
  sketch.line({rims[0].x, 0, 0}, {rims[1].x, 0, 0}, Paint::red, Stroke::bold);
  sketch.arrow({}, 0.45 * at_angle(90), Paint::green);
  sketch.words(0.45 * at_angle(90), {-8, 6}, "n", Paint::green, Anchor::end);
  sketch.mark({}, Paint::ink);
  // The disk of the rim has the radius R/d and is tilted by the lamp's angle: its area on the floor is the
  // irradiance.
  const double cosine = std::cos(34 * std::numbers::pi / 180);
  expect(std::abs(sphere_irradiance({}, {0, 1, 0}, lamp.center, lamp.radius) -
                  std::numbers::pi * sine * sine * cosine) < 1e-12,
         "projected_cap");
  expect(std::abs(rims[0].x - rims[1].x - 2 * sine * cosine) < 1e-12, "projected_cap");
  const auto line = [&](double y, const std::string& words, Paint paint) {
    drawing.words({402, y}, words, Anchor::start, paint);
  };
  line(64, "the cap", Paint::red);
  line(100, "the disk of its rim,", Paint::blue);
  line(122, "radius sin γ = R/r", Paint::blue);
  line(176, "both cover the same", Paint::ink);
  line(198, "part of the floor:", Paint::ink);
  line(220, "π (R/r)² cos θ", Paint::ink);
}

// ---- Draws

void drawn_directions(Drawing& drawing) {
  constexpr std::uint32_t samples = 256;
  constexpr double radius = 125;
  // Seen from far away, the place of a direction in the lamp's disk is its distance from the axis.
  const Sphere lamp{.center = {0, 0, 1000}, .radius = 1};
  const SphereView view({}, lamp.center, lamp.radius);
  const auto draw = [&](const Place& middle, bool is_right, const char* title) {
    drawing.circle(middle, radius, Paint::orange, Fill::soft);
    drawing.circle(middle, radius / 2, Paint::gray, Fill::none, Stroke::dashed);
    int inside = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const SampleSet<double> numbers = numbers_of(i, samples);
      const Vec3 d = view.sample(numbers[0], numbers[1]).direction;
      double x = 1000 * d.x, y = 1000 * d.y;
      const double r = std::sqrt(x * x + y * y);
      if (!is_right) x *= r, y *= r;  // the share of the height, r², becomes a share of the angle
      if (x * x + y * y < 0.25) ++inside;
      drawing.circle({middle.x + radius * x, middle.y - radius * y}, 3, Paint::blue, Fill::full);
    }
    drawing.words({middle.x, 26}, title, Anchor::middle, Paint::ink, true);
    drawing.words({middle.x, 312}, std::to_string(inside) + " of 256 in the inner circle", Anchor::middle);
    return inside;
  };
  expect(std::abs(draw({160, 165}, true, "equal heights") - 64) <= 4, "drawn_directions");
  expect(std::abs(draw({480, 165}, false, "equal angles: wrong") - 128) <= 4, "drawn_directions");
}

}  // namespace

std::vector<StageFigure> soft_shadow_figures() {
  return {
      {"soft_shadow", "19_soft_shadows",
       "Lamps over a board: shadows with a wide border and with a narrow one", 368, soft_shadow},
      {"light_cap", "19_soft_shadows", "A lamp as a cap of the directions from a point", 330, light_cap},
      {"projected_cap", "19_soft_shadows",
       "The cap of a lamp and the disk of its rim, over the same part of the floor", 276, projected_cap},
      {"drawn_directions", "19_soft_shadows",
       "256 directions to a lamp: spread evenly, and with heaps in the middle", 330, drawn_directions},
  };
}

}  // namespace figures
