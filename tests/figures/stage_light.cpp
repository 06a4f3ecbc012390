// Figures of the stages 03 to 08: closest hits, depth, normals, colors, light and transparency.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"
#include "stages/naive.hpp"

using namespace protostar;

namespace figures {

namespace {

const Ray along_x{.origin = {0, 0, 0}, .direction = {1, 0, 0}};

void closest_hit(Drawing& drawing) {
  const std::vector<Sphere> spheres{{.center = {3.3, -0.35, 0}, .radius = 0.8},
                                    {.center = {2.0, 0.25, 0}, .radius = 0.6},
                                    {.center = {4.9, 0.2, 0}, .radius = 0.6},
                                    {.center = {0.9, 0.85, 0}, .radius = 0.5}};
  Scene<Sphere> scene;
  for (const Sphere& sphere : spheres) scene.add(sphere, Color{1});
  const auto hit = scene.intersect(along_x).value();
  const Sketch sketch(drawing, {36, 150}, 96);
  const std::vector<std::string> names{"S₁", "S₂", "S₃", "S₄"};
  sketch.eye(Point{0}, along_x.direction);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    sketch.circle(spheres[i].center, spheres[i].radius, Paint::gray);
    sketch.words(spheres[i].center, {0, spheres[i].center.y > 0 ? -14.0 : 26.0}, names[i], Paint::ink,
                 Anchor::middle);
  }
  sketch.arrow(Point{0}, along_x.at(6), Paint::gray);
  sketch.arrow(Point{0}, hit.point(), Paint::red, Stroke::bold);
  sketch.mark(hit.point(), Paint::red);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double y = -1.75 - 0.32 * static_cast<double>(i);
    const Roots roots = roots_of(spheres[i], along_x);
    sketch.words({0, y, 0}, {-24, 6}, names[i]);
    sketch.line({0, y, 0}, {5.9, y, 0}, Paint::gray, Stroke::dashed);
    if (roots.count() == 0) {
      sketch.words({0.9, y, 0}, {0, 6}, "no root", Paint::gray, Anchor::middle);
      continue;
    }
    sketch.line({roots[0], y, 0}, {roots[1], y, 0}, Paint::blue, Stroke::bold);
    for (const double t : roots) sketch.mark({t, y, 0}, t == hit.t ? Paint::red : Paint::blue);
  }
  sketch.line(hit.point(), {hit.t, -3, 0}, Paint::red, Stroke::dashed);
  sketch.arrow({0, -3, 0}, {6.1, -3, 0}, Paint::ink);
  sketch.words({6.1, -3, 0}, {0, 24}, "t", Paint::ink, Anchor::end);
  sketch.words({hit.t, -3, 0}, {0, 24}, "the smallest root: the closest hit", Paint::red, Anchor::middle);
}

void three_queries(Drawing& drawing) {
  Scene<Sphere> scene;
  const std::vector<Sphere> spheres{{.center = {1.7, 0, 0}, .radius = 0.5},
                                    {.center = {3.2, 0, 0}, .radius = 0.5}};
  for (const Sphere& sphere : spheres) scene.add(sphere, Color{1});
  double y = 70;
  for (const char* name : {"intersect", "occluded", "crossings"}) {
    const Sketch sketch(drawing, {16, y}, 84);
    const std::string query = name;
    for (const Sphere& sphere : spheres) sketch.circle(sphere.center, sphere.radius, Paint::gray);
    sketch.eye({0.2, 0, 0}, along_x.direction);
    sketch.arrow({0.2, 0, 0}, along_x.at(4.3), Paint::blue);
    if (query == "intersect") sketch.mark(scene.intersect(along_x).value().point(), Paint::red);
    if (query == "crossings")
      scene.crossings(along_x, {}, [&](const auto& hit) { sketch.mark(hit.point(), Paint::red); });
    drawing.words({390, y - 8}, query, Anchor::start, Paint::ink, true);
    drawing.words({390, y + 18},
                  query == "intersect"  ? "which is first?"
                  : query == "occluded" ? (scene.occluded(along_x) ? "is there any? yes" : "is there any? no")
                                        : "which are there at all?",
                  Anchor::start, query == "occluded" ? Paint::green : Paint::red);
    y += 104;
  }
}

