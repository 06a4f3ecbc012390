// Figures of the stages 00 to 02: vectors, images, cameras and rays.
#include <algorithm>
#include <cmath>
#include <protostar/interval.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

void axes(Drawing& drawing) {
  const auto draw = [&](double left, const Camera& camera, const char* title, const char* z) {
    const Sketch sketch(drawing, {left + 160, 190}, 110, camera);
    drawing.words({left + 160, 24}, title, Anchor::middle, Paint::ink, true);
    for (const auto& [axis, name, paint] : {std::tuple{Vec3{1, 0, 0}, "x", Paint::red},
                                            {Vec3{0, 1, 0}, "y", Paint::green},
                                            {Vec3{0, 0, 1}, "z", Paint::blue}}) {
      sketch.arrow(Point{0}, axis, paint, Stroke::bold);
      sketch.words(1.15 * axis, {0, 6}, name, paint, Anchor::middle);
    }
    drawing.words({left + 160, 276}, z, Anchor::middle, Paint::blue);
  };
  draw(0, Camera::look_at({2, 1.4, -4}, Point{0}), "left-handed: here", "z leads away from you");
  draw(320, Camera::look_at_right_handed({2, 1.4, 4}, Point{0}), "right-handed", "z leads towards you");
  drawing.line({320, 40}, {320, 286}, Paint::gray, Stroke::dashed);
  drawing.words({320, 314}, "of that hand: thumb x, index finger y, middle finger z", Anchor::middle);
}

void vector_sum(Drawing& drawing) {
  const Vec3 u{3, 1, 0}, v{1, 2, 0};
  const auto arrow = [](const Sketch& sketch, const Point& from, const Vec3& along, const char* name,
                        Paint paint, const Place& beside) {
    sketch.arrow(from, from + along, paint, Stroke::bold);
    sketch.words(from + 0.5 * along, beside, name, paint, Anchor::middle);
  };
  const Sketch sum(drawing, {30, 226}, 48), rest(drawing, {260, 226}, 48), product(drawing, {480, 226}, 48);
  drawing.words({120, 24}, "a + b", Anchor::middle, Paint::ink, true);
  sum.line(u, u + v, Paint::gray, Stroke::dashed);
  sum.line(v, u + v, Paint::gray, Stroke::dashed);
  arrow(sum, Point{0}, u, "a", Paint::blue, {10, 22});
  arrow(sum, Point{0}, v, "b", Paint::green, {-14, -4});
  arrow(sum, Point{0}, u + v, "a + b", Paint::red, {-22, -14});
  drawing.words({340, 24}, "a − b", Anchor::middle, Paint::ink, true);
  arrow(rest, Point{0}, u, "a", Paint::blue, {10, 22});
  arrow(rest, Point{0}, v, "b", Paint::green, {-14, -4});
  arrow(rest, Point(v), u - v, "a − b", Paint::red, {22, -10});
  drawing.words({556, 24}, "s a", Anchor::middle, Paint::ink, true);
  const Vec3 w = 0.5 * u;
  for (const auto& [s, name, y] : {std::tuple{1.0, "a", 0.0}, {2.0, "2 a", 1.0}, {-1.0, "−1 a", 2.2}}) {
    const Point from = s < 0 ? Point(0, y, 0) + w : Point(0, y, 0);
    arrow(product, from, s * w, name, s == 1 ? Paint::blue : Paint::red, {-4, -12});
  }
}

