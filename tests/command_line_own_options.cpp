// Options that only some stages have: --epsilon, --offset and --show.
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_stage.hpp"

TEST_CASE("the option --epsilon takes finite numbers above 0, and a march with a proof has no such option") {
  const TemporaryFolder folder;
  for (const std::string stage : {"30_fixed_step", "31_sphere_tracing", "32_enhanced"}) {
    CAPTURE(stage);
    CHECK(run_stage(stage, "--size 16x12 --epsilon 0.5", folder).status == 0);
    for (const std::string value : {"0", "-1", "nan", "inf", "1e400", "x"}) {
      const Outcome outcome = run_stage(stage, "--size 16x12 --epsilon " + value, folder);
      CAPTURE(value);
      CHECK(outcome.status == 2);
      CHECK_THAT(outcome.err, ContainsSubstring("'" + value + "' is not a finite number greater than 0"));
    }
  }
  const std::vector<std::string> certified{"33_certified", "37_marched_shadow"};
  for (const std::string& stage : of_built_stages(certified, std::identity{}))
    CHECK(run_stage(stage, "--size 16x12 --epsilon 0.5", folder).status == 2);
}

TEST_CASE("the option --offset takes numbers that a float holds") {
  const TemporaryFolder folder;
  for (const std::string stage : {"08_naive", "09_naive"}) {
    CAPTURE(stage);
    for (const std::string value : {"0", "-1", "3.4e38"})
      CHECK(run_stage(stage, "--size 16x12 --offset " + value, folder).status == 0);
    for (const std::string value : {"nan", "inf", "1e39", "-1e400", "x"}) {
      const Outcome outcome = run_stage(stage, "--size 16x12 --offset " + value, folder);
      CAPTURE(value);
      CHECK(outcome.status == 2);
      CHECK_THAT(outcome.err,
                 ContainsSubstring("--offset: '" + value + "' is not a number of at most 3.4e38 "));
    }
  }
}

TEST_CASE("the option --help tells what an option of a stage's own is by default") {
  const TemporaryFolder folder;
  for (const auto& [stage, text] :
       {std::pair<std::string, std::string>{"08_naive", "in scene units [0.0001]"},
        {"09_naive", "in scene units [0.0001]"},
        {"30_fixed_step", "in scene units [0.25]"},
        {"31_sphere_tracing", "in scene units [0.001]"}}) {
    CAPTURE(stage);
    CHECK_THAT(stage_help(stage, folder), ContainsSubstring(text));
  }
}

TEST_CASE("the option --show chooses among the integrators of a stage that has several") {
  struct Row {
    std::string stage, name;
  };
  const std::vector<Row> rows{{"33_certified", "evaluations"},
                              {"33_certified", "enclosure-width"},
                              {"37_marched_shadow", "distance-occlusion"},
                              {"37_marched_shadow", "distance-shadow"},
                              {"37_marched_shadow", "ambient-occlusion"},
                              {"37_marched_shadow", "direct"},
                              {"38_fractal", "evaluations"}};
  const TemporaryFolder folder;
  for (const auto& [stage, name] : of_built_stages(rows, [](const Row& row) { return row.stage; })) {
    CAPTURE(stage, name);
    const Outcome outcome = run_stage(stage, "--size 16x12 --show " + name, folder);
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.out, ContainsSubstring(name));
  }
  for (const std::string& stage : of_built_stages(std::vector<std::string>{"38_fractal"}, std::identity{})) {
    const Outcome unknown = run_stage(stage, "--show width", folder);
    CHECK(unknown.status == 2);
    CHECK_THAT(unknown.err, ContainsSubstring("'width' is not one of shadow, evaluations"));
  }
  CHECK(run_stage("07_diffuse", "--show evaluations", folder).status == 2);
}
