#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/torus.hpp>
#include <protostar/surfaces/triangle.hpp>

#include <bit>
#include <cmath>
#include <functional>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

/// A box as a user may write it: intersect, normal_at, and bounds that exceed the box by far more than
/// rounding.
struct Cube {
  Point center{0};
  double half = 1;

  std::optional<double> intersect(const Ray& ray, Interval range) const {
    double from = -infinity, until = infinity;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (center[axis] - half - ray.origin[axis]) / ray.direction[axis];
      const double b = (center[axis] + half - ray.origin[axis]) / ray.direction[axis];
      from = std::max(from, std::min(a, b));
      until = std::min(until, std::max(a, b));
    }
    if (!(from <= until)) return std::nullopt;
    if (range.contains(from)) return from;
    return range.contains(until) ? std::optional(until) : std::nullopt;
  }
  Vec3 normal_at(Point point) const {
    const Vec3 p = abs(point - center);
    return p.x > p.y && p.x > p.z ? Vec3{1, 0, 0} : p.y > p.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  }
  Bounds bounds() const { return {center - Vec3{1.001 * half}, center + Vec3{1.001 * half}}; }
};
static_assert(SurfaceWithBounds<Cube> && !SurfaceWithBounds<Cylinder>);

/// A cube whose bounds are another cube, of half-width reach around the coordinate origin.
struct LooseCube : Cube {
  double reach = 2;
  Bounds bounds() const { return {Point{-reach}, Point{reach}}; }
};

std::uint64_t bits_of(double x) { return std::bit_cast<std::uint64_t>(x); }

/// Returns a scene's answers to a ray: closest hit, any hit and all hits, as integers that are equal only if
/// all bits are. Colors identify the surfaces.
std::vector<std::uint64_t> answers(const Traceable auto& scene, const Ray& ray, Interval range) {
  std::vector<std::uint64_t> all;
  const auto add = [&](const Intersection& hit) {
    all.push_back(bits_of(hit.t));
    all.push_back(std::bit_cast<std::uint32_t>(hit.color().r));
  };
  if (const auto hit = scene.intersect(ray, range)) add(*hit);
  all.push_back(scene.occluded(ray, range));
  scene.crossings(ray, range, add);
  return all;
}

/// Checks that the accelerated scene answers as the plain one for random rays, with and without ranges, and
/// for rays that leave their hits. Returns the number of rays that hit.
template <Surface... S>
int compare(const Scene<S...>& plain, Random& random, const Point& around, double size, int rays) {
  const auto fast = accelerate(plain, {.threads = 1});
  int hits = 0;
  const auto check = [&](const Ray& ray, Interval range) {
    const auto expected = answers(plain, ray, range);
    if (answers(fast, ray, range) != expected) {
      CAPTURE(ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z);
      CAPTURE(range.min, range.max);
      FAIL_CHECK("other answers");
    }
    hits += expected.size() > 1;
  };
  for (int i = 0; i < rays; ++i) {
    const Ray ray{around + random.point(size), random.direction() * std::exp2(random.real(-2, 2))};
    check(ray, {});
    check(ray, {-infinity, infinity});
    check(ray, {random.real(-1, 1), random.real(0, 2) * size});
    const auto hit = plain.intersect(ray);
    if (!hit) continue;
    const Point target = around + random.point(size);
    check(hit->leave(target - hit->point()), {0, 1});
    check(hit->leave(ray.direction), {});
    check(hit->leave(cross(hit->normal(), random.direction())), {});  // along the surface
    check(ray, {0, hit->t});
  }
  return hits;
}

/// Returns a color that identifies surface i.
Color number(int i) { return Color{static_cast<float>(i)}; }

/// A board as a user may write it: its prepared equation is of a type that is named elsewhere.
struct PreparedBoard {
  Parallelogram board;

