// Values of options that several command lines have, and usage errors.
#pragma once

#include <filesystem>
#include <optional>
#include <protostar/encode.hpp>
#include <string>
#include <string_view>

#include "command_line.hpp"
#include "options.hpp"

/// Returns an argument of the command line in quotes, shortened to leave room in an error message.
std::string found_text(std::string_view text);

/// Prints a usage error to stderr: one line that names the program, and a second one.
void print_usage_error(const std::string& program, const UsageError& error);

/// Throws a usage error, which names the option, the value found and the values allowed.
[[noreturn]] void refuse(const std::string& option, std::string_view found, const std::string& allowed);

/// Reads the value of --transfer; throws a usage error for any other text. name_of returns the text of one.
protostar::Transfer read_transfer(std::string_view text);
std::string name_of(const protostar::Transfer& transfer);

/// Reads a whole number for which is_allowed is true; throws a usage error with `allowed`, the words for
/// these numbers, for any other text.
int read_whole(const std::string& option, std::string_view text, bool (*is_allowed)(int),
               const std::string& allowed);

/// Returns true if the name of a file ends so, in upper or lower case.
bool ends_in(const std::filesystem::path& path, std::string_view ending);

/// Options of the file of a picture: --bits, --transfer and --plain.
struct FileOptions {
  std::string bits = {}, transfer = {};
  bool plain = false;

  /// Adds these options to a command line, with these texts for what holds without them.
  void add_to(CommandLine& line, const std::string& default_transfer, const std::string& default_plain);

  /// Reads the options but the transfer, which it returns if it is given. An option that the format cannot
  /// follow is refused, not ignored.
  std::optional<protostar::Transfer> read(const CommandLine& line, Options& options) const;
};
