// The camera, which maps points of the film to rays (§2.2.3).
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "magnitude.hpp"
#include "numeric/scale.hpp"
#include "numeric/trigonometry.hpp"
#include "ray.hpp"
#include "shutter.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Affine camera: origin and direction of the ray at film point (u, v) are affine in u and v,
///   origin    = position + u · film_right + v · film_up
///   direction = forward  + u · right      + v · up.
///
/// - Pinhole: the film vectors are 0, and all rays start at position. The film stands at forward's tip,
///   spanned by right and up, so forward's length is the focal length. The default is the tutorial's camera:
///   at the origin, x to the right, y up, looking along z.
/// - Pinhole behind its film: the film vectors are k · right and k · up, for one k > 0. Then
///     origin = (position − k · forward) + k · direction,
///   so the rays are those of a pinhole at position − k · forward, without their first k · direction. They
///   start on the film; surfaces between the pinhole and the film are not seen.
/// - Orthographic: right and up are 0, and all rays run along forward.
///
/// - Thin lens: a pinhole with an aperture. Rays start on a disk around position, spanned by the directions
///   of right and up, and all that belong to one film point meet where a pinhole's ray is in focus:
///     origin    = position + lens point
///     direction = forward  + u · right + v · up − lens point / focus.
///   Points at the distance focus, in lengths of forward, are sharp; all others are blurred over disks. Only
///   pictures of samples show that: without samples, the ray of a pixel's center passes the lens' center.
///
/// Any other film vectors are allowed if right, up and forward span space. The rays of such a camera have no
/// common point; they are rendered by tiles as all others are, but the tiles cull less.
///
/// The functions that make a camera take left-handed coordinates: with x to the right and y up, z leads away
/// from the viewer. Through them a scene in right-handed coordinates, where z leads towards the viewer, comes
/// out as its mirror image. For such a scene use look_at_right_handed, or mirrored() of another function's
/// result; tiles and culling take any camera. Normals, angles and shadows do not depend on the handedness.
/// Environments do: such a camera sees them as their mirror image.
struct Camera {
  Point position{0};
  Vec3 right{1, 0, 0};
  Vec3 up{0, 1, 0};
  Vec3 forward{0, 0, 1};
  Vec3 film_right{0};
  Vec3 film_up{0};
  double aperture = 0;  ///< radius of the lens; 0: none
  double focus = 1;     ///< distance of what is in focus, in lengths of forward
  Shutter shutter{};    ///< times of the rays of a pixel
  Vec3 velocity{0};     ///< the camera is at position + t · velocity at time t, and never turns

  /// Largest cosine between the arguments direction and upward of a camera, which should be orthogonal. It is
  /// the allowance of scene files, for directions written in decimals; it shears the picture by less than a
  /// pixel in 10^6.
  static constexpr double most_cosine = 1e-6;

  /// Returns a pinhole camera at position whose film is seen under a vertical angle of field_of_view, in
  /// degrees, between 0 and 180. In all functions that take direction and upward, these may have any length
  /// but 0 and must be orthogonal, their cosine at most 10^-6; the picture's right is upward × direction
  /// (left-handed). Throws std::invalid_argument, which says what is wrong and what is allowed.
  [[nodiscard]] static Camera perspective(const Point& position, const Vec3& direction, const Vec3& upward,
                                          double field_of_view) {
    if (!(field_of_view > 0 && field_of_view < 180))
      refuse("Camera: the field of view must be greater than 0 and less than 180 degrees", field_of_view);
    const auto [right, up, forward] = axes(direction, upward);
    const double half = tangent_of_degrees(field_of_view / 2);
    return valid({.position = position, .right = half * right, .up = half * up, .forward = forward});
  }

  /// Returns a camera with a sensor of height 1 around position, whose focal point is focal_length behind it:
  /// rays start on the sensor and lead away from that point.
  [[nodiscard]] static Camera sensor(const Point& position, const Vec3& direction, const Vec3& upward,
                                     double focal_length) {
    require_length("focal length", focal_length);
    const auto [right, up, forward] = axes(direction, upward);
    return valid({.position = position,
                  .right = 0.5 * right,
                  .up = 0.5 * up,
                  .forward = focal_length * forward,
                  .film_right = 0.5 * right,
                  .film_up = 0.5 * up});
  }