  std::optional<double> intersect(const Ray& ray, Interval range = {}) const {
    return board.intersect(ray, range);
  }
  Vec3 normal_at(const Point& point) const { return board.normal_at(point); }
  auto equation(const auto& rays) const { return board.equation(rays); }
  bool is_left_by(const auto& rays) const { return board.is_left_by(rays); }
  auto prepared() const { return board.prepared(); }
};
static_assert(PreparedSurface<PreparedBoard> && PreparedSurface<Parallelogram> && !PreparedSurface<Sphere>);

}  // namespace

TEST_CASE("an accelerated scene answers as the plain one does, bit for bit") {
  struct Row {
    const char* what;
    int count;
    Point around;
    std::function<Sphere(Random&, int)> sphere;
  };
  const auto anywhere = [](double radius) {
    return [radius](Random& random, int) {
      return Sphere{random.point(1), radius * random.real(0.5, 1) * (random.bits() % 2 ? 1 : -1)};
    };
  };
  const auto row = GENERATE_COPY(
      values<Row>({{"one", 1, {}, anywhere(0.8)},
                   {"few", 3, {}, anywhere(0.5)},
                   {"some", 100, {}, anywhere(0.2)},
                   {"many", 5000, {}, anywhere(0.03)},
                   {"around the camera", 100, {}, anywhere(2)},
                   {"far from the origin", 100, Point{65537, -65537, 65537},
                    [](Random& random, int) {
                      return Sphere{Point{65537, -65537, 65537} + random.point(1), random.real(0.1, 0.3)};
                    }},
                   {"nested",
                    60,
                    {},
                    [](Random&, int i) {
                      return Sphere{Point{0.25}, std::exp2(-0.5 * i)};
                    }},
                   {"tangent in one point",
                    60,
                    {},
                    [](Random&, int i) {
                      return Sphere{Point{0, std::exp2(-i / 4), 0}, std::exp2(-i / 4)};
                    }},
                   {"touching in a row",
                    50,
                    {},
                    [](Random&, int i) {
                      return Sphere{Point{0.25 * (i - 25), 0, 0}, 0.125};
                    }},
                   {"coincident",
                    64,
                    {},
                    [](Random&, int i) {
                      return Sphere{Point{0.5 * (i % 4), 0, 0}, i % 8 < 4 ? 0.5 : -0.5};
                    }},
                   {"huge and tiny", 200, {}, [](Random& random, int i) {
                      if (i == 7) return Sphere{{0, -1e6 - 1, 0}, 1e6};
                      return Sphere{random.point(1), std::exp2(random.real(-20, -2))};
                    }}}));
  CAPTURE(row.what);
  Random random(static_cast<std::uint64_t>(row.count));
  Scene<Sphere> scene;
  for (int i = 0; i < row.count; ++i) scene.add(row.sphere(random, i), number(i));
  CHECK(compare(scene, random, row.around, 1.5, row.count > 1000 ? 40 : 200) > 10);
}

TEST_CASE("rays through points of tangency and along axes get the plain scene's answers") {
  Scene<Sphere> scene;
  for (int i = 0; i < 40; ++i)
    scene.add(Sphere{Point(0.5 * (i % 5), 0.5 * (i / 5 % 4), 0.5 * (i / 20)), 0.25}, number(i));
  const auto fast = accelerate(scene);
  for (int axis = 0; axis < 3; ++axis)
    for (int a = -2; a <= 8; ++a)
      for (int b = -2; b <= 8; ++b) {
        Point origin{0};
        origin[axis] = -3;
        origin[(axis + 1) % 3] = 0.25 * a;
        origin[(axis + 2) % 3] = 0.25 * b;
        Vec3 direction{0};
        direction[axis] = 1;
        const Ray ray{origin, direction}, back{origin + 10.0 * direction, -direction};
        CHECK(answers(fast, ray, {}) == answers(scene, ray, {}));
        CHECK(answers(fast, back, {}) == answers(scene, back, {}));
      }
}

