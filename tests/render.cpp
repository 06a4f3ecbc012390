#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/pictures.hpp"

using namespace protostar;

namespace {
const auto direction_as_color = [](const Ray& ray) { return Color{ray.direction}; };

struct Height {
  Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray);
    return hit ? Color{static_cast<float>(hit->point().y)} : Color{-1e9f};
  }
};

/// Radiance that makes all threads wait until the caller's thread has traced a ray, so that it surely takes
/// part.
class CallerTakesPart {
 public:
  Color operator()(const Ray&) const {
    if (std::this_thread::get_id() == caller_) *has_work_ = true;
    while (!*has_work_) std::this_thread::yield();
    return Color{1};
  }

 private:
  std::thread::id caller_ = std::this_thread::get_id();
  std::shared_ptr<std::atomic<bool>> has_work_ = std::make_shared<std::atomic<bool>>(false);
};

/// Surface that throws at its hundredth intersection test.
struct Fragile {
  std::atomic<int>* count;
  std::optional<double> intersect(const Ray&, Interval) const {
    if (++*count == 100) throw std::runtime_error("broken surface");
    return std::nullopt;
  }
  Vec3 normal_at(Point) const { return {0, 1, 0}; }
};

/// Integrator and radiance that refuse to be used.
struct Refusing {
  Color operator()(const Ray&) const { throw std::logic_error("a ray was traced"); }
  Color operator()(const Ray&, const auto&) const { throw std::logic_error("a ray was traced"); }
  void validate() const { throw std::invalid_argument("Refusing: never"); }
};

static_assert(Integrator<Height, Scene<Sphere>> && Integrator<ShadowIntegrator, Scene<AnySurface>>);
static_assert(Radiance<decltype(direction_as_color)> && !Radiance<Height>);
static_assert(!Integrator<int, Scene<>>);
}  // namespace

TEST_CASE("each pixel gets the radiance of the ray through its center") {
  const Camera camera{.position = {1, 2, 3}, .right = {0, 0, 1}, .forward = {2, 0, 0}};
  struct {
    int width, height;
  } const sizes[] = {{1, 1}, {1, 100}, {100, 1}, {31, 33}, {32, 32}, {64, 65}, {97, 5}};
  for (const auto& size : sizes)
    for (const int threads : {1, 2}) {
      CAPTURE(size.width, size.height, threads);
      Image image(size.width, size.height);
      std::atomic<int> calls = 0;
      render(image, camera,
             [&](const Ray& ray) {
               ++calls;
               return direction_as_color(ray);
             },
             {.threads = threads});
      CHECK(calls == size.width * size.height);
      CHECK(count_pixels(image, [&](int x, int y) {
              return image(x, y) != direction_as_color(camera.through_pixel(x, y, size.width, size.height));
            }) == 0);
    }
}

TEST_CASE("the options of render may be left out") {
  Image image(40, 40);
  render(image, Camera{}, [](const Ray&) { return Color{0.5f}; });
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0.5f}; }) == 0);
  render(image, Camera{}, three_spheres(), Height{});
  CHECK(image(20, 20).r != 0.5f);
}

TEST_CASE("an integrator is a struct or a function of ray and scene, the user's own as well") {
  const auto scene = three_spheres();
  Image structure(64, 48), generic(64, 48), typed(64, 48), captured(64, 48);
  render(structure, Camera{}, scene, Height{});
  render(generic, Camera{}, scene,
         [](const Ray& ray, const auto& traced) { return Height{}.radiance(ray, traced); });
  render(typed, Camera{}, scene,
         [](const Ray& ray, const Scene<Sphere>& traced) { return Height{}.radiance(ray, traced); });
  render(captured, Camera{}, [&](const Ray& ray) { return Height{}.radiance(ray, scene); });
  CHECK(count_pixels(structure, [&](int x, int y) { return structure(x, y).r > -1e9f; }) > 1000);
  CHECK(different_pixels(structure, generic) == 0);
  CHECK(different_pixels(structure, typed) == 0);
  CHECK(different_pixels(structure, captured) == 0);
}

TEST_CASE("the picture is the same for any number of threads") {
  const auto scene = three_spheres();
  Image expected(150, 110);
  render(expected, Camera{}, scene, ShadowIntegrator{}, {.threads = 1});
  CHECK(count_pixels(expected, [&](int x, int y) { return expected(x, y) != Color{0}; }) > 5000);
  for (const int threads : {0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 64, 1000}) {
    CAPTURE(threads);
    Image image(150, 110);
    render(image, Camera{}, scene, ShadowIntegrator{}, {.threads = threads});
    CHECK(different_pixels(image, expected) == 0);
  }
}

TEST_CASE("a negative number of threads is refused") {
  Image image(4, 4);
  for (const int threads : {-1, -64, std::numeric_limits<int>::min()})
    CHECK_THAT(message_of<std::invalid_argument>(
                   [&] { render(image, Camera{}, direction_as_color, {.threads = threads}); }),
               ContainsSubstring("RenderOptions: threads must be 0 (all cores) or more; it is " +
                                 std::to_string(threads)));
}

