// Figures of the stage 17: triangles, meshes and trees of boxes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

void edge_sides(Drawing& drawing) {
  const Point a{0, 0, 0}, b{0.4, 2, 0}, c{2.4, 0.5, 0};
  double left = 26;
  for (const auto& [p, title] :
       {std::pair{Point{0.9, 0.85, 0}, "inside"}, {Point{1.75, 1.4, 0}, "outside"}}) {
    const Sketch sketch(drawing, {left, 262}, 94);
    const ExactLine line = exact_line(p - Vec3{0, 0, 1}, Vec3{0, 0, 1});
    drawing.words({left + 120, 24}, title, Anchor::middle, Paint::ink, true);
    sketch.polygon({a, b, c}, Paint::gray);
    int sum = 0;
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
      const int side = detail::side_of_edge(line, from, to);
      const Paint paint = side > 0 ? Paint::green : Paint::red;
      sum += side;
      sketch.arrow(from, to, paint, Stroke::bold);
      const Vec3 along = to - from, out = normalize(Vec3{-along.y, along.x, 0});
      sketch.words(0.5 * (from + to) + 0.22 * out, {0, 6}, side > 0 ? "+" : "−", paint, Anchor::middle);
    }
    const bool is_hit = Triangle{a, b, c}.intersect(Ray{.origin = p - Vec3{0, 0, 1}}).has_value();
    expect(is_hit == (std::abs(sum) == 3), "edge_sides");
    sketch.mark(p, is_hit ? Paint::green : Paint::red);
    sketch.words(a, {0, 24}, "p₀", Paint::ink, Anchor::middle);
    sketch.words(b, {0, -8}, "p₁", Paint::ink, Anchor::middle);
    sketch.words(c, {10, 8}, "p₂");
    drawing.words({left + 130, 322}, is_hit ? "one sign: a hit" : "two signs: a miss", Anchor::middle,
                  is_hit ? Paint::green : Paint::red);
    left += 330;
  }
}

void shared_edge(Drawing& drawing) {
  const Triangle lower{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}}, upper{{0, 0, 0}, {4, 3, 0}, {0, 3, 0}};
  const Sketch sketch(drawing, {150, 306}, 86);
  sketch.polygon({lower.a, lower.b, lower.c}, Paint::blue);
  sketch.polygon({upper.a, upper.b, upper.c}, Paint::orange);
  int on_edge = 0;
  for (int i = 1; i < 8; ++i)
    for (int k = 1; k < 8; ++k) {
      // A grid on which some rays meet the edge exactly.
      const Ray ray{.origin = {0.5 * i, 0.375 * k, -1}, .direction = {0, 0, 1}};
      const bool in_lower = lower.intersect(ray).has_value(), in_upper = upper.intersect(ray).has_value();
      expect(in_lower != in_upper, "shared_edge");
      on_edge += i == k ? 1 : 0;
      sketch.mark(ray.at(1), in_lower ? Paint::blue : Paint::orange, i == k ? Fill::full : Fill::none);
    }
  drawing.words({324, 340},
                std::to_string(on_edge) + " rays through the edge itself: each hits one triangle only",
                Anchor::middle);
}

void vertex_normals(Drawing& drawing) {
  MeshData data;
  for (int i = 0; i <= 4; ++i) {
    const Vec3 n = at_angle(150 - 30 * i);
    for (const double z : {-1.0, 1.0}) {
      data.vertices.push_back(1.5 * n + Vec3{0, 0, z});
      data.normals.push_back(n);
    }
    if (i == 4) break;
    const auto first = static_cast<std::uint32_t>(2 * i);
    data.triangles.push_back({first, first + 1, first + 2});
    data.triangles.push_back({first + 2, first + 1, first + 3});
  }
  MeshData flat = data;
  flat.normals.clear();
  const Vec3 to_light = normalize(Vec3{-0.5, 1, 0});
  for (const bool is_smooth : {false, true}) {
    const double middle = is_smooth ? 480 : 160;
    const Mesh mesh(is_smooth ? data : flat, {.threads = 1});
    const Sketch sketch(drawing, {middle, 246}, 94);
    drawing.words({middle, 24}, is_smooth ? "vertex normals" : "flat triangles", Anchor::middle, Paint::ink,
                  true);
    for (std::size_t i = 0; i + 2 < data.vertices.size(); i += 2)
      sketch.line({data.vertices[i].x, data.vertices[i].y, 0},
                  {data.vertices[i + 2].x, data.vertices[i + 2].y, 0}, Paint::ink, Stroke::bold);
    constexpr int steps = 40;
    for (int i = 0; i < steps; ++i) {
      const Ray down{.origin = {2.56 * (i + 0.5) / steps - 1.28, 3, 0.1}, .direction = {0, -1, 0}};
      const auto hit = mesh.first_crossing(down, {}).value();
      const Point p = down.at(hit.t);
      Vec3 n = mesh.normal_at(p, hit.primitive);
      if (n.y < 0) n = -n;
      const Place place = sketch.of({p.x, 0, 0});
      drawing.swatch({place.x - 3.5, 268}, 7, 40,
                     shown_color(Color{static_cast<float>(std::max(dot(n, to_light), 0.0))}));
      if (i % 4 == 1) sketch.arrow({p.x, p.y, 0}, Point{p.x, p.y, 0} + 0.55 * n, Paint::green);
    }
    drawing.rectangle({middle - 124, 268}, 248, 40, Paint::gray, Fill::none);
    drawing.words({middle, 336}, is_smooth ? "no steps; the corners remain" : "a step at every edge",
                  Anchor::middle);
  }
}

