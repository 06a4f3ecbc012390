// Checks closed meshes with rays that are aimed at their edges and vertices: none may slip through, and no
// crossing may be counted twice.
//
//   stress_mesh [--tests N] [--seed S] [--threads N] [--csv FILE]
//
// Traces N rays (60,000). Along each, which starts outside, crossings must lead in and out in turn, by the
// exact signs of d·n; crossings at exactly equal t may come in any order. If all triangles around its target
// are seen from one side, exactly one of them must be crossed. The first crossings of many rays at once must
// be equal to those of each ray. For one ray in eight, a range begins or ends just before, at or behind a
// crossing: the answers for that range must contain exactly the crossings that lie in it. From the closest
// hit of each ray, another ray leaves, which must cross the mesh in and out in turn as well, beginning inside
// if it leaves inwards. Exits with 1 if anything is wrong, and prints the ray in hexadecimal. The counts do
// not depend on the number of threads (1; 0: all cores).

#include <algorithm>
#include <atomic>
#include <cinttypes>
#include <cstdio>
#include <exception>
#include <optional>
#include <protostar/surfaces/mesh.hpp>
#include <span>
#include <vector>

#include "corpora/draws.hpp"
#include "csv.hpp"
#include "exact.hpp"
#include "oracle/equations.hpp"
#include "support/meshes.hpp"
#include "work.hpp"

using namespace protostar;
using corpora::coin, corpora::whole, corpora::whole_vector, corpora::size;

namespace {

struct Family {
  const char* name;
  MeshData (*mesh)();
  double radius;  ///< radius of a sphere around it
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

/// Mesh of a family, and the triangles around its vertices.
struct Shape {
  const char* name;
  double radius;
  MeshData mesh;
  std::vector<std::vector<int>> around;  ///< for each vertex: the triangles that have it

  explicit Shape(const Family& family)
      : name(family.name), radius(family.radius), mesh(family.mesh()), around(mesh.vertices.size()) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const std::uint32_t vertex : mesh.triangles[i]) around[vertex].push_back(static_cast<int>(i));
  }
};

/// Shape, scaled and moved.
struct Model {
  const Shape& shape;
  double scale;
  Vec3 offset;
  Mesh mesh;

  Model(const Shape& of, double by, const Vec3& to)
      : shape(of), scale(by), offset(to), mesh(meshes::moved(of.mesh, by, to), {.threads = 1}) {}
};

/// Ray, and the triangles around its target, if they are known.
struct Aimed {
  Ray ray;
  std::vector<int> at;
};

/// Returns an origin outside the sphere around the mesh.
Point origin_outside(Random& random, const Model& model) {
  const double radius = model.shape.radius;
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
  switch (whole(random, 0, 4)) {
    case 0: {  // a vertex
      const Point origin = origin_outside(random, model);
      return {{origin, p - origin}, model.shape.around[from]};
    }
    case 1: {  // a point on an edge, sometimes in the middle or nearly at its end
      const Point origin = origin_outside(random, model);
      const double s = coin(random) ? random.real(0, 1) : std::ldexp(1, -whole(random, 1, 50));
      std::vector<int> of_both;  // rounding may lead past the end of an edge
      const std::vector<int>&some = model.shape.around[from], &others = model.shape.around[to];
      std::set_union(some.begin(), some.end(), others.begin(), others.end(), std::back_inserter(of_both));
      return {{origin, p + s * (q - p) - origin}, of_both};
    }
    case 2: {  // a vertex, along an axis
      Vec3 d{0};
      d[whole(random, 0, 2)] = coin(random) ? 4 : -4;
      return {{p - model.scale * model.shape.radius * d, d}, model.shape.around[from]};
    }
    case 3: {  // along an edge
      const double far = 4 * model.scale * model.shape.radius / length(q - p);
      return {{p - std::ceil(far) * (q - p), q - p}, {}};
    }
    default: {  // a point next to a vertex
      const Point origin = origin_outside(random, model);
      const double near = std::ldexp(model.scale, -whole(random, 20, 60));
      return {{origin, p + near * random.direction() - origin}, {}};
    }
  }
}

