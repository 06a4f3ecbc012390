#include <cmath>
#include <functional>
#include <limits>
#include <protostar/camera.hpp>
#include <stdexcept>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"

using namespace protostar;

namespace {

/// Returns the distance of a ray's direction from the unit vector along v.
double error(const Ray& ray, const Vec3& v) { return length(ray.direction - v / length(v)); }

// With u = 2^-53, normalize rounds a square of a length by 3u of itself, its root and its inverse by 1.5u + u
// + u, and each product by u: 4.5u. The quotient by a length is off by 1.5u + u + u = 3.5u. Directions of
// exact numbers hence agree to 8u. Tangents, and places on a film or of a pixel, round on either side by up
// to 4u more: two roundings of a constant, a product and a sum.
constexpr double exact_error = 8.001 * 0x1p-53, rounded_error = 16.001 * 0x1p-53;

bool equal(const Camera& a, const Camera& b) {
  return a.position == b.position && a.right == b.right && a.up == b.up && a.forward == b.forward &&
         a.film_right == b.film_right && a.film_up == b.film_up;
}

const Vec3 x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};
}  // namespace

TEST_CASE("the default camera is the tutorial's: at the origin, x to the right, y up, looking along z") {
  const Camera camera;
  CHECK(camera.position == Point{0, 0, 0});
  CHECK(camera(0, 0).direction == Vec3{0, 0, 1});
  CHECK(error(camera(1, 0), {1, 0, 1}) < exact_error);
  CHECK(error(camera(0, 1), {0, 1, 1}) < exact_error);
  CHECK(camera.is_pinhole());
  CHECK(!camera.is_orthographic());
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
      {0, 0, 1, 2, {0, 0.5, 1}},     // a tall film spans [−1/2, 1/2]
      {0, 0, 640, 480, {-4.0 / 3 * 639 / 640, 479.0 / 480, 1}},
      {639, 479, 640, 480, {4.0 / 3 * 639 / 640, -479.0 / 480, 1}},
      {320, 240, 640, 480, {4.0 / 3 / 640, -1.0 / 480, 1}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.x, row.y, row.width, row.height);
    const Ray ray = camera.through_pixel(row.x, row.y, row.width, row.height);
    CHECK(ray.origin == Point{0, 0, 0});
    CHECK(error(ray, row.expected) < rounded_error);
    CHECK(ray.departure == Departure{});
  }
}

TEST_CASE("the film is at the tip of forward and is spanned by right and up") {
  const Camera camera{.position = {1, 2, 3}, .right = {0, 0, 2}, .up = {0, 3, 0}, .forward = {4, 0, 1}};
  CHECK(camera(0.5, -1).origin == Point{1, 2, 3});
  CHECK(error(camera(0, 0), {4, 0, 1}) < exact_error);
  CHECK(error(camera(0.5, -1), {4, -3, 2}) < exact_error);
}

TEST_CASE("the length of forward is the focal length") {
  const Camera tele{.forward = {0, 0, 10}};
  CHECK(error(tele(1, 0), {1, 0, 10}) < exact_error);
}

TEST_CASE("camera rays have unit directions, so that t is a distance") {
  const Camera camera{.right = {3, 1, 0}, .up = {0, 0.1, -2}, .forward = {0.5, 4, 1}};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x)
      REQUIRE(std::abs(length(camera.through_pixel(x, y, 30, 20).direction) - 1) < exact_error);
}

