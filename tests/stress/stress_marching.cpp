// Marches along random rays to ten fields, and judges every answer by intervals of its own, in double and
// with 113 bits; roots that have a closed form are also compared with it.
//
//   stress_marching [--tests N] [--seed S] [--threads N] [--field F] [--kind K] [--csv FILE]
//
// Marches N rays (400) of each kind to each field, or to those whose names begin with F and K. The kinds are
// rays of a camera, which go in packets too; rays that pass a point of the surface at a distance of 10^-1 to
// 10^-17; and rays that leave the surface outward or inward, in random directions or with a cosine of 10^-1
// to 10^-14. Exits with 1 if an answer was wrong, an enclosure was wider than 2^-30 of t and of the field's
// size, a packet differed from its rays, the two judges from each other, or a ray of a camera was not decided
// by the march or its judge; and prints the first wrong rays in hexadecimal. The counts do not depend on the
// number of threads (1; 0: all cores).

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <protostar/accel/packet.hpp>
#include <protostar/exact/functions.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <string>

#include "csv.hpp"
#include "marching/judge.hpp"
#include "work.hpp"

using namespace protostar;
using marching::Claim, marching::ClosedForm, marching::Judge, marching::Quad, marching::Verdict;

namespace {

enum class Kind { camera, grazing, out, out_grazing, in, in_grazing };
constexpr std::array kind_names{"camera", "grazing", "out", "out grazing", "in", "in grazing"};

bool leaves(Kind kind) { return kind >= Kind::out; }

/// Counts of the rays of one kind to one field.
class Tally {
 public:
  std::uint64_t rays = 0, hits = 0, missed = 0, not_there = 0, off = 0, wide = 0;
  std::uint64_t undecided = 0, along = 0, unknown = 0, in_closed_form = 0, disagree = 0, differ = 0;
  double widest = -2000, sum_of_widths = 0;  ///< logarithms to the base 2, of the width by max(1, t)
  double farthest = 0;                       ///< largest truth where a march was undecided

  void add(const Tally& other) {
    rays += other.rays, hits += other.hits, missed += other.missed, not_there += other.not_there;
    off += other.off, wide += other.wide, undecided += other.undecided, along += other.along;
    unknown += other.unknown, in_closed_form += other.in_closed_form, disagree += other.disagree;
    differ += other.differ, sum_of_widths += other.sum_of_widths;
    widest = std::max(widest, other.widest), farthest = std::max(farthest, other.farthest);
  }
  [[nodiscard]] std::uint64_t wrong() const { return missed + not_there + off + wide + disagree + differ; }
  /// Returns a logarithm of widths in words, or "-" without a hit.
  [[nodiscard]] std::string widest_width() const { return in_words(widest); }
  [[nodiscard]] std::string mean_width() const { return in_words(sum_of_widths / static_cast<double>(hits)); }

 private:
  [[nodiscard]] std::string in_words(double logarithm) const {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", logarithm);
    return hits > 0 ? text : "-";
  }
};

void report(const char* what, const char* field, Kind kind, const Random& random, const Claim& claim) {
  static std::mutex reporting;
  const std::lock_guard lock(reporting);
  static int reports = 0;
  if (++reports > 20) return;
  const Ray& ray = claim.ray;
  std::fprintf(stderr, "%s, %s: %s, with the seed %" PRIu64 " of its chunk, after %" PRIu64 " numbers\n",
               field, kind_names[static_cast<std::size_t>(kind)], what, random.seed(), random.drawn());
  std::fprintf(stderr, "  ray {%a, %a, %a} {%a, %a, %a}%s\n  answer %d in [%a, %a]\n", ray.origin.x,
               ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z,
               claim.leaves ? ", leaving" : "", static_cast<int>(claim.root.answer), claim.root.min,
               claim.root.max);
}

/// Source of the rays towards a field.
template <class Surface>
class Rays {
 public:
  Rays(const Surface& surface, double reach, Random& random)
      : surface_(surface), reach_(reach + 0.02), random_(random) {}

  /// Returns a ray of a kind, with the part of it that is in the ball around the field.
  Claim next(Kind kind) {
    for (;;) {
      Claim claim;
      claim.ray = from_camera();
      if (kind != Kind::camera) {
        const auto t = surface_.intersect(claim.ray);
        if (!t) continue;
        const Point point = claim.ray.at(*t);
        const Vec3 normal = surface_.normal_at(point);
        claim.ray = kind == Kind::grazing ? past(point, normal) : leaving(point, normal, kind);
        claim.leaves = leaves(kind);
      }
      const double b = dot(claim.ray.origin, claim.ray.direction),
                   c = dot(claim.ray.origin, claim.ray.origin) - reach_ * reach_, D = b * b - c;
      if (!(D > 0)) continue;
      claim.begin = std::max(0.0, -b - std::sqrt(D)), claim.end = -b + std::sqrt(D);
      if (claim.begin < claim.end) return claim;
    }
  }

