// Pictures that are drawn in passes: until their error is small enough, or their time is over.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <protostar/integrators/direct.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/protostar.hpp>
#include <protostar/sampling/every_pixel.hpp>
#include <protostar/sampling/samplers.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/known_light.hpp"
#include "support/ray_by_ray.hpp"

using namespace protostar;

namespace {

/// Scene of a lit ball, a mirror and a lamp over a floor.
Scene<Sphere, Plane> scene_in_passes() {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {-0.6, 0.1, 3}, .radius = 0.7}, Color{0.3f, 0.9f, 0.5f});
  scene.add(Sphere{.center = {0.7, -0.2, 3.5}, .radius = 0.6},
            Material{.diffuse = Color{0.3f, 0.1f, 0.7f}, .reflect = 0.4});
  scene.add(Sphere{.center = {0, 2, 2.5}, .radius = 0.3}, Material{.emission = Color{20}});
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -0.8}, Color{0.5f});
  scene.add(PointLight{.position = {1, 3, 0}, .power = Color{125.66f}});
  scene.set_sky(Color{0.3f, 0.5f, 0.7f});
  return scene;
}

std::string refusal_of(const RenderOptions& options, int width = 8, int height = 8) {
  Image image(width, height);
  return message_of<std::invalid_argument>([&] {
    render(
        image, Camera{}, [](const Ray&) { return Color{1}; }, options);
  });
}

}  // namespace

TEST_CASE("a picture of some error has the bytes of as many samples at once", "[bytes]") {
  const auto scene = scene_in_passes();
  const DirectIntegrator direct(scene);
  const auto check = [&](const auto& integrator, double error) {
    RenderReport report;
    Image expected(40, 30), noise(1, 1);
    RenderOptions options{.seed = 7, .error = error, .report = &report, .standard_error = &noise};
    options.tiles = false;
    options.threads = 1;
    render(expected, Camera{}, scene, integrator, options);
    CHECK(report.is_met);
    CHECK(report.bound <= error);
    CHECK(report.error < report.bound);
    CHECK(report.samples >= 16);
    CHECK((report.samples & (report.samples - 1)) == 0);
    CHECK(report.seconds_left == 0);
    CHECK(noise.width() == 40);

    Image image(40, 30);
    options.tiles = true;
    options.threads = 3;
    render(image, Camera{}, scene, integrator, options);
    CHECK(different_bytes(image, expected) == 0);
    render(image, Camera{}, accelerate(scene), integrator, options);
    CHECK(different_bytes(image, expected) == 0);
    render(image, Camera{}, scene, integrator,
           {.samples = report.samples, .sampler = sampler_of<SobolSampler>, .seed = 7});
    CHECK(different_bytes(image, expected) == 0);
  };
  check(WhittedIntegrator{.depth = 2}, 0.02);
  check(ShadowIntegrator{}, 0.05);
  check(direct, 0.05);
}

TEST_CASE("standard errors of a number of samples are those of its film") {
  const auto scene = scene_in_passes();
  Image noise(1, 1), image(30, 20), expected(30, 20);
  RenderReport report;
  render(image, Camera{}, scene, ShadowIntegrator{},
         {.samples = 8,
          .report = &report,
          .standard_error = &noise,
          .crop = {.x = 5, .y = 7, .width = 60, .height = 40}});
  CHECK(report.samples == 8);
  CHECK(report.is_met);
  Film film(Tile{5, 7, 35, 27});
  add_samples(film, {0, 8}, Camera{}, scene, ShadowIntegrator{},
              {.samples = 8, .sampler = sampler_of<SobolSampler>, .crop = {.width = 60, .height = 40}});
  CHECK(different_bytes(noise, film.standard_error()) == 0);
  CHECK(different_bytes(image, film.mean()) == 0);
  CHECK(report.error == film.error().rmse());
  render(expected, Camera{}, scene, ShadowIntegrator{},
         {.samples = 8,
          .sampler = sampler_of<SobolSampler>,
          .crop = {.x = 5, .y = 7, .width = 60, .height = 40}});
  CHECK(different_bytes(image, expected) == 0);
}

TEST_CASE("the estimate is the mean squared error of pictures whose truth is known, on average") {
  constexpr int seeds = 200;
  for (const KnownLight& known : known_lights()) {
    double estimated = 0, truly = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      RenderReport report;
      Image image(KnownLight::width, KnownLight::height), noise(1, 1);
      render(image, Camera{}, known,
             {.samples = 8,
              .seed = static_cast<std::uint64_t>(seed),
              .report = &report,
              .standard_error = &noise});
      estimated += report.error * report.error / seeds;
      truly += known.squared_error(image) / seeds;
    }
    // Either mean is of 384 · 200 pixels; v and e have relative deviations of about 1.5, or √(1/.03) = 6
    // where one pixel in 30 has all of the error. 6/√76800 = .022 is exceeded fivefold by chance in 10^-6 of
    // runs.
    CAPTURE(known.name, estimated, truly);
    CHECK(std::abs(estimated / truly - 1) < 0.11);
  }
}

