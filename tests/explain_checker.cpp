// Explanations that docs/check_explanation has to refuse.
#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/run_stage.hpp"

TEST_CASE("docs/check_explanation refuses what no step of the light depends on") {
  const TemporaryFolder folder;
  const auto checker = std::filesystem::path(PROTOSTAR_SOURCE_DIR) / "docs" / "check_explanation";
  if (run({.program = checker, .arguments = {"--help"}, .folder = folder / ""}).status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  struct Row {
    std::string stage, from, to;
    int status;
    std::string message;
  };
  const std::string lamp = "\"area_lights\": [\n    {\n      \"surface\": ";
  const std::vector<Row> rows{
      Row{"13_whitted", "\"type\": \"ConstantLight\"", "\"type\": \"Light\"", 1, "/type must be that"},
      Row{"09_shadow", "\"radiance\": null", "\"radiance\": 1", 1, "/radiance must be null"},
      Row{"24_path", "\"radiance\": null", "\"radiance\": [1, 1, 1]", 1, "/radiance must be null"},
      Row{"24_path", lamp + "3", lamp + "4", 1, "/area_lights/0/surface must name a surface"},  // a plane
      Row{"24_path", "_has_places\": false", "_has_places\": 0", 2, "must be true or false"},
  };
  for (const auto& [stage, from, to, status, message] :
       of_built_stages(rows, [](const Row& row) { return row.stage; })) {
    CAPTURE(stage, from);
    CHECK(run_stage(stage, "--size 160x120 --samples 1 --pixel 80,90 --explain a.json --quiet", folder).out ==
          "");
    std::string text = bytes_of(folder / "a.json");
    const auto check = [&] {
      return run({.program = checker, .arguments = {"a.json"}, .folder = folder / ""});
    };
    CHECK(check().status == 0);
    const std::size_t at = text.rfind(from);
    REQUIRE(at != std::string::npos);
    put_bytes(folder / "a.json", text.replace(at, from.size(), to));
    const Outcome outcome = check();
    CHECK(outcome.status == status);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  }
}
