// Figures of the pages beside the stages: history, field of view, lights, exposure, sRGB, threads, glass.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <protostar/encode.hpp>
#include <protostar/image.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/light.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/tone.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "scenes/three_spheres.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

void history(Drawing& drawing) {
  const auto x_of = [](int year) { return 60 + 530.0 * (year - 1966) / 32; };
  drawing.arrow({x_of(1966), 150}, {x_of(1998), 150}, Paint::ink);
  bool above = true;
  for (const auto& [year, who, what, paint] : {std::tuple{1968, "Appel", "shadows", Paint::blue},
                                               {1975, "Phong", "highlights", Paint::green},
                                               {1979, "Whitted", "mirrors, glass", Paint::blue},
                                               {1984, "Cook and others", "many rays a pixel", Paint::blue},
                                               {1986, "Kajiya", "all paths of light", Paint::blue},
                                               {1996, "Hart", "sphere tracing", Paint::blue}}) {
    const double x = x_of(year), y = above ? 46.0 : 206.0;
    const Anchor anchor = year == 1996 ? Anchor::end : year == 1968 ? Anchor::start : Anchor::middle;
    const double words_x = year == 1984 ? x - 20 : year == 1986 ? x + 26 : x;
    drawing.line({x, 150}, {x, above ? 100.0 : 188.0}, paint, Stroke::dashed);
    drawing.mark({x, 150}, paint);
    drawing.words({words_x, y}, std::to_string(year), anchor, paint, true);
    drawing.words({words_x, y + 22}, who, anchor, paint);
    drawing.words({words_x, y + 44}, what, anchor, Paint::ink);
    above = !above;
  }
  drawing.words({320, 290}, "blue: works that the tutorial names", Anchor::middle);
}

void film_tangent(Drawing& drawing) {
  constexpr double degrees = 75;
  constexpr int pixels = 16, chosen = 12;
  const Camera camera = Camera::perspective(Point{0}, {0, 0, 1}, {0, 1, 0}, degrees);
  // Seen from the side: forward to the right, up is up. The film stands at a distance of 1.
  const Sketch sketch(drawing, {90, 190}, 200, {.right = {0, 0, 1}});
  const auto on_film = [&](double v) { return camera.forward + v * camera.up; };
  sketch.line(on_film(1), on_film(-1), Paint::ink, Stroke::bold);
  for (int i = 0; i <= pixels; ++i) {
    const Point p = on_film(Camera::v_at(i, pixels));
    sketch.line(p, p + Vec3{0, 0, 0.05}, Paint::ink);
  }
  const Ray edge = camera(0, 1), ray = camera.through_pixel(0, chosen, 1, pixels);
  const double height = length(camera.up);  // of half the film
  expect(std::abs(edge.direction.y / edge.direction.z - height) < 1e-12, "film_tangent");
  sketch.line(Point{0}, on_film(1), Paint::red);
  sketch.line(Point{0}, on_film(-1), Paint::red);
  sketch.line(Point{0}, camera.forward, Paint::gray, Stroke::dashed);
  sketch.line(camera.forward, on_film(1), Paint::green, Stroke::bold);
  const Point tip = ray.at(1 / ray.direction.z);
  sketch.arrow(Point{0}, tip, Paint::blue, Stroke::bold);
  sketch.mark(tip, Paint::blue);
  sketch.mark(Point{0}, Paint::ink);
  sketch.angle(Point{0}, 0.3, camera.forward, edge.direction, Paint::red);
  sketch.words({0, 0.12, 0.34}, {0, 4}, "half of 75°", Paint::red);
  sketch.words({0, 0, 0.5}, {0, 20}, "1", Paint::gray, Anchor::middle);
  sketch.words(on_film(0.5), {20, 6}, joined({"tan(75°/2) = ", text_of(height)}), Paint::green);
  sketch.words(tip, {20, 0}, joined({"pixel ", std::to_string(chosen), " of ", std::to_string(pixels)}),
               Paint::blue);
  sketch.words(tip, {20, 24},
               joined({"v = ", text_of(Camera::v_at(chosen + 0.5, pixels)), ", at ", text_of(tip.y)}),
               Paint::blue);
  sketch.words(Point{0}, {-12, 6}, "eye", Paint::ink, Anchor::end);
}

