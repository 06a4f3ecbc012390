// Figures of the stages 30 to 33: steps along a ray through a distance field, and proofs that they are right.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "scenes/three_spheres.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Spheres with the distance field of their union.
struct Balls {
  std::vector<Sphere> spheres;

  [[nodiscard]] double field(const Point& p) const {
    double nearest = infinity;
    for (const Sphere& s : spheres) nearest = std::min(nearest, length(p - s.center) - s.radius);
    return nearest;
  }

  /// Returns the exact t of the first hit.
  [[nodiscard]] std::optional<double> first(const Ray& ray) const {
    Scene<Sphere> scene;
    for (const Sphere& s : spheres) scene.add(s, Color{1});
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? std::optional(hit->t) : std::nullopt;
  }

  void draw(const Sketch& sketch) const {
    for (const Sphere& s : spheres) sketch.circle(s.center, s.radius, Paint::orange, Fill::soft);
  }
};

// ---- Fixed steps

void fixed_steps(Drawing& drawing) {
  constexpr double step = 0.5;
  const Balls balls{{{.center = {2.25, 0.62, 0}, .radius = 0.66},
                     {.center = {1.2, -1.2, 0}, .radius = 0.5},
                     {.center = {4.55, 0.25, 0}, .radius = 0.8}}};
  const Sketch sketch(drawing, {60, 150}, 100);
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const auto exact = balls.first(ray);
  balls.draw(sketch);
  sketch.eye({0, 0, 0}, {1, 0, 0});
  double t = step;
  for (; balls.field(ray.at(t)) > 0; t += step) sketch.mark(ray.at(t), Paint::blue, Fill::none);
  expect(exact && *exact < 2.2 && t > 3.7 && balls.field(ray.at(*exact + 0.2)) < 0, "fixed_steps");
  sketch.line(ray.at(0.05), ray.at(t), Paint::blue);
  sketch.mark(ray.at(t), Paint::red);
  sketch.cross(ray.at(*exact), Paint::green);
  sketch.words(ray.at(*exact), {0, 30}, "missed", Paint::green, Anchor::middle);
  sketch.words(ray.at(t), {10, -10}, "hit: too late", Paint::red);
  sketch.line({1, -0.14, 0}, {1.5, -0.14, 0}, Paint::blue);
  sketch.words({1.25, -0.14, 0}, {0, 22}, "ε", Paint::blue, Anchor::middle);
  drawing.words({320, 30}, "steps of the length ε", Anchor::middle, Paint::ink, true);
}

void missed_chords(Drawing& drawing) {
  constexpr double step = 0.5;
  const Balls ball{{{.center = {4.25, 0, 0}, .radius = 1.5}}};
  const Sketch sketch(drawing, {-100, 180}, 98);
  ball.draw(sketch);
  int missed = 0, seen = 0;
  for (int i = 0; i <= 40; ++i) {
    const double y = 1.56 * (i / 20.0 - 1);
    const Ray ray{.origin = {0, y, 0}, .direction = {1, 0, 0}};
    const auto exact = ball.first(ray);
    std::optional<double> found;
    for (double t = step; t < 7 && !found; t += step)
      if (ball.field(ray.at(t)) <= 0) found = t;
    if (exact && !found) ++missed;
    if (found) ++seen;
    const double end = found ? *found : 6.4;
    sketch.line(ray.at(1.6), ray.at(end), found ? Paint::blue : exact ? Paint::red : Paint::gray);
    if (found) sketch.mark(ray.at(end), Paint::blue);
  }
  expect(missed >= 2 && seen > 25, "missed_chords");
  for (int i = 4; i < 13; ++i)
    sketch.line({i * step, -1.68, 0}, {i * step, 1.68, 0}, Paint::gray, Stroke::dashed);
  drawing.words({450, 372}, "red: rays that miss it", Anchor::middle, Paint::red);
  drawing.words({180, 372}, "blue: stairs", Anchor::middle, Paint::blue);
}

