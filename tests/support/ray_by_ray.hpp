// Pictures drawn ray by ray, and a comparison by bytes with those drawn otherwise.
#pragma once

#include <cstring>
#include <protostar/camera.hpp>
#include <protostar/image.hpp>
#include <protostar/vec3.hpp>

#include "pictures.hpp"

/// Returns the number of pixels whose bytes differ between two pictures of one size.
inline int different_bytes(const protostar::Image& a, const protostar::Image& b) {
  return count_pixels(
      a, [&](int x, int y) { return std::memcmp(&a(x, y), &b(x, y), sizeof(protostar::Color)) != 0; });
}

/// Returns the picture drawn ray by ray, without render().
inline protostar::Image ray_by_ray(const protostar::Camera& camera, int width, int height, const auto& scene,
                                   const auto& integrator) {
  protostar::Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image(x, y) = integrator.radiance(camera.through_pixel(x, y, width, height), scene);
  return image;
}
