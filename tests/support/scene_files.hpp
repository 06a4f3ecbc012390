// Scene files for the tests of their reader: the folder of the project's, and texts that a test changes in
// one place.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <protostar/io/json_scene.hpp>
#include <protostar/surfaces/any_surface.hpp>
#include <string>

#include "errors.hpp"
#include "scenes_folder.hpp"

/// The smallest scene, with one of each required item.
inline const std::string smallest_scene = R"({
  "settings": {"resolution-x": 8, "resolution-y": 6},
  "camera": {"projection": "perspective", "position": [0, 0, 0], "direction": [0, 0, 1], "upward": [0, 1, 0],
             "field-of-view": 90},
  "objects": [{"surface": {"type": "sphere", "position": [0, 0, 3], "radius": 1}, "color": [1, 0.5, 0]}]
})";

/// A scene with one of everything, into which tests put errors.
inline const std::string scene_of_everything = R"({
  "settings": {"resolution-x": 8, "resolution-y": 6, "samples": 4, "sampler": "stratified", "filter": "tent", "seed": 7, "depth": 3, "integrator": "shadow",
               "transfer": {"gamma": 2.2}, "tone": "scale-pixel", "exposure": 0.5},
  "world": {"sky": [0.1, 0.2, 0.3]},
  "camera": {"projection": "perspective", "position": [1, 2, 3], "direction": [0, 0, 2], "upward": [0, 3, 0],
             "field-of-view": 60},
  "objects": [
    {"surface": {"type": "sphere", "position": [0, 0, 3], "radius": 1}, "material-id": "red"},
    {"surface": {"type": "plane", "normal": [0, 2, 0], "distance": -1}, "material-id": "squares"},
    {"surface": {"type": "parallelogram", "position": [1, 1, 1], "edges": [[2, 0, 0], [0, 0, 3]]},
     "color": [1, 0.5, 0]}
  ],
  "lights": [
    {"position": [0, 3, 0], "intensity": [1, 2, 3]},
    {"position": [0, 3, 0], "power": [4, 5, 6]},
    {"direction": [0, 2, 0], "intensity": [7, 8, 9]},
    {"position": [0, 3, 0], "direction": [0, -2, 0], "angle": 30, "fade": 10, "power": [1, 1, 1]},
    {"ambient": [0.1, 0.1, 0.2]}
  ],
  "materials": {
    "red": {"diffuse": [0.8, 0.1, 0.1], "specular": [0.5, 0.6, 0.7], "shininess": 20, "reflect": 0.25,
            "refract": 0.5, "ior": 1.33, "emission": [0.25, 0, 2], "glossy": [0.9, 0.5, 0],
            "roughness": 0.125},
    "squares": {"diffuse": {"checker": [[1, 0, 0], [0, 0, 1]], "size": 2}},
    "black": {}
  }
})";

inline protostar::SceneFile scene_of_text(const std::string& text) {
  return protostar::scene_from_json(text, "scene.json");
}

inline std::string scene_error(const std::string& text) {
  return message_of<protostar::SceneError>([&] { static_cast<void>(scene_of_text(text)); });
}

/// Returns the scene with everything after a JSON Patch (RFC 6902).
inline std::string patched(const std::string& patch) {
  return nlohmann::json::parse(scene_of_everything).patch(nlohmann::json::parse("[" + patch + "]")).dump();
}

inline std::string replacing(const std::string& pointer, const std::string& value) {
  return patched(R"({"op": "replace", "path": ")" + pointer + R"(", "value": )" + value + "}");
}

inline std::string scene_with(const std::string& pointer, const std::string& value) {
  return patched(R"({"op": "add", "path": ")" + pointer + R"(", "value": )" + value + "}");
}

/// A surface, and functions that replace the surface of the smallest scene.
inline const std::string ball_in_json = R"({"position":[0,0,3],"radius":1,"type":"sphere"})";
inline std::string with_surface(const std::string& surface) {
  const std::string sphere = R"({"type": "sphere", "position": [0, 0, 3], "radius": 1})";
  return std::string(smallest_scene).replace(smallest_scene.find(sphere), sphere.size(), surface);
}
inline protostar::AnySurface only_surface(const std::string& surface) {
  return scene_of_text(with_surface(surface)).scene.surfaces<protostar::AnySurface>().at(0);
}