/// Returns how many pixels of a small picture see something else than the exact scene does, if rays march
/// with this function.
int wrong_pixels(const auto& march, long long* evaluations = nullptr) {
  constexpr int width = 160, height = 120;
  const Camera camera;
  const auto scene = three_spheres();
  Balls balls;
  for (const auto& one : the_three_spheres) balls.spheres.push_back(one.sphere);
  int wrong = 0;
  for (int i = 0; i < width * height; ++i) {
    const Ray ray = camera.through_pixel(i % width, i / width, width, height);
    const auto hit = scene.intersect(ray, Interval{});
    int steps = 0;
    const std::optional<double> t = march(balls, ray, steps);
    if (evaluations) *evaluations += steps;
    if (t.has_value() != hit.has_value()) {
      ++wrong;
    } else if (t) {
      // The sphere that is nearest to the point that was found is another one.
      const Point p = ray.at(*t);
      std::size_t nearest = 0;
      const auto distance = [&](std::size_t k) {
        return length(p - balls.spheres[k].center) - balls.spheres[k].radius;
      };
      for (std::size_t k = 1; k < balls.spheres.size(); ++k)
        if (distance(k) < distance(nearest)) nearest = k;
      wrong += the_three_spheres[nearest].color != hit->color() ? 1 : 0;
    }
  }
  return wrong;
}

constexpr double far = 50;

std::optional<double> by_fixed_steps(const Balls& balls, const Ray& ray, double step, int& steps) {
  for (double t = step; t < far; t += step) {
    ++steps;
    if (balls.field(ray.at(t)) <= 0) return t;
  }
  return std::nullopt;
}

/// Marches with steps of `relaxation` times the free way.
std::optional<double> by_balls(const Balls& balls, const Ray& ray, double epsilon, double relaxation,
                               int& steps, int most = 512) {
  double t = 0, before = 0, step = 0;
  for (; steps < most && t < far; ++steps) {
    const double free = balls.field(ray.at(t));
    if (relaxation > 1 && before + std::abs(free) < step) {
      t += before - step, step = before, relaxation = 1;
      continue;
    }
    if (free < epsilon) return t;
    before = free, step = relaxation * free, t += step;
  }
  return std::nullopt;
}

void bars(Drawing& drawing, const std::vector<std::pair<std::string, int>>& rows, Paint paint,
          double bottom) {
  double x = 40;
  const double wide = 580.0 / static_cast<double>(rows.size());
  for (const auto& [name, value] : rows) {
    const double high = 50 * std::log10(1.0 + value);
    drawing.rectangle({x, bottom - high}, wide - 24, high, paint, Fill::soft);
    drawing.words({x + (wide - 24) / 2, bottom - 8 - high}, std::to_string(value), Anchor::middle, paint);
    drawing.words({x + (wide - 24) / 2, bottom + 24}, name, Anchor::middle);
    x += wide;
  }
  drawing.line({28, bottom}, {620, bottom}, Paint::ink);
}

void step_lengths(Drawing& drawing) {
  drawing.words({320, 24}, "wrong pixels of 19,200, by the length of a step", Anchor::middle, Paint::ink,
                true);
  std::vector<std::pair<std::string, int>> rows;
  for (const auto& [step, name] : {std::pair{4.0, "4"},
                                   {2.0, "2"},
                                   {1.0, "1"},
                                   {0.5, "0.5"},
                                   {0.2, "0.2"},
                                   {0.1, "0.1"},
                                   {0.05, "0.05"}})
    rows.emplace_back(name, wrong_pixels([by = step](const Balls& balls, const Ray& ray, int& steps) {
                        return by_fixed_steps(balls, ray, by, steps);
                      }));
  expect(rows.front().second > 1000 && rows.back().second < 100, "step_lengths");
  bars(drawing, rows, Paint::red, 280);
}

// ---- Balls

