// The Cornell box with a ball of glass, as in Peter Shirley, Trevor David Black and Steve Hollasch, "Ray
// Tracing: The Rest of Your Life": a room with a red and a green wall, a lamp at its ceiling and a tall box.
#pragma once

#include <protostar/camera.hpp>
#include <protostar/numeric/trigonometry.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>

/// Builds the scene; the room is a cube with sides of length 555, which is open towards the viewer.
inline protostar::Scene<protostar::Sphere, protostar::Parallelogram> cornell_box() {
  using protostar::Color, protostar::Material, protostar::Parallelogram, protostar::Point, protostar::Vec3;
  const Color red{0.65f, 0.05f, 0.05f}, white{0.73f}, green{0.12f, 0.45f, 0.15f};
  constexpr double side = 555;

  protostar::Scene<protostar::Sphere, protostar::Parallelogram> scene;
  scene.add(Parallelogram{{side, 0, 0}, {0, 0, side}, {0, side, 0}}, green);
  scene.add(Parallelogram{{0, 0, side}, {0, 0, -side}, {0, side, 0}}, red);
  scene.add(Parallelogram{{0, side, 0}, {side, 0, 0}, {0, 0, side}}, white);
  scene.add(Parallelogram{{0, 0, side}, {side, 0, 0}, {0, 0, -side}}, white);
  scene.add(Parallelogram{{side, 0, side}, {-side, 0, 0}, {0, side, 0}}, white);
  scene.add(Parallelogram{{213, 554, 227}, {130, 0, 0}, {0, 0, 105}}, Material{.emission = Color{15}});

  // The tall box, turned by 15 degrees: its front, right, back, left and top. It stands on the floor.
  const double cosine = protostar::cosine_of_degrees(15), sine = protostar::sine_of_degrees(15);
  const Vec3 across{165 * cosine, 0, -165 * sine}, along{165 * sine, 0, 165 * cosine}, up{0, 330, 0};
  const Point corner{265, 0, 295};
  scene.add(Parallelogram{corner, across, up}, white);
  scene.add(Parallelogram{corner + across, along, up}, white);
  scene.add(Parallelogram{corner + across + along, -across, up}, white);
  scene.add(Parallelogram{corner + along, -along, up}, white);
  scene.add(Parallelogram{corner + up, across, along}, white);

  scene.add(protostar::Sphere{{190, 90, 190}, 90}, Material{.refract = 1, .ior = 1.5});
  scene.set_sky(Color{0});
  return scene;
}

/// The camera that looks into the box. The book's coordinates are right-handed.
inline protostar::Camera camera_of_cornell_box() {
  return protostar::Camera::look_at_right_handed({278, 278, -800}, {278, 278, 0}, {0, 1, 0}, 40);
}
