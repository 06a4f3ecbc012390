// Reads scene files (docs/scene-format.md), through nlohmann_json. Not part of the core: link
// protostar::json.
//
// A JsonCursor, which knows the path to its value, checks everything where it is read. Surfaces have a header
// of their own, json_surfaces.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../image.hpp"
#include "../sampling/reconstruction.hpp"
#include "../sampling/samplers.hpp"
#include "../shown.hpp"
#include "../surfaces/csg.hpp"
#include "image_normal_map.hpp"
#include "image_texture.hpp"
#include "json_cursor.hpp"
#include "json_surfaces.hpp"
#include "json_tree.hpp"
#include "loaded_files.hpp"
#include "read_options.hpp"
#include "scene_file.hpp"
#include "text.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

// ---- Materials.

/// Returns the image that a path leads to, read once by load(path, most_pixels) and kept in a list.
inline std::shared_ptr<const Image> image_at(const JsonCursor& at, LoadedFiles::Images LoadedFiles::*list,
                                             Image (*load)(const std::filesystem::path&, std::int64_t)) {
  const NamedFile file = at.named_file();
  LoadedFiles& loaded = at.loaded();
  std::shared_ptr<const Image>& image = (loaded.*list)[file.canonical];
  if (image) return image;
  image = at.checked([&] {
    return std::make_shared<const Image>(
        load(file.path, std::min(at.options().most_pixels - loaded.pixels, most_image_pixels)));
  });
  loaded.pixels += std::int64_t{image->width()} * image->height();
  return image;
}

/// Returns the image of light that a path leads to, or that of normals.
inline std::shared_ptr<const Image> light_at(const JsonCursor& at) {
  return image_at(at, &LoadedFiles::images, [](const std::filesystem::path& path, std::int64_t most) {
    return load_image(path, most);
  });
}
inline std::shared_ptr<const Image> normals_at(const JsonCursor& at) {
  return image_at(at, &LoadedFiles::normal_maps, &load_normal_map);
}

/// Returns an image with its size on a surface, of the keys image and size.
inline ImageTexture placed_image(const JsonCursor& at,
                                 std::shared_ptr<const Image> (*image)(const JsonCursor&)) {
  at.with_keys({"image", "size"});
  double size_u = 1, size_v = 1;
  if (at.has("size")) {
    const JsonCursor size = at["size"].with_size(2, "an array of two numbers");
    size_u = size[0].size(), size_v = size[1].size();
  }
  return {image(at["image"]), size_u, size_v, at["image"].named_file().path.string()};
}

inline Texture texture_at(const JsonCursor& at) {
  if (at.has("image")) return placed_image(at, light_at);
  if (!at.has("checker"))
    at.with_keys({"checker", "image", "size"})["checker"].refuse(
        "an array of two colors, and there is no image");
  const JsonCursor colors =
      at.with_keys({"checker", "size"})["checker"].with_size(2, "an array of two colors");
  return Checker{.first = colors[0].color(), .second = colors[1].color(), .size = at["size"].size()};
}

inline Material material_at(const JsonCursor& at) {
  at.with_keys({"diffuse", "specular", "shininess", "reflect", "refract", "ior", "normal-map", "emission",
                "glossy", "roughness", "blur"});
  Material material;
  if (at["diffuse"].is(json::value_t::object))
    material.texture = texture_at(at["diffuse"]);
  else if (at.has("diffuse"))
    material.diffuse = at["diffuse"].color(", or a texture");
  if (at.has("normal-map")) material.normal_map = ImageNormalMap{placed_image(at["normal-map"], normals_at)};
  if (at.has("specular")) material.specular = at["specular"].color();
  if (at.has("shininess"))
    material.shininess =
        at["shininess"].number_between(0, std::numeric_limits<double>::max(), "a number of at least 0");
  if (at.has("reflect")) material.reflect = at["reflect"].factor();
  if (at.has("refract")) material.refract = at["refract"].factor();
  if (at.has("ior")) material.ior = at["ior"].size();
  if (at.has("emission")) material.emission = at["emission"].color();
  if (at.has("glossy")) material.glossy = at["glossy"].color();
  if (at.has("roughness")) material.roughness = at["roughness"].number_between(0, 1, "a number from 0 to 1");
  if (at.has("blur")) {
    material.blur = at["blur"].one_of<Blur>({{"ggx", Blur::ggx}, {"phong", Blur::phong}});
    if (material.blur == Blur::phong && at.has("shininess"))
      material.shininess = at["shininess"].number_between(0, Material::most_shininess_of_blur,
                                                          "a number from 0 to 2^30 (1e9), with this blur");
  }
  return material;
}

