// Figures of the stages 09 to 13: shadows, highlights, mirrors, glass and trees of rays.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <protostar/image.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/tone.hpp>
#include <string>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"
#include "stages/naive.hpp"

using namespace protostar;

namespace figures {

namespace {

const Plane ground{.normal = {0, 1, 0}, .distance = 0};
const Vec3 upwards{0, 1, 0};

void shadow_ray(Drawing& drawing) {
  Scene<Sphere, Plane> scene;
  const Sphere between{.center = {1.15, 0.95, 0}, .radius = 0.42},
      beyond{.center = {-2.55, 2.8, 0}, .radius = 0.4};
  for (const Sphere& sphere : {between, beyond}) scene.add(sphere, Color{1});
  scene.add(ground, Color{1});
  for (const Point& lamp : {Point{-1.9, 2.1, 0}, Point{2.4, 1.95, 0}})
    scene.add(PointLight{.position = lamp, .power = Color{1}});
  const Sketch sketch(drawing, {320, 330}, 100);
  const Ray from_camera{.origin = {-2.7, 1.2, 0}, .direction = {2.7, -1.2, 0}};
  const auto hit = scene.intersect(from_camera).value();
  sketch.line({-3.1, 0, 0}, {3.1, 0, 0}, Paint::ink, Stroke::bold);
  for (const Sphere& sphere : {between, beyond}) sketch.circle(sphere.center, sphere.radius, Paint::ink);
  sketch.ray(from_camera, hit.t, Paint::blue);
  sketch.eye(from_camera.origin, from_camera.direction);
  for (const Light& light : scene.lights()) {
    const Ray ray = hit.leave(light.towards(hit.point()));
    const bool is_hidden = scene.occluded(ray, light.occlusion_range());
    sketch.line(ray.origin, ray.at(1), is_hidden ? Paint::red : Paint::green, Stroke::bold);
    sketch.lamp(ray.at(1));
    sketch.words(ray.at(1), is_hidden ? Place{-16, -22} : Place{18, 4}, "t = 1", Paint::orange,
                 is_hidden ? Anchor::end : Anchor::start);
    if (!is_hidden) {
      expect(scene.occluded(ray), "shadow_ray");
      sketch.line(ray.at(1), ray.at(1.6), Paint::gray, Stroke::dashed);
      sketch.words(ray.at(0.72), {-14, 6}, "V = 1: no root", Paint::green, Anchor::end);
      continue;
    }
    for (const double t : roots_of(between, ray)) sketch.mark(ray.at(t), Paint::red);
    sketch.words(between.center, {52, 22}, "V = 0: a root", Paint::red);
    sketch.words(between.center, {52, 44}, "in 0 < t < 1", Paint::red);
  }
  sketch.mark(hit.point(), Paint::ink);
  sketch.words(hit.point(), {0, 26}, "p, t = 0", Paint::ink, Anchor::middle);
  sketch.words(beyond.center, {54, -6}, "beyond the light: no shadow", Paint::gray);
}

void shadow_strip(Drawing& drawing) {
  Scene<Sphere, Plane> scene;
  const Sphere ball{.center = {0, 0.8, 0}, .radius = 0.5};
  scene.add(ball, Color{1});
  scene.add(ground, Color{1});
  for (const double x : {-0.8, 0.8}) scene.add(PointLight{.position = {x, 2.6, 0}, .power = Color{1}});
  const Sketch sketch(drawing, {320, 290}, 92);
  sketch.circle(ball.center, ball.radius, Paint::ink);
  const auto seen_at = [&](double x) {
    const Ray down{.origin = {x, 0.01, 0}, .direction = {0, -1, 0}};
    const auto hit = scene.intersect(down).value();
    int seen = 0;
    for (const Light& light : scene.lights())
      seen += scene.occluded(hit.leave(light.towards(hit.point())), light.occlusion_range()) ? 0 : 1;
    return seen;
  };
  constexpr int steps = 320;
  int last = -1;
  double from = -3.2;
  for (int i = 0; i <= steps; ++i) {
    const double x = -3.2 + 6.4 * (i + 0.5) / steps;
    const int seen = i < steps ? seen_at(x) : -1;
    if (seen == last) continue;
    if (last >= 0) {
      const Place a = sketch.of({from, 0, 0}), b = sketch.of({x, 0, 0});
      const Paint paint = last == 0 ? Paint::gray : Paint::orange;
      drawing.rectangle({a.x, a.y}, b.x - a.x, 20, paint,
                        last == 2   ? Fill::full
                        : last == 1 ? Fill::soft
                                    : Fill::none);
      drawing.words({(a.x + b.x) / 2, a.y + 46},
                    last == 0   ? "none"
                    : last == 1 ? "one"
                                : "both",
                    Anchor::middle, paint);
      if (i < steps)
        for (const Light& light : scene.lights()) {
          // The lamp whose rays graze the ball here.
          const Ray ray{.origin = light.towards(Point{0}),
                        .direction = Point{x, 0, 0} - light.towards(Point{0})};
          const auto e = sphere_equation(ray, ball.center, ball.radius);
          if (std::abs(e.D) < 0.1) sketch.line(ray.origin, {x, 0, 0}, Paint::orange, Stroke::dashed);
        }
    }
    last = seen, from = x;
  }
  for (const Light& light : scene.lights()) sketch.lamp(light.towards(Point{0}));
  drawing.words({320, 364}, "how many lights each point of the floor sees", Anchor::middle);
}

void departure(Drawing& drawing) {
  Scene<Sphere> scene;
  const Sphere sphere{.center = {0, 0, 0}, .radius = 1.1};
  scene.add(sphere, Color{1});
  double middle = 160;
  for (const bool leads_out : {true, false}) {
    const Sketch sketch(drawing, {middle, 182}, 88);
    const auto hit = scene.intersect(Ray{.origin = {-2, 0.5, 0}, .direction = {1, 0, 0}}).value();
    const Ray ray = hit.leave(leads_out ? Vec3{-0.35, 1, 0} : Vec3{1, -0.35, 0});
    const Roots roots = roots_of(sphere, ray);
    expect(roots.count() == 1 && (roots[0] < 0) == leads_out && !scene.occluded(ray) == leads_out,
           "departure");
    sketch.circle(Point{0}, 1.1, Paint::gray);
    drawing.words({middle, 24}, leads_out ? "leads outwards" : "leads inwards", Anchor::middle, Paint::ink,
                  true);
    sketch.arrow({-1.75, 0.5, 0}, ray.origin, Paint::gray);
    sketch.ray(ray, leads_out ? 0.85 : 2.25, Paint::blue, Stroke::bold);
    if (leads_out) sketch.line(ray.origin, ray.at(roots[0]), Paint::gray, Stroke::dashed);
    sketch.mark(ray.at(roots[0]), leads_out ? Paint::gray : Paint::red, leads_out ? Fill::none : Fill::full);
    sketch.mark(ray.origin, Paint::ink);
    sketch.words(ray.origin, {12, leads_out ? 4.0 : -14.0}, "t = 0, divided out");
    sketch.words(ray.at(roots[0]), leads_out ? Place{12, -8} : Place{-14, -2},
                 joined({"2B/A = ", text_of(roots[0])}), leads_out ? Paint::gray : Paint::red,
                 leads_out ? Anchor::start : Anchor::end);
    drawing.words({middle, 316}, leads_out ? "its root is behind: no hit" : "its root is ahead: one hit",
                  Anchor::middle, leads_out ? Paint::green : Paint::red);
    middle += 320;
  }
}

void offsets(Drawing& drawing) {
  constexpr int width = 128, height = 96;
  const Camera camera;
  const auto scene = three_spheres();
  const Encoder encoder(Gamma{}, 255);
  const auto differs = [&](const Color& a, const Color& b) {  // as Stage::compare: by more than one level
    bool is_wrong = false;
    for (int c = 0; c < 3; ++c) is_wrong = is_wrong || std::abs(encoder(a[c]) - encoder(b[c])) > 1;
    return is_wrong;
  };
  drawing.words({320, 24}, "wrong pixels of 12,288, by the offset", Anchor::middle, Paint::ink, true);
  drawing.words({70, 56}, "transparency", Anchor::start, Paint::blue);
  drawing.words({200, 56}, "shadow", Anchor::start, Paint::orange);
  double x = 46;
  for (const auto& [offset, name] : {std::pair{0.0f, "0"},
                                     {1e-6f, "10⁻⁶"},
                                     {1e-5f, "10⁻⁵"},
                                     {1e-4f, "10⁻⁴"},
                                     {1e-3f, "10⁻³"},
                                     {1e-2f, "10⁻²"},
                                     {1e-1f, "0.1"}}) {
    int glass = 0, shadows = 0;
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        const Ray ray = camera.through_pixel(column, row, width, height);
        glass += differs(naive::transparency(naive::Ray(ray), offset),
                         TransparencyIntegrator{}.radiance(ray, scene))
                     ? 1
                     : 0;
        shadows +=
            differs(naive::shadow(naive::Ray(ray), offset), ShadowIntegrator{}.radiance(ray, scene)) ? 1 : 0;
      }
    double left = x;
    for (const auto& [wrong, paint] : {std::pair{glass, Paint::blue}, {shadows, Paint::orange}}) {
      const double high = 54 * std::log10(1.0 + wrong);
      drawing.rectangle({left, 300 - high}, 36, high, paint, Fill::soft);
      drawing.words({left + 18, 292 - high}, std::to_string(wrong), Anchor::middle, paint);
      left += 40;
    }
    drawing.words({x + 38, 326}, name, Anchor::middle);
    x += 83;
  }
  drawing.line({34, 300}, {630, 300}, Paint::ink);
}

/// Returns how many of the points that camera rays see get the wrong answer of a shadow ray in float, in the
/// scene of the stages, `scale` times as large, with the offset of the naive stage. `tested` counts them.
int wrong_shadows(float scale, int& tested) {
  constexpr float offset = 1e-4f;
  const Camera camera;
  auto spheres = naive::spheres;
  Scene<Sphere> scene;
  for (naive::Sphere& sphere : spheres) {
    sphere.center *= scale, sphere.radius *= scale;
    scene.add(Sphere{.center = Point(sphere.center), .radius = sphere.radius}, Color{1});
  }
  const naive::Vec lamp = scale * naive::Vec(light_of_the_three_spheres.position);
  int wrong = 0;
  tested = 0;
  for (int i = 0; i < 64 * 48; ++i) {
    const Ray ray = camera.through_pixel(i % 64, i / 64, 64, 48);
    const auto hit = scene.intersect(ray);
    if (!hit || dot(hit->facing_normal(), Point(lamp) - hit->point()) <= 0) continue;
    const naive::Vec point(hit->point()), to_lamp = lamp - point;
    const float distance = length(to_lamp);
    const naive::Ray shadow(point + offset * naive::Vec(hit->facing_normal()), to_lamp / distance);
    bool is_hidden = false;
    for (const naive::Sphere& sphere : spheres) {
      const auto t = sphere.intersect(shadow);
      is_hidden = is_hidden || (t && *t < distance - offset);
    }
    ++tested;
    wrong += is_hidden != scene.occluded(hit->leave(Point(lamp) - hit->point()), {.max = 1}) ? 1 : 0;
  }
  return wrong;
}

void scales(Drawing& drawing) {
  drawing.words({320, 26}, "wrong shadow rays with an offset of 0.0001", Anchor::middle, Paint::ink, true);
  double x = 34;
  for (const auto& [scale, name] : {std::pair{1e-5f, "10⁻⁵"},
                                    {1e-4f, "10⁻⁴"},
                                    {1e-3f, "10⁻³"},
                                    {1e-2f, "10⁻²"},
                                    {1e-1f, "0.1"},
                                    {1.0f, "1"},
                                    {10.0f, "10"},
                                    {1e2f, "100"},
                                    {1e3f, "1000"},
                                    {1e4f, "10⁴"}}) {
    int tested = 0;
    const double share = 100.0 * wrong_shadows(scale, tested) / tested, high = 4 * share;
    drawing.rectangle({x, 250 - high}, 40, high, Paint::red, Fill::soft);
    drawing.words({x + 20, 242 - high}, text_of(share, 1) + "%", Anchor::middle, Paint::red);
    drawing.words({x + 20, 276}, name, Anchor::middle);
    x += 59;
  }
  drawing.line({24, 250}, {616, 250}, Paint::ink);
  drawing.words({320, 306}, "size of the scene: 1 is that of stage 09", Anchor::middle);
}

void phong(Drawing& drawing) {
  const Sketch sketch(drawing, {320, 270}, 118);
  const Vec3 to_light = at_angle(138), n = upwards;
  const Vec3 r = reflected(-to_light, n), eye = at_angle(27);

  sketch.line({-2.5, 0, 0}, {2.5, 0, 0}, Paint::ink, Stroke::bold);
  for (const auto& [shininess, paint] :
       {std::pair{4.0, Paint::green}, {20.0, Paint::orange}, {100.0, Paint::red}}) {
    std::vector<Point> outline{Point{0}};
    for (int i = 0; i <= 90; ++i) {
      const Vec3 v = at_angle(2 * i);
      outline.push_back(1.75 * std::pow(std::max(dot(v, r), 0.0), shininess) * v);
    }
    sketch.polygon(outline, paint);
  }
  sketch.arrow(1.9 * to_light, Point{0}, Paint::orange, Stroke::bold);
  sketch.lamp(2.05 * to_light);
  sketch.arrow(Point{0}, 1.5 * n, Paint::green);
  sketch.arrow(Point{0}, 2.1 * r, Paint::red, Stroke::bold);
  sketch.arrow(Point{0}, 2.1 * eye, Paint::blue, Stroke::bold);
  sketch.eye(2.25 * eye, -eye);
  sketch.angle(Point{0}, 0.5, to_light, n, Paint::gray);
  sketch.angle(Point{0}, 0.5, n, r, Paint::gray);
  sketch.angle(Point{0}, 1.95, eye, r, Paint::ink);
  sketch.words(1.5 * n, {0, -8}, "n", Paint::green, Anchor::middle);
  sketch.words(2.1 * r, {-8, -10}, "l', the light mirrored", Paint::red, Anchor::middle);
  sketch.words(2.1 * eye, {6, 34}, "−d, to the eye", Paint::blue, Anchor::middle);
  drawing.words({320, 302}, "their cosine to the power of 4 (green), 20 (orange), 100 (red)", Anchor::middle);
}

void lobes(Drawing& drawing) {
  constexpr double left = 60, right = 600, bottom = 270, top = 44;
  const auto at = [&](double degrees, double value) {
    return Place{left + (right - left) * (degrees + 60) / 120, bottom - (bottom - top) * value};
  };
  for (const double value : {0.0, 0.5, 1.0}) {
    drawing.line(at(-60, value), at(60, value), Paint::gray, value == 0 ? Stroke::thin : Stroke::dashed);
    drawing.words({left - 10, at(0, value).y + 6}, text_of(value, 1), Anchor::end);
  }
  double x = 250;
  for (const auto& [shininess, paint] :
       {std::pair{1.0, Paint::ink}, {10.0, Paint::green}, {50.0, Paint::orange}, {1000.0, Paint::red}}) {
    std::vector<Place> points;
    for (int i = -120; i <= 120; ++i)
      points.push_back(at(0.5 * i, std::pow(dot(at_angle(0.5 * i), Vec3{1, 0, 0}), shininess)));
    drawing.polyline(points, paint, Stroke::bold);
    drawing.words({x, bottom + 78}, text_of(shininess, 0), Anchor::start, paint);
    x += 70;
  }
  for (const double degrees : {-60.0, -30.0, 0.0, 30.0, 60.0})
    drawing.words({at(degrees, 0).x, bottom + 24}, text_of(degrees, 0) + "°", Anchor::middle);
  drawing.words({320, bottom + 52}, "angle between l' and −d", Anchor::middle);
  drawing.words({left, 24}, "its cosine to the power of the shininess");
  drawing.words({150, bottom + 78}, "shininess:");
}

void light_kinds(Drawing& drawing) {
  double middle = 80;
  for (const auto& [kind, title] : {std::pair{"PointLight", "point"},
                                    {"SpotLight", "spot"},
                                    {"DirectionalLight", "directional"},
                                    {"AmbientLight", "ambient"}}) {
    const std::string name = kind;
    const Sketch sketch(drawing, {middle, 122}, 60);
    const Light light = name == "SpotLight"
                            ? Light(SpotLight{.direction = {0, -1, 0}, .angle = 32, .power = Color{1}})
                        : name == "DirectionalLight"
                            ? Light(DirectionalLight{.direction = {0.3, 1, 0}, .intensity = Color{1}})
                            : Light(PointLight{.power = Color{1}});
    drawing.words({middle, 24}, title, Anchor::middle, Paint::ink, true);
    sketch.line({-1.1, -1.2, 0}, {1.1, -1.2, 0}, Paint::ink, Stroke::bold);
    if (name == "DirectionalLight") {
      for (int i = 0; i < 5; ++i) {
        const Point to{0.42 * i - 0.9, -1.2, 0};
        sketch.arrow(to + 2.0 * normalize(light.towards(to)), to, Paint::orange);
      }
    } else if (name == "AmbientLight") {
      for (int i = 0; i <= 6; ++i) {
        const Vec3 from = at_angle(12 + 26 * i);
        sketch.arrow(Point{0, -1.2, 0} + 1.15 * from, Point{0, -1.2, 0} + 0.25 * from, Paint::orange);
      }
    } else {
      for (int i = 0; i < 32; ++i) {
        const Vec3 d = at_angle(11.25 * i);
        if (light.perpendicular_irradiance(Point(d)).r == 0 || (name == "PointLight" && i % 2 != 0)) continue;
        const bool is_spot = name == "SpotLight";
        const auto t = ground.intersect(Ray{.origin = {0, 1.2, 0}, .direction = d});
        sketch.arrow(0.25 * d, (t ? std::min(*t, is_spot ? 1.6 : 0.95) : 0.95) * d, Paint::orange);
      }
      sketch.lamp(Point{0});
    }
    middle += 160;
  }
  drawing.words({80, 236}, "1/r²", Anchor::middle, Paint::orange);
  drawing.words({240, 236}, "1/r², in a cone", Anchor::middle, Paint::orange);
  drawing.words({400, 236}, "no falloff", Anchor::middle, Paint::orange);
  drawing.words({560, 236}, "from everywhere", Anchor::middle, Paint::orange);
}

void tone(Drawing& drawing) {
  const Color light{1.7f, 0.85f, 0.3f};
  double left = 30;
  for (const char* kind : {"the light", "clip", "scale_pixel"}) {
    Image image(1, 1);
    image(0, 0) = light;
    if (std::string(kind) == "scale_pixel") apply(Tone::scale_pixel, image);
    const bool is_light = std::string(kind) == "the light";
    const Color shown = is_light ? light : min(image(0, 0), Color{1});
    drawing.words({left + 85, 24}, kind, Anchor::middle, Paint::ink, true);
    for (int i = 0; i < 3; ++i) {
      const double high = 110.0 * shown[i], x = left + 20 + 46.0 * i;
      const Paint paint = i == 0 ? Paint::red : i == 1 ? Paint::green : Paint::blue;
      drawing.rectangle({x, 260 - high}, 36, high, paint, Fill::soft);
      drawing.words({x + 18, 282}, text_of(shown[i]), Anchor::middle, paint);
    }
    drawing.line({left, 150}, {left + 170, 150}, Paint::gray, Stroke::dashed);
    drawing.line({left, 260}, {left + 170, 260}, Paint::ink);
    if (is_light)
      drawing.words({left + 85, 326}, "no code stands for it", Anchor::middle);
    else
      drawing.swatch({left + 35, 296}, 100, 44, shown_color(shown));
    left += 205;
  }
  drawing.words({24, 156}, "1", Anchor::end);
}

void mirror_vector(Drawing& drawing) {
  const Vec3 d = normalize(Vec3{1, -0.75, 0}), n = upwards, mirrored = reflected(d, n), along = dot(n, d) * n;
  const Sketch sketch(drawing, {300, 206}, 132);
  sketch.line({-2, 0, 0}, {2.2, 0, 0}, Paint::ink, Stroke::bold);
  sketch.arrow(-1.6 * d, Point{0}, Paint::blue);
  sketch.arrow(Point{0}, 1.6 * mirrored, Paint::red);
  sketch.arrow(Point{0}, 1.2 * n, Paint::green, Stroke::bold);
  sketch.arrow(Point{0}, d, Paint::blue, Stroke::bold);
  sketch.arrow(Point{0}, mirrored, Paint::red, Stroke::bold);
  sketch.arrow(d, d - along, Paint::orange, Stroke::bold);
  sketch.arrow(d - along, mirrored, Paint::orange, Stroke::bold);
  sketch.angle(Point{0}, 0.42, -d, n, Paint::gray);
  sketch.angle(Point{0}, 0.42, n, mirrored, Paint::gray);
  sketch.words(-1.3 * d, {14, -4}, "the ray", Paint::blue);
  sketch.words(0.6 * d, {-10, 20}, "d", Paint::blue, Anchor::end);
  sketch.words(1.6 * mirrored, {4, -8}, "d'", Paint::red);
  sketch.words(1.2 * n, {-12, 6}, "n", Paint::green, Anchor::end);
  sketch.words(d - 0.5 * along, {10, 6}, "−(n · d) n", Paint::orange);
  sketch.words(d - 1.5 * along, {10, 6}, "and once more", Paint::orange);
}

void mirror_paths(Drawing& drawing) {
  Scene<Plane> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{1});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 1.6}, Color{1});
  const Sketch sketch(drawing, {30, 216}, 100);
  for (const double y : {0.0, 1.6}) sketch.line({0, y, 0}, {5.9, y, 0}, Paint::ink, Stroke::bold);
  Ray ray{.origin = {0.1, 0.5, 0}, .direction = normalize(Vec3{0.62, 1, 0})};
  sketch.eye(ray.origin, ray.direction);
  for (int i = 1; i <= 5; ++i) {
    const auto hit = scene.intersect(ray).value();
    sketch.ray(ray, hit.t, Paint::blue, Stroke::bold);
    sketch.words(ray.at(0.5 * hit.t), {i % 2 == 1 ? -10.0 : 10.0, -2}, std::to_string(i), Paint::blue,
                 i % 2 == 1 ? Anchor::end : Anchor::start);
    sketch.mark(hit.point(), Paint::red);
    ray = hit.leave(reflected(ray.direction, hit.facing_normal()));
  }
  sketch.ray(ray, 0.6, Paint::gray, Stroke::dashed);
  sketch.words(ray.at(0.6), {10, 6}, "not sent", Paint::gray);
  drawing.words({320, 262}, "two mirrors, and a depth of 5: five rays in one path", Anchor::middle);
}

