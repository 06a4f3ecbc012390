// Figures of the stages 34 to 38: distance fields of shapes, and what is done with them.
#include <algorithm>
#include <cmath>
#include <protostar/exact/plain.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "scenes/sponge.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Returns the value of a field of the library at a point.
double value_of(const auto& field, const Point& p) {
  using P = Plain<double>;
  return field(FieldPoint<P>{P::of(p.x), P::of(p.y), P::of(p.z)}).value;
}

/// Draws the lines in the plane z = 0 on which a function of a point has a value, in a square from `low` to
/// `high`: in each of many small squares, between the places on its sides where the function has it.
void draw_level(const Sketch& sketch, const auto& f, double level, const Point& low, const Point& high,
                Paint paint, Stroke stroke = Stroke::thin, int cells = 64) {
  const double dx = (high.x - low.x) / cells, dy = (high.y - low.y) / cells;
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      const Point corners[] = {{low.x + i * dx, low.y + k * dy, 0},
                               {low.x + (i + 1) * dx, low.y + k * dy, 0},
                               {low.x + (i + 1) * dx, low.y + (k + 1) * dy, 0},
                               {low.x + i * dx, low.y + (k + 1) * dy, 0}};
      std::vector<Point> places;
      for (int side = 0; side < 4; ++side) {
        const Point &a = corners[side], &b = corners[(side + 1) % 4];
        const double fa = f(a) - level, fb = f(b) - level;
        if ((fa > 0) != (fb > 0)) places.push_back(a + fa / (fa - fb) * (b - a));
      }
      for (std::size_t j = 0; j + 1 < places.size(); j += 2)
        sketch.line(places[j], places[j + 1], paint, stroke);
    }
}

// ---- Shapes

void level_lines(Drawing& drawing) {
  const auto largest = [](const auto& p) { return max(abs(p.x) - 0.7, abs(p.y) - 0.4); };
  const auto distance = [](const auto& p) { return signed_length(Vec2{abs(p.x) - 0.7, abs(p.y) - 0.4}); };
  const auto draw = [&](double middle, const auto& field, const char* title) {
    const Sketch sketch(drawing, {middle, 190}, 92);
    const auto f = [&](const Point& p) { return value_of(field, p); };
    for (const double level : {-0.2, 0.2, 0.4, 0.6, 0.8})
      draw_level(sketch, f, level, {-1.6, -1.4, 0}, {1.6, 1.4, 0}, level < 0 ? Paint::orange : Paint::gray);
    draw_level(sketch, f, 0, {-1.6, -1.4, 0}, {1.6, 1.4, 0}, Paint::blue, Stroke::bold);
    drawing.words({middle, 30}, title, Anchor::middle, Paint::ink, true);
    return f({1.1, 0.8, 0});
  };
  const double bound = draw(165, largest, "the largest of three"),
               exact = draw(475, distance, "the distance");
  expect(std::abs(exact - std::sqrt(0.32)) < 1e-12 && std::abs(bound - 0.4) < 1e-12, "level_lines");
  drawing.words({320, 350}, "lines of equal value, 0.2 apart; bold: 0", Anchor::middle);
}

void fields_as_sets(Drawing& drawing) {
  const auto a = [](const auto& p) { return length(p - Vec3{-0.35, 0, 0}) - 0.7; };
  const auto b = [](const auto& p) { return length(p - Vec3{0.35, 0, 0}) - 0.7; };
  const auto draw = [&](double middle, const auto& field, const char* title) {
    const Sketch sketch(drawing, {middle, 150}, 82);
    sketch.circle({-0.35, 0, 0}, 0.7, Paint::gray, Fill::none, Stroke::dashed);
    sketch.circle({0.35, 0, 0}, 0.7, Paint::gray, Fill::none, Stroke::dashed);
    const auto f = [&](const Point& p) { return value_of(field, p); };
    draw_level(sketch, f, 0, {-1.2, -1, 0}, {1.2, 1, 0}, Paint::blue, Stroke::bold);
    drawing.words({middle, 256}, title, Anchor::middle, Paint::blue);
    return f({-0.6, 0, 0}) < 0;
  };
  expect(draw(
             110, [&](const auto& p) { return min(a(p), b(p)); }, "min(f, g)"),
         "fields_as_sets");
  expect(!draw(
             320, [&](const auto& p) { return max(a(p), b(p)); }, "max(f, g)"),
         "fields_as_sets");
  expect(draw(
             530, [&](const auto& p) { return max(a(p), -b(p)); }, "max(f, −g)"),
         "fields_as_sets");
  for (const auto& [x, word] : {std::pair{110.0, "union"}, {320.0, "intersection"}, {530.0, "difference"}})
    drawing.words({x, 40}, word, Anchor::middle, Paint::ink, true);
}

