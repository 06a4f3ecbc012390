// Normal maps: tangents, shading normals, and what integrators make of them.
#include <protostar/accel/accelerate.hpp>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/lobes.hpp>
#include <protostar/normals.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/surfaces/triangle.hpp>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/cylinder.hpp"
#include "support/drawn_alike.hpp"
#include "support/errors.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/ray_by_ray.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

const NormalMap level = [](double, double) { return Vec3{0, 0, 1}; };

/// Returns a normal map that has one direction everywhere.
NormalMap constant(const Vec3& direction) {
  return [=](double, double) { return direction; };
}

/// Waves that tilt the normal by up to 45 degrees along u and along v.
const NormalMap wave_map = [](double u, double v) { return Vec3{std::sin(30 * u), std::sin(40 * v), 1}; };

/// Returns true if vectors are within some roundings of 2^-53.
bool is_near(const Vec3& a, const Vec3& b, double roundings) { return length(a - b) <= roundings * 0x1p-53; }

// With u = 2^-53, and where normal and tangents have exact numbers, or of 4.5u each by normalize
// (camera.cpp), the tilted normal is off by 9u for its terms and their sums, by 4.5u for normalize, and the
// expected by 2u.
constexpr double tilt_roundings = 16;

// The most roundings are those of a sphere askew. At rest, normal and tangents are off from right angles by
// at most 8u. The map's largest factor is 2, and so is its inverse's: 8u grow to 32u. Rows and columns have a
// size of √5.25, sums of theirs errors of 4u and 3u, and results a size of ½ or more: 18.4u and 13.8u.
// normalize adds 4.5u, and a dot product 3u.
constexpr double askew_roundings = 72;

/// A square in the plane z = 4, of the corners (−1, −1) and (1, 1), whose normal leads to the eye at 0. u and
/// v grow with x and y.
MeshData square_with(std::vector<Uv> uvs) {
  return {.vertices = {{-1, -1, 4}, {1, -1, 4}, {1, 1, 4}, {-1, 1, 4}},
          .triangles = {{0, 2, 1}, {0, 3, 2}},
          .uvs = std::move(uvs)};
}

const MeshData square_ahead = square_with({{0, 0}, {1, 0}, {1, 1}, {0, 1}});

/// Surfaces of all kinds in front of the eye at 0, and for each a ray that hits it. Some stand obliquely.
struct Target {
  std::string name;
  AnySurface surface;
  Ray ray;
};