void mirror_ball(Drawing& drawing) {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 0}, .radius = 1}, Color{1});
  const Sketch sketch(drawing, {330, 186}, 92);
  const Point eye{-3.1, 0, 0};
  sketch.circle(Point{0}, 1, Paint::gray);
  for (int i = -4; i <= 4; ++i) {
    const Ray ray{.origin = eye, .direction = normalize(Vec3{3.1, 0.256 * i, 0})};
    const auto hit = scene.intersect(ray).value();
    const Ray back = hit.leave(reflected(ray.direction, hit.facing_normal()));
    sketch.ray(ray, hit.t, Paint::blue);
    sketch.ray(back, 0.85, i > 0 ? Paint::red : i < 0 ? Paint::green : Paint::ink, Stroke::bold);
  }
  sketch.eye(eye, {1, 0, 0});
  drawing.words({330, 366}, "at the rim it shows what is behind the ball, in the middle the eye",
                Anchor::middle);
}

/// Draws one ray through the surface y = 0 of glass, which fills y < 0.
void draw_refraction(const Sketch& sketch, double degrees, bool enters, double length, bool has_names) {
  const Vec3 n = enters ? upwards : -upwards, d = at_angle(enters ? degrees - 90 : 90 - degrees);
  const auto [passes, bent] = refracted(d, n, enters ? 1 / 1.5 : 1.5);
  const Paint paint = passes ? Paint::blue : Paint::red;
  sketch.arrow(-length * d, Point{0}, paint, Stroke::bold);
  if (!passes || has_names)
    sketch.arrow(Point{0}, length * reflected(d, n), passes ? Paint::gray : Paint::red,
                 passes ? Stroke::dashed : Stroke::bold);
  if (!passes) return;
  sketch.arrow(Point{0}, length * bent, Paint::blue, Stroke::bold);
  if (!has_names) return;
  sketch.angle(Point{0}, 0.5, -d, n, Paint::ink);
  sketch.angle(Point{0}, 0.6, bent, -n, Paint::red);
  const double behind = std::asin(std::abs(bent.x)) * 180 / std::numbers::pi;
  sketch.words(0.62 * normalize(n - d), {-4, 6}, text_of(degrees, 0) + "°", Paint::ink, Anchor::end);
  sketch.words(0.72 * normalize(bent - n), {6, enters ? 14.0 : 0.0}, text_of(behind, 0) + "°", Paint::red);
}