void depth_curve(Drawing& drawing) {
  const auto scene = three_spheres();
  const Camera camera;
  const Sketch sketch(drawing, {60, 290}, 84);
  constexpr double high = 2.2;  // units of the drawing to a light of 1
  sketch.arrow({0, 0, 0}, {6.6, 0, 0}, Paint::ink);
  sketch.arrow({0, 0, 0}, {0, 3.25, 0}, Paint::ink);
  sketch.words({6.6, 0, 0}, {0, 24}, "t", Paint::ink, Anchor::end);
  sketch.words({0, 3.25, 0}, {12, 8}, "L = 1/t");
  const auto at = [&](double t) { return Point{t, high / t, 0}; };
  sketch.curve(at, 0.8, 1, Paint::red, Stroke::dashed);
  sketch.curve(at, 1, 6.4, Paint::blue, Stroke::bold);
  sketch.line({0, high, 0}, {1, high, 0}, Paint::red, Stroke::bold);
  sketch.line({1, high, 0}, {6.4, high, 0}, Paint::gray, Stroke::dashed);
  sketch.words({1.1, high, 0}, {4, -10}, "nearer than 1: the file holds white", Paint::red);
  for (int t = 1; t <= 6; ++t)
    sketch.words({t + 0.0, 0, 0}, {0, 24}, std::to_string(t), Paint::ink, Anchor::middle);
  sketch.words({0, high, 0}, {-10, 6}, "1", Paint::ink, Anchor::end);
  for (const auto& [u, v, name] : {std::tuple{0.0, 0.0, "orange sphere"}, {-0.4, 0.0, "green sphere"}}) {
    const Ray ray = camera(u, v);
    const double t = scene.intersect(ray).value().t, light = DepthIntegrator{}.radiance(ray, scene).r;
    expect(std::abs(light * t - 1) < 1e-6, "depth_curve");
    sketch.line({t, 0, 0}, {t, high * light, 0}, Paint::gray, Stroke::dashed);
    sketch.mark({t, high * light, 0}, Paint::blue);
    sketch.words({t, high * light, 0}, {10, -8}, name + std::string(": ") + text_of(light), Paint::blue);
  }
}

void depth_plane(Drawing& drawing) {
  const Plane wall{.normal = {1, 0, 0}, .distance = 3};
  const Sketch sketch(drawing, {70, 190}, 110);
  sketch.line({3, 1.5, 0}, {3, -1.5, 0}, Paint::ink, Stroke::bold);
  sketch.words({3, 0.7, 0}, {14, 6}, "a wall");
  sketch.arrow(Point{0}, {2.94, 0, 0}, Paint::green, Stroke::bold);
  for (const double degrees : {25.0, -24.0}) {
    const Ray ray{.origin = {0, 0, 0}, .direction = at_angle(degrees)};
    const double t = wall.intersect(ray).value(), along = t * dot(ray.direction, Vec3{1, 0, 0});
    expect(std::abs(along - 3) < 1e-12, "depth_plane");
    sketch.ray(ray, t, Paint::blue, Stroke::bold);
    sketch.mark(ray.at(t), Paint::blue);
    sketch.words(ray.at(t), {14, 6}, joined({"t = ", text_of(t)}), Paint::blue);
  }
  const double t = wall.intersect(along_x).value();
  sketch.mark(along_x.at(t), Paint::green);
  sketch.words(along_x.at(t), {14, 6}, joined({"t = ", text_of(t)}), Paint::green);
  sketch.words({1.9, 0, 0}, {-30, -10}, "forward: always 3", Paint::green, Anchor::middle);
  sketch.curve([&](double degrees) { return t * at_angle(degrees); }, -30, 30, Paint::gray, Stroke::dashed);
  sketch.words(t * at_angle(-29), {-14, 6}, "distance 3", Paint::gray, Anchor::end);
  sketch.eye(Point{0}, {1, 0, 0});
}