void empty_balls(Drawing& drawing) {
  const Balls balls{{{.center = {1.7, 1.25, 0}, .radius = 0.62},
                     {.center = {2.6, -1.35, 0}, .radius = 0.7},
                     {.center = {5.1, 0.25, 0}, .radius = 0.8}}};
  const Sketch sketch(drawing, {50, 190}, 100);
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const auto exact = balls.first(ray).value();
  double t = 0;
  int steps = 0;
  for (; steps < 40; ++steps) {
    const double free = balls.field(ray.at(t));
    if (free < 1e-2) break;
    sketch.circle(ray.at(t), free, Paint::blue, Fill::soft);
    sketch.mark(ray.at(t), Paint::blue);
    t += free;
  }
  expect(exact - t > 0 && exact - t < 0.05 && steps > 4, "empty_balls");
  balls.draw(sketch);
  sketch.line(ray.origin, ray.at(exact), Paint::ink);
  sketch.eye({0, 0, 0}, {1, 0, 0});
  sketch.mark(ray.at(exact), Paint::red);
  drawing.words({320, 360}, "each ball is empty, and the next one begins at its edge", Anchor::middle);
}

void lipschitz_cone(Drawing& drawing) {
  const Balls balls{{{.center = {2.2, 0.9, 0}, .radius = 0.7}, {.center = {4.9, -0.2, 0}, .radius = 0.9}}};
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const auto f = [&](double t) { return balls.field(ray.at(t)); };
  const Sketch sketch(drawing, {60, 250}, 120);
  sketch.arrow({-0.1, 0, 0}, {4.6, 0, 0}, Paint::ink);
  sketch.arrow({0, -0.3, 0}, {0, 1.8, 0}, Paint::ink);
  sketch.words({4.6, 0, 0}, {-4, 24}, "t", Paint::ink);
  sketch.words({0, 1.8, 0}, {10, 10}, "f(t)", Paint::blue);
  sketch.curve([&](double t) { return Point{t, f(t), 0}; }, 0, 4.25, Paint::blue, Stroke::bold, 96);
  double t = 0;
  for (int i = 0; i < 5; ++i) {
    const double v = f(t);
    sketch.line({t, 0, 0}, {t, v, 0}, Paint::gray, Stroke::dashed);
    sketch.line({t, v, 0}, {t + v, 0, 0}, Paint::red);
    for (int k = 0; k <= 20; ++k) expect(f(t + v * k / 20) >= v - v * k / 20 - 1e-12, "lipschitz_cone");
    sketch.mark({t, v, 0}, Paint::blue);
    t += v;
    sketch.mark({t, 0, 0}, Paint::red);
  }
  sketch.words({0.62, 0.75, 0}, {6, -4}, "falls by no more than this", Paint::red);
}

void grazing_balls(Drawing& drawing) {
  const Balls ball{{{.center = {3, -1.01, 0}, .radius = 1}}};
  const Sketch sketch(drawing, {-80, 120}, 140);
  const Ray ray{.origin = {0.7, 0, 0}, .direction = {1, 0, 0}};
  expect(!ball.first(ray), "grazing_balls");
  double t = 0;
  int steps = 0;
  for (; t < 4.3; ++steps) {
    const double free = ball.field(ray.at(t));
    sketch.circle(ray.at(t), free, Paint::blue, Fill::none);
    t += free;
  }
  expect(steps > 25, "grazing_balls");
  sketch.circle({3, -1.01, 0}, 1, Paint::orange, Fill::soft);
  sketch.line(ray.origin, ray.at(t), Paint::ink);
  drawing.words({320, 330}, joined({std::to_string(steps), " steps past a sphere that is missed"}),
                Anchor::middle);
}