TEST_CASE("pictures of known light keep their error targets") {
  const int seeds = cases(20, 200);
  for (const KnownLight& known : known_lights())
    for (const auto sampler : {sampler_of<SobolSampler>, sampler_of<IndependentSampler>}) {
      const double error = sampler == sampler_of<SobolSampler> ? 0.01 : 0.04;
      int over = 0, unmet = 0;
      for (int seed = 0; seed < seeds; ++seed) {
        RenderReport report;
        Image image(KnownLight::width, KnownLight::height);
        render(image, Camera{}, known,
               {.sampler = sampler,
                .seed = static_cast<std::uint64_t>(seed),
                .error = error,
                .report = &report});
        over += std::sqrt(known.squared_error(image)) > error;
        unmet += !report.is_met;
      }
      CAPTURE(known.name, error);
      CHECK(over * 20 <= seeds);  // 5 %
      CHECK(unmet == 0);
    }
}

TEST_CASE("a picture takes little more than the samples that its error needs") {
  // An oracle knows the error, and stops at the first of these numbers at which it is small enough.
  double logarithms = 0;
  int count = 0;
  for (const KnownLight& known : known_lights()) {
    if (known.name == "rare" || known.name == "smooth") continue;  // done at the first look, or nearly
    std::vector<double> squares(65, 0);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Film film(Tile{0, 0, KnownLight::width, KnownLight::height});
      for (std::uint32_t k = 1; k <= 64; ++k) {
        add_samples(film, {2 * k - 2, 2 * k}, Camera{}, known,
                    {.samples = 128, .sampler = sampler_of<SobolSampler>, .seed = 1000 + seed, .threads = 1});
        squares[k] += known.squared_error(film.mean()) / 20;
      }
    }
    for (const double error : {0.02, 0.017, 0.014, 0.012, 0.01}) {
      int oracle = 1;
      while (oracle < 64 && squares[static_cast<std::size_t>(oracle)] > error * error) ++oracle;
      RenderReport report;
      Image image(KnownLight::width, KnownLight::height);
      render(image, Camera{}, known, {.error = error, .report = &report, .threads = 1});
      logarithms += std::log(report.samples / (2.0 * oracle));
      ++count;
    }
  }
  CHECK(std::exp(logarithms / count) < 2.2);
}

TEST_CASE("ordinary pictures keep their error targets, against pictures of many samples", "[bytes]") {
  const int seeds = cases(3, 200);
  const int coarser = cases(4, 2, 1);  // errors twice as large take a quarter of the samples
  const auto scene = scene_in_passes();
  const auto check = [&](const auto& integrator, double error) {
    // The reference has at least 16 times as many samples as the pictures, so that its error adds at most
    // √(1 + 1/16) = 3 % even if it falls as samples^-1/2.
    Image reference(24, 18), image(24, 18);
    int over = 0, most = 0;
    std::vector<Image> images;
    for (int seed = 0; seed < seeds; ++seed) {
      RenderReport report;
      render(image, Camera{}, scene, integrator,
             {.seed = static_cast<std::uint64_t>(seed), .error = error, .report = &report});
      CHECK(report.is_met);
      most = std::max(most, report.samples);
      images.push_back(image);
    }
    render(reference, Camera{}, scene, integrator,
           {.samples = 16 * most, .sampler = sampler_of<SobolSampler>, .seed = 12345});
    for (const Image& drawn : images) {
      double sum = 0;
      for (int y = 0; y < 18; ++y)
        for (int x = 0; x < 24; ++x) {
          const Color d = drawn(x, y) - reference(x, y);
          sum += (d.r * d.r + d.g * d.g + d.b * d.b) / (3.0 * 24 * 18);
        }
      over += std::sqrt(sum) > error;
    }
    CHECK(over * 20 <= seeds);
  };
  check(ShadowIntegrator{}, coarser * 0.02);
  check(WhittedIntegrator{.depth = 3}, coarser * 0.02);
  check(DirectIntegrator(scene), coarser * 0.03);
}

TEST_CASE("a target that is not met ends at the largest number of samples, and is reported") {
  const std::vector<KnownLight> lights = known_lights();
  RenderReport report;
  Image image(KnownLight::width, KnownLight::height), expected = image;
  const RenderOptions options{.error = 1e-4, .max_samples = 50, .report = &report};
  render(image, Camera{}, lights[0], options);
  CHECK(report.samples == 50);
  CHECK_FALSE(report.is_met);
  CHECK(report.bound > 1e-4);
  render(expected, Camera{}, lights[0], {.samples = 50});
  CHECK(different_bytes(image, expected) == 0);
  RenderOptions few = options;
  few.max_samples = 7;
  render(image, Camera{}, lights[0], few);
  CHECK(report.samples == 7);
}

