#include <protostar/sampling/disk_view.hpp>
#include <protostar/sampling/warp.hpp>
#include <protostar/sampling/warp_lanes.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/catch.hpp"
#include "support/chi_squared.hpp"
#include "support/jacobian.hpp"
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

/// Returns the integral of a density that depends on the height alone, over all directions above one, by
/// Gauss and Legendre's rule with 12 nodes in each of 25 panels.
double integral(const auto& density, double from) {
  constexpr int panels = 25;
  const double width = (1 - from) / panels;
  double sum = 0;
  for (int i = 0; i < panels; ++i)
    sum += detail::gauss_legendre([&](double z) { return density(direction_at(z, 1)); }, from + i * width,
                                  width);
  return sum * 2 * std::numbers::pi;
}

// With u = 2^-53, sums of 12 and of 25 numbers are off by 37u, terms by 15u of themselves for the densities
// and by 8u for the factors, and a node by u, which is n u of a power n of it, up to 40. The rule is exact
// for polynomials up to 23; powers up to 40 and the densities of GGX, whose poles are 3 half widths of a
// panel away, it gives to 2^-60.
constexpr double integral_error = (37 + 15 + 8 + 40) * 0x1p-53;

// Largest error of the length of a direction: normalize is off by 4.5u (camera.cpp), a component r cos by at
// most 5u, 2u for r and 2u for the cosine. The length adds 2.5u.
constexpr double length_error = 7.5 * 0x1p-53;

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
  const auto at = [](const auto& cells) {
    return [&](int i) { return static_cast<double>(cells[static_cast<std::size_t>(i)]); };
  };
  return chi_squared_over_bound(heights * azimuths, at(counts), at(expected));
}

