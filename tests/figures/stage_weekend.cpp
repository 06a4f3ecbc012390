// Figures of stage 26: a tree of boxes around the balls, and how blurred mirrors spread light.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <protostar/sampling/glossy_lobes.hpp>
#include <protostar/sampling/sobol_sampler.hpp>
#include <protostar/sampling/warp.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "figures.hpp"
#include "scenes/weekend.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Balls from above, in boxes that are halved along their longer side; a ray asks those that it meets.
class TreeFromAbove {
 public:
  TreeFromAbove(const Sketch& sketch, const Ray& ray) : sketch_(sketch), ray_(ray) {}

  void add(std::vector<Sphere> balls, int depth) {
    Point low{1e9, 1e9, 0}, high{-1e9, -1e9, 0};
    for (const Sphere& ball : balls) {
      low = {std::min(low.x, ball.center.x - ball.radius), std::min(low.y, ball.center.z - ball.radius), 0};
      high = {std::max(high.x, ball.center.x + ball.radius), std::max(high.y, ball.center.z + ball.radius),
              0};
    }
    ++boxes;
    const bool is_met = meets(low, high);
    if (depth == 0 || !is_met) {
      sketch_.polygon({low, {high.x, low.y, 0}, high, {low.x, high.y, 0}},
                      is_met ? Paint::orange : Paint::gray);
      for (const Sphere& ball : balls)
        sketch_.circle({ball.center.x, ball.center.z, 0}, ball.radius, is_met ? Paint::orange : Paint::gray,
                       is_met ? Fill::full : Fill::none);
      if (is_met) asked += balls.size();
      return;
    }
    const bool is_wide = high.x - low.x > high.y - low.y;
    std::sort(balls.begin(), balls.end(), [&](const Sphere& a, const Sphere& b) {
      return is_wide ? a.center.x < b.center.x : a.center.z < b.center.z;
    });
    const auto middle = balls.begin() + static_cast<std::ptrdiff_t>(balls.size() / 2);
    add({balls.begin(), middle}, depth - 1);
    add({middle, balls.end()}, depth - 1);
  }

  std::size_t boxes = 0, asked = 0;

 private:
  [[nodiscard]] bool meets(const Point& low, const Point& high) const {
    double enters = 0, leaves = 1e9;
    for (const int axis : {0, 1}) {
      const double t1 = (low[axis] - ray_.origin[axis]) / ray_.direction[axis];
      const double t2 = (high[axis] - ray_.origin[axis]) / ray_.direction[axis];
      enters = std::max(enters, std::min(t1, t2));
      leaves = std::min(leaves, std::max(t1, t2));
    }
    return enters <= leaves;
  }

  const Sketch& sketch_;
  Ray ray_;
};

void ball_tree(Drawing& drawing) {
  std::vector<Sphere> balls;
  const auto add = [&](const Sphere& ball, const auto&...) {
    if (ball.radius < 1) balls.push_back(ball);
  };
  weekend_balls(add, add, add);
  const Sketch sketch(drawing, {320, 215}, 17);
  const Ray ray{.origin = {-12.5, 6.5, 0}, .direction = normalize(Vec3{1, -0.42, 0})};
  TreeFromAbove tree(sketch, ray);
  tree.add(balls, 7);
  expect(balls.size() > 400 && tree.asked < balls.size() / 4, "ball_tree");
  sketch.ray(ray, 26.5, Paint::blue, Stroke::bold);
  drawing.words({320, 436},
                joined({"the ray asks ", std::to_string(tree.boxes), " boxes and ",
                        std::to_string(tree.asked), " of ", std::to_string(balls.size()), " balls"}),
                Anchor::middle);
}

/// Shows which share of rays is within an angle of the mirrored one, for the book's fuzz and the lobe.
void fuzz_lobes(Drawing& drawing) {
  constexpr std::uint32_t samples = 4096;
  constexpr double fuzz = 0.3, most_degrees = 50;
  const GgxLobe lobe{.color = Color{1}, .roughness = weekend_roughness(fuzz)};
  std::vector<double> book, ggx;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const auto numbers = SobolSampler({.seed = 3, .x = 0, .y = 0, .sample = i, .samples = samples})(1);
    const Vec3 around = uniform_sphere(numbers[0], numbers[1]).direction;
    const auto degrees = [](const Vec3& v) {
      return std::acos(std::min(normalize(v).z, 1.0)) * 180 / std::numbers::pi;
    };
    book.push_back(degrees(Vec3{0, 0, 1} + fuzz * around));
    ggx.push_back(degrees(lobe.sample({0, 0, 1}, numbers[0], numbers[1]).direction));
  }
  const auto at = [&](double degree, double share) {
    return Place{80 + degree / most_degrees * 500, 270 - 230 * share};
  };
  drawing.line(at(0, 0), at(most_degrees, 0), Paint::ink);
  drawing.line(at(0, 0), at(0, 1), Paint::ink);
  drawing.line(at(0, 0.5), at(most_degrees, 0.5), Paint::gray, Stroke::dashed);
  for (const int degree : {0, 10, 20, 30, 40, 50})
    drawing.words({at(degree, 0).x, 292}, std::to_string(degree) + "°", Anchor::middle);
  drawing.words({70, at(0, 0.5).y + 5}, "half", Anchor::end);
  drawing.words({70, at(0, 1).y + 5}, "all", Anchor::end);
  for (auto* angles : {&book, &ggx}) {
    std::sort(angles->begin(), angles->end());
    std::vector<Place> places;
    for (std::size_t i = 0; i < angles->size(); i += 32)
      if ((*angles)[i] < most_degrees) places.push_back(at((*angles)[i], static_cast<double>(i) / samples));
    drawing.polyline(places, angles == &book ? Paint::blue : Paint::orange, Stroke::bold);
  }
  expect(std::abs(book[samples / 2] - ggx[samples / 2]) < 0.5, "fuzz_lobes");
  expect(book.back() < 18 && ggx.back() > 40, "fuzz_lobes");
  drawing.words({at(19, 0.92).x, at(0, 0.95).y}, "the book's fuzz", Anchor::start, Paint::blue);
  drawing.words({at(30, 0).x, at(0, 0.72).y}, "GGX: some go far away", Anchor::start, Paint::orange);
  drawing.words({330, 322}, "angle to the mirrored direction", Anchor::middle);
}

}  // namespace

std::vector<StageFigure> weekend_figures() {
  return {
      {"ball_tree", "26_weekend", "Balls from above, in a tree of boxes, and a ray that meets a few of them",
       450, ball_tree},
      {"fuzz_lobes", "26_weekend",
       "Shares of rays within an angle of the mirrored one, for two kinds of blur", 340, fuzz_lobes},
  };
}

}  // namespace figures