void sphere_normals(Drawing& drawing) {
  const Sphere sphere{.center = {0, 0, 0}, .radius = 1.5};
  const Sketch sketch(drawing, {230, 200}, 68);
  sketch.circle(sphere.center, sphere.radius, Paint::gray);
  for (int i = 0; i < 12; ++i) {
    const Ray ray{.origin = 4.0 * at_angle(30 * i), .direction = -at_angle(30 * i)};
    const Point p = ray.at(sphere.intersect(ray).value());
    sketch.arrow(p, p + sphere.normal_at(p), Paint::green, i == 1 ? Stroke::bold : Stroke::thin);
    if (i != 1) continue;
    sketch.arrow(sphere.center, p, Paint::blue, Stroke::bold);
    sketch.mark(p, Paint::red);
    sketch.words(sphere.center, {0, 34}, "p − c: length R", Paint::blue, Anchor::middle);
    sketch.words(p, {-2, 26}, "p", Paint::red);
    sketch.words(p + sphere.normal_at(p), {8, 0}, "n = (p − c)/R, length 1", Paint::green);
  }
  sketch.mark(sphere.center, Paint::ink);
  sketch.words(sphere.center, {-10, -8}, "c", Paint::ink, Anchor::end);
}

void normal_colors(Drawing& drawing) {
  Scene<Sphere> scene;
  scene.add(Sphere{}, Color{1});
  const Camera camera = Camera::orthographic({0, 0, -3}, {0, 0, 1}, {0, 1, 0}, 2);
  const Sketch sketch(drawing, {210, 176}, 140);
  sketch.circle(Point{0}, 1, Paint::gray, Fill::none);
  const auto color_at = [&](double x, double y) {
    return shown_color(NormalIntegrator{}.radiance(camera(x, y), scene));
  };
  for (const double radius : {0.0, 0.34, 0.67, 0.97})
    for (int i = 0; i < (radius == 0 ? 1 : 12); ++i) {
      const Vec3 p = radius * at_angle(30 * i);
      const Place place = sketch.of(p);
      drawing.swatch({place.x - 13, place.y - 13}, 26, 26, color_at(p.x, p.y));
    }
  double y = 60;
  for (const auto& [p, name] : {std::pair{0.97 * at_angle(0), "to the right: red"},
                                {0.97 * at_angle(90), "up: green"},
                                {Vec3{0, 0, 0}, "to the camera: no blue"},
                                {0.97 * at_angle(210), "left and down: blue"}}) {
    drawing.swatch({400, y - 18}, 24, 24, color_at(p.x, p.y));
    drawing.words({436, y}, name);
    const Vec3 n = scene.intersect(camera(p.x, p.y)).value().normal();
    drawing.words({436, y + 24},
                  joined({"(", text_of(n.x, 1), ", ", text_of(n.y, 1), ", ", text_of(n.z, 1), ")"}),
                  Anchor::start, Paint::gray);
    y += 70;
  }
}

void color_profile(Drawing& drawing) {
  const auto scene = three_spheres();
  const Camera camera;
  constexpr int count = 48;
  constexpr double left = 32, size = 12;
  double top = 62;
  for (const bool is_lit : {false, true}) {
    drawing.words({left, top - 10}, is_lit ? "with a light (stage 07)" : "the color alone");
    std::vector<Place> red;
    for (int i = 0; i < count; ++i) {
      const Ray ray = camera(0.9 * (2 * (i + 0.5) / count - 1), 0.1);
      const Color light =
          is_lit ? DiffuseIntegrator{}.radiance(ray, scene) : ColorIntegrator{}.radiance(ray, scene);
      drawing.swatch({left + size * i, top}, size, 34, shown_color(light));
      red.push_back({left + size * (i + 0.5), 320 - 70.0 * std::min(light.r, 1.5f)});
    }
    drawing.rectangle({left, top}, count * size, 34, Paint::gray, Fill::none);
    drawing.polyline(red, is_lit ? Paint::orange : Paint::blue, Stroke::bold);
    top += 84;
  }
  drawing.line({left, 320}, {left + count * size, 320}, Paint::ink);
  drawing.words({left, 238}, "red light", Anchor::start);
  drawing.words({446, 238}, "blue: the color", Anchor::start, Paint::blue);
  drawing.words({446, 262}, "orange: lit", Anchor::start, Paint::orange);
  drawing.words({320, 346}, "along one row of pixels", Anchor::middle);
}

