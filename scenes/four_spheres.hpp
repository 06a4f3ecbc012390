// Four spheres between three lights, by themselves or above a checker board: ivory, glass, red rubber and a
// mirror, with the numbers of Dmitry V. Sokolov's tinyraytracer. Its z axis runs towards the camera, ours
// away.
#pragma once

#include <array>
#include <cstddef>
#include <protostar/any_scene.hpp>
#include <protostar/camera.hpp>

inline const protostar::Material ivory{
    .diffuse = {0.36f, 0.36f, 0.27f}, .specular = protostar::Color{0.5f}, .shininess = 50, .reflect = 0.1};
inline const protostar::Material unpolished_ivory{
    .diffuse = ivory.diffuse, .specular = ivory.specular, .shininess = ivory.shininess};
inline const protostar::Material glass{
    .specular = protostar::Color{0.9f}, .shininess = 125, .reflect = 0.1, .refract = 0.8, .ior = 1.5};
inline const protostar::Material red_rubber{
    .diffuse = {0.42f, 0.14f, 0.14f}, .specular = protostar::Color{0.3f}, .shininess = 10};
inline const protostar::Material mirror{.specular = protostar::Color{16}, .shininess = 1425, .reflect = 0.8};

inline const std::array<protostar::Sphere, 4> the_four_spheres{{{.center = {-3, 0, 16}, .radius = 2},
                                                                {.center = {-1, -1.5, 12}, .radius = 2},
                                                                {.center = {1.5, -0.5, 18}, .radius = 3},
                                                                {.center = {7, 5, 18}, .radius = 4}}};

/// A board of 10 × 10 squares below them, and what it is made of.
inline const protostar::Parallelogram checker_board{
    .position = {-10, -4, 10}, .edge_u = {20, 0, 0}, .edge_v = {0, 0, 20}};
inline const protostar::Material checkers{
    .texture = protostar::Checker{.first = {0.6f, 0.4f, 0.2f}, .second = protostar::Color{0.6f}, .size = 2}};

/// Builds the scene, with what the spheres are made of. It names the types that scene files know, so that
/// their pictures are compiled once.
inline protostar::AnyScene four_spheres(const std::array<protostar::Material, 4>& materials) {
  protostar::AnyScene scene;
  for (std::size_t i = 0; i < materials.size(); ++i) scene.add(the_four_spheres[i], materials[i]);
  for (const protostar::Point& position :
       {protostar::Point{-20, 20, -20}, protostar::Point{30, 50, 25}, protostar::Point{30, 20, -30}})
    scene.add(protostar::ConstantLight{.position = position, .intensity = protostar::Color{1}});
  scene.set_sky({0.2f, 0.7f, 0.8f});
  return scene;
}

/// The camera that looks at them, with a field of view of 1.05 radians.
inline protostar::Camera camera_of_four_spheres() {
  return protostar::Camera::perspective({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.16056848873644);
}