// ---- The truth

using exact::Number;

/// Equation slope · t = height of the crossing with a triangle's plane. With the edges u = b − a and
/// v = c − a, n = u × v and w = a − o, slope = n·d and height = n·w.
///
/// Both are rounded; if their error may reach a sign, exact numbers decide it. In units of u = 2^-53 of the
/// sum of the sizes of its terms, u, v and w are wrong by 1, a component of n by 1 + 1 + 1 + 1 = 4, the slope
/// by 4 + 1 + 2 = 7 and the height by 4 + 1 + 1 + 2 = 8. The code takes 16, which covers the rounding of that
/// sum and the second order. The numbers here are 0 or from 2^-200 to 2^100: only products of slopes and
/// heights may underflow, by less than 2^-900.
class Plumb {
 public:
  Plumb(const Ray& ray, const Triangle& s) : ray_(ray), triangle_(s) {
    const Vec3 u = s.b - s.a, v = s.c - s.a, w = s.a - ray.origin, n = cross(u, v);
    const Vec3 terms{std::abs(u.y * v.z) + std::abs(u.z * v.y), std::abs(u.z * v.x) + std::abs(u.x * v.z),
                     std::abs(u.x * v.y) + std::abs(u.y * v.x)};
    slope_ = dot(n, ray.direction), slope_terms_ = dot(terms, abs(ray.direction));
    height_ = dot(n, w), height_terms_ = dot(terms, abs(w));
  }

  /// Returns the sign of the slope: 1 if the triangle is seen from behind.
  [[nodiscard]] int side() const {
    const auto sign = sign_of(slope_, 0x1p-49 * slope_terms_);
    return sign ? *sign : exactly().slope.sign();
  }

  /// Returns the sign of t − other.t. Each product is wrong by 8 + 7 + 1 of that of both sums, and the
  /// difference rounds once more: 17, for which the code takes 32.
  [[nodiscard]] int order(const Plumb& other) const {
    const auto sign =
        sign_of(height_ * other.slope_ - other.height_ * slope_,
                0x1p-48 * (height_terms_ * other.slope_terms_ + other.height_terms_ * slope_terms_));
    return (sign ? *sign : exact_order(exactly(), other.exactly())) * side() * other.side();
  }

  /// Returns the sign of t − end. The height is wrong by 8, the product by 7 + 1, and the difference rounds:
  /// 9.
  [[nodiscard]] int order(double end) const {
    const auto sign =
        sign_of(height_ - end * slope_, 0x1p-49 * (height_terms_ + std::abs(end) * slope_terms_));
    return (sign ? *sign : exact_order(exactly(), {1.0, end})) * side();
  }

 private:
  struct Exact {
    Number slope, height;
  };

  /// Returns the sign of a number that is off by less than the error, or nothing if the number may be 0.
  static std::optional<int> sign_of(double rounded, double error) {
    if (std::abs(rounded) <= error + 0x1p-900) return std::nullopt;
    return rounded > 0 ? 1 : -1;
  }

  [[nodiscard]] Exact exactly() const {
    using Vector = exact::Vector<Number>;
    const Vector a(triangle_.a);
    const Vector n = exact::cross(Vector(triangle_.b) - a, Vector(triangle_.c) - a);
    return {exact::dot(n, Vector(ray_.direction)), exact::dot(n, a - Vector(ray_.origin))};
  }

  static int exact_order(const Exact& x, const Exact& y) {
    return (x.height * y.slope - y.height * x.slope).sign();
  }

  Ray ray_;
  Triangle triangle_;
  double slope_, slope_terms_, height_, height_terms_;
};

// ---- The judgement