TEST_CASE("an integrator or a function of a ray may be refused by its validate(), before a ray is traced") {
  Image image(4, 4);
  CHECK(message_of<std::invalid_argument>([&] { render(image, Camera{}, Refusing{}); }) == "Refusing: never");
  CHECK(message_of<std::invalid_argument>([&] { render(image, Camera{}, three_spheres(), Refusing{}); }) ==
        "Refusing: never");
}

TEST_CASE("an invalid camera is refused before a ray is traced") {
  Image image(4, 4);
  const auto never = [](const Ray&) -> Color { throw std::logic_error("a ray was traced"); };
  CHECK_THAT(message_of<std::invalid_argument>([&] {
               render(image, Camera{.forward = {0, 0, 0}}, never);
             }),
             ContainsSubstring("Camera"));
  CHECK_THAT(message_of<std::invalid_argument>([&] {
               render(image, Camera{.up = {0, 0, 1}}, three_spheres(), Height{});
             }),
             ContainsSubstring("Camera"));
}

TEST_CASE("a render that is stopped ends early and leaves the other pixels unchanged") {
  for (const int threads : {1, 3}) {
    CAPTURE(threads);
    Image image(640, 640);  // 400 tiles
    for (int y = 0; y < 640; ++y)
      for (int x = 0; x < 640; ++x) image(x, y) = Color{-1};
    std::atomic<bool> stops = false;
    std::atomic<int> calls = 0;
    render(image, Camera{},
           [&](const Ray&) {
             if (++calls == 5000) stops = true;
             return Color{1};
           },
           {.threads = threads, .stop = [&] { return stops.load(); }});
    CHECK(calls >= 5000);
    CHECK(calls <= 5000 + 32 * 32 * threads);
    CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) == Color{1}; }) == calls);
    CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) == Color{-1}; }) == 640 * 640 - calls);
  }
  Image image(64, 64);
  render(image, Camera{}, [](const Ray&) { return Color{1}; }, {.stop = [] { return true; }});
  CHECK(count_pixels(image, [&](int x, int y) { return image(x, y) != Color{0}; }) == 0);
}

TEST_CASE("progress is reported in the caller's thread, as a rising share") {
  for (const int threads : {1, 2, 5}) {
    CAPTURE(threads);
    Image image(320, 200);
    std::vector<double> shares;
    bool own_thread = true;
    const auto caller = std::this_thread::get_id();
    render(image, Camera{}, CallerTakesPart{}, {.threads = threads, .progress = [&](double share) {
                                                  shares.push_back(share);
                                                  own_thread =
                                                      own_thread && std::this_thread::get_id() == caller;
                                                }});
    CHECK(own_thread);
    REQUIRE_FALSE(shares.empty());
    CHECK(shares.front() > 0);
    CHECK(shares.back() == 1);
    CHECK(std::adjacent_find(shares.begin(), shares.end(), std::greater_equal<>{}) == shares.end());
  }
}

TEST_CASE("progress of one thread is reported after each tile and ends with 1") {
  Image image(320, 200);
  std::vector<double> shares;
  render(image, Camera{}, direction_as_color,
         {.threads = 1, .progress = [&](double share) { shares.push_back(share); }});
  REQUIRE(shares.size() == 10 * 7);
  for (std::size_t i = 0; i < shares.size(); ++i) REQUIRE(shares[i] == static_cast<double>(i + 1) / 70);
}

TEST_CASE("an exception in the user's code reaches the caller of render, from any thread") {
  Image image(320, 320);
  for (const int threads : {1, 2, 8}) {
    CAPTURE(threads);
    const RenderOptions options{.threads = threads};
    CHECK(message_of<std::runtime_error>([&] {
            render(
                image, Camera{},
                [](const Ray& ray) -> Color {
                  if (ray.direction.y < 0) throw std::runtime_error("broken radiance");
                  return Color{0};
                },
                options);
          }) == "broken radiance");

    std::atomic<int> count = 0;
    Scene<Sphere, Fragile> typed;
    typed.add(Fragile{&count}, Color{1});
    CHECK(message_of<std::runtime_error>([&] { render(image, Camera{}, typed, Height{}, options); }) ==
          "broken surface");
    count = 0;
    Scene<AnySurface> any;
    any.add(Fragile{&count}, Color{1});
    CHECK(message_of<std::runtime_error>([&] { render(image, Camera{}, any, Height{}, options); }) ==
          "broken surface");

    RenderOptions with_progress = options;
    with_progress.progress = [](double) { throw std::runtime_error("broken progress"); };
    CHECK(message_of<std::runtime_error>(
              [&] { render(image, Camera{}, CallerTakesPart{}, with_progress); }) == "broken progress");
  }
}

TEST_CASE("an exception in one thread stops the other threads") {
  Image image(640, 640);
  std::atomic<int> calls = 0;
  const auto caller = std::this_thread::get_id();
  CHECK(message_of<std::runtime_error>([&] {
          render(image, Camera{},
                 [&](const Ray&) -> Color {
                   ++calls;
                   if (std::this_thread::get_id() != caller) throw std::runtime_error("a helper's");
                   std::this_thread::sleep_for(std::chrono::microseconds(1));
                   return Color{0};
                 },
                 {.threads = 2});
        }) == "a helper's");
  CHECK(calls < 640 * 640);
}