void space_checkers(Drawing& drawing) {
  const Sphere sphere{.center = {0.3, 0.1, 0}, .radius = 1.7};
  const Sketch sketch(drawing, {320, 190}, 68);
  const auto is_even = [](const Point& p) {
    const double sum = std::floor(p.x) + std::floor(p.y);
    return sum == 2 * std::floor(sum / 2);
  };
  for (int x = -4; x < 4; ++x)
    for (int y = -2; y < 2; ++y)
      if (is_even({x + 0.5, y + 0.5, 0}))
        sketch.polygon(
            {{x + 0.0, y + 0.0, 0}, {x + 1.0, y + 0.0, 0}, {x + 1.0, y + 1.0, 0}, {x + 0.0, y + 1.0, 0}},
            Paint::gray);
  for (int i = 0; i < 180; ++i) {
    const Ray ray{.origin = sphere.center + 3.0 * at_angle(2 * i + 1), .direction = -at_angle(2 * i + 1)};
    const Point middle = ray.at(sphere.intersect(ray).value());
    sketch.line(sphere.center + 1.7 * at_angle(2 * i), sphere.center + 1.7 * at_angle(2 * i + 2),
                is_even(middle) ? Paint::orange : Paint::blue, Stroke::bold);
  }
  drawing.words({320, 366}, "the outline takes the color of the cube that it is in", Anchor::middle);
}

void lambert(Drawing& drawing) {
  double middle = 160;
  for (const double degrees : {0.0, 60.0}) {
    const Sketch sketch(drawing, {middle, 226}, 66);
    const Vec3 normal = at_angle(90 + degrees);
    const Plane plane{.normal = normal, .distance = 0};
    std::vector<Point> ends;
    for (int i = 0; i < 5; ++i) {
      const Ray ray{.origin = {0.5 * i - 1, 2.7, 0}, .direction = {0, -1, 0}};
      const Point hit = ray.at(plane.intersect(ray).value());
      sketch.arrow(ray.origin, hit, Paint::orange);
      ends.push_back(hit);
    }
    const Vec3 along = normalize(ends.back() - ends.front());
    sketch.line(-2.3 * along, 2.3 * along, Paint::ink);
    sketch.line(ends.front(), ends.back(), Paint::red, Stroke::bold);
    sketch.arrow(Point{0}, 1.3 * normal, Paint::green, Stroke::bold);
    const Light sun = DirectionalLight{.direction = {0, 1, 0}, .intensity = Color{1}};
    const double share = sun.irradiance(Point{0}, plane.normal_at(Point{0})).r;
    if (degrees > 0) {
      sketch.line(Point{0}, {0, 1.3, 0}, Paint::gray, Stroke::dashed);
      sketch.angle(Point{0}, 0.6, {0, 1, 0}, normal, Paint::ink);
      sketch.words({-0.33, 0.74, 0}, {-2, 0}, "θ", Paint::ink, Anchor::middle);
    }
    sketch.words(1.3 * normal, {-12, 6}, "n", Paint::green, Anchor::end);
    drawing.words({middle, 24}, degrees > 0 ? "at θ = 60°" : "straight down", Anchor::middle, Paint::ink,
                  true);
    drawing.words({middle, 366}, joined({"area ", text_of(length(ends.back() - ends.front()) / 2, 1)}),
                  Anchor::middle, Paint::red);
    drawing.words({middle, 392}, joined({"light per area ", text_of(share, 1)}), Anchor::middle,
                  Paint::orange);
    middle += 320;
  }
}

void inverse_square(Drawing& drawing) {
  const Sketch sketch(drawing, {64, 250}, 124, Camera::look_at({4, 0.9, -2.6}, {0, 0, 0.3}));
  const Light lamp = PointLight{.position = Point{0}, .power = Color{4 * std::numbers::pi_v<float>}};
  const auto corner = [](double distance, double x, double y) {
    return distance * Point{0.32 * x, 0.32 * y, 1.3};
  };
  for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
    sketch.line(Point{0}, corner(3, x, y), Paint::orange);
  for (int distance = 3; distance >= 1; --distance) {
    const double d = distance;
    sketch.polygon({corner(d, -1, -1), corner(d, 1, -1), corner(d, 1, 1), corner(d, -1, 1)}, Paint::orange);
    for (int i = 1; i < distance; ++i) {
      const double share = 2.0 * i / d - 1;
      sketch.line(corner(d, share, -1), corner(d, share, 1), Paint::orange);
      sketch.line(corner(d, -1, share), corner(d, 1, share), Paint::orange);
    }
    const double light = lamp.perpendicular_irradiance(Point{0, 0, d}).r;
    sketch.words(corner(d, 0, -1), {0, 40}, joined({"r = ", std::to_string(distance)}), Paint::ink,
                 Anchor::middle);
    const int parts = distance * distance;
    expect(std::abs(light * parts - 1) < 1e-6, "inverse_square");
    sketch.words(corner(d, -1, 1), {0, -8},
                 parts == 1 ? "all on 1" : joined({"1/", std::to_string(parts), " on each"}), Paint::orange,
                 Anchor::end);
  }
  sketch.lamp(Point{0});
}