struct Tally {
  std::uint64_t rays = 0, crossings = 0, ranges = 0, slipped = 0, twice = 0, disordered = 0, misjudged = 0;
  std::uint64_t exact = 0;              ///< triangles that the library decided without rounding
  std::uint64_t leaving = 0, lost = 0;  ///< rays that leave a mesh, and those that do not cross it in turn

  [[nodiscard]] std::uint64_t wrong() const { return slipped + twice + disordered + misjudged + lost; }

  void add(const Tally& other) {
    rays += other.rays, crossings += other.crossings, ranges += other.ranges;
    slipped += other.slipped, twice += other.twice, disordered += other.disordered;
    misjudged += other.misjudged, exact += other.exact;
    leaving += other.leaving, lost += other.lost;
  }
};

class Judge {
 public:
  Judge(const Model& model, const Aimed& aimed) : mesh_(model.mesh), aimed_(aimed) {
    mesh_.each_crossing(aimed.ray, {}, [&](const Crossing& crossing) { crossings_.push_back(crossing); });
  }

  /// Checks that crossings lead in and out in turn.
  void judge_order(Tally& tally) const {
    ++tally.rays;
    tally.crossings += crossings_.size();
    int inside = 0;
    for (std::size_t i = 0; i < crossings_.size();) {
      const Plumb here = plumb(crossings_[i].primitive);
      if (here.side() == 0) ++tally.disordered;  // a triangle that is seen edge-on leads nowhere
      inside -= here.side();
      for (++i; i < crossings_.size(); ++i) {
        const Plumb next = plumb(crossings_[i].primitive);
        const int order = here.order(next);
        if (order > 0) ++tally.disordered;
        if (order != 0) break;
        inside -= next.side();
      }
      if (inside > 1) ++tally.twice;
      if (inside < 0) ++tally.slipped;
    }
    if (inside != 0) ++tally.slipped;
  }

  /// Checks that exactly one of the triangles around the target is crossed, if all are seen from one side.
  void judge_aim(Tally& tally) const {
    if (aimed_.at.empty()) return;
    const auto side = [&](int primitive) { return plumb(primitive).side(); };
    const int seen = side(aimed_.at[0]);
    const auto begin = aimed_.at.begin(), end = aimed_.at.end();
    if (seen == 0 || !std::all_of(begin, end, [&](int primitive) { return side(primitive) == seen; })) return;
    const auto crossed = std::count_if(crossings_.begin(), crossings_.end(), [&](const Crossing& crossing) {
      return std::find(begin, end, crossing.primitive) != end;
    });
    if (crossed == 0) ++tally.slipped;
    if (crossed > 1) ++tally.twice;
  }

  /// Checks that an answer is the first of the crossings.
  void judge_first(Tally& tally, const std::optional<Crossing>& first) const {
    if (!is_first(first, crossings_)) ++tally.misjudged;
  }

  /// Checks that the answers for a range contain exactly the crossings that lie in it, before or behind a
  /// number near a crossing, or near the target.
  void judge_range(Tally& tally, Random& random) const {
    const std::size_t some = random.bits() % (crossings_.size() + 1);
    const double end = nudged(random, some < crossings_.size() ? crossings_[some].t : 1);
    const bool is_before = coin(random);
    std::vector<Crossing> within;
    for (const Crossing& crossing : crossings_)
      if (plumb(crossing.primitive).order(end) == (is_before ? -1 : 1)) within.push_back(crossing);
    ++tally.ranges;
    const Interval range = is_before ? Interval{0, end} : Interval{end, infinity};
    std::vector<Crossing> found;
    mesh_.each_crossing(aimed_.ray, range, [&](const Crossing& crossing) { found.push_back(crossing); });
    if (!are_same(found, within) || !finds(range, within) || !finds({}, crossings_)) ++tally.misjudged;
  }

