#include <limits>
#include <protostar/vec3.hpp>
#include <type_traits>

#include "support/catch.hpp"

using namespace protostar;

static_assert(std::is_same_v<Vec3::value_type, double>);
static_assert(std::is_same_v<Point, Vec3>);
static_assert(std::is_same_v<Color::value_type, float>);

TEST_CASE("vectors are added, scaled and multiplied by component") {
  const Vec3 u{1, 2, 3}, v{4, -5, 6};
  CHECK(u + v == Vec3{5, -3, 9});
  CHECK(u - v == Vec3{-3, 7, -3});
  CHECK(-u == Vec3{-1, -2, -3});
  CHECK(2.0 * u == Vec3{2, 4, 6});
  CHECK(u / 2.0 == Vec3{0.5, 1, 1.5});
  CHECK(u * v == Vec3{4, -10, 18});
}

TEST_CASE("products and lengths of vectors are those of geometry, and need no namespace prefix") {
  const Vec3 u{1, 2, 3}, v{4, -5, 6};
  CHECK(dot(u, v) == 12);
  CHECK(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}) == Vec3{0, 0, 1});
  CHECK(cross(u, v) == Vec3{27, 6, -13});
  CHECK(length(Vec3{2, 3, 6}) == 7);
  CHECK(normalize(Vec3{0, 0, -9}) == Vec3{0, 0, -1});  // 9 times 1/9, rounded, is rounded to 1
}

TEST_CASE("a vector is finite if all of its components are") {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(is_finite(Vec3{1, -2, 1e308}));
  for (const double bad : {inf, -inf, nan}) {
    CHECK_FALSE(is_finite(Vec3{bad, 0, 0}));
    CHECK_FALSE(is_finite(Vec3{0, bad, 0}));
    CHECK_FALSE(is_finite(Vec3{0, 0, bad}));
  }
}

TEST_CASE("is_light accepts only channels that are finite and not negative") {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(is_light(Color{0, 0.5f, 1000}));
  for (const float bad : {inf, -inf, nan, -1e-9f}) {
    CHECK_FALSE(is_light(Color{bad, 0, 0}));
    CHECK_FALSE(is_light(Color{0, bad, 0}));
    CHECK_FALSE(is_light(Color{0, 0, bad}));
  }
}
