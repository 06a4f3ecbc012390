#include "unit.hpp"

#include <typeinfo>

DECLARE_UNIT(UNIT)

const char* UNIT::scene_type() { return typeid(protostar::Scene<protostar::Sphere>).name(); }

Function UNIT::inline_function() { return reinterpret_cast<Function>(&protostar::quadratic_roots); }

std::vector<protostar::Color> UNIT::picture() {
  using namespace protostar;
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{1, 0.3f, 0});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.5f});
  scene.add(PointLight{.position = {0, 3, 0}, .power = Color{125.66f}});
  Image image(160, 120);
  render(image, Camera{}, scene, ShadowIntegrator{});
  std::vector<Color> pixels;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) pixels.push_back(image(x, y));
  return pixels;
}
