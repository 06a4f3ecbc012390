// CommandLine of the stages in a browser, without the library that reads the command line elsewhere, whose
// code would be an eighth of a stage's module.
#include "stages/support/command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <protostar/version.hpp>
#include <utility>

#include "stages/support/message.hpp"
#include "stages/support/option_values.hpp"

/// Returns true for a word that begins with - or -- and a letter.
static bool is_option(std::string_view word) {
  if (!word.starts_with('-')) return false;
  word.remove_prefix(word.starts_with("--") ? 2 : 1);
  return !word.empty() && ((word[0] >= 'a' && word[0] <= 'z') || (word[0] >= 'A' && word[0] <= 'Z'));
}

/// Options and words that a program takes.
struct CommandLine::Reader {
  struct Item {
    std::string name, type, help;
    std::string* value = nullptr;               ///< of an option with one, or of a word
    bool* flag = nullptr;                       ///< of an option without a value; none for help and version
    std::vector<std::string>* words = nullptr;  ///< of several words
    int count = 0;                              ///< how often it is given

    bool is_word() const { return !name.starts_with('-'); }
    bool is_flag() const { return value == nullptr && words == nullptr; }
  };

  std::string description, program;
  std::vector<Item> items = {};
  std::vector<std::string> unexpected = {};

  Item* option(std::string_view name);
  void refuse_wrong_values(int argc, const char* const* argv);
  void read_option(std::vector<std::string>& rest);
  void read_word(const std::string& word);
  bool read(int argc, const char* const* argv);
  bool given(std::string_view name) const;
  std::string help() const;
};

CommandLine::CommandLine(const std::string& description, const std::string& program)
    : reader_(new Reader{.description = description, .program = program}) {
  reader_->items.push_back({.name = "--help", .type = {}, .help = "Print this help message and exit"});
  reader_->items.push_back(
      {.name = "--version", .type = {}, .help = "Display program version information and exit"});
}

CommandLine::~CommandLine() = default;

void CommandLine::add_option(const std::string& name, std::string& value, const std::string& type,
                             const std::string& help) {
  reader_->items.push_back({.name = name, .type = type, .help = help, .value = &value});
}

void CommandLine::add_flag(const std::string& name, bool& flag, const std::string& help) {
  reader_->items.push_back({.name = name, .type = {}, .help = help, .flag = &flag});
}

void CommandLine::add_word(const std::string& name, std::string& word, const std::string& type,
                           const std::string& help) {
  add_option(name, word, type, help);
}

void CommandLine::add_words(const std::string& name, std::vector<std::string>& words,
                            const std::string& help) {
  reader_->items.push_back({.name = name, .type = {}, .help = help, .words = &words});
}

bool CommandLine::given(const std::string& name) const { return reader_->given(name); }

bool CommandLine::read(int argc, const char* const* argv) { return reader_->read(argc, argv); }

CommandLine::Reader::Item* CommandLine::Reader::option(std::string_view name) {
  if (name == "-h") name = "--help";
  const auto found = std::find_if(items.begin(), items.end(),
                                  [&](const Item& item) { return !item.is_word() && item.name == name; });
  return found == items.end() ? nullptr : &*found;
}

bool CommandLine::Reader::given(std::string_view name) const {
  return std::any_of(items.begin(), items.end(),
                     [&](const Item& item) { return item.name == name && item.count > 0; });
}

/// Refuses --flag=VALUE and --name=, wherever they stand before --.
void CommandLine::Reader::refuse_wrong_values(int argc, const char* const* argv) {
  for (int i = 1; i < argc && argv[i] != std::string_view("--"); ++i) {
    const std::string_view argument = argv[i];
    const std::size_t equals = argument.find('=');
    if (!argument.starts_with('-') || equals == std::string_view::npos) continue;
    const std::string name(argument.substr(0, equals));
    const Item* const known = option(name);
    if (known && known->is_flag()) throw UsageError(name + " takes no value: " + found_text(argument));
    if (known && equals == argument.size() - 1)
      throw UsageError(name + ": a value is missing: " + found_text(argument));
  }
}

