#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <protostar/version.hpp>

#include "option_values.hpp"

struct CommandLine::Reader {
  CLI::App app;
};

CommandLine::CommandLine(const std::string& description, const std::string& program)
    : reader_(new Reader{.app = CLI::App(description, program)}) {
  reader_->app.set_version_flag("--version", std::string("protostar ") + PROTOSTAR_VERSION);
}

CommandLine::~CommandLine() = default;

void CommandLine::add_option(const std::string& name, std::string& value, const std::string& type,
                             const std::string& help) {
  CLI::Option* const option = reader_->app.add_option(name, value, help)->type_name(type);
  if (help.empty()) option->group("");
}

void CommandLine::add_flag(const std::string& name, bool& flag, const std::string& help) {
  reader_->app.add_flag(name, flag, help);
}

void CommandLine::add_word(const std::string& name, std::string& word, const std::string& type,
                           const std::string& help) {
  reader_->app.add_option(name, word, help)->type_name(type)->required();
}

void CommandLine::add_words(const std::string& name, std::vector<std::string>& words,
                            const std::string& help) {
  reader_->app.add_option(name, words, help)->type_name("")->required();
}

bool CommandLine::given(const std::string& name) const {
  const CLI::Option* option = reader_->app.get_option_no_throw(name);
  return option && option->count() > 0;
}

/// Refuses values that CLI11 misreads: --name= takes the next argument as its value, and a flag with a value,
/// --help=3, counts as that many flags.
static void refuse_wrong_values(const CLI::App& app, int argc, const char* const* argv) {
  for (int i = 1; i < argc && argv[i] != std::string_view("--"); ++i) {
    const std::string_view argument = argv[i];
    const std::size_t equals = argument.find('=');
    if (!argument.starts_with('-') || equals == std::string_view::npos) continue;
    const std::string name(argument.substr(0, equals));
    const CLI::Option* option = app.get_option_no_throw(name);
    if (option && option->get_items_expected_max() == 0)
      throw UsageError(name + " takes no value: " + found_text(argument));
    if (option && equals == argument.size() - 1)
      throw UsageError(name + ": a value is missing: " + found_text(argument));
  }
}

/// Returns the error for arguments that nothing takes, in the order in which they are given; CLI11 counts the
/// -- before words among them.
static std::string unexpected_text(std::vector<std::string> arguments) {
  const auto separator = std::find(arguments.begin(), arguments.end(), "--");
  if (separator != arguments.end()) arguments.erase(separator);
  std::string list;
  for (const std::string& argument : arguments) list += " " + found_text(argument);
  return std::string("The following argument") + (arguments.size() > 1 ? "s were" : " was") +
         " not expected:" + list;
}

bool CommandLine::read(int argc, const char* const* argv) {
  CLI::App& app = reader_->app;
  refuse_wrong_values(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& message) {
    app.exit(message);  // prints the help or the version
    return false;
  } catch (const CLI::ExtrasError&) {
    throw UsageError(unexpected_text(app.remaining()));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return true;
}
