#include <protostar/sampling/warp.hpp>
#include <protostar/sampling/warp_lanes.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/catch.hpp"
#include "support/chi_squared.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

constexpr double full_angle = 4 * std::numbers::pi;

/// Returns a local direction by its height and its azimuth.
Vec3 direction_at(double z, double azimuth) {
  const double r = std::sqrt((1 - z) * (1 + z));
  return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

/// Returns the integral of a density over all directions above a height, by midpoints of a grid with m
/// azimuths: few, where the density is a smooth function of the azimuth.
double integral(const auto& density, double from, int m) {
  constexpr int n = 2000, to = 1;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j)
      sum += density(direction_at(from + (to - from) * (i + 0.5) / n, 2 * std::numbers::pi * (j + 0.5) / m));
  return sum * (to - from) * 2 * std::numbers::pi / n / m;
}

/// Returns the solid angle per area of the unit square to which a map takes (u, v), times the density there,
/// less 1: 0 if the density is that of the map. Differences across 2e-5 have errors of 1e-9 in smooth places.
double jacobian_error(const auto& map, double u, double v) {
  constexpr double step = 1e-5;
  const Vec3 du = (map(u + step, v).direction - map(u - step, v).direction) / (2 * step);
  const Vec3 dv = (map(u, v + step).direction - map(u, v - step).direction) / (2 * step);
  const auto [direction, density] = map(u, v);
  return std::abs(dot(cross(du, dv), direction)) * density - 1;
}

/// Returns χ² of directions in cells of equal height and azimuth, against the integral of the density in each
/// cell.
double chi_squared_of(const auto& map, const auto& density, double lowest, std::uint64_t seed) {
  constexpr int heights = 8, azimuths = 12, count = 20000;
  std::vector<int> counts(heights * azimuths);
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const double u = random.interior(), v = random.interior();
    const Vec3 d = map(u, v).direction;
    const double turn = std::atan2(d.y, d.x) / (2 * std::numbers::pi);
    const int row = std::clamp(static_cast<int>((d.z - lowest) / (1 - lowest) * heights), 0, heights - 1);
    const int column = std::clamp(static_cast<int>((turn + 0.5) * azimuths), 0, azimuths - 1);
    ++counts[static_cast<std::size_t>(row * azimuths + column)];
  }
  std::vector<double> expected;
  for (int i = 0; i < heights * azimuths; ++i) {
    double sum = 0;
    constexpr int n = 40, m = 4;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < m; ++b)
        sum +=
            density(direction_at(lowest + (1 - lowest) * (i / azimuths + (a + 0.5) / n) / heights,
                                 2 * std::numbers::pi * ((i % azimuths + (b + 0.5) / m) / azimuths - 0.5)));
    expected.push_back(count * sum * (1 - lowest) * 2 * std::numbers::pi / (heights * azimuths * n * m));
  }
  // Cells with few expected directions are one.
  double rest = 0, rest_expected = 0, sum = 0;
  int cells = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] < 10) {
      rest += counts[i], rest_expected += expected[i];
      continue;
    }
    sum += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i], ++cells;
  }
  if (rest_expected > 10) sum += (rest - rest_expected) * (rest - rest_expected) / rest_expected, ++cells;
  return sum / chi_squared_bound(cells - 1);
}

/// Checks that a density integrates to 1, and that a map draws directions with it.
void check_map(const auto& map, const auto& density, double lowest, std::uint64_t seed) {
  CHECK(std::abs(integral(density, lowest, 4) - 1) < 3e-5);
  CHECK(chi_squared_of(map, density, lowest, seed) < 1);
  Random random(seed);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const double u = random.real(0.01, 0.99), v = random.real(0.01, 0.99);
    // The concentric map bends at the diagonals, and differences must not reach across.
    if (std::abs(u - v) < 1e-4 || std::abs(u + v - 1) < 1e-4) continue;
    const auto [direction, value] = map(u, v);
    wrong.add(std::abs(length(direction) - 1) > 4e-16, "length", u, v);
    wrong.add(std::abs(value / density(direction) - 1) > 1e-12, "density", u, v, value, density(direction));
    wrong.add(std::abs(jacobian_error(map, u, v)) > 1e-5, "Jacobian", u, v, jacobian_error(map, u, v));
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("a frame is orthonormal and right-handed for every normal") {
  Random random(1);
  WrongCases wrong(random);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 n = random.direction();
    // Close to the z axis, in both directions, down to the smallest numbers.
    if (i % 2 == 0)
      n = {std::exp2(random.real(-1060, -1)), std::exp2(random.real(-1060, -1)), i % 4 == 0 ? -1.0 : 1.0};
    if (i % 2 == 0) n.z *= std::sqrt(1 - n.x * n.x - n.y * n.y);
    const auto [x, y, z] = frame_around(n);
    const double error = std::max({std::abs(dot(x, x) - 1), std::abs(dot(y, y) - 1), std::abs(dot(x, y)),
                                   std::abs(dot(x, z)), std::abs(dot(y, z)), length(cross(x, y) - z)});
    most = std::max(most, error * 0x1p53);
    wrong.add(z != n, n);
  }
  CHECK(wrong == 0);
  CHECK(most < 16);
}