void epsilon_thresholds(Drawing& drawing) {
  drawing.words({320, 24}, "wrong pixels of 19,200, by ε", Anchor::middle, Paint::ink, true);
  std::vector<std::pair<std::string, int>> rows;
  for (const auto& [epsilon, name] : {std::pair{0.1, "0.1"},
                                      {1e-2, "10⁻²"},
                                      {1e-3, "10⁻³"},
                                      {1e-4, "10⁻⁴"},
                                      {1e-6, "10⁻⁶"},
                                      {1e-9, "10⁻⁹"}})
    rows.emplace_back(name, wrong_pixels([e = epsilon](const Balls& balls, const Ray& ray, int& steps) {
                        return by_balls(balls, ray, e, 1, steps, 64);
                      }));
  bars(drawing, rows, Paint::red, 230);
  drawing.words({320, 284}, "after 64 steps a ray gives up", Anchor::middle);
}

// ---- Longer steps

void overlapping_balls(Drawing& drawing) {
  const Balls balls{{{.center = {6.1, 0.1, 0}, .radius = 0.5}}};
  double y = 110;
  std::array<int, 2> steps{};
  for (const double relaxation : {1.0, 1.6}) {
    const Balls here{{{.center = {2.6, -12.3, 0}, .radius = 12}, balls.spheres[0]}};
    const Sketch sketch(drawing, {40, y}, 96);
    const Ray ray{.origin = {0.8, 0, 0}, .direction = {1, 0, 0}};
    sketch.circle(balls.spheres[0].center, balls.spheres[0].radius, Paint::orange, Fill::soft);
    const Sphere& ground = here.spheres[0];
    sketch.curve([&](double degrees) { return ground.center + ground.radius * at_angle(degrees); }, 75, 102,
                 Paint::orange, Stroke::bold);
    double t = 0, before = 0, step = 0, factor = relaxation;
    int count = 0;
    while (count < 60) {
      const double free = here.field(ray.at(t));
      ++count;
      if (before + std::abs(free) < step) {
        t += before - step, step = before, factor = 1;
        continue;
      }
      if (free < 1e-2) break;
      sketch.circle(ray.at(t), free, Paint::blue, Fill::soft);
      sketch.mark(ray.at(t), Paint::blue);
      before = free, step = factor * free, t += step;
    }
    steps[relaxation > 1 ? 1 : 0] = count;
    sketch.line(ray.origin, ray.at(here.first(ray).value()), Paint::ink);
    drawing.words({20, y - 72}, relaxation > 1 ? "Ω = 1.6" : "Ω = 1", Anchor::start, Paint::ink, true);
    y += 190;
  }
  expect(steps[1] < steps[0], "overlapping_balls");
}

void gap_between_balls(Drawing& drawing) {
  const Balls balls{{{.center = {3.05, 0.2, 0}, .radius = 0.26}, {.center = {6.6, 0, 0}, .radius = 0.3}}};
  const Sketch sketch(drawing, {10, 190}, 110);
  const Ray ray{.origin = {1.2, 0, 0}, .direction = {1, 0, 0}};
  const double first = balls.field(ray.at(0)), step = 1.6 * first, second = balls.field(ray.at(step));
  const double hit = balls.first(ray).value();
  expect(first + second < step && hit < step && hit > first, "gap_between_balls");
  balls.draw(sketch);
  sketch.circle(ray.at(0), first, Paint::blue, Fill::soft);
  sketch.circle(ray.at(step), second, Paint::red, Fill::soft);
  sketch.line(ray.origin, ray.at(step), Paint::ink);
  sketch.line(ray.at(first), ray.at(step - second), Paint::red, Stroke::bold);
  sketch.mark(ray.at(0), Paint::blue);
  sketch.mark(ray.at(step), Paint::red);
  sketch.mark(ray.at(first), Paint::green);
  sketch.words(ray.at(first), {-8, 28}, "back to here", Paint::green, Anchor::end);
  sketch.words(ray.at(0), {0, 24}, "t", Paint::blue, Anchor::middle);
  sketch.words(ray.at(step), {0, 24}, "t'", Paint::red, Anchor::middle);
  sketch.words(ray.at(0.5 * (first + step - second)), {0, -56}, "not covered", Paint::red, Anchor::middle);
}