void dot_product(Drawing& drawing) {
  const Vec3 u{2.4, 0, 0};
  double middle = 107;
  for (const auto& [v, title, paint] : {std::tuple{Vec3{1.5, 1.6, 0}, "less than 90°", Paint::green},
                                        {Vec3{0, 2.1, 0}, "90°", Paint::ink},
                                        {Vec3{-1, 1.8, 0}, "more than 90°", Paint::red}}) {
    const Sketch sketch(drawing, {middle - 50, 180}, 54);
    const Vec3 along = dot(u, v) / dot(u, u) * u;
    drawing.words({middle, 24}, title, Anchor::middle, Paint::ink, true);
    sketch.arrow(Point{0}, u, Paint::blue, Stroke::bold);
    sketch.arrow(Point{0}, v, paint, Stroke::bold);
    sketch.angle(Point{0}, 0.5, u, v, Paint::ink);
    if (dot(u, v) != 0) {
      sketch.line(v, along, Paint::gray, Stroke::dashed);
      sketch.line(Point(0, -0.16, 0), along + Vec3{0, -0.16, 0}, paint, Stroke::bold);
    }
    sketch.words(u, {2, 22}, "a", Paint::blue, Anchor::middle);
    sketch.words(v, {0, -8}, "b", paint, Anchor::middle);
    drawing.words({middle, 236}, joined({"a · b = ", text_of(dot(u, v))}), Anchor::middle, paint);
    middle += 213;
  }
}

void cross_product(Drawing& drawing) {
  const Vec3 u{0.6, 0, 2}, v{2.6, 0, 0.4}, n = cross(u, v) / 3.0;
  const Sketch sketch(drawing, {150, 218}, 96, Camera::look_at({1.5, 2.2, -4}, Point{0}));
  sketch.polygon({Point{0}, u, u + v, v}, Paint::orange);
  sketch.arrow(Point{0}, u, Paint::green, Stroke::bold);
  sketch.arrow(Point{0}, v, Paint::blue, Stroke::bold);
  sketch.arrow(Point{0}, n, Paint::red, Stroke::bold);
  for (const Vec3& side : {u, v}) {
    const Vec3 a = 0.22 * normalize(side), b = 0.22 * normalize(n);
    sketch.line(a, a + b, Paint::gray);
    sketch.line(a + b, b, Paint::gray);
  }
  sketch.words(u, {8, -6}, "a", Paint::green);
  sketch.words(v, {10, 6}, "b", Paint::blue);
  sketch.words(n, {12, 4}, "a × b, at right angles to both", Paint::red);
  sketch.words(0.5 * (u + v), {0, 0}, "its length is this area", Paint::orange, Anchor::middle);
}

void pixel_grid(Drawing& drawing) {
  constexpr double left = 150, top = 66, size = 62;
  constexpr int width = 6, height = 4;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Place corner{left + size * x, top + size * y};
      drawing.rectangle(corner, size, size, Paint::gray, x == 4 && y == 1 ? Fill::soft : Fill::none);
      drawing.words({corner.x + size / 2, corner.y + size / 2 + 6}, std::to_string(y * width + x),
                    Anchor::middle, x == 4 && y == 1 ? Paint::red : Paint::gray);
    }
  for (int x = 0; x < width; ++x)
    drawing.words({left + size * (x + 0.5), top - 10}, std::to_string(x), Anchor::middle, Paint::blue);
  for (int y = 0; y < height; ++y)
    drawing.words({left - 12, top + size * (y + 0.5) + 6}, std::to_string(y), Anchor::end, Paint::green);
  drawing.arrow({left, 28}, {left + size * width, 28}, Paint::blue);
  drawing.words({left + size * width + 12, 34}, "x", Anchor::start, Paint::blue);
  drawing.arrow({left - 46, top}, {left - 46, top + size * height}, Paint::green);
  drawing.words({left - 46, top + size * height + 22}, "y", Anchor::middle, Paint::green);
  drawing.words({left + size * 3, top + size * height + 30}, "red: image(4, 1), number 1 · 6 + 4 in memory",
                Anchor::middle, Paint::red);
}

