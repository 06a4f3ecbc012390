// Figures of the stages 13 to 16: surfaces and their coordinates, solids and environments.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <protostar/scene.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "figures.hpp"
#include "scenes/dusk.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

const Camera from_above = Camera::look_at({1.2, 2.2, -3.4}, Point{0});

/// Draws a circle around a point, in the plane of two directions of unit length.
void draw_circle(const Sketch& sketch, const Point& center, double radius, const Vec3& u, const Vec3& v,
                 Paint paint) {
  sketch.curve(
      [&](double degrees) {
        const Vec3 at = at_angle(degrees);
        return center + radius * (at.x * u + at.y * v);
      },
      0, 360, paint);
}

void checker_uv(Drawing& drawing) {
  const Parallelogram board{.position = {0, 0, 0}, .edge_u = {4, 0, 0}, .edge_v = {0, 0, 3}};
  const Checker checker{.first = Color{1}, .second = Color{0}, .size = 1};
  const Sketch sketch(drawing, {70, 240}, 104, Camera::look_at({0.9, 2.6, -3.4}, Point{0}));
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      const Point corner{i + 0.0, 0, k + 0.0};
      const Vec3 right{1, 0, 0}, away{0, 0, 1};
      const Uv middle = board.uv_at(corner + 0.5 * (right + away));
      sketch.polygon({corner, corner + right, corner + right + away, corner + away}, Paint::gray,
                     checker(middle.x, middle.y).r > 0 ? Fill::none : Fill::soft);
      sketch.words(corner + 0.5 * (right + away), {0, 6}, std::to_string(i + k),
                   (i + k) % 2 == 0 ? Paint::ink : Paint::gray, Anchor::middle);
    }
  sketch.arrow(Point{0}, {4.4, 0, 0}, Paint::blue, Stroke::bold);
  sketch.arrow(Point{0}, {0, 0, 3.5}, Paint::green, Stroke::bold);
  sketch.words({4.4, 0, 0}, {6, 8}, "u", Paint::blue);
  sketch.words({0, 0, 3.5}, {-6, -8}, "v", Paint::green);
  const Ray ray{.origin = {2.7, 2.0, 1.2}, .direction = {0, -1, 0.1}};
  const Point hit = ray.at(board.intersect(ray).value());
  const Uv uv = board.uv_at(hit);
  sketch.arrow(ray.origin, hit, Paint::red, Stroke::bold);
  sketch.words(ray.origin, {10, 10}, joined({"u = ", text_of(uv.x, 1), ", v = ", text_of(uv.y, 1)}),
               Paint::red);
  drawing.words({250, 336}, "each square shows ⌊u⌋ + ⌊v⌋: even or odd", Anchor::middle);
}

void plane_crossing(Drawing& drawing) {
  const Vec3 n = normalize(Vec3{-0.35, 1, 0}), along{n.y, -n.x, 0};
  const Point a = -1.5 * along;
  const Plane plane{.normal = n, .distance = 0};
  const Ray ray{.origin = 1.75 * n - 1.85 * along, .direction = std::sqrt(0.75) * along - 0.5 * n};
  const double t = plane.intersect(ray).value(), height = dot(n, ray.origin - a),
               slope = -dot(n, ray.direction);
  expect(std::abs(t - height / slope) < 1e-12, "plane_crossing");
  const Sketch sketch(drawing, {330, 200}, 100);
  sketch.line(-2.9 * along, 2.9 * along, Paint::ink, Stroke::bold);
  sketch.arrow(a, a + 0.8 * n, Paint::green, Stroke::bold);
  sketch.mark(a, Paint::ink);
  sketch.line(ray.origin, ray.origin - height * n, Paint::gray, Stroke::dashed);
  sketch.ray(ray, t + 0.9, Paint::blue);
  sketch.ray(ray, 1, Paint::blue, Stroke::bold);
  sketch.mark(ray.origin, Paint::blue);
  sketch.mark(ray.at(t), Paint::red);
  sketch.arrow(0.9 * along - 0.5 * n, 2.6 * along - 0.5 * n, Paint::gray, Stroke::dashed);
  sketch.words(a, {4, 26}, "p₀", Paint::ink);
  sketch.words(a + 0.8 * n, {8, 4}, "n", Paint::green);
  sketch.words(ray.origin, {-12, -6}, "o", Paint::blue, Anchor::end);
  sketch.words(ray.at(1), {0, -10}, "d", Paint::blue, Anchor::end);
  sketch.words(ray.origin - 0.5 * height * n, {-10, 6}, text_of(height), Paint::gray, Anchor::end);
  drawing.words({320, 318}, joined({"t = ", text_of(height), "/", text_of(slope), " = ", text_of(t)}),
                Anchor::middle, Paint::red);
  sketch.words(0.9 * along - 0.5 * n, {-40, 26}, "parallel, n · d = 0: no hit", Paint::gray);
}

