#include <CLI/CLI.hpp>
#include <protostar/version.hpp>
#include <string>

#include "option_values.hpp"
#include "options.hpp"

std::optional<MergeOptions> parse_merge_options(int argc, const char* const* argv, const std::string& program,
                                                int& status) {
  MergeOptions merge;
  merge.options.program = program;
  merge.options.work = "merged";
  std::string output;
  std::vector<std::string> shards;
  FileOptions file;
  CLI::App app("Makes the picture of which .shard files have all parts (docs/many_machines.md).", program);
  app.set_version_flag("--version", std::string("protostar ") + PROTOSTAR_VERSION);
  app.add_option("OUT", output, "The picture's file: .ppm, .png, or .pfm and .hdr for the linear light")
      ->required()
      ->type_name("");
  app.add_option("SHARD", shards, "The parts, in any order, as --shard has written them")
      ->required()
      ->type_name("");
  file.add_to(app, "the scene's", "");
  app.add_flag("--quiet", merge.options.quiet, "Print nothing but errors");
  set_failure_message(app);
  try {
    parse(app, argc, argv);
    merge.options.output = output;
    merge.options.format = format_of(merge.options.output, "OUT");
    merge.own_transfer = file.read(app, merge.options);
    merge.shards.assign(shards.begin(), shards.end());
    return merge;
  } catch (const CLI::ParseError& message) {
    status = app.exit(message) == 0 ? 0 : 2;  // prints the message
    return std::nullopt;
  }
}