void codes(Drawing& drawing) {
  constexpr int most = 7;
  const Encoder encoder(Linear{}, most);
  constexpr double left = 70, bottom = 300, width = 520, height = 250;
  const auto at = [&](double light, double code) {
    return Place{left + width * light, bottom - height * code / most};
  };
  drawing.arrow({left, bottom}, {left + width + 36, bottom}, Paint::ink);
  drawing.arrow({left, bottom}, {left, 24}, Paint::ink);
  drawing.line(at(0, 0), at(1, most), Paint::gray, Stroke::dashed);
  std::vector<Place> stairs{at(0, 0)};
  for (int code = 1; code <= most; ++code) {
    // The smallest float with this code, found by halving.
    double below = 0, from = 1;
    for (int i = 0; i < 40; ++i) {
      const double middle = (below + from) / 2;
      (encoder(static_cast<float>(middle)) < code ? below : from) = middle;
    }
    stairs.push_back(at(from, code - 1)), stairs.push_back(at(from, code));
    drawing.line({at(from, 0).x, bottom - 6}, {at(from, 0).x, bottom + 6}, Paint::blue, Stroke::bold);
  }
  stairs.push_back(at(1, most));
  drawing.polyline(stairs, Paint::blue, Stroke::bold);
  for (int code = 0; code <= most; ++code)
    drawing.words({left - 12, at(0, code).y + 6}, std::to_string(code), Anchor::end);
  for (const double light : {0.0, 0.5, 1.0})
    drawing.words({at(light, 0).x, bottom + 28}, text_of(light, 1), Anchor::middle);
  drawing.words({left + 12, 30}, "code k in the file");
  drawing.words({left + width / 2, bottom + 54}, "light L; a blue mark is a threshold, (k − ½)/7",
                Anchor::middle);
}

void viewport(Drawing& drawing) {
  const Camera camera;
  const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
  constexpr int width = 4, height = 3;
  const Sketch sketch(drawing, {70, 250}, 118, Camera::look_at({5.5, 2.4, -3.6}, {0, 0, 0.4}));
  const auto film = [&](double x, double y) {
    return camera.position + camera.forward + Camera::u_at(x, width, height) * camera.right +
           Camera::v_at(y, height) * camera.up;
  };
  sketch.circle(sphere.center, sphere.radius, Paint::blue);
  sketch.polygon({film(0, 0), film(width, 0), film(width, height), film(0, height)}, Paint::gray);
  for (int x = 0; x <= width; ++x) sketch.line(film(x, 0), film(x, height), Paint::gray);
  for (int y = 0; y <= height; ++y) sketch.line(film(0, y), film(width, y), Paint::gray);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.through_pixel(x, y, width, height);
      const auto on_film = Plane{.normal = camera.forward, .distance = 1}.intersect(ray);
      const auto t = sphere.intersect(ray);
      sketch.line(ray.origin, ray.at(on_film.value()), t ? Paint::blue : Paint::gray,
                  t ? Stroke::thin : Stroke::dashed);
      sketch.mark(ray.at(on_film.value()), t ? Paint::blue : Paint::ink, t ? Fill::full : Fill::none);
      if (t) sketch.arrow(ray.at(on_film.value()), ray.at(*t), Paint::blue, Stroke::bold);
    }
  sketch.arrow(Point{0}, camera.forward, Paint::red, Stroke::bold);
  sketch.arrow(camera.forward, camera.forward + camera.up, Paint::green, Stroke::bold);
  sketch.arrow(camera.forward, camera.forward + camera.right, Paint::orange, Stroke::bold);
  sketch.mark(Point{0}, Paint::ink);
  sketch.words(Point{0}, {-64, 30}, "camera", Paint::ink);
  sketch.words(film(0, 0), {-8, -12}, "film", Paint::ink, Anchor::middle);
  sketch.words(camera.forward, {-10, 26}, "forward", Paint::red, Anchor::end);
  sketch.words(camera.forward + camera.up, {0, -10}, "up", Paint::green, Anchor::middle);
  sketch.words(camera.forward + camera.right, {6, 24}, "right", Paint::orange);
  sketch.words(sphere.center, {6, -30}, "sphere", Paint::blue);
}