void disk(Drawing& drawing) {
  const Disk disk{.position = {0, 0, 0}, .normal = {0, 1, 0}, .radius = 1.2};
  const Plane plane{.normal = {0, 1, 0}, .distance = 0};
  const Sketch sketch(drawing, {290, 178}, 106, from_above);
  sketch.polygon({{-2, 0, -1.4}, {2.5, 0, -1.4}, {2.5, 0, 1.4}, {-2, 0, 1.4}}, Paint::gray, Fill::none);
  std::vector<Point> outline;
  for (int i = 0; i < 60; ++i) outline.push_back(1.2 * Point{at_angle(6 * i).x, 0, at_angle(6 * i).y});
  sketch.polygon(outline, Paint::blue);
  for (const Point& above : {Point{-0.9, 1.3, -0.2}, Point{1.1, 1.3, 0.1}}) {
    const Ray ray{.origin = above, .direction = {0.35, -1, 0}};
    const Point p = ray.at(plane.intersect(ray).value());
    const bool is_hit = disk.intersect(ray).has_value();
    const Paint paint = is_hit ? Paint::green : Paint::red;
    sketch.arrow(above, p, paint, Stroke::bold);
    sketch.line(disk.position, p, paint, Stroke::dashed);
    sketch.words(p, {is_hit ? -10.0 : 12.0, -2},
                 joined({"|p − c| = ", text_of(length(p - disk.position), 1)}), paint,
                 is_hit ? Anchor::end : Anchor::start);
  }
  sketch.arrow(Point{0}, {0, 0.7, 0}, Paint::ink);
  sketch.mark(Point{0}, Paint::ink);
  sketch.words({0, 0.7, 0}, {0, -8}, "n", Paint::ink, Anchor::middle);
  sketch.words(Point{0}, {8, 22}, "c", Paint::ink);
  sketch.line(Point{0}, {-0.3, 0, -1.162}, Paint::blue);
  sketch.words({-0.25, 0, -0.8}, {-8, 4}, "R = 1.2", Paint::blue, Anchor::end);
}

void parallelogram(Drawing& drawing) {
  const Parallelogram shape{.position = {0, 0, 0}, .edge_u = {2.6, 0.3, 0}, .edge_v = {0.8, 1.7, 0}};
  const Sketch sketch(drawing, {120, 280}, 112);
  const auto at = [&](double alpha, double beta) {
    return shape.position + alpha * shape.edge_u + beta * shape.edge_v;
  };
  sketch.polygon({at(0, 0), at(1, 0), at(1, 1), at(0, 1)}, Paint::blue);
  for (int i = 1; i < 4; ++i) {
    sketch.line(at(0.25 * i, 0), at(0.25 * i, 1), Paint::gray, Stroke::dashed);
    sketch.line(at(0, 0.25 * i), at(1, 0.25 * i), Paint::gray, Stroke::dashed);
  }
  sketch.arrow(at(0, 0), at(1, 0), Paint::orange, Stroke::bold);
  sketch.arrow(at(0, 0), at(0, 1), Paint::green, Stroke::bold);
  for (const Point& p : {at(0.75, 0.5), at(1.12, 0.4)}) {
    const Ray ray{.origin = p - Vec3{0, 0, 2}, .direction = {0, 0, 1}};
    const Uv uv = shape.uv_at(p);
    const double alpha = uv.x / length(shape.edge_u), beta = uv.y / length(shape.edge_v);
    const bool is_hit = shape.intersect(ray).has_value();
    const Paint paint = is_hit ? Paint::green : Paint::red;
    sketch.mark(p, paint);
    sketch.words(p, {is_hit ? -10.0 : 12.0, is_hit ? -8.0 : 6.0},
                 joined({"(", text_of(alpha), ", ", text_of(beta), ")"}), paint,
                 is_hit ? Anchor::end : Anchor::start);
  }
  sketch.mark(at(0, 0), Paint::ink);
  sketch.words(at(0, 0), {-12, 12}, "p₀", Paint::ink, Anchor::end);
  sketch.words(at(0.5, 0), {10, 26}, "a: u from 0 to 1", Paint::orange, Anchor::middle);
  sketch.words(at(0, 0.6), {-12, 0}, "b: v", Paint::green, Anchor::end);
}