void refraction(Drawing& drawing) {
  double middle = 160;
  for (const bool enters : {true, false}) {
    const Sketch sketch(drawing, {middle, 190}, 96);
    drawing.rectangle({middle - 150, 190}, 300, 140, Paint::blue, Fill::soft);
    sketch.line({0, 1.4, 0}, {0, -1.4, 0}, Paint::gray, Stroke::dashed);
    draw_refraction(sketch, enters ? 50 : 35, enters, 1.4, true);
    drawing.words({middle, 24}, enters ? "into glass" : "out of glass", Anchor::middle, Paint::ink, true);
    drawing.words({middle + 146, 182}, "air", Anchor::end, Paint::gray);
    drawing.words({middle + 146, 322}, "glass, 1.5", Anchor::end, Paint::gray);
    drawing.words({middle, 354}, enters ? "towards the normal" : "away from the normal", Anchor::middle);
    middle += 320;
  }
}

void total_reflection(Drawing& drawing) {
  drawing.rectangle({10, 150}, 620, 170, Paint::blue, Fill::soft);
  double middle = 66;
  for (const double degrees : {0.0, 20.0, 35.0, 41.0, 43.0, 60.0}) {
    const Sketch sketch(drawing, {middle, 150}, 92);
    draw_refraction(sketch, degrees, false, degrees > 41.8 ? 0.7 : 1.25, false);
    drawing.words({middle, 344}, text_of(degrees, 0) + "°", Anchor::middle,
                  degrees > 41.8 ? Paint::red : Paint::blue);
    middle += degrees < 40 ? 92 : 108;
  }
  drawing.words({320, 24}, "From within glass: beyond 41.8° nothing gets out", Anchor::middle, Paint::ink,
                true);
}