// ---- Blends

void smooth_minimum(Drawing& drawing) {
  const auto f = [](double x) { return 1.2 - 0.55 * x; };
  const auto g = [](double x) { return 0.1 + 0.5 * x; };
  const double width = 0.9;
  const auto smooth = [&](double x) {
    return smooth_min(Plain<double>::of(f(x)), Plain<double>::of(g(x)), width).value;
  };
  const Sketch sketch(drawing, {80, 290}, 190);
  sketch.arrow({-0.1, 0, 0}, {2.5, 0, 0}, Paint::ink);
  sketch.arrow({0, -0.1, 0}, {0, 1.45, 0}, Paint::ink);
  sketch.curve([&](double x) { return Point{x, f(x), 0}; }, 0, 2.1, Paint::gray);
  sketch.curve([&](double x) { return Point{x, g(x), 0}; }, 0, 2.3, Paint::gray);
  sketch.curve([&](double x) { return Point{x, smooth(x), 0}; }, 0, 2.1, Paint::blue, Stroke::bold);
  const double meet = 1.1 / 1.05;
  expect(std::abs(f(meet) - g(meet)) < 1e-12 && std::abs(f(meet) - smooth(meet) - width / 4) < 1e-12,
         "smooth_minimum");
  sketch.line({meet, f(meet), 0}, {meet, smooth(meet), 0}, Paint::red, Stroke::bold);
  sketch.words({meet, 0.5 * (f(meet) + smooth(meet)), 0}, {8, 6}, "K/4", Paint::red);
  for (const double side : {-1.0, 1.0}) {
    const double x = meet + side * width / 1.05;
    sketch.line({x, f(x), 0}, {x, g(x), 0}, Paint::green, Stroke::dashed);
    sketch.words({x, std::max(f(x), g(x)), 0}, {0, -10}, "K", Paint::green, Anchor::middle);
  }
  sketch.words({0, 1.2, 0}, {-10, 6}, "f", Paint::gray, Anchor::end);
  sketch.words({0, 0.1, 0}, {-10, 0}, "g", Paint::gray, Anchor::end);
}

void blended_outlines(Drawing& drawing) {
  double middle = 110;
  double thickness = -1;
  for (const double width : {0.05, 0.6, 1.2}) {
    const auto field = [width](const auto& p) {
      return smooth_min(length(p - Vec3{-0.62, 0, 0}) - 0.55, length(p - Vec3{0.62, 0.1, 0}) - 0.45, width);
    };
    const Sketch sketch(drawing, {middle, 140}, 84);
    sketch.circle({-0.62, 0, 0}, 0.55, Paint::gray, Fill::none, Stroke::dashed);
    sketch.circle({0.62, 0.1, 0}, 0.45, Paint::gray, Fill::none, Stroke::dashed);
    draw_level(
        sketch, [&](const Point& p) { return value_of(field, p); }, 0, {-1.4, -0.9, 0}, {1.4, 0.9, 0},
        Paint::blue, Stroke::bold);
    drawing.words({middle, 250}, joined({"K = ", text_of(width)}), Anchor::middle);
    const double between = -value_of(field, {0.05, 0.05, 0});
    expect(between > thickness, "blended_outlines");
    thickness = between;
    middle += 210;
  }
}

// ---- Repetition

void folded_line(Drawing& drawing) {
  const Sketch sketch(drawing, {60, 180}, 84);
  const auto folded = [](double x) { return fold(Plain<double>::of(x)).value; };
  sketch.arrow({-0.3, 0, 0}, {6.4, 0, 0}, Paint::ink);
  sketch.words({6.4, 0, 0}, {0, 24}, "x", Paint::ink, Anchor::middle);
  std::vector<Point> corners;
  for (int i = 0; i <= 6; ++i) {
    corners.push_back({static_cast<double>(i), folded(i), 0});
    if (i % 2 == 0) sketch.circle({static_cast<double>(i), 0, 0}, 0.35, Paint::orange, Fill::soft);
  }
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    sketch.line(corners[i], corners[i + 1], Paint::blue, Stroke::bold);
    expect(std::abs(folded(0.5 * (corners[i].x + corners[i + 1].x)) - 0.5) < 1e-12, "folded_line");
  }
  for (const double x : {0.7, 1.3, 2.7, 3.3, 4.7, 5.3}) {
    sketch.mark({x, folded(x), 0}, Paint::red);
    expect(std::abs(folded(x) - 0.7) < 1e-12, "folded_line");
  }
  sketch.line({0, 0.7, 0}, {5.9, 0.7, 0}, Paint::red, Stroke::dashed);
  drawing.words({320, 40}, "all red points become the same one", Anchor::middle, Paint::red);
  drawing.words({320, 244}, "one ball in folded space is a row of balls", Anchor::middle, Paint::orange);
}

