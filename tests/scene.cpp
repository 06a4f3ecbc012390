#include <cmath>
#include <future>
#include <limits>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "scenes/three_spheres.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/cylinder.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

static_assert(Traceable<Scene<>> && Traceable<Scene<Sphere>> && Traceable<Scene<Sphere, Plane, Cylinder>>);
static_assert(Traceable<Scene<AnySurface>> && !Traceable<Sphere>);

namespace {

/// Returns a color whose red identifies a surface.
Color tag(int number) { return Color{static_cast<float>(number), 0, 0}; }
int tag_of(const Intersection& hit) { return static_cast<int>(hit.color().r); }

using Seen = std::pair<int, double>;  // the surface's tag, and t
std::vector<Seen> crossings_of(const Traceable auto& scene, const Ray& ray, Interval range = {}) {
  std::vector<Seen> list;
  scene.crossings(ray, range, [&](const Intersection& hit) { list.emplace_back(tag_of(hit), hit.t); });
  return list;
}

template <class S>
concept TakesSphere = requires(S scene) {
  scene.add(Sphere{}, Color{1});
};
static_assert(TakesSphere<Scene<Sphere>> && TakesSphere<Scene<AnySurface>> && !TakesSphere<Scene<Plane>>);
}  // namespace

TEST_CASE("a scene without surfaces is a miss for every ray") {
  const auto is_empty = [](const auto& scene) {
    return !scene.intersect(ray_along_z) && !scene.occluded(ray_along_z) &&
           crossings_of(scene, ray_along_z).empty() && scene.lights().empty();
  };
  CHECK(is_empty(Scene<>{}));
  CHECK(is_empty(Scene<Sphere>{}));
  CHECK(is_empty(Scene<Sphere, Plane>{}));
  CHECK(is_empty(Scene<AnySurface>{}));
}

TEST_CASE("a scene's closest hit is the nearest crossing, whichever type it has and however it was added") {
  Scene<Sphere, Plane> scene;
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 4}, tag(1));
  scene.add(Sphere{.center = {0, 0, 8}, .radius = 1}, tag(2));
  scene.add(Sphere{.center = {0, 0, 2}, .radius = 1}, tag(3));
  scene.add(Sphere{.center = {0, 0, 20}, .radius = 1}, tag(4));
  const auto first = [&](Interval range) {
    const auto hit = scene.intersect(ray_along_z, range);
    return hit ? Seen{tag_of(*hit), hit->t} : Seen{0, 0};
  };
  CHECK(first({}) == Seen{3, 1});
  CHECK(first({.min = 1}) == Seen{3, 3});
  CHECK(first({.min = 3}) == Seen{1, 4});
  CHECK(first({.min = 4}) == Seen{2, 7});
  CHECK(first({.min = 4, .max = 7}) == Seen{0, 0});
  CHECK(first({.min = 21}) == Seen{0, 0});
}

TEST_CASE("at equal t the surface type named first wins, then the surface added first") {
  // All are hit at t = 2.
  const Sphere near{.center = {0, 0, 3}, .radius = 1}, far{.center = {0, 0, 4}, .radius = 2};
  const Plane plane{.normal = {0, 0, 1}, .distance = 2};
  const auto first = [&](auto scene, const auto&... surfaces) {
    int number = 0;
    (scene.add(surfaces, tag(++number)), ...);
    const auto hit = scene.intersect(ray_along_z);
    REQUIRE(hit);
    CHECK(hit->t == 2);
    return tag_of(*hit);
  };
  CHECK(first(Scene<Sphere>{}, near, far) == 1);
  CHECK(first(Scene<Sphere>{}, far, near) == 1);
  CHECK(first(Scene<Sphere, Plane>{}, plane, near) == 2);
  CHECK(first(Scene<Plane, Sphere>{}, near, plane) == 2);
  CHECK(first(Scene<Sphere, Plane>{}, plane, far, near) == 2);
  CHECK(first(Scene<AnySurface>{}, plane, near, far) == 1);
  CHECK(first(Scene<AnySurface>{}, near, plane) == 1);
}