void glass_ball(Drawing& drawing) {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 0}, .radius = 1}, Color{1});
  const Sketch sketch(drawing, {290, 136}, 92);
  const Point eye{-2.9, 0, 0};
  sketch.circle(Point{0}, 1, Paint::blue);
  for (int i = -3; i <= 3; ++i) {
    const Paint paint = i > 0 ? Paint::red : i < 0 ? Paint::green : Paint::gray;
    Ray ray{.origin = eye, .direction = normalize(Vec3{2.9, 0.25 * i, 0})};
    for (const bool enters : {true, false}) {
      const auto hit = scene.intersect(ray).value();
      const auto [passes, bent] = refracted(ray.direction, hit.facing_normal(), enters ? 1 / 1.5 : 1.5);
      expect(passes, "glass_ball");
      sketch.line(ray.origin, hit.point(), paint, Stroke::bold);
      ray = hit.leave(bent);
    }
    sketch.arrow(ray.origin, ray.at((3.4 - ray.origin.x) / ray.direction.x), paint, Stroke::bold);
  }
  sketch.eye(eye, {1, 0, 0});
  sketch.words({-1.9, 0.42, 0}, {0, 0}, "looks up", Paint::red, Anchor::middle);
  sketch.words({2.6, -0.78, 0}, {0, 0}, "sees what is below", Paint::red, Anchor::middle);
}

