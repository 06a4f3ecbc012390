// Marched surfaces in scenes, pictures, instances, in motion and as solids: they are as other surfaces are.
#include <cmath>
#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/path.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/moving.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/drawn_alike.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("of a marched surface and another at equal t the first in the scene is hit, counted as undecided") {
  const Ray ray{.origin = {0.3, -0.2, -4}, .direction = {0, 0, 1}};
  Scene<AnySurface> scene;
  scene.add(Marched(sphere_field, cube_bounds(1)), Color{1, 0, 0});
  scene.add(Sphere{}, Color{0, 1, 0});
  fallbacks = {};
  CHECK(scene.intersect(ray)->color() == Color{1, 0, 0});
  CHECK(fallbacks.undecided > 0);

  Scene<AnySurface> turned;
  turned.add(Sphere{}, Color{0, 1, 0});
  turned.add(Marched(sphere_field, cube_bounds(1)), Color{1, 0, 0});
  CHECK(turned.intersect(ray)->color() == Color{0, 1, 0});

  // A sphere that is larger by 2^-50 is hit first.
  Scene<AnySurface> larger;
  larger.add(Marched(sphere_field, cube_bounds(1)), Color{1, 0, 0});
  larger.add(Sphere{.radius = 1 + 0x1p-50}, Color{0, 1, 0});
  CHECK(larger.intersect(ray)->color() == Color{0, 1, 0});
}

TEST_CASE("marched surfaces look alike ray by ray, by tiles and through the tree") {
  Scene<Marched<decltype(torus_field)>, Marched<decltype(blend_field)>, Sphere> scene;
  scene.add(Marched(torus_field, cube_bounds(1.3)), Color{0.8f, 0.6f, 0.3f});
  scene.add(Marched(blend_field, cube_bounds(1.4)), Color{0.3f, 0.6f, 0.8f});
  scene.add(Sphere{.center = {0.9, 0.4, -0.5}, .radius = 0.5},
            Material{.diffuse = Color{0.5f}, .reflect = 0.4});
  scene.add(PointLight{.position = {4, 3, -4}, .power = Color{400}});
  const Camera camera{.position = {0, 0.5, -2.2}};
  const DrawnAlike drawn = drawn_alike(scene, camera);
  CHECK(drawn.lit > 200);
  CHECK(drawn.different == 0);

  Scene<AnySurface> any;
  any.add(Marched(torus_field, cube_bounds(1.3)), Color{0.8f, 0.6f, 0.3f});
  CHECK(drawn_alike(any, camera, DepthIntegrator{}).different == 0);
}

TEST_CASE("a marched surface in an instance, in motion and as part of a solid is hit as exact ones are") {
  const Affine placement = Affine{}.rotated_about({1, 2, 3}, 40);
  Random random(5);
  WrongCases wrong(random);
  const Marched marched(box_field, cube_bounds(1));
  const Box exact{.min = {-1, -0.7, -0.5}, .max = {1, 0.7, 0.5}};
  const auto compare = [&](const auto& a, const auto& b) {
    for (int i = 0; i < cases(40, 4000); ++i) {
      Ray ray = ray_into(random, 1);
      ray.time = 0.5;
      const auto as = crossings_of(a, ray, everywhere), bs = crossings_of(b, ray, everywhere);
      bool is_equal = as.size() == bs.size();
      for (std::size_t k = 0; is_equal && k < as.size(); ++k) is_equal = std::abs(as[k] - bs[k]) < 1e-8;
      wrong.add(!is_equal, ray, as, bs);
    }
  };
  compare(Instance(marched, placement), Instance(exact, placement));
  compare(Moving(marched, {0.3, 0, 0.1}), Moving(exact, {0.3, 0, 0.1}));
  const Sphere hole{.center = {0.2, 0.1, 0}, .radius = 0.6};
  compare(difference_of({marched, hole}), difference_of({exact, hole}));
  compare(union_of({hole, marched}), union_of({hole, exact}));
  CHECK(wrong == 0);
}

TEST_CASE("a marched surface is a solid if its field is above 0 all around") {
  CHECK(Marched(sphere_field, cube_bounds(1)).is_solid());
  CHECK(Marched(torus_field, cube_bounds(1.5)).is_solid());
  const auto slab = [](const auto& p) { return abs(p.y) - 0.5; };
  const Marched cut(slab, cube_bounds(1));
  CHECK_FALSE(cut.is_solid());
  CHECK_THROWS_AS(Csg(cut), std::invalid_argument);
}

TEST_CASE("paths and mirrors light marched surfaces") {
  Scene<AnySurface> scene;
  scene.add(Marched(gyroid_field, cube_bounds(1.4), 4000), Color{0.8f, 0.6f, 0.3f});
  scene.set_sky(Color{1});
  Image image(16, 12);
  fallbacks = {};
  render(image, Camera{.position = {0, 0, -2.2}}, scene, PathIntegrator(scene),
         RenderOptions{.samples = 2, .threads = 1});
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) != Color{1}; }) > 20);
  CHECK(fallbacks.undecided == 0);
}