void spot_share(Drawing& drawing) {
  constexpr double left = 70, right = 600, bottom = 270, top = 60;
  const auto at = [&](double degrees, double share) {
    return Place{left + (right - left) * (degrees + 45) / 90, bottom - (bottom - top) * share};
  };
  for (const double share : {0.0, 1.0}) {
    drawing.line(at(-45, share), at(45, share), Paint::gray, share == 0 ? Stroke::thin : Stroke::dashed);
    drawing.words({left - 10, at(0, share).y + 6}, text_of(share, 0), Anchor::end);
  }
  for (const auto& [fade, paint] : {std::pair{0.0, Paint::blue}, {15.0, Paint::red}}) {
    const Light light = SpotLight{
        .direction = {0, -1, 0}, .angle = 30, .power = Color{4 * std::numbers::pi_v<float>}, .fade = fade};
    std::vector<Place> points;
    for (int i = -450; i <= 450; ++i) {
      // At a distance of 1, this power would bring an irradiance of 1 without the cone.
      const Point p(at_angle(-90 + 0.1 * i));
      points.push_back(at(0.1 * i, light.perpendicular_irradiance(p).r));
    }
    drawing.polyline(points, paint, Stroke::bold);
  }
  for (const double degrees : {-30.0, -15.0, 0.0, 15.0, 30.0})
    drawing.words({at(degrees, 0).x, bottom + 24}, text_of(degrees, 0) + "°", Anchor::middle);
  drawing.words({left, 30}, "share of the light, in a cone of 30°");
  drawing.words({320, bottom + 50}, "angle from the axis", Anchor::middle);
  drawing.words({430, 30}, "fade 0", Anchor::start, Paint::blue);
  drawing.words({510, 30}, "fade 15", Anchor::start, Paint::red);
}

void tone_curves(Drawing& drawing) {
  constexpr float most = 4;  // the largest light of the picture
  constexpr double left = 70, right = 600, bottom = 290, top = 60;
  const auto at = [&](double light, double shown) {
    return Place{left + (right - left) * light / most, bottom - (bottom - top) * shown};
  };
  drawing.arrow({left, bottom}, {right + 20, bottom}, Paint::ink);
  drawing.arrow({left, bottom}, {left, top - 20}, Paint::ink);
  drawing.line(at(0, 1), at(most, 1), Paint::gray, Stroke::dashed);
  drawing.words({left - 10, at(0, 1).y + 6}, "1", Anchor::end);
  for (const auto& [name, exposure, tone, paint, y] :
       {std::tuple{"clip", 1.0, Tone::clip, Paint::red, 170.0},
        {"exposure 0.4, clip", 0.4, Tone::clip, Paint::green, 196.0},
        {"scale_image", 1.0, Tone::scale_image, Paint::blue, 222.0}}) {
    std::vector<Place> points;
    for (int i = 0; i <= 80; ++i) {
      const float light = most * static_cast<float>(i) / 80;
      Image image(2, 1);  // a pixel with this light, and the brightest one
      image(0, 0) = Color{light}, image(1, 0) = Color{most};
      expose(image, exposure);
      apply(tone, image);
      points.push_back(at(light, std::min(image(0, 0).r, 1.0f)));
    }
    drawing.polyline(points, paint, Stroke::bold);
    drawing.words({430, y + 20}, name, Anchor::start, paint);
  }
  for (int light = 0; light <= 4; ++light)
    drawing.words({at(light, 0).x, bottom + 24}, std::to_string(light), Anchor::middle);
  drawing.words({left + 12, 34}, "light as the file has it");
  drawing.words({320, bottom + 50}, "light L of the picture, whose brightest pixel has 4", Anchor::middle);
}