TEST_CASE("crossings come in the order of the surfaces: by type, then as added, near root first") {
  const auto fill = [](auto scene) {
    scene.add(Plane{.normal = {0, 0, 1}, .distance = 1}, tag(1));
    scene.add(Sphere{.center = {0, 0, 10}, .radius = 2}, tag(2));
    scene.add(Sphere{.center = {0, 0, 4}, .radius = 1}, tag(3));
    scene.add(Plane{.normal = {0, 0, 1}, .distance = 0.5}, tag(4));
    scene.add(Sphere{.center = {1, 0, 6}, .radius = 1}, tag(5));  // tangent
    return scene;
  };
  const std::vector<Seen> spheres{{2, 8}, {2, 12}, {3, 3}, {3, 5}, {5, 6}, {5, 6}};
  const std::vector<Seen> planes{{1, 1}, {4, 0.5}};
  auto spheres_first = spheres, planes_first = planes;
  spheres_first.insert(spheres_first.end(), planes.begin(), planes.end());
  planes_first.insert(planes_first.end(), spheres.begin(), spheres.end());
  CHECK(crossings_of(fill(Scene<Sphere, Plane>{}), ray_along_z) == spheres_first);
  CHECK(crossings_of(fill(Scene<Plane, Sphere>{}), ray_along_z) == planes_first);
  CHECK(crossings_of(fill(Scene<AnySurface>{}), ray_along_z) ==
        std::vector<Seen>{{1, 1}, {2, 8}, {2, 12}, {3, 3}, {3, 5}, {4, 0.5}, {5, 6}, {5, 6}});
  CHECK(crossings_of(fill(Scene<Sphere, Plane>{}), ray_along_z, {.min = 3, .max = 8}) ==
        std::vector<Seen>{{3, 5}, {5, 6}, {5, 6}});
}

TEST_CASE("a ray is occluded exactly if it has a closest hit, in every range") {
  Random random(11);
  Scene<Sphere, Plane, Cylinder> scene;
  for (int i = 0; i < 10; ++i) scene.add(Sphere{random.point(5), random.real(0.5, 2)}, tag(i));
  scene.add(Plane{.normal = random.direction(), .distance = 6}, tag(10));
  scene.add(Cylinder{.radius = 0.5}, tag(11));
  int hits = 0, misses = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 30000; ++i) {
    const Ray ray{random.point(6), random.direction()};
    const double min = random.real(0, 3);
    const Interval range{.min = min, .max = min + random.real(0, 5)};
    const auto hit = scene.intersect(ray, range);
    ++(hit ? hits : misses);
    wrong.add(scene.occluded(ray, range) != hit.has_value(), ray, range);
    wrong.add(hit && !range.contains(hit->t), ray, range);
    // The closest hit has the least t of all crossings.
    double least = infinity;
    scene.crossings(ray, range, [&](const Intersection& crossing) { least = std::min(least, crossing.t); });
    wrong.add(hit ? hit->t != least : least != infinity, ray, range, least);
  }
  CHECK(hits > 3000);
  CHECK(misses > 5000);
  CHECK(wrong == 0);
}