  /// Returns a camera with a viewport at a distance before the eye: rays lead from the eye through the
  /// viewport and start on it, so surfaces before it are not seen. Along eye + t (point of the viewport −
  /// eye) only t > 1 counts. A square image shows width × height of it; one of another shape as much more or
  /// less of its width.
  [[nodiscard]] static Camera viewport(const Point& eye, const Vec3& direction, const Vec3& upward,
                                       double width, double height, double distance) {
    require_length("viewport's width", width);
    require_length("viewport's height", height);
    require_length("viewport's distance", distance);
    const auto [right, up, forward] = axes(direction, upward);
    return valid({.position = eye + distance * forward,
                  .right = 0.5 * width * right,
                  .up = 0.5 * height * up,
                  .forward = distance * forward,
                  .film_right = 0.5 * width * right,
                  .film_up = 0.5 * height * up});
  }

  /// Returns a camera with parallel rays along direction, from a film of the given height around position.
  [[nodiscard]] static Camera orthographic(const Point& position, const Vec3& direction, const Vec3& upward,
                                           double height) {
    require_length("film's height", height);
    const auto [right, up, forward] = axes(direction, upward);
    return valid({.position = position,
                  .right = Vec3{0},
                  .up = Vec3{0},
                  .forward = forward,
                  .film_right = 0.5 * height * right,
                  .film_up = 0.5 * height * up});
  }

  /// Returns the perspective camera at position with target in the middle of its picture. upward points to
  /// the top of the picture, and may be any direction but that to the target and its opposite. Coordinates
  /// are left-handed: seen from the origin along z with y up, x is to the right. Throws std::invalid_argument
  /// if target equals position, if upward is parallel to their difference, or as perspective does.
  [[nodiscard]] static Camera look_at(const Point& position, const Point& target,
                                      const Vec3& upward = {0, 1, 0}, double field_of_view = 90) {
    if (position == target) refuse("Camera: target must differ from position", position);
    const Vec3 forward = unit(target - position, "target - position"), above = unit(upward, "upward");
    const Vec3 right = cross(above, forward);
    // Rounding may leave a product of 2^-50 for parallel unit vectors, each good to 2^-52.
    if (!(length(right) > 0x1p-48))
      refuse("Camera: upward must not be parallel to target - position", upward);
    return perspective(position, forward, cross(forward, unit(right, "upward")), field_of_view);
  }

  /// Returns the camera of look_at for a scene in right-handed coordinates, as most modeling programs have
  /// them: seen from the origin along -z with y up, x is to the right. The picture's right is direction ×
  /// upward, so the picture is the mirror image of look_at's. Throws as look_at does.
  [[nodiscard]] static Camera look_at_right_handed(const Point& position, const Point& target,
                                                   const Vec3& upward = {0, 1, 0},
                                                   double field_of_view = 90) {
    return look_at(position, target, upward, field_of_view).mirrored();
  }

  /// Returns a perspective camera with a lens: the aperture is the lens' radius, and focus the distance along
  /// direction of the plane that is in focus. Throws as perspective and with_lens do.
  [[nodiscard]] static Camera thin_lens(const Point& position, const Vec3& direction, const Vec3& upward,
                                        double field_of_view, double aperture, double focus) {
    return perspective(position, direction, upward, field_of_view).with_lens(aperture, focus);
  }

  /// Returns this camera, a pinhole, with a lens instead: look_at(...).with_lens(0.1, 5). With an aperture of
  /// 0 it stays as it is. Throws std::invalid_argument if the aperture is negative or not finite, if the
  /// distance of focus is not greater than 0 and finite, if the aperture is above 0 and the camera has a
  /// film, or as validate does.
  [[nodiscard]] Camera with_lens(double radius, double distance) const {
    require_length("focus", distance);
    Camera camera = *this;
    camera.aperture = radius, camera.focus = distance / length(forward);
    return valid(camera);
  }

  /// Returns this camera with no lens but its center: the pinhole camera of the same sharp picture.
  [[nodiscard]] Camera without_lens() const {
    Camera camera = *this;
    camera.aperture = 0;
    return camera;
  }

  /// Returns this camera with rays at times from one to another, at which they meet moving surfaces. Throws
  /// std::invalid_argument as Shutter::validate does.
  [[nodiscard]] Camera with_shutter(double opens, double closes) const {
    Camera camera = *this;
    camera.shutter = {opens, closes};
    return valid(camera);
  }

