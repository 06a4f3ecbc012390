// Records why a pixel has its color: the rays that an integrator traces for it, and what each of them meets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <protostar/bounds.hpp>
#include <protostar/camera.hpp>
#include <protostar/intersection.hpp>
#include <protostar/light.hpp>
#include <protostar/pixel_grid.hpp>
#include <string>
#include <utility>
#include <vector>

#include "options.hpp"

/// Numbers with a name, such as the radius of a sphere.
struct Named {
  std::string name;
  std::vector<double> values;
};

/// Numbers of a surface, or of the equation of a surface and a ray, and those of its parts, such as the
/// solids of a solid made of solids.
struct Facts {
  std::string type;
  std::vector<Named> numbers = {};
  std::vector<Facts> parts = {};
  std::string file = {};  ///< path of the file of an image; empty if unknown
};

/// Surface that a ray is tested with, and the result.
struct Considered {
  /// Arithmetic that decides where the ray crosses the surface.
  enum class Decided : std::uint8_t { in_double, in_double_double, exactly };

  std::size_t surface = 0;
  std::vector<protostar::Crossing> crossings;  ///< in the range; the first alone, unless all are asked for
  Decided decided = Decided::in_double;
  Facts equation;
};

/// Light that an integrator takes from the sky, or from the environment at u and v.
struct SkyRecord {
  std::optional<protostar::Color> radiance;  ///< empty if the scene has none, and the integrator its own
  std::optional<protostar::Uv> uv = {};      ///< empty for a sky of one color
  Facts look_up = {};                        ///< how the environment follows from u and v
};

/// One light at a hit.
struct LightRecord {
  protostar::Vec3 towards{0};  ///< vector from the hit to the light
  double cosine = 0;           ///< of the angle between that vector and the normal
  protostar::Color facing{0};  ///< irradiance of a surface that faces the light
  protostar::Color irradiance{0};
  std::optional<protostar::Color> share = {};  ///< of the radiance, if nothing occludes the light
  std::optional<std::size_t> shadow_ray = {};  ///< index among the rays; empty if none was needed
};

/// Surface that is a light of any size, to which directions are drawn.
struct AreaLightRecord {
  std::size_t surface = 0;
  protostar::Color emission{0};
};

/// Normal that a normal map gives to a hit, and the numbers that it follows from.
struct MappedNormal {
  protostar::Vec3 direction{0};  ///< that the map holds at u and v, in tangent space
  protostar::Tangents tangents;  ///< of the surface
  protostar::Vec3 shading_normal{0}, facing_shading_normal{0};
};

/// Hit, in numbers.
struct HitRecord {
  double t = 0;
  protostar::Point point{0};
  protostar::Vec3 normal{0}, facing_normal{0};  ///< the surface's own
  int part = 0;
  protostar::Uv uv{0};
  protostar::Color color{0};
  protostar::Material material = {};
  Facts primitive = {};                     ///< triangle of a mesh
  std::optional<MappedNormal> mapped = {};  ///< empty if the material has no normal map
  std::vector<LightRecord> lights = {};
};

/// Ray, the surfaces that it is tested with, and all that follows from it.
struct RayRecord {
  enum class Query : std::uint8_t { closest, any, all };

  Query query = Query::closest;
  protostar::Ray ray = {};
  protostar::Interval range = {};
  std::optional<std::size_t> left = {};  ///< surface that the ray leaves
  int left_part = 0;                     ///< part of that surface, as the surface counts them
  std::vector<Considered> considered = {};
  std::optional<std::size_t> taken = {};  ///< index in considered of the closest hit, or of the occluder
  std::optional<HitRecord> hit = {};      ///< closest hit
  std::vector<HitRecord> all_hits = {};   ///< in the order of considered, if all are asked for
  bool asks_lights = false;               ///< true if the integrator adds up the lights at the hit
  std::vector<SkyRecord> sky = {};
  std::list<RayRecord> rays = {};  ///< rays that the integrator traces while it shades the hit
  std::optional<protostar::Color> radiance = {};

  /// Closest hit in the scene, while that lives.
  std::optional<protostar::SurfaceCrossing> crossing = {};
};

/// Ray of the camera through a sample of the pixel.
struct SampleRecord {
  protostar::FilteredPlace<double> place{};  ///< in the pixel, and the weight of the light
  protostar::PixelSampler sampler{{}, {}};   ///< gives the numbers of the sample
  double u = 0, v = 0;                       ///< film coordinates
  std::optional<protostar::Uv> lens = {};    ///< point of the lens in the unit disk, if there is one
  protostar::Ray ray;

  /// Sets of numbers that the integrator takes, each once, in the order in which it first asks for them.
  std::vector<std::pair<std::uint32_t, protostar::SampleSet<double>>> sets = {};
  RayRecord all = {};  ///< no ray itself; all.rays are the rays that the integrator traces first
  protostar::Color radiance{0};

  // Steps that a function of the ray tells: in words, and in numbers.
  std::vector<std::string> told = {};
  std::vector<Facts> steps = {};
};

/// Explanation of a pixel: what the scene contains, and each sample.
struct Explanation {
  Pixel pixel;
  bool is_traced = false;    ///< true if rays of a camera gave the color
  bool is_recorded = false;  ///< true if they were traced in a scene that records them
  int width = 0, height = 0;
  protostar::Camera camera;
  int depth = 0;        ///< of WhittedIntegrator and PathIntegrator, otherwise 0
  int most_rays = 0;    ///< of DirectIntegrator and PathIntegrator, otherwise 0
  double distance = 0;  ///< of AmbientOcclusionIntegrator, otherwise 0
  std::vector<AreaLightRecord> area_lights = {};
  bool environment_has_places = false;  ///< true if directions are drawn to the environment
  std::vector<Facts> surfaces = {};
  std::vector<protostar::Bounds> bounds = {};  ///< of the surfaces; infinite where there are none
  std::vector<protostar::Light> lights = {};
  protostar::Color ambient{0};
  std::string sampler;  ///< name; "own" for a type that is not the library's
  std::uint64_t seed = 0;
  std::vector<SampleRecord> samples = {};
  protostar::Color mean{0};  ///< of the samples' radiances

  // Set at the end, from the picture.
  protostar::Color light{0};  ///< mean times exposure
  float largest = 0;          ///< largest channel of the picture, if the tone asks for it
  protostar::Color toned{0};
  std::array<std::uint16_t, 3> codes{};

  /// Returns true if rays have times, which are told with the shutter: they may differ, differ from 0, or
  /// move the camera.
  [[nodiscard]] bool has_times() const {
    return camera.shutter.is_open() || camera.shutter.opens != 0 || camera.is_moving();
  }
};

/// Returns the name of a sampler; "own" for a type that is not the library's.
std::string name_of(const protostar::SamplerChoice& sampler);

/// Returns the explanation as a tree in words.
std::string text_of(const Explanation& explanation, const Options& options);

/// Returns the explanation as JSON, complete: docs/check_explanation evaluates it again.
std::string json_of(const Explanation& explanation, const Options& options);

/// Returns a drawing of the rays: as SVG, from above and from the side; otherwise as OBJ, with a line for
/// each ray.
std::string rays_of(const Explanation& explanation, bool is_svg);