TEST_CASE("surfaces of several types, with and without bounds, are hit as in the plain scene") {
  Random random(5);
  Scene<Plane, Sphere, Cylinder, Cube, AnySurface> scene;
  for (int i = 0; i < 30; ++i) {
    scene.add(Sphere{random.point(1), random.real(0.1, 0.4)}, number(5 * i));
    scene.add(Cube{random.point(1), random.real(0.05, 0.3)}, number(5 * i + 1));
    scene.add(AnySurface(Sphere{random.point(1), random.real(0.1, 0.4)}), number(5 * i + 2));
    const Point corner = random.point(1);
    scene.add(AnySurface(Box{corner, corner + abs(random.point(0.5))}), number(300 + 3 * i));
    scene.add(AnySurface(Disk{random.point(1), random.direction(), random.real(0.1, 0.4)}),
              number(301 + 3 * i));
    scene.add(AnySurface(Torus{random.point(1), random.direction(), random.real(0.1, 0.4), 0.05}),
              number(400 + i));
    const double size = random.real(4, 40);
    if (i < 2)
      scene.add(AnySurface(Quadric{{size * random.direction(), {}, random.point(1), -1}}),
                number(302 + 3 * i));
    if (i < 2) scene.add(Plane{random.direction(), random.real(-1, 1)}, number(5 * i + 3));
    if (i < 2) scene.add(AnySurface(Plane{random.direction(), random.real(-1, 1)}), number(5 * i + 4));
    if (i < 2) scene.add(Cylinder{random.real(0.2, 0.5)}, number(5 * i + 4));
  }
  CHECK(compare(scene, random, Point{0}, 1.5, 300) > 100);
}

TEST_CASE("at equal t the closest hit is that of the scene's earlier surface, wherever it is in the tree") {
  Scene<AnySurface, Sphere> scene;
  for (int i = 0; i < 50; ++i) scene.add(Sphere{Point{0}, i % 2 ? 1.0 : -1.0}, number(i));
  for (int i = 0; i < 50; ++i) scene.add(Sphere{Point(3, i % 7, 0), 0.5}, number(100 + i));
  const auto color = [&](const Ray& ray) { return accelerate(scene).intersect(ray)->color().r; };
  CHECK(color({{0, 0, -3}, {0, 0, 1}}) == 0);
  CHECK(color({{3, 4, -3}, {0, 0, 1}}) == 104);
  scene.add(AnySurface(Sphere{}), number(200));
  CHECK(color({{0, 0, -3}, {0, 0, 1}}) == 200);
}

TEST_CASE("a ray whose origin is off the surface of its departure gets the plain scene's answers") {
  const int count = GENERATE(3, 8, 9, 100);
  Random random(9);
  Scene<Sphere> scene;
  for (int i = 0; i < count; ++i) {
    Sphere sphere{random.point(1), random.real(0.05, 0.2) * (i % 2 ? 1 : -1)};
    if (i % 5 == 3) sphere = scene.surfaces<Sphere>().back();
    if (i % 5 == 4) sphere.center = scene.surfaces<Sphere>().back().center;  // float cannot tell them apart
    if (i % 5 == 4) sphere.radius = scene.surfaces<Sphere>().back().radius * (1 + std::exp2(-i));
    scene.add(sphere, number(i));
  }
  const auto fast = accelerate(scene);
  const auto& spheres = scene.surfaces<Sphere>();
  for (int i = 0; i < 2000; ++i) {
    const Sphere& sphere = spheres[random.bits() % spheres.size()];
    // The origin is a little off the sphere, on either side, or sometimes far off; any direction.
    const double off = 1 + std::exp2(random.real(-50, i % 10 != 1 ? -20 : 1)) * (i % 2 ? 1 : -0.1);
    const Vec3 normal = random.direction();
    Ray ray{sphere.center + (off * sphere.radius) * normal,
            i % 3 ? random.direction() : cross(normal, random.direction()) - 1e-9 * normal,
            sphere.departure()};
    if (i % 4 < 2) ray.departure.surface = &sphere;  // as Intersection::leave sets it
    for (const Interval range : {Interval{}, Interval{0, 1}, Interval{-1, 1}})
      CHECK(answers(fast, ray, range) == answers(scene, ray, range));
  }
}

