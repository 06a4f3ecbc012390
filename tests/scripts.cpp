// Scripts of the project: what each prints about itself.
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path source_folder = PROTOSTAR_SOURCE_DIR;

/// Returns the paths of all scripts, inside the project: files that begin with #! and the path of env.
std::vector<std::string> scripts() {
  std::vector<std::string> found;
  for (const char* const folder : {".ci", "docs", "scenes", "stages", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(source_folder / folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::string line;
      if (std::getline(file, line) && line.starts_with("#!/usr/bin/env "))
        found.push_back(entry.path().lexically_relative(source_folder).generic_string());
    }
  return found;
}

}  // namespace

TEST_CASE("each script tells how it is called if it is asked to by --help or -h, and does nothing else") {
  const std::vector<std::string> all = scripts();
  CHECK(all.size() >= 30);
  const TemporaryFolder folder;
  for (const std::string& script : all) {
    CAPTURE(script);
    std::string told;
    for (const std::string word : {"--help", "-h"}) {
      const auto temporary_files_here = [&] { ::setenv("TMPDIR", (folder / "").c_str(), 1); };
      const Outcome outcome = run({.program = source_folder / script,
                                   .arguments = {word},
                                   .folder = folder / "",
                                   .before = temporary_files_here});
      if (outcome.status == 127 && outcome.err.find("env: ") != std::string::npos) {
        WARN("not tested: the interpreter of " << script << " is not installed");
        continue;
      }
      CHECK(outcome.status == 0);
      CHECK(outcome.err.empty());
      CHECK_THAT(outcome.out, ContainsSubstring(script));
      if (word == "-h") CHECK(outcome.out == told);
      told = outcome.out;
    }
    CHECK(folder.count() == 0);
  }
}

TEST_CASE("a check that finds nothing to look at is no success") {
  const TemporaryFolder folder;
  const Outcome comments = run(
      {.program = source_folder / "docs/check_comments", .arguments = {folder / ""}, .folder = folder / ""});
  if (comments.status == 127)
    WARN("not tested: python3 is not installed");
  else
    CHECK((comments.status == 2 && comments.err.starts_with("docs/check_comments: no comments in ")));

  // A project without results of plain ray tracers in its pages.
  fs::create_directories(folder / "tests/plain");
  fs::create_directories(folder / "docs/stages");
  fs::copy_file(source_folder / "tests/plain/check", folder / "tests/plain/check");
  put_bytes(folder / "docs/stages/01_gradient.md", "# Gradient\n");
  const Outcome plain = run({.program = folder / "tests/plain/check",
                             .arguments = {"g++", "compare_images", "work"},
                             .folder = folder / ""});
  if (plain.status == 77)
    WARN("not tested: " << plain.out);
  else
    CHECK((plain.status == 1 && plain.err == "FAILED: no page has a line <!-- plain: NAME -->\n"));
}

TEST_CASE("bench_compile writes its table where it is called, not where the headers are") {
  const TemporaryFolder folder;
  const Outcome outcome =
      run({.program = source_folder / "tests/bench/bench_compile",
           .arguments = {"--quick", "--csv", "a.csv"},
           .folder = folder / "",
           .before = [] { ::setenv("CXX", "true", 1); }});  // a compiler that does nothing
  CHECK(outcome.status == 0);
  const std::string table = bytes_of(folder / "a.csv");
  CHECK(table.starts_with("file,seconds\naccel/accelerate.hpp,"));
}

TEST_CASE("no script takes an unknown option for a file or a number") {
  const TemporaryFolder folder;
  const auto [script, usage] =
      GENERATE(std::pair{"docs/check_comments", "docs/check_comments [--list] [FILE or FOLDER ...]"},
               std::pair{"docs/web/build", "docs/web/build [BUILD [MODULE... [STAGE...]]]"},
               std::pair{"docs/web/serve", "docs/web/serve [PORT [BUILD]]"},
               std::pair{"tests/bench/figures", "tests/bench/figures [BUILD [NAME...]]"},
               std::pair{"tests/bits/run", "tests/bits/run [--all] FOLDER [FLAG...]"},
               std::pair{"tests/cost", "tests/cost"},
               std::pair{"tests/fuzz/run", "tests/fuzz/run [SECONDS [FOLDER [SEED]]]"});
  CAPTURE(script);
  const auto outcome_of = [&, program = source_folder / script](const std::string& word) {
    return run({.program = program, .arguments = {word}, .folder = folder / ""});
  };
  const Outcome help = outcome_of("--help");
  if (help.status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  CHECK(help.status == 0);
  CHECK_THAT(help.out, ContainsSubstring(usage));
  CHECK(outcome_of("-h").out == help.out);
  const Outcome bogus = outcome_of("--bogus");
  CHECK(bogus.status == 2);
  CHECK(bogus.out.empty());
  CHECK_THAT(bogus.err, ContainsSubstring(std::string("there is no option --bogus; usage: ") + usage));
  CHECK(folder.count() == 0);
}