TEST_CASE("a ray that leaves one of several coinciding surfaces leaves all of them") {
  Random random(12);
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0.1, 0.2, 0.3}, .radius = 0.7}, tag(1));
  scene.add(Sphere{.center = {0.1, 0.2, 0.3}, .radius = 0.7}, tag(2));
  scene.add(Sphere{.center = {0.1, 0.2, 0.3}, .radius = -0.7}, tag(3));
  scene.add(Plane{.normal = {1, 2, 3}, .distance = 7}, tag(4));
  scene.add(Plane{.normal = {1, 2, 3}, .distance = 7}, tag(5));
  scene.add(Plane{.normal = {-3, -6, -9}, .distance = -21}, tag(6));
  int spheres = 0, planes = 0;
  WrongCases wrong(random);
  for (int i = 0; i < 20000; ++i) {
    const Ray ray{0.8 * random.direction(), random.direction()};
    const auto hit = scene.intersect(ray);
    if (!hit) continue;
    const Ray left = hit->leave(random.direction());
    int own = 0;
    const bool is_sphere = tag_of(*hit) <= 3;
    ++(is_sphere ? spheres : planes);
    for (const auto& [number, t] : crossings_of(scene, left)) own += (number <= 3) == is_sphere ? 1 : 0;
    wrong.add(!is_sphere && own != 0, ray, left);
    const bool inwards = dot(left.direction, Point{0.1, 0.2, 0.3} - left.origin) > 0;
    wrong.add(is_sphere && own != (inwards ? 3 : 0), ray, left);
  }
  CHECK(spheres > 2000);
  CHECK(planes > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("user-defined surfaces work in any scene like those of the library") {
  const auto fill = [](auto scene) {
    scene.add(Cylinder{.radius = 1}, tag(1));
    scene.add(Cylinder{.radius = 3}, tag(2));
    return scene;
  };
  const auto check = [](const auto& scene) {
    const Ray ray{{-5, 7, 0}, {1, 0, 0}};
    const auto hit = scene.intersect(ray);
    REQUIRE(hit);
    CHECK(hit->t == 2);
    CHECK(hit->normal() == Vec3{-1, 0, 0});
    CHECK(scene.occluded(ray));
    CHECK(crossings_of(scene, ray) == std::vector<Seen>{{1, 4}, {1, 6}, {2, 2}, {2, 8}});
    CHECK(crossings_of(scene, hit->leave({1, 0, 0})) == std::vector<Seen>{{1, 2}, {1, 4}, {2, 6}});
    CHECK(crossings_of(scene, hit->leave({-1, 0, 0})).empty());
    CHECK_FALSE(scene.occluded(hit->leave({-1, 0, 0})));
    CHECK_FALSE(scene.occluded(hit->leave({1, 0, 0}), {0, 2}));
    CHECK(scene.occluded(hit->leave({1, 0, 0}), {0, 2.5}));
  };
  check(fill(Scene<Cylinder>{}));
  check(fill(Scene<AnySurface>{}));
  check(fill(Scene<Sphere, Plane, Cylinder>{}));
  check(fill(Scene<Sphere, AnySurface>{}));
}

TEST_CASE("a surface is stored as its own type, or as the first type that it converts to") {
  Scene<AnySurface, Sphere> scene;
  scene.add(Plane{.normal = {0, 0, 1}, .distance = 2}, tag(1));
  scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, tag(2));
  scene.add(AnySurface{Sphere{.center = {0, 0, 3}, .radius = 1}}, tag(3));
  // The sphere is stored as Sphere, hence last, although AnySurface, which takes it too, comes first.
  CHECK(crossings_of(scene, ray_along_z) == std::vector<Seen>{{1, 2}, {3, 2}, {3, 4}, {2, 2}, {2, 4}});
}

TEST_CASE("a ray without direction, or with a number that is not finite, crosses nothing") {
  Scene<Sphere, Plane> scene;
  scene.add(Sphere{.center = {0, 0, 0}, .radius = 2}, tag(1));
  scene.add(Plane{.normal = {1, 1, 1}, .distance = 1}, tag(2));
  std::vector<Ray> rays{{{0, 0, 0}, {0, 0, 0}}};
  for (const double bad : {infinity, -infinity, not_a_number})
    for (int axis = 0; axis < 3; ++axis) {
      rays.push_back({{0, 0, 0}, {0.1, 0.2, 0.3}});
      rays.back().origin[axis] = bad;
      rays.push_back({{0, 0, 0}, {0.1, 0.2, 0.3}});
      rays.back().direction[axis] = bad;
    }
  for (const Ray& ray : rays) {
    CHECK_FALSE(scene.intersect(ray));
    CHECK_FALSE(scene.occluded(ray));
    CHECK(crossings_of(scene, ray).empty());
  }
  for (const Interval range :
       {Interval{not_a_number, 1}, Interval{0, not_a_number}, Interval{1, 1}, Interval{9, 0}}) {
    CHECK_FALSE(scene.intersect(ray_along_z, range));
    CHECK_FALSE(scene.occluded(ray_along_z, range));
    CHECK(crossings_of(scene, ray_along_z, range).empty());
  }
}