TEST_CASE("a ray that leaves a surface of an accelerated scene gets the plain scene's answers") {
  Random random(91);
  Scene<Sphere, Parallelogram> scene;
  for (int i = 0; i < 10; ++i)
    scene.add(Sphere{random.point(1), random.real(0.05, 0.5) * (i % 2 ? 1 : -1)}, number(i));
  scene.add(scene.surfaces<Sphere>()[3], number(10));  // twice the same
  for (int i = 0; i < 10; ++i) {
    const Point p = random.point(1);
    const Vec3 u = random.direction(), v = random.direction();
    scene.add(Parallelogram{p, u, v}, number(11 + i));
    scene.add(Parallelogram{p, 0.5 * u, 0.25 * v}, number(21 + i));  // in one plane
  }
  const auto fast = accelerate(scene);
  WrongCases wrong(random);
  int again = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto hit = scene.intersect({3.0 * random.direction(), random.direction()}, Interval{});
    if (!hit) continue;
    const Ray ray = hit->leave(random.direction());
    const Interval range = i % 4 == 0 ? Interval{0, 1} : i % 4 == 1 ? Interval{0.1, infinity} : Interval{};
    const auto found = scene.intersect(ray, range);
    again += found && found->surface() == hit->surface();
    wrong.add(!(answers(fast, ray, range) == answers(scene, ray, range)), ray, range.min, range.max);
  }
  CHECK(wrong == 0);
  CHECK(again > 20);
}

TEST_CASE("rays that start next to a sphere, or end there, get the plain scene's answers") {
  const int count = GENERATE(1, 4, 200);
  Random random(19);
  Scene<Sphere> scene;
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    spheres.push_back({random.point(1), i == 0 ? 1000.0 : random.real(0.05, 0.2)});
    scene.add(spheres.back(), number(i));
  }
  const auto fast = accelerate(scene);
  int occluded = 0, free = 0;
  WrongCases wrong(random);
  for (int i = 0; i < cases(1000, 4000); ++i) {
    const Sphere& sphere = spheres[random.bits() % spheres.size()];
    const double off = std::exp2(random.real(-52, -8)) * (i % 2 ? 1 : -1);
    const Vec3 normal = random.direction();
    const Point point = sphere.center + (1 + off) * sphere.radius * normal;
    const Point other = i % 3 ? point + sphere.radius * random.direction() : random.point(1);
    const Vec3 way = i % 5 ? other - point : sphere.radius * cross(normal, random.direction());
    for (const Ray& ray : {Ray{point, way}, Ray{point + way, -way}})
      for (const Interval range : {Interval{0, 1}, Interval{}, Interval{0.5, 2}, Interval{1e-300, 1}}) {
        wrong.add(answers(fast, ray, range) != answers(scene, ray, range), sphere, ray, range);
        ++(scene.occluded(ray, range) ? occluded : free);
      }
  }
  CHECK(wrong == 0);
  CHECK(occluded > cases(250, 1000));
  CHECK(free > cases(250, 1000));
}

