#include <array>
#include <cstdarg>
#include <cstdio>
#include <iterator>
#include <protostar/light.hpp>

#include "explanation.hpp"

using namespace protostar;

namespace {

[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...) {
  std::array<char, 512> text;
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  return text.data();
}

std::string text(double x) { return formatted("%.6g", x); }
std::string text(const std::vector<double>& list) {
  if (list.size() == 1) return text(list[0]);
  std::string all;
  for (const double x : list) all += (all.empty() ? "(" : ", ") + text(x);
  return all + ")";
}
template <class V>
std::string text(const V& v) requires requires {
  v.z;
}
{ return text(std::vector<double>{v.x, v.y, v.z}); }

/// Returns a surface in words: its type, and its numbers if it has few.
std::string text(const Facts& facts) {
  std::string all = facts.type;
  const bool is_made_of_others = !facts.parts.empty();
  if (facts.type == "instance") return "instance of a " + text(facts.parts[0]);
  if (is_made_of_others) {
    all += " of";
    for (const Facts& part : facts.parts) all += (&part == facts.parts.data() ? " " : ", ") + part.type;
    return all;
  }
  for (const Named& number : facts.numbers)
    if (number.values.size() <= 3)  // but not the vertices of a mesh
      all += ", " + number.name + " " + text(number.values);
  return all;
}

/// Returns where a ray that crosses the plane of a surface passes beside it, if it does.
std::string why_beside(const Facts& e) {
  if (e.numbers.size() < 4) return "";
  const double slope = e.numbers[1].values[0], first = e.numbers[2].values[0],
               second = e.numbers[3].values[0];
  if (e.numbers[2].name == "from_center") return formatted(" at %.6g radii from the center", first / second);
  return formatted(" at %.6g of the first edge and %.6g of the second", first / slope, second / slope);
}

/// Returns why a surface is missed, or which equation was solved, by the numbers of the equation.
std::string text_of_equation(const Facts& e, bool is_hit) {
  const auto number = [&](std::size_t i) { return e.numbers[i].values[0]; };
  if (e.type == "quadratic")
    return formatted("A t^2 - 2 b t + c = 0: A = %.6g, b = %.6g, c = %.6g, D = b^2 - A c = %.6g", number(0),
                     number(1), number(2), number(3)) +
           (is_hit                           ? ""
            : number(3) < 0                  ? ", no root"
            : number(1) < 0 && number(2) > 0 ? ", roots below 0"
                                             : ", no root in that range");
  if (e.type == "linear")
    return formatted("t = %.6g / %.6g", number(0), number(1)) + (is_hit           ? ""
                                                                 : number(1) == 0 ? ": parallel to the ray"
                                                                 : number(0) / number(1) <= 0
                                                                     ? ": behind the ray's start"
                                                                     : why_beside(e));
  return "";
}

/// Returns a step of a march in words, with its place, the value of the field, and what that proves.
std::string text_of_step(const Facts& step) {
  const auto numbers = [&](const char* name) {
    for (const Named& number : step.numbers)
      if (number.name == name && !number.values.empty())
        return number.values.size() == 1 ? formatted("%.6g", number.values[0])
                                         : formatted("[%.6g, %.6g]", number.values[0], number.values[1]);
    return std::string("?");
  };
  const double from = step.numbers[0].values[0], to = step.numbers[1].values[0];
  const std::string part = formatted("t = %.9g to %.9g: ", from, to);
  const std::string least = numbers("slopes"),
                    slopes = least == "?" ? "value behind " + numbers("value_behind") : "slope in " + least;
  if (step.type == "ball") return part + "empty by a ball, value " + numbers("value");
  if (step.type == "two balls")
    return part + "empty by two balls, values " + numbers("value") + " and " + numbers("value_at_to");
  if (step.type == "bend")
    return part + "empty by its bend, values " + numbers("value_before") + " and " + numbers("value");
  if (step.type == "deflation") return part + slopes + ": the surface that is left is not crossed again";
  if (step.type == "sign change")
    return part + slopes + ", and the sign changes: one crossing, enclosed by " +
           formatted("[%.13g, %.13g]", step.numbers[3].values[0], to);
  if (step.type == "touch") return formatted("t = %.9g: undecided, taken for a hit", from);
  return part + "empty by a " + step.type + ", values in " + numbers("values") + ", " + slopes;
}

const char* text(Considered::Decided decided) {
  switch (decided) {
    case Considered::Decided::in_double:
      return "double";
    case Considered::Decided::in_double_double:
      return "double-double";
    case Considered::Decided::exactly:
      return "exact arithmetic";
  }
  return "";
}

/// Formula of an integrator, in words, and the name of rays that follow from a hit besides shadow rays, if
/// they are not those of mirrors and glass.
struct Formula {
  const char *integrator, *words, *ray = nullptr;
};
constexpr std::array formulas{
    Formula{"ambient-occlusion", "1 if nothing is in the way of the ray that is drawn, otherwise 0",
            "ray in a direction drawn by chance"},
    Formula{"binary", "1 if the ray hits anything, otherwise 0"},
    Formula{"color", "the color of the closest hit"},
    Formula{"depth", "1 / t of the closest hit"},
    Formula{"diffuse", "color * (ambient light + irradiance of each light)"},
    Formula{"direct",
            "emission + color / pi * (ambient light + irradiance of each light that nothing occludes)",
            "ray to an area light"},
    Formula{"normal", "0.5 * normal + 0.5"},
    Formula{"path", "emission + light that rays to lights bring + color * light that the path meets",
            "ray of the path, or to a light"},
    Formula{"shadow", "color * (ambient light + irradiance of each light that nothing occludes)"},
    Formula{"sphere", "1 if the ray hits the sphere, otherwise 0"},
    Formula{"transparency", "light from behind, times the color at each hit"},
    Formula{"whitted",
            "emission + color * ambient light + share of each light that nothing occludes + reflect * "
            "radiance of the mirrored ray + refract * radiance of the refracted ray"},
};

/// Writer of the tree, line by line.
class Tree {
 public:
  Tree(const Explanation& explanation, const Options& options)
      : explanation_(explanation), options_(options) {}

