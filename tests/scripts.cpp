// Scripts of the project: what each prints about itself.
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path project = PROTOSTAR_SOURCE_DIR;

/// Returns the paths of all scripts, inside the project: files that begin with #! and the path of env.
std::vector<std::string> scripts() {
  std::vector<std::string> found;
  for (const char* const folder : {".ci", "docs", "scenes", "stages", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(project / folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::string line;
      if (std::getline(file, line) && line.starts_with("#!/usr/bin/env "))
        found.push_back(entry.path().lexically_relative(project).generic_string());
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
      const Outcome outcome = run({.program = project / script,
                                   .arguments = {word},
                                   .folder = folder / "",
                                   .before = temporary_files_here});
      if (outcome.status == 127 && outcome.err.starts_with("/usr/bin/env: ")) {
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