 private:
  [[nodiscard]] Plumb plumb(int primitive) const {
    return {aimed_.ray, mesh_.data().triangle(static_cast<std::size_t>(primitive))};
  }

  static double nudged(Random& random, double t) {
    switch (whole(random, 0, 3)) {
      case 0:
        return t;
      case 1:
        return std::nextafter(t, 0);
      case 2:
        return std::nextafter(t, infinity);
      default:
        const double side = coin(random) ? 1 : -1;
        return t * (1 + std::ldexp(side, -whole(random, 1, 51)));
    }
  }

  static bool is_first(const std::optional<Crossing>& first, const std::vector<Crossing>& all) {
    return first ? !all.empty() && first->primitive == all[0].primitive : all.empty();
  }
  [[nodiscard]] bool finds(const Interval& range, const std::vector<Crossing>& all) const {
    return is_first(mesh_.first_crossing(aimed_.ray, range), all) &&
           mesh_.any_hit(aimed_.ray, range) == !all.empty();
  }
  static bool are_same(const std::vector<Crossing>& some, const std::vector<Crossing>& others) {
    return std::equal(some.begin(), some.end(), others.begin(), others.end(),
                      [](const Crossing& a, const Crossing& b) { return a.primitive == b.primitive; });
  }

  const Mesh& mesh_;
  const Aimed& aimed_;
  std::vector<Crossing> crossings_;
};

/// Returns a ray that leaves a mesh at the hit of another one: in any direction, nearly along the triangle,
/// or to a point on another triangle's edge.
Ray leaving_ray(Random& random, const Mesh& mesh, const Ray& ray, const Crossing& met) {
  const Triangle left = mesh.data().triangle(static_cast<std::size_t>(met.primitive));
  const Point from = ray.at(met.t);
  Vec3 direction = random.direction();
  if (const int kind = whole(random, 0, 2); kind == 0) {
    const auto& [a, b, c] = mesh.data().triangles[random.bits() % mesh.data().triangles.size()];
    const Point p = mesh.data().vertices[a], q = mesh.data().vertices[b];
    direction = p + (coin(random) ? 0.0 : random.real(0, 1)) * (q - p) - from;
  } else if (kind == 1)
    direction = random.real(-1, 1) * (left.b - left.a) + random.real(-1, 1) * (left.c - left.a) +
                std::ldexp(length(left.b - left.a), -whole(random, 0, 70)) * direction;
  return {from, direction, mesh.departure(met.primitive)};
}

/// Checks that a ray that leaves a mesh crosses it in and out in turn, and is outside in the end. Crossings
/// at equal t, as of triangles that meet there, may be in any order.
void judge_leaving(Tally& tally, const Mesh& mesh, const Ray& ray) {
  const auto side = [&](int primitive) {
    return Plumb(ray, mesh.data().triangle(static_cast<std::size_t>(primitive))).side();
  };
  const int from = side(ray.departure.primitive);
  if (from == 0) return;  // in the triangle's plane, it leaves to neither side
  ++tally.leaving;
  std::vector<Crossing> crossings;
  mesh.each_crossing(ray, {}, [&](const Crossing& crossing) { crossings.push_back(crossing); });
  int inside = from < 0 ? 1 : 0;
  bool is_lost = false;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    is_lost |= !(crossings[i].t > 0);
    if (i > 0 && crossings[i].t > crossings[i - 1].t) is_lost |= inside != 0 && inside != 1;
    inside -= side(crossings[i].primitive);
  }
  const auto first = mesh.first_crossing(ray, {});
  is_lost |= inside != 0 || mesh.any_hit(ray, {}) == crossings.empty() ||
             (first ? crossings.empty() || first->primitive != crossings[0].primitive : !crossings.empty());
  tally.lost += is_lost;
}