TEST_CASE("a camera whose numbers are not finite is refused") {
  for (const double bad : {infinity, -infinity, not_a_number})
    for (Vec3 Camera::*field : {&Camera::position, &Camera::right, &Camera::up, &Camera::forward,
                                &Camera::film_right, &Camera::film_up, &Camera::velocity})
      for (int axis = 0; axis < 3; ++axis) {
        Camera camera;
        (camera.*field)[axis] = bad;
        CHECK_THAT(message_of<std::invalid_argument>([&] { camera.validate(); }),
                   ContainsSubstring("Camera") && ContainsSubstring("finite"));
      }
  CHECK_THAT(message_of<std::invalid_argument>([] {
               Camera{.position = {0, 1e121, 0}}.validate();
             }),
             ContainsSubstring("Camera: position must have numbers at most 2^400"));
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

TEST_CASE("a camera may have any scale, and be oblique, mirrored or almost flat") {
  for (const double scale : {1e-60, 1e-9, 1.0, 1e9, 1e60}) {
    CAPTURE(scale);
    const Camera camera{.right = {scale, 0, 0}, .up = {0, scale, 0}, .forward = {0, 0, scale}};
    CHECK_NOTHROW(camera.validate());
    CHECK(error(camera(0.5, -2), {0.5, -2, 1}) < exact_error);
  }
  CHECK_NOTHROW(Camera{.right = {-1, 0, 0}}.validate());
  CHECK_NOTHROW(Camera{.up = {0, 1e-17, 1}}.validate());
  CHECK_NOTHROW(Camera{.right = {1e-30, 0, 0}, .forward = {0, 0, 1e30}}.validate());
  CHECK_NOTHROW(Camera{.right = {1, 2, 3}, .up = {4, 5, 6}, .forward = {7, 8, 10}}.validate());
}

TEST_CASE("rays start on the film if the film vectors are not zero") {
  const Camera camera{
      .position = {1, 2, 3}, .right = {1, 0, 0}, .film_right = {0, 0, 2}, .film_up = {5, 0, 0}};
  CHECK(camera(0, 0).origin == Point{1, 2, 3});
  CHECK(camera(0.5, -1).origin == Point{-4, 2, 4});
  CHECK(error(camera(0.5, -1), {0.5, -1, 1}) < exact_error);
  CHECK(camera.through_pixel(0, 0, 2, 2).origin == Point{3.5, 2, 2});
  CHECK_NOTHROW(camera.validate());
}

TEST_CASE("the perspective camera with a field of view of 90 degrees is the default camera") {
  CHECK(equal(Camera::perspective(Point{0}, z_axis, y_axis, 90), Camera{}));
  CHECK(equal(Camera::look_at(Point{0}, {0, 0, 7}, y_axis), Camera{}));
  CHECK(equal(Camera::look_at(Point{0}, {0, 0, 0.3}, {0, 0.1, 55}, 90), Camera{}));
}

TEST_CASE("the field of view of a perspective camera is the angle between the upper and the lower edge") {
  struct {
    Vec3 direction, upward;
    double field_of_view;
    Vec3 right, up;  ///< directions to the middles of the edges of a square image
  } const rows[] = {
      {z_axis, y_axis, 90, {1, 0, 1}, {0, 1, 1}},
      {{0, 0, 1e-200}, {0, 1e200, 0}, 90, {1, 0, 1}, {0, 1, 1}},
      {-z_axis, y_axis, 90, {-1, 0, -1}, {0, 1, -1}},
      {x_axis, z_axis, 60, {1, 1 / std::sqrt(3), 0}, {1, 0, 1 / std::sqrt(3)}},
      {{0, -2, 0}, {3, 0, 0}, 120, {0, -1, -std::sqrt(3)}, {std::sqrt(3), -1, 0}},
      {{1, 1, 0}, {-1, 1, 0}, 90, {1, 1, -std::sqrt(2)}, {0, 1, 0}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.field_of_view, row.direction.x, row.direction.y, row.direction.z);
    const Camera camera = Camera::perspective({1, 2, 3}, row.direction, row.upward, row.field_of_view);
    CHECK(camera.is_pinhole());
    CHECK(camera(0.3, 0.7).origin == Point{1, 2, 3});
    CHECK(error(camera(1, 0), row.right) < rounded_error);
    CHECK(error(camera(0, 1), row.up) < rounded_error);
  }
}

TEST_CASE("rays of a sensor camera start on the sensor and lead away from its focal point") {
  const Camera camera = Camera::sensor({1, 2, 3}, {0, 0, 5}, {0, 2, 0}, 1.5);
  CHECK(!camera.is_pinhole());
  CHECK(camera(0, 0).origin == Point{1, 2, 3});
  CHECK(camera(0, 0).direction == z_axis);
  CHECK(camera(0, 1).origin == Point{1, 2.5, 3});
  CHECK(camera(-2, -1).origin == Point{0, 1.5, 3});
  CHECK(error(camera(-2, -1), {-1, -0.5, 1.5}) < rounded_error);
  for (const double u : {-1.3, 0.2, 1.0})
    for (const double v : {-1.0, 0.4}) {
      const Ray ray = camera(u, v);
      const Point focal_point{1, 2, 1.5};
      CHECK(error(ray, ray.origin - focal_point) < rounded_error);
    }
  // The field of view is the angle of a height of 1 at distance 1.5.
  CHECK(error(camera(0, 1),
              Camera::perspective(Point{0}, z_axis, y_axis, 2 * 18.434948822922011)(0, 1).direction) <
        rounded_error);
}

TEST_CASE("rays of a viewport camera start on the viewport and lead away from the eye") {
  const Camera camera = Camera::viewport({1, 2, 3}, z_axis, y_axis, 3, 1, 2);
  CHECK(camera(0, 0).origin == Point{1, 2, 5});
  CHECK(camera(1, 1).origin == Point{2.5, 2.5, 5});
  CHECK(error(camera(1, 1), {1.5, 0.5, 2}) < rounded_error);
  // The ray starts where the eye's ray is at t = 1.
  const Ray from_eye =
      Camera{.position = {1, 2, 3}, .right = {1.5, 0, 0}, .up = {0, 0.5, 0}, .forward = {0, 0, 2}}(0.3, -0.7);
  CHECK(camera(0.3, -0.7).direction == from_eye.direction);
  CHECK(length(camera(0.3, -0.7).origin - (Point{1, 2, 3} + Vec3{0.45, -0.35, 2})) < rounded_error);
}

TEST_CASE("rays of an orthographic camera are parallel, and its film has the given height") {
  const Camera camera = Camera::orthographic({1, 2, 3}, {0, 0, 5}, {0, 2, 0}, 6);
  CHECK(camera.is_orthographic());
  CHECK(!camera.is_pinhole());
  CHECK(camera(0, 0).origin == Point{1, 2, 3});
  CHECK(camera(0, 1).origin == Point{1, 5, 3});
  CHECK(camera(-2, -1).origin == Point{-5, -1, 3});
  for (const double u : {-1.3, 0.0, 1.0}) CHECK(camera(u, 0.4).direction == z_axis);
  CHECK(camera.through_pixel(0, 0, 2, 2).origin == Point{-0.5, 3.5, 3});
}

TEST_CASE("a camera that looks at a point shows it in the middle of the image, with upward pointing up") {
  struct {
    Point position, target;
    Vec3 upward;
    Vec3 right, up;
  } const rows[] = {
      {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}},
      {{5, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 0}},
      {{0, 3, 0}, {0, 0, 0}, {0, 7, 1}, {1, 0, 0}, {0, 0, 1}},
      {{1, 1, 1}, {1, 1, 2}, {1, 0, 9}, {0, -1, 0}, {1, 0, 0}},
      {{0, 0, 0}, {1, 0, 1}, {0, 1, 0.125}, {1, 0.125, -1}, {-0.125, 2, 0.125}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.position.x, row.position.y, row.position.z);
    const Camera camera = Camera::look_at(row.position, row.target, row.upward, 60);
    const double half = 1 / std::sqrt(3);
    CHECK(camera.position == row.position);
    CHECK(error(camera(0, 0), row.target - row.position) < rounded_error);
    CHECK(length(camera.right - half * normalize(row.right)) < rounded_error);
    CHECK(length(camera.up - half * normalize(row.up)) < rounded_error);
    CHECK(std::abs(dot(camera.up, camera.forward)) < rounded_error);
    CHECK(std::abs(dot(camera.right, camera.forward)) < rounded_error);
  }
}