TEST_CASE("rays that float cannot represent get the plain scene's answers") {
  const int count = GENERATE(5, 50);
  Random random(13);
  Scene<Sphere, Cube> scene;
  for (int i = 0; i < count; ++i) scene.add(Sphere{random.point(1), 0.3}, number(i));
  for (int i = 0; i < 50; ++i) scene.add(Cube{random.point(1), 0.1}, number(50 + i));
  const auto fast = accelerate(scene);
  const double nan = std::nan("");
  for (const Ray& ray :
       {Ray{Point{0, 0, -3}, Vec3{0}}, Ray{Point{0, 0, -3}, Vec3{0, 0, infinity}}, Ray{Point{nan}, Vec3{1}},
        Ray{Point{0, 0, -3}, Vec3{0, nan, 1}}, Ray{Point{0, 0, -1e30}, Vec3{0, 0, 1}},
        Ray{Point{0.1, 0.1, -3}, Vec3{0, 0, 1e-250}}, Ray{Point{0.1, 0.1, -3}, Vec3{0, 0, 1e250}},
        Ray{Point{0.1, 0.1, -3}, Vec3{5e-324, 0, 1}}, Ray{Point{0.1, 0.1, -3}, Vec3{1e-30, -1e-300, 1}}})
    for (const Interval range : {Interval{}, Interval{-infinity, infinity}, Interval{nan, 1},
                                 Interval{0, nan}, Interval{1, 0}, Interval{2.5, 1e300}})
      CHECK(answers(fast, ray, range) == answers(scene, ray, range));
}

TEST_CASE("surfaces whose bounds overflow, or nearly do, are hit as in the plain scene, and none twice") {
  Random random(16);
  Scene<Sphere, LooseCube> scene;
  int i = 0;
  for (; i < 2100; ++i) scene.add(Sphere{random.point(1), random.real(0.01, 0.05)}, number(i));
  scene.add(Sphere{.center = {1e120, 0, 0}, .radius = 1.7e120}, number(i++));
  for (; i < 2150; ++i) scene.add(LooseCube{{random.point(1), random.real(0.05, 0.3)}}, number(i));
  scene.add(LooseCube{{Point{0}, 0.5}, 1e200}, number(i));
  CHECK(compare(scene, random, Point{0}, 1.5, cases(10, 40)) > cases(25, 100));
}

TEST_CASE("small and distant spheres behind a ray's origin are hit as in the plain scene") {
  Random random(17);
  Scene<Sphere> scene;
  std::vector<Sphere> spheres;
  for (int i = 0; i < 300; ++i) {
    spheres.push_back({random.point(std::exp2(random.real(0, 12))), 1e-7});
    scene.add(spheres.back(), number(i));
  }
  const auto fast = accelerate(scene);
  int hits = 0;
  WrongCases wrong(random);
  for (const Sphere& sphere : spheres)
    for (int i = 0; i < 10; ++i) {
      const Point target = sphere.center + (0.9 * sphere.radius) * random.direction();
      const Point origin = target + random.point(std::exp2(random.real(-10, 12)));
      const double scale = std::exp2(random.real(-2, 2)), t = -1 / scale;
      const Ray ray{origin, scale * (origin - target)};
      for (const Interval range :
           {Interval{-infinity, infinity}, {-infinity, 0}, {-infinity, 0.5 * t}, {2 * t, 0.5 * t}}) {
        const auto expected = answers(scene, ray, range);
        wrong.add(answers(fast, ray, range) != expected, sphere, ray, range);
        hits += expected.size() > 1;
      }
    }
  CHECK(wrong == 0);
  CHECK(hits > 10000);
}