  /// Returns this camera in motion: at each time t of its shutter it is at position + t · velocity. Throws
  /// std::invalid_argument if a number of the velocity, or of a position in that time, is no coordinate
  /// (magnitude.hpp).
  [[nodiscard]] Camera with_velocity(const Vec3& per_time) const {
    Camera camera = *this;
    camera.velocity = per_time;
    return valid(camera);
  }

  /// Returns the camera whose picture is the mirror image of this one's, left and right exchanged. For the
  /// result of perspective, sensor, viewport or orthographic, this is the camera for a scene in right-handed
  /// coordinates.
  [[nodiscard]] Camera mirrored() const {
    Camera camera = *this;
    camera.right = -right;
    camera.film_right = -film_right;
    return camera;
  }

  /// Returns true if all rays start at position.
  [[nodiscard]] bool is_pinhole() const { return !has_film() && !has_lens() && !is_moving(); }

  [[nodiscard]] bool has_lens() const { return aperture > 0; }

  /// Returns true if rays start on a film, not all at one point of the camera.
  [[nodiscard]] bool has_film() const { return !(film_right == Vec3{0} && film_up == Vec3{0}); }

  /// Returns true if rays of different times start at different points.
  [[nodiscard]] bool is_moving() const { return !(velocity == Vec3{0}); }

  /// Returns true if all rays have the same direction.
  [[nodiscard]] bool is_orthographic() const { return right == Vec3{0} && up == Vec3{0}; }

  /// Returns the ray of time 0 through the film at (u, v), with a direction of unit length. That of a lens
  /// passes its center.
  [[nodiscard]] Ray operator()(double u, double v) const {
    return {has_film() ? u * film_right + v * film_up + position : position,
            normalize(u * right + v * up + forward)};
  }

  /// A lens as rays take it: the one that starts at the point (x, y) of the unit disk starts at position + x
  /// · right + y · up of these vectors, and has the direction that the center's has at (u − x · u_shift, v −
  /// y · v_shift).
  struct Lens {
    Vec3 right, up;
    double u_shift, v_shift;
  };
  /// Returns the lens. Precondition: right and up are not 0, as for any camera with a lens.
  [[nodiscard]] Lens lens() const {
    const double a = length(right), b = length(up);
    return {aperture / a * right, aperture / b * up, aperture / focus / a, aperture / focus / b};
  }

  /// Returns the ray of time 0 through the film at (u, v) from a point of the lens, given in the unit disk.
  /// Precondition: the camera has no film; film_right and film_up are not used.
  [[nodiscard]] Ray operator()(double u, double v, const Uv& at) const {
    const Lens of = lens();
    return {at.x * of.right + at.y * of.up + position,
            normalize((u - at.x * of.u_shift) * right + (v - at.y * of.v_shift) * up + forward)};
  }

  /// Returns where a ray starts at a time, given where it would start at time 0. Both may be in lanes.
  [[nodiscard]] auto origin_at(const auto& time, const auto& at_0) const { return time * velocity + at_0; }

  /// Returns the film coordinate u or v of a point of the image, x and y in pixels from the top left: u runs
  /// over [−width/height, width/height] from left to right, v over [1, −1] from top to bottom. x and y may be
  /// numbers in lanes.
  [[nodiscard]] static auto u_at(const auto& x, int width, int height) {
    return static_cast<double>(width) / height * (2.0 * x / static_cast<double>(width) - 1.0);
  }
  [[nodiscard]] static auto v_at(const auto& y, int height) {
    return 1.0 - 2.0 * y / static_cast<double>(height);
  }

  /// Returns the ray of time 0 through the center of pixel (x, y) of an image of width × height pixels, with
  /// (0, 0) at the top left.
  [[nodiscard]] Ray through_pixel(int x, int y, int width, int height) const {
    return (*this)(u_at(x + 0.5, width, height), v_at(y + 0.5, height));
  }