void relaxations(Drawing& drawing) {
  drawing.words({320, 24}, "mean number of evaluations of a ray, by Ω", Anchor::middle, Paint::ink, true);
  double x = 40;
  double least = infinity, plain = 0;
  for (const auto& [omega, name] :
       {std::pair{1.0, "1"}, {1.2, "1.2"}, {1.4, "1.4"}, {1.6, "1.6"}, {1.8, "1.8"}, {1.95, "1.95"}}) {
    long long evaluations = 0;
    wrong_pixels([o = omega](const Balls& balls, const Ray& ray,
                             int& steps) { return by_balls(balls, ray, 1e-3, o, steps); },
                 &evaluations);
    const double mean = static_cast<double>(evaluations) / 19200;
    if (omega == 1) plain = mean;
    least = std::min(least, mean);
    const double high = 7 * mean;
    drawing.rectangle({x, 260 - high}, 70, high, Paint::blue, Fill::soft);
    drawing.words({x + 35, 252 - high}, text_of(mean, 1), Anchor::middle, Paint::blue);
    drawing.words({x + 35, 284}, name, Anchor::middle);
    x += 97;
  }
  expect(least < plain, "relaxations");
  drawing.line({28, 260}, {620, 260}, Paint::ink);
}

// ---- Proofs

/// Range of numbers.
struct Range {
  double lo, hi;
};

/// Returns the range of the distance to a sphere along a ray of unit direction. It is convex: it has its
/// least value where the ray is nearest to the center, and its greatest at an end.
Range values_of(const Sphere& sphere, const Ray& ray, const Range& t) {
  const auto f = [&](double at) { return length(ray.at(at) - sphere.center) - sphere.radius; };
  const double nearest = std::clamp(dot(sphere.center - ray.origin, ray.direction), t.lo, t.hi);
  return {f(nearest), std::max(f(t.lo), f(t.hi))};
}

/// Returns the range of its slope, which grows along the ray.
Range slopes_of(const Sphere& sphere, const Ray& ray, const Range& t) {
  const auto slope = [&](double at) {
    const Vec3 v = ray.at(at) - sphere.center;
    return dot(v, ray.direction) / length(v);
  };
  return {slope(t.lo), slope(t.hi)};
}

/// Step of the march of stage 33.
struct Segment {
  Range t, values, slopes;
  bool is_free, is_crossing;
};

/// Marches as stage 33 does, with the exact ranges of one sphere, until it has found a crossing or is past
/// `end`. Without the values, what is free is proven by slopes alone.
std::vector<Segment> segments(const Sphere& sphere, const Ray& ray, double end, bool with_values = true) {
  std::vector<Segment> all;
  double t = 0, step = 1;
  while (t < end && all.size() < 60) {
    const Range over{t, t + step};
    const Range v = values_of(sphere, ray, over), s = slopes_of(sphere, ray, over);
    const double left = values_of(sphere, ray, {over.lo, over.lo}).hi,
                 right = values_of(sphere, ray, {over.hi, over.hi}).hi;
    const bool is_free = (with_values && v.lo > 0) || left + step * std::min(s.lo, 0.0) > 0 ||
                         right - step * std::max(s.hi, 0.0) > 0;
    const bool is_crossing = !is_free && s.hi < 0 && right < 0;
    all.push_back({over, v, s, is_free, is_crossing});
    if (is_crossing) break;
    if (is_free) {
      t = over.hi, step *= 2;
    } else {
      step /= 2;
    }
  }
  return all;
}

