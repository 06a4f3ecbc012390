// Meshes as solids, alone and in CSG trees.
#include <array>
#include <cstdint>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/mesh.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/meshes.hpp"
#include "support/pictures.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {}  // namespace

TEST_CASE("a mesh is a solid if each edge belongs to as many triangles in one direction as in the other") {
  for (const MeshData& closed : {meshes::box(2), meshes::icosphere(1), meshes::torus(9, 7)}) {
    CHECK(closed.is_closed());
    MeshData apart = closed;  // each triangle with vertices of its own
    apart.vertices.clear();
    for (auto& triangle : apart.triangles)
      for (std::uint32_t& vertex : triangle) {
        apart.vertices.push_back(closed.vertices[vertex]);
        vertex = static_cast<std::uint32_t>(apart.vertices.size()) - 1;
      }
    CHECK(apart.is_closed());
    CHECK(is_solid(Mesh(apart)));
    MeshData turned = closed;
    std::swap(turned.triangles[3][0], turned.triangles[3][1]);
    CHECK_FALSE(turned.is_closed());
    MeshData open = closed;
    open.triangles.pop_back();
    CHECK_FALSE(open.is_closed());
    open.triangles.push_back({0, 1, 0});  // without area, it closes nothing
    CHECK_FALSE(open.is_closed());
    MeshData moved = closed;
    const std::uint32_t corner = moved.triangles[0][0];
    moved.vertices.push_back(moved.vertices[corner] * (1 + 1e-15));
    moved.triangles[0][0] = static_cast<std::uint32_t>(moved.vertices.size()) - 1;
    CHECK_FALSE(moved.is_closed());
  }
  const MeshData triangle{.vertices = {{0, 0, 3}, {2, 0, 3}, {0, 2, 3}}, .triangles = {{0, 1, 2}}};
  CHECK_FALSE(is_solid(Mesh(triangle)));
  MeshData both_sides = triangle;
  both_sides.triangles.push_back({1, 0, 2});
  CHECK(both_sides.is_closed());
  MeshData zeros = both_sides;  // −0 equals 0
  zeros.vertices.push_back({-0.0, -0.0, 3});
  zeros.triangles[1] = {1, 3, 2};
  CHECK(zeros.is_closed());
}

TEST_CASE("a closed mesh works in CSG trees like other solids") {
  const MeshData cube = meshes::box(1);  // equal to the box from −1 to 1
  const Mesh mesh(cube);
  CHECK(is_solid(mesh));
  CHECK(mesh.primitive_count() == 48);
  const Box box{Point{-1}, Point{1}};
  Random random(86);
  int crossed = 0;
  WrongCases wrong(random);
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
      const auto expected = crossings_of_solid(of_box[k], line, everywhere);
      wrong.add(crossings_of_solid(of_mesh[k], line, everywhere) != expected, box, cut, line);
      crossed += !expected.empty();
      // Compares also the rays that leave the first crossing in any direction.
      const auto first = of_box[k].first_crossing(line, {});
      const auto same = of_mesh[k].first_crossing(line, {});
      if (!first || !same) continue;
      const Vec3 on = random.direction();
      const Point p = line.at(first->t);
      wrong.add(of_mesh[k].normal_at(p, same->primitive) != of_box[k].normal_at(p, first->primitive), box,
                cut, line, p);
      wrong.add(crossings_of_solid(of_mesh[k], {p, on, of_mesh[k].departure(same->primitive)}) !=
                    crossings_of_solid(of_box[k], {p, on, of_box[k].departure(first->primitive)}),
                box, cut, line, on, p);
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

TEST_CASE("a cube that is cut by CSG has the same picture as a mesh and as a box") {
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