TEST_CASE("a frame is a continuous function of its normal, but at one place") {
  Random random(2);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 n = random.direction(), m = normalize(n + 1e-6 * random.direction());
    // Its derivative is that of the azimuth, 1 over the distance from (0, 0, −1), at most.
    const double most = 4e-6 / length(n - Vec3{0, 0, -1});
    wrong.add(length(frame_around(n).x - frame_around(m).x) > most, n, m);
    wrong.add(length(frame_around(n).y - frame_around(m).y) > most, n, m);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a frame turns local directions, and turns them back") {
  const Frame frame = frame_around(normalize(Vec3{1, -2, 0.5}));
  CHECK(frame({0, 0, 1}) == frame.z);
  CHECK(length(frame.local(frame({0.1, 0.2, 0.3})) - Vec3{0.1, 0.2, 0.3}) < 1e-15);
  CHECK(frame_around({0, 0, -1}).x == Vec3{1, 0, 0});
}

TEST_CASE("the concentric map takes squares around the center to circles, and keeps areas") {
  CHECK(concentric_disk(0.5, 0.5) == Uv{0, 0});
  Random random(3);
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const double u = random.real(0, 1), v = random.real(0, 1), step = 1e-6;
    const Uv p = concentric_disk(u, v);
    const double ring = 2 * std::max(std::abs(u - 0.5), std::abs(v - 0.5));
    wrong.add(std::abs(std::sqrt(p.x * p.x + p.y * p.y) - ring) > 1e-15, u, v);
    if (std::abs(u - v) < 1e-5 || std::abs(u + v - 1) < 1e-5 || ring < 1e-3) continue;
    const Uv du = concentric_disk(u + step, v) - concentric_disk(u - step, v),
             dv = concentric_disk(u, v + step) - concentric_disk(u, v - step);
    const double area = std::abs(du.x * dv.y - du.y * dv.x) / (4 * step * step);
    wrong.add(std::abs(area / std::numbers::pi - 1) > 1e-6, u, v, area);
  }
  CHECK(wrong == 0);
}

TEST_CASE("directions of a cosine-weighted hemisphere have the density cos θ/π") {
  check_map([](double u, double v) { return cosine_hemisphere(u, v); },
            [](const Vec3& d) { return cosine_density(d.z); }, 0, 4);
  const Vec3 normal = normalize(Vec3{1, 2, -2});
  const auto [direction, density] = cosine_hemisphere(normal, 0.3, 0.6);
  CHECK(std::abs(density - dot(direction, normal) / std::numbers::pi) < 1e-15);
  CHECK(cosine_density(-0.5) == 0);
}

TEST_CASE("a cosine-weighted direction at the horizon has a cosine with digits") {
  // u = 2^-40: r = 1 − 2^-39, and cos θ = √((1 − r)(1 + r)).
  const Vec3 d = cosine_hemisphere(0x1p-40, 0.5).direction;
  CHECK(std::abs(d.z / std::sqrt(0x1p-38 * (1 - 0x1p-40)) - 1) < 1e-15);
}

TEST_CASE("directions of a uniform sphere have the density 1/4π") {
  check_map([](double u, double v) { return uniform_sphere(u, v); },
            [](const Vec3&) { return uniform_sphere_density; }, -1, 5);
  CHECK(uniform_sphere_density * full_angle == 1);
}

TEST_CASE("directions of a power of the cosine have the density (n + 1)/2π · cosⁿ α") {
  for (const double exponent : {0.0, 1.0, 7.5, 40.0}) {
    CAPTURE(exponent);
    const CosinePower lobe{exponent};
    check_map([&](double u, double v) { return lobe.sample(u, v); },
              [&](const Vec3& d) { return lobe.density(d.z); }, 0, 6);
  }
  CHECK(CosinePower{3}.density(-0.1) == 0);
  CHECK(CosinePower{3}.density(0) == 0);
}

