// Families of random scenes in which surfaces touch, coincide or lie in each other, and rays through them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <protostar/numeric/affine.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <protostar/vec3.hpp>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "corpora/boxes.hpp"
#include "corpora/draws.hpp"
#include "corpora/instances.hpp"
#include "corpora/solids.hpp"
#include "made_of.hpp"
#include "support/random.hpp"

namespace scene_families {

using corpora::coin, corpora::whole, corpora::whole_vector, corpora::size;
using protostar::Affine, protostar::Box, protostar::Disk, protostar::Parallelogram, protostar::Plane,
    protostar::Point, protostar::Quadric, protostar::Ray, protostar::Sphere, protostar::Vec3;

/// Surfaces of a scene, and points at which something special happens.
struct Model {
  std::vector<Sphere> spheres;
  std::vector<Plane> planes;
  std::vector<Parallelogram> boards;
  std::vector<Disk> disks;
  std::vector<Box> boxes;
  std::vector<Quadric> quadrics;
  std::vector<Made> trees;
  std::vector<Placed<Sphere>> placed_spheres;
  std::vector<Placed<Box>> placed_boxes;
  std::vector<Placed<Made>> placed_trees;
  std::vector<Point> special;
};

/// Returns all lists of surfaces, in the order in which a scene has them.
inline auto surfaces_of(auto& model) {
  return std::tie(model.spheres, model.planes, model.boards, model.disks, model.boxes, model.quadrics,
                  model.trees, model.placed_spheres, model.placed_boxes, model.placed_trees);
}

struct Family {
  const char* name;
  Model (*next)(Random&);
};

/// Returns spheres in each other, around one center or not.
inline Model nested(Random& random) {
  Model model;
  const Point center = whole_vector(random, -5, 5);
  for (int i = whole(random, 2, 5); i > 0; --i) {
    const Vec3 off = coin(random) ? Vec3{0} : 0.1 * random.point(1);
    model.spheres.push_back({center + off, i + random.real(-0.3, 0.3)});
  }
  model.special.push_back(center);
  return model;
}

/// Returns spheres and planes of small whole numbers that touch in one point, from inside and outside.
inline Model tangent(Random& random) {
  Model model;
  const Point contact = whole_vector(random, -5, 5);
  const int times = whole(random, 0, 2);
  const Vec3 normal = corpora::turned(coin(random) ? Vec3{0, 5, 0} : Vec3{3, 4, 0}, times);
  for (int i = whole(random, 2, 4); i > 0; --i) {
    const double far = whole(random, 1, 6), side = coin(random) ? far : -far;
    model.spheres.push_back({contact + side * normal, 5 * side});
  }
  if (coin(random)) model.planes.push_back({normal, dot(normal, contact)});
  model.special.push_back(contact);
  return model;
}

/// Returns pairs of equal spheres, some turned inside out, and of planes whose equations are multiples of
/// each other, or nearly so.
inline Model coincident(Random& random) {
  Model model;
  for (int i = whole(random, 1, 2); i > 0; --i) {
    const Sphere sphere{random.point(3), random.real(0.5, 2)};
    model.spheres.push_back(sphere);
    model.spheres.push_back({sphere.center, coin(random) ? sphere.radius : -sphere.radius});
    model.special.push_back(sphere.center + sphere.radius * random.direction());
  }
  for (int i = whole(random, 1, 2); i > 0; --i) {
    const Plane plane{whole_vector(random, -3, 3) + Vec3{0, 3.5, 0},
                      static_cast<double>(whole(random, -3, 3))};
    const double times = whole(random, 1, 5), factor = coin(random) ? times : -times;
    model.planes.push_back(plane);
    model.planes.push_back({factor * plane.normal, factor * plane.distance});
    corpora::nudge(random, model.planes.back().normal);
    double& distance = model.planes.back().distance;
    if (distance != 0 && whole(random, 0, 3) == 0) distance = std::nextafter(distance, 9);
  }
  return model;
}

inline Model overlapping(Random& random) {
  Model model;
  for (int i = whole(random, 1, 6); i > 0; --i) {
    const Point center = random.point(3);
    model.spheres.push_back({center, size(random, -3, 2)});
    model.special.push_back(model.spheres.back().center + model.spheres.back().radius * random.direction());
  }
  for (int i = whole(random, 0, 2); i > 0; --i) {
    const Vec3 normal = random.direction();
    model.planes.push_back({normal, random.real(-3, 3)});
  }
  return model;
}

/// Returns boards that lie in one plane and overlap, the plane itself, and others that stand on it or cross
/// it.
inline Model boards(Random& random) {
  Model model;
  const Point corner = whole_vector(random, -3, 3);
  const bool level = coin(random);
  const Vec3 u = level ? Vec3{1, 0, 0} : whole_vector(random, -3, 3),
             v = level ? Vec3{0, 0, 1} : whole_vector(random, -3, 3), n = cross(u, v);
  if (n == Vec3{0}) return boards(random);
  for (int i = whole(random, 1, 3); i > 0; --i) {
    const double a = 0.5 * whole(random, -3, 3), b = 0.5 * whole(random, -3, 3), c = whole(random, -2, 2);
    model.boards.push_back({corner + a * u + b * v, 2.0 * u + c * v, 0.5 * v});
  }
  if (coin(random)) model.planes.push_back({3.0 * n, dot(3.0 * n, corner)});
  if (coin(random)) model.boards.push_back({corner, u, n});
  if (coin(random)) model.boards.push_back({corner + 0.25 * v - n, whole_vector(random, -3, 3), n});
  if (model.boards.back().edge_u == Vec3{0} || cross(model.boards.back().edge_u, n) == Vec3{0})
    model.boards.back().edge_u = u;
  if (coin(random)) model.spheres.push_back({corner + u, 1});
  model.special = {corner, corner + u, corner + 0.5 * u + 0.25 * v};
  return model;
}

/// Returns boxes of small whole numbers that stand on a floor, side by side and on each other, disks that lie
/// on them, and quadrics that touch them.
inline Model solids(Random& random) {
  Model model;
  const int axis = whole(random, 0, 2);
  const double floor = whole(random, -2, 2);
  for (int i = whole(random, 1, 3); i > 0; --i) {
    Point corner = whole_vector(random, -3, 3);
    corner[axis] = coin(random) ? floor : floor + 1;
    const Vec3 size_of_it{whole(random, 1, 3), whole(random, 1, 3), whole(random, 1, 3)};
    model.boxes.push_back({corner, corner + size_of_it});
    model.special.push_back(corner), model.special.push_back(corner + size_of_it);
  }
  Vec3 up{0};
  up[axis] = coin(random) ? 1 : -2;
  const auto& top = model.boxes.back();
  if (coin(random)) model.planes.push_back({up, up[axis] * floor});
  if (coin(random)) model.disks.push_back({top.max, up, static_cast<double>(whole(random, 1, 2))});
  if (coin(random)) model.disks.push_back({top.min, whole_vector(random, -2, 2) + Vec3{0.5}, 1});
  if (coin(random)) model.spheres.push_back({top.max + up / up[axis], 1});
  if (coin(random)) {
    // An ellipsoid, a cylinder or a hyperboloid with its center one unit above a vertex.
    const Point middle = top.max + up / up[axis];
    Vec3 squares{4};
    squares[axis] = whole(random, 0, 2) * 4 - 4;
    model.quadrics.push_back(
        {{.squares = squares, .linear = -squares * middle, .constant = dot(squares * middle, middle) - 4}});
  }
  return model;
}

inline Sphere whole_ball(Random& random) {
  const Point center = whole_vector(random, -2, 2);
  return {center, static_cast<double>(whole(random, 1, 3))};
}
inline Box whole_box(Random& random) {
  const Point one = whole_vector(random, -2, 2), other = whole_vector(random, -2, 2);
  return corpora::box_around(one, other);
}
inline Made whole_tree(Random& random) {
  const int count = whole(random, 2, 4);
  return Made(corpora::tree_of(
      random,
      [](Random& r) { return coin(r) ? SolidTree::Solid(whole_ball(r)) : SolidTree::Solid(whole_box(r)); },
      count));
}

/// Calls visit(point) for points of a surface at which others of whole numbers may touch it.
inline void each_special(const Sphere& s, const auto& visit) {
  visit(s.center), visit(s.center + Vec3{0, s.radius, 0});
}
inline void each_special(const Box& s, const auto& visit) { visit(s.min), visit(s.max); }
inline void each_special(const Quadric&, const auto&) {}
template <class S>
void each_special(const Placed<S>& s, const auto& visit) {
  each_special(s.own, [&](const Point& point) { visit(s.placement.point(point)); });
}
inline void each_special(const Made& s, const auto& visit) {
  s.tree.each_solid([&](const SolidTree::Solid& held) {
    std::visit([&](const auto& solid) { each_special(solid, visit); }, held);
  });
}
inline void each_special(const Placed<Made>& s, const auto& visit) {
  each_special(s.own, [&](const Point& point) { visit(s.placement.point(point)); });
}

/// Adds a surface with its special points.
template <class S>
void add(Model& model, std::vector<S>& surfaces, const S& surface) {
  surfaces.push_back(surface);
  each_special(surface, [&](const Point& point) { model.special.push_back(point); });
}

/// Adds surfaces that whole solids may touch, or have a face in common with.
inline void add_neighbors(Random& random, Model& model) {
  Vec3 up{0};
  up[whole(random, 0, 2)] = coin(random) ? 1 : -2;
  if (coin(random)) model.planes.push_back({up, static_cast<double>(whole(random, -2, 2))});
  if (coin(random)) add(model, model.spheres, whole_ball(random));
  if (coin(random)) add(model, model.boxes, whole_box(random));
}

/// Returns solids made of balls and boxes of small whole numbers.
inline Model trees(Random& random) {
  Model model;
  for (int i = whole(random, 1, 2); i > 0; --i) add(model, model.trees, whole_tree(random));
  add_neighbors(random, model);
  return model;
}

/// Returns images of balls, boxes and solids of whole numbers, by maps of small whole numbers and powers of
/// two.
inline Model instances(Random& random) {
  Model model;
  for (int i = whole(random, 1, 3); i > 0; --i) {
    Affine map = coin(random) ? corpora::whole_map(random) : Affine{};
    map.translation = whole_vector(random, -3, 3);
    switch (whole(random, 0, 2)) {
      case 0:
        add(model, model.placed_spheres, Placed(whole_ball(random), map));
        break;
      case 1:
        add(model, model.placed_boxes, Placed(whole_box(random), map));
        break;
      default:
        add(model, model.placed_trees, Placed(whole_tree(random), map));
    }
  }
  add_neighbors(random, model);
  return model;
}

/// Returns solids made of images of balls and boxes, next to each other in one lattice that is stretched or
/// sheared.
inline Model trees_of_instances(Random& random) {
  Model model;
  Affine map = coin(random) ? corpora::whole_map(random) : Affine{};
  map.translation = whole_vector(random, -3, 3);
  const auto solid = [&](Random& r) {
    Affine other = map;
    if (whole(r, 0, 2) == 0) other.translation += map.vector(whole_vector(r, -1, 1));
    if (coin(r)) return SolidTree::Solid(Placed(whole_ball(r), other));
    return SolidTree::Solid(Placed(whole_box(r), other));
  };
  for (int i = whole(random, 1, 2); i > 0; --i) {
    const int count = whole(random, 2, 4);
    add(model, model.trees, Made(corpora::tree_of(random, solid, count)));
  }
  if (coin(random)) add(model, model.placed_boxes, Placed(whole_box(random), map));
  add_neighbors(random, model);
  return model;
}

/// Returns a surface, scaled and moved.
inline Sphere moved(const Sphere& s, double scale, const Vec3& offset) {
  return {scale * s.center + offset, scale * s.radius};
}
inline Plane moved(const Plane& s, double scale, const Vec3& offset) {
  return {s.normal, scale * s.distance + dot(s.normal, offset)};
}
inline Parallelogram moved(const Parallelogram& s, double scale, const Vec3& offset) {
  return {scale * s.position + offset, scale * s.edge_u, scale * s.edge_v};
}
inline Disk moved(const Disk& s, double scale, const Vec3& offset) {
  return {scale * s.position + offset, s.normal, scale * s.radius};
}
inline Box moved(const Box& s, double scale, const Vec3& offset) {
  return {scale * s.min + offset, scale * s.max + offset};
}
/// Returns a quadric, scaled; its offset must be 0.
inline Quadric moved(const Quadric& s, double scale, const Vec3&) {
  return {{.squares = s.form.squares,
           .products = s.form.products,
           .linear = scale * s.form.linear,
           .constant = scale * scale * s.form.constant}};
}
template <class S>
Placed<S> moved(const Placed<S>& s, double scale, const Vec3& offset) {
  return Placed(s.own, s.placement.scaled_by(Vec3(scale)).moved_by(offset));
}
inline SolidTree moved(SolidTree tree, double scale, const Vec3& offset) {
  std::visit([&](auto& solid) { solid = moved(solid, scale, offset); }, tree.solid);
  for (SolidTree& operand : tree.operands) operand = moved(std::move(operand), scale, offset);
  return tree;
}
inline Made moved(const Made& s, double scale, const Vec3& offset) {
  return Made(moved(s.tree, scale, offset));
}
inline Model moved(Model model, double scale, const Vec3& offset) {
  const auto move_all = [&](auto& surfaces) {
    for (auto& surface : surfaces) surface = moved(surface, scale, offset);
  };
  std::apply([&](auto&... lists) { (move_all(lists), ...); }, surfaces_of(model));
  for (Point& p : model.special) p = scale * p + offset;
  return model;
}

/// Returns a model at a scale of 1e-4 to 1e6, with an offset of up to 1e4 times that: powers of two and whole
/// numbers, which keep contacts and coincidences, or any numbers.
inline Model transformed(const Model& model, Random& random) {
  const int choice = whole(random, 0, 2);
  if (choice == 0) return model;
  if (!model.quadrics.empty()) return moved(model, std::ldexp(1, whole(random, -13, 20)), Vec3{0});
  const double scale = choice == 1 ? std::ldexp(1, whole(random, -13, 20)) : size(random, -13, 20);
  const int reach = whole(random, 0, 10000);
  const Vec3 offset = choice == 1 ? whole_vector(random, -reach, reach) : random.point(reach);
  return moved(model, scale, scale * offset);
}

inline const std::vector<Family> families{
    {"nested", nested},           {"tangent", tangent},     {"coincident", coincident},
    {"overlapping", overlapping}, {"boards", boards},       {"solids", solids},
    {"solids of solids", trees},  {"instances", instances}, {"made of instances", trees_of_instances}};

/// Returns the size of a scene, for the positions of eyes and lights.
inline double extent(const Model& model) {
  double largest = 1e-9;
  const auto take = [&](double size_of_it) { largest = std::max(largest, size_of_it); };
  for (const Sphere& s : model.spheres) take(std::abs(s.radius));
  for (const Parallelogram& s : model.boards) take(length(s.edge_u));
  const auto take_boxes = [&](const auto& surfaces) {
    for (const auto& s : surfaces) take(length(s.bounds().max - s.bounds().min));
  };
  take_boxes(model.boxes), take_boxes(model.trees), take_boxes(model.placed_spheres);
  take_boxes(model.placed_boxes), take_boxes(model.placed_trees);
  return largest;
}

inline Point point_near(Random& random, const Model& model) {
  const Point special =
      model.special[static_cast<std::size_t>(whole(random, 0, static_cast<int>(model.special.size()) - 1))];
  switch (whole(random, 0, 3)) {
    case 0:
      return special;
    case 1: {
      const double near = std::ldexp(extent(model), -whole(random, 1, 52));
      return special + near * random.direction();
    }
    case 2:
      return special + extent(model) * 0.25 * whole_vector(random, -8, 8);
    default:
      return special + random.point(3 * extent(model));
  }
}

inline Ray ray_through(Random& random, const Model& model) {
  for (;;) {
    const Point eye = point_near(random, model), target = point_near(random, model);
    const Vec3 d = target - eye;
    if (d == Vec3{0}) continue;
    return {eye, coin(random) ? d : normalize(d)};
  }
}

}  // namespace scene_families