void srgb_dark(Drawing& drawing) {
  const Encoder srgb(Srgb{}, 255), gamma(Gamma{}, 255), linear(Linear{}, 255);
  constexpr double left = 70, right = 600, bottom = 290, top = 40, most_light = 0.01, most_code = 32;
  const auto at = [&](double light, double code) {
    return Place{left + (right - left) * light / most_light, bottom - (bottom - top) * code / most_code};
  };
  drawing.arrow({left, bottom}, {right + 20, bottom}, Paint::ink);
  drawing.arrow({left, bottom}, {left, top - 20}, Paint::ink);
  for (const auto& [encoder, paint, name, y] : {std::tuple{&linear, Paint::gray, "linear", 206.0},
                                                {&gamma, Paint::blue, "gamma 2.2", 232.0},
                                                {&srgb, Paint::red, "sRGB", 258.0}}) {
    std::vector<Place> points;
    for (int i = 0; i <= 400; ++i) {
      const double light = most_light * i / 400;
      points.push_back(at(light, (*encoder)(static_cast<float>(light))));
    }
    drawing.polyline(points, paint, Stroke::bold);
    drawing.words({470, y - 30}, name, Anchor::start, paint);
  }
  drawing.line(at(0.0031308, 0), at(0.0031308, 24), Paint::gray, Stroke::dashed);
  drawing.words({at(0.0031308, 24).x, at(0, 24).y - 8}, "0.0031308", Anchor::middle, Paint::gray);
  for (const int code : {0, 10, 20, 30})
    drawing.words({left - 10, at(0, code).y + 6}, std::to_string(code), Anchor::end);
  for (const double light : {0.0, 0.005, 0.01})
    drawing.words({at(light, 0).x, bottom + 24}, text_of(light, 3), Anchor::middle);
  drawing.words({left + 12, 30}, "code k of 255");
  drawing.words({320, bottom + 50}, "light L, the darkest hundredth", Anchor::middle);
}

/// Returns how many rays a tile of the picture of stage 09 takes: one for each pixel, and a shadow ray for
/// each pixel that sees a surface on the side of the light.
int rays_of_tile(int column, int row, int columns, int rows) {
  static const auto scene = three_spheres();
  constexpr int side = 16;
  int rays = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Ray ray = Camera{}.through_pixel(column * side + x, row * side + y, columns * side, rows * side);
      const auto hit = scene.intersect(ray);
      rays += hit && scene.lights()[0].irradiance(hit->point(), hit->facing_normal()).r > 0 ? 2 : 1;
    }
  return rays;
}

void threads(Drawing& drawing) {
  constexpr int columns = 8, rows = 6, count = 4;
  constexpr double size = 34;
  constexpr std::array<Paint, count> paints{Paint::blue, Paint::green, Paint::orange, Paint::red};
  double left = 24;
  for (const bool by_quarters : {true, false}) {
    drawing.words({left + size * columns / 2, 24},
                  by_quarters ? "a quarter for each thread" : "tile after tile", Anchor::middle, Paint::ink,
                  true);
    std::array<int, count> busy{};  // until when each thread works, in rays
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const auto free = std::min_element(busy.begin(), busy.end()) - busy.begin();
        const auto thread = by_quarters
                                ? static_cast<std::size_t>(2 * (row >= rows / 2) + (column >= columns / 2))
                                : static_cast<std::size_t>(free);
        busy[thread] += rays_of_tile(column, row, columns, rows);
        drawing.rectangle({left + size * column, 40 + size * row}, size, size, paints[thread], Fill::soft);
      }
    const int last = *std::max_element(busy.begin(), busy.end());
    for (std::size_t i = 0; i < count; ++i)
      drawing.rectangle({left, 264 + 22.0 * static_cast<double>(i)}, size * columns * busy[i] / 9000.0, 16,
                        paints[i], Fill::full);
    const double end = left + size * columns * last / 9000.0;
    drawing.line({end, 258}, {end, 354}, Paint::ink, Stroke::dashed);
    drawing.words({end, 376}, std::to_string(last) + " rays", Anchor::middle);
    left += 320;
  }
  drawing.words({320, 404}, "bars: how long each thread works; the picture is ready at the dashed line",
                Anchor::middle);
}