void backwards(Drawing& drawing) {
  const Plane floor{.normal = {0, 1, 0}, .distance = -1};
  const Sphere ball{.center = {0.55, -0.5, 0}, .radius = 0.5};
  const Point lamp{-0.7, 1.15, 0}, eye{-1.75, 0.1, 0};
  const auto first = [&](const Ray& ray) {
    const auto on_ball = ball.intersect(ray), on_floor = floor.intersect(ray);
    return on_ball && (!on_floor || *on_ball < *on_floor) ? on_ball : on_floor;
  };
  const auto draw = [&](double left, const char* title) {
    const Sketch sketch(drawing, {left + 164, 190}, 78);
    drawing.words({left + 160, 24}, title, Anchor::middle, Paint::ink, true);
    sketch.line({-2, -1, 0}, {1.9, -1, 0}, Paint::ink, Stroke::bold);
    sketch.circle(ball.center, ball.radius, Paint::ink);
    sketch.lamp(lamp);
    sketch.eye(eye, {1, -0.35, 0});
    return sketch;
  };
  const Sketch forwards = draw(0, "as light goes");
  for (int i = 0; i < 15; ++i) {
    const Ray ray{.origin = lamp, .direction = at_angle(24 * i - 14)};
    const auto t = first(ray);
    const bool is_near = t && std::abs(ray.at(*t).x) < 1.9;
    forwards.ray(ray, is_near ? *t : 0.85, Paint::orange);
  }
  drawing.words({160, 318}, "almost none reaches the eye", Anchor::middle, Paint::orange);

  const Sketch back = draw(320, "as we go: from the eye");
  for (const double slope : {-0.72, -0.56, -0.42, -0.31, -0.22}) {
    const Ray ray{.origin = eye, .direction = {1, slope, 0}};
    const Point hit = ray.at(first(ray).value());
    back.arrow(eye, hit, Paint::blue, Stroke::bold);
    back.line(hit, lamp, Paint::gray, Stroke::dashed);
  }
  drawing.words({480, 318}, "every ray is of use", Anchor::middle, Paint::blue);
}

void field_of_view(Drawing& drawing) {
  const Sphere sphere{.center = {0, 0, 3}, .radius = 1};
  const Sketch side(drawing, {40, 175}, 74, {.right = {0, 0, 1}});
  side.circle(sphere.center, sphere.radius, Paint::ink);
  double top = 44;
  for (const auto& [degrees, paint, at, name] : {std::tuple{30.0, Paint::green, 1.4, Point{0, -0.07, 1.48}},
                                                 {60.0, Paint::blue, 1.15, Point{0, -0.55, 1.1}},
                                                 {90.0, Paint::red, 0.9, Point{0, 0.6, 0.75}}}) {
    const Camera camera = Camera::perspective(Point{0}, {0, 0, 1}, {0, 1, 0}, degrees);
    for (const double v : {1.0, -1.0}) {
      const Ray edge = camera(0, v);
      side.line(Point{0}, edge.at(std::min(3.9 / edge.direction.z, 2.1 / std::abs(edge.direction.y))), paint,
                Stroke::bold);
    }
    side.angle(Point{0}, at, camera(0, 1).direction, camera(0, -1).direction, paint);
    side.words(name, {0, 0}, text_of(degrees, 0) + "°", paint);
    // The sphere's outline in the picture: the last camera ray upwards that meets it. Above and below, the
    // edges of the picture cut it.
    double v = 0;
    while (sphere.intersect(camera(0, v))) v += 1.0 / 1024;
    drawing.rectangle({462, top}, 120, 84, Paint::gray, Fill::none);
    expect(v < 120.0 / 84, "field_of_view");
    if (v < 1) {
      drawing.circle({522, top + 42}, 42 * v, paint, Fill::soft);
    } else {
      std::vector<Place> outline;
      for (int angle = 0; angle < 360; angle += 3) {
        const Vec3 place = v * at_angle(angle);
        outline.push_back({522 + 42 * place.x, top + 42 - 42 * std::clamp(place.y, -1.0, 1.0)});
      }
      drawing.polygon(outline, paint, Fill::soft);
    }
    drawing.words({592, top + 48}, text_of(degrees, 0) + "°", Anchor::start, paint);
    top += 98;
  }
  side.mark(Point{0}, Paint::ink);
  drawing.words({90, 24}, "from the side", Anchor::middle, Paint::ink, true);
  drawing.words({522, 24}, "the pictures", Anchor::middle, Paint::ink, true);
}