/// A ray of a tree of rays, with what it hits.
struct TreeRay {
  Point from, to;
  const char* name;
  Paint paint;
  std::vector<TreeRay> children;
};

/// Traces a ray through a scene whose materials reflect and refract, as WhittedIntegrator does.
TreeRay traced(const Ray& ray, const auto& scene, const char* name, Paint paint, int rays) {
  const auto hit = scene.intersect(ray);
  TreeRay result{ray.origin, ray.at(hit && hit->t < 3 ? hit->t : 0.6), name, paint, {}};
  if (!hit || rays == 1) return result;
  const Vec3 n = hit->facing_normal(), d = ray.direction;
  if (hit->material().reflect > 0)
    result.children.push_back(traced(hit->leave(reflected(d, n)), scene, "mirrored", Paint::red, rays - 1));
  if (hit->material().refract > 0) {
    const auto [passes, bent] = refracted(d, n, dot(hit->normal(), d) <= 0 ? 1 / 1.5 : 1.5);
    if (passes)
      result.children.push_back(traced(hit->leave(bent), scene, "refracted", Paint::green, rays - 1));
  }
  return result;
}

/// Returns the number of paths that begin with a ray.
double ends_of(const TreeRay& ray) {
  double sum = ray.children.empty() ? 1 : 0;
  for (const TreeRay& child : ray.children) sum += ends_of(child);
  return sum;
}

