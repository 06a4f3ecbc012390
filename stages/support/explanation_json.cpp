#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <protostar/shown.hpp>
#include <protostar/texture_image.hpp>
#include <string_view>

#include "explanation.hpp"

using namespace protostar;

namespace {

/// Writer of JSON, with an object's members in lines of their own, and lists of numbers in one.
class Json {
 public:
  Json& object(const auto& members) { return nested('{', members, '}'); }
  Json& array(const auto& elements) { return nested('[', elements, ']'); }

  /// Begins the next member of an object, or the next element of an array.
  Json& key(std::string_view name) {
    next();
    text_.append("\"").append(name).append("\": ");
    return *this;
  }
  Json& next() {
    text_ += is_first_ ? "\n" : ",\n";
    text_.append(2 * depth_, ' ');
    is_first_ = false;
    return *this;
  }

  /// Writes a number with as many digits as tell it from all others. JSON has no infinity: "infinity" is a
  /// word.
  void value(double x) {
    if (!std::isfinite(x)) return value(std::isnan(x) ? "nan" : x > 0 ? "infinity" : "-infinity");
    text_ += shown(x);
  }
  void value(float x) { value(static_cast<double>(x)); }
  void value(std::integral auto x) { text_ += std::to_string(x); }
  void value(bool x) { text_ += x ? "true" : "false"; }
  void value(std::nullptr_t) { text_ += "null"; }
  void value(const std::string& x) { value(std::string_view(x)); }
  void value(const char* x) { value(std::string_view(x)); }
  /// Writes a text. JSON has no bytes that belong to no character of UTF-8: \xNN stands for them (shown).
  void value(std::string_view x) {
    text_ += '"';
    while (!x.empty()) {
      const std::size_t size = protostar::detail::bytes_of_character(x);
      const std::string_view character = x.substr(0, std::max<std::size_t>(size, 1));
      if (size == 0)
        text_.append("\\").append(shown(character));
      else if (static_cast<unsigned char>(character[0]) < 0x20)
        text_.append("\\u00").append(shown(character), 2);
      else
        text_.append(character == "\"" || character == "\\" ? "\\" : "").append(character);
      x.remove_prefix(character.size());
    }
    text_ += '"';
  }
  void value(const Vec3& v) { list(std::array{v.x, v.y, v.z}); }
  void value(const Color& c) { list(std::array{c.r, c.g, c.b}); }
  void value(const Uv& v) { list(std::array{v.x, v.y}); }
  template <class T>
  void value(const std::optional<T>& x) {
    x ? value(*x) : value(nullptr);
  }

  /// Writes numbers in one line.
  void list(const auto& numbers) {
    text_ += '[';
    bool is_first = true;
    for (const auto& x : numbers) {
      if (!is_first) text_ += ", ";
      is_first = false;
      value(x);
    }
    text_ += ']';
  }
  void member(std::string_view name, const auto& x) { key(name).value(x); }

  std::string text() { return text_ + "\n"; }

 private:
  Json& nested(char begin, const auto& inside, char end) {
    text_ += begin;
    ++depth_;
    is_first_ = true;
    inside();
    --depth_;
    if (!is_first_) {
      text_ += "\n";
      text_.append(2 * depth_, ' ');
    }
    is_first_ = false;
    text_ += end;
    return *this;
  }

  std::string text_;
  std::size_t depth_ = 0;
  bool is_first_ = true;
};

/// Returns true if the lights were asked for at any hit of a ray or of those that follow it.
bool asks_lights(const RayRecord& record) {
  return record.asks_lights || std::any_of(record.rays.begin(), record.rays.end(), asks_lights);
}

class Writer {
 public:
  Writer(const Explanation& explanation, const Options& options) : e_(explanation), options_(options) {}

  std::string write() {
    json_.object([&] {
      json_.member("format", "protostar explanation 1");
      json_.member("integrator", options_.integrator);
      json_.key("picture").list(std::array{e_.width, e_.height});
      json_.key("pixel").list(std::array{e_.pixel.x, e_.pixel.y});
      if (e_.is_traced) write_camera();
      if (e_.is_recorded) write_scene();
      if (e_.is_traced) {
        json_.member("sampler", e_.sampler);
        json_.member("filter", options_.filter);
        json_.member("seed", e_.seed);
      }
      json_.key("samples").array([&] {
        for (const SampleRecord& sample : e_.samples) {
          json_.next();
          write(sample);
        }
      });
      json_.member("mean", e_.mean);
      json_.member("exposure", options_.exposure);
      json_.member("light", e_.light);
      if (!options_.is_linear()) write_end();
    });
    return json_.text();
  }

 private:
  /// Returns true for the integrators that draw directions to lights and by glossy lobes.
  [[nodiscard]] bool draws_light() const {
    return options_.integrator == "direct" || options_.integrator == "path";
  }