 private:
  Ray from_camera() {
    const Point eye = 4.0 * random_.direction();
    return {.origin = eye, .direction = normalize(random_.real(0, reach_) * random_.direction() - eye)};
  }
  /// Returns a ray at a right angle to the normal, outside or inside of the point.
  Ray past(const Point& point, const Vec3& normal) {
    const Vec3 along = normalize(cross(normal, random_.direction()));
    const double distance = std::pow(10, random_.real(-17, -1)), side = random_.bits() % 2 == 0 ? 1 : -1;
    return {.origin = point + side * distance * normal - 4.0 * along, .direction = along};
  }
  Ray leaving(const Point& point, const Vec3& normal, Kind kind) {
    const bool is_outward = kind == Kind::out || kind == Kind::out_grazing;
    Vec3 direction = random_.direction();
    if ((dot(direction, normal) > 0) != is_outward) direction = -direction;
    if (kind == Kind::out_grazing || kind == Kind::in_grazing) {
      const double cosine = std::pow(10, random_.real(-14, -1));
      direction =
          normalize(direction - dot(direction, normal) * normal + (is_outward ? cosine : -cosine) * normal);
    }
    return {.origin = point, .direction = direction, .departure = surface_.departure()};
  }

  const Surface& surface_;
  double reach_;
  Random& random_;
};

/// Judges the answer to a ray, and adds it to the tally. Returns the name of an error, or nullptr.
template <class Truth>
const char* judge(Tally& tally, const Truth& truth, const Claim& claim, double size) {
  using Answer = MarchedRoot::Answer;
  const MarchedRoot& root = claim.root;
  const Judge<Truth> judge(truth);
  ++tally.rays;
  if (root.answer == Answer::undecided) {
    if (judge.runs_in_surface(claim)) return ++tally.along, nullptr;
    ++tally.undecided;
    tally.farthest = std::max(tally.farthest, judge.largest_at(claim, root.t()));
    return nullptr;
  }
  const bool is_hit = root.answer == Answer::hit;
  if (is_hit) {
    const double width = std::log2(std::max((root.max - root.min) / std::max(1.0, root.t()), 0x1p-100));
    ++tally.hits, tally.sum_of_widths += width, tally.widest = std::max(tally.widest, width);
  }
  const Verdict verdict = judge.verdict(claim);
  if constexpr (requires { truth.closed(claim.ray); }) {
    // The closed forms are of rays from outside that do not leave.
    const ClosedForm closed = claim.leaves ? ClosedForm{} : truth.closed(claim.ray);
    if (closed.answer != ClosedForm::Answer::unknown && verdict != Verdict::unknown &&
        verdict != Verdict::along) {
      ++tally.in_closed_form;
      const bool is_right = is_hit == (closed.answer == ClosedForm::Answer::hit) &&
                            (!is_hit || (Quad(root.min) - closed.error <= closed.t &&
                                         closed.t <= Quad(root.max) + closed.error));
      if (is_right != (verdict == Verdict::right)) return ++tally.disagree, "the closed form disagrees";
    }
  }
  switch (verdict) {
    case Verdict::missed:
      return ++tally.missed, "a missed crossing";
    case Verdict::not_there:
      return ++tally.not_there, "a crossing that is not there";
    case Verdict::off:
      return ++tally.off, "a crossing that is not the first";
    case Verdict::along:
      return ++tally.along, nullptr;
    case Verdict::unknown:
      return ++tally.unknown, nullptr;
    case Verdict::right:
      break;
  }
  if (is_hit && root.max - root.min > 0x1p-30 * std::max(root.t(), claim.leaves ? size : 0.0))
    return ++tally.wide, "a wide enclosure";
  return nullptr;
}

/// Returns the tally of so many rays of a kind, and compares camera rays with packets of them.
template <class Truth, class Surface>
Tally judged(const Truth& truth, const Surface& surface, Kind kind, Random& random, std::uint64_t rays) {
  constexpr auto lanes = static_cast<std::size_t>(simd::double_lanes);
  Rays<Surface> source(surface, Truth::reach, random);
  Tally tally;
  simd::Vectors origins(Vec3{0}), directions(Vec3{0});
  std::array<Claim, lanes> packet;
  const auto judge_one = [&](Claim& claim) {
    NoTrace trace;
    claim.root = surface.march(claim.ray, {}, trace);
    if (const char* wrong = judge(tally, truth, claim, Truth::reach))
      report(wrong, Truth::name, kind, random, claim);
  };
  for (std::uint64_t i = 0; i < rays; ++i) {
    Claim& claim = packet[i % lanes];
    claim = source.next(kind);
    judge_one(claim);
    if (kind != Kind::camera) continue;
    const auto lane = static_cast<int>(i % lanes);
    const auto& [origin, direction] = std::pair(claim.ray.origin, claim.ray.direction);
    origins.x.set(lane, origin.x), origins.y.set(lane, origin.y), origins.z.set(lane, origin.z);
    directions.x.set(lane, direction.x), directions.y.set(lane, direction.y),
        directions.z.set(lane, direction.z);
    if (i % lanes + 1 != lanes) continue;
    const simd::ClosestCrossings first =
        simd::first_crossings(surface, simd::RayPacket(origins, directions), true, Interval{});
    for (std::size_t k = 0; k < lanes; ++k) {
      const MarchedRoot& root = packet[k].root;
      const bool is_there = (bits(first.met) >> k & 1) != 0;
      if ((bits(first.in_doubt) >> k & 1) != 0) continue;  // traced alone
      if (is_there == (root.answer != MarchedRoot::Answer::miss) &&
          (!is_there || first.t[static_cast<int>(k)] == root.t()))
        continue;
      ++tally.differ;
      report("a packet differs", Truth::name, kind, random, packet[k]);
    }
  }
  return tally;
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--tests", "--seed", "--threads", "--field", "--kind", "--csv"});
  Work work(options, options.number("--tests", 400), 1);
  CsvFile csv(options.text("--csv"),
              "field,kind,rays,hits,missed,not there,off,wide,undecided,in the surface,not told,in closed "
              "form,disagree,packets differ,widest,mean width,farthest undecided");
  std::printf("%-12s%-12s%10s%10s%7s%7s%7s%7s%10s%9s%9s%10s%9s%8s%8s%8s%10s\n", "field", "kind", "rays",
              "hits", "missed", "not th.", "off", "wide", "undecided", "in surf.", "not told", "closed f.",
              "disagree", "differ", "widest", "mean", "farthest");
  std::uint64_t wrong = 0, rows = 0;
  const auto begins = [](const std::string& name, const std::string& with) {
    return name.compare(0, with.size(), with) == 0;
  };
  marching::each_field([&](const auto& truth) {
    const char* field = std::remove_cvref_t<decltype(truth)>::name;
    std::optional<Marched<std::remove_cvref_t<decltype(truth.field)>>> surface;
    for (std::size_t k = 0; k < kind_names.size(); ++k) {
      if (!begins(field, options.text("--field")) || !begins(kind_names[k], options.text("--kind"))) continue;
      if (!surface) surface.emplace(truth.field, truth.field.bounds());
      const auto tally = work.summed<Tally>(2000, [&](Random& random, std::uint64_t rays) {
        return judged(truth, *surface, static_cast<Kind>(k), random, rays);
      });
      std::printf("%-12s%-12s%10" PRIu64 "%10" PRIu64 "%7" PRIu64 "%7" PRIu64 "%7" PRIu64 "%7" PRIu64
                  "%10" PRIu64 "%9" PRIu64 "%9" PRIu64 "%10" PRIu64 "%9" PRIu64 "%8" PRIu64 "%8s%8s%10.2g\n",
                  field, kind_names[k], tally.rays, tally.hits, tally.missed, tally.not_there, tally.off,
                  tally.wide, tally.undecided, tally.along, tally.unknown, tally.in_closed_form,
                  tally.disagree, tally.differ, tally.widest_width().c_str(), tally.mean_width().c_str(),
                  tally.farthest);
      std::fflush(stdout);
      csv.row(field, kind_names[k], tally.rays, tally.hits, tally.missed, tally.not_there, tally.off,
              tally.wide, tally.undecided, tally.along, tally.unknown, tally.in_closed_form, tally.disagree,
              tally.differ, tally.widest_width(), tally.mean_width(), tally.farthest);
      wrong += tally.wrong(), ++rows;
      if (static_cast<Kind>(k) == Kind::camera) wrong += tally.undecided + tally.unknown;
    }
  });
  if (rows == 0) throw std::invalid_argument("no such field or kind");
  return wrong > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return stress(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stress_marching: %s\n", error.what());
    return 2;
  }
}
