// Closed meshes, and rays that are aimed at their edges and vertices: does one slip through, or is a crossing
// counted twice?
//
//   stress_mesh [--tests N] [--seed S]
//
// N rays (60,000). Along each, which starts outside, crossings have to lead in and out in turn, as the exact
// signs of d·n say; what is crossed at exactly equal t may come in any order. And where all triangles around
// what it is aimed at are seen from one side, exactly one of them has to be crossed. Exits with 1 if that is
// not so, and prints the ray in hexadecimal.

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <exception>
#include <protostar/surfaces/mesh.hpp>
#include <vector>

#include "corpora.hpp"
#include "options.hpp"
#include "oracle.hpp"
#include "support/meshes.hpp"

using namespace protostar;
using corpora::coin, corpora::whole, corpora::whole_vector, corpora::size;

namespace {

struct Family {
  const char* name;
  MeshData (*mesh)();
  double radius;  ///< of a sphere around it
};

const Family families[] = {
    {"box", [] { return meshes::box(1); }, 2},
    {"squares", [] { return meshes::box(4); }, 7},
    {"icosahedron", [] { return meshes::icosphere(0); }, 1},
    {"icosphere", [] { return meshes::icosphere(3); }, 1},
    {"torus", [] { return meshes::torus(40, 17); }, 1.5},
    {"needles",
     [] {
       MeshData mesh = meshes::icosphere(2);
       for (Point& p : mesh.vertices) p.x *= 0x1p-20, p.y *= 0x1p-10;
       return mesh;
     },
     1},
};

/// A mesh in its place, and what is around its edges and vertices.
struct Model {
  const Family& family;
  double scale;
  Vec3 offset;
  Mesh mesh;
  std::vector<std::vector<int>> around;  ///< of each vertex: the triangles that have it

  Model(const Family& f, double by, const Vec3& to)
      : family(f), scale(by), offset(to), mesh(meshes::moved(f.mesh(), by, to), {.threads = 1}) {
    around.resize(mesh.data().vertices.size());
    for (std::size_t i = 0; i < mesh.data().triangles.size(); ++i)
      for (const std::uint32_t vertex : mesh.data().triangles[i])
        around[vertex].push_back(static_cast<int>(i));
  }
};

/// A ray, and the triangles around what it is aimed at.
struct Aimed {
  Ray ray;
  std::vector<int> at;
};

/// An origin outside the sphere around the mesh.
Point origin_outside(Random& random, const Model& model) {
  const double radius = model.family.radius;
  for (;;) {
    const double far = size(random, 1, 8);
    const Vec3 place = coin(random) ? whole_vector(random, -10, 10) : far * random.direction();
    if (length(place) > 1.01 * radius) return model.offset + model.scale * place;
  }
}

Aimed aim(Random& random, const Model& model) {
  const auto& [vertices, triangles, normals, uvs] = model.mesh.data();
  const auto& triangle = triangles[random.bits() % triangles.size()];
  const std::size_t corner = random.bits() % 3;
  const std::uint32_t from = triangle[corner], to = triangle[(corner + 1) % 3];
  const Point p = vertices[from], q = vertices[to];
  std::vector<int> of_both;  // rounding may lead past the end of an edge
  std::ranges::set_union(model.around[from], model.around[to], std::back_inserter(of_both));
  switch (whole(random, 0, 4)) {
    case 0: {  // a vertex
      const Point origin = origin_outside(random, model);
      return {{origin, p - origin}, model.around[from]};
    }
    case 1: {  // a place on an edge, some of them in the middle or nearly at its end
      const Point origin = origin_outside(random, model);
      const double s = coin(random) ? random.real(0, 1) : std::ldexp(1, -whole(random, 1, 50));
      return {{origin, p + s * (q - p) - origin}, of_both};
    }
    case 2: {  // one that is looked at along an axis
      Vec3 d{0};
      d[whole(random, 0, 2)] = coin(random) ? 4 : -4;
      return {{p - model.scale * model.family.radius * d, d}, model.around[from]};
    }
    case 3: {  // along the edge
      const double far = 4 * model.scale * model.family.radius / length(q - p);
      return {{p - std::ceil(far) * (q - p), q - p}, {}};
    }
    default: {  // to a place next to a vertex
      const Point origin = origin_outside(random, model);
      const double near = std::ldexp(model.scale, -whole(random, 20, 60));
      return {{origin, p + near * random.direction() - origin}, {}};
    }
  }
}

// ---- The truth

using exact::Number;
using ExactVector = exact::Vector<Number>;

/// slope · t = height is where the line crosses the plane of a triangle.
struct Plumb {
  Number slope, height;

  Plumb(const Ray& ray, const Triangle& s) {
    const ExactVector a(s.a);
    const ExactVector n = exact::cross(ExactVector(s.b) - a, ExactVector(s.c) - a);
    slope = exact::dot(n, ExactVector(ray.direction));
    height = exact::dot(n, a - ExactVector(ray.origin));
  }

