// Figures of stage 22: lobes around the mirror direction, microfacets, and two ways to find a lamp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <protostar/light_at_hit.hpp>
#include <protostar/refraction.hpp>
#include <protostar/sampling/glossy_lobes.hpp>
#include <protostar/sampling/sphere_view.hpp>
#include <protostar/sampling/warp.hpp>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Returns the local direction of a lobe, whose normal is z, for one of the drawing, whose normal is y.
Vec3 local_of(const Vec3& d) { return {d.x, 0, d.y}; }

// ---- Idea

void glossy_lobe(Drawing& drawing) {
  const auto draw = [&](double left, double exponent, const char* title) {
    const Sketch sketch(drawing, {left, 216}, 88);
    const Vec3 view = at_angle(135), mirror = at_angle(45);
    const PhongLobe lobe{.exponent = exponent};
    // The mirror direction has the largest density.
    const double most = lobe.density(local_of(view), local_of(mirror));
    expect(most > lobe.density(local_of(view), local_of(at_angle(40))), "glossy_lobe");
    const auto tip = [&](double degrees) {
      const Vec3 d = at_angle(degrees);
      return Point{} + 1.5 * lobe.density(local_of(view), local_of(d)) / most * d;
    };
    // A part of a wide lobe is below the surface.
    sketch.curve(tip, 0, 135, Paint::blue, Stroke::bold, 270);
    sketch.curve(tip, -45, 0, Paint::red, Stroke::dashed, 90);
    sketch.line({-0.95, 0, 0}, {0.95, 0, 0}, Paint::ink, Stroke::bold);
    sketch.arrow(1.3 * view, 0.06 * view, Paint::ink);
    sketch.arrow({}, 1.5 * mirror, Paint::ink, Stroke::dashed);
    sketch.arrow({}, {0, 1.2, 0}, Paint::green);
    sketch.words({0, 1.2, 0}, {-8, 4}, "n", Paint::green, Anchor::end);
    const CosinePower power{exponent};
    for (const double u : {0.1, 0.35, 0.65, 0.9}) {
      const double angle = std::acos(power.sample(0.5 + u / 2, 0.5).direction.z) * 180 / std::numbers::pi;
      for (const int side : {-1, 1})
        if (const Vec3 d = at_angle(45 + side * angle); d.y > 0) sketch.line({}, 0.45 * d, Paint::orange);
    }
    drawing.words({left, 26}, title, Anchor::middle, Paint::ink, true);
  };
  draw(110, 1000, "nearly a mirror");
  draw(320, 30, "glossy");
  draw(520, 2, "rough");
  drawing.words({110, 276}, "exponent 1000", Anchor::middle);
  drawing.words({320, 276}, "exponent 30", Anchor::middle);
  drawing.words({520, 276}, "exponent 2", Anchor::middle);
}

// ---- Microfacets

void microfacets(Drawing& drawing) {
  const auto draw = [&](double left, double roughness, const char* title) {
    const Sketch sketch(drawing, {left, 200}, 100);
    const Vec3 view = at_angle(142);
    const double alpha = GgxLobe{.roughness = roughness}.width();
    // Slopes of the distribution in the plane of the drawing, in an order without order.
    constexpr int count = 10;
    constexpr std::array<int, count> order{3, 8, 1, 6, 9, 2, 5, 0, 7, 4};
    std::vector<Point> corners{{-1.25, 0, 0}};
    for (const int i : order) {
      const double slope = alpha * std::tan(std::numbers::pi * ((i + 0.5) / count - 0.5) * 0.72);
      corners.push_back(corners.back() + Vec3{0.25, 0.25 * slope, 0});
    }
    expect(std::abs(corners.back().y - corners.front().y) < 1e-9, "microfacets");
    int seen = 0;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const Vec3 along = normalize(corners[i + 1] - corners[i]), normal{-along.y, along.x, 0};
      const Point middle = 0.5 * (corners[i] + corners[i + 1]);
      const bool is_seen = dot(normal, view) > 0.05;
      sketch.line(corners[i], corners[i + 1], is_seen ? Paint::blue : Paint::gray, Stroke::bold);
      if (!is_seen) continue;
      ++seen;
      if (i % 3 != 1) continue;
      const Vec3 light = 2 * dot(view, normal) * normal - view;
      sketch.arrow(middle + view, middle, Paint::ink);
      sketch.arrow(middle, middle + light, Paint::orange);
    }
    expect(seen >= 5, "microfacets");
    drawing.words({left, 26}, title, Anchor::middle, Paint::ink, true);
  };
  draw(180, 0.4, "roughness 0.4");
  draw(475, 0.95, "roughness 0.95");
  drawing.words({320, 296}, "blue: mirrors that turn to the viewer", Anchor::middle, Paint::blue);
}

// ---- Two ways

void two_ways(Drawing& drawing) {
  // Densities of directions in a plane, by the angle from the mirror direction, in which the lamp is.
  const auto draw = [&](double left, double exponent, double sine, const char* title, const char* below) {
    const CosinePower lobe{exponent};
    const SphereView lamp({}, Point{0, 0, 1}, sine);
    const double by_lamp = 1 / lamp.solid_angle(), rim = std::asin(sine) * 180 / std::numbers::pi;
    const auto by_lobe = [&](double degrees) {
      return lobe.density(std::cos(degrees * std::numbers::pi / 180));
    };
    const double most = std::max(by_lamp, by_lobe(0));
    constexpr double wide = 125, high = 170, floor = 236, most_angle = 60;
    const auto place = [&](double degrees, double density) {
      return Place{left + wide * degrees / most_angle, floor - high * density / most};
    };
    std::vector<Place> corners;
    for (int i = -240; i <= 240; ++i) corners.push_back(place(i * 0.25, by_lobe(i * 0.25)));
    drawing.polyline(corners, Paint::blue, Stroke::bold);
    drawing.polyline({place(-most_angle, 0), place(-rim, 0), place(-rim, by_lamp), place(rim, by_lamp),
                      place(rim, 0), place(most_angle, 0)},
                     Paint::orange, Stroke::bold);
    drawing.words({left, 26}, title, Anchor::middle, Paint::ink, true);
    const double share = by_lamp / (by_lamp + by_lobe(0));
    expect(std::abs(power_heuristic(by_lamp, by_lobe(0)) + power_heuristic(by_lobe(0), by_lamp) - 1) < 1e-12,
           "two_ways");
    drawing.words({left, 268}, below, Anchor::middle);
    drawing.words({left, 292}, joined({"share of the lamp ", text_of(share)}), Anchor::middle, Paint::orange);
    drawing.words({left, 316}, joined({"share of the lobe ", text_of(1 - share)}), Anchor::middle,
                  Paint::blue);
    return share;
  };
  expect(draw(165, 1000, 0.5, "smooth metal, large lamp", "the lobe fits into the lamp") < 0.05, "two_ways");
  expect(draw(475, 8, 0.1, "rough metal, small lamp", "the lamp fits into the lobe") > 0.95, "two_ways");
}

}  // namespace

std::vector<StageFigure> glossy_figures() {
  return {
      {"glossy_lobe", "22_glossy", "Three lobes around the mirror direction: narrow, wider and wide", 296,
       glossy_lobe},
      {"microfacets", "22_glossy", "Metal as a surface of tiny mirrors, which send a ray to many sides", 316,
       microfacets},
      {"two_ways", "22_glossy", "How likely a direction is drawn by the lamp and by the lobe", 332, two_ways},
  };
}

}  // namespace figures