/// Checks that a density integrates to 1, and that a map draws directions with it.
void check_map(const auto& map, const auto& density, double lowest, std::uint64_t seed) {
  CHECK(std::abs(integral(density, lowest) - 1) <= integral_error);
  CHECK(chi_squared_of(map, density, lowest, seed) < 1);
  const auto direction_of = [&](double u, double v) { return map(u, v).direction; };
  Random random(seed);
  WrongCases wrong(random);
  for (int i = 0; i < 2000; ++i) {
    const double u = random.real(0.01, 0.99), v = random.real(0.01, 0.99);
    const auto [direction, value] = map(u, v);
    wrong.add(std::abs(length(direction) - 1) > length_error, "length", u, v);
    wrong.add(value != density(direction), "density", u, v, value, density(direction));
    if (is_at_diagonal(u, v)) continue;
    // Angles up to 2π are off by 9u, and length_error is on top of it.
    const Estimated one = times_density(direction_of, value, u, v, 16);
    wrong.add(!one.is_one(), "Jacobian", u, v, one.value, one.error);
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
    // With the angle θ to the z axis, it turns by |dn| around an axis and by |dn| tan θ/2 around n: together
    // by |dn|/cos θ/2, and 2 cos θ/2 is the distance from (0, 0, −1). Vectors are off by 8u (warp.hpp), and
    // 4.5u for n.
    const double way = length(n - m);
    const double most = 2 * way / (length(n - Vec3{0, 0, -1}) - way) + 2 * 12.5 * 0x1p-53;
    wrong.add(length(frame_around(n).x - frame_around(m).x) > most, n, m);
    wrong.add(length(frame_around(n).y - frame_around(m).y) > most, n, m);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a frame turns local directions, and turns them back") {
  const Frame frame = frame_around(normalize(Vec3{1, -2, 0.5}));
  CHECK(frame({0, 0, 1}) == frame.z);
  // With u = 2^-53, squares of the vectors are off from 1 by 16u (warp.hpp) and 9u for n, and their products
  // from 0 by 8u; both sums of three terms round by 3√3 u.
  CHECK(length(frame.local(frame({0.1, 0.2, 0.3})) - Vec3{0.1, 0.2, 0.3}) <=
        0.375 * (25 + 16 + 10.4) * 0x1p-53);
  CHECK(frame_around({0, 0, -1}).x == Vec3{1, 0, 0});
}

TEST_CASE("the concentric map takes squares around the center to circles, and keeps areas") {
  CHECK(concentric_disk(0.5, 0.5) == Uv{0, 0});
  Random random(3);
  WrongCases wrong(random);
  const auto on_plane = [](double u, double v) { return Vec3{concentric_disk(u, v), 1}; };
  for (int i = 0; i < 5000; ++i) {
    const double u = random.real(0, 1), v = random.real(0, 1);
    const Uv p = concentric_disk(u, v);
    const double ring = 2 * std::max(std::abs(u - 0.5), std::abs(v - 0.5));
    // Both are differences, rounded once; components have 2u more for a sine and u for a product, and the
    // length of two 2u.
    wrong.add(std::abs(std::sqrt(p.x * p.x + p.y * p.y) - ring) > 7 * 0x1p-53 * ring, u, v);
    if (is_at_diagonal(u, v)) continue;
    const Estimated one = times_density(on_plane, 1 / std::numbers::pi, u, v, 16);
    wrong.add(!one.is_one(), "area", u, v, one.value, one.error);
  }
  CHECK(wrong == 0);
}

TEST_CASE("directions of a cosine-weighted hemisphere have the density cos θ/π") {
  check_map([](double u, double v) { return cosine_hemisphere(u, v); },
            [](const Vec3& d) { return cosine_density(d.z); }, 0, 4);
  const Vec3 normal = normalize(Vec3{1, 2, -2});
  const auto [direction, density] = cosine_hemisphere(normal, 0.3, 0.6);
  // With u = 2^-53, x and y are off from right angles to the normal by 8u, its square by 9u (camera.cpp), and
  // sums of three terms round by 3√3 u and 3u.
  CHECK(std::abs(density - dot(direction, normal) / std::numbers::pi) <=
        (8 * std::sqrt(2) + 9 + 5.2 + 3) / std::numbers::pi * 0x1p-53);
  CHECK(cosine_density(-0.5) == 0);
}

TEST_CASE("a cosine-weighted direction at the horizon has a cosine with digits") {
  // u = 2^-40: r = 1 − 2^-39, and cos θ = √((1 − r)(1 + r)).
  const Vec3 d = cosine_hemisphere(0x1p-40, 0.5).direction;
  CHECK(d.z == std::sqrt(0x1p-38 * (1 - 0x1p-40)));  // the numbers in it are exact
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
    // An error of 2^-57 of the cosine counts twice in sin² = 0.99/n, and so once, by 0.99, in the sine. With
    // u = 2^-53, its rounding is 1.5u, products and sines add 3u, the length 2.5u, the expected number and
    // the quotient 2u.
    CHECK(std::abs(std::sqrt(d.x * d.x + d.y * d.y) / sine - 1) <= 0x1p-57 * exponent / 0.99 + 9 * 0x1p-53);
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
      const auto map = [&](double u, double v) { return normals.sample(u, v); };
      CHECK(chi_squared_of(map, density, 0, 7) < 1);
      const auto normal_at = [&](double u, double v) { return map(u, v).direction; };
      const auto reflected_at = [&](double u, double v) {
        const Vec3 n = normal_at(u, v);
        return 2 * dot(normals.to_viewer, n) * n - normals.to_viewer;
      };
      Random random(8);
      WrongCases wrong(random);
      // The roundings of check_map, of a direction that is stretched by 1/α; mirrored, it turns twice as
      // fast.
      const double roundings = 16 / roughness;
      for (int i = 0; i < 1000; ++i) {
        const double u = random.real(0.01, 0.99), v = random.real(0.01, 0.99);
        const Estimated one = times_density(normal_at, map(u, v).density, u, v, roundings);
        wrong.add(!one.is_one(), "normal", u, v, one.value, one.error);
        // A direction mirrored at the normal has the density of both. Mirrored below the surface, it has a
        // normal halfway all the same.
        const double density_reflected = normals.reflected_density(reflected_at(u, v));
        const Estimated other = times_density(reflected_at, density_reflected, u, v, 2 * roundings);
        wrong.add(!other.is_one(), "reflected", u, v, other.value, other.error);
      }
      CHECK(wrong == 0);
      // Projected on the surface, all microfacets have its area.
      CHECK(std::abs(integral([&](const Vec3& d) { return normals.distribution(d) * d.z; }, 0) - 1) <=
            integral_error);
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
    wrong.add(std::abs(length(normal) - 1) > length_error, normal);
  }
  CHECK(wrong == 0);
  // For a viewer above, tan² θ = α² v/(1 − v).
  const VisibleNormals above{.to_viewer = {0, 0, 1}, .roughness = 1e-6};
  const Vec3 n = above.sample(0.1, 0.75).direction;
  // With u = 2^-53, x and y have 8u for α, r, a sine, products with both, and the last product of normalize,
  // whose z has one, too; squares count twice. Squares, sum, quotients and 3e-12 have 6u.
  CHECK(std::abs((n.x * n.x + n.y * n.y) / (n.z * n.z) / 3e-12 - 1) <= (2 * 8 + 6) * 0x1p-53);
}

// These values would differ between machines if functions of the C library took part.
TEST_CASE("maps have the same bits on every machine") {
  CHECK(cosine_hemisphere(0.3, 0.6).direction.x == -0x1.7a6bca5c20a9fp-2);
  CHECK(CosinePower{7.5}.sample(0.3, 0.6).direction.z == 0x1.f59ad0fd926f3p-1);
  CHECK(VisibleNormals{{0.6, 0, 0.8}, 0.5}.sample(0.3, 0.6).direction.x == 0x1.a196da617b233p-6);
}
