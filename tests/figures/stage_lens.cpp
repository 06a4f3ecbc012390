// Figures of stage 20: a lens, the plane that is in focus, and the blur of all else.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <protostar/camera.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/warp.hpp>
#include <string>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Returns a camera that looks to the right in the plane of the drawing, whose picture's up is up there.
Camera camera_to_the_right(double field_of_view, double aperture, double focus) {
  return Camera::thin_lens({}, {1, 0, 0}, {0, 1, 0}, field_of_view, aperture, focus);
}

/// Returns the parameter at which a ray has got so far to the right.
double at_distance(const Ray& ray, double x) { return (x - ray.origin.x) / ray.direction.x; }

/// Draws a lens around the origin: two arcs that meet at its rim.
void draw_lens(const Sketch& sketch, double radius, double thickness) {
  for (const int side : {-1, 1})
    sketch.curve(
        [&](double y) {
          return Point{side * thickness * (1 - y * y / (radius * radius)), y, 0};
        },
        -radius, radius, Paint::blue, Stroke::bold, 32);
}

// ---- Idea

void lens_focus(Drawing& drawing) {
  constexpr double focus = 3, aperture = 0.55, film = 1.2, end = 4.9;
  const Camera camera = camera_to_the_right(40, aperture, focus);
  const Sketch sketch(drawing, {150, 165}, 92);
  sketch.line({focus, -1.35, 0}, {focus, 1.35, 0}, Paint::gray, Stroke::dashed);
  sketch.line({-film, -1, 0}, {-film, 1, 0}, Paint::ink, Stroke::bold);
  const auto draw = [&](double v, Paint paint) {
    const Point sharp = camera(0, v).at(at_distance(camera(0, v), focus));
    for (const double place : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const Ray ray = camera(0, v, {0, place});
      expect(length(ray.at(at_distance(ray, focus)) - sharp) < 1e-12, "lens_focus");
      sketch.line(ray.origin, ray.at(at_distance(ray, end)), paint);
      // Behind the lens, all of them go to the place of the film that the center's ray leads away from.
      sketch.line({-film, -film * sharp.y / focus, 0}, ray.origin, paint);
    }
    sketch.mark(sharp, paint);
    sketch.mark({-film, -film * sharp.y / focus, 0}, paint);
  };
  draw(0.62, Paint::orange);
  draw(-0.62, Paint::green);
  draw_lens(sketch, 1.15 * aperture, 0.1);
  sketch.words({-film, -1, 0}, {0, 24}, "film", Paint::ink, Anchor::middle);
  sketch.words({0, -1, 0}, {0, 24}, "lens", Paint::blue, Anchor::middle);
  sketch.words({focus, -1.35, 0}, {0, 24}, "in focus", Paint::gray, Anchor::middle);
  sketch.words({end - 0.45, -1.35, 0}, {0, 24}, "blurred", Paint::ink, Anchor::middle);
  sketch.words({1.4, -1.35, 0}, {0, 24}, "blurred", Paint::ink, Anchor::middle);
}

// ---- Circle of confusion

void confusion(Drawing& drawing) {
  constexpr double focus = 4.6, near = 2.0, aperture = 0.75;
  const Camera camera = camera_to_the_right(40, aperture, focus);
  const Sketch sketch(drawing, {60, 155}, 100);
  const Point seen{near, 0, 0};
  sketch.line({}, {5.4, 0, 0}, Paint::gray, Stroke::dashed);
  sketch.line({focus, -1.2, 0}, {focus, 1.2, 0}, Paint::gray, Stroke::dashed);
  for (const int side : {-1, 1}) {
    const Point rim{0, side * aperture, 0};
    // The plane in focus, met by the ray from the rim through the point
    const double height = rim.y * (1 - focus / near);
    // The camera's own ray through that place of the plane and the rim passes the point.
    const Ray ray = camera(0, height / focus / length(camera.up), {0, static_cast<double>(side)});
    expect(length(ray.origin - rim) < 1e-12 && length(ray.at(at_distance(ray, near)) - seen) < 1e-12,
           "confusion");
    sketch.polygon({seen, rim, {}}, Paint::blue);
    sketch.polygon({seen, {focus, height, 0}, {focus, 0, 0}}, Paint::orange);
    sketch.line(rim, {focus, height, 0}, Paint::ink);
  }
  const double blur = aperture * (focus / near - 1);
  sketch.line({0, -aperture, 0}, {0, aperture, 0}, Paint::blue, Stroke::bold);
  sketch.line({focus, -blur, 0}, {focus, blur, 0}, Paint::orange, Stroke::bold);
  sketch.mark(seen, Paint::ink);
  sketch.words({0, aperture / 2, 0}, {-10, 6}, "R", Paint::blue, Anchor::end);
  sketch.words({focus, blur / 2, 0}, {10, 6}, "R'", Paint::orange);
  const double below = -1.2;
  sketch.arrow({near / 2 - 0.2, below, 0}, {0, below, 0}, Paint::ink);
  sketch.arrow({near / 2 + 0.2, below, 0}, {near, below, 0}, Paint::ink);
  sketch.words({near / 2, below, 0}, {0, 6}, "z", Paint::ink, Anchor::middle);
  sketch.arrow({(near + focus) / 2 - 0.45, below, 0}, {near, below, 0}, Paint::ink);
  sketch.arrow({(near + focus) / 2 + 0.45, below, 0}, {focus, below, 0}, Paint::ink);
  sketch.words({(near + focus) / 2, below, 0}, {0, 6}, "ζ − z", Paint::ink, Anchor::middle);
  sketch.words(seen, {0, -14}, "a point", Paint::ink, Anchor::middle);
  sketch.words({focus, 1.2, 0}, {0, -10}, "in focus", Paint::gray, Anchor::middle);
}

