// Figures of stages 23 and 24: free space, directions by their cosines, paths, and the roulette that ends
// them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <protostar/area_lights.hpp>
#include <protostar/integrators/ambient_occlusion.hpp>
#include <protostar/lobes.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/warp.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Returns the sampler of a sample, whose numbers are spread evenly over all samples.
SobolSampler sampler_of(std::uint32_t i, std::uint32_t samples) {
  return SobolSampler({.seed = 3, .x = 0, .y = 0, .sample = i, .samples = samples});
}

/// Returns the mean of AmbientOcclusionIntegrator at a hit.
double free_share(const auto& scene, const Intersection& hit, std::uint32_t samples = 4096) {
  double sum = 0;
  for (std::uint32_t i = 0; i < samples; ++i)
    sum += AmbientOcclusionIntegrator{}.shade(hit, scene, sampler_of(i, samples)).r;
  return sum / samples;
}

// ---- Stage 23

/// A floor with a roof on a wall, seen from the side. All go on far towards the viewer and away from them.
Scene<Plane, Box> shed() {
  Scene<Plane, Box> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{1});
  scene.add(Box{.min = {-4, 0, -100}, .max = {-3.5, 2, 100}}, Color{1});
  scene.add(Box{.min = {-3.5, 1.7, -100}, .max = {-0.7, 2, 100}}, Color{1});
  return scene;
}

void free_space(Drawing& drawing) {
  const auto scene = shed();
  const Sketch sketch(drawing, {350, 250}, 78);
  sketch.line({-4.2, 0, 0}, {3.6, 0, 0}, Paint::ink, Stroke::bold);
  sketch.polygon({{-4, 0, 0}, {-4, 2, 0}, {-0.7, 2, 0}, {-0.7, 1.7, 0}, {-3.5, 1.7, 0}, {-3.5, 0, 0}},
                 Paint::ink, Fill::soft);
  double before = 0;
  for (const double x : {-2.6, -0.4, 2.1}) {
    const auto hit = scene.intersect({.origin = {x, 0.5, 0}, .direction = {0, -1, 0}}, Interval{});
    for (int i = 0; i < 11; ++i) {
      const Ray ray = hit.value().leave(at_angle(15 + 15 * i));
      const auto met = scene.intersect(ray, Interval{});
      expect(met.has_value() == scene.occluded(ray, Interval{}), "free_space");
      if (met) {
        sketch.line(hit->point(), met->point(), Paint::red);
        sketch.mark(met->point(), Paint::red);
      } else {
        sketch.arrow(hit->point(), hit->point() + 1.35 * ray.direction, Paint::blue);
      }
    }
    sketch.mark(hit->point(), Paint::ink);
    const double share = free_share(scene, *hit, 65536);
    expect(share > before, "free_space");
    // Beside an edge, the free sky is above half an ellipse of the floor: page 23, Beside a wall.
    const auto beside = [&](double height) { return (x + 0.7) / std::hypot(x + 0.7, height); };
    expect(std::abs(share - (1 + std::min(beside(1.7), beside(2))) / 2) < 0.0005, "free_space");
    before = share;
    sketch.words({x, 0, 0}, {0, 26}, joined({text_of(100 * share, 0), " %"}), Paint::ink, Anchor::middle);
  }
  drawing.words({320, 304}, "share of the sky's light that arrives", Anchor::middle);
  drawing.words({350, 32}, "blue: free", Anchor::start, Paint::blue);
  drawing.words({490, 32}, "red: blocked", Anchor::start, Paint::red);
}