void ray_points(Drawing& drawing) {
  const Ray ray{.origin = {0, 0, 0}, .direction = normalize(Vec3{2, 1, 0})};
  const Sketch sketch(drawing, {170, 216}, 104);
  sketch.line(ray.at(-1.6), ray.at(0), Paint::gray, Stroke::dashed);
  sketch.ray(ray, 4, Paint::blue);
  sketch.ray(ray, 1, Paint::red, Stroke::bold);
  for (int t = -1; t <= 3; ++t) {
    sketch.mark(ray.at(t),
                t < 0    ? Paint::gray
                : t == 0 ? Paint::ink
                         : Paint::blue,
                t < 0 ? Fill::none : Fill::full);
    sketch.words(ray.at(t), {-6, -14}, (t < 0 ? "t = −" : "t = ") + std::to_string(std::abs(t)),
                 t < 0 ? Paint::gray : Paint::ink, Anchor::end);
  }
  sketch.words(ray.at(0), {4, 24}, "o", Paint::ink);
  sketch.words(ray.at(0.62), {2, 24}, "d, of length 1", Paint::red);
  sketch.words(ray.at(2), {6, 24}, "o + 2 d", Paint::blue);
  sketch.words(ray.at(-1), {6, 24}, "behind: not on the ray", Paint::gray);
}

/// The unit sphere of a figure, and a line from the left at a height over its center.
constexpr Sphere unit_sphere{.center = {0, 0, 0}, .radius = 1};
Ray at_height(double height) { return {.origin = {-2.2, height, 0}, .direction = {1, 0, 0}}; }

void sphere_crossings(Drawing& drawing) {
  double middle = 107;
  for (const auto& [height, title, paint] : {std::tuple{0.5, "two roots", Paint::blue},
                                             {1.0, "they coincide", Paint::orange},
                                             {1.35, "no root", Paint::red}}) {
    const Sketch sketch(drawing, {middle, 170}, 68);
    const Ray ray = at_height(height);
    const auto equation = sphere_equation(ray, unit_sphere.center, unit_sphere.radius);
    const Roots roots = roots_of(unit_sphere, ray);
    drawing.words({middle, 24}, title, Anchor::middle, Paint::ink, true);
    sketch.circle(unit_sphere.center, 1, Paint::ink);
    sketch.arrow(ray.at(0.75), ray.at(3.6), paint, Stroke::bold);
    sketch.line(Point{0}, {0, height, 0}, Paint::gray, Stroke::dashed);
    sketch.mark(Point{0}, Paint::gray);
    for (const double t : roots) sketch.mark(ray.at(t), paint);
    if (roots.count() == 2 && roots[0] < roots[1]) {
      sketch.words(ray.at(roots[0]), {-6, -10}, "t₁", paint, Anchor::end);
      sketch.words(ray.at(roots[1]), {6, -10}, "t₂", paint);
    }
    drawing.words({middle, 276}, joined({"D = ", text_of(equation.D)}), Anchor::middle, paint);
    middle += 213;
  }
}