  std::string write() {
    const Explanation& e = explanation_;
    line(0, formatted("pixel %d,%d of %dx%d, by the integrator ", e.pixel.x, e.pixel.y, e.width, e.height) +
                options_.integrator);
    if (!e.is_traced) line(1, "drawn without rays");
    if (e.samples.size() > 1)
      line(1, formatted("%zu samples, placed by the sampler ", e.samples.size()) + e.sampler +
                  formatted(" with the seed %llu and the filter ", static_cast<unsigned long long>(e.seed)) +
                  options_.filter);
    for (const SampleRecord& sample : e.samples) write(sample);
    if (e.samples.size() > 1)
      line(1, formatted("mean of the %zu samples: ", e.samples.size()) + text(e.mean));
    if (!(e.light == e.mean)) line(1, "times exposure " + text(options_.exposure) + ": " + text(e.light));
    write_end();
    return text_;
  }

 private:
  void line(int depth, const std::string& words) {
    text_.append(2 * static_cast<std::size_t>(depth), ' ').append(words).append("\n");
  }

  void write(const SampleRecord& sample) {
    int depth = 1;
    if (explanation_.samples.size() > 1)
      line(depth++, formatted("sample at (%g, %g) in the pixel", sample.place.x, sample.place.y) +
                        (sample.place.weight == 1 ? "" : formatted(", of weight %.9g", sample.place.weight)));
    line(depth, formatted("film point u = %.9g, v = %.9g", sample.u, sample.v));
    if (sample.lens)
      line(depth, formatted("point of the lens x = %.9g, y = %.9g", sample.lens->x, sample.lens->y));
    if (explanation_.has_times()) line(depth, formatted("time %.9g", sample.ray.time));
    line(depth, "ray from " + text(sample.ray.origin) + " along " + text(sample.ray.direction));
    for (const auto& [set, numbers] : sample.sets)
      line(depth, formatted("set %lu of the sampler: %.9g, %.9g, %.9g, %.9g", static_cast<unsigned long>(set),
                            numbers[0], numbers[1], numbers[2], numbers[3]));
    if (!explanation_.is_recorded)
      line(depth + 1, std::string("traced by a function of its own") +
                          (sample.told.empty() ? ", which records nothing" : ":"));
    for (const std::string& told : sample.told) line(depth + 2, told);
    write_sky(depth + 1, sample.all);
    for (const RayRecord& ray : sample.all.rays) write(depth + 1, ray, "");
    const Formula* const formula = formula_of(options_.integrator);
    line(depth,
         "radiance" + (formula ? std::string(" = ") + formula->words : "") + ": " + text(sample.radiance));
  }