void beside_wall(Drawing& drawing) {
  // A wall of height 1 that goes on far to both sides. The disk below the free part of the hemisphere
  constexpr double angle = 50;
  const Sketch sketch(drawing, {150, 250}, 118);
  const double distance = 1 / std::tan(angle * std::numbers::pi / 180);
  sketch.line({-1.2, 0, 0}, {1.15, 0, 0}, Paint::ink, Stroke::bold);
  sketch.polygon({{distance, 0, 0}, {distance, 1, 0}, {distance + 0.12, 1, 0}, {distance + 0.12, 0, 0}},
                 Paint::ink, Fill::soft);
  sketch.line({}, {1.25 * distance, 1.25, 0}, Paint::gray, Stroke::dashed);
  sketch.curve([](double a) { return at_angle(a); }, angle, 180, Paint::blue, Stroke::bold, 60);
  sketch.curve([](double a) { return at_angle(a); }, 0, angle, Paint::red, Stroke::dashed, 30);
  const Vec3 edge = at_angle(angle);
  sketch.line(edge, {edge.x, 0, 0}, Paint::blue, Stroke::dashed);
  sketch.line({-1, 0.0, 0}, {edge.x, 0.0, 0}, Paint::blue, Stroke::bold);
  sketch.angle({}, 0.3, {1, 0, 0}, edge, Paint::ink);
  sketch.words(0.42 * at_angle(angle / 2), {0, 6}, "φ", Paint::ink, Anchor::middle);
  sketch.mark({}, Paint::ink);
  sketch.words({-0.2, 0, 0}, {0, 28}, "1 + cos φ", Paint::blue, Anchor::middle);
  sketch.words({distance, 1, 0}, {20, 6}, "wall", Paint::ink);
  sketch.words(at_angle(125), {-8, -8}, "free", Paint::blue, Anchor::end);
  // The curve over the distance, and what the integrator finds
  const Sketch plot(drawing, {360, 250}, 80);
  const auto at = [](double x, double share) { return Point{x, 2.4 * share, 0}; };
  plot.arrow(at(0, 0), at(3.3, 0), Paint::ink);
  plot.arrow(at(0, 0), at(0, 1.1), Paint::ink);
  plot.line(at(0, 1), at(3, 1), Paint::gray, Stroke::dashed);
  const auto share_at = [](double x) { return (1 + x / std::sqrt(1 + x * x)) / 2; };
  plot.curve([&](double x) { return at(x, share_at(x)); }, 0, 3, Paint::blue, Stroke::bold);
  Scene<Plane, Box> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{1});
  scene.add(Box{.min = {0, 0, -5000}, .max = {1, 1, 5000}}, Color{1});
  for (const double x : {0.25, 0.5, 1.0, 1.5, 2.0, 2.5}) {
    const auto hit = scene.intersect({.origin = {-x, 0.5, 0}, .direction = {0, -1, 0}}, Interval{});
    const double found = free_share(scene, hit.value());
    // The error of a share by n samples that are spread evenly is of the order of n^-3/4, here 1/512.
    expect(std::abs(found - share_at(x)) < 5.0 / 512, "beside_wall");
    plot.mark(at(x, found), Paint::orange);
  }
  plot.words(at(0, 1), {-8, 6}, "1", Paint::ink, Anchor::end);
  plot.words(at(0, 0.5), {-8, 6}, "½", Paint::ink, Anchor::end);
  plot.words(at(1.6, 0), {0, 26}, "distance / height of the wall", Paint::ink, Anchor::middle);
  drawing.words({370, 32}, "orange: the integrator", Anchor::start, Paint::orange);
}

// ---- Stage 24

/// A floor, a roof on a wall, and a lamp, seen from the side: a section of the yard.
Scene<Plane, Box, Sphere> section() {
  Scene<Plane, Box, Sphere> scene;
  scene.add(Plane{.normal = {0, 1, 0}, .distance = 0}, Color{0.7f});
  scene.add(Box{.min = {3, 0, -100}, .max = {3.3, 3, 100}}, Color{0.7f});
  scene.add(Box{.min = {0.6, 2, -100}, .max = {3, 2.2, 100}}, Color{0.7f});
  scene.add(Sphere{.center = {-0.9, 2.9, 0}, .radius = 0.25},
            Material{.diffuse = Color{0}, .emission = Color{20}});
  return scene;
}