void enclosing_boxes(Drawing& drawing) {
  const Sphere sphere{.center = {4.2, 0.45, 0}, .radius = 1.2};
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const Sketch sketch(drawing, {60, 270}, 76);
  const auto f = [&](double t) { return values_of(sphere, ray, {t, t}).hi; };
  const auto all = segments(sphere, ray, 6);
  for (const Segment& segment : all) {
    const Paint paint = segment.is_crossing ? Paint::red : segment.is_free ? Paint::green : Paint::gray;
    const auto& [t, v] = std::pair(segment.t, segment.values);
    for (const Point& corner : {Point{t.lo, v.lo, 0}, Point{t.hi, v.hi, 0}})
      expect(std::abs(corner.x) < 8, "enclosing_boxes");
    sketch.polygon({{t.lo, v.lo, 0}, {t.hi, v.lo, 0}, {t.hi, v.hi, 0}, {t.lo, v.hi, 0}}, paint,
                   segment.is_free || segment.is_crossing ? Fill::soft : Fill::none);
  }
  expect(all.size() > 3 && all.back().is_crossing, "enclosing_boxes");
  Scene<Sphere> scene;
  scene.add(sphere, Color{1});
  const double hit = scene.intersect(ray, Interval{}).value().t;
  expect(all.back().t.lo < hit && hit < all.back().t.hi, "enclosing_boxes");
  sketch.arrow({-0.1, 0, 0}, {7.2, 0, 0}, Paint::ink);
  sketch.arrow({0, -1, 0}, {0, 3.3, 0}, Paint::ink);
  sketch.curve([&](double t) { return Point{t, f(t), 0}; }, 0, 6.2, Paint::blue, Stroke::bold, 96);
  sketch.mark({hit, 0, 0}, Paint::red);
  sketch.words({7.2, 0, 0}, {-6, 24}, "t", Paint::ink);
  sketch.words({0, 3.3, 0}, {10, 12}, "f(t)", Paint::blue);
  drawing.words({380, 60}, "green: surely free", Anchor::start, Paint::green);
  drawing.words({380, 86}, "gray: in doubt, halved", Anchor::start, Paint::gray);
  drawing.words({380, 112}, "red: surely a crossing", Anchor::start, Paint::red);
}

void slope_lines(Drawing& drawing) {
  const Sphere sphere{.center = {2.2, 1.06, 0}, .radius = 1};
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const Range t{1.75, 2.65};
  const auto f = [&](double at) { return values_of(sphere, ray, {at, at}).hi; };
  const Range slopes = slopes_of(sphere, ray, t);
  const double left = f(t.lo), right = f(t.hi);
  // The two lines meet where left + lo (s - t.lo) = right - hi (t.hi - s).
  const double meet = (right - left + slopes.lo * t.lo - slopes.hi * t.hi) / (slopes.lo - slopes.hi);
  const double low = left + slopes.lo * (meet - t.lo);
  expect(t.lo < meet && meet < t.hi && low < 0 && f(meet) > 0, "slope_lines");
  const auto draw = [&](double middle, const Range& over, const char* title) {
    const Sketch sketch(drawing, {middle - 2.2 * 270, 240}, 270);
    const auto place = [&](double at, double value) { return Point{at, 2 * value, 0}; };
    const Range s = slopes_of(sphere, ray, over);
    const double a = f(over.lo), b = f(over.hi);
    const double m = (b - a + s.lo * over.lo - s.hi * over.hi) / (s.lo - s.hi);
    sketch.line(place(1.68, 0), place(2.72, 0), Paint::ink);
    sketch.curve([&](double at) { return place(at, f(at)); }, 1.72, 2.68, Paint::blue, Stroke::bold);
    sketch.line(place(over.lo, a), place(m, a + s.lo * (m - over.lo)), Paint::red);
    sketch.line(place(over.hi, b), place(m, b - s.hi * (over.hi - m)), Paint::green);
    sketch.mark(place(over.lo, a), Paint::red);
    sketch.mark(place(over.hi, b), Paint::green);
    drawing.words({middle, 26}, title, Anchor::middle, Paint::ink, true);
    return a + s.lo * (m - over.lo);
  };
  expect(draw(165, t, "wide: in doubt") < 0, "slope_lines");
  expect(draw(480, {t.lo, 0.5 * (t.lo + t.hi)}, "half as wide: free") > 0, "slope_lines");
  drawing.words({320, 340}, "the field lies above the red line, and above the green one", Anchor::middle);
}