TEST_CASE("invalid surfaces and lights are refused when added, with the names of type and field") {
  Scene<Sphere, Plane> typed;
  Scene<AnySurface> any;
  const auto says = [](auto& scene, const auto&... arguments) {
    return message_of<std::invalid_argument>([&] { scene.add(arguments...); });
  };
  const auto check = [&](const auto& surface, const Color& color, const std::string& expected) {
    CAPTURE(expected);
    CHECK_THAT(says(typed, surface, color), ContainsSubstring(expected));
    CHECK_THAT(says(any, surface, color), ContainsSubstring(expected));
  };
  for (const double bad : {0.0, not_a_number, infinity, -infinity})
    check(Sphere{.radius = bad}, Color{1}, "Sphere: radius");
  check(Sphere{.center = {not_a_number, 0, 0}}, Color{1}, "Sphere: center");
  check(Sphere{.center = {0, 0, infinity}}, Color{1}, "Sphere: center");
  for (const Vec3& bad : {Vec3{0}, Vec3{0, not_a_number, 0}, Vec3{infinity, 0, 0}})
    check(Plane{.normal = bad}, Color{1}, "Plane: normal");
  for (const double bad : {not_a_number, infinity})
    check(Plane{.distance = bad}, Color{1}, "Plane: distance");
  for (const float bad : {-0.1f, static_cast<float>(not_a_number), static_cast<float>(infinity)}) {
    check(Sphere{}, Color{0, bad, 0}, "Scene::add: color");
    check(Plane{}, Color{0, 0, bad}, "Scene::add: color");
    CHECK_THAT(says(typed, PointLight{.position = {0, 0, 0}, .power = Color{bad, 0, 0}}),
               ContainsSubstring("PointLight: power"));
  }
  for (const double bad : {not_a_number, infinity})
    CHECK_THAT(says(typed, PointLight{.position = {0, bad, 0}, .power = Color{1}}),
               ContainsSubstring("PointLight: position"));
  CHECK_THAT(says(any, AnySurface{Sphere{.radius = 0}}, Color{1}), ContainsSubstring("Sphere: radius"));

  // No refused surface or light has been added.
  CHECK(crossings_of(typed, ray_along_z, {-infinity, infinity}).empty());
  CHECK(crossings_of(any, ray_along_z, {-infinity, infinity}).empty());
  CHECK(typed.lights().empty());
}

TEST_CASE("a negative radius, black, colors above 1 and a light without power are valid") {
  Scene<Sphere> scene;
  CHECK_NOTHROW(scene.add(Sphere{.center = {0, 0, 3}, .radius = -1}, Color{0}));
  CHECK_NOTHROW(scene.add(Sphere{.center = {0, 0, 9}, .radius = 1}, Color{5}));
  CHECK_NOTHROW(scene.add(PointLight{}));
  CHECK(scene.lights().size() == 1);
  const auto hit = scene.intersect(ray_along_z);
  REQUIRE(hit);
  CHECK(hit->normal() == Vec3{0, 0, 1});
}

TEST_CASE("lights stay in the order in which they were added") {
  Scene<> scene;
  scene.add(PointLight{.position = {1, 0, 0}, .power = Color{1}});
  scene.add(PointLight{.position = {2, 0, 0}, .power = Color{1}});
  REQUIRE(scene.lights().size() == 2);
  CHECK(scene.lights()[0].towards(Point{0}) == Vec3{1, 0, 0});
  CHECK(scene.lights()[1].towards(Point{0}) == Vec3{2, 0, 0});
}

