#include <cmath>
#include <limits>
#include <protostar/camera.hpp>
#include <stdexcept>

#include "support/catch.hpp"
#include "support/errors.hpp"

using namespace protostar;

namespace {
constexpr double inf = std::numeric_limits<double>::infinity(),
                 not_a_number = std::numeric_limits<double>::quiet_NaN();

/// How far a ray's direction is from the unit vector along v.
double error(const Ray& ray, const Vec3& v) { return length(ray.direction - v / length(v)); }
}  // namespace

TEST_CASE("the default camera is the tutorial's: at the origin, x to the right, y up, looking along z") {
  const Camera camera;
  CHECK(camera.position == Point{0, 0, 0});
  CHECK(camera(0, 0).direction == Vec3{0, 0, 1});
  CHECK(error(camera(1, 0), {1, 0, 1}) < 1e-15);
  CHECK(error(camera(0, 1), {0, 1, 1}) < 1e-15);
  CHECK_NOTHROW(camera.validate());
}

TEST_CASE("rays lead through the pixels' centers, (0, 0) at the top left") {
  const Camera camera;
  struct {
    int x, y, width, height;
    Vec3 expected;
  } const rows[] = {
      {0, 0, 1, 1, {0, 0, 1}},
      {1, 1, 3, 3, {0, 0, 1}},
      {0, 0, 2, 2, {-0.5, 0.5, 1}},
      {1, 0, 2, 2, {0.5, 0.5, 1}},
      {0, 1, 2, 2, {-0.5, -0.5, 1}},
      {1, 1, 2, 2, {0.5, -0.5, 1}},
      {0, 0, 4, 2, {-1.5, 0.5, 1}},  // a wide film spans [−2, 2]
      {3, 1, 4, 2, {1.5, -0.5, 1}},  //
      {0, 0, 1, 2, {0, 0.5, 1}},     // a tall one [−1/2, 1/2]
      {0, 0, 640, 480, {-4.0 / 3 * 639 / 640, 479.0 / 480, 1}},
      {639, 479, 640, 480, {4.0 / 3 * 639 / 640, -479.0 / 480, 1}},
      {320, 240, 640, 480, {4.0 / 3 / 640, -1.0 / 480, 1}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.x, row.y, row.width, row.height);
    const Ray ray = camera.through_pixel(row.x, row.y, row.width, row.height);
    CHECK(ray.origin == Point{0, 0, 0});
    CHECK(error(ray, row.expected) < 1e-15);
    CHECK(ray.departure == Departure{});
  }
}

TEST_CASE("the film stands at forward's tip and is spanned by right and up") {
  const Camera camera{.position = {1, 2, 3}, .right = {0, 0, 2}, .up = {0, 3, 0}, .forward = {4, 0, 1}};
  CHECK(camera(0.5, -1).origin == Point{1, 2, 3});
  CHECK(error(camera(0, 0), {4, 0, 1}) < 1e-15);
  CHECK(error(camera(0.5, -1), {4, -3, 2}) < 1e-15);
}

TEST_CASE("the length of forward is the focal length") {
  const Camera tele{.forward = {0, 0, 10}};
  CHECK(error(tele(1, 0), {1, 0, 10}) < 1e-15);
}

TEST_CASE("camera rays are unit vectors, so that t is a distance") {
  const Camera camera{.right = {3, 1, 0}, .up = {0, 0.1, -2}, .forward = {0.5, 4, 1}};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x)
      REQUIRE(std::abs(length(camera.through_pixel(x, y, 30, 20).direction) - 1) < 1e-15);
}

TEST_CASE("a camera whose numbers are not finite is refused") {
  for (const double bad : {inf, -inf, not_a_number})
    for (Vec3 Camera::*field : {&Camera::position, &Camera::right, &Camera::up, &Camera::forward})
      for (int axis = 0; axis < 3; ++axis) {
        Camera camera;
        (camera.*field)[axis] = bad;
        CHECK_THAT(message_of<std::invalid_argument>([&] { camera.validate(); }),
                   ContainsSubstring("Camera") && ContainsSubstring("finite"));
      }
}

TEST_CASE("a camera whose directions do not span space is refused") {
  struct {
    const char* what;
    Camera camera;
  } const rows[] = {
      {"zero forward", {.forward = {0, 0, 0}}},
      {"zero right", {.right = {0, 0, 0}}},
      {"zero up", {.up = {0, 0, 0}}},
      {"up along forward", {.up = {0, 0, 2}}},
      {"up against forward", {.up = {0, 0, -1}}},
      {"up along right", {.up = {3, 0, 0}}},
      {"up along an oblique forward", {.up = {0.1, 0.2, 0.3}, .forward = {0.3, 0.6, 0.9}}},
      {"all in a plane", {.right = {1, 0, 0}, .up = {0, 1, 0}, .forward = {1, 1, 0}}},
      {"all in an oblique plane", {.right = {1, 2, 3}, .up = {4, 5, 6}, .forward = {7, 8, 9}}},
      {"all in a plane, but for rounding",
       {.right = {0.1, 0.2, 0.3}, .up = {0.4, 0.5, 0.6}, .forward = {0.7, 0.8, 0.9}}},
      {"all in a tiny plane", {.right = {1e-60, 0, 0}, .up = {0, 1e-60, 0}, .forward = {1e-60, 1e-60, 0}}},
      {"smaller than double can tell",
       {.right = {1e-200, 0, 0}, .up = {0, 1e-200, 0}, .forward = {0, 0, 1e-200}}},
      {"larger than double can tell",
       {.right = {1e200, 0, 0}, .up = {0, 1e200, 0}, .forward = {0, 0, 1e200}}},
  };
  for (const auto& row : rows) {
    INFO(row.what);
    CHECK_THAT(message_of<std::invalid_argument>([&] { row.camera.validate(); }),
               ContainsSubstring("Camera: right, up and forward"));
  }
}

TEST_CASE("a camera may be of any scale, oblique, mirrored and almost flat") {
  for (const double scale : {1e-60, 1e-9, 1.0, 1e9, 1e60}) {
    CAPTURE(scale);
    const Camera camera{.right = {scale, 0, 0}, .up = {0, scale, 0}, .forward = {0, 0, scale}};
    CHECK_NOTHROW(camera.validate());
    CHECK(error(camera(0.5, -2), {0.5, -2, 1}) < 1e-15);
  }
  CHECK_NOTHROW(Camera{.right = {-1, 0, 0}}.validate());
  CHECK_NOTHROW(Camera{.up = {0, 1e-17, 1}}.validate());
  CHECK_NOTHROW(Camera{.right = {1e-30, 0, 0}, .forward = {0, 0, 1e30}}.validate());
  CHECK_NOTHROW(Camera{.right = {1, 2, 3}, .up = {4, 5, 6}, .forward = {7, 8, 10}}.validate());
}