void draw_tree(Drawing& drawing, const Sketch& sketch, const TreeRay& ray, const Place& at, double width) {
  sketch.arrow(ray.from, ray.to, ray.paint, Stroke::bold);
  double x = at.x - width / 2;
  for (const TreeRay& child : ray.children) {
    const double part = width * ends_of(child) / ends_of(ray);
    const Place below{x + part / 2, at.y + 78};
    drawing.line(at, below, child.paint, Stroke::bold);
    draw_tree(drawing, sketch, child, below, part);
    x += part;
  }
  drawing.mark(at, Paint::ink, ray.children.empty() ? Fill::none : Fill::full);
}

void whitted_tree(Drawing& drawing) {
  Scene<Sphere, Plane> scene;
  const Sphere ball{.center = {0, 1.05, 0}, .radius = 0.8}, mirror{.center = {1.75, 0.75, 0}, .radius = 0.7};
  scene.add(ball, Material{.reflect = 0.1, .refract = 0.9});
  scene.add(mirror, Material{.reflect = 0.9});
  scene.add(ground, Material{.diffuse = Color{1}});
  const Sketch sketch(drawing, {156, 316}, 90);
  sketch.line({-1.6, 0, 0}, {2.6, 0, 0}, Paint::ink, Stroke::bold);
  sketch.circle(ball.center, ball.radius, Paint::blue);
  sketch.circle(mirror.center, mirror.radius, Paint::ink);
  const Ray ray{.origin = {-1.45, 1.9, 0}, .direction = normalize(Vec3{1, -0.3, 0})};
  const TreeRay root = traced(ray, scene, "camera", Paint::blue, 4);
  drawing.line({500, 34}, {500, 62}, Paint::blue, Stroke::bold);
  draw_tree(drawing, sketch, root, {500, 62}, 250);
  sketch.eye(ray.origin, ray.direction);
  sketch.words(ball.center, {-26, 52}, "glass", Paint::blue, Anchor::middle);
  sketch.words(mirror.center, {16, 10}, "mirror", Paint::ink, Anchor::middle);
  drawing.words({512, 46}, "camera", Anchor::start, Paint::blue);
  drawing.words({320, 350}, "red: mirrored;  green: refracted;  hollow: the end of a path", Anchor::middle);
}

}  // namespace