void sphere_polynomial(Drawing& drawing) {
  const Sketch sketch(drawing, {56, 222}, 112);
  sketch.arrow({0, 0, 0}, {4.5, 0, 0}, Paint::ink);
  sketch.arrow({0, -0.9, 0}, {0, 1.75, 0}, Paint::ink);
  sketch.words({4.5, 0, 0}, {-4, 26}, "t", Paint::ink, Anchor::end);
  sketch.words({0, 1.75, 0}, {0, -10}, "A t² − 2 B t + C");
  for (const auto& [height, name, paint] :
       {std::tuple{0.5, "D > 0", Paint::blue}, {1.0, "D = 0", Paint::orange}, {1.35, "D < 0", Paint::red}}) {
    const auto e = sphere_equation(at_height(height), unit_sphere.center, unit_sphere.radius);
    const auto f = [&](double t) { return Point{t, (e.A * t - 2 * e.b) * t + e.c, 0}; };
    sketch.curve(f, 2.2 - 0.95, 2.2 + 0.95, paint, Stroke::bold);
    for (const double t : roots_of(unit_sphere, at_height(height))) sketch.mark({t, 0, 0}, paint);
    sketch.words(f(2.2 + 0.95), {14, 6}, name, paint);
  }
  sketch.line({2.2, -0.85, 0}, {2.2, 0.85, 0}, Paint::gray, Stroke::dashed);
  sketch.words({2.2, -0.85, 0}, {0, 20}, "B/A: nearest the center", Paint::gray, Anchor::middle);
}

void roots_behind(Drawing& drawing) {
  double y = 78;
  for (const auto& [start, title] : {std::pair{-2.6, "before the sphere: t₁ counts"},
                                     {-0.2, "inside: t₁ is behind, t₂ counts"},
                                     {1.7, "beyond it: both behind, a miss"}}) {
    const Sketch sketch(drawing, {236, y}, 60);
    const Ray ray{.origin = {start, 0.3, 0}, .direction = {1, 0, 0}};
    const auto hit = unit_sphere.intersect(ray);
    const Roots roots = roots_of(unit_sphere, ray);
    sketch.circle(unit_sphere.center, 1, Paint::ink);
    sketch.line({-3.3, 0.3, 0}, ray.origin, Paint::gray, Stroke::dashed);
    sketch.arrow(ray.origin, {3.1, 0.3, 0}, Paint::blue, Stroke::bold);
    sketch.eye(ray.origin, ray.direction);
    for (int i = 0; i < roots.count(); ++i) {
      const bool counts = hit && roots[i] == *hit, is_behind = roots[i] < 0;
      sketch.mark(ray.at(roots[i]), counts ? Paint::red : Paint::gray, is_behind ? Fill::none : Fill::full);
      sketch.words(ray.at(roots[i]), {i == 0 ? -8.0 : 8.0, 24}, i == 0 ? "t₁" : "t₂",
                   counts ? Paint::red : Paint::gray, i == 0 ? Anchor::end : Anchor::start);
    }
    drawing.words({434, y - 8}, std::string(title).substr(0, std::string(title).find(':') + 1));
    drawing.words({434, y + 16}, std::string(title).substr(std::string(title).find(':') + 2), Anchor::start,
                  hit ? Paint::red : Paint::gray);
    y += 138;
  }
}