TEST_CASE("invalid parameters of a camera are refused, with what was found and what is allowed") {
  const Point o{0};
  struct {
    std::function<Camera()> make;
    const char *allowed, *found;
  } const rows[] = {
      {[=] { return Camera::perspective(o, z_axis, y_axis, 0); }, "field of view must be greater than 0",
       "is 0"},
      {[=] { return Camera::perspective(o, z_axis, y_axis, 180); }, "less than 180", "is 180"},
      {[=] { return Camera::perspective(o, z_axis, y_axis, -3.5); }, "field of view", "is -3.5"},
      {[=] { return Camera::perspective(o, z_axis, y_axis, not_a_number); }, "field of view", "nan"},
      {[=] {
         return Camera::perspective(o, {0, 0, 0}, y_axis, 90);
       },
       "direction must be finite and not zero", "(0, 0, 0)"},
      {[=] {
         return Camera::perspective(o, z_axis, {0, infinity, 0}, 90);
       },
       "upward must be finite and not zero", "(0, inf, 0)"},
      {[=] {
         return Camera::perspective(o, z_axis, {0, 4, 3}, 90);
       },
       "upward must be orthogonal to direction", "is 0.6"},
      {[=] {
         return Camera::perspective(o, z_axis, {0, 1, -1.1e-6}, 90);
       },
       "at most 1e-6", "is -1.09999999999933"},
      {[=] {
         return Camera::perspective({0, infinity, 0}, z_axis, y_axis, 90);
       },
       "position", "finite"},
      {[=] { return Camera::perspective(o, z_axis, y_axis, 1e-200); }, "right, up and forward", "2^-400"},
      {[=] { return Camera::sensor(o, z_axis, y_axis, 0); }, "focal length must be finite and greater than 0",
       "is 0"},
      {[=] { return Camera::sensor(o, z_axis, y_axis, infinity); }, "focal length", "is inf"},
      {[=] { return Camera::sensor(o, z_axis, z_axis, 1); }, "orthogonal", "is 1"},
      {[=] { return Camera::viewport(o, z_axis, y_axis, -1, 1, 1); }, "viewport's width must be", "is -1"},
      {[=] { return Camera::viewport(o, z_axis, y_axis, 1, 0, 1); }, "viewport's height must be", "is 0"},
      {[=] { return Camera::viewport(o, z_axis, y_axis, 1, 1, not_a_number); }, "viewport's distance must be",
       "nan"},
      {[=] { return Camera::orthographic(o, z_axis, y_axis, -2); }, "film's height must be finite", "is -2"},
      {[=] { return Camera::orthographic(o, z_axis, y_axis, 1e-200); }, "film_right, film_up and forward",
       "2^-400"},
      {[=] {
         return Camera::look_at({1, 2, 3}, {1, 2, 3}, y_axis);
       },
       "target must differ from position", "(1, 2, 3)"},
      {[=] {
         return Camera::look_at(o, {0, -9, 0}, {0, 3, 0});
       },
       "upward must not be parallel", "(0, 3, 0)"},
      {[=] {
         return Camera::look_at(o, {0.1, 0.2, 0.3}, {0.3, 0.6, 0.9});
       },
       "upward must not be parallel", "(0.3, 0.6, 0.9)"},
      {[=] {
         return Camera::look_at(o, {0, 0, infinity}, y_axis);
       },
       "target - position must be finite", "(0, 0, inf)"},
      {[=] { return Camera::look_at(o, z_axis, Vec3{0}); }, "upward must be finite and not zero",
       "(0, 0, 0)"},
  };
  for (const auto& row : rows) {
    INFO(row.allowed);
    CHECK_THAT(message_of<std::invalid_argument>(row.make), ContainsSubstring("Camera: ") &&
                                                                ContainsSubstring(row.allowed) &&
                                                                ContainsSubstring(row.found));
  }
  CHECK_NOTHROW(Camera::perspective(o, z_axis, {0, 1, 0.9e-6}, 90));
}