std::vector<Target> targets() {
  const Affine askew = Affine{}.scaled_by({1, 0.5, 2}).rotated_about({1, 2, 3}, 40).moved_by({0, 0, 5});
  const Affine mirrored = Affine{}.scaled_by({-1, 1, 1}).moved_by({0, 0, 4});
  const Ray ahead{.origin = {0.1, 0.2, 0}, .direction = {0, 0, 1}};
  const Quadric ellipsoid{{.squares = {1, 2, 3}, .products = {0.1, 0.2, -0.3}, .constant = -1}};
  const Ray down_z{.origin = {0.1, 0.2, -5}, .direction = {0, 0, 1}};
  MeshData slanted = square_with({{0, 0}, {2, 1}, {2, 3}, {0.5, 2}}),
           mirrored_square = square_with({{1, 0}, {0, 0}, {0, 1}, {1, 1}});
  return {{"sphere", Sphere{.center = {0, 0, 4}}, ahead},
          {"sphere from inside", Sphere{.center = {0, 0, 1}, .radius = -3}, ahead},
          {"plane", Plane{.normal = {1, 2, -3}, .distance = -9}, ahead},
          {"parallelogram",
           Parallelogram{.position = {-1, -1, 4}, .edge_u = {3, 0.5, 0}, .edge_v = {1, 4, 1}}, ahead},
          {"triangle", Triangle{{-3, -1, 4}, {3, -1, 5}, {0, 3, 4}}, ahead},
          {"disk", Disk{.position = {0, 0, 4}, .normal = {1, 2, -3}}, ahead},
          {"box", Box{.min = {-1, -1, 4}, .max = {1, 1, 5}}, ahead},
          {"quadric", ellipsoid, down_z},
          {"hyperboloid", Quadric{{.squares = {1, -2, 3}, .products = {0.1, 0.2, -0.3}}}, down_z},
          {"paraboloid",
           Quadric{{.squares = {1, 2, 0}, .products = {0, 0, -0.3}, .linear = {0.1, 0.2, 1}, .constant = 0}},
           down_z},
          {"mesh", Mesh(square_ahead), ahead},
          {"mesh without texture coordinates", Mesh(square_with({})), ahead},
          {"mesh with slanted coordinates", Mesh(slanted), ahead},
          {"mesh with mirrored coordinates", Mesh(mirrored_square), ahead},
          {"difference of spheres",
           Csg(Csg::Operation::first_alone,
               {Sphere{.center = {0, 0, 4}}, Sphere{.center = {0, 0, 3}, .radius = 0.8}}),
           ahead},
          {"instance askew", Instance(AnySurface(Sphere{}), askew), ahead},
          {"box askew", Instance(AnySurface(Box{.min = {-1, -1, -1}, .max = {1, 1, 1}}), askew), ahead},
          {"mirror image of a sphere", Instance(AnySurface(Sphere{}), mirrored), ahead},
          {"mirror image of an instance",
           Instance(AnySurface(Instance(AnySurface(Mesh(square_ahead)), Affine{}.scaled_by({1, 2, 1}))),
                    mirrored),
           Ray{.origin = {0.1, 0.2, 4}, .direction = {0, 0, 1}}}};
}

/// Returns the closest hit of a target's ray with it, in a scene that stays.
Intersection hit_of(const Scene<AnySurface>& scene, const Ray& ray) {
  const auto hit = scene.intersect(ray);
  REQUIRE(hit);
  return *hit;
}

Scene<AnySurface> scene_of(const AnySurface& surface, const Material& material) {
  Scene<AnySurface> scene;
  scene.add(surface, material);
  return scene;
}

/// Returns the shading normal where a target's ray hits it.
Vec3 mapped_normal_of(const AnySurface& surface, const Ray& ray, const NormalMap& map) {
  const auto scene = scene_of(surface, {.normal_map = map});
  return hit_of(scene, ray).normal();
}

}  // namespace

TEST_CASE("tangents lead where u grows and v stays, and where v grows and u stays") {
  for (const auto& [name, surface, ray] : targets()) {
    CAPTURE(name);
    REQUIRE(has_tangents(surface));
    const auto scene = scene_of(surface, Material{});
    const Intersection hit = hit_of(scene, ray);
    const Tangents along = surface.tangents_at(hit.point(), hit.primitive());
    const auto moved_by = [&, &on = surface](const Vec3& way) {
      const Vec3 step = 0x1p-16 / length(way) * way;
      return on.uv_at(hit.point() + step, hit.primitive()) - on.uv_at(hit.point() - step, hit.primitive());
    };
    const Uv by_u = moved_by(along.u), by_v = moved_by(along.v);
    constexpr double u = 0x1p-53;
    CHECK(std::abs(dot(hit.normal(), along.u)) <= askew_roundings * u * length(along.u));
    CHECK(std::abs(dot(hit.normal(), along.v)) <= askew_roundings * u * length(along.v));
    // Both ways change v, or u, alike: roundings remain. On planes they are 19.4u of a point's size
    // (coordinates.cpp), here up to 5.4, for both points; they are less on other surfaces. Measured is 1u.
    constexpr double most = 2 * 19.4 * 5.4 * u;
    CHECK(by_u.x > 0x1p-20);
    CHECK(std::abs(by_u.y) <= most);
    CHECK(by_v.y > 0x1p-20);
    CHECK(std::abs(by_v.x) <= most);
  }
}