using Materials = std::map<std::string, Material>;

inline Material material_of(const JsonCursor& object, const Materials& materials) {
  if (object.has("material-id") && object.has("color")) object["color"].refuse_beside("a material-id");
  if (object.has("color")) return {.diffuse = object["color"].color()};
  const std::string allowed = "the name of one of the materials";
  const auto found = materials.find(object["material-id"].text(allowed + ", and there is no color"));
  if (found != materials.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, material] : materials)
    if (names.size() < 10) names.push_back(json(beginning(name)).dump());
  if (names.size() < materials.size()) names.push_back("more");
  object["material-id"].refuse(allowed +
                               (names.empty() ? ", of which there are none" : ": " + list_of(names)));
}

// ---- Lights, whose kind follows from their keys.

inline void add_light(const JsonCursor& at, SceneFile& file) {
  if (at.has("ambient")) {
    at.with_keys({"ambient"});
    file.scene.add(AmbientLight{at["ambient"].color()});
  } else if (at.has("angle") || at.has("fade") || (at.has("position") && at.has("direction"))) {
    at.with_keys({"position", "direction", "angle", "fade", "power"});
    SpotLight light{.position = at["position"].point(), .direction = at["direction"].direction()};
    const std::string degrees = "a number of degrees above 0 and at most 180";
    light.angle = at["angle"].number_between(std::numeric_limits<double>::denorm_min(), 180, degrees);
    if (at.has("fade"))
      light.fade = at["fade"].number_between(0, std::numeric_limits<double>::max(),
                                             "a number of degrees of at least 0");
    light.power = at["power"].color();
    at.checked([&] { file.scene.add(light); });
  } else if (at.has("direction")) {
    at.with_keys({"direction", "intensity"});
    const Vec3 direction = at["direction"].direction();
    file.scene.add(DirectionalLight{.direction = direction, .intensity = at["intensity"].color()});
  } else if (at.has("power")) {
    at.with_keys({"position", "power"});
    file.scene.add(PointLight{.position = at["position"].point(), .power = at["power"].color()});
  } else {
    if (!at.has("intensity"))
      at.with_keys({"position", "direction", "intensity", "power", "angle", "fade", "ambient"});
    if (!at.has("position") || !at.has("intensity"))
      at.refuse(
          "a light: position and power; position and intensity; direction and intensity; position, "
          "direction, angle and power; or ambient");
    at.with_keys({"position", "intensity"});
    file.scene.add(ConstantLight{.position = at["position"].point(), .intensity = at["intensity"].color()});
  }
}

// ---- Camera, settings, world.