void opacity(Drawing& drawing) {
  const Ray ray{.origin = {0, 0, 0}, .direction = {1, 0, 0}};
  const std::array<std::pair<Sphere, Color>, 2> balls{
      {{{.center = {2.3, 0.1, 0}, .radius = 0.75}, {1, 0.3f, 0}},
       {{.center = {4.4, -0.1, 0}, .radius = 0.75}, {0.2f, 0.7f, 0.1f}}}};
  Scene<Sphere> scene;
  for (const auto& [sphere, color] : balls) scene.add(sphere, color);
  const Sketch sketch(drawing, {30, 96}, 92);
  for (const auto& [sphere, color] : balls)
    sketch.circle(sphere.center, sphere.radius, color.r > 0.5f ? Paint::orange : Paint::green);
  sketch.line(Point{0}, ray.at(6.4), Paint::ink);
  sketch.eye(Point{0}, ray.direction);
  std::vector<double> cuts{0.35};
  scene.crossings(ray, {}, [&](const auto& hit) { cuts.push_back(hit.t); });
  cuts.push_back(6.3);
  double y = 190;
  for (const float alpha : {0.0f, 0.25f, 0.5f, 1.0f}) {
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      Color light{1};
      scene.crossings(ray, {.min = (cuts[i] + cuts[i + 1]) / 2},
                      [&](const auto& hit) { light *= (1 - alpha) * Color{1} + alpha * hit.color(); });
      const Place from = sketch.of(ray.at(cuts[i])), to = sketch.of(ray.at(cuts[i + 1]));
      drawing.swatch({from.x, y}, to.x - from.x, 26, shown_color(light));
    }
    drawing.rectangle({sketch.of(ray.at(0.35)).x, y}, 92 * 5.95, 26, Paint::gray, Fill::none);
    drawing.words({sketch.of(ray.at(0.35)).x - 8, y + 19}, text_of(alpha, alpha == 0.25f ? 2 : 1),
                  Anchor::end);
    y += 36;
  }
  drawing.words({320, 356}, "left: the share α; the strips show the light on its way to the eye",
                Anchor::middle);
}

void parameter_space(Drawing& drawing) {
  // The eye and the viewport of scenes/discs.json, and a line from the eye through the viewport, not
  // normalized.
  const Ray ray{.origin = {0, 0, 0}, .direction = {0, 0, 1}};
  const Sketch sketch(drawing, {230, 130}, 110, {.right = {0, 0, 1}});
  sketch.line(ray.at(-1.7), ray.at(0), Paint::gray, Stroke::dashed);
  sketch.line(ray.at(0), ray.at(1), Paint::orange, Stroke::bold);
  sketch.arrow(ray.at(1), ray.at(3.5), Paint::green, Stroke::bold);
  sketch.line(ray.at(1) + Vec3{0, 0.5, 0}, ray.at(1) - Vec3{0, 0.5, 0}, Paint::ink, Stroke::bold);
  for (const auto& [z, paint] : {std::pair{-1.1, Paint::gray}, {0.5, Paint::orange}, {2.2, Paint::green}}) {
    const Sphere sphere{.center = {0, 0.1, z}, .radius = 0.3};
    sketch.circle(sphere.center, sphere.radius, paint);
    for (const double t : roots_of(sphere, ray)) {
      expect((t > 1) == (z > 1) && (t < 0) == (z < 0), "parameter_space");
      sketch.mark(ray.at(t), paint, t > 1 ? Fill::full : Fill::none);
    }
  }
  sketch.eye(Point{0}, ray.direction);
  sketch.words(ray.at(0), {-9, -16}, "eye", Paint::ink, Anchor::middle);
  sketch.words(ray.at(1), {0, -64}, "viewport", Paint::ink, Anchor::middle);
  sketch.words(ray.at(0), {0, 74}, "t = 0", Paint::ink, Anchor::middle);
  sketch.words(ray.at(1), {0, 74}, "t = 1", Paint::ink, Anchor::middle);
  sketch.words(ray.at(-1.1), {0, 110}, "t < 0: behind", Paint::gray, Anchor::middle);
  sketch.words(ray.at(0.5), {0, 110}, "between", Paint::orange, Anchor::middle);
  sketch.words(ray.at(2.2), {0, 110}, "t > 1: the scene", Paint::green, Anchor::middle);
}