/// Reads the last of these words, which begins with '-', and the word before it if that is its value.
void CommandLine::Reader::read_option(std::vector<std::string>& rest) {
  const std::string word = std::move(rest.back());
  rest.pop_back();
  const bool is_long = word.starts_with("--");
  const std::size_t equals = is_long ? word.find('=') : std::string::npos;
  Item* const item = option(word.substr(0, is_long ? equals : 2));
  if (item == nullptr) return unexpected.push_back(word);
  ++item->count;
  if (item->is_flag()) {
    if (item->flag) *item->flag = true;
    if (!is_long && word.size() > 2) rest.push_back("-" + word.substr(2));  // -hq is -h -q
  } else if (equals != std::string::npos) {
    *item->value = word.substr(equals + 1);
  } else if (!is_long && word.size() > 2) {
    *item->value = word.substr(2);
  } else if (!rest.empty()) {
    *item->value = std::move(rest.back());
    rest.pop_back();
  } else {
    throw UsageError(item->name + ": 1 required " + item->type + " missing");
  }
}

void CommandLine::Reader::read_word(const std::string& word) {
  for (Item& item : items)
    if (item.is_word() && (item.words || item.count == 0)) {
      if (item.words)
        item.words->push_back(word);
      else
        *item.value = word;
      ++item.count;
      return;
    }
  unexpected.push_back(word);
}

bool CommandLine::Reader::read(int argc, const char* const* argv) {
  refuse_wrong_values(argc, argv);
  std::vector<std::string> rest;  // the next one last
  for (int i = argc - 1; i > 0; --i) rest.emplace_back(argv[i]);
  bool words_only = false;
  while (!rest.empty()) {
    const std::string& next = rest.back();
    if (!words_only && next == "--") {
      words_only = true;
      rest.pop_back();
    } else if (!words_only && is_option(next)) {
      read_option(rest);
    } else {
      const std::string word = next;
      rest.pop_back();
      read_word(word);
    }
  }

  const auto print_text = [](const std::string& text) { std::fputs(text.c_str(), stdout); };
  if (given("--version")) return print_text("protostar " PROTOSTAR_VERSION "\n"), false;
  for (const Item& item : items)
    if (item.value && item.count > 1)
      throw UsageError(item.name + ": At Most 1 required but received " + std::to_string(item.count));
  if (given("--help")) return print_text(help()), false;
  for (const Item& item : items)
    if (item.is_word() && item.count == 0) throw UsageError(item.name + " is required");
  if (unexpected.empty()) return true;
  std::string list;
  for (const std::string& word : unexpected) list += " " + found_text(word);
  throw UsageError(std::string("The following argument") + (unexpected.size() > 1 ? "s were" : " was") +
                   " not expected:" + list);
}

std::string CommandLine::Reader::help() const {
  const std::size_t column = 30;  // of the explanations
  std::string usage = description + "\nUsage: " + program + " [OPTIONS]", words, options;
  for (const Item& item : items) {
    if (item.help.empty()) continue;
    std::string line = "  " + (item.name == "--help" ? "-h," : std::string()) + item.name;
    if (!item.type.empty()) line += " " + item.type;
    if (item.words) line += " ...";
    if (item.is_word()) line += " REQUIRED";
    if (line.size() >= column)
      line += "\n" + std::string(column, ' ');
    else
      line.resize(column, ' ');
    line += item.help + "\n";
    (item.is_word() ? words : options) += line;
    if (item.is_word()) usage += " " + item.name + (item.words ? "..." : "");
  }
  if (!words.empty()) words = "\nPositionals:\n" + words;
  return usage + "\n" + words + "\nOptions:\n" + options + "\n";
}