TEST_CASE("a picture in some time has the bytes of the samples it reports") {
  const KnownLight known = known_lights()[3];
  RenderReport report;
  Image image(KnownLight::width, KnownLight::height), expected = image;
  for (const double seconds : {1e-9, 0.05, 0.3}) {
    const auto start = std::chrono::steady_clock::now();
    render(image, Camera{}, known, {.seconds = seconds, .report = &report});
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    CAPTURE(seconds, taken.count(), report.samples);
    CHECK(taken.count() < seconds + 5);  // on a machine that is busy otherwise
    CHECK(report.samples >= 2);
    CHECK(report.samples % 2 == 0);
    CHECK(report.is_met);
    CHECK(report.error < 1);
    render(expected, Camera{}, known, {.samples = report.samples});
    CHECK(different_bytes(image, expected) == 0);
  }
  CHECK(report.samples > 2);
  render(image, Camera{}, known, {.seconds = 60, .max_samples = 33, .report = &report});
  CHECK(report.samples == 33);
}

TEST_CASE("every pixel of pictures is within its error") {
  const int seeds = cases(1, 20);
  for (const KnownLight& known : known_lights()) {
    if (known.name == "smooth") continue;  // brighter than the clamp
    for (int seed = 0; seed < seeds; ++seed) {
      RenderReport report;
      Image image(KnownLight::width, KnownLight::height);
      const double error = 0.1;
      const RenderOptions options{.seed = static_cast<std::uint64_t>(seed),
                                  .clamp = 1,
                                  .error = error,
                                  .every_pixel = true,
                                  .report = &report,
                                  .threads = 1 + seed % 2};
      render(image, Camera{}, known, options);
      CAPTURE(known.name, seed, report.samples);
      CHECK(report.is_met);
      CHECK(report.pixel_error <= error);
      CHECK(report.samples >= report.least_samples);
      CHECK(report.least_samples == EveryPixel(error, 1, image.tile()).least_samples());
      CHECK(known.largest_error(image) <= error);
      if (seed > 0) continue;
      Image again(KnownLight::width, KnownLight::height);
      RenderOptions other = options;
      other.threads = 3;
      render(again, Camera{}, known, other);
      CHECK(different_bytes(image, again) == 0);
    }
  }
}

TEST_CASE("the price of every pixel grows with the clamp and with the logarithm of the pixels") {
  const Tile picture{0, 0, 640, 480};
  // ln(2 · 3 · 307200/.05) = 17.42, and 17.42/(.75 · .01) = 2323.03 asks for 2324 observations of 8 samples,
  // two in a block.
  CHECK(EveryPixel(0.01, 1, picture).samples_of_block() == 16);
  CHECK(EveryPixel(0.01, 1, picture).least_samples() == 1162 * 16);
  CHECK(EveryPixel(0.01, 100, picture).least_samples() == 116152 * 2);
  CHECK(EveryPixel::seed_of_block(5, 0) == 5);
  CHECK(EveryPixel::seed_of_block(5, 1) != EveryPixel::seed_of_block(5, 2));
}