void near_misses(Drawing& drawing) {
  drawing.words({320, 24}, "steps past a sphere, by the gap", Anchor::middle, Paint::ink, true);
  drawing.words({60, 52}, "balls", Anchor::start, Paint::red);
  drawing.words({130, 52}, "slopes", Anchor::start, Paint::green);
  double x = 40;
  int last_balls = 0, last_segments = 0;
  for (const auto& [gap, name] : {std::pair{1e-1, "0.1"},
                                  {1e-2, "10⁻²"},
                                  {1e-3, "10⁻³"},
                                  {1e-4, "10⁻⁴"},
                                  {1e-5, "10⁻⁵"},
                                  {1e-6, "10⁻⁶"}}) {
    const Sphere sphere{.center = {3.3, 1 + gap, 0}, .radius = 1};
    const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
    const auto all = segments(sphere, ray, 6, false);
    expect(!all.empty() && all.back().is_free, "near_misses");
    int steps = 0;
    for (double t = 0; t < 6; ++steps) t += values_of(sphere, ray, {t, t}).hi;
    double left = x;
    last_balls = steps, last_segments = static_cast<int>(all.size());
    for (const auto& [count, paint] : {std::pair{last_balls, Paint::red}, {last_segments, Paint::green}}) {
      const double high = 62 * std::log10(static_cast<double>(count));
      drawing.rectangle({left, 290 - high}, 40, high, paint, Fill::soft);
      drawing.words({left + 20, 282 - high}, std::to_string(count), Anchor::middle, paint);
      left += 44;
    }
    drawing.words({x + 42, 316}, name, Anchor::middle);
    x += 98;
  }
  expect(last_balls > 10 * last_segments, "near_misses");
  drawing.line({28, 290}, {620, 290}, Paint::ink);
}

}  // namespace

std::vector<StageFigure> marching_figures() {
  return {
      {"fixed_steps", "30_fixed_step", "Steps of one length along a ray, which jump over a sphere", 296,
       fixed_steps},
      {"missed_chords", "30_fixed_step", "Parallel rays with steps of one length before a sphere", 392,
       missed_chords},
      {"step_lengths", "30_fixed_step", "Bars: wrong pixels for steps from 4 to 0.05", 322, step_lengths},
      {"empty_balls", "31_sphere_tracing", "A chain of empty balls along a ray, up to a sphere", 376,
       empty_balls},
      {"lipschitz_cone", "31_sphere_tracing",
       "A field along a ray, and lines below it that fall with the slope 1", 300, lipschitz_cone},
      {"grazing_balls", "31_sphere_tracing", "Many small balls along a ray that passes close to a sphere",
       346, grazing_balls},
      {"epsilon_thresholds", "31_sphere_tracing", "Bars: wrong pixels for ε from 0.1 to a thousand-millionth",
       300, epsilon_thresholds},
      {"overlapping_balls", "32_enhanced", "Chains of balls along a ray: side by side, and overlapping", 400,
       overlapping_balls},
      {"gap_between_balls", "32_enhanced", "Two balls that do not overlap, and a small sphere between them",
       372, gap_between_balls},
      {"relaxations", "32_enhanced", "Bars: evaluations of a ray for factors from 1 to 1.95", 302,
       relaxations},
      {"enclosing_boxes", "33_certified", "A field along a ray, enclosed by boxes", 366, enclosing_boxes},
      {"slope_lines", "33_certified", "A field between two lines of its least and its greatest slope", 358,
       slope_lines},
      {"near_misses", "33_certified", "Bars: steps past a sphere for gaps from 0.1 to a millionth", 332,
       near_misses},
  };
}

}  // namespace figures