TEST_CASE("a direction of a sharp lobe has digits") {
  if (!long_double_judges()) return;
  const double u = 0.5, v = 0.8125;  // r = 0.625
  for (const double exponent : {1e3, 1e6, 1e9, 1e12}) {
    CAPTURE(exponent);
    const Vec3 d = CosinePower{exponent}.sample(u, v).direction;
    const long double log = std::log1p(-0.625L * 0.625L) / (static_cast<long double>(exponent) + 1);
    const double sine = static_cast<double>(std::sqrt(-std::expm1(2 * log)));
    CHECK(std::abs(std::sqrt(d.x * d.x + d.y * d.y) / sine - 1) <
          0x1p-57 * exponent + 1e-15);  // sin² is about 1/exponent
  }
}

TEST_CASE("maps in lanes have the bits that each pair of numbers has alone") {
  using simd::Doubles;
  Random random(10);
  WrongCases wrong(random);
  for (int i = 0; i < 10000; ++i) {
    // Now and then both are on a diagonal of the square, or in its center.
    const Doubles u = Doubles::of_each([&](int) { return i % 5 == 0 ? 0.5 : random.interior(); });
    const Doubles v = i % 7 == 0 ? u : Doubles::of_each([&](int) { return random.interior(); });
    const auto [x, y] = simd::concentric_disk(u, v);
    const simd::Vectors directions = simd::cosine_hemisphere(u, v);
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      wrong.add(Uv{x[lane], y[lane]} != concentric_disk(u[lane], v[lane]), u[lane], v[lane]);
      wrong.add(directions[lane] != cosine_hemisphere(u[lane], v[lane]).direction, u[lane], v[lane]);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("visible normals of GGX have the density that a viewer sees") {
  for (const double roughness : {0.3, 0.7, 1.0})
    for (const double z : {1.0, 0.7, 0.2}) {
      CAPTURE(roughness, z);
      const VisibleNormals normals{.to_viewer = direction_at(z, 1), .roughness = roughness};
      const auto density = [&](const Vec3& d) { return normals.density(d); };
      CHECK(std::abs(integral(density, 0, 64) - 1) < 3e-4);
      CHECK(chi_squared_of([&](double u, double v) { return normals.sample(u, v); }, density, 0, 7) < 1);
      Random random(8);
      WrongCases wrong(random);
      for (int i = 0; i < 1000; ++i) {
        const double u = random.real(0.01, 0.99), v = random.real(0.01, 0.99);
        const auto map = [&](double a, double b) { return normals.sample(a, b); };
        wrong.add(std::abs(jacobian_error(map, u, v)) > 1e-5, u, v, jacobian_error(map, u, v));
        // A direction mirrored at the normal has the density of both.
        const auto reflected = [&](double a, double b) -> DirectionAndDensity {
          const Vec3 n = normals.sample(a, b).direction;
          const Vec3 d = 2 * dot(normals.to_viewer, n) * n - normals.to_viewer;
          return {d, normals.reflected_density(d)};
        };
        // Mirrored below the surface, it has a normal halfway all the same.
        wrong.add(std::abs(jacobian_error(reflected, u, v)) > 1e-5, "reflected", u, v);
      }
      CHECK(wrong == 0);
      // Projected on the surface, all microfacets have its area; those that are visible, the viewer's.
      CHECK(std::abs(integral([&](const Vec3& d) { return normals.distribution(d) * d.z; }, 0, 64) - 1) <
            3e-4);
    }
  CHECK(VisibleNormals{}.distribution({1, 0, 0}) == 0);
}

TEST_CASE("almost smooth microfacets have normals with digits") {
  const VisibleNormals normals{.to_viewer = direction_at(0.5, 2), .roughness = 1e-6};
  Random random(9);
  WrongCases wrong(random);
  for (int i = 0; i < 1000; ++i) {
    const auto [normal, density] = normals.sample(random.interior(), random.interior());
    wrong.add(!(density > 0 && std::isfinite(density)), normal, density);
    // Slopes are of the size of the roughness: the median of tan² θ is α².
    wrong.add(std::abs(length(normal) - 1) > 4e-16, normal);
  }
  CHECK(wrong == 0);
  // For a viewer above, tan² θ = α² v/(1 − v).
  const VisibleNormals above{.to_viewer = {0, 0, 1}, .roughness = 1e-6};
  const Vec3 n = above.sample(0.1, 0.75).direction;
  CHECK(std::abs((n.x * n.x + n.y * n.y) / (n.z * n.z) / 3e-12 - 1) < 1e-14);
}

// These values would differ between machines if functions of the C library took part.
TEST_CASE("maps have the same bits on every machine") {
  CHECK(cosine_hemisphere(0.3, 0.6).direction.x == -0x1.7a6bca5c20a9fp-2);
  CHECK(CosinePower{7.5}.sample(0.3, 0.6).direction.z == 0x1.f59ad0fd926f3p-1);
  CHECK(VisibleNormals{{0.6, 0, 0.8}, 0.5}.sample(0.3, 0.6).direction.x == 0x1.a196da617b233p-6);
}
