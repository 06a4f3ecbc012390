// Pictures of moving surfaces, and by moving cameras.
#include <protostar/surfaces/moving.hpp>

#include <cmath>
#include <cstdint>
#include <protostar/accel/accelerate.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/samplers.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/light_truth.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

using MovingScene = Scene<Sphere, Plane, Moving<Sphere>, Moving<Mesh>, AnySurface>;

MovingScene moving_scene(int count) {
  MovingScene scene;
  Random random(11);
  const auto material = [&](int i) {
    return Material{.diffuse = random.color(),
                    .reflect = i % 3 == 0 ? 0.4 : 0,
                    .refract = i % 3 == 1 ? 0.4 : 0,
                    .ior = 1.4};
  };
  const auto place = [&] { return Point{random.real(-4, 4), random.real(-1, 3), random.real(2, 9)}; };
  for (int i = 0; i < count; ++i) {
    const Sphere sphere{.center = place(), .radius = random.real(0.1, 0.5)};
    if (i % 4 == 0) scene.add(sphere, material(i));
    if (i % 4 == 1) scene.add(Moving<Sphere>(sphere, random.point(1)), material(i));
    if (i % 4 == 2) scene.add(AnySurface(Moving<>(AnySurface(sphere), random.point(0.5))), material(i));
    if (i % 4 == 3)
      scene.add(AnySurface(Moving<Box>({sphere.center, sphere.center + Vec3{0.3}}, random.point(1))),
                material(i));
  }
  const Mesh torus(meshes::moved(meshes::torus(20, 10), 0.7, {1.1, 0.2, 4}), {.threads = 1});
  scene.add(Moving<Mesh>(torus, {-0.5, 0.25, 0}), Color{0.2f, 0.7f, 0.3f});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1},
            Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  scene.add(PointLight{.position = {0, 5, 0}, .power = Color{300}});
  scene.set_sky(Color{0.3f, 0.5f, 0.7f});
  return scene;
}

}  // namespace

TEST_CASE(
    "a picture by one ray a pixel shows moving surfaces halfway, and a shutter of no length stills them") {
  Scene<Moving<Sphere>> moving;
  moving.add(Moving<Sphere>({{0, 0, 4}, 1}, {1, 0.5, 0}), Color{1});
  Scene<Sphere> halfway;
  halfway.add(Sphere{{0.5, 0.25, 4}, 1}, Color{1});
  for (const bool tiles : {false, true}) {
    Image a(48, 36), b(48, 36);
    render(a, Camera{}.with_shutter(0, 1), moving, NormalIntegrator{}, {.tiles = tiles});
    render(b, Camera{}, halfway, NormalIntegrator{}, {.tiles = tiles});
    CHECK(different_pixels(a, b) == 0);
    render(a, Camera{}.with_shutter(0.5, 0.5), moving, NormalIntegrator{}, {.samples = 4, .tiles = tiles});
    render(b, Camera{}, halfway, NormalIntegrator{}, {.samples = 4, .tiles = tiles});
    CHECK(different_pixels(a, b) == 0);
  }
}