/// Shows the spheres of scenes/discs.json and the edges of the view, from above and from the right.
void discs_plan(Drawing& drawing) {
  const Camera camera = Camera::viewport(Point{0}, {0, 0, 1}, {0, 1, 0}, 1, 1, 1);
  double middle = 170;
  for (const bool is_above : {true, false}) {
    const Camera from = is_above ? Camera{.right = {1, 0, 0}, .up = {0, 0, 1}} : Camera{.right = {0, 0, 1}};
    const Sketch sketch(drawing, is_above ? Place{middle, 316} : Place{middle - 130, 180}, 50, from);
    drawing.words({middle, 24}, is_above ? "from above" : "from the right", Anchor::middle, Paint::ink, true);
    for (const auto& [center, paint] : {std::pair{Point{0, -1, 3}, Paint::red},
                                        {Point{2, 0, 4}, Paint::blue},
                                        {Point{-2, 0, 4}, Paint::green}}) {
      const Sphere sphere{.center = center, .radius = 1};
      expect(sphere.intersect(Ray{.origin = {0, 0, 0}, .direction = center}, {.min = 1}).has_value(),
             "discs_plan");
      sketch.circle(sphere.center, sphere.radius, paint);
    }
    const auto at_edge = [&](double edge) { return is_above ? camera(edge, 0) : camera(0, edge); };
    for (const double edge : {-1.0, 1.0}) {
      const Ray ray = at_edge(edge);
      sketch.line(Point{0}, ray.at((5.2 - ray.origin.z) / ray.direction.z), Paint::gray, Stroke::dashed);
    }
    const Point corner = at_edge(1).origin;
    sketch.line(corner, at_edge(-1).origin, Paint::orange, Stroke::bold);
    const Place eye = sketch.of(Point{0});
    drawing.mark(eye, Paint::ink);
    drawing.words({eye.x, eye.y + 26}, "eye", Anchor::middle);
    sketch.words(corner, is_above ? Place{8, 6} : Place{0, -10}, "viewport", Paint::orange,
                 is_above ? Anchor::start : Anchor::middle);
    middle += 310;
  }
}

void sphere_mesh(Drawing& drawing) {
  constexpr int sides = 8;
  double middle = 160;
  for (const bool is_mesh : {false, true}) {
    const Sketch sketch(drawing, {middle, 180}, 110);
    const Sphere sphere{.center = {0, 0, 0}, .radius = 1};
    drawing.words({middle, 24}, is_mesh ? "a mesh of it" : "the sphere", Anchor::middle, Paint::ink, true);
    std::vector<Point> corners;
    corners.reserve(sides);
    for (int i = 0; i < sides; ++i) corners.push_back(Point(at_angle(360.0 * (i + 0.5) / sides)));
    if (is_mesh) {
      sketch.circle(sphere.center, 1, Paint::gray, Fill::none, Stroke::dashed);
      sketch.polygon(corners, Paint::blue);
      for (const Point& corner : corners) sketch.mark(corner, Paint::blue);
    } else {
      sketch.circle(sphere.center, 1, Paint::blue);
    }
    for (int i = 0; i < 16; ++i) {
      const Vec3 towards = at_angle(360.0 * (i + 0.5) / 16);
      const Ray ray{.origin = 2.0 * towards, .direction = -towards};
      Point hit = ray.at(sphere.intersect(ray).value());
      Vec3 normal = sphere.normal_at(hit);
      if (is_mesh) {
        // The side of the polygon that faces the ray: the plane through two corners, upright on the drawing.
        const Point &a = corners[static_cast<std::size_t>((i / 2 + sides - 1) % sides)],
                    &b = corners[static_cast<std::size_t>(i / 2)];
        const Plane side{.normal = cross(b - a, Vec3{0, 0, 1}),
                         .distance = dot(cross(b - a, Vec3{0, 0, 1}), a)};
        const Plane next{
            .normal = cross(corners[static_cast<std::size_t>((i / 2 + 1) % sides)] - b, Vec3{0, 0, 1}),
            .distance =
                dot(cross(corners[static_cast<std::size_t>((i / 2 + 1) % sides)] - b, Vec3{0, 0, 1}), b)};
        const double t_side = side.intersect(ray).value(), t_next = next.intersect(ray).value();
        const Plane& met = t_side > t_next ? side : next;  // a convex polygon is entered through the last one
        hit = ray.at(std::max(t_side, t_next));
        normal = met.normal_at(hit);
        if (dot(normal, towards) < 0) normal = -normal;
      }
      sketch.arrow(hit, hit + 0.3 * normal, Paint::green);
    }
    middle += 320;
  }
  drawing.words({320, 350}, "green: normals; on the mesh, each side has one", Anchor::middle);
}