void ray_interval(Drawing& drawing) {
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const Interval range{.min = 1, .max = 4};
  const Sketch sketch(drawing, {40, 120}, 100);
  sketch.arrow({-0.3, 0, 0}, {5.9, 0, 0}, Paint::gray);
  sketch.line(ray.at(range.min), ray.at(range.max), Paint::blue, Stroke::bold);
  for (const double x : {0.5, 2.0, 3.5, 5.0}) {
    const Sphere sphere{.center = {x, 0, 0}, .radius = 0.5};
    sketch.circle(sphere.center, sphere.radius, Paint::gray);
    for (const double t : roots_of(sphere, ray))
      sketch.mark(ray.at(t), range.contains(t) ? Paint::red : Paint::gray,
                  range.contains(t) ? Fill::full : Fill::none);
  }
  for (int t = 0; t <= 5; ++t) {
    sketch.line({t + 0.0, -0.85, 0}, {t + 0.0, -0.75, 0}, Paint::ink);
    sketch.words({t + 0.0, -0.85, 0}, {0, 22}, std::to_string(t), Paint::ink, Anchor::middle);
  }
  sketch.arrow({-0.3, -0.8, 0}, {5.9, -0.8, 0}, Paint::ink);
  sketch.words({5.9, -0.8, 0}, {-4, -10}, "t", Paint::ink, Anchor::end);
  sketch.words({1, 0, 0}, {0, -72}, "min", Paint::blue, Anchor::middle);
  sketch.words({4, 0, 0}, {0, -72}, "max", Paint::blue, Anchor::middle);
  for (const double t : {1.0, 4.0}) sketch.line({t, 0.65, 0}, {t, -0.75, 0}, Paint::blue, Stroke::dashed);
  drawing.words({320, 264}, "red: counts;  gray: outside, or exactly at an end", Anchor::middle);
}

void projections(Drawing& drawing) {
  const Sphere near{.center = {0, 0.3, 1.9}, .radius = 0.3}, far{.center = {0, -0.45, 3.1}, .radius = 0.3};
  const auto draw = [&](double left, const Camera& camera, const char* title) {
    const Sketch side(drawing, {left + 26, 170}, 76, {.right = {0, 0, 1}});
    drawing.words({left + 160, 24}, title, Anchor::middle, Paint::ink, true);
    side.circle(near.center, near.radius, Paint::blue);
    side.circle(far.center, far.radius, Paint::red);
    for (int y = 0; y < 13; ++y) {
      const Ray ray = camera.through_pixel(0, y, 1, 13);
      const auto on_near = near.intersect(ray), on_far = far.intersect(ray);
      const Paint paint = on_near ? Paint::blue : on_far ? Paint::red : Paint::gray;
      const double end = 3.6 / ray.direction.z;
      side.arrow(ray.origin, ray.at(on_near ? *on_near : on_far ? *on_far : end), paint);
    }
    // The picture, as a strip of pixels that the rays, followed past the spheres, would meet in their order.
    constexpr double strip = 3.66;
    constexpr int pixels = 104;
    const auto row = [&](double y) {
      const Ray ray = camera(0, Camera::v_at(y, pixels));
      return side.of(ray.at(strip / ray.direction.z));
    };
    const Place top = row(0), bottom = row(pixels);
    for (int y = 0; y < pixels; ++y) {
      const Ray ray = camera.through_pixel(0, y, 1, pixels);
      const bool on_near = near.intersect(ray).has_value(), on_far = far.intersect(ray).has_value();
      const Place at = row(y + 0.5);
      if (on_near || on_far)
        drawing.line(at, {at.x + 14, at.y}, on_near ? Paint::blue : Paint::red, Stroke::bold);
    }
    drawing.rectangle(top, 14, bottom.y - top.y, Paint::gray, Fill::none);
    return side;
  };
  const Sketch pinhole = draw(0, Camera::perspective({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 40), "perspective");
  pinhole.mark(Point{0}, Paint::ink);
  const Sketch parallel =
      draw(320, Camera::orthographic({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 2.2), "orthographic");
  parallel.line({0, 1.1, 0}, {0, -1.1, 0}, Paint::ink, Stroke::bold);
  drawing.words({160, 312}, "the far one looks smaller", Anchor::middle);
  drawing.words({480, 312}, "both look alike", Anchor::middle);
}

void film_coordinates(Drawing& drawing) {
  constexpr int width = 4, height = 3;
  constexpr double size = 62;
  const auto grid = [&](double left, double top) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool is_shown = x == 3 && y == 0;
        drawing.rectangle({left + size * x, top + size * y}, size, size, Paint::gray,
                          is_shown ? Fill::soft : Fill::none);
        drawing.circle({left + size * (x + 0.5), top + size * (y + 0.5)}, 3,
                       is_shown ? Paint::red : Paint::gray, Fill::full);
      }
  };
  grid(16, 80), grid(376, 80);
  drawing.words({140, 24}, "pixels (x, y)", Anchor::middle, Paint::ink, true);
  drawing.words({500, 24}, "film (u, v)", Anchor::middle, Paint::ink, true);
  drawing.arrow({16, 80}, {290, 80}, Paint::blue), drawing.words({292, 74}, "x", Anchor::start, Paint::blue);
  drawing.arrow({16, 80}, {16, 296}, Paint::green),
      drawing.words({26, 300}, "y", Anchor::start, Paint::green);
  const Place middle{376 + 2 * size, 80 + 1.5 * size};
  drawing.arrow(middle, {632, middle.y}, Paint::blue);
  drawing.words({628, middle.y + 22}, "u", Anchor::end, Paint::blue);
  drawing.arrow(middle, {middle.x, 56}, Paint::green);
  drawing.words({middle.x + 10, 66}, "v", Anchor::start, Paint::green);
  drawing.arrow({284, middle.y}, {366, middle.y}, Paint::ink, Stroke::bold);
  const double u = Camera::u_at(3.5, width, height), v = Camera::v_at(0.5, height);
  drawing.words({140, 326}, "red center: (3 + ½, 0 + ½)", Anchor::middle, Paint::red);
  drawing.words({500, 326}, joined({"u = ", text_of(u), ", v = ", text_of(v)}), Anchor::middle, Paint::red);
  drawing.words({490, 296}, "|u| up to 4/3, |v| up to 1", Anchor::middle, Paint::gray);
}

}  // namespace

