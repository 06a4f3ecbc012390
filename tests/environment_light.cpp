#include <protostar/environment_light.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <protostar/protostar.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/chi_squared.hpp"
#include "support/light_truth.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// Returns a dim sky, brighter above, with a sun of one pixel.
EnvironmentImage sky_with_sun(int width = 32, int height = 16) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image(x, y) =
          y < height / 2 ? Color{0.2f, 0.3f, 0.5f} * (0.5f + 0.1f * static_cast<float>(x % 7)) : Color{0};
  image(width / 3, height / 4) = Color{2000, 1500, 1000};
  return {std::make_shared<const Image>(std::move(image))};
}

Scene<Sphere> scene_under(Texture environment) {
  Scene<Sphere> scene;
  scene.set_environment(std::move(environment));
  return scene;
}

/// Returns the integral of a function of directions, by midpoints of u and v, n across each of the cells.
double integral_over_sky(const auto& f, int columns, int rows, int n) {
  double whole = 0;
  const int w = columns * n, h = rows * n;
  for (int y = 0; y < h; ++y) {
    const double angle = std::numbers::pi * (y + 0.5) / h;
    const double area = 2 * std::sin(angle) * std::sin(std::numbers::pi / (2 * h)) * 2 * std::numbers::pi / w;
    double sum = 0;
    for (int x = 0; x < w; ++x) {
      const double turn = 2 * std::numbers::pi * ((x + 0.5) / w - 0.5);
      sum += f(Vec3{std::sin(angle) * std::sin(turn), std::cos(angle), std::sin(angle) * std::cos(turn)});
    }
    whole += sum * area;
  }
  return whole;
}

/// Returns light that is brighter below, and in a place between the middles of cells.
Color bright_spot(double u, double v) {
  return Color{to_float(0.1 * (1 + v) + (std::abs(u - 0.3) < 0.01 && std::abs(v - 0.3) < 0.01 ? 20 : 0))};
}

const Vec3 tilted_normal = normalize(Vec3{0.3, 0.9, -0.2});

/// Returns an estimate of the irradiance of a tilted surface by one direction.
Color irradiance_by(const DirectionAndDensity& drawn, const Texture& environment) {
  const double height = dot(drawn.direction, tilted_normal);
  if (!(height > 0)) return Color{0};
  return environment_radiance(environment, Ray{{}, drawn.direction}) * to_float(height / drawn.density);
}

}  // namespace

TEST_CASE("the density of directions to an environment integrates to 1, and is that of the samples") {
  struct Row {
    Texture environment;
    int columns, rows;
  };
  const auto row =
      GENERATE(Row{sky_with_sun(), 32, 16}, Row{sky_with_sun(5, 3), 5, 3}, Row{bright_spot, 256, 128});
  const EnvironmentLight light(scene_under(row.environment));
  const int n = row.columns > 100 ? 1 : 4;
  const double whole =
      integral_over_sky([&](const Vec3& d) { return light.density(d); }, row.columns, row.rows, n);
  // With u = 2^-53, sums of one row and over rows are off by u for each number, numbers by 20u. Heights from
  // 0 to 2 are off by 2u, their differences by 4u: more than that over the least one, of the rows at the
  // poles.
  const double least_height = 1 - std::cos(std::numbers::pi / row.rows);
  CHECK(std::abs(whole - 1) <= (n * (row.columns + row.rows) + 20 + 4 / least_height) * 0x1p-53);

  // Counts in cells of the image, but for those where next to nothing is expected.
  std::vector<double> expected(static_cast<std::size_t>(row.columns * row.rows));
  std::vector<int> counts(expected.size());
  const auto index = [&](const Vec3& d) {
    const Uv uv = direction_uv(d);
    const int x = std::clamp(static_cast<int>(uv.x * row.columns), 0, row.columns - 1);
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(uv.y * row.rows), 0, row.rows - 1) * row.columns + x);
  };
  constexpr int count = 20000;
  Random random(1);
  WrongCases wrong(random);
  for (int i = 0; i < count; ++i) {
    const auto [direction, density] = light.sample(random.interior(), random.interior());
    ++counts[index(direction)];
    wrong.add(!(std::abs(length(direction) - 1) <= 7.5 * 0x1p-53), direction);  // as in warp.cpp
    wrong.add(light.density(direction) != density, direction, density);
  }
  CHECK(wrong == 0);
  static_cast<void>(integral_over_sky(
      [&](const Vec3& d) {
        const double height = std::abs(d.y), step = std::numbers::pi / row.rows;
        const double angle = std::acos(height);
        const double area = 2 * std::sin(angle) * std::sin(step / 2) * 2 * std::numbers::pi / row.columns;
        expected[index(d)] = count * light.density(d) * area;
        return 0.0;
      },
      row.columns, row.rows, 1));
  const auto at = [](const auto& cells) {
    return [&](int i) { return static_cast<double>(cells[static_cast<std::size_t>(i)]); };
  };
  CHECK(chi_squared_over_bound(static_cast<int>(expected.size()), at(counts), at(expected)) < 1);
}