TEST_CASE(
    "an accelerated scene of few surfaces knows what is the same at all points of each, but not of many") {
  Random random(61);
  Scene<Sphere, Plane, Disk, Parallelogram, Triangle, Box, Cube> scene;
  for (int i = 0; i < 2; ++i) {
    const auto vector = [&] { return random.point(2); };
    scene.add(Sphere{vector(), random.real(0.5, 2)}, Color{1});
    scene.add(Plane{vector(), random.real(-2, 2)}, Color{1});
    scene.add(Disk{vector(), vector(), random.real(0.5, 2)}, Color{1});
    scene.add(Parallelogram{vector(), vector(), vector()}, Color{1});
    scene.add(Triangle{vector(), vector(), vector()}, Color{1});
    scene.add(Box{{-1, -1, -1}, {1, 1, 1}}, Color{1});
    scene.add(Cube{vector(), 1}, Color{1});
  }
  std::size_t index = 0, flat = 0;
  const auto check = [&]<class T>(const auto& accelerated, const SceneVector<T>& surfaces) {
    REQUIRE(accelerated.template equations<T>().size() == surfaces.size());
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      CAPTURE(index);
      const T& surface = surfaces[i];
      if constexpr (PreparedSurface<T>) {
        const Ray ray{.origin = random.point(9), .direction = random.point(1)};
        const auto prepared = accelerated.template equations<T>()[i].equation(ray),
                   own = surface.equation(ray);
        CHECK(prepared.height == own.height);
        CHECK(prepared.slope == own.slope);
        CHECK(prepared.is_certain == own.is_certain);
        CHECK(prepared.misses == own.misses);
        CHECK(prepared.crosses == own.crosses);
      }
      const SurfaceConstants* const constants = accelerated.constants(index++);
      REQUIRE(constants != nullptr);
      CHECK(constants->departure.has_value() == !is_made_of_primitives<T>);
      if (constants->departure) {
        CHECK(*constants->departure == departure_of(surface));
        CHECK(constants->departure->surface == &surface);
      }
      CHECK(constants->normal.has_value() == is_flat<T>);
      if constexpr (is_flat<T>) {
        ++flat;
        for (int k = 0; k < 10; ++k) CHECK(*constants->normal == surface.normal_at(random.point(9)));
      }
    }
  };
  {
    const auto few = accelerate(scene);
    check(few, scene.surfaces<Sphere>()), check(few, scene.surfaces<Plane>());
    check(few, scene.surfaces<Disk>()), check(few, scene.surfaces<Parallelogram>());
    check(few, scene.surfaces<Triangle>()), check(few, scene.surfaces<Box>());
    check(few, scene.surfaces<Cube>());
    CHECK(index == 14);
    CHECK(flat == 8);
  }
  while (scene.size() <= simd::few_surfaces) scene.add(Sphere{{0, 0, 0}, 1}, Color{1});
  CHECK(accelerate(scene).constants(0) == nullptr);
}

TEST_CASE("accelerate refuses a negative number of threads for many surfaces and for none") {
  Scene<Sphere> scene;
  for (int i = 0; i < 10000; ++i) scene.add(Sphere{.center = Point(i), .radius = 1}, Color{1});
  CHECK_NOTHROW(accelerate(scene, {.samples = -1, .threads = 2}));  // accelerate takes no samples
  CHECK_THROWS_AS(accelerate(scene, {.threads = -1}), std::invalid_argument);
  const Scene<Sphere, Plane> few;  // built by one thread in any case
  CHECK_THROWS_AS(accelerate(few, {.threads = -1}), std::invalid_argument);
}