std::vector<StageFigure> vector_figures() {
  return {
      {"axes", "00_vectors", "The axes x, y and z of left-handed and of right-handed coordinates", 330, axes},
      {"vector_sum", "00_vectors", "Two arrows with their sum, their difference and multiples", 256,
       vector_sum},
      {"dot_product", "00_vectors", "Two vectors at three angles, with the sign of their dot product", 252,
       dot_product},
      {"cross_product", "00_vectors", "Two vectors on the ground and their cross product, upright", 270,
       cross_product},
      {"pixel_grid", "01_gradient", "Pixels of an image, counted to the right and down", 360, pixel_grid},
      {"codes", "01_gradient", "Stairs: the codes 0 to 7 of light from 0 to 1", 366, codes},
      {"viewport", "02_sphere", "A camera, its film of 4 by 3 pixels, and the rays through their centers",
       400, viewport},
      {"backwards", "introduction", "Rays from a lamp, few of which reach the eye, and rays from the eye",
       336, backwards},
      {"film_coordinates", "02_sphere", "Pixel coordinates beside the film coordinates u and v", 342,
       film_coordinates},
      {"field_of_view", "field_of_view", "Three fields of view and how large a sphere is in each picture",
       348, field_of_view},
      {"projections", "projections",
       "Rays of a perspective and of an orthographic camera to two equal spheres", 328, projections},
      {"ray_points", "02_sphere", "A ray with the points at t = −1, 0, 1, 2 and 3", 312, ray_points},
      {"sphere_crossings", "02_sphere", "Lines that cross a circle twice, touch it and miss it", 292,
       sphere_crossings},
      {"sphere_polynomial", "02_sphere", "Three parabolas over t with two roots, one and none", 352,
       sphere_polynomial},
      {"roots_behind", "02_sphere", "A ray that starts before a sphere, inside it and beyond it", 430,
       roots_behind},
      {"interval", "02_sphere", "Crossings along a ray, and those in its open interval", 280, ray_interval},
  };
}

}  // namespace figures