/// Shows how high a thing of height 1 is in the picture, at distances from 1 to 8.
void projected_height(Drawing& drawing) {
  const Camera eye = Camera::perspective(Point{0}, {0, 0, 1}, {0, 1, 0}, 90);
  const Camera plan = Camera::orthographic(Point{0}, {0, 0, 1}, {0, 1, 0}, 2);
  const auto at = [](double distance, double height) {
    return Place{70 + 66 * distance, 290 - 220 * height};
  };
  std::vector<Place> perspective, orthographic;
  for (int i = 0; i <= 70; ++i) {
    const double distance = 1 + 0.1 * i;
    for (const bool is_plan : {false, true}) {
      const double v = is_plan ? 1 : 1 / distance;
      const Ray ray = (is_plan ? plan : eye)(0, v);
      expect(std::abs(ray.at((distance - ray.origin.z) / ray.direction.z).y - 1) < 1e-12, "projected_height");
      (is_plan ? orthographic : perspective).push_back(at(distance, v));
    }
  }
  drawing.arrow(at(0, 0), at(8.3, 0), Paint::ink);
  drawing.arrow(at(0, 0), at(0, 1.15), Paint::ink);
  for (const double height : {0.5, 1.0}) {
    drawing.line(at(0, height), at(8, height), Paint::gray, Stroke::dashed);
    drawing.words({at(0, height).x - 10, at(0, height).y + 6}, text_of(height, 1), Anchor::end);
  }
  for (const double distance : {1.0, 2.0, 4.0, 8.0})
    drawing.words({at(distance, 0).x, 314}, text_of(distance, 0), Anchor::middle);
  drawing.polyline(perspective, Paint::blue, Stroke::bold);
  drawing.polyline(orthographic, Paint::orange, Stroke::bold);
  for (const double distance : {1.0, 2.0, 4.0, 8.0}) drawing.mark(at(distance, 1 / distance), Paint::blue);
  drawing.words({at(4.5, 0.88).x, at(4.5, 0.88).y}, "parallel rays", Anchor::start, Paint::orange);
  drawing.words({at(2.2, 0.52).x, at(2.2, 0.56).y}, "rays from one point: 1/z", Anchor::start, Paint::blue);
  drawing.words({320, 340}, "distance z of a thing of height 1", Anchor::middle);
  drawing.words({70, 26}, "its height in the picture");
}

/// Shows two panes of glass and two layers of paint, in both orders.
void paint_order(Drawing& drawing) {
  const Color orange{1, 0.3f, 0}, blue{0.1f, 0.3f, 1}, white{1};
  constexpr float alpha = 0.6f;
  double left = 36;
  for (const bool is_paint : {false, true}) {
    const auto over = [&](const Color& color, const Color& behind) {
      return is_paint ? alpha * color + (1 - alpha) * behind : ((1 - alpha) * white + alpha * color) * behind;
    };
    drawing.words({left + 134, 26}, is_paint ? "paint covers" : "glass is multiplied", Anchor::middle,
                  Paint::ink, true);
    std::vector<std::array<int, 3>> overlaps;
    for (const bool orange_first : {true, false}) {
      const Color &front = orange_first ? orange : blue, &back = orange_first ? blue : orange;
      drawing.swatch({left, 46}, 124, 124, shown_color(white));
      drawing.swatch({left + 12, 58}, 64, 64, shown_color(over(back, white)));
      drawing.swatch({left + 48, 94}, 64, 64, shown_color(over(front, white)));
      overlaps.push_back(shown_color(over(front, over(back, white))));
      drawing.swatch({left + 48, 94}, 28, 28, overlaps.back());
      drawing.rectangle({left, 46}, 124, 124, Paint::gray, Fill::none);
      drawing.words({left + 62, 196}, orange_first ? "orange in front" : "blue in front", Anchor::middle);
      left += 144;
    }
    expect((overlaps[0] == overlaps[1]) == !is_paint, "paint_order");
    left += 16;
  }
}