TEST_CASE("a normal map tilts the normal along u, and at a right angle to it on the side of v") {
  for (const auto& [name, surface, ray] : targets()) {
    CAPTURE(name);
    const auto scene = scene_of(surface, Material{});
    const Intersection hit = hit_of(scene, ray);
    const auto [u, v] = surface.tangents_at(hit.point(), hit.primitive());
    const Vec3 n = hit.normal(), t = normalize(u);
    const Vec3 right = cross(n, t), b = dot(right, v) > 0 ? right : -right;
    // Two cross products and normalize are off by 10.2u, an angle to u that is not right by its cosine more.
    // Measured are 7u.
    const double roundings = tilt_roundings + 10.2 + askew_roundings;
    CHECK(is_near(mapped_normal_of(surface, ray, constant({3, 0, 4})), 0.6 * t + 0.8 * n, roundings));
    CHECK(is_near(mapped_normal_of(surface, ray, constant({0, 3, 4})), 0.6 * b + 0.8 * n, roundings));
    CHECK(is_near(mapped_normal_of(surface, ray, constant({-0.2, 0.4, 0.4})),
                  (-0.2 * t + 0.4 * b + 0.4 * n) / 0.6, roundings));
  }
}

TEST_CASE("a path scatters by the normals on the side that its ray comes from, the shading normal too") {
  const auto scene =
      scene_of(Parallelogram{{-1, -1, 4}, {2, 0, 0}, {0, 2, 0}}, {.normal_map = constant({3, 0, 4})});
  for (const double side : {-1.0, 1.0}) {
    CAPTURE(side);
    const Vertex vertex(hit_of(scene, {.origin = {0, 0, 4 + side}, .direction = {0, 0, -side}}));
    CHECK(vertex.normals.surface == Vec3{0, 0, side});
    CHECK(is_near(vertex.normals.shading, {side * 0.6, 0, side * 0.8}, tilt_roundings));
    CHECK(vertex.enters == (side > 0));
  }
}

TEST_CASE("shading normals that are known by hand") {
  // Ahead of the eye, on the sphere's side that faces it: u grows to the left and v downwards.
  const Ray ahead{.direction = {0, 0, 1}};
  struct Row {
    std::string name;
    AnySurface surface;
    Vec3 to_u, to_v;
  };
  const auto mirrored = Affine{}.scaled_by({-1, 1, 1});
  const auto flat = Affine{}.scaled_by({1, 1, 0.1}).moved_by({0, 0, 3.6});
  for (const auto& [name, surface, to_u, to_v] : {
           Row{"sphere", Sphere{.center = {0, 0, 4}}, {-0.6, 0, -0.8}, {0, -0.6, -0.8}},
           Row{"square", Mesh(square_ahead), {0.6, 0, -0.8}, {0, 0.6, -0.8}},
           Row{"square with u from right to left",
               Mesh(square_with({{1, 0}, {0, 0}, {0, 1}, {1, 1}})),
               {-0.6, 0, -0.8},
               {0, 0.6, -0.8}},
           Row{"mirror image of the square",
               Instance(AnySurface(Mesh(square_ahead)), mirrored),
               {-0.6, 0, -0.8},
               {0, 0.6, -0.8}},
           Row{"flattened square",
               Instance(AnySurface(Mesh(square_ahead)), flat),
               {0.6, 0, -0.8},
               {0, 0.6, -0.8}},
           Row{"board",
               Parallelogram{.position = {-1, -1, 4}, .edge_u = {0, 2, 0}, .edge_v = {2, 2, 0}},
               {0, 0.6, -0.8},
               {0.6, 0, -0.8}},
       }) {
    CAPTURE(name);
    CHECK(is_near(mapped_normal_of(surface, ahead, constant({3, 0, 4})), to_u, tilt_roundings));
    CHECK(is_near(mapped_normal_of(surface, ahead, constant({0, 3, 4})), to_v, tilt_roundings));
  }
}