TEST_CASE("pictures of moving surfaces have the same bytes ray by ray, by tiles and with a tree") {
  const std::vector<Camera> cameras{
      Camera::perspective({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60).with_shutter(0, 1),
      Camera::thin_lens({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60, 0.2, 5).with_shutter(0.25, 0.75),
      Camera::orthographic({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 4).with_shutter(0, 1),
      Camera::perspective({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60)
          .with_shutter(0, 1)
          .with_velocity({0.5, -0.25, 1}),
      Camera::thin_lens({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 60, 0.2, 5)
          .with_shutter(0.25, 0.75)
          .with_velocity({-1, 0.5, 0.5}),
      Camera::orthographic({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 4)
          .with_shutter(0, 1)
          .with_velocity({0.5, 0.25, 1}),
      Camera::sensor({0, 0.5, -1}, {0, 0, 1}, {0, 1, 0}, 1).with_shutter(0.5, 1).with_velocity({-1, 0, 0.5})};
  std::size_t round = 0;
  for (const int count : {8, 200, 2600}) {
    if (count > cases(200, 2600, 2600)) continue;
    const MovingScene scene = moving_scene(count);
    const auto fast = accelerate(scene);
    for (const auto sampler : sampler_names) {
      RenderOptions options{.samples = std::vector{2, 0, 3}[round % 3],
                            .sampler = *sampler_named(sampler),
                            .seed = round,
                            .threads = 2};
      const Camera& camera = cameras[round % cameras.size()];
      CAPTURE(count, sampler, round % cameras.size(), options.samples);
      ++round;
      const auto differ = [&](const auto& integrator) {
        Image plain(41, 33), tiles(41, 33), tree(41, 33);
        options.tiles = false;
        if (count < 1000) render(plain, camera, scene, integrator, options);
        render(tree, camera, fast, integrator, options);
        options.tiles = true;
        render(tiles, camera, scene, integrator, options);
        return different_pixels(tree, tiles) + (count < 1000 ? different_pixels(plain, tiles) : 0);
      };
      CHECK(differ(NormalIntegrator{}) == 0);
      CHECK(differ(ColorIntegrator{}) == 0);
      CHECK(differ(ShadowIntegrator{}) == 0);
      if (count == 8) {
        CHECK(differ(TransparencyIntegrator{}) == 0);
        CHECK(differ(WhittedIntegrator{.depth = 4}) == 0);
      }
    }
  }
}

TEST_CASE("an edge in motion fades linearly over its way, pixel by pixel") {
  // The edge is seen at u = (e + t w)/d at time t. Of the times from 0 to 1, the share s = (u d − e)/w,
  // between 0 and 1, has the board at u. Its integral is H.
  const auto integral = [](double s) { return s <= 0 ? 0 : s >= 1 ? s - 0.5 : s * s / 2; };
  constexpr int width = 32, height = 4, samples = PROTOSTAR_LONG_FORMS ? 1024 : 32;
  struct {
    double depth, edge, way;
  } const rows[] = {{1, -1, 4}, {2, 1, 6}, {0.5, -1, 0.75}};
  for (const auto& row : rows)
    for (const SamplerChoice& sampler :
         {sampler_of<SobolSampler>, sampler_of<HaltonSampler>, sampler_of<StratifiedSampler>}) {
      CAPTURE(row.depth, row.edge, row.way);
      const Parallelogram board{{row.edge, -1000, row.depth}, {1000, 0, 0}, {0, 2000, 0}};
      Scene<Moving<Parallelogram>> scene;
      scene.add(Moving<Parallelogram>(board, {row.way / 0.5, 0, 0}, {2, 2.5}), Color{1});
      Scene<Parallelogram> still;
      still.add(board, Color{1});
      // The way begins at time 2, at the edge.
      const Camera camera = Camera{.position = {4 * row.way, 0, 0}}.with_shutter(2, 2.5);
      std::vector<Image> pictures;
      for (int r = 0; r < LightTruth::scramblings; ++r) {
        pictures.emplace_back(width, height);
        const RenderOptions options{
            .samples = samples, .sampler = sampler, .seed = static_cast<std::uint64_t>(r)};
        render(pictures.back(), camera, scene, ColorIntegrator{}, options);
        // At rest, before a camera that moves to the other side instead, the edge has the same picture.
        Image from_camera(width, height);
        render(from_camera, camera.with_velocity({-row.way / 0.5, 0, 0}), still, ColorIntegrator{}, options);
        CHECK(different_pixels(from_camera, pictures.back()) == 0);
      }
      LightTruth truth;
      for (int x = 0; x < width; ++x) {
        const auto share = [&](int column) {
          return (Camera::u_at(column, width, height) * row.depth - row.edge) / row.way;
        };
        const double from = share(x), to = share(x + 1);
        for (int y = 0; y < height; ++y) {
          std::vector<double> means;
          for (const Image& picture : pictures) means.push_back(picture(x, y).g);
          truth.compare(means, (integral(to) - integral(from)) / (to - from), "pixel", x, y);
        }
      }
      CHECK(truth.wrong == 0);
      CHECK(truth.lit > width / 2);
      CHECK(std::abs(truth.mean_error) <=
            LightTruth::most_errors * std::sqrt(truth.variance) + 0x1p-20 * truth.mean_truth);
      CHECK(truth.detectable_bias() < (PROTOSTAR_LONG_FORMS ? 2e-3 : 0.02));
    }
}

TEST_CASE("a moving camera sees what one at rest sees if all surfaces move to the other side") {
  // Origins of rays are o + t v, and in the surfaces' space o − t (−v), which is equal.
  const Vec3 velocity{1.25, -0.5, 2};
  Scene<Sphere, Parallelogram> still;
  Scene<Moving<Sphere>, Moving<Parallelogram>> moving;
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const Sphere sphere{{random.real(-4, 4), random.real(-3, 3), random.real(3, 9)}, random.real(0.1, 0.6)};
    const Material material{.diffuse = random.color()};
    still.add(sphere, material);
    moving.add(Moving<Sphere>(sphere, -velocity), material);
  }
  const Parallelogram board{{-9, -3, -2}, {18, 0, 0}, {0, 1, 20}};
  still.add(board, Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  moving.add(Moving<Parallelogram>(board, -velocity),
             Material{.texture = Checker{.first = Color{0.8f}, .second = Color{0.1f}}});
  const Point from{0.25, 0.5, -1};
  const Vec3 forwards{0, 0, 1}, upwards{0, 1, 0};
  for (const Camera& camera :
       {Camera::perspective(from, forwards, upwards, 60),
        Camera::thin_lens(from, forwards, upwards, 60, 0.2, 5),
        Camera::orthographic(from, forwards, upwards, 4), Camera::sensor(from, forwards, upwards, 1)})
    for (const Shutter& shutter : {Shutter{0, 1}, Shutter{0.5, 0.5}, Shutter{0.25, 1}})
      for (const int samples : {0, 3})
        for (const bool tiles : {false, true}) {
          const Camera rests = camera.with_shutter(shutter.opens, shutter.closes);
          const RenderOptions options{.samples = samples, .tiles = tiles};
          const auto differ = [&](const auto& integrator) {
            Image a(33, 25), b(33, 25);
            render(a, rests.with_velocity(velocity), still, integrator, options);
            render(b, rests, moving, integrator, options);
            return different_pixels(a, b);
          };
          CAPTURE(shutter.opens, samples, tiles, camera.aperture);
          CHECK(differ(NormalIntegrator{}) == 0);
          CHECK(differ(ColorIntegrator{}) == 0);
        }
}
