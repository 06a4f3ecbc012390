// Checks random scenes: sequences of crossings, and the decisions of shadow segments, are judged by exact
// arithmetic.
//
//   stress_scenes [--tests N] [--seed S] [--threads N]
//
// Traces N rays (20,000), each judged with all that follows from it: its crossings with all surfaces in their
// order, the closest hit, and the rays that leave from there towards lights and onwards. Instances are judged
// by their exact images. Exits with 1 if the library was wrong about one of them, and prints that scene in
// hexadecimal. The counts do not depend on the number of threads (1; 0: all cores).

#include <cinttypes>
#include <cstdio>
#include <exception>
#include <mutex>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <tuple>

#include "corpora/boxes.hpp"
#include "corpora/draws.hpp"
#include "corpora/instances.hpp"
#include "corpora/solids.hpp"
#include "made_of.hpp"
#include "oracle/coincide.hpp"
#include "oracle/departures.hpp"
#include "oracle/sorted_hits.hpp"
#include "oracle/surface_roots.hpp"
#include "oracle/tree_roots.hpp"
#include "work.hpp"

using namespace protostar;
using corpora::coin, corpora::whole, corpora::whole_vector, corpora::size;

namespace {

// ---- Scenes

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
auto surfaces_of(auto& model) {
  return std::tie(model.spheres, model.planes, model.boards, model.disks, model.boxes, model.quadrics,
                  model.trees, model.placed_spheres, model.placed_boxes, model.placed_trees);
}
using AllSurfaces = Scene<Sphere, Plane, Parallelogram, Disk, Box, Quadric, AnySurface>;

struct Family {
  const char* name;
  Model (*next)(Random&);
};

/// Returns spheres in each other, around one center or not.
Model nested(Random& random) {
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
Model tangent(Random& random) {
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
Model coincident(Random& random) {
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

Model overlapping(Random& random) {
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
Model boards(Random& random) {
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
Model solids(Random& random) {
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

Sphere whole_ball(Random& random) {
  const Point center = whole_vector(random, -2, 2);
  return {center, static_cast<double>(whole(random, 1, 3))};
}
Box whole_box(Random& random) {
  const Point one = whole_vector(random, -2, 2), other = whole_vector(random, -2, 2);
  return corpora::box_around(one, other);
}
Made whole_tree(Random& random) {
  const int count = whole(random, 2, 4);
  return Made(corpora::tree_of(
      random,
      [](Random& r) { return coin(r) ? SolidTree::Solid(whole_ball(r)) : SolidTree::Solid(whole_box(r)); },
      count));
}

/// Calls visit(point) for points of a surface at which others of whole numbers may touch it.
void each_special(const Sphere& s, const auto& visit) {
  visit(s.center), visit(s.center + Vec3{0, s.radius, 0});
}
void each_special(const Box& s, const auto& visit) { visit(s.min), visit(s.max); }
void each_special(const Quadric&, const auto&) {}
template <class S>
void each_special(const Placed<S>& s, const auto& visit) {
  each_special(s.own, [&](const Point& point) { visit(s.placement.point(point)); });
}
void each_special(const Made& s, const auto& visit) {
  s.tree.each_solid([&](const SolidTree::Solid& held) {
    std::visit([&](const auto& solid) { each_special(solid, visit); }, held);
  });
}
void each_special(const Placed<Made>& s, const auto& visit) {
  each_special(s.own, [&](const Point& point) { visit(s.placement.point(point)); });
}

/// Adds a surface with its special points.
template <class S>
void add(Model& model, std::vector<S>& surfaces, const S& surface) {
  surfaces.push_back(surface);
  each_special(surface, [&](const Point& point) { model.special.push_back(point); });
}

/// Adds surfaces that whole solids may touch, or have a face in common with.
void add_neighbors(Random& random, Model& model) {
  Vec3 up{0};
  up[whole(random, 0, 2)] = coin(random) ? 1 : -2;
  if (coin(random)) model.planes.push_back({up, static_cast<double>(whole(random, -2, 2))});
  if (coin(random)) add(model, model.spheres, whole_ball(random));
  if (coin(random)) add(model, model.boxes, whole_box(random));
}

/// Returns solids made of balls and boxes of small whole numbers.
Model trees(Random& random) {
  Model model;
  for (int i = whole(random, 1, 2); i > 0; --i) add(model, model.trees, whole_tree(random));
  add_neighbors(random, model);
  return model;
}

/// Returns images of balls, boxes and solids of whole numbers, by maps of small whole numbers and powers of
/// two.
Model instances(Random& random) {
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
Model trees_of_instances(Random& random) {
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
Sphere moved(const Sphere& s, double scale, const Vec3& offset) {
  return {scale * s.center + offset, scale * s.radius};
}
Plane moved(const Plane& s, double scale, const Vec3& offset) {
  return {s.normal, scale * s.distance + dot(s.normal, offset)};
}
Parallelogram moved(const Parallelogram& s, double scale, const Vec3& offset) {
  return {scale * s.position + offset, scale * s.edge_u, scale * s.edge_v};
}
Disk moved(const Disk& s, double scale, const Vec3& offset) {
  return {scale * s.position + offset, s.normal, scale * s.radius};
}
Box moved(const Box& s, double scale, const Vec3& offset) {
  return {scale * s.min + offset, scale * s.max + offset};
}
/// Returns a quadric, scaled; its offset must be 0.
Quadric moved(const Quadric& s, double scale, const Vec3&) {
  return {{.squares = s.form.squares,
           .products = s.form.products,
           .linear = scale * s.form.linear,
           .constant = scale * scale * s.form.constant}};
}
template <class S>
Placed<S> moved(const Placed<S>& s, double scale, const Vec3& offset) {
  return Placed(s.own, s.placement.scaled_by(Vec3(scale)).moved_by(offset));
}
SolidTree moved(SolidTree tree, double scale, const Vec3& offset) {
  std::visit([&](auto& solid) { solid = moved(solid, scale, offset); }, tree.solid);
  for (SolidTree& operand : tree.operands) operand = moved(std::move(operand), scale, offset);
  return tree;
}
Made moved(const Made& s, double scale, const Vec3& offset) { return Made(moved(s.tree, scale, offset)); }
Model moved(Model model, double scale, const Vec3& offset) {
  const auto move_all = [&](auto& surfaces) {
    for (auto& surface : surfaces) surface = moved(surface, scale, offset);
  };
  std::apply([&](auto&... lists) { (move_all(lists), ...); }, surfaces_of(model));
  for (Point& p : model.special) p = scale * p + offset;
  return model;
}

/// Returns a model at a scale of 1e-4 to 1e6, with an offset of up to 1e4 times that: powers of two and whole
/// numbers, which keep contacts and coincidences, or any numbers.
Model transformed(const Model& model, Random& random) {
  const int choice = whole(random, 0, 2);
  if (choice == 0) return model;
  if (!model.quadrics.empty()) return moved(model, std::ldexp(1, whole(random, -13, 20)), Vec3{0});
  const double scale = choice == 1 ? std::ldexp(1, whole(random, -13, 20)) : size(random, -13, 20);
  const int reach = whole(random, 0, 10000);
  const Vec3 offset = choice == 1 ? whole_vector(random, -reach, reach) : random.point(reach);
  return moved(model, scale, scale * offset);
}

const std::vector<Family> families{
    {"nested", nested},           {"tangent", tangent},     {"coincident", coincident},
    {"overlapping", overlapping}, {"boards", boards},       {"solids", solids},
    {"solids of solids", trees},  {"instances", instances}, {"made of instances", trees_of_instances}};

/// Returns the size of a scene, for the positions of eyes and lights.
double extent(const Model& model) {
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

Point point_near(Random& random, const Model& model) {
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

Ray ray_through(Random& random, const Model& model) {
  for (;;) {
    const Point eye = point_near(random, model), target = point_near(random, model);
    const Vec3 d = target - eye;
    if (d == Vec3{0}) continue;
    return {eye, coin(random) ? d : normalize(d)};
  }
}

// ---- The truth

using exact::Hit;

void each_surface(const Model& model, const auto& visit) {
  int id = 0;
  const auto visit_all = [&](const auto& surfaces) {
    for (const auto& surface : surfaces) visit(surface, id++);
  };
  std::apply([&](const auto&... lists) { (visit_all(lists), ...); }, surfaces_of(model));
}

/// Returns true if two of the model's surfaces are left together: they are the same points, or in one plane.
bool coincide(const Model& model, int a, int b) {
  bool found = false;
  each_surface(model, [&](const auto& s, int i) {
    each_surface(model, [&](const auto& t, int k) {
      if constexpr (requires { exact::coincide(s, t); })
        if ((i == a && k == b) || (i == b && k == a)) found = exact::coincide(s, t);
    });
  });
  return found;
}

/// Surface of the model that a ray leaves, −1 for none, and the part of it.
struct Leaves {
  int surface = -1;
  int part = 0;
};

/// Adds the crossings of a ray with a surface.
template <class S>
void add_crossings(std::vector<Hit>& hits, const Model& model, const Ray& ray, const S& surface, int id,
                   const Leaves& left, double end) {
  if constexpr (requires { exact::roots(ray, surface, exact::Left{}); } && !std::same_as<S, Quadric>) {
    // A ray that leaves another surface may leave this one's plane or sphere with it, which exact::roots
    // tests.
    add_hits(hits, ray, surface, id, exact::Left{id == left.surface ? left.part : -1}, end);
  } else {
    const bool leaves =
        left.surface >= 0 && (id == left.surface || exact::is_left_with(ray, surface) ||
                              (!std::same_as<S, Quadric> && coincide(model, id, left.surface)));
    add_hits(hits, ray, surface, id, leaves, end);
  }
}

/// Returns the crossings with 0 < t < end, in order of t, for a ray that leaves left.
std::vector<Hit> crossings(const Model& model, const Ray& ray, const Leaves& left, double end) {
  std::vector<Hit> hits;
  each_surface(model,
               [&](const auto& surface, int id) { add_crossings(hits, model, ray, surface, id, left, end); });
  sort(hits);
  return hits;
}

// ---- The library

/// Returns the number of a surface, which is its color.
int surface_of(const Intersection& hit) { return static_cast<int>(hit.color().r); }

template <class S>
S scene_of(const Model& model) {
  S scene;
  each_surface(model,
               [&](const auto& surface, int id) { scene.add(surface, Color{static_cast<float>(id)}); });
  return scene;
}

void print(const char* name, const Vec3& v) {
  std::fprintf(stderr, "  %s {%a, %a, %a}", name, v.x, v.y, v.z);
}
void print(const Sphere& s) { print("sphere", s.center), std::fprintf(stderr, " %a", s.radius); }
void print(const Plane& s) { print("plane", s.normal), std::fprintf(stderr, " %a", s.distance); }
void print(const Parallelogram& s) { print("board", s.position), print("", s.edge_u), print("", s.edge_v); }
void print(const Disk& s) {
  print("disk", s.position), print("", s.normal), std::fprintf(stderr, " %a", s.radius);
}
void print(const Box& s) { print("box", s.min), print("", s.max); }
void print(const Quadric& s) {
  print("quadric", s.form.squares), print("", s.form.products), print("", s.form.linear);
  std::fprintf(stderr, " %a", s.form.constant);
}
void print_map(const Affine& map) {
  print("mapped by", map.x), print("", map.y), print("", map.z), print("", map.translation);
}
template <class S>
void print(const Placed<S>& s) {
  print(s.own), print_map(s.placement);
}
void print(const SolidTree& tree) {
  static constexpr const char* names[] = {"", "union", "intersection", "difference"};
  if (tree.operands.empty()) return std::visit([](const auto& solid) { print(solid); }, tree.solid);
  std::fprintf(stderr, "  %s of (", names[static_cast<int>(tree.operation)]);
  for (const SolidTree& operand : tree.operands) print(operand);
  std::fprintf(stderr, ")");
}
void print(const Made& s) { print(s.tree); }
void print(const Placed<Made>& s) { print(s.own), print_map(s.placement); }

void report(const char* family, const char* what, const Model& model, const Ray& ray, const Leaves& left,
            const std::vector<Hit>& expected, const std::vector<Intersection>& found) {
  static std::mutex reporting;
  const std::lock_guard lock(reporting);
  static int reports = 0;
  if (++reports > 20) return;
  std::fprintf(stderr, "wrong in %s: %s\n", family, what);
  each_surface(model, [](const auto& surface, int) { print(surface), std::fprintf(stderr, "\n"); });
  print("ray", ray.origin), print("", ray.direction),
      std::fprintf(stderr, " leaving %d, part %d\n  true:", left.surface, left.part);
  for (const Hit& hit : expected)
    std::fprintf(stderr, " %d at %a", hit.surface, static_cast<double>(hit.root.t));
  std::fprintf(stderr, "\n  found:");
  for (const Intersection& hit : found) std::fprintf(stderr, " %d at %a", surface_of(hit), hit.t);
  std::fprintf(stderr, "\n");
}

/// Returns true if the library's crossings of a ray that leaves left, and its closest hit, are right.
template <class S>
bool is_right(const char* family, const Model& model, const S& scene, const Ray& ray, const Leaves& left) {
  const std::vector<Hit> expected = crossings(model, ray, left, infinity);
  std::vector<Intersection> found;
  scene.crossings(ray, Interval{}, [&](const Intersection& hit) { found.push_back(hit); });
  std::stable_sort(found.begin(), found.end());
  const bool same =
      std::equal(found.begin(), found.end(), expected.begin(), expected.end(),
                 [](const Intersection& a, const Hit& b) { return surface_of(a) == b.surface; });
  const auto first = scene.intersect(ray);
  const bool same_first =
      first.has_value() == !expected.empty() && (!first || surface_of(*first) == expected.front().surface);
  if (!same || !same_first)
    report(family, same ? "the first" : "the crossings", model, ray, left, expected, found);
  return same && same_first;
}

/// Returns true if a shadow segment, from t = 0 to 1, is decided right.
template <class S>
bool is_shadow_right(const char* family, const Model& model, const S& scene, const Ray& ray,
                     const Leaves& left) {
  const std::vector<Hit> expected = crossings(model, ray, left, 1);
  if (scene.occluded(ray, Interval{0, 1}) == !expected.empty()) return true;
  report(family, "a shadow", model, ray, left, expected, {});
  return false;
}

struct Tally {
  std::uint64_t rays = 0, crossings = 0, shadows = 0, wrong = 0;
  Fallbacks fallbacks;

  void add(const Tally& other) {
    rays += other.rays, crossings += other.crossings, shadows += other.shadows, wrong += other.wrong;
    fallbacks.exact += other.fallbacks.exact;
  }
};

/// Judges a ray and all that follows from it.
template <class S>
void judge(Tally& tally, const char* family, const Model& model, const S& scene, Random& random) {
  const Ray ray = ray_through(random, model);
  ++tally.rays;
  bool right = is_right(family, model, scene, ray, {});
  if (const auto hit = scene.intersect(ray)) {
    const Leaves left{surface_of(*hit), hit->part()};
    right = is_right(family, model, scene, hit->leave(ray.direction), left) && right;
    ++tally.crossings;
    for (int light = 0; light < 2; ++light) {
      const Ray shadow_ray = hit->leave(point_near(random, model) - hit->point());
      if (shadow_ray.direction == Vec3{0}) continue;
      right = is_shadow_right(family, model, scene, shadow_ray, left) && right;
      ++tally.shadows;
    }
  }
  if (!right) ++tally.wrong;
}

/// Returns the tally of the given number of rays, a few in each scene.
Tally judged(const Family& family, Random& random, std::uint64_t rays) {
  constexpr std::uint64_t rays_of_a_scene = 20;
  Tally tally;
  fallbacks = {};
  while (tally.rays < rays) {
    const std::uint64_t until = std::min(rays, tally.rays + rays_of_a_scene);
    const Model plain = family.next(random);
    const Model model = transformed(plain, random);
    const auto judge_all = [&](const auto& scene) {
      while (tally.rays < until) judge(tally, family.name, model, scene, random);
    };
    if (whole(random, 0, 7) == 0)
      judge_all(scene_of<Scene<AnySurface>>(model));
    else
      judge_all(scene_of<AllSurfaces>(model));
  }
  tally.fallbacks = fallbacks;
  return tally;
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed", "--threads"});
  constexpr std::uint64_t chunk_size = 2000;
  Work work(options, options.number("--tests", 20'000), families.size());
  Tally all;
  std::printf("%-17s%12s%12s%12s%12s\n", "scenes", "rays", "hits", "shadow rays", "wrong rays");
  for (const Family& family : families) {
    const auto tally = work.summed<Tally>(
        chunk_size, [&](Random& random, std::uint64_t rays) { return judged(family, random, rays); });
    std::printf("%-17s%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "\n", family.name, tally.rays,
                tally.crossings, tally.shadows, tally.wrong);
    std::fflush(stdout);
    all.add(tally);
  }
  std::printf("answered without rounding %" PRIu64 "\n", all.fallbacks.exact);
  return all.wrong > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return stress(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stress_scenes: %s\n", error.what());
    return 2;
  }
}
