// Random scenes: whole sequences of crossings and the decisions of shadow segments, judged by exact
// arithmetic.
//
//   stress_scenes [--tests N] [--seed S]
//
// N rays (20,000), each judged with all that follows from it: its crossings with all surfaces in their order,
// the first of them, and the rays that leave from there towards lights and onwards. Exits with 1 if the
// library was wrong about one of them, and prints that scene in hexadecimal.

#include <cinttypes>
#include <cstdio>
#include <exception>
#include <protostar/scene.hpp>
#include <protostar/surfaces/any_surface.hpp>

#include "corpora.hpp"
#include "options.hpp"
#include "oracle.hpp"

using namespace protostar;
using corpora::coin, corpora::whole, corpora::whole_vector, corpora::size;

namespace {

// ---- Scenes

/// A scene's surfaces, spheres first, then planes, and points at which something special happens.
struct Model {
  std::vector<Sphere> spheres;
  std::vector<Plane> planes;
  std::vector<Parallelogram> boards;
  std::vector<Disk> disks;
  std::vector<Box> boxes;
  std::vector<Quadric> quadrics;
  std::vector<Point> special;
};

struct Family {
  const char* name;
  Model (*next)(Random&);
};

/// One in another, around one center or not.
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

/// Spheres and planes of small whole numbers that touch in one point, from inside and outside.
Model tangent(Random& random) {
  Model model;
  const Point contact = whole_vector(random, -5, 5);
  const int times = whole(random, 0, 2);
  const Vec3 normal = corpora::turned(coin(random) ? Vec3{0, 5, 0} : Vec3{3, 4, 0}, times);
  for (int i = whole(random, 2, 4); i > 0; --i) {
    const int side = whole(random, 1, 6) * (coin(random) ? 1 : -1);
    model.spheres.push_back({contact + static_cast<double>(side) * normal, 5.0 * side});
  }
  if (coin(random)) model.planes.push_back({normal, dot(normal, contact)});
  model.special.push_back(contact);
  return model;
}

/// The same sphere twice, turned inside out; planes whose equations are multiples of each other, and such
/// that are all but that.
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
    const double factor = whole(random, 1, 5) * (coin(random) ? 1 : -1);
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

/// Boards that lie in one plane and overlap, the plane itself, and others that stand on it or cross it.
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

/// Boxes of small whole numbers that stand on a floor, side by side and on each other, disks that lie on what
/// is there, and quadrics that touch it.
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
    // An ellipsoid, a cylinder or a hyperboloid with its middle above a vertex, one unit above the floor.
    const Point middle = top.max + up / up[axis];
    Vec3 squares{4};
    squares[axis] = whole(random, 0, 2) * 4 - 4;
    model.quadrics.push_back(
        {{.squares = squares, .linear = -squares * middle, .constant = dot(squares * middle, middle) - 4}});
  }
  return model;
}

/// The same, scaled and moved.
Model transformed(const Model& model, double scale, const Vec3& offset) {
  Model result;
  for (const Sphere& s : model.spheres)
    result.spheres.push_back({scale * s.center + offset, scale * s.radius});
  for (const Plane& p : model.planes)
    result.planes.push_back({p.normal, scale * p.distance + dot(p.normal, offset)});
  for (const Parallelogram& p : model.boards)
    result.boards.push_back({scale * p.position + offset, scale * p.edge_u, scale * p.edge_v});
  for (const Disk& s : model.disks)
    result.disks.push_back({scale * s.position + offset, s.normal, scale * s.radius});
  for (const Box& s : model.boxes) result.boxes.push_back({scale * s.min + offset, scale * s.max + offset});
  for (const Quadric& s : model.quadrics)
    result.quadrics.push_back({{.squares = s.form.squares,
                                .products = s.form.products,
                                .linear = scale * s.form.linear,
                                .constant = scale * scale * s.form.constant}});
  for (const Point& p : model.special) result.special.push_back(scale * p + offset);
  return result;
}

/// Scales of 1e-4 to 1e6, and offsets of up to 1e4 times that; powers of two and whole numbers, which keep
/// what touches and coincides, or any.
Model transformed(const Model& model, Random& random) {
  const int choice = whole(random, 0, 2);
  if (choice == 0) return model;
  if (!model.quadrics.empty()) return transformed(model, std::ldexp(1, whole(random, -13, 20)), Vec3{0});
  const double scale = choice == 1 ? std::ldexp(1, whole(random, -13, 20)) : size(random, -13, 20);
  const int reach = whole(random, 0, 10000);
  const Vec3 offset = choice == 1 ? whole_vector(random, -reach, reach) : random.point(reach);
  return transformed(model, scale, scale * offset);
}

const std::vector<Family> families{{"nested", nested},         {"tangent", tangent},
                                   {"coincident", coincident}, {"overlapping", overlapping},
                                   {"boards", boards},         {"solids", solids}};

/// How large a scene is, for the places of eyes and lights.
double extent(const Model& model) {
  double largest = 1e-9;
  for (const Sphere& s : model.spheres) largest = std::max(largest, std::abs(s.radius));
  for (const Parallelogram& s : model.boards) largest = std::max(largest, length(s.edge_u));
  for (const Box& s : model.boxes) largest = std::max(largest, length(s.max - s.min));
  return largest;
}