void facing_normal(Drawing& drawing) {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 0}, .radius = 1.2}, Color{1});
  for (const bool is_outside : {true, false}) {
    const Sketch sketch(drawing, {is_outside ? 190.0 : 490.0, 172}, 88);
    const Ray ray{.origin = is_outside ? Point{-1.9, 0.1, 0} : Point{0.6, 0, 0},
                  .direction = is_outside ? Vec3{1, 0.45, 0} : Vec3{-1, 0.45, 0}};
    const auto hit = scene.intersect(ray).value();
    const Point p = hit.point();
    expect((hit.normal() == hit.facing_normal()) == is_outside, "facing_normal");
    sketch.circle(Point{0}, 1.2, Paint::gray);
    sketch.ray(ray, hit.t, Paint::blue, Stroke::bold);
    sketch.eye(ray.origin, ray.direction);
    sketch.arrow(p, p + 0.75 * hit.normal(), Paint::green, is_outside ? Stroke::bold : Stroke::dashed);
    if (!is_outside) sketch.arrow(p, p + 0.75 * hit.facing_normal(), Paint::red, Stroke::bold);
    sketch.mark(p, Paint::ink);
    sketch.words(p + 0.75 * hit.normal(), {-4, -12}, "n", Paint::green, Anchor::middle);
    if (!is_outside)
      sketch.words(p - 0.75 * hit.normal(), {4, 24}, "facing normal", Paint::red, Anchor::middle);
    const double x = is_outside ? 160 : 480;
    drawing.words({x, 24}, is_outside ? "seen from outside" : "seen from inside", Anchor::middle, Paint::ink,
                  true);
    drawing.words({x, 312}, is_outside ? "n · d < 0: n faces you" : "n · d > 0: take −n", Anchor::middle,
                  is_outside ? Paint::green : Paint::red);
  }
}

void gamma(Drawing& drawing) {
  const Sketch sketch(drawing, {64, 284}, 240);
  sketch.arrow(Point{0}, {1.1, 0, 0}, Paint::ink);
  sketch.arrow(Point{0}, {0, 1.08, 0}, Paint::ink);
  const auto draw = [&](const auto& curve, Paint paint, Stroke stroke, const char* name, double y) {
    sketch.curve([&](double value) { return Point{decode(curve, value), value, 0}; }, 0, 1, paint, stroke);
    drawing.words({350, y}, name, Anchor::start, paint);
  };
  draw(Linear{}, Paint::gray, Stroke::bold, "linear: L", 60);
  draw(Gamma{}, Paint::blue, Stroke::bold, "gamma: L^(1/2.2)", 86);
  draw(Srgb{}, Paint::red, Stroke::dashed, "sRGB", 112);
  for (const double x : {0.0, 1.0})
    sketch.words({x, 0, 0}, {0, 24}, text_of(x, 0), Paint::ink, Anchor::middle);
  sketch.words({0, 1, 0}, {-10, 6}, "1", Paint::ink, Anchor::end);
  sketch.words({0.5, 0, 0}, {0, 24}, "light L", Paint::ink, Anchor::middle);
  sketch.words({0, 1.08, 0}, {10, 4}, "share of the largest code");
  drawing.words({350, 168}, "equal steps of light");
  drawing.words({350, 246}, "equal steps of codes");
  for (int i = 0; i < 10; ++i) {
    const double share = i / 9.0;
    drawing.swatch({350 + 27.0 * i, 178}, 27, 36, shown_color(Color{static_cast<float>(share)}));
    drawing.swatch({350 + 27.0 * i, 256}, 27, 36,
                   shown_color(Color{static_cast<float>(decode(Srgb{}, share))}));
  }
  for (const double y : {178.0, 256.0}) drawing.rectangle({350, y}, 270, 36, Paint::gray, Fill::none);
}