void wrong_cell(Drawing& drawing) {
  // A ball that is not in the middle of its cell, from -1 to 1.
  const Vec3 offset{-0.62, 0, 0};
  constexpr double radius = 0.3;
  const auto own = [&](const Point& p) {
    const double cell = p.x - 2 * std::round(p.x / 2);
    return length(Point{cell, p.y, 0} - offset) - radius;
  };
  const auto all = [&](const Point& p) {
    double nearest = infinity;
    for (int i = -1; i <= 4; ++i)
      nearest = std::min(nearest, length(p - offset - Vec3{2.0 * i, 0, 0}) - radius);
    return nearest;
  };
  const Sketch sketch(drawing, {150, 160}, 100);
  for (int i = 0; i < 3; ++i) {
    sketch.line({2.0 * i - 1, -1.2, 0}, {2.0 * i - 1, 1.2, 0}, Paint::gray, Stroke::dashed);
    sketch.circle(Point{2.0 * i, 0, 0} + offset, radius, Paint::orange, Fill::soft);
  }
  const Point p{0.72, 0.1, 0};
  expect(own(p) > 1 && all(p) < 0.5, "wrong_cell");
  sketch.circle(p, own(p), Paint::red, Fill::none);
  sketch.circle(p, all(p), Paint::green, Fill::soft);
  sketch.mark(p, Paint::ink);
  sketch.words({0.72, 1.12, 0}, {10, -10}, "by the own cell", Paint::red);
  sketch.words({0.72, -0.4, 0}, {0, 26}, "by the neighbor, too", Paint::green, Anchor::middle);
}

// ---- Shadows

void leaving_level(Drawing& drawing) {
  const auto field = [](const auto& p) { return min(length(p) - 1.0, length(p - Vec3{2.9, 1.5, 0}) - 0.55); };
  const Ray out{.origin = at_angle(60), .direction = normalize(Point{2.9, 1.42, 0} - at_angle(60))};
  const Sketch sketch(drawing, {60, 230}, 150);
  const auto f = [&](double t) { return value_of(field, out.at(t)); };
  sketch.arrow({-0.1, 0, 0}, {3.6, 0, 0}, Paint::ink);
  sketch.arrow({0, -0.3, 0}, {0, 1.2, 0}, Paint::ink);
  sketch.curve([&](double t) { return Point{t, f(t), 0}; }, 0, 2.4, Paint::blue, Stroke::bold, 96);
  double leave = 1;
  const auto slope = [&](double t) { return (f(t + 1e-6) - f(t - 1e-6)) / 2e-6; };
  while (slope(leave) < 0.05) leave /= 2;
  expect(leave < 1 || slope(0.01) > 0, "leaving_level");
  sketch.polygon({{0, -0.12, 0}, {leave, -0.12, 0}, {leave, 0, 0}, {0, 0, 0}}, Paint::green);
  sketch.words({leave / 2, -0.12, 0}, {0, 24}, "the field only grows", Paint::green, Anchor::middle);
  double t = leave;
  while (f(t) > 1e-9) t += f(t);
  sketch.mark({0, 0, 0}, Paint::ink);
  sketch.mark({t, 0, 0}, Paint::red);
  sketch.words({t, 0, 0}, {0, 26}, "the next surface", Paint::red, Anchor::middle);
  sketch.words({0, 1.2, 0}, {10, 10}, "f(t)", Paint::blue);
  sketch.words({3.6, 0, 0}, {-4, -12}, "t", Paint::ink);
}

