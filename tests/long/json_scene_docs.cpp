// Scene files and their documentation: every key and word, the examples, the errors and the limits.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <protostar/io/image_texture.hpp>
#include <protostar/io/json_scene.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/scene_files.hpp"

namespace fs = std::filesystem;
using namespace protostar;
using nlohmann::json;

namespace {

/// Keys, or words, by the kind of place where they stand.
using Vocabulary = std::map<std::string, std::set<std::string>>;

/// Returns the kind of place that a JSON pointer leads to: * stands for the index or the name of one of many.
/// A nested surface has the kind of the surface that contains it, and a nested field that of the outer field.
std::string kind_of(const std::string& pointer) {
  std::string kind;
  std::istringstream steps(pointer);
  steps.get();  // the first slash
  for (std::string step; std::getline(steps, step, '/');)
    if (step == "surfaces" || step == "fields")
      std::getline(steps, step, '/');
    else if ((step != "surface" && step != "field") || !kind.ends_with('/' + step))
      kind += '/' + (kind == "/materials" || (step[0] >= '0' && step[0] <= '9') ? "*" : step);
  return kind;
}

/// Returns the names in a message's list, "a, b and c" or "a, b or c". An object at its end is no name.
std::set<std::string> list_in(const std::string& error) {
  std::set<std::string> names;
  std::string name;
  std::istringstream words(error);
  while (words >> name) {
    if (name.starts_with('{')) break;
    std::erase_if(name, [](char c) { return c == ',' || c == '"'; });
    if (name != "and" && name != "or") names.insert(name);
  }
  return names;
}

/// Adds to `allowed` the keys and words that a file may have at its places, which the reader lists when it is
/// given others, and to `used` those that the file has there.
void look_at(const fs::path& path, const std::string& text, Vocabulary& allowed, Vocabulary& used) {
  const json scene = json::parse(text), flat = scene.flatten();
  const auto list_after = [&](const json& wrong, const std::string& before) {
    const std::string error =
        message_of<SceneError>([&] { static_cast<void>(scene_from_json(wrong.dump(), path.string())); });
    CAPTURE(error);
    const std::size_t begin = error.find(before);
    REQUIRE(begin != std::string::npos);
    return list_in(error.substr(begin + before.size()));
  };

  std::set<std::string> objects;
  for (const auto& [pointer, value] : flat.items()) {
    for (json::json_pointer in(pointer); !in.empty();) {
      in = in.parent_pointer();
      if (scene[in].is_object()) objects.insert(in.to_string());
    }
    const bool is_name = pointer.ends_with("/material-id") || pointer.ends_with("/image") ||
                         pointer.ends_with("/file") || pointer.ends_with("/environment");
    if (!value.is_string() || is_name) continue;
    json wrong = scene;
    wrong[json::json_pointer(pointer)] = "?";
    allowed[kind_of(pointer)].merge(list_after(wrong, "\"?\" is not "));
    used[kind_of(pointer)].insert(value);
  }
  objects.erase("/materials");  // its keys are names
  for (const std::string& pointer : objects) {
    json wrong = scene;
    wrong[json::json_pointer(pointer)]["?"] = 0;
    std::set<std::string> keys = list_after(wrong, "/?: is not a key here; allowed are ");
    // Objects that may have the same keys are one kind of place, as all spheres are, also those that cannot
    // move, as they are parts of other surfaces. Lights are one kind together, since the keys that one may
    // have depend on those that it has.
    std::string kind = kind_of(pointer);
    if (kind != "/lights/*")
      for (const std::string& key : keys)
        if (key != "velocity") kind += ' ' + key;
    allowed[kind].merge(keys);
    for (const auto& [key, value] : scene[json::json_pointer(pointer)].items()) used[kind].insert(key);
  }
}

}  // namespace

TEST_CASE("every key and word of a scene file has an example in a scene of the project, and is documented") {
  Vocabulary allowed, used, elsewhere;
  look_at("scene.json", scene_of_everything, allowed, elsewhere);
  for (const auto& entry : fs::directory_iterator(scenes_folder))
    if (entry.path().extension() == ".json") look_at(entry.path(), bytes_of(entry.path()), allowed, used);
  const std::string docs = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "scene-format.md");
  int count = 0;
  for (const auto& [kind, words] : allowed)
    for (const std::string& word : words) {
      CAPTURE(kind, word);
      // These stand alone, so that an object that has them may have no other key of the list.
      const bool stands_alone = word == "matrix" || word == "image";
      const std::string place = kind.substr(0, kind.find(' '));
      CHECK(std::any_of(used.begin(), used.end(), [&](const auto& one) {
        return one.second.contains(word) &&
               (one.first == kind || (stands_alone && one.first.starts_with(place + ' ')));
      }));
      CHECK((docs.find('`' + word + '`') != std::string::npos ||
             docs.find('"' + word + '"') != std::string::npos));
      ++count;
    }
  CHECK(count > 60);
}

TEST_CASE("the examples in the documentation of scene files can be read") {
  std::ifstream page(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "scene-format.md");
  std::vector<std::string> examples;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```json") examples.emplace_back();
    if (inside && line != "```") examples.back() += line + "\n";
    inside = line == "```json" || (inside && line != "```");
  }
  REQUIRE(!examples.empty());
  for (const std::string& example : examples) {
    INFO(example);
    CHECK(scene_error(example) == "");
  }
}

TEST_CASE("the errors and the limits in the documentation of scene files agree with the reader") {
  const std::string docs = bytes_of(fs::path(PROTOSTAR_SOURCE_DIR) / "docs" / "scene-format.md");
  const std::string sphere =
      R"({"surface": {"type": "sphere", "position": [0, 0, 0], "radius": -1}, "color": [1, 1, 1]})";
  for (const std::string& text : {scene_with("/objects/3", sphere), std::string("{\n  \"a\": 1,\n}")})
    CHECK_THAT(docs, ContainsSubstring("\nrender: " + scene_error(text) + "\n"));
  CHECK_THAT(docs, ContainsSubstring("from 1 to " + std::to_string(most_depth)));
  CHECK_THAT(docs, ContainsSubstring("from 0 to " + std::to_string(most_samples)));
  CHECK_THAT(docs, ContainsSubstring("`depth` at most " + std::to_string(most_depth)));
  CHECK_THAT(docs, ContainsSubstring("`samples` at most " + std::to_string(most_samples)));
  CHECK_THAT(docs, ContainsSubstring("at most 2^24 values in a file"));
  CHECK(protostar::detail::most_values == 1 << 24);
  CHECK_THAT(docs, ContainsSubstring("an image of at most 2^26 pixels"));
  CHECK(most_image_pixels == 1 << 26);
  CHECK_THAT(docs, ContainsSubstring("together 2^28"));
  CHECK(ReadOptions{}.most_pixels == 1 << 28);
}