  void write_camera() {
    json_.key("camera").object([&] {
      json_.member("position", e_.camera.position);
      json_.member("right", e_.camera.right);
      json_.member("up", e_.camera.up);
      json_.member("forward", e_.camera.forward);
      json_.member("film_right", e_.camera.film_right);
      json_.member("film_up", e_.camera.film_up);
      json_.member("aperture", e_.camera.aperture);
      json_.member("focus", e_.camera.focus);
      if (e_.has_times())
        json_.key("shutter").list(std::array{e_.camera.shutter.opens, e_.camera.shutter.closes});
      json_.member("velocity", e_.camera.velocity);
    });
  }

  void write_scene() {
    json_.key("surfaces").array([&] {
      for (const Facts& facts : e_.surfaces) {
        json_.next();
        write(facts);
      }
    });
    json_.member("depth", e_.depth);
    if (options_.integrator == "ambient-occlusion") json_.member("distance", e_.distance);
    if (draws_light()) {
      json_.member("most_rays", e_.most_rays);
      json_.key("area_lights").array([&] {
        for (const AreaLightRecord& light : e_.area_lights)
          json_.next().object([&] {
            json_.member("surface", light.surface);
            json_.member("emission", light.emission);
          });
      });
      json_.member("environment_has_places", e_.environment_has_places);
    }
    if (std::none_of(e_.samples.begin(), e_.samples.end(),
                     [](const SampleRecord& sample) { return asks_lights(sample.all); }))
      return;
    json_.member("ambient", e_.ambient);
    json_.key("lights").array([&] {
      for (const Light& light : e_.lights) {
        json_.next().object([&] {
          const bool is_far = light.occlusion_range().max == infinity;
          json_.member("type", light.type());
          json_.member(is_far ? "direction" : "position", light.towards(Point{0}));
          json_.member("color", light.color());
          if (light.axis() == Vec3{0}) return;
          json_.member("axis", light.axis());
          json_.member("angle", light.angle());
          json_.member("fade", light.fade());
        });
      }
    });
  }

  void write(const Facts& facts) {
    json_.object([&] {
      json_.member("type", facts.type);
      if (facts.type == "image") json_.member("file", facts.file);
      for (const Named& number : facts.numbers)
        if (number.values.size() == 1 && facts.type != "csg")
          json_.member(number.name, number.values[0]);
        else
          json_.key(number.name).list(number.values);
      if (facts.parts.empty()) return;
      json_.key("parts").array([&] {
        for (const Facts& part : facts.parts) {
          json_.next();
          write(part);
        }
      });
    });
  }

  void write(const SampleRecord& sample) {
    json_.object([&] {
      json_.key("position").list(std::array{sample.place.x, sample.place.y});
      json_.member("weight", sample.place.weight);
      json_.key("film").list(std::array{sample.u, sample.v});
      if (sample.lens) json_.key("lens").list(std::array{sample.lens->x, sample.lens->y});
      if (e_.has_times()) json_.member("time", sample.ray.time);
      json_.member("origin", sample.ray.origin);
      json_.member("direction", sample.ray.direction);
      if (!sample.sets.empty())
        json_.key("sets").array([&] {
          for (const auto& drawn : sample.sets)
            json_.next().object([&] {
              json_.member("set", drawn.first);
              json_.key("numbers").list(drawn.second);
            });
        });
      write_following(sample.all);
      if (!sample.steps.empty())
        json_.key("steps").array([&] {
          for (const Facts& step : sample.steps) {
            json_.next();
            write(step);
          }
        });
      json_.member("radiance", sample.radiance);
    });
  }

  void write_following(const RayRecord& record) {
    json_.key("sky").array([&] {
      for (const SkyRecord& sky : record.sky)
        json_.next().object([&] {
          json_.member("radiance", sky.radiance);
          if (!sky.uv) return;
          json_.member("uv", *sky.uv);
          json_.key("environment");
          write(sky.look_up);
        });
    });
    json_.key("rays").array([&] {
      for (const RayRecord& ray : record.rays) {
        json_.next();
        write(ray);
      }
    });
  }

  void write(const RayRecord& record) {
    constexpr std::array queries{"closest", "any", "all"};
    json_.object([&] {
      json_.member("query", queries[static_cast<std::size_t>(record.query)]);
      json_.member("origin", record.ray.origin);
      json_.member("direction", record.ray.direction);
      json_.member("range_end", record.range.max);
      json_.member("leaves", record.left);
      if (record.left) json_.member("leaves_part", record.left_part);
      json_.key("considered").array([&] {
        for (const Considered& one : record.considered) {
          json_.next();
          write(one);
        }
      });
      if (record.query == RayRecord::Query::all) {
        json_.key("hits").array([&] {
          for (const HitRecord& hit : record.all_hits) {
            json_.next();
            write(hit, false);
          }
        });
        return;
      }
      json_.member("taken", record.taken);
      if (record.hit) {
        json_.key("hit");
        write(*record.hit, record.asks_lights);
      }
      if (record.query == RayRecord::Query::any) return;
      write_following(record);
      json_.member("radiance", record.radiance);
    });
  }