void triangle(Drawing& drawing) {
  const Triangle shape{{0, 0, 0}, {3.2, 0.3, 0}, {1.1, 2.2, 0}};
  const Sketch sketch(drawing, {110, 290}, 110);
  const Point p = shape.a + 0.3 * (shape.b - shape.a) + 0.25 * (shape.c - shape.a);
  const Uv uv = shape.uv_at(p);
  const auto weight = [](double w) { return text_of(w); };
  sketch.polygon({shape.b, shape.c, p}, Paint::red);
  sketch.polygon({shape.c, shape.a, p}, Paint::green);
  sketch.polygon({shape.a, shape.b, p}, Paint::blue);
  sketch.mark(p, Paint::ink);
  for (const auto& [vertex, name, paint, w, beside, anchor] :
       {std::tuple{shape.a, "p₀", Paint::red, 1 - uv.x - uv.y, Place{-10, 26}, Anchor::middle},
        {shape.b, "p₁", Paint::green, uv.x, Place{14, 6}, Anchor::start},
        {shape.c, "p₂", Paint::blue, uv.y, Place{0, -12}, Anchor::middle}}) {
    sketch.mark(vertex, paint);
    sketch.words(vertex, beside, name, paint, anchor);
    // The weight of a vertex is the share of the area of the triangle across from it.
    const Point across = (shape.a + shape.b + shape.c - vertex + p) / 3.0;
    sketch.words(across, {0, 6}, weight(w), paint, Anchor::middle);
  }
  sketch.words(p, {10, -10}, "p");
  drawing.words({480, 80}, "p =", Anchor::start, Paint::ink);
  drawing.words({480, 108}, weight(1 - uv.x - uv.y) + " p₀", Anchor::start, Paint::red);
  drawing.words({480, 134}, joined({"+ ", weight(uv.x), " p₁"}), Anchor::start, Paint::green);
  drawing.words({480, 160}, joined({"+ ", weight(uv.y), " p₂"}), Anchor::start, Paint::blue);
}

void box_slabs(Drawing& drawing) {
  const Box box{.min = {-0.9, -0.6, -1}, .max = {0.9, 0.6, 1}};
  double left = 0;
  for (const bool is_hit : {true, false}) {
    const Sketch sketch(drawing, {left + 164, 150}, 84);
    const Ray ray{.origin = {-1.75, is_hit ? -0.75 : 0.3, 0}, .direction = normalize(Vec3{1, 0.42, 0})};
    drawing.words({left + 160, 24}, is_hit ? "hit" : "miss", Anchor::middle, Paint::ink, true);
    for (const double end : {-1.0, 1.0}) {
      sketch.line({0.9 * end, -1.15, 0}, {0.9 * end, 1.15, 0}, Paint::blue, Stroke::dashed);
      sketch.line({-1.8, 0.6 * end, 0}, {1.8, 0.6 * end, 0}, Paint::orange, Stroke::dashed);
    }
    drawing.rectangle(sketch.of({-0.9, 0.6, 0}), 84 * 1.8, 84 * 1.2, Paint::ink, Fill::soft);
    sketch.ray(ray, is_hit ? 3.7 : 2.9, Paint::ink, Stroke::bold);
    const auto bar_at = [&](double t) { return left + 24 + 74 * t; };
    double latest = -infinity, earliest = infinity, y = 282;
    for (int axis = 0; axis < 2; ++axis) {
      Vec3 normal{0};
      normal[axis] = 1;
      const Interval line{.min = -infinity};
      const double from = Plane{normal, box.min[axis]}.intersect(ray, line).value(),
                   to = Plane{normal, box.max[axis]}.intersect(ray, line).value();
      const Paint paint = axis == 0 ? Paint::blue : Paint::orange;
      drawing.rectangle({bar_at(std::max(from, 0.0)), y},
                        bar_at(std::min(to, 3.6)) - bar_at(std::max(from, 0.0)), 14, paint, Fill::soft);
      drawing.words({left + 14, y + 13}, axis == 0 ? "x" : "y", Anchor::middle, paint);
      for (const double t : {from, to})
        if (t > 0 && t < 3.7 && (is_hit || t < 2.9)) sketch.mark(ray.at(t), paint);
      latest = std::max(latest, from), earliest = std::min(earliest, to);
      y += 24;
    }
    const auto entry = box.intersect(ray);
    expect(entry.has_value() == is_hit && (!entry || std::abs(*entry - latest) < 1e-12), "box_slabs");
    if (is_hit)
      drawing.rectangle({bar_at(latest), y}, bar_at(earliest) - bar_at(latest), 14, Paint::green, Fill::full);
    drawing.words({left + 160, y + 40}, is_hit ? "both at once: inside" : "never both at once",
                  Anchor::middle, is_hit ? Paint::green : Paint::red);
    left += 320;
  }
}

void quadric(Drawing& drawing) {
  const Quadric hill{{.squares = {2, 0, 2}, .linear = {0, 0.5, 0}, .constant = -2}};
  const Sketch section(drawing, {160, 270}, 96);
  drawing.words({160, 24}, "paraboloid", Anchor::middle, Paint::ink, true);
  std::vector<Point> outline;
  for (int i = 0; i <= 44; ++i) {
    const Ray down{.origin = {0.05 * i - 1.1, 4, 0}, .direction = {0, -1, 0}};
    expect(roots_of(hill, down).count() == 1, "quadric");
    outline.push_back(down.at(hill.intersect(down).value()));
  }
  section.polygon(outline, Paint::gray);
  for (const auto& [ray, t, paint] :
       {std::tuple{Ray{.origin = {-1.4, 0.6, 0}, .direction = {1, 0.1, 0}}, 2.9, Paint::blue},
        {Ray{.origin = {0.45, 2.45, 0}, .direction = {0, -1, 0}}, 2.6, Paint::red}}) {
    section.ray(ray, t, paint, Stroke::bold);
    for (const double root : roots_of(hill, ray)) section.mark(ray.at(root), paint);
  }
  drawing.words({160, 334}, "blue: two roots", Anchor::middle, Paint::blue);
  drawing.words({160, 358}, "red: A = 0, one root", Anchor::middle, Paint::red);

  const Quadric cylinder{{.squares = {1, 0, 1}, .constant = -1}};
  const Sketch space(drawing, {480, 172}, 92, Camera::look_at({0, 1.3, -4}, Point{0}));
  drawing.words({480, 24}, "cylinder", Anchor::middle, Paint::ink, true);
  for (const double y : {-1.0, 1.0}) draw_circle(space, {0, y, 0}, 1, {1, 0, 0}, {0, 0, 1}, Paint::gray);
  for (const double x : {-1.0, 1.0}) {
    space.line({x, -1, 0}, {x, 1, 0}, Paint::gray);
    space.line({x, 1, 0}, {x, 1.3, 0}, Paint::gray, Stroke::dashed);
    space.line({x, -1, 0}, {x, -1.3, 0}, Paint::gray, Stroke::dashed);
  }
  const Ray ray{.origin = {-1.5, 0.75, -0.9}, .direction = {1, -0.35, 0.45}};
  const Roots roots = roots_of(cylinder, ray);
  space.line(ray.origin, ray.at(roots[0]), Paint::blue, Stroke::bold);
  space.line(ray.at(roots[0]), ray.at(roots[1]), Paint::blue, Stroke::dashed);
  space.arrow(ray.at(roots[1]), ray.at(3.1), Paint::blue, Stroke::bold);
  const Point first = ray.at(roots[0]);
  space.arrow(first, first + 0.7 * cylinder.normal_at(first), Paint::green, Stroke::bold);
  for (const double t : roots) space.mark(ray.at(t), Paint::red);
  space.words(first + 0.7 * cylinder.normal_at(first), {-6, 18}, "n", Paint::green, Anchor::end);
  drawing.words({480, 334}, "x² + z² − 1 = 0, without an end", Anchor::middle);
}

void csg_intervals(Drawing& drawing) {
  const Sphere a{.center = {1.9, 0, 0}, .radius = 1.05}, b{.center = {3.3, 0, 0}, .radius = 0.95};
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const Sketch sketch(drawing, {120, 130}, 100);
  sketch.circle(a.center, a.radius, Paint::blue);
  sketch.circle(b.center, b.radius, Paint::orange);
  sketch.words(a.center, {-30, -40}, "S", Paint::blue, Anchor::middle);
  sketch.words(b.center, {30, -40}, "T", Paint::orange, Anchor::middle);
  sketch.ray(ray, 4.9, Paint::ink);
  sketch.eye(Point{0}, ray.direction);
  double y = 272;
  for (const auto& [name, solid, paint] : {std::tuple{"S", Csg(a), Paint::blue},
                                           {"T", Csg(b), Paint::orange},
                                           {"S ∪ T", union_of({a, b}), Paint::ink},
                                           {"S ∩ T", intersection_of({a, b}), Paint::green},
                                           {"S \\ T", difference_of({a, b}), Paint::red}}) {
    std::vector<double> crossings;
    solid.each_crossing(ray, {}, [&](const Crossing& crossing) { crossings.push_back(crossing.t); });
    expect(crossings.size() == 2, "csg_intervals");
    const Place from = sketch.of(ray.at(crossings[0])), to = sketch.of(ray.at(crossings[1]));
    drawing.line({120, y}, {610, y}, Paint::gray, Stroke::dashed);
    drawing.rectangle({from.x, y - 8}, to.x - from.x, 16, paint, Fill::soft);
    for (const double x : {from.x, to.x}) drawing.mark({x, y}, paint);
    drawing.words({100, y + 6}, name, Anchor::end, paint);
    y += 36;
  }
  for (const Sphere& sphere : {a, b})
    for (const double t : roots_of(sphere, ray))
      drawing.line(sketch.of(ray.at(t)), {sketch.of(ray.at(t)).x, y - 24}, Paint::gray, Stroke::dashed);
}

void csg_bowl(Drawing& drawing) {
  const Csg bowl = difference_of({Sphere{}, Sphere{.radius = 0.7}, Box{{-1, 0.35, -1}, {1, 1, 1}}});
  const Sketch sketch(drawing, {320, 160}, 140);
  sketch.circle(Point{0}, 1, Paint::gray, Fill::none, Stroke::dashed);
  sketch.circle(Point{0}, 0.7, Paint::gray, Fill::none, Stroke::dashed);
  for (double y = -0.985; y < 0.35; y += 0.03) {
    const Ray row{.origin = {-2, y, 0}, .direction = {1, 0, 0}};
    std::vector<Point> points;
    bowl.each_crossing(row, {}, [&](const Crossing& crossing) { points.push_back(row.at(crossing.t)); });
    for (std::size_t i = 0; i + 1 < points.size(); i += 2) sketch.line(points[i], points[i + 1], Paint::blue);
  }
  const Ray ray{.origin = {-1.9, 0.1, 0}, .direction = normalize(Vec3{1, -0.12, 0})};
  sketch.ray(ray, 3.7, Paint::ink, Stroke::bold);
  bowl.each_crossing(ray, {}, [&](const Crossing& crossing) {
    const Point p = ray.at(crossing.t);
    sketch.arrow(p, p + 0.36 * bowl.normal_at(p, crossing.primitive), Paint::green, Stroke::bold);
    sketch.mark(p, Paint::red);
  });
  drawing.words({320, 336}, "green: normals, always out of what is left", Anchor::middle, Paint::green);
}