// ---- Places in a disk

void lens_places(Drawing& drawing) {
  constexpr std::uint32_t samples = 256;
  constexpr double radius = 88;
  const auto draw = [&](double x, const char* title, const auto& place) {
    const Place middle{x, 135};
    drawing.circle(middle, radius, Paint::gray, Fill::none);
    drawing.circle(middle, radius / 2, Paint::orange, Fill::none, Stroke::dashed);
    int inside = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const SampleSet<double> numbers =
          SobolSampler({.seed = 3, .x = 0, .y = 0, .sample = i, .samples = samples})(0);
      const Uv at = place(numbers[2], numbers[3]);
      if (at.x * at.x + at.y * at.y < 0.25) ++inside;
      drawing.circle({middle.x + radius * at.x, middle.y - radius * at.y}, 2.5, Paint::blue, Fill::full);
    }
    drawing.words({x, 26}, title, Anchor::middle, Paint::ink, true);
    drawing.words({x, 256}, std::to_string(inside) + " inside", Anchor::middle, Paint::orange);
    return inside;
  };
  const auto polar = [](double r, double share) {
    const Vec3 at = r * at_angle(360 * share);
    return Uv{at.x, at.y};
  };
  const int heaps = draw(110, "r = ξ: wrong", [&](double u, double v) { return polar(u, v); });
  const int even = draw(320, "r = √ξ", [&](double u, double v) { return polar(std::sqrt(u), v); });
  const int concentric = draw(530, "concentric", [](double u, double v) { return concentric_disk(u, v); });
  expect(std::abs(heaps - 128) <= 4 && std::abs(even - 64) <= 4 && std::abs(concentric - 64) <= 6,
         "lens_places");
}

/// The unit square and the disk, with the same lines in both.
void concentric_map(Drawing& drawing) {
  constexpr double side = 200, radius = 100;
  constexpr int cells = 8;
  const Place corner{70, 40}, middle{470, 140};
  const auto in_square = [&](double u, double v) {
    return Place{corner.x + side * u, corner.y + side * (1 - v)};
  };
  const auto in_disk = [&](double u, double v) {
    const Uv at = concentric_disk(u, v);
    return Place{middle.x + radius * at.x, middle.y - radius * at.y};
  };
  const auto draw = [&](const auto& place, double u0, double v0, double u1, double v1, Paint paint,
                        Stroke stroke) {
    std::vector<Place> corners;
    for (int i = 0; i <= 64; ++i) corners.push_back(place(u0 + (u1 - u0) * i / 64, v0 + (v1 - v0) * i / 64));
    drawing.polyline(corners, paint, stroke);
  };
  // Squares around the middle become circles.
  for (int i = 1; i <= cells / 2; ++i) {
    const double low = 0.5 - static_cast<double>(i) / cells, high = 1 - low;
    const Uv rim = concentric_disk(high, 0.5 + (high - 0.5) * 0.3);
    expect(std::abs(std::sqrt(rim.x * rim.x + rim.y * rim.y) - 2.0 * i / cells) < 1e-12, "concentric_map");
    const auto both = [&](double u0, double v0, double u1, double v1) {
      draw(in_square, u0, v0, u1, v1, Paint::blue, i == cells / 2 ? Stroke::bold : Stroke::thin);
      draw(in_disk, u0, v0, u1, v1, Paint::blue, i == cells / 2 ? Stroke::bold : Stroke::thin);
    };
    both(low, low, high, low), both(high, low, high, high);
    both(high, high, low, high), both(low, high, low, low);
  }
  // Lines from the middle stay lines.
  for (int i = 0; i < cells; ++i) {
    const double share = static_cast<double>(i) / cells;
    for (const Place& end : {Place{share, 0}, Place{1, share}, Place{1 - share, 1}, Place{0, 1 - share}}) {
      draw(in_square, 0.5, 0.5, end.x, end.y, Paint::orange, Stroke::thin);
      draw(in_disk, 0.5, 0.5, end.x, end.y, Paint::orange, Stroke::thin);
    }
  }
  drawing.arrow({300, 140}, {340, 140}, Paint::ink);
  drawing.words({corner.x + side / 2, 268}, "two numbers", Anchor::middle);
  drawing.words({middle.x, 268}, "a place of the lens", Anchor::middle);
}

}  // namespace

std::vector<StageFigure> lens_figures() {
  return {
      {"lens_focus", "20_lens",
       "Rays from two places of the film, through a lens, meet in the plane in focus", 330, lens_focus},
      {"confusion", "20_lens", "Two similar triangles: from a point to the lens, and to the plane in focus",
       310, confusion},
      {"lens_places", "20_lens", "256 places of a disk: with heaps in the middle, and evenly in two ways",
       276, lens_places},
      {"concentric_map", "20_lens", "A square of squares becomes a disk of circles", 290, concentric_map},
  };
}

}  // namespace figures