  void write(const Considered& one) {
    constexpr std::array decided{"double", "double-double", "exact"};
    json_.object([&] {
      json_.member("surface", one.surface);
      json_.member("decided", decided[static_cast<std::size_t>(one.decided)]);
      std::vector<double> t, intervals;
      std::vector<int> parts;
      for (const Crossing& crossing : one.crossings) {
        const double error = Roots::relative_error * std::abs(crossing.t);
        t.push_back(crossing.t);
        intervals.insert(intervals.end(), {crossing.t - error, crossing.t + error});
        parts.push_back(crossing.primitive);
      }
      json_.key("t").list(t);
      json_.key("intervals").list(intervals);
      json_.key("parts").list(parts);
      json_.key("equation");
      write(one.equation);
    });
  }

  void write(const HitRecord& hit, bool asks_lights) {
    json_.object([&] {
      json_.member("t", hit.t);
      json_.member("part", hit.part);
      json_.member("point", hit.point);
      json_.member("normal", hit.normal);
      json_.member("facing_normal", hit.facing_normal);
      if (!hit.primitive.type.empty()) {
        json_.key("primitive");
        write(hit.primitive);
      }
      json_.key("material").object([&] { write(hit.material, hit.uv); });
      if (hit.material.texture || hit.mapped) json_.member("uv", hit.uv);
      if (hit.mapped)
        json_.key("normal_map").object([&] {
          json_.member("direction", hit.mapped->direction);
          if (const auto* map = hit.material.normal_map.target<ImageNormalMap>()) write(map->colors, hit.uv);
          json_.member("tangent_u", hit.mapped->tangents.u);
          json_.member("tangent_v", hit.mapped->tangents.v);
          json_.member("shading_normal", hit.mapped->shading_normal);
          json_.member("facing_shading_normal", hit.mapped->facing_shading_normal);
        });
      json_.member("color", hit.color);
      if (!asks_lights) return;
      json_.key("lights").array([&] {
        for (const LightRecord& light : hit.lights) {
          json_.next();
          write(light);
        }
      });
    });
  }

  /// Writes which pixel of an image is at u and v, with the sizes that it follows from.
  void write(const ImageTexture& texture, const Uv& uv) {
    json_.key("image").object([&] {
      json_.member("file", texture.file);
      json_.key("pixels").list(std::array{texture.image->width(), texture.image->height()});
      json_.key("size").list(std::array{texture.size_u, texture.size_v});
      json_.member("column", texture.column_at(uv.x));
      json_.member("row", texture.row_at(uv.y));
    });
  }

  void write(const Material& material, const Uv& uv) {
    if (const auto* image = material.texture.target<ImageTexture>()) write(*image, uv);
    if (!material.texture) json_.member("diffuse", material.diffuse);
    if (const auto* checker = material.texture.target<Checker>())
      json_.key("checker").object([&] {
        json_.member("first", checker->first);
        json_.member("second", checker->second);
        json_.member("size", checker->size);
      });
    if (draws_light() || options_.integrator == "whitted") json_.member("emission", material.emission);
    if (draws_light()) {
      json_.member("glossy", material.glossy);
      if (!is_black(material.glossy)) {
        const bool is_phong = material.blur == Blur::phong;
        json_.member("blur", is_phong ? "phong" : "ggx");
        json_.member(is_phong ? "shininess" : "roughness",
                     is_phong ? material.shininess : material.roughness);
      }
    }
    if (options_.integrator == "whitted") {
      json_.member("specular", material.specular);
      json_.member("shininess", material.shininess);
    } else if (options_.integrator != "path") {
      return;
    }
    json_.member("reflect", material.reflect);
    json_.member("refract", material.refract);
    json_.member("ior", material.ior);
  }

  void write(const LightRecord& light) {
    json_.object([&] {
      json_.member("towards", light.towards);
      json_.member("cosine", light.cosine);
      json_.member("facing", light.facing);
      json_.member("irradiance", light.irradiance);
      json_.member("share", light.share);
      json_.member("shadow_ray", light.shadow_ray);
    });
  }

  void write_end() {
    constexpr std::array tones{"clip", "scale_pixel", "scale_image"};
    json_.member("tone", tones[static_cast<std::size_t>(options_.tone)]);
    if (options_.tone == Tone::scale_image) json_.member("largest", e_.largest);
    json_.member("toned", e_.toned);
    if (const auto* gamma = std::get_if<Gamma>(&options_.transfer)) {
      json_.member("transfer", "gamma");
      json_.member("exponent", gamma->exponent);
    } else {
      json_.member("transfer", std::holds_alternative<Srgb>(options_.transfer) ? "srgb" : "linear");
    }
    json_.member("max_code", options_.bits == 16 ? 65535 : 255);
    json_.key("codes").list(e_.codes);
  }

  const Explanation& e_;
  const Options& options_;
  Json json_;
};

}  // namespace

std::string json_of(const Explanation& explanation, const Options& options) {
  return Writer(explanation, options).write();
}