TEST_CASE("a copy of a scene is independent of the original") {
  auto scene = three_spheres();
  const auto copy = scene;
  scene.add(Sphere{.center = {0, 0, 1}, .radius = 0.5}, tag(9));
  REQUIRE(copy.intersect(ray_along_z));
  CHECK(copy.intersect(ray_along_z)->t == 2);
  CHECK(scene.intersect(ray_along_z)->t == 0.5);
}

TEST_CASE("a const scene may be used by several threads at once") {
  const auto scene = three_spheres<AnySurface>();
  const auto work = [&] {
    Random random(13);
    double sum = 0;
    for (int i = 0; i < 20000; ++i) {
      const Ray ray{{0, 0, 0}, random.direction()};
      if (const auto hit = scene.intersect(ray)) sum += hit->t + hit->normal().y;
      scene.crossings(ray, {}, [&](const Intersection& crossing) { sum += crossing.t; });
    }
    return sum;
  };
  const double expected = work();
  std::vector<double> sums(4);
  {
    std::vector<std::future<void>> threads;
    for (double& sum : sums) threads.push_back(std::async(std::launch::async, [&] { sum = work(); }));
  }
  CHECK(sums == std::vector<double>(4, expected));
}

namespace {
/// Surface that returns the given t for every ray and range.
struct Answers {
  double t;
  std::optional<double> intersect(const Ray&, Interval) const { return t; }
  Vec3 normal_at(Point) const { return {0, 0, 1}; }
};

/// Type that converts to a sphere.
struct AlmostSphere {
  double radius;
  operator Sphere() const { return {.radius = radius}; }
};
}  // namespace

TEST_CASE("a surface that returns NaN, or a t outside the range, is not hit") {
  for (const double t : {std::numeric_limits<double>::quiet_NaN(), -5.0, 0.0, 100.0, 1e9, infinity}) {
    CAPTURE(t);
    Scene<Answers> scene;
    Scene<AnySurface> any;
    scene.add(Answers{t}, Color{1});
    any.add(Answers{t}, Color{1});
    int visits = 0;
    const auto count = [&](const Intersection&) { ++visits; };
    scene.crossings(Ray{}, {.min = 0, .max = 100}, count);
    any.crossings(Ray{}, {.min = 0, .max = 100}, count);
    CHECK(visits == 0);
    CHECK_FALSE(scene.intersect(Ray{}, {.min = 0, .max = 100}));
    CHECK_FALSE(any.intersect(Ray{}, {.min = 0, .max = 100}));
    CHECK_FALSE(scene.occluded(Ray{}, {.min = 0, .max = 100}));
    CHECK_FALSE(any.occluded(Ray{}, {.min = 0, .max = 100}));
  }
}

TEST_CASE("an object that converts to a surface is validated as that surface") {
  Scene<Sphere> scene;
  CHECK_NOTHROW(scene.add(AlmostSphere{2}, Color{1}));
  CHECK_THROWS_AS(scene.add(AlmostSphere{0}, Color{1}), std::invalid_argument);
  CHECK_FALSE(scene.occluded(Ray{{5, 0, 0}}));
}

TEST_CASE("a visitor of crossings may take them by reference") {
  Scene<Sphere> scene;
  scene.add(Sphere{.center = {0, 0, 3}}, Color{1});
  int visits = 0;
  scene.crossings(Ray{}, {}, [&](auto& crossing) { visits += crossing.t > 0; });
  CHECK(visits == 2);
}

TEST_CASE("the sum of ambient lights is clamped, however large it is") {
  Scene<Sphere> scene;
  scene.add(AmbientLight{Color{3e38f, 1, 0}});
  scene.add(AmbientLight{Color{3e38f, 1, 0}});
  CHECK(scene.ambient() == Color{most_irradiance, 2, 0});
}