TEST_CASE("if right and up of a camera are zero, the film vectors and forward have to span space") {
  const Vec3 none{0};
  CHECK_NOTHROW(Camera{.right = none, .up = none, .film_right = x_axis, .film_up = y_axis}.validate());
  CHECK_NOTHROW(Camera{.right = none, .up = none, .film_right = x_axis, .film_up = {1, 1, 3}}.validate());
  for (const Camera& camera :
       {Camera{.right = none, .up = none}, Camera{.right = none, .up = none, .film_right = x_axis},
        Camera{.right = none, .up = none, .film_right = x_axis, .film_up = -x_axis},
        Camera{.right = none, .up = none, .film_right = x_axis, .film_up = z_axis}})
    CHECK_THAT(message_of<std::invalid_argument>([&] { camera.validate(); }),
               ContainsSubstring("Camera: film_right, film_up and forward"));
  // A right vector of zero alone does not make the camera orthographic.
  CHECK_THAT(message_of<std::invalid_argument>(
                 [&] { Camera{.right = none, .film_right = x_axis, .film_up = y_axis}.validate(); }),
             ContainsSubstring("Camera: right, up and forward"));
  CHECK_THAT(message_of<std::invalid_argument>([&] {
               Camera{.film_up = {0, 1e121, 0}}.validate();
             }),
             ContainsSubstring("film_right and film_up must not be longer"));
}