void sum_of_lights(Drawing& drawing) {
  const float power = 4 * std::numbers::pi_v<float>;
  const std::vector<Light> lights{PointLight{.position = {-1.7, 0.9, 0}, .power = Color{0.8f * power}},
                                  PointLight{.position = {1.5, 1.3, 0}, .power = Color{1.5f * power}}};
  const Sketch space(drawing, {320, 176}, 84), chart(drawing, {320, 340}, 84);
  space.line({-3.6, 0, 0}, {3.6, 0, 0}, Paint::ink, Stroke::bold);
  for (const Light& light : lights) {
    const Point lamp = light.towards(Point{0});
    for (const double x : {-0.5, 0.0, 0.5})
      space.line(lamp, {lamp.x + 1.2 * x, 0, 0}, Paint::gray, Stroke::dashed);
    space.lamp(lamp);
  }
  const auto sum_at = [&](double x) {
    double sum = 0;
    for (const Light& light : lights) sum += light.irradiance(Point{x, 0, 0}, Vec3{0, 1, 0}).r;
    return Point{x, sum, 0};
  };
  chart.curve(sum_at, -3.5, 3.5, Paint::red, Stroke::bold, 96);
  for (const Light& light : lights)
    chart.curve(
        [&](double x) {
          return Point{x, light.irradiance(Point{x, 0, 0}, Vec3{0, 1, 0}).r, 0};
        },
        -3.5, 3.5, Paint::orange, Stroke::dashed, 96);
  chart.line({-3.6, 0, 0}, {3.6, 0, 0}, Paint::ink);
  drawing.words({320, 234}, "sum", Anchor::middle, Paint::red);
  drawing.words({320, 366}, "E of each light and their sum, along the floor", Anchor::middle);
}

void color_product(Drawing& drawing) {
  Scene<Sphere> scene;
  const std::vector<std::pair<Sphere, Color>> glass{
      {{.center = {2.3, 0.1, 0}, .radius = 0.75}, {1, 0.5f, 0.15f}},
      {{.center = {4.4, -0.1, 0}, .radius = 0.75}, {0.45f, 0.85f, 0.4f}}};
  for (const auto& [sphere, color] : glass) scene.add(sphere, color);
  const Sketch sketch(drawing, {30, 120}, 92);
  for (const auto& [sphere, color] : glass)
    sketch.circle(sphere.center, sphere.radius, color.r > 0.5f ? Paint::orange : Paint::green);
  sketch.line(Point{0}, along_x.at(6.4), Paint::ink);
  sketch.eye(Point{0}, along_x.direction);
  std::vector<double> cuts{0.35};
  scene.crossings(along_x, {}, [&](const auto& hit) {
    cuts.push_back(hit.t);
    sketch.mark(hit.point(), Paint::red);
  });
  cuts.push_back(6.3);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    Color light{1};
    scene.crossings(along_x, {.min = (cuts[i] + cuts[i + 1]) / 2},
                    [&](const auto& hit) { light *= hit.color(); });
    if (i == 0) expect(light == TransparencyIntegrator{}.radiance(along_x, scene), "color_product");
    const Place from = sketch.of(along_x.at(cuts[i])), to = sketch.of(along_x.at(cuts[i + 1]));
    drawing.swatch({from.x, 216}, to.x - from.x, 40, shown_color(light));
    if (i > 0) drawing.line(from, {from.x, 216}, Paint::gray, Stroke::dashed);
  }
  drawing.rectangle({sketch.of(along_x.at(0.35)).x, 216}, 92 * 5.95, 40, Paint::gray, Fill::none);
  drawing.words({30, 284}, "what the eye gets");
  drawing.words({610, 284}, "white light from behind", Anchor::end);
  drawing.arrow({386, 278}, {210, 278}, Paint::ink);
  for (const auto& [sphere, color] : glass)
    sketch.words(sphere.center, {0, -78}, "· color²", color.r > 0.5f ? Paint::orange : Paint::green,
                 Anchor::middle);
}