  /// Returns the formula of an integrator, or nullptr.
  static const Formula* formula_of(const std::string& integrator) {
    for (const Formula& formula : formulas)
      if (formula.integrator == integrator) return &formula;
    return nullptr;
  }

  void write(int depth, const RayRecord& record, const std::string& name) {
    if (!name.empty()) {
      line(depth, name + ", from " + text(record.ray.origin) + " along " + text(record.ray.direction));
      ++depth;
    }
    const std::string end = record.range.max == infinity ? "t > 0" : "0 < t < " + text(record.range.max);
    constexpr std::array words{"the closest hit", "any hit", "all hits"};
    line(depth, std::string("search for ") + words[static_cast<std::size_t>(record.query)] + " in " + end);
    for (const Considered& one : record.considered) write(depth + 1, one, record);
    if (record.query != RayRecord::Query::all && !record.taken) line(depth, "no hit");
    write_sky(depth, record);
    if (record.hit) write_hit(depth, record);
    if (record.radiance) line(depth, "radiance of this ray: " + text(*record.radiance));
  }

  void write(int depth, const Considered& one, const RayRecord& record) {
    const bool is_left = record.left == one.surface;
    std::string words =
        formatted("surface %zu, ", one.surface) + text(explanation_.surfaces[one.surface]) + ": ";
    if (one.crossings.empty()) words += is_left ? "left by the ray, and not hit again" : "missed";
    for (std::size_t i = 0; i < one.crossings.size(); ++i) {
      const double t = one.crossings[i].t, error = Roots::relative_error * std::abs(t);
      words += (i > 0 ? ", " : "") + formatted("hit at t = %.9g +- %.1e", t, error);
    }
    words += std::string(", decided in ") + text(one.decided);
    if (record.taken && &one == &record.considered[*record.taken])
      words += record.query == RayRecord::Query::closest ? "; the closest hit" : "; this occludes the light";
    else if (record.query == RayRecord::Query::closest && !one.crossings.empty())
      words += "; not the closest";
    line(depth, words);
    // The numbers of a line's equation do not show the root 0, which does not count for a ray that starts
    // there.
    if (one.equation.type == "march")
      for (const Facts& step : one.equation.parts) line(depth + 1, text_of_step(step));
    if (is_left) return;
    if (const std::string equation = text_of_equation(one.equation, !one.crossings.empty());
        !equation.empty())
      line(depth + 1, equation);
  }

  void write_sky(int depth, const RayRecord& record) {
    for (const SkyRecord& sky : record.sky) {
      if (!sky.radiance) continue;
      const std::string from =
          sky.uv ? formatted("environment at u = %.6g, v = %.6g: ", sky.uv->x, sky.uv->y) : "sky: ";
      line(depth, (record.hit ? "a path ends here and sees the " : "") + from + text(*sky.radiance));
    }
  }

  void write_hit(int depth, const RayRecord& record) {
    const HitRecord& hit = *record.hit;
    line(depth, "point " + text(hit.point));
    line(depth, "normal " + text_of_normal(hit.normal, hit.facing_normal));
    if (hit.mapped) {
      const MappedNormal& mapped = *hit.mapped;
      line(depth, "the normal map holds the direction " + text(mapped.direction) +
                      formatted(" at u = %.6g, v = %.6g", hit.uv.x, hit.uv.y));
      line(depth + 1,
           "tangents: u grows along " + text(mapped.tangents.u) + ", v along " + text(mapped.tangents.v));
      line(depth + 1,
           "shading normal " + text_of_normal(mapped.shading_normal, mapped.facing_shading_normal));
    }
    line(depth,
         "color " + text(hit.color) +
             (hit.material.texture ? formatted(" of the texture at u = %.6g, v = %.6g", hit.uv.x, hit.uv.y)
                                   : ""));
    write_material(depth, hit.material);
    if (record.asks_lights) line(depth, "ambient light " + text(explanation_.ambient));
    std::vector<bool> is_written(record.rays.size(), false);
    for (std::size_t i = 0; i < hit.lights.size(); ++i) {
      const LightRecord& light = hit.lights[i];
      write_light(depth, i, light);
      if (!light.shadow_ray) continue;
      is_written[*light.shadow_ray] = true;
      const RayRecord& ray = *std::next(record.rays.begin(), static_cast<std::ptrdiff_t>(*light.shadow_ray));
      write(depth + 1, ray, "shadow ray");
      line(depth + 1, ray.taken ? "occluded: adds nothing" : "not occluded: adds its share");
    }
    std::size_t following = 0;
    std::size_t i = 0;
    const Formula* const formula = formula_of(options_.integrator);
    for (const RayRecord& ray : record.rays)
      if (!is_written[i++])
        write(depth, ray, formula && formula->ray ? formula->ray : name_of(hit, following++));
  }