void instance(Drawing& drawing) {
  const Affine placement = Affine{}.scaled_by({1.5, 0.75, 1}).rotated_about({0, 0, 1}, 25);
  const Instance image(Sphere{}, placement);
  const AffineInverse inverse(placement);
  const Ray ray{.origin = {-1.75, -0.55, 0}, .direction = {1, 0.45, 0}};
  const Ray own{.origin = inverse.point(ray.origin), .direction = inverse.vector(ray.direction)};
  const double t = image.intersect(ray).value();
  expect(std::abs(t - Sphere{}.intersect(own).value()) < 1e-12, "instance");
  const auto draw = [&](double middle, const auto& surface, const Ray& line, const char* title) {
    const Sketch sketch(drawing, {middle, 160}, 78);
    drawing.words({middle, 24}, title, Anchor::middle, Paint::ink, true);
    std::vector<Point> outline;
    for (int i = 0; i < 60; ++i) {
      const Ray inwards{.origin = 4.0 * at_angle(6 * i), .direction = -at_angle(6 * i)};
      outline.push_back(inwards.at(surface.intersect(inwards).value()));
    }
    sketch.polygon(outline, Paint::gray);
    sketch.ray(line, 3.4, Paint::blue, Stroke::bold);
    for (int i = 0; i <= 3; ++i) {
      sketch.mark(line.at(i), Paint::blue);
      sketch.words(line.at(i), {-4, -12}, std::to_string(i), Paint::blue, Anchor::middle);
    }
    sketch.mark(line.at(t), Paint::red);
    sketch.words(line.at(t), {8, 26}, joined({"t = ", text_of(t)}), Paint::red);
  };
  draw(160, image, ray, "the scene");
  draw(490, Sphere{}, own, "object space");
  drawing.words({320, 300}, "the points at t = 0, 1, 2, 3: every t is the same in both", Anchor::middle);
}

/// Direction with a name, to be found in a map of all directions.
struct Direction {
  Vec3 along;
  const char* name;
  Paint paint;
};
const Direction directions[] = {{{0, 0, 1}, "ahead", Paint::red},
                                {{1, 0, 0}, "right", Paint::blue},
                                {{-1, 0, 0}, "left", Paint::green},
                                {{0, 1, 0}, "up", Paint::ink}};

void environment_map(Drawing& drawing) {
  const Sketch sketch(drawing, {130, 172}, 88, Camera::look_at({1.3, 1.1, -3}, Point{0}));
  sketch.circle(Point{0}, 1, Paint::gray);
  draw_circle(sketch, Point{0}, 1, {1, 0, 0}, {0, 0, 1}, Paint::gray);
  constexpr double left = 268, top = 76, width = 360, height = 180;
  constexpr int columns = 24, rows = 12;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double u = (x + 0.5) / columns, v = (y + 0.5) / rows;
      drawing.swatch({left + width * x / columns, top + height * y / rows}, width / columns, height / rows,
                     shown_color(dusk(u, v)));
    }
  drawing.rectangle({left, top}, width, height, Paint::gray, Fill::none);
  for (const auto& [along, name, paint] : directions) {
    sketch.arrow(Point{0}, 1.1 * along, paint, Stroke::bold);
    sketch.words(1.2 * along, {0, along.y > 0 ? -6.0 : 16.0}, name, paint, Anchor::middle);
    const Uv uv = direction_uv(along);
    const Place place{left + width * uv.x, top + height * uv.y};
    drawing.circle(place, 7, Paint::ink, Fill::full);
    drawing.circle(place, 5, paint, Fill::full);
    drawing.words({place.x, place.y - 12}, name, Anchor::middle, paint);
  }
  drawing.arrow({left, top + height + 22}, {left + width, top + height + 22}, Paint::ink);
  drawing.words({left + width / 2, top + height + 46}, "u from 0 to 1; v downwards", Anchor::middle);
  drawing.words({left + width / 2, 24}, "as a picture", Anchor::middle, Paint::ink, true);
  drawing.words({130, 24}, "directions", Anchor::middle, Paint::ink, true);
}