/// Shows two threads that take the next tile, in two steps each and in one.
void next_tile(Drawing& drawing) {
  const auto step = [&](double x, double y, double width, const std::string& text, Paint paint) {
    drawing.rectangle({x, y}, width, 34, paint, Fill::soft);
    drawing.words({x + width / 2, y + 23}, text, Anchor::middle, paint);
  };
  double top = 20;
  for (const bool is_atomic : {false, true}) {
    drawing.words({20, top + 8},
                  is_atomic ? "an atomic number: reads and adds in one step" : "an int: reads, then writes",
                  Anchor::start, Paint::ink, true);
    int next = 7;
    drawing.words({20, top + 46}, "thread A");
    drawing.words({20, top + 88}, "thread B");
    if (is_atomic) {
      for (const bool is_b : {false, true}) {
        const int tile = next++;
        step(is_b ? 270 : 120, top + (is_b ? 65 : 23), 140,
             joined({"reads ", std::to_string(tile), ", adds 1"}), is_b ? Paint::orange : Paint::blue);
      }
    } else {
      const int a = next, b = next;
      step(120, top + 23, 90, joined({"reads ", std::to_string(a)}), Paint::blue);
      step(230, top + 65, 90, joined({"reads ", std::to_string(b)}), Paint::orange);
      next = a + 1;
      step(340, top + 23, 90, joined({"writes ", std::to_string(next)}), Paint::blue);
      next = b + 1;
      step(450, top + 65, 90, joined({"writes ", std::to_string(next)}), Paint::orange);
    }
    expect(next == (is_atomic ? 9 : 8), "next_tile");
    drawing.words({120, top + 128},
                  joined({"next is ", std::to_string(next),
                          is_atomic ? ": tiles 7 and 8 are drawn once each" : ": both threads draw tile 7"}),
                  Anchor::start, is_atomic ? Paint::green : Paint::red);
    top += 160;
  }
  drawing.arrow({120, top}, {600, top}, Paint::gray);
  drawing.words({600, top + 24}, "time", Anchor::end, Paint::gray);
}

}  // namespace

std::vector<StageFigure> topic_figures() {
  return {
      {"history", "introduction", "Years of ray tracing, from Appel in 1968 to Hart in 1996", 306, history},
      {"film_tangent", "field_of_view",
       "An eye, a film of 16 pixels at distance 1, and the ray of one of them", 380, film_tangent},
      {"parameter_space", "field_of_view", "A line from the eye through the viewport, and what counts on it",
       256, parameter_space},
      {"discs_plan", "field_of_view",
       "Three spheres and the edges of the view, from above and from the right", 356, discs_plan},
      {"sphere_mesh", "17_mesh", "A sphere and a mesh of eight sides, with their normals", 366, sphere_mesh},
      {"spot_share", "lights", "The share of a spotlight's light by the angle from its axis", 336,
       spot_share},
      {"tone_curves", "exposure", "Curves of clipping, of less exposure and of scaling", 356, tone_curves},
      {"srgb_dark", "srgb", "Codes of the darkest light, linear, with gamma and in sRGB", 356, srgb_dark},
      {"threads", "parallelism", "Tiles of a picture shared by four threads, and how long each works", 420,
       threads},
      {"projected_height", "projections", "The height of a thing in the picture against its distance", 356,
       projected_height},
      {"paint_order", "opacity", "Two panes of glass and two layers of paint, in both orders", 216,
       paint_order},
      {"next_tile", "parallelism",
       "Two threads that take the next tile from an int and from an atomic number", 380, next_tile},
      {"opacity", "opacity", "Light through two balls for four values of the share α", 372, opacity},
  };
}

}  // namespace figures