/// Returns the camera at the time 0, the only one of its shutter.
inline Camera still_camera_at(const JsonCursor& at) {
  const bool is_orthographic =
      at["projection"].one_of<bool>({{"perspective", false}, {"orthographic", true}});
  if (is_orthographic)
    at.with_keys({"projection", "position", "direction", "upward", "ortho-scale", "shutter", "velocity"});
  else
    at.with_keys({"projection", "position", "direction", "upward", "field-of-view", "focal-length",
                  "aperture", "focus", "shutter", "velocity"});

  const Vec3 position = at["position"].point(), direction = at["direction"].direction();
  const Vec3 upward = at["upward"].direction();
  if (!(std::abs(dot(direction, upward)) <= Camera::most_cosine))
    at["upward"].refuse("orthogonal to direction: the cosine between them is at most 1e-6");

  if (is_orthographic) {
    const double height = at["ortho-scale"].camera_length();
    return at.checked([&] { return Camera::orthographic(position, direction, upward, height); });
  }
  if (at.has("field-of-view") && at.has("focal-length")) at["focal-length"].refuse_beside("a field-of-view");
  if (at.has("aperture") && at.has("focal-length")) at["aperture"].refuse_beside("a focal-length");
  if (at.has("focal-length")) {
    const double focal_length = at["focal-length"].camera_length();
    return at.checked([&] { return Camera::sensor(position, direction, upward, focal_length); });
  }
  // tan(angle / 2) is a length of the camera: 8.7e-103 for the least angle, and 3.5e15 for the double below
  // 180.
  const std::string degrees = "a number of degrees from 1e-100 to below 180";
  if (!at.has("field-of-view")) at["field-of-view"].refuse(degrees + ", and there is no focal-length");
  const double angle = at["field-of-view"].number_between(1e-100, std::nextafter(180, 0), degrees);
  if (!at.has("aperture") && !at.has("focus"))
    return at.checked([&] { return Camera::perspective(position, direction, upward, angle); });
  const double aperture = at["aperture"].number_between(0, 1e100, "a number from 0 to 1e100");
  const double focus = at["focus"].camera_length();
  return at.checked([&] { return Camera::thin_lens(position, direction, upward, angle, aperture, focus); });
}

inline Camera camera_at(const JsonCursor& at) {
  const Camera still = still_camera_at(at);
  const Vec3 velocity = at.has("velocity") ? at["velocity"].point() : Vec3{0};
  const Camera camera = at.checked([&] { return still.with_velocity(velocity); });
  if (!at.has("shutter")) return camera;
  const JsonCursor shutter = at["shutter"].with_size(2, "an array of two times");
  const double opens = shutter[0].coordinate(), closes = shutter[1].coordinate();
  if (!(opens <= closes))
    shutter.refuse("an array of two times, of which the second is not before the first");
  return at.checked([&] { return camera.with_shutter(opens, closes); });
}

inline Transfer transfer_at(const JsonCursor& at) {
  if (at.is(json::value_t::object)) return Gamma{at.with_keys({"gamma"})["gamma"].number_above_0()};
  return at.one_of<Transfer>({{"srgb", Srgb{}}, {"linear", Linear{}}}, R"({"gamma": G})");
}

inline void read_settings(const JsonCursor& at, SceneFile& file) {
  at.with_keys({"resolution-x", "resolution-y", "samples", "error", "sampler", "filter", "seed", "depth",
                "integrator", "occlusion-distance", "transfer", "tone", "exposure"});
  const int most = static_cast<int>(Image::max_pixels);
  file.width = at["resolution-x"].whole_number(1, most);
  file.height = at["resolution-y"].whole_number(1, most);
  if (std::int64_t{file.width} * file.height > Image::max_pixels)
    at.refuse("a picture of at most 2^28 pixels");
  if (at.has("samples")) file.samples = at["samples"].whole_number(0, most_samples);
  if (at.has("depth")) file.depth = at["depth"].whole_number(1, most_depth);
  const auto name_of = [&](const char* key, const auto& allowed) {
    std::vector<std::pair<std::string_view, std::string_view>> names;
    for (const std::string_view name : allowed) names.push_back({name, name});
    return std::string(at[key].one_of(names));
  };
  if (at.has("sampler")) file.sampler = name_of("sampler", sampler_names);
  if (at.has("error")) {
    if (at.has("samples")) at["error"].refuse_beside("samples");
    file.error = at["error"].number_above_0();
    if (file.sampler == "hammersley" || file.sampler == "stratified")
      at["sampler"].refuse(
          "independent, halton or sobol, which can tell the error that the settings ask for");
  }
  if (at.has("filter")) file.filter = name_of("filter", ReconstructionFilter::names);
  if (at.has("seed")) file.seed = at["seed"].whole_word();
  if (at.has("integrator")) file.integrator = name_of("integrator", integrator_names);
  if (file.sampler == "hammersley" && draws_by_chance(file.integrator))
    at["sampler"].refuse("independent, stratified, halton or sobol: " + why_not_hammersley(file.integrator));
  if (at.has("occlusion-distance")) file.occlusion_distance = at["occlusion-distance"].size();
  if (at.has("transfer")) file.transfer = transfer_at(at["transfer"]);
  if (at.has("tone"))
    file.tone = at["tone"].one_of<Tone>(
        {{"clip", Tone::clip}, {"scale-pixel", Tone::scale_pixel}, {"scale-image", Tone::scale_image}});
  if (at.has("exposure")) file.exposure = at["exposure"].factor();
}