void restart(Drawing& drawing) {
  const Sphere sphere{.center = {0, 0, 0}, .radius = 1};
  const Ray ray{.origin = {-2, 0.25, 0}, .direction = {1, 0, 0}};
  const Roots roots = roots_of(sphere, ray);
  double middle = 108;
  for (const auto& [offset, title] :
       {std::pair{-0.16, "starts before"}, {0.16, "starts behind"}, {0.0, "never restarted"}}) {
    const Sketch sketch(drawing, {middle, 156}, 62);
    sketch.circle(sphere.center, 1, Paint::gray);
    drawing.words({middle, 24}, title, Anchor::middle, Paint::ink, true);
    std::vector<double> found{roots[0]};
    const Ray again{.origin = ray.at(roots[0] + offset), .direction = ray.direction};
    if (offset == 0) {
      found.push_back(roots[1]);
      sketch.arrow(ray.at(0.35), ray.at(3.4), Paint::blue, Stroke::bold);
    } else {
      sketch.line(ray.at(0.35), ray.at(roots[0]), Paint::gray);
      for (const double t : roots_of(sphere, again))
        if (t > 0) found.push_back(t + roots[0] + offset);
      sketch.ray(again, 3.35 - roots[0], Paint::blue, Stroke::bold);
      sketch.mark(again.origin, Paint::ink, Fill::none);
    }
    for (const double t : found) sketch.mark(ray.at(t), Paint::red);
    drawing.words({middle, 256}, text_of(static_cast<double>(found.size()), 0) + " crossings", Anchor::middle,
                  found.size() == 2 ? Paint::green : Paint::red);
    middle += 212;
  }
  drawing.words({320, 288}, "in true size the step is some last digits of the point", Anchor::middle,
                Paint::gray);
}

void float_error(Drawing& drawing) {
  const naive::Sphere& ground = naive::spheres[2];
  const Camera camera;
  constexpr double unit = 60, zero = 170, left = 40;  // pixels to an error of 0.0001
  const auto y_of = [&](double error) { return zero - unit * error / 1e-4; };
  for (const double sign : {1.0, -1.0}) {
    drawing.line({left, y_of(sign * 1e-4)}, {620, y_of(sign * 1e-4)}, Paint::green, Stroke::dashed);
  }
  drawing.line({left, zero}, {620, zero}, Paint::ink);
  int outside = 0;
  for (int i = 0; i < 190; ++i) {
    // A ray of the stage enters the ground sphere, is started again, and leaves it on the other side.
    const naive::Ray ray(camera.through_pixel(320, 280 + i, 640, 480));
    const auto enters = ground.intersect(ray);
    if (!enters) continue;
    const naive::Vec point = ray.origin + *enters * ray.direction;
    const naive::Ray again(point - 1e-4f * (point - ground.center) / ground.radius, ray.direction);
    const auto leaves = ground.intersect(again);
    if (!leaves) continue;
    const Point exit(again.origin + *leaves * again.direction);
    const double error = length(exit - Point(ground.center)) - 1000.0;
    const bool is_off = std::abs(error) > 1e-4;
    outside += is_off ? 1 : 0;
    const double shown = std::min(std::max(y_of(error), 48.0), 300.0);
    drawing.circle({left + 3.05 * i + 3, shown}, 2.5, is_off ? Paint::red : Paint::blue, Fill::full);
  }
  drawing.words({left, y_of(1e-4) - 8}, "offset 0.0001", Anchor::start, Paint::green);
  drawing.words({left, 26}, "how far a computed exit is off the ground sphere");
  drawing.words({left, 332}, "rays near the horizon");
  drawing.words({620, 332}, "steep rays", Anchor::end);
  drawing.words({360, 332}, std::to_string(outside) + " off by more", Anchor::middle, Paint::red);
}

/// Writes a number digit by digit, those in red from the first on that is not in the exact one.
void write_digits(Drawing& drawing, double y, const std::string& name, double value, double exact) {
  char digits[32], right[32];
  std::snprintf(digits, sizeof digits, "%16.6f", value);
  std::snprintf(right, sizeof right, "%16.6f", exact);
  drawing.words({170, y}, name, Anchor::end);
  bool is_right = true;
  for (int i = 0; i < 16; ++i) {
    is_right = is_right && digits[i] == right[i];
    drawing.words({200 + 20.0 * i, y}, digits[i] == '-' ? "−" : std::string(1, digits[i]), Anchor::middle,
                  is_right ? Paint::ink : Paint::red);
  }
}

void cancellation(Drawing& drawing) {
  const naive::Sphere& ground = naive::spheres[2];
  // The first ray that starts again at its hit on the ground and meets the ground there once more, with the
  // formulas of naive::Sphere::intersect: in float, and in double from the same floats.
  naive::Ray ray(Camera{}.through_pixel(320, 300, 640, 480));
  for (int row = 300; row < 480; ++row) {
    ray = naive::Ray(Camera{}.through_pixel(320, row, 640, 480));
    ray.origin += ground.intersect(ray).value() * ray.direction;
    const naive::Vec away = ray.origin - ground.center;
    if (ground.intersect(ray).value_or(1) < 0.1f && dot(Vec3(away), Vec3(away)) >= 1e6) break;
  }
  const naive::Vec l = ground.center - ray.origin;
  const float b = dot(ray.direction, l), ll = dot(l, l), RR = ground.radius * ground.radius, c = ll - RR;
  const Vec3 exact_l(l);
  const double exact_b = dot(Vec3(ray.direction), exact_l), exact_ll = dot(exact_l, exact_l);
  const double exact_c = exact_ll - 1e6, exact_root = std::sqrt(exact_b * exact_b - exact_c);
  const float root = std::sqrt(b * b - c);
  drawing.words({320, 26}, "A ray from a computed hit on the ground, in float", Anchor::middle, Paint::ink,
                true);
  write_digits(drawing, 66, "|c − o|²", ll, exact_ll);
  write_digits(drawing, 92, "− R²", RR, 1e6);
  drawing.line({60, 102}, {530, 102}, Paint::gray);
  write_digits(drawing, 124, "C", c, exact_c);
  write_digits(drawing, 170, "B", b, exact_b);
  write_digits(drawing, 196, "− √D", root, exact_root);
  drawing.line({60, 206}, {530, 206}, Paint::gray);
  write_digits(drawing, 228, "t", b - root, exact_b - exact_root);
  write_digits(drawing, 266, "t, exact", exact_b - exact_root, exact_b - exact_root);
  drawing.words({320, 300}, "red: from the first wrong digit on", Anchor::middle, Paint::red);
}

}  // namespace

std::vector<StageFigure> light_figures() {
  return {
      {"closest_hit", "03_scene", "A ray through spheres, and their roots on an axis of t", 466, closest_hit},
      {"three_queries", "03_scene", "One ray and two spheres: the answers of the three queries", 336,
       three_queries},
      {"depth_curve", "04_depth", "The curve 1/t, cut at 1, with two spheres on it", 330, depth_curve},
      {"depth_plane", "04_depth", "A wall with points at different distances and one depth", 380,
       depth_plane},
      {"sphere_normals", "05_normal", "A sphere with its normals, and one as the difference of two points",
       392, sphere_normals},
      {"normal_colors", "05_normal", "The colors of a sphere's normals", 346, normal_colors},
      {"color_profile", "06_color", "A row of pixels in flat colors and lit", 360, color_profile},
      {"space_checkers", "06_color", "Squares in space, cut by a circle", 384, space_checkers},
      {"lambert", "07_diffuse", "Equal beams of light on a level and on a tilted surface", 408, lambert},
      {"inverse_square", "07_diffuse", "Light of a lamp on one, four and nine squares", 400, inverse_square},
      {"facing_normal", "07_diffuse", "A sphere's normal seen from outside and from inside", 328,
       facing_normal},
      {"sum_of_lights", "07_diffuse", "Two lamps over a floor and the light that they bring to it", 382,
       sum_of_lights},
      {"gamma", "07_diffuse", "Curves from light to codes, with steps of gray", 322, gamma},
      {"color_product", "08_transparency",
       "A ray through two balls of colored glass, and its color between them", 300, color_product},
      {"restart", "08_transparency", "A ray that is started again before, behind and not at all", 304,
       restart},
      {"cancellation", "08_naive", "The numbers of a root in float, with their wrong digits", 316,
       cancellation},
      {"float_error", "08_naive", "Errors of hits in float, some larger than the offset", 348, float_error},
  };
}

}  // namespace figures