TEST_CASE("each direction from which light comes has a density, and none in the dark below") {
  const Texture environment = sky_with_sun();
  const EnvironmentLight light(scene_under(environment));
  Random random(2);
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 direction = random.direction();
    const bool is_lit = !is_black(environment_radiance(environment, Ray{{}, direction}));
    wrong.add(is_lit && !(light.density(direction) > 0), direction);
    // A dark row takes an eighth of the light of the row above it.
    wrong.add(direction.y < -0.3 && light.density(direction) > 0, "dark", direction);
  }
  for (const double x : {0.0, 1e-300, -1e-17, 1e-9})
    for (const double y : {1.0, -1.0})
      for (const double z : {0.0, 1e-300, -1e-17})
        wrong.add(!std::isfinite(light.density({x, y, z})), x, y, z);
  CHECK(wrong == 0);
}

TEST_CASE("a sky and an image of one color have no better places") {
  Scene<Sphere> sky, dark, black;
  sky.set_sky(Color{0.5f, 0, 0});
  black.set_sky(Color{0});
  const auto of_one_color = [](const Color& color) {
    Image image(4, 2);
    for (int i = 0; i < 8; ++i) image(i % 4, i / 4) = color;
    return scene_under(EnvironmentImage{std::make_shared<const Image>(image)});
  };
  for (const auto& scene : {sky, dark, black, of_one_color(Color{2}), of_one_color(Color{0}),
                            scene_under([](double, double) { return Color{2}; })}) {
    const EnvironmentLight light(scene);
    CHECK(!light.has_places());
  }
  // Where a function is looked at it may be black, and bright elsewhere.
  const EnvironmentLight hidden(scene_under([](double u, double) { return Color{u == 0.1 ? 1.0f : 0.0f}; }));
  // With u = 2^-53, a cell's share is a difference of sums, off by u of all 256 cells of its row, and the
  // row's by u of all, 2 s of a height; heights are off by 4u (see above).
  const double s = std::sqrt(1 - tilted_normal.y * tilted_normal.y) * std::sin(std::numbers::pi / 256);
  CHECK(std::abs(hidden.density(tilted_normal) / uniform_sphere_density - 1) <= (256 + 3 / s + 20) * 0x1p-53);
}

TEST_CASE("a pixel that is no light has the cells of a black one") {
  const auto with_pixel = [](const Color& color) {
    Image image(8, 4);
    for (int i = 0; i < 32; ++i) image(i % 8, i / 8) = Color{1};
    image(5, 1) = Color{30};
    image(6, 1) = color;
    return EnvironmentLight(scene_under(EnvironmentImage{std::make_shared<const Image>(image)}));
  };
  const EnvironmentLight black = with_pixel(Color{0});
  CHECK(black.has_places());
  for (const float number :
       {-20.0f, -1000.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    const EnvironmentLight light = with_pixel({1, number, 1});
    Random random(5);
    WrongCases wrong(random);
    for (int i = 0; i < 500; ++i) {
      const Vec3 direction = random.direction();
      const double expected = black.density(direction);
      wrong.add(!(expected > 0 && light.density(direction) == expected), direction);
      const double u = random.interior(), v = random.interior();
      wrong.add(light.sample(u, v).direction != black.sample(u, v).direction, u, v);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a nearly even environment has no better places, as long as the cosine varies less on average") {
  // Radiance 1 + k in the upper half of the directions and 1 − k in the lower has ⟨L²⟩ = 1 + k² and ⟨L⟩ = 1;
  // and a bright cap of the share s alone, ⟨L²⟩/⟨L⟩² = 1/s.
  const auto halves = [](double k) {
    return EnvironmentLight(
        scene_under([=](double, double v) { return Color{to_float(v < 0.5 ? 1 + k : 1 - k)}; }));
  };
  CHECK(!halves(0.5).has_places());
  CHECK(!halves(1).has_places());
  // Both are alike for s = 3/8: 53 of the 128 rows are less, of the share (1 − cos 53π/128)/2, and 54 are
  // more.
  const auto cap = [](int rows) {
    return EnvironmentLight(
        scene_under([=](double, double v) { return Color{128 * v < rows ? 1.0f : 0.0f}; }));
  };
  CHECK(cap(53).has_places());
  CHECK(!cap(54).has_places());
}

TEST_CASE(
    "the irradiance by a sky with a small sun is that of quadrature, with far less noise than by the "
    "cosine") {
  struct Row {
    Texture environment;
    int columns, rows, steps;
    double gain;  ///< least ratio of the variances
  };
  const auto row = GENERATE(Row{sky_with_sun(), 32, 16, 16, 100}, Row{bright_spot, 500, 500, 1, 4});
  const EnvironmentLight light(scene_under(row.environment));
  const double truth = integral_over_sky(
      [&](const Vec3& d) {
        const double height = dot(d, tilted_normal);
        return height > 0 ? height * environment_radiance(row.environment, Ray{{}, d}).g : 0;
      },
      row.columns, row.rows, row.steps);
  LightTruth estimate;
  double square = 0, square_of_cosine = 0;
  for (int i = 0; i < 4; ++i)
    estimate.compare(
        Ray{},
        [&](const auto& sampler) {
          const SampleSet<double> numbers = sampler(1);
          const Color by_light = irradiance_by(light.sample(numbers[0], numbers[1]), row.environment);
          const Color by_cosine =
              irradiance_by(cosine_hemisphere(tilted_normal, numbers[0], numbers[1]), row.environment);
          square += (by_light.g - truth) * (by_light.g - truth);
          square_of_cosine += (by_cosine.g - truth) * (by_cosine.g - truth);
          return by_light;
        },
        truth, 128);
  CHECK(estimate.wrong == 0);
  CHECK(square_of_cosine > row.gain * square);
}