  /// Writes what the integrator uses of a material besides its color, unless it is black.
  void write_material(int depth, const Material& material) {
    const bool is_whitted = options_.integrator == "whitted";
    if (!is_whitted && options_.integrator != "direct" && options_.integrator != "path") return;
    if (!is_black(material.emission)) line(depth, "emission " + text(material.emission));
    if (is_whitted && !is_black(material.specular))
      line(depth, "specular " + text(material.specular) + ", shininess " + text(material.shininess));
    if (!is_whitted && !is_black(material.glossy))
      line(depth, "glossy " + text(material.glossy) +
                      (material.blur == Blur::phong ? ", shininess " + text(material.shininess)
                                                    : ", roughness " + text(material.roughness)));
  }

  static std::string text_of_normal(const Vec3& outside, const Vec3& facing) {
    return text(outside) + (facing == outside ? "" : ", turned to the ray: " + text(facing));
  }

  /// Returns the name of the i-th ray that follows from a hit besides shadow rays: a mirrored one, then a
  /// refracted one, if the material has both.
  static std::string name_of(const HitRecord& hit, std::size_t i) {
    const float reflect = to_float(hit.material.reflect);
    if (i == 0 && reflect > 0) return "mirrored ray, reflect = " + text(hit.material.reflect);
    return "refracted ray, refract = " + text(hit.material.refract) + ", ior = " + text(hit.material.ior);
  }

  void write_light(int depth, std::size_t i, const LightRecord& light) {
    line(depth, formatted("light %zu, a ", i) + explanation_.lights[i].type() + ": towards it " +
                    text(light.towards) + ", cosine " + text(light.cosine) +
                    (light.cosine > 0 ? "" : ": behind the surface, adds nothing"));
    if (!(light.cosine > 0)) return;
    line(depth + 1, "irradiance " + text(light.irradiance) + " = " + text(light.facing) + " * cosine");
    if (light.share) line(depth + 1, "share of the radiance " + text(*light.share));
  }

  void write_end() {
    const Explanation& e = explanation_;
    if (options_.is_linear()) return line(1, "saved as linear light: " + text(e.light));
    constexpr std::array tones{"clip: channels above 1 are cut by the encoder",
                               "scale_pixel: divided by its largest channel if that is above 1",
                               "scale_image: divided by the largest channel of the picture"};
    line(1, std::string("tone ") + tones[static_cast<std::size_t>(options_.tone)] +
                (options_.tone == Tone::scale_image ? ", " + text(e.largest) : "") + ": " + text(e.toned));
    const int most = options_.bits == 16 ? 65535 : 255;
    std::string transfer = "srgb";
    if (std::holds_alternative<Linear>(options_.transfer)) transfer = "linear";
    if (const auto* gamma = std::get_if<Gamma>(&options_.transfer))
      transfer = "gamma " + text(gamma->exponent);
    line(1, "transfer " + transfer + formatted(", times %d and rounded: ", most) +
                formatted("%d %d %d", e.codes[0], e.codes[1], e.codes[2]));
  }

  const Explanation& explanation_;
  const Options& options_;
  std::string text_;
};

}  // namespace

std::string text_of(const Explanation& explanation, const Options& options) {
  return Tree(explanation, options).write();
}