TEST_CASE("the vertex normals of a mesh are tilted, not those of its triangles") {
  MeshData smooth = square_ahead;
  smooth.normals.assign(4, Vec3{0, 0.6, -0.8});
  CHECK(is_near(mapped_normal_of(Mesh(smooth), Ray{}, constant({3, 0, 4})),
                0.6 * Vec3{1, 0, 0} + 0.8 * Vec3{0, 0.6, -0.8}, tilt_roundings));
}

TEST_CASE("the direction of a normal map may be of any length") {
  const Parallelogram board{.position = {-1, -1, 4}, .edge_u = {0, 2, 0}, .edge_v = {2, 0, 0}};
  const Vec3 tilted = mapped_normal_of(board, Ray{}, constant({3, 4, 12}));
  CHECK(is_near(tilted, Vec3{4, 3, -12} / 13.0, tilt_roundings));
  for (const double size : {0x1p-1060, 0x1p-600, 0x1p-100, 0x1p100, 0x1p520, 0x1p1019}) {
    CAPTURE(size);
    CHECK(mapped_normal_of(board, Ray{}, constant(size * Vec3{3, 4, 12})) == tilted);
  }
}

TEST_CASE("a normal map of an empty std::function is none, as of no function") {
  CHECK(!NormalMap());
  CHECK(!NormalMap(std::function<Vec3(double, double)>()));
  CHECK(!NormalMap(static_cast<Vec3 (*)(double, double)>(nullptr)));
  CHECK(NormalMap(std::function<Vec3(double, double)>(wave_map)));
}

TEST_CASE("a normal map tilts nothing where the directions of u and v are not known") {
  const Ray down{.origin = {0, 5, 0}, .direction = {0, -1, 0}};  // to a pole
  CHECK(mapped_normal_of(Sphere{}, down, wave_map) == Vec3{0, 1, 0});
  CHECK(mapped_normal_of(Mesh(square_with(std::vector<Uv>(4, Uv{1, 2}))), Ray{.origin = {0.1, 0.3, 0}},
                         constant({3, 0, 4})) == Vec3{0, 0, -1});
}

TEST_CASE("a normal map tilts nothing on cones and cylinders, where u and v are no coordinates") {
  Random random(5);
  int hits = 0;
  // The squares along three axes at right angles, and the constant, of a form around a center.
  for (const auto& [squares, constant] : {std::pair{Vec3{1, 1, -1}, 0.0}, std::pair{Vec3{3, 0.5, -1}, 0.0},
                                          std::pair{Vec3{1, 4, 0}, -1.0}, std::pair{Vec3{1, -2, 0}, 1.0}})
    for (int i = 0; i < 100; ++i) {
      const Affine turned = Affine{}.rotated_about(random.direction(), random.real(0, 360));
      const Point center = random.point(100);
      QuadricForm form{.squares = Vec3{0}, .constant = constant};
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 a =
            turned.vector(Vec3{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0});
        form.squares += squares[axis] * a * a;
        form.products += squares[axis] * Vec3{a.y * a.z, a.z * a.x, a.x * a.y};
      }
      form.linear = -form.times(center);
      form.constant -= dot(form.linear, center);
      CHECK(curvature_sign(form) == 0);
      const auto scene = scene_of(Quadric{form}, {.normal_map = wave_map});
      const Point eye = center + 5.0 * random.direction();
      if (const auto hit = scene.intersect({.origin = eye, .direction = random.direction()})) {
        ++hits;
        CHECK(hit->normal() == hit->surface_normal());
      }
    }
  CHECK(hits > 100);
}