Point point_near(Random& random, const Model& model) {
  const Point special =
      model.special[static_cast<std::size_t>(whole(random, 0, static_cast<int>(model.special.size()) - 1))];
  switch (whole(random, 0, 3)) {
    case 0:
      return special;
    case 1:
      return special + std::ldexp(extent(model), -whole(random, 1, 52)) * random.direction();
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

template <class Visit>
void each_surface(const Model& model, const Visit& visit) {
  int id = 0;
  for (const Sphere& s : model.spheres) visit(s, id++);
  for (const Plane& s : model.planes) visit(s, id++);
  for (const Parallelogram& s : model.boards) visit(s, id++);
  for (const Disk& s : model.disks) visit(s, id++);
  for (const Box& s : model.boxes) visit(s, id++);
  for (const Quadric& s : model.quadrics) visit(s, id++);
}

/// Whether two of the model's surfaces are left together: the same points, or in one plane.
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

/// The crossings with 0 < t < end, in their order; of a ray that leaves a surface, if left is not -1.
std::vector<Hit> crossings(const Model& model, const Ray& ray, int left, double end) {
  std::vector<Hit> hits;
  each_surface(model, [&](const auto& surface, int id) {
    const bool is_itself = std::same_as<std::remove_cvref_t<decltype(surface)>, Quadric> && id == left;
    const bool leaves =
        left >= 0 && (is_itself || coincide(model, id, left) || exact::is_left_with(ray, surface));
    add_hits(hits, ray, surface, id, leaves, end);
  });
  sort(hits);
  return hits;
}

// ---- The library

/// The surface's number, which is its color.
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

void report(const char* family, const char* what, const Model& model, const Ray& ray, int left,
            const std::vector<Hit>& expected, const std::vector<Intersection>& found) {
  static int reports = 0;
  if (++reports > 20) return;
  std::fprintf(stderr, "wrong in %s: %s\n", family, what);
  for (const Sphere& s : model.spheres) print("sphere", s.center), std::fprintf(stderr, " %a\n", s.radius);
  for (const Plane& s : model.planes) print("plane", s.normal), std::fprintf(stderr, " %a\n", s.distance);
  for (const Parallelogram& s : model.boards)
    print("board", s.position), print("", s.edge_u), print("", s.edge_v), std::fprintf(stderr, "\n");
  for (const Disk& s : model.disks)
    print("disk", s.position), print("", s.normal), std::fprintf(stderr, " %a\n", s.radius);
  for (const Box& s : model.boxes) print("box", s.min), print("", s.max), std::fprintf(stderr, "\n");
  for (const Quadric& s : model.quadrics)
    print("quadric", s.form.squares), print("", s.form.products), print("", s.form.linear),
        std::fprintf(stderr, " %a\n", s.form.constant);
  print("ray", ray.origin), print("", ray.direction), std::fprintf(stderr, " leaving %d\n  true:", left);
  for (const Hit& hit : expected)
    std::fprintf(stderr, " %d at %a", hit.surface, static_cast<double>(hit.root.t));
  std::fprintf(stderr, "\n  found:");
  for (const Intersection& hit : found) std::fprintf(stderr, " %d at %a", surface_of(hit), hit.t);
  std::fprintf(stderr, "\n");
}

/// Whether the library crosses the scene as it should; left is the surface that the ray leaves, or -1.
template <class S>
bool is_right(const char* family, const Model& model, const S& scene, const Ray& ray, int left) {
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

/// Whether a shadow segment, from t = 0 to 1, is decided as it should.
template <class S>
bool is_shadow_right(const char* family, const Model& model, const S& scene, const Ray& ray, int left) {
  const std::vector<Hit> expected = crossings(model, ray, left, 1);
  if (scene.occluded(ray, Interval{0, 1}) == !expected.empty()) return true;
  report(family, "a shadow", model, ray, left, expected, {});
  return false;
}

struct Tally {
  std::uint64_t rays = 0, crossings = 0, shadows = 0, wrong = 0;
};

/// A ray and all that follows from it.
template <class S>
void judge(Tally& tally, const char* family, const Model& model, const S& scene, Random& random) {
  const Ray ray = ray_through(random, model);
  ++tally.rays;
  bool right = is_right(family, model, scene, ray, -1);
  if (const auto hit = scene.intersect(ray)) {
    const int left = surface_of(*hit);
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

Tally run(const Family& family, std::uint64_t tests, std::uint64_t seed) {
  constexpr int rays_of_a_scene = 20;
  Random random(seed);
  Tally tally;
  while (tally.rays < tests) {
    const Model plain = family.next(random);
    const Model model = transformed(plain, random);
    if (whole(random, 0, 7) == 0) {
      const auto scene = scene_of<Scene<AnySurface>>(model);
      for (int i = 0; i < rays_of_a_scene; ++i) judge(tally, family.name, model, scene, random);
    } else {
      const auto scene = scene_of<Scene<Sphere, Plane, Parallelogram, Disk, Box, Quadric>>(model);
      for (int i = 0; i < rays_of_a_scene; ++i) judge(tally, family.name, model, scene, random);
    }
  }
  return tally;
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed"});
  const std::uint64_t each = (options.number("--tests", 20'000) + families.size() - 1) / families.size();
  Random seeds(options.number("--seed", 1));
  std::uint64_t wrong = 0;
  fallbacks = {};
  std::printf("%-13s%12s%12s%12s%12s\n", "scenes", "rays", "hits", "shadow rays", "wrong rays");
  for (const Family& family : families) {
    const Tally tally = run(family, each, seeds.bits());
    std::printf("%-13s%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "\n", family.name, tally.rays,
                tally.crossings, tally.shadows, tally.wrong);
    std::fflush(stdout);
    wrong += tally.wrong;
  }
  std::printf("roots worked out in double-double %" PRIu64 ", exactly %" PRIu64 "\n", fallbacks.double_double,
              fallbacks.exact);
  return wrong > 0 ? 1 : 0;
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