std::vector<StageFigure> path_figures() {
  return {
      {"shadow_ray", "09_shadow", "Rays from a point to two lights, one of which a ball hides", 366,
       shadow_ray},
      {"shadow_strip", "09_shadow", "A ball between two lights and the floor, and its shadows", 380,
       shadow_strip},
      {"departure", "09_shadow", "Rays that leave a sphere outwards and inwards", 332, departure},
      {"offsets", "09_naive", "Bars: wrong pixels for offsets from 0 to 0.1", 342, offsets},
      {"scales", "09_naive", "Bars: wrong shadow rays in scenes from a small to a large size", 322, scales},
      {"phong", "10_phong", "A highlight's lobes around the mirror direction", 318, phong},
      {"lobes", "10_phong", "Powers of the cosine for four values of the shininess", 364, lobes},
      {"light_kinds", "lights", "A point light, a spotlight, a directional and an ambient light", 256,
       light_kinds},
      {"tone", "exposure", "Light above 1, cut channel by channel and scaled", 356, tone},
      {"mirror_vector", "11_mirror", "A direction, its mirror image, and the normal", 322, mirror_vector},
      {"mirror_paths", "11_mirror", "A path of five rays between two mirrors", 280, mirror_paths},
      {"mirror_ball", "11_mirror", "Rays from an eye, mirrored by a ball in all directions", 382,
       mirror_ball},
      {"refraction", "12_glass", "A ray that enters glass and one that leaves it", 370, refraction},
      {"total_reflection", "12_glass", "Rays within glass at six angles, two of them reflected", 360,
       total_reflection},
      {"glass_ball", "12_glass", "Rays through a ball of glass, which cross behind it", 276, glass_ball},
      {"whitted_tree", "13_whitted", "A path that splits at glass, in space and as a tree", 366,
       whitted_tree},
  };
}

}  // namespace figures