TEST_CASE("the sign of a quadric's curvature is that of its shape, at any size and place") {
  for (const double size : {0x1p-100, 1.0, 0x1p100})
    for (const double factor : {-0x1p-90, 1.0, -0x1p100})
      for (const Vec3& center : {Vec3{0}, size * Vec3{3, -2, 5}}) {
        const auto sign_of = [&](const Vec3& squares, const Vec3& linear, double constant) {
          QuadricForm form{.squares = factor * squares,
                           .linear = factor * size * linear - factor * squares * center,
                           .constant = factor * size * size * constant};
          form.constant += factor * dot(squares * center, center) - 2 * factor * size * dot(linear, center);
          return curvature_sign(form);
        };
        CHECK(sign_of({1, 2, 3}, {}, -1) == 1);           // an ellipsoid
        CHECK(sign_of({1, 2, -3}, {}, -1) == -1);         // a hyperboloid of one sheet
        CHECK(sign_of({1, 2, -3}, {}, 1) == 1);           // a hyperboloid of two sheets
        CHECK(sign_of({1, 2, 0}, {0, 0, -1}, 0) == 1);    // a paraboloid
        CHECK(sign_of({1, -2, 0}, {0, 0, -1}, 0) == -1);  // a saddle
        CHECK(sign_of({1, 0, 0}, {0, 0, -1}, 0) == 0);    // a parabolic cylinder
      }
}

TEST_CASE("tangents of numbers near the limits of coordinates still give unit normals") {
  for (const double size : {0x1p-398, 0x1p398}) {
    CAPTURE(size);
    MeshData data = square_ahead;
    for (Point& vertex : data.vertices) vertex *= size;
    for (Uv& uv : data.uvs) uv *= size;
    const Vec3 normal = mapped_normal_of(Mesh(data), Ray{}, constant({3, 0, 4}));
    CHECK(is_near(normal, {0.6, 0, -0.8}, tilt_roundings));
  }
}

TEST_CASE("a surface without coordinates takes no normal map") {
  Scene<Cylinder> scene;
  CHECK_THAT(
      message_of<std::invalid_argument>([&] { scene.add(Cylinder{}, Material{.normal_map = wave_map}); }),
      ContainsSubstring("normal map") && ContainsSubstring("tangents_at(point)"));
  Scene<AnySurface> any;
  CHECK_THROWS_AS(any.add(Instance(AnySurface(Cylinder{}), {}), Material{.normal_map = wave_map}),
                  std::invalid_argument);
  CHECK_NOTHROW(scene.add(Cylinder{}, Material{}));
}

namespace {

using All = Scene<Sphere, Plane, Parallelogram, Mesh, AnySurface>;

All scene_with(const NormalMap& map) {
  const Material matte{.diffuse = {0.8f, 0.6f, 0.4f}, .normal_map = map},
      shiny{.diffuse = Color{0.3f}, .normal_map = map, .specular = Color{0.5f}, .reflect = 0.4},
      glass{.normal_map = map, .specular = Color{0.5f}, .reflect = 0.2, .refract = 0.7};
  All scene;
  scene.add(Sphere{.center = {-0.6, 0.4, 4}}, shiny);
  scene.add(Sphere{.center = {1, 0.5, 3}, .radius = 0.6}, glass);
  scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, shiny);
  scene.add(Parallelogram{.position = {-3, -1, 6}, .edge_u = {4, 0, 2}, .edge_v = {0.5, 3, 0}}, matte);
  MeshData data = square_ahead;
  for (Point& p : data.vertices) p = 0.5 * p + Point{0, -0.5, 0.3};
  scene.add(Mesh(data), matte);
  scene.add(AnySurface(Instance(AnySurface(Box{.min = {0.2, 0.1, 4}, .max = {1, 1, 5}}),
                                Affine{}.rotated_about({1, 1, 0}, 20))),
            shiny);
  scene.set_sky({0.2f, 0.3f, 0.5f});
  scene.add(PointLight{.position = {-2, 3, 0}, .power = Color{300}});
  scene.add(DirectionalLight{.direction = {1, 0.5, 0.3}, .intensity = Color{0.4f}});
  return scene;
}