TEST_CASE("every pixel is known no better than its samples count, and its float is what is known") {
  const Tile one{0, 0, 1, 1};
  constexpr double error = 0.1;
  EveryPixel pixels(error, 1, one);
  BernsteinSequence expected(BernsteinRule(1, error - 0x1p-48, (1 - PictureError::confidence) / 3));
  Film picture(one), block(one);
  const float light = 0.7f;  // two thirds of it are no float
  for (int i = 0; i < 3; ++i) {
    block(0, 0).add(0, Color{light}), block(0, 0).add(1, Color{0}), block(0, 0).add(2, Color{light});
    expected.add(light), expected.add(0);
    const double found = pixels.add(block, picture, {.threads = 1});
    CHECK(found == expected.error_of(picture.mean()(0, 0).r) + 0x1p-48);
  }

  // Light below 2^-48 counts as black, so that no error of 2^-48 or less can be kept.
  constexpr float dark = 3e-15f;
  const auto drawn = [&](double target) {
    Image image(1, 1);
    RenderReport report;
    render(image, Camera{}, [&](const Ray&) { return Color{dark}; },
           {.clamp = 1e-14, .error = target, .every_pixel = true, .report = &report});
    CHECK(report.is_met);
    CHECK(report.pixel_error >= dark - image(0, 0).r);
    CHECK(report.pixel_error <= target);
  };
  drawn(4e-15);
  for (const double wrong : {1e-15, 0x1p-48}) {
    CHECK_THAT(message_of<std::invalid_argument>([&] { EveryPixel(wrong, 1e-14, one); }),
               ContainsSubstring("EveryPixel: error must be greater than 2^-48 (3.6e-15)"));
    CHECK_THAT(message_of<std::invalid_argument>([&] { drawn(wrong); }),
               ContainsSubstring("must be greater than 2^-48 (3.6e-15)"));
  }
  for (const double clamp : {0.0, infinity, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THAT(message_of<std::invalid_argument>([&] { EveryPixel(0.1, clamp, one); }),
               ContainsSubstring("EveryPixel: clamp must be finite and greater than 0"));
}

TEST_CASE("progress of passes never goes back, and the report goes with it") {
  const KnownLight known = known_lights()[0];
  for (const RenderOptions& kind : {RenderOptions{.error = 0.02}, RenderOptions{.seconds = 0.05},
                                    RenderOptions{.clamp = 1, .error = 0.2, .every_pixel = true}}) {
    RenderOptions options = kind;
    RenderReport report;
    double last = 0;
    int calls = 0, back = 0;
    options.report = &report;
    options.progress = [&](double done) {
      back += done < last || done > 1;
      last = done;
      ++calls;
    };
    Image image(KnownLight::width, KnownLight::height);
    render(image, Camera{}, known, options);
    CHECK(back == 0);
    CHECK(last == 1);
    CHECK(calls > 3);
    CHECK(report.samples > 0);
  }
}

TEST_CASE("a picture in passes that is stopped leaves the image as it was") {
  const KnownLight known = known_lights()[0];
  Image image(KnownLight::width, KnownLight::height);
  int asked = 0;
  render(image, Camera{}, known,
         {.error = 1e-9, .threads = 1, .stop = StopToken([&] { return ++asked > 20; })});
  CHECK(image(3, 3) == Color{0});
}

TEST_CASE("options of passes that make no sense are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {-1.0, infinity, nan}) {
    CHECK_THAT(refusal_of({.error = wrong}), ContainsSubstring("RenderOptions: error must be finite"));
    CHECK_THAT(refusal_of({.seconds = wrong}), ContainsSubstring("RenderOptions: seconds must be finite"));
  }
  CHECK(refusal_of({.samples = 4, .error = 0.5}) ==
        "RenderOptions: only one of samples, error and seconds may be given; they are 4, 0.5 and 0");
  CHECK_THAT(refusal_of({.error = 1, .seconds = 1}), ContainsSubstring("only one of samples, error and sec"));
  CHECK_THAT(refusal_of({.error = 1, .max_samples = 1}), ContainsSubstring("max_samples must be from 2 to"));
  CHECK_THAT(refusal_of({.error = 1}, 31, 1), ContainsSubstring("32 pixels or more"));
  CHECK(refusal_of({.error = 1}, 32, 1).empty());
  for (const auto sampler : {sampler_of<HammersleySampler>, sampler_of<StratifiedSampler>})
    CHECK_THAT(refusal_of({.sampler = sampler, .seconds = 1}), ContainsSubstring("need a sampler whose"));
  CHECK_THAT(refusal_of({.error = 1, .every_pixel = true}), ContainsSubstring("every_pixel needs a clamp"));
  CHECK_THAT(refusal_of({.clamp = 1, .every_pixel = true}), ContainsSubstring("every_pixel needs an error"));
  CHECK_THAT(
      refusal_of({.filter = ReconstructionFilter::mitchell(), .clamp = 1, .error = 1, .every_pixel = true}),
      ContainsSubstring("a filter whose weights are 1"));
  CHECK_THAT(refusal_of({.clamp = 1, .error = 1e-4, .every_pixel = true}),
             ContainsSubstring("more than max_samples, 65536"));
  Image noise(1, 1);
  CHECK_THAT(refusal_of({.samples = 1, .standard_error = &noise}), ContainsSubstring("at least 2"));
  CHECK_THAT(refusal_of({.error = 1, .crop = {.x = 5, .width = 9, .height = 9}}),
             ContainsSubstring("is not inside 9x9"));
  constexpr int least = std::numeric_limits<int>::min();
  CHECK_THAT(refusal_of({.samples = 4, .standard_error = &noise, .crop = {1, 0, least, 4}}),
             ContainsSubstring("is not inside -2147483648x4"));
  Film film(Tile{0, 0, 8, 8});
  CHECK_THAT(message_of<std::invalid_argument>([&] {
               add_samples(film, {0, 1}, Camera{}, [](const Ray&) { return Color{1}; }, {.error = 1});
             }),
             ContainsSubstring("options of an image, not of a film"));
}
