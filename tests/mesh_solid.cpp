// Meshes among the solids of a tree.
#include <array>
#include <protostar/integrators/shadow.hpp>
#include <protostar/render.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

const Interval everywhere{-infinity, infinity};

std::vector<double> crossings(const Csg& tree, const Ray& ray, Interval range = {}) {
  std::vector<double> all;
  tree.each_crossing(ray, range, [&](const Crossing& crossing) { all.push_back(crossing.t); });
  return all;
}

}  // namespace

TEST_CASE("a closed mesh is a solid like others") {
  const MeshData cube = meshes::box(1);  // as the box from −1 to 1
  const Mesh mesh(cube);
  CHECK(is_solid(mesh));
  CHECK(mesh.part_count() == 48);
  const Box box{Point{-1}, Point{1}};
  Random random(86);
  int crossed = 0, wrong = 0;
  for (int i = 0; i < 3000; ++i) {
    const Sphere cut{random.point(1), random.real(0.3, 1.2)};
    const auto with = [&](const Csg& solid) {
      return std::array{union_of({solid, cut}), intersection_of({solid, cut}), difference_of({solid, cut}),
                        difference_of({cut, solid})};
    };
    const auto of_mesh = with(mesh), of_box = with(box);
    const Point origin = random.point(3);
    const Ray line{origin, random.point(1) - origin};
    for (std::size_t k = 0; k < of_box.size(); ++k) {
      const auto expected = crossings(of_box[k], line, everywhere);
      wrong += crossings(of_mesh[k], line, everywhere) != expected;
      crossed += !expected.empty();
      // And behind the first of them, along any other line.
      const auto first = of_box[k].first_crossing(line, {});
      const auto same = of_mesh[k].first_crossing(line, {});
      if (!first || !same) continue;
      const Vec3 on = random.direction();
      const Point p = line.at(first->t);
      wrong += of_mesh[k].normal_at(p, same->part) != of_box[k].normal_at(p, first->part);
      wrong += crossings(of_mesh[k], {p, on, of_mesh[k].departure(same->part)}) !=
               crossings(of_box[k], {p, on, of_box[k].departure(first->part)});
    }
  }
  CHECK(crossed > 3000);
  CHECK(wrong == 0);

  MeshData open = cube;
  open.triangles.pop_back();
  CHECK_FALSE(is_solid(Mesh(open)));
  CHECK_THAT(message_of<std::invalid_argument>([&] { (void)Csg(Mesh(open)); }),
             ContainsSubstring("closed solid"));
}

TEST_CASE("a cube is cut to the same picture as a mesh and as a box") {
  const auto picture = [](const Csg& cube, bool by_tiles) {
    Scene<Csg, Plane> scene;
    scene.add(difference_of({cube, Sphere{{0.5, 0.5, -1}, 0.9}, Sphere{{-1, 0, 0}, 0.5}}),
              Color{0.9f, 0.5f, 0.1f});
    scene.add(intersection_of({cube, Sphere{{0.9, 0.3, -0.7}, 0.4}}), Color{0.1f, 0.5f, 0.9f});
    scene.add(Plane{{0, 1, 0}, -1}, Color{0.4f});
    scene.add(PointLight{.position = {3, 4, -5}, .power = Color{900}});
    Image image(96, 64);
    render(image, Camera{.position = {0.3, 0.7, -3}}, scene, ShadowIntegrator{}, {.tiles = by_tiles});
    return image;
  };
  const Mesh mesh(meshes::box(1));
  const Image expected = picture(Box{Point{-1}, Point{1}}, false);
  CHECK(count_pixels(expected, [&](int x, int y) { return expected(x, y).b > expected(x, y).r; }) > 50);
  CHECK(different_pixels(picture(mesh, false), expected) == 0);
  CHECK(different_pixels(picture(mesh, true), expected) == 0);
}