inline void read_world(const JsonCursor& at, SceneFile& file) {
  at.with_keys({"sky", "environment"});
  if (at.has("sky") && at.has("environment")) at["sky"].refuse_beside("an environment");
  if (at.has("sky")) file.scene.set_sky(at["sky"].color());
  if (at.has("environment")) {
    const JsonCursor image = at["environment"];
    file.scene.set_environment(EnvironmentImage{light_at(image), image.named_file().path.string()});
  }
}

inline SceneFile scene_at(const JsonCursor& at) {
  at.with_keys({"settings", "world", "camera", "objects", "lights", "materials"});
  SceneFile file;
  read_settings(at["settings"], file);
  if (at.has("world")) read_world(at["world"], file);
  file.camera = camera_at(at["camera"]);

  Materials materials;
  if (at.has("materials"))
    at["materials"].each_member([&](const std::string& name, const JsonCursor& material) {
      materials.emplace(name, material_at(material));
    });
  at["objects"].each_element([&](const JsonCursor& object) {
    object.with_keys({"surface", "material-id", "color"});
    const JsonCursor surface = object["surface"];
    surface["type"].one_of(surface_types).add(surface, material_of(object, materials), file);
  });
  if (at.has("lights"))
    at["lights"].each_element([&, count = std::size_t{0}](const JsonCursor& light) mutable {
      if (count++ == file.scene.most_lights)
        at["lights"].refuse("an array of at most " + std::to_string(file.scene.most_lights) + " lights");
      add_light(light, file);
    });
  if (const auto refusal = refusal_of_samples(file.samples, file.scene.lights().size()))
    at["settings"]["samples"].refuse("possible: " + *refusal);
  if (at["settings"].has("integrator"))
    at["settings"]["integrator"].checked([&] { require_integrator(file.integrator, file); });
  file.files = at.loaded().paths();
  return file;
}

}  // namespace detail

/// Returns the scene that a text describes. `file` is its name in error messages, and files that the scene
/// names are looked for from its folder. Throws SceneError.
[[nodiscard]] inline SceneFile scene_from_json(const std::string& text, const std::string& file,
                                               const ReadOptions& options = {}) {
  // The parser takes a zero byte for the end of the text.
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto line = 1 + std::count(text.data(), text.data() + zero, '\n');
    const std::size_t column = zero - std::string_view(text.data(), zero).rfind('\n');  // npos is −1
    throw SceneError(shown(file) + ": parse error at line " + std::to_string(line) + ", column " +
                     std::to_string(column) + ": a zero byte, which no text has");
  }
  detail::SceneText scene{.tree = detail::JsonTree(file), .options = options};
  // Operations on solids may nest Csg::most_depth deep, each as an object and an array; 48 more for the rest.
  detail::JsonBuilder builder(scene.tree, 2 * std::size_t{Csg::most_depth} + 48);
  nlohmann::json::sax_parse(text, &builder);
  return detail::scene_at(detail::JsonCursor(scene));
}

/// Reads a scene file. Throws std::system_error if it cannot be read, and SceneError if it is wrong or if
/// there is not enough memory for it.
[[nodiscard]] inline SceneFile read_scene(const std::filesystem::path& path,
                                          const ReadOptions& options = {}) {
  try {
    return scene_from_json(detail::text_of<SceneError>(path, detail::most_bytes), path.string(), options);
  } catch (const std::bad_alloc&) {
    throw SceneError(shown(path.string()) + ": not enough memory for this scene");
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI
