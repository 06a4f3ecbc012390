#include <algorithm>
#include <array>
#include <protostar/integrators/binary.hpp>
#include <protostar/integrators/color.hpp>
#include <protostar/integrators/depth.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/normal.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <protostar/integrators/whitted.hpp>
#include <protostar/render.hpp>
#include <protostar/sampling/samplers.hpp>
#include <string>
#include <string_view>

#include "explained_scene.hpp"

using namespace protostar;

template void ExplainedScene::add(const SceneVector<AnySurface>&, const SceneVector<Material>&);
template void ExplainedScene::add(const SceneVector<Mesh>&, const SceneVector<Material>&);
template void ExplainedScene::add(const SceneVector<Parallelogram>&, const SceneVector<Material>&);
template void ExplainedScene::add(const SceneVector<Plane>&, const SceneVector<Material>&);
template void ExplainedScene::add(const SceneVector<Sphere>&, const SceneVector<Material>&);

RayRecord& ExplainedScene::begin(RayRecord::Query query, const Ray& ray, Interval range) const {
  const RayRecord& before = *current_;
  RayRecord& record = current_->rays.emplace_back();
  record.query = query;
  record.ray = ray;
  record.range = range;
  const std::size_t left = index_of(ray.departure.surface);
  if (left == surfaces_.size()) return record;
  record.left = left;
  // The departure of a solid that is made of solids counts the parts of one of them.
  record.left_part = before.hit && before.taken == record.left ? before.hit->part : ray.departure.primitive;
  return record;
}

const Considered& ExplainedScene::consider(RayRecord& record, std::size_t surface, bool is_first) const {
  Considered& considered = record.considered.emplace_back();
  considered.surface = surface;
  const Fallbacks before = fallbacks;
  considered.crossings = surfaces_[surface].crossings(record.ray, record.range, is_first);
  considered.decided = fallbacks.exact > before.exact ? Considered::Decided::exactly
                       : fallbacks.double_double > before.double_double
                           ? Considered::Decided::in_double_double
                           : Considered::Decided::in_double;
  considered.equation = surfaces_[surface].equation(record.ray, record.range, is_first);
  return considered;
}

std::optional<Intersection> ExplainedScene::intersect(const Ray& ray, Interval range) const {
  RayRecord& record = begin(RayRecord::Query::closest, ray, range);
  current_ = &record;
  SurfaceCrossing first;
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    if (const Considered& one = consider(record, i, true); !one.crossings.empty()) {
      const SurfaceCrossing candidate = surfaces_[i].on(one.crossings[0]);
      if (record.taken && !precedes(ray, candidate, first)) continue;
      first = candidate;
      record.taken = i;
    }
  if (!record.taken) return std::nullopt;
  record.crossing = first;
  const Intersection hit(ray, first);
  record.hit = recorded(hit, *record.taken);
  return hit;
}

HitRecord ExplainedScene::recorded(const Intersection& hit, std::size_t surface) const {
  const Normals<Vec3> outside = hit.normals(), facing = hit.facing_normals();
  HitRecord record{.t = hit.t,
                   .point = hit.point(),
                   .normal = outside.surface,
                   .facing_normal = facing.surface,
                   .part = hit.primitive(),
                   .uv = hit.uv(),
                   .color = hit.color(),
                   .material = hit.material(),
                   .primitive = surfaces_[surface].primitive(hit.primitive())};
  if (const NormalMap& map = hit.material().normal_map)
    record.mapped = {.direction = map(record.uv.x, record.uv.y),
                     .tangents = hit.tangents(),
                     .shading_normal = outside.shading,
                     .facing_shading_normal = facing.shading};
  return record;
}

bool ExplainedScene::occluded(const Ray& ray, Interval range) const {
  RayRecord& record = begin(RayRecord::Query::any, ray, range);
  for (std::size_t i = 0; i < surfaces_.size() && !record.taken; ++i)
    if (!consider(record, i, true).crossings.empty()) record.taken = i;
  return record.taken.has_value();
}

std::vector<Intersection> ExplainedScene::all_hits(const Ray& ray, Interval range) const {
  RayRecord& record = begin(RayRecord::Query::all, ray, range);
  std::vector<Intersection> hits;
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    for (const Crossing& one : consider(record, i, false).crossings) {
      hits.emplace_back(ray, surfaces_[i].on(one));
      record.all_hits.push_back(recorded(hits.back(), i));
    }
  return hits;
}

std::string name_of(const SamplerChoice& sampler) {
  for (const std::string_view name : sampler_names)
    if (sampler_named(name) == sampler) return std::string(name);
  return "own";
}

void explain_function(Explanation& explanation, const Camera& camera,
                      const std::function<Color(SampleRecord&)>& radiance, const RenderOptions& options,
                      const SamplerChoice& default_sampler) {
  const PixelGrid pixels(explanation.width, explanation.height, options, default_sampler);
  const int x = explanation.pixel.x, y = explanation.pixel.y;
  explanation.is_traced = true;
  explanation.sampler = name_of(options.sampler.is_made() ? options.sampler : default_sampler);
  explanation.seed = options.seed;
  explanation.camera = camera;
  explanation.mean = pixels.mean(x, y, [&](int i, const auto& place) {
    SampleRecord& sample = explanation.samples.emplace_back();
    sample.place = place;
    sample.sampler = pixels.sampler(x, y, i);
    sample.u = pixels.u(x, place.x);
    sample.v = pixels.v(y, place.y);
    if (camera.has_lens() && !pixels.has_only_centers()) sample.lens = pixels.lens_point(x, y, i);
    sample.ray = pixels.ray(camera, x, y, i, place);
    return sample.radiance = radiance(sample);
  });
}

template void explain(Explanation&, const Camera&, const ExplainedScene&, const BinaryIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const ColorIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const DepthIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const DiffuseIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const NormalIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const ShadowIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const TransparencyIntegrator&,
                      const RenderOptions&);
template void explain(Explanation&, const Camera&, const ExplainedScene&, const WhittedIntegrator&,
                      const RenderOptions&);