void distance_shadow(Drawing& drawing) {
  const Sphere ball{.center = {2, 1.3, 0}, .radius = 0.5};
  const Sketch sketch(drawing, {70, 250}, 120);
  const Vec3 towards = normalize(Vec3{1, 0.28, 0});
  const Point lamp = 4.2 * towards;
  sketch.line({-0.4, 0, 0}, {4.4, 0, 0}, Paint::ink, Stroke::bold);
  sketch.circle(ball.center, ball.radius, Paint::orange, Fill::soft);
  const auto f = [&](double t) { return length(t * towards - ball.center) - ball.radius; };
  double best = infinity, at = 0;
  for (int i = 1; i <= 400; ++i) {
    const double t = 4.2 * i / 400;
    if (f(t) / t < best) best = f(t) / t, at = t;
  }
  expect(best > 0 && best < 0.3, "distance_shadow");
  for (const double t : {0.35, 0.75, 1.25, at, 2.9})
    sketch.circle(t * towards, f(t), Paint::gray, Fill::none);
  sketch.circle(at * towards, f(at), Paint::blue, Fill::soft);
  sketch.line({0, 0, 0}, lamp, Paint::ink);
  // The cone that touches the ball of the least quotient.
  const double angle = std::asin(best), turned = std::atan2(towards.y, towards.x);
  for (const double side : {-1.0, 1.0})
    sketch.line({0, 0, 0}, 4.2 * Vec3{std::cos(turned + side * angle), std::sin(turned + side * angle), 0},
                Paint::blue, Stroke::dashed);
  sketch.lamp(lamp);
  sketch.words(at * towards, {10, 54}, joined({"least f/t: ", text_of(best)}), Paint::blue);
  sketch.mark({0, 0, 0}, Paint::red);
}

// ---- Fractals

void sponge_levels(Drawing& drawing) {
  double middle = 110;
  int last = 0;
  for (int level = 1; level <= 3; ++level) {
    const Sponge sponge{level};
    constexpr int cells = 27;
    int holes = 0;
    for (int i = 0; i < cells; ++i)
      for (int k = 0; k < cells; ++k) {
        // Just below the face at z = 1
        const Point p{(2 * (i + 0.5) - cells) / cells, (2 * (k + 0.5) - cells) / cells, 1 - 1e-3};
        if (value_of(sponge, p) < 0) {
          drawing.rectangle({middle - 94.5 + 7 * i, 60.0 + 7 * k}, 7, 7, Paint::orange, Fill::full);
        } else {
          ++holes;
        }
      }
    expect(holes > last, "sponge_levels");
    last = holes;
    drawing.words({middle, 38}, level == 1 ? "1 level" : joined({std::to_string(level), " levels"}),
                  Anchor::middle, Paint::ink, true);
    middle += 210;
  }
  expect(last == 27 * 27 - 8 * 8 * 8, "sponge_levels");
}

void sponge_balls(Drawing& drawing) {
  const Sponge sponge{3};
  const Sketch sketch(drawing, {330, 190}, 150);
  constexpr int cells = 81;
  const auto in_plane = [](double x, double y) { return Point{x, y, 0.2}; };
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      const double x = (2 * (i + 0.5) - cells) / cells, y = (2 * (k + 0.5) - cells) / cells;
      if (value_of(sponge, in_plane(x, y)) < 0) {
        const Place corner = sketch.of({x - 1.0 / cells, y + 1.0 / cells, 0});
        drawing.rectangle(corner, 300.0 / cells, 300.0 / cells, Paint::orange, Fill::soft);
      }
    }
  const Vec3 direction = normalize(Vec3{1, -0.38, 0});
  const Point origin{-2, 0.6, 0};
  double t = 0;
  int steps = 0;
  for (; steps < 60; ++steps) {
    const Point p = origin + t * direction;
    const double free = value_of(sponge, in_plane(p.x, p.y));
    if (free < 1e-3) break;
    sketch.circle(p, free, Paint::blue, Fill::soft);
    t += free;
  }
  expect(steps > 3 && steps < 60, "sponge_balls");
  sketch.line(origin, origin + t * direction, Paint::ink);
  sketch.mark(origin + t * direction, Paint::red);
}

}  // namespace

std::vector<StageFigure> field_figures() {
  return {
      {"level_lines", "34_fields", "Lines of equal value around a box, with sharp and with round corners",
       370, level_lines},
      {"fields_as_sets", "34_fields", "Two circles: their union, intersection and difference", 276,
       fields_as_sets},
      {"smooth_minimum", "35_blend",
       "Two straight lines, and a curve below both that goes from one to the other", 320, smooth_minimum},
      {"blended_outlines", "35_blend", "Two balls that flow together, more and more", 270, blended_outlines},
      {"folded_line", "36_repetition", "A zigzag line over a row of balls", 266, folded_line},
      {"wrong_cell", "36_repetition", "Balls in cells, and a free ball that reaches into the next cell", 320,
       wrong_cell},
      {"leaving_level", "37_marched_shadow", "A field along a ray that leaves a surface and meets another",
       290, leaving_level},
      {"distance_shadow", "37_marched_shadow", "A ray to a lamp past a ball, and the widest free cone", 280,
       distance_shadow},
      {"sponge_levels", "38_fractal", "A face of the sponge with one, two and three levels of holes", 270,
       sponge_levels},
      {"sponge_balls", "38_fractal", "A ray into a hole of the sponge, with its empty balls", 370,
       sponge_balls},
  };
}

}  // namespace figures