TEST_CASE("an accelerated scene refuses to answer if surfaces were added to its scene or removed") {
  Scene<Sphere, Cylinder> scene;
  scene.add(Sphere{.center = {0, 0, 5}, .radius = 1}, Color{1});
  const auto fast = accelerate(scene);
  const Ray ray;
  const auto hit_in_front = [&] {
    const auto hit = fast.intersect(ray);
    return hit ? hit->t : infinity;
  };
  CHECK(hit_in_front() == 4);

  // Lights and sky are not in the tree.
  scene.add(PointLight{.power = Color{1}});
  scene.set_sky(Color{0.5f});
  CHECK(hit_in_front() == 4);
  CHECK(fast.lights().size() == 1);

  const auto refuses = [&](const char* sentence) {
    Image image(4, 4);
    bool asked = false;
    const auto is_asked = [&](const Ray&, const auto&) { return asked = true, Color{0}; };
    const std::function<void()> uses[] = {
        [&] { static_cast<void>(fast.intersect(ray)); },
        [&] { static_cast<void>(fast.occluded(ray)); },
        [&] { fast.crossings(ray, Interval{}, [](const Intersection&) {}); },
        [&] { render(image, Camera{}, fast, ShadowIntegrator{}); },
        [&] { render(image, Camera{}, fast, ShadowIntegrator{}, {.tiles = false}); },
        [&] { render(image, Camera{}, fast, is_asked); },
        [&] { render(image, Camera{}, fast, is_asked, {.tiles = false}); },
    };
    for (const auto& use : uses) CHECK_THAT(message_of<std::logic_error>(use), ContainsSubstring(sentence));
    CHECK_FALSE(asked);
  };
  scene.add(Sphere{.center = {0, 0, 2}, .radius = 1}, Color{1});
  refuses("the scene had 1, 0 surfaces of its types when it was accelerated, and now has 2, 0");
  CHECK(accelerate(scene).intersect(ray)->t == 1);

  scene = {};
  refuses("the scene had 1, 0 surfaces of its types when it was accelerated, and now has 0, 0");
  scene.add(Cylinder{}, Color{1});  // as many surfaces, of another type
  refuses("the scene had 1, 0 surfaces of its types when it was accelerated, and now has 0, 1");
}

TEST_CASE("a surface of a user's own has a prepared equation in an accelerated scene") {
  const Parallelogram board{{-1, -1, 3}, {2, 0, 0}, {0, 2, 0.5}};
  Scene<PreparedBoard> scene;
  scene.add(PreparedBoard{board}, Color{1});
  const auto accelerated = accelerate(scene);
  REQUIRE(accelerated.equations<PreparedBoard>().size() == 1);
  Random random(21);
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{.direction = {random.real(-1, 1), random.real(-1, 1), 2}};
    CHECK(accelerated.equations<PreparedBoard>()[0].equation(ray).height == board.equation(ray).height);
    const auto hit = accelerated.intersect(ray);
    const auto t = board.intersect(ray);
    REQUIRE(hit.has_value() == t.has_value());
    if (!t) continue;
    ++hits;
    CHECK(hit->t == *t);
  }
  CHECK((50 < hits && hits < 200));
}

TEST_CASE("an empty accelerated scene has no hits and occludes nothing") {
  const Scene<Sphere, Plane> scene;
  const auto fast = accelerate(scene);
  CHECK_FALSE(fast.intersect(Ray{}));
  CHECK_FALSE(fast.occluded(Ray{}));
  CHECK(&fast.lights() == &scene.lights());
}

namespace {

Sphere far_from(const Sphere&) { return {{99, 0, 0}, 1}; }
Plane far_from(const Plane&) { return {{0, 0, 1}, 99}; }

/// Tests whether an accelerated scene has the answers of the scene for a ray that left a surface of another
/// scene, at whose address it has a surface.
template <class S>
void check_kept_departure(const S& left, const S& other) {
  Scene<S> scene, next;
  for (int i = 0; i < 20; ++i) {
    scene.add(i == 5 ? left : far_from(left), Color{1});
    next.add(i == 5 ? other : far_from(left), Color{1});
  }
  const Ray towards{.origin = {0, 0, -5}, .direction = {0, 0, 1}};
  const Ray kept = accelerate(scene).intersect(towards).value().leave({0, 0, -1});
  scene = next;  // in the same memory
  const auto fast = accelerate(scene);
  REQUIRE(scene.occluded(kept));
  CHECK(fast.occluded(kept));
  CHECK(fast.intersect(kept).has_value());
}

}  // namespace

TEST_CASE("an accelerated scene hits a surface at the address of one that a ray has left in another scene") {
  check_kept_departure(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, -10}, 1});
  check_kept_departure(Sphere{{0, 0, 0}, 1}, Sphere{{0, 0, 10}, 20});
  check_kept_departure(Plane{{0, 0, -1}, 0}, Plane{{0, 0, 1}, -10});
}