template <class I>
void check_integrator(const std::string& name, const I& integrator) {
  CAPTURE(name);
  const Camera camera;
  const All mapped = scene_with(wave_map), plain = scene_with({});
  const auto [lit, different] = drawn_alike(mapped, camera, integrator);
  CHECK(lit > 1000);
  CHECK(different == 0);
  const Image without = ray_by_ray(camera, 64, 48, plain, integrator);
  CHECK(different_bytes(ray_by_ray(camera, 64, 48, mapped, integrator), without) > 1000);
  CHECK(different_bytes(ray_by_ray(camera, 64, 48, scene_with(level), integrator), without) == 0);
}

}  // namespace

TEST_CASE(
    "integrators use the shading normal, alike for packets and for one ray; a level map changes no byte") {
  check_integrator("normal", NormalIntegrator{});
  check_integrator("diffuse", DiffuseIntegrator{});
  check_integrator("shadow", ShadowIntegrator{});
  check_integrator("whitted", WhittedIntegrator{.depth = 4});
}

namespace {

/// Returns a board in the plane y = 0 with a normal map of random slopes up to steep ones, and its scene.
Scene<Parallelogram> floor_with(Material material) {
  material.normal_map = [](double u, double v) {
    return Vec3{3 * std::sin(50 * u), 3 * std::sin(70 * v), 1};
  };
  Scene<Parallelogram> scene;
  scene.add(Parallelogram{.position = {-9, 0, -9}, .edge_u = {18, 0, 0}, .edge_v = {0, 0, 18}}, material);
  return scene;
}

/// The camera looks down at it, at a grazing angle for most of the picture.
const Camera above = Camera::perspective({0, 0.5, -8}, {0, 0, 1}, {0, 1, 0}, 60);

/// Returns the number of pixels that hit the floor and see more of one channel than of another.
int pixels_with(const Image& image, auto&& is_so) {
  return count_pixels(image, [&](int x, int y) { return is_so(image(x, y)); });
}

}  // namespace

TEST_CASE("a light behind the surface gives nothing, however the normal is tilted") {
  auto scene = floor_with({.diffuse = Color{1}, .specular = Color{1}});
  scene.add(PointLight{.position = {0, -0.5, 0}, .power = Color{1000}});
  scene.add(DirectionalLight{.direction = {1, -0.1, 0}, .intensity = Color{1}});
  const auto is_lit = [](const Color& c) { return c != Color{0}; };
  CHECK(pixels_with(ray_by_ray(above, 64, 48, scene, DiffuseIntegrator{}), is_lit) == 0);
  CHECK(pixels_with(ray_by_ray(above, 64, 48, scene, ShadowIntegrator{}), is_lit) == 0);
  CHECK(pixels_with(ray_by_ray(above, 64, 48, scene, WhittedIntegrator{}), is_lit) == 0);
  scene.add(PointLight{.position = {0, 0.5, 0}, .power = Color{1000}});
  CHECK(pixels_with(ray_by_ray(above, 64, 48, scene, ShadowIntegrator{}), is_lit) > 300);
}

TEST_CASE("mirrored rays stay before the surface, and refracted rays pass it, however the normal is tilted") {
  const Texture red_above = [](double, double v) { return v < 0.5 ? Color{1, 0, 0} : Color{0, 1, 0}; };
  const auto is_red = [](const Color& c) { return c.r > 0; };
  const auto is_green = [](const Color& c) { return c.g > 0; };
  const int upper_half = 64 * 24;  // above the horizon, where the sky is seen
  {
    auto scene = floor_with({.reflect = 1});
    scene.set_environment(red_above);
    const Image image = ray_by_ray(above, 64, 48, scene, WhittedIntegrator{});
    CHECK(pixels_with(image, is_red) > upper_half + 500);
    CHECK(pixels_with(image, [&](const Color& c) { return is_green(c); }) < 64 * 2);  // beyond the floor
  }
  {
    auto scene = floor_with({.refract = 1, .ior = 1 / 1.5});
    scene.set_environment(red_above);
    const Image image = ray_by_ray(above, 64, 48, scene, WhittedIntegrator{});
    CHECK(pixels_with(image, is_green) > 300);
    CHECK(pixels_with(image, is_red) == upper_half);
  }
}
