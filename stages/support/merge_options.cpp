#include <string>

#include "command_line.hpp"
#include "option_values.hpp"
#include "options.hpp"
#include "picture_file.hpp"

std::optional<MergeOptions> parse_merge_options(int argc, const char* const* argv, const std::string& program,
                                                int& status) {
  MergeOptions merge;
  merge.options.program = program;
  merge.options.work = "merged";
  std::string output;
  std::vector<std::string> shards;
  FileOptions file;
  CommandLine line("Makes the picture of which .shard files have all parts (docs/many_machines.md).",
                   program);
  line.add_word("OUT", output, "", "The picture's file: " + std::string(format_endings));
  line.add_words("SHARD", shards, "The parts, in any order, as --shard has written them");
  file.add_to(line, "the scene's", "");
  line.add_flag("--quiet", merge.options.quiet, "Print nothing but errors");
  try {
    if (!line.read(argc, argv)) return std::nullopt;
    merge.options.output = output;
    merge.options.format = format_of(merge.options.output, "OUT");
    merge.own_transfer = file.read(line, merge.options);
    merge.shards.assign(shards.begin(), shards.end());
    refuse_replacing("OUT", merge.options.output, merge.shards, "the parts");
    return merge;
  } catch (const UsageError& error) {
    print_usage_error(program, error);
    status = 2;
    return std::nullopt;
  }
}