void report(const Model& model, const Ray& ray) {
  static std::atomic<int> reports = 0;
  if (++reports > 20) return;
  std::fprintf(stderr, "wrong in %s, scale %a, offset {%a, %a, %a}: ray {%a, %a, %a}, {%a, %a, %a}\n",
               model.shape.name, model.scale, model.offset.x, model.offset.y, model.offset.z, ray.origin.x,
               ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z);
}

/// Returns a model at a scale of 1e-3 to 1e6, with an offset of up to 1e4 times that; powers of two and whole
/// numbers, or any.
Model placed(const Shape& shape, Random& random) {
  const bool is_whole = coin(random);
  const double scale = is_whole ? std::ldexp(1, whole(random, -10, 20)) : size(random, -10, 20);
  const int reach = coin(random) ? whole(random, 0, 10000) : 0;
  const Vec3 offset = is_whole ? whole_vector(random, -reach, reach) : random.point(reach);
  return {shape, scale, scale * offset};
}

/// Returns the tally of count rays at a model.
Tally judged(const Shape& shape, Random& random, std::uint64_t count) {
  Tally tally;
  fallbacks = {};
  const Model model = placed(shape, random);
  std::vector<Aimed> aims;
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < count; ++i) {
    aims.push_back(aim(random, model));
    rays.push_back(aims.back().ray);
  }
  std::vector<std::optional<Crossing>> firsts(rays.size());
  const auto ray = [&](std::size_t i) { return rays[i]; };
  model.mesh.first_crossings(rays.size(), ray, {},
                             [&](std::size_t i, const auto& first) { firsts[i] = first; });
  const auto compare = [&](std::size_t i, bool any_hit) {
    if (any_hit == firsts[i].has_value()) return;
    ++tally.misjudged;
    report(model, rays[i]);
  };
  model.mesh.any_hits(rays.size() / 8, ray, {}, compare);

  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Judge judge(model, aims[i]);
    const std::uint64_t before = tally.wrong();
    judge.judge_order(tally);
    judge.judge_aim(tally);
    judge.judge_first(tally, firsts[i]);
    if (whole(random, 0, 7) == 0) judge.judge_range(tally, random);
    if (tally.wrong() > before) report(model, rays[i]);
  }
  tally.exact = fallbacks.exact;

  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!firsts[i]) continue;
    const Ray leaving = leaving_ray(random, model.mesh, rays[i], *firsts[i]);
    const std::uint64_t before = tally.lost;
    judge_leaving(tally, model.mesh, leaving);
    if (tally.lost > before) report(model, leaving);
  }
  return tally;
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed", "--threads", "--csv"});
  constexpr std::uint64_t rays_of_a_model = 512;
  Work work(options, options.number("--tests", 60'000), std::size(families));
  Tally all;
  CsvFile csv(options.text("--csv"), "meshes,rays,crossings,ranges,slipped,twice,disordered,misjudged");
  std::printf("%-13s%12s%12s%12s%12s%12s%12s%12s\n", "meshes", "rays", "crossings", "ranges", "slipped",
              "twice", "disordered", "misjudged");
  for (const Family& family : families) {
    const Shape shape(family);
    const auto tally = work.summed<Tally>(
        rays_of_a_model, [&](Random& random, std::uint64_t rays) { return judged(shape, random, rays); });
    std::printf("%-13s%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64 "%12" PRIu64
                "%12" PRIu64 "\n",
                family.name, tally.rays, tally.crossings, tally.ranges, tally.slipped, tally.twice,
                tally.disordered, tally.misjudged);
    csv.row(family.name, tally.rays, tally.crossings, tally.ranges, tally.slipped, tally.twice,
            tally.disordered, tally.misjudged);
    std::fflush(stdout);
    all.add(tally);
  }
  std::printf("triangles decided without rounding %" PRIu64 "\n", all.exact);
  std::printf("rays that leave a mesh %" PRIu64 ", lost %" PRIu64 "\n", all.leaving, all.lost);
  return all.wrong() > 0 ? 1 : 0;
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