  /// Throws std::invalid_argument if a number of position is no coordinate (magnitude.hpp), if another is not
  /// finite, or if three directions do not span space: right, up and forward, or film_right, film_up and
  /// forward if right and up are both 0. They do not span space if the length of one is not between 2^-400
  /// and 2^400 (about 10^±120), if two are parallel, or if all lie in a plane. Film vectors must always be
  /// shorter than 2^400. Neither an aperture nor its quotient by focus may be above that, focus must be above
  /// 0, and a camera with a lens has no film. The shutter must not close before it opens; the velocity, and
  /// the positions when it does so, must have coordinates.
  [[gnu::cold]] void validate() const {
    const std::pair<const char*, const Vec3&> vectors[] = {
        {"position", position}, {"right", right},           {"up", up},
        {"forward", forward},   {"film_right", film_right}, {"film_up", film_up},
        {"velocity", velocity}};
    for (const auto& [name, v] : vectors)
      if (!is_finite(v)) refuse(std::string("Camera: ").append(name).append(" must be finite"), v);
    require_coordinates("position", position);
    if (is_orthographic())
      require_space(film_right, film_up, forward,
                    "Camera: film_right, film_up and forward of a camera whose right and up are zero");
    else
      require_space(right, up, forward, "Camera: right, up and forward");
    for (const Vec3& v : {film_right, film_up})
      if (!(dot(v, v) < 0x1p800)) refuse("Camera: film_right and film_up must not be longer than 2^400", v);
    if (!(aperture >= 0 && aperture <= 0x1p400))
      refuse("Camera: aperture must be a number from 0 to 2^400", aperture);
    if (!(focus > 0 && std::isfinite(focus)))
      refuse("Camera: focus must be finite and greater than 0", focus);
    if (!(aperture / focus <= 0x1p400))
      refuse("Camera: aperture / focus must be at most 2^400", aperture / focus);
    shutter.validate("Camera");
    require_coordinates("velocity", velocity);
    for (const double time : {shutter.opens, shutter.closes})
      require_coordinates("position + time · velocity", origin_at(time, position));
    if (has_lens() && has_film())
      throw std::invalid_argument(
          "Camera: a lens needs rays that start at one point, so film_right and film_up must be 0");
  }

 private:
  static void refuse(std::string rule, const auto& found) { detail::refuse_found(std::move(rule), found); }

  static void require_coordinates(const char* name, const Vec3& v) {
    if (!is_coordinate(v))
      refuse(std::string("Camera: ").append(name).append(" must have numbers ").append(coordinate_rule), v);
  }

  static Camera valid(const Camera& camera) {
    camera.validate();
    return camera;
  }

  static void require_length(const char* name, double value) {
    if (!(value > 0 && std::isfinite(value)))
      refuse(std::string("Camera: the ").append(name).append(" must be finite and greater than 0"), value);
  }

  /// Returns the unit vector along v. Throws std::invalid_argument if v is 0 or not finite.
  static Vec3 unit(const Vec3& v, const char* name) {
    if (!is_finite(v) || v == Vec3{0})
      refuse(std::string("Camera: ").append(name).append(" must be finite and not zero"), v);
    const Vec3 near_one = scaled(v, -exponent_of({v}));
    return near_one / length(near_one);
  }

  /// Returns right, up and forward, each of unit length.
  static std::array<Vec3, 3> axes(const Vec3& direction, const Vec3& upward) {
    const Vec3 forward = unit(direction, "direction"), up = unit(upward, "upward");
    if (!(std::abs(dot(up, forward)) <= most_cosine))
      refuse("Camera: upward must be orthogonal to direction, their cosine at most 1e-6", dot(up, forward));
    return {cross(up, forward), up, forward};
  }

  [[gnu::cold]] static void require_space(const Vec3& right, const Vec3& up, const Vec3& forward,
                                          const std::string& names) {
    // For these lengths neither a product of three nor the square of a ray's direction leaves the range of
    // double.
    const auto has_length = [](const Vec3& v) { return 0x1p-800 < dot(v, v) && dot(v, v) < 0x1p800; };
    if (!has_length(right) || !has_length(up) || !has_length(forward))
      throw std::invalid_argument(names + " must not be zero, nor shorter than 2^-400 or longer than 2^400");
    // The volume spanned by the unit directions is a sum of six products. Each passes at most fourteen
    // roundings, of 2^-53 of its size, so a volume above 2^-49 of the sum of the sizes is truly not 0.
    const Vec3 r = normalize(right), u = normalize(up), f = normalize(forward);
    const Vec3 a = abs(r), b = abs(u), c = abs(f);
    const double volume = dot(cross(r, u), f);
    const double sizes = dot(Vec3{a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x}, c);
    if (!(std::abs(volume) > 0x1p-49 * sizes))
      throw std::invalid_argument(names + " must not be parallel or in one plane");
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