void sphere_uv(Drawing& drawing) {
  const Sphere sphere{};
  const Camera camera = Camera::look_at({0.9, 1.5, -3}, Point{0});
  const Sketch sketch(drawing, {160, 176}, 120, camera);
  sketch.circle(Point{0}, 1, Paint::gray);
  constexpr double left = 352, top = 110, width = 260, height = width / 2;
  drawing.rectangle({left, top}, width, height, Paint::gray, Fill::soft);
  // The points of the sphere that the camera sees, on lines of equal u and of equal v.
  const auto point_at = [](double u, double v) {
    const Vec3 around = at_angle(360 * (u - 0.5)), down = at_angle(180 * v);
    return Point{down.y * around.y, down.x, down.y * around.x};
  };
  const auto draw = [&](const auto& at, Paint paint) {
    for (int i = 0; i < 48; ++i) {
      const Point a = at(i / 48.0), b = at((i + 1) / 48.0);
      if (dot(a + b, camera.forward) < 0) sketch.line(a, b, paint);
    }
  };
  for (int i = 0; i < 8; ++i) {
    draw([&](double v) { return point_at(i / 8.0, v); }, Paint::blue);
    drawing.line({left + width * i / 8, top}, {left + width * i / 8, top + height}, Paint::blue);
  }
  for (int i = 1; i < 6; ++i) {
    draw([&](double u) { return point_at(u, i / 6.0); }, Paint::green);
    drawing.line({left, top + height * i / 6}, {left + width, top + height * i / 6}, Paint::green);
  }
  const Ray ray{.origin = {0.1, 0.75, -3}, .direction = {0.1, -0.1, 1}};
  const Point p = ray.at(sphere.intersect(ray).value());
  const Uv uv = sphere.uv_at(p);
  expect(length(p - point_at(uv.x, uv.y)) < 1e-9, "sphere_uv");
  sketch.mark(p, Paint::red);
  drawing.mark({left + width * uv.x, top + height * uv.y}, Paint::red);
  drawing.words({left + width / 2, top + height + 30},
                joined({"u = ", text_of(uv.x), ", v = ", text_of(uv.y)}), Anchor::middle, Paint::red);
  drawing.words({left + width / 2, 24}, "u and v", Anchor::middle, Paint::ink, true);
  drawing.words({left + width / 2, 60}, "blue: equal u; green: equal v", Anchor::middle);
  drawing.words({160, 24}, "the sphere", Anchor::middle, Paint::ink, true);
}

}  // namespace

std::vector<StageFigure> geometry_figures() {
  return {
      {"checker_uv", "13_whitted", "A board with its coordinates u and v and the sums of its squares", 352,
       checker_uv},
      {"plane_crossing", "14_primitives", "A ray that crosses a plane, with the lengths of the formula", 334,
       plane_crossing},
      {"disk", "14_primitives", "A disk in its plane, a ray that hits it and one that does not", 340, disk},
      {"parallelogram", "14_primitives", "A parallelogram with the coordinates of two points", 330,
       parallelogram},
      {"triangle", "14_primitives", "A triangle, cut into three by a point, with the weights of its corners",
       330, triangle},
      {"box_slabs", "14_primitives", "Rays between the planes of a box, and their intervals", 384, box_slabs},
      {"quadric", "14_primitives", "Rays through a paraboloid and through a cylinder", 372, quadric},
      {"csg_intervals", "15_csg",
       "A ray through two spheres and the intervals of their union, intersection and difference", 440,
       csg_intervals},
      {"csg_bowl", "15_csg", "A bowl, cut open, with its normals along a ray", 352, csg_bowl},
      {"instance", "15_csg", "A ray and an ellipsoid, and both in the space of the sphere", 316, instance},
      {"environment_map", "16_environment", "Four directions, and their places on a picture of the sky", 322,
       environment_map},
      {"sphere_uv", "16_environment", "Lines of longitude and latitude on a sphere and on its map", 326,
       sphere_uv},
  };
}

}  // namespace figures