void path_in_yard(Drawing& drawing) {
  const auto scene = section();
  const AreaLights lights(scene);
  const Sketch sketch(drawing, {300, 290}, 80);
  sketch.line({-3.4, 0, 0}, {3.9, 0, 0}, Paint::ink, Stroke::bold);
  sketch.polygon({{3, 0, 0}, {3.3, 0, 0}, {3.3, 3, 0}, {3, 3, 0}}, Paint::ink);
  sketch.polygon({{0.6, 2, 0}, {3, 2, 0}, {3, 2.2, 0}, {0.6, 2.2, 0}}, Paint::ink);
  const Point lamp{-0.9, 2.9, 0};
  sketch.circle(lamp, 0.25, Paint::orange, Fill::full);
  sketch.words(lamp, {-28, 6}, "lamp", Paint::orange, Anchor::end);
  // The path: from the eye to the wall under the roof, to the roof's lower side, to the floor in the light,
  // and into the sky. The directions are chosen; where they lead, the library finds.
  Ray ray{.origin = {-3, 1.3, 0}, .direction = normalize(Vec3{6, 0.1, 0})};
  sketch.eye(ray.origin, ray.direction);
  const std::array<Vec3, 3> onward{normalize(Vec3{-0.9, 0.55, 0}), normalize(Vec3{-2.7, -2, 0}),
                                   normalize(Vec3{-1.2, 1.9, 0})};
  std::array<bool, 3> is_lit{};
  for (std::size_t i = 0; i < onward.size(); ++i) {
    const auto hit = scene.intersect(ray, Interval{});
    const Point p = hit.value().point();
    sketch.arrow(ray.origin, p, Paint::blue, Stroke::bold);
    const auto met = scene.intersect(hit->leave(normalize(lamp - p)), Interval{});
    const Point end = met.value().point();
    is_lit[i] = lights.lights().front().is_hit(*met, 0);
    if (hit->height(lamp - p) > 0) {
      sketch.line(p, end, is_lit[i] ? Paint::orange : Paint::red, is_lit[i] ? Stroke::thin : Stroke::dashed);
      if (!is_lit[i]) sketch.cross(end, Paint::red);
    }
    sketch.mark(p, Paint::blue);
    static constexpr std::array<Place, 3> beside{Place{-8, 26}, Place{2, -24}, Place{4, 26}};
    sketch.words(p, beside[i], std::to_string(i + 1), Paint::blue, Anchor::middle);
    ray = hit->leave(onward[i]);
  }
  expect(!is_lit[0] && !is_lit[1] && is_lit[2], "path_in_yard");
  expect(!scene.occluded(ray, Interval{}), "path_in_yard");
  sketch.arrow(ray.origin, ray.origin + 2.6 * ray.direction, Paint::blue, Stroke::bold);
  sketch.words(ray.origin + 2.6 * ray.direction, {-10, 4}, "sky", Paint::blue, Anchor::end);
  drawing.words({30, 334}, "blue: the path", Anchor::start, Paint::blue);
  drawing.words({200, 334}, "orange: the lamp's light", Anchor::start, Paint::orange);
  drawing.words({450, 334}, "red: hidden", Anchor::start, Paint::red);
}

void raised_disk(Drawing& drawing) {
  // Left, from the side: equal strips of the disk, and the parts of the hemisphere above them
  const Sketch side(drawing, {165, 250}, 130);
  constexpr int strips = 10;
  const auto above = [](double x) { return Vec3{x, std::sqrt(std::max(0.0, 1 - x * x)), 0}; };
  for (int i = 0; i <= strips; ++i) {
    const double x = -1 + 2.0 * i / strips;
    side.line({x, 0, 0}, above(x), Paint::gray, Stroke::dashed);
  }
  for (int i = 0; i < strips; ++i) {
    const double left = -1 + 2.0 * i / strips, right = left + 2.0 / strips;
    const double from = std::acos(std::clamp(right, -1.0, 1.0)) * 180 / std::numbers::pi,
                 to = std::acos(std::clamp(left, -1.0, 1.0)) * 180 / std::numbers::pi;
    side.curve([](double a) { return at_angle(a); }, from, to, i % 2 == 0 ? Paint::red : Paint::orange,
               Stroke::bold, 16);
    side.line({left, 0, 0}, {right, 0, 0}, i % 2 == 0 ? Paint::red : Paint::orange, Stroke::bold);
    const Vec3 middle = above((left + right) / 2);
    side.arrow({}, 0.93 * middle, Paint::blue);
  }
  side.mark({}, Paint::ink);
  side.words({0, 0, 0}, {0, 28}, "equal strips of the floor", Paint::ink, Anchor::middle);
  drawing.words({165, 34}, "from the side", Anchor::middle, Paint::ink, true);
  // Right, from above: the directions that the library draws
  const Sketch plan(drawing, {475, 165}, 115);
  plan.circle({}, 1, Paint::ink, Fill::none);
  plan.circle({}, 0.5, Paint::gray, Fill::none, Stroke::dashed);
  constexpr std::uint32_t samples = 256;
  int inside = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const SampleSet<double> numbers = sampler_of(i, samples)(1);
    const Vec3 d = cosine_hemisphere(numbers[0], numbers[1]).direction;
    expect(std::abs(dot(d, d) - 1) < 1e-12 && d.z > 0, "raised_disk");
    if (d.x * d.x + d.y * d.y < 0.25) ++inside;
    const Place place = plan.of({d.x, d.y, 0});
    drawing.circle(place, 3, Paint::blue, Fill::full);
  }
  expect(std::abs(inside - 64) <= 4, "raised_disk");
  drawing.words({475, 34}, "from above", Anchor::middle, Paint::ink, true);
  drawing.words({475, 304}, joined({std::to_string(inside), " of 256 in the inner circle"}), Anchor::middle);
}

void two_densities(Drawing& drawing) {
  // Estimates of the light that white floor sends back under a white sky of radiance 1: cos θ/π over the
  // density, which is 1/(2π) for directions that are all equally likely.
  constexpr std::uint32_t samples = 64;
  const auto draw = [&](double y, const char* title, auto estimate) {
    const auto at = [y](std::uint32_t i, double value) {
      return Place{60 + 540.0 * (i + 0.5) / samples, y - 42 * value};
    };
    drawing.line(at(0, 0), at(samples - 1, 0), Paint::ink);
    double sum = 0;
    std::vector<Place> means;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const SampleSet<double> numbers = sampler_of(i, samples)(1);
      const double value = estimate(numbers[0], numbers[1]);
      sum += value;
      means.push_back(at(i, sum / (i + 1)));
      drawing.circle(at(i, value), 4, Paint::blue, Fill::full);
    }
    drawing.polyline(means, Paint::orange, Stroke::bold);
    for (const int value : {0, 1, 2})
      drawing.words({46, y - 42.0 * value + 6}, std::to_string(value), Anchor::end);
    drawing.words({60, y - 104}, title, Anchor::start, Paint::ink, true);
    return sum / samples;
  };
  const auto uniform = [](double u, double) { return 2 * (1 - u); };  // heights are equally likely
  const auto by_cosine = [](double u, double v) {
    const auto [direction, density] = cosine_hemisphere(u, v);
    return direction.z / std::numbers::pi / density;
  };
  // 64 heights, one in each 64th of the range, are off their mean by 1/64 · 2 at most.
  expect(std::abs(draw(136, "all directions equally likely", uniform) - 1) < 2.0 / 64, "two_densities");
  expect(std::abs(draw(290, "likely by the cosine", by_cosine) - 1) < 1e-12, "two_densities");
  drawing.words({150, 326}, "blue: estimates", Anchor::start, Paint::blue);
  drawing.words({350, 326}, "orange: their mean so far", Anchor::start, Paint::orange);
}

void roulette(Drawing& drawing) {
  constexpr std::uint32_t paths = 16;
  constexpr double full = 92, wide = 30;
  const auto row = [&](double y, const char* title) {
    drawing.line({48, y}, {48 + 34.0 * paths, y}, Paint::ink);
    drawing.words({48, y - full - 12}, title, Anchor::start, Paint::ink, true);
  };
  const auto bar = [&](double y, std::uint32_t i, double weight, Paint paint) {
    drawing.rectangle({50 + 34.0 * i, y - full * weight}, wide, full * weight, paint, Fill::soft);
  };
  constexpr double weight = 0.4, survival = 0.5;
  double before = 0, after = 0;
  row(136, "16 paths of weight 0.4");
  row(290, "half of them go on, with weight 0.8");
  for (std::uint32_t i = 0; i < paths; ++i) {
    bar(136, i, weight, Paint::blue);
    before += weight;
    const bool survives = sampler_of(i, paths)(1)[0] < survival;
    if (survives) {
      bar(290, i, weight / survival, Paint::orange);
      after += weight / survival;
    } else {
      drawing.cross({50 + 34.0 * i + wide / 2, 280}, Paint::gray);
    }
  }
  // Numbers that are spread evenly end exactly half of them.
  expect(std::abs(before - after) < 1e-12, "roulette");
  drawing.words({592, 32}, joined({"sum ", text_of(before, 1)}), Anchor::end, Paint::blue);
  drawing.words({592, 186}, joined({"sum ", text_of(after, 1)}), Anchor::end, Paint::orange);
}

}  // namespace

std::vector<StageFigure> path_tracing_figures() {
  return {
      {"free_space", "23_ambient_occlusion",
       "Three places on a floor, and the directions that are free there", 320, free_space},
      {"beside_wall", "23_ambient_occlusion",
       "The free part of the sky beside a wall, and its share by the distance of the wall", 290, beside_wall},
      {"path_in_yard", "24_path",
       "A path from the eye over three surfaces into the sky, with rays to the lamp", 350, path_in_yard},
      {"raised_disk", "24_path", "A disk whose even points are raised to the hemisphere above it", 320,
       raised_disk},
      {"two_densities", "24_path", "64 estimates with directions that are equally likely, and by the cosine",
       340, two_densities},
      {"roulette", "24_path", "16 paths, of which half go on with twice the weight", 310, roulette},
  };
}

}  // namespace figures