  /// The sign of t − other.t.
  [[nodiscard]] int order(const Plumb& other) const {
    return (height * other.slope - other.height * slope).sign() * slope.sign() * other.slope.sign();
  }
};

// ---- The judgement

struct Tally {
  std::uint64_t rays = 0, crossings = 0, slipped = 0, twice = 0, disordered = 0;

  [[nodiscard]] std::uint64_t wrong() const { return slipped + twice + disordered; }
};

void judge(Tally& tally, const Model& model, const Aimed& aimed) {
  std::vector<Crossing> crossings;
  model.mesh.each_crossing(aimed.ray, {}, [&](const Crossing& crossing) { crossings.push_back(crossing); });
  ++tally.rays;
  tally.crossings += crossings.size();
  const auto triangle = [&](int part) { return model.mesh.data().triangle(static_cast<std::size_t>(part)); };

  const auto first = model.mesh.first_crossing(aimed.ray, {});
  if (first.has_value() == crossings.empty() || (first && first->part != crossings[0].part))
    ++tally.disordered;

  int inside = 0;
  for (std::size_t i = 0; i < crossings.size();) {
    const Plumb here(aimed.ray, triangle(crossings[i].part));
    inside -= here.slope.sign();
    for (++i; i < crossings.size(); ++i) {
      const Plumb next(aimed.ray, triangle(crossings[i].part));
      const int order = here.order(next);
      if (order > 0) ++tally.disordered;
      if (order != 0) break;
      inside -= next.slope.sign();
    }
    if (inside > 1) ++tally.twice;
    if (inside < 0) ++tally.slipped;
  }
  if (inside != 0) ++tally.slipped;

  if (aimed.at.empty()) return;
  const auto side = [&](int part) { return Plumb(aimed.ray, triangle(part)).slope.sign(); };
  const int seen = side(aimed.at[0]);
  if (seen == 0 || !std::ranges::all_of(aimed.at, [&](int part) { return side(part) == seen; })) return;
  const auto crossed = std::ranges::count_if(crossings, [&](const Crossing& crossing) {
    return std::ranges::find(aimed.at, crossing.part) != aimed.at.end();
  });
  if (crossed == 0) ++tally.slipped;
  if (crossed > 1) ++tally.twice;
}

void report(const Model& model, const Ray& ray) {
  static int reports = 0;
  if (++reports > 20) return;
  std::fprintf(stderr, "wrong in %s, scale %a, offset {%a, %a, %a}: ray {%a, %a, %a}, {%a, %a, %a}\n",
               model.family.name, model.scale, model.offset.x, model.offset.y, model.offset.z, ray.origin.x,
               ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z);
}

/// Scales of 1e-3 to 1e6, and offsets of up to 1e4 times that; powers of two and whole numbers, or any.
Model placed(const Family& family, Random& random) {
  const bool is_whole = coin(random);
  const double scale = is_whole ? std::ldexp(1, whole(random, -10, 20)) : size(random, -10, 20);
  const int reach = coin(random) ? whole(random, 0, 10000) : 0;
  const Vec3 offset = is_whole ? whole_vector(random, -reach, reach) : random.point(reach);
  return {family, scale, scale * offset};
}

Tally run(const Family& family, std::uint64_t tests, std::uint64_t seed) {
  constexpr std::uint64_t rays_of_a_model = 2000;
  Random random(seed);
  Tally tally;
  while (tally.rays < tests) {
    const Model model = placed(family, random);
    for (std::uint64_t i = 0; i < rays_of_a_model && tally.rays < tests; ++i) {
      const Aimed aimed = aim(random, model);
      const std::uint64_t before = tally.wrong();
      judge(tally, model, aimed);
      if (tally.wrong() > before) report(model, aimed.ray);
    }
  }
  return tally;
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed"});
  const std::uint64_t each =
      (options.number("--tests", 60'000) + std::size(families) - 1) / std::size(families);
  Random seeds(options.number("--seed", 1));
  std::uint64_t wrong = 0;
  fallbacks = {};
  std::printf("%-13s%12s%12s%12s%12s%12s\n", "meshes", "rays", "crossings", "slipped", "twice", "disordered");
  for (const Family& family : families) {
    const Tally tally = run(family, each, seeds.bits());
    std::printf("%-13s%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "\n", family.name,
                tally.rays, tally.crossings, tally.slipped, tally.twice, tally.disordered);
    std::fflush(stdout);
    wrong += tally.wrong();
  }
  std::printf("triangles decided without rounding %" PRIu64 "\n", fallbacks.exact);
  return wrong > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return stress(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stress_mesh: %s\n", error.what());
    return 2;
  }
}