/// Node of a tree of boxes over triangles: a leaf of at most two, or two halves.
struct BoxTree {
  Box box{Point{infinity}, Point{-infinity}};
  std::vector<Triangle> triangles;  ///< of a leaf
  std::vector<BoxTree> halves;

  explicit BoxTree(std::vector<Triangle> all) {
    for (const Triangle& triangle : all)
      box = {min(box.min, triangle.bounds().min), max(box.max, triangle.bounds().max)};
    if (all.size() <= 2) {
      triangles = std::move(all);
      return;
    }
    const int axis = box.max.x - box.min.x > box.max.y - box.min.y ? 0 : 1;
    std::sort(all.begin(), all.end(), [&](const Triangle& a, const Triangle& b) {
      return a.bounds().min[axis] + a.bounds().max[axis] < b.bounds().min[axis] + b.bounds().max[axis];
    });
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    halves.emplace_back(std::vector<Triangle>(all.begin(), middle));
    halves.emplace_back(std::vector<Triangle>(middle, all.end()));
  }
};

/// Draws a tree of boxes as a ray visits it. Returns the number of triangles that it tests.
int draw_visits(Drawing& drawing, const Sketch& sketch, const BoxTree& tree, const Ray& ray) {
  const bool is_met = tree.box.intersect(ray).has_value();
  const Vec3 size = tree.box.max - tree.box.min;
  const Place corner = sketch.of({tree.box.min.x, tree.box.max.y, 0}),
              end = sketch.of({tree.box.max.x, tree.box.min.y, 0});
  expect(size.x > 0, "bvh");
  drawing.rectangle({corner.x - 3, corner.y - 3}, end.x - corner.x + 6, end.y - corner.y + 6,
                    is_met ? Paint::red : Paint::gray, Fill::none);
  int tests = 0;
  for (const Triangle& t : tree.triangles) {
    sketch.polygon({t.a, t.b, t.c}, is_met ? Paint::blue : Paint::gray);
    tests += is_met ? 1 : 0;
  }
  for (const BoxTree& half : tree.halves) {
    if (is_met) {
      tests += draw_visits(drawing, sketch, half, ray);
      continue;
    }
    // What is in a box that the ray misses is not visited: only its triangles are drawn.
    std::vector<const BoxTree*> rest{&half};
    while (!rest.empty()) {
      const BoxTree& skipped = *rest.back();
      rest.pop_back();
      for (const Triangle& t : skipped.triangles) sketch.polygon({t.a, t.b, t.c}, Paint::gray);
      for (const BoxTree& below : skipped.halves) rest.push_back(&below);
    }
  }
  return tests;
}

void bvh(Drawing& drawing) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < 12; ++i) {
    // Places that look irregular.
    const Point p{0.3 + 0.86 * (i % 6) + 0.13 * (i * i % 3), 0.35 + 1.35 * (i / 6) + 0.14 * (i * 5 % 4), 0};
    const double turn = 77.0 * i;
    triangles.push_back({p + 0.33 * at_angle(turn), p + 0.33 * at_angle(turn + 110),
                         p + 0.33 * at_angle(turn + 230) + Vec3{0, 0, 1e-3}});
  }
  const BoxTree tree(triangles);
  const Sketch sketch(drawing, {70, 286}, 100);
  const Ray ray{.origin = {-0.45, 0.75, 0}, .direction = normalize(Vec3{1, 0.09, 0})};
  const int tests = draw_visits(drawing, sketch, tree, ray);
  sketch.ray(ray, 6, Paint::ink, Stroke::bold);
  drawing.words(
      {320, 346},
      joined({"the ray tests ", std::to_string(tests), " of 12 triangles (blue); gray boxes are skipped"}),
      Anchor::middle);
}

}  // namespace

std::vector<StageFigure> mesh_figures() {
  return {
      {"edge_sides", "17_mesh", "The signs of three edges for a point inside a triangle and one outside", 338,
       edge_sides},
      {"shared_edge", "17_mesh", "Two triangles with one edge, and rays on a grid", 356, shared_edge},
      {"vertex_normals", "17_mesh", "Normals and shades of flat triangles and of interpolated normals", 352,
       vertex_normals},
      {"bvh", "17_mesh", "Boxes around triangles, and those that a ray visits", 362, bvh},
  };
}

}  // namespace figures
