// Checks random scenes: sequences of crossings, and the decisions of shadow segments, are judged by exact
// arithmetic.
//
//   stress_scenes [--tests N] [--seed S] [--threads N] [--csv FILE]
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

#include "corpora/draws.hpp"
#include "csv.hpp"
#include "made_of.hpp"
#include "oracle/coincide.hpp"
#include "oracle/departures.hpp"
#include "oracle/sorted_hits.hpp"
#include "oracle/surface_roots.hpp"
#include "oracle/tree_roots.hpp"
#include "scene_families.hpp"
#include "work.hpp"

using namespace protostar;
using corpora::whole;
using scene_families::Family, scene_families::Model, scene_families::families;

namespace {

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

/// Surface of the model that a ray leaves, −1 for none, and the primitive of it.
struct Leaves {
  int surface = -1;
  int primitive = 0;
};

// Without their headers, the tests of requires below would judge otherwise.
static_assert(requires(const Ray& ray, const Sphere& sphere) {
  exact::coincide(sphere, sphere);
  exact::roots(ray, sphere, exact::Left{});
});

/// Adds the crossings of a ray with a surface.
template <class S>
void add_crossings(std::vector<Hit>& hits, const Model& model, const Ray& ray, const S& surface, int id,
                   const Leaves& left, double end) {
  if constexpr (requires { exact::roots(ray, surface, exact::Left{}); } && !std::same_as<S, Quadric>) {
    // A ray that leaves another surface may leave this one's plane or sphere with it, which exact::roots
    // tests.
    add_hits(hits, ray, surface, id, exact::Left{id == left.surface ? left.primitive : -1}, end);
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

using AllSurfaces = Scene<Sphere, Plane, Parallelogram, Disk, Box, Quadric, AnySurface>;

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
      std::fprintf(stderr, " leaving %d, primitive %d\n  true:", left.surface, left.primitive);
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
    const Leaves left{surface_of(*hit), hit->primitive()};
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
  const Options options(argc, argv, {"--tests", "--seed", "--threads", "--csv"});
  constexpr std::uint64_t chunk_size = 2000;
  Work work(options, options.number("--tests", 20'000), families.size());
  Tally all;
  CsvFile csv(options.text("--csv"), "scenes,rays,hits,shadow rays,wrong rays");
  std::printf("%-17s%12s%12s%12s%12s\n", "scenes", "rays", "hits", "shadow rays", "wrong rays");
  for (const Family& family : families) {
    const auto tally = work.summed<Tally>(
        chunk_size, [&](Random& random, std::uint64_t rays) { return judged(family, random, rays); });
    std::printf("%-17s%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "\n", family.name, tally.rays,
                tally.crossings, tally.shadows, tally.wrong);
    csv.row(family.name, tally.rays, tally.crossings, tally.shadows, tally.wrong);
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
