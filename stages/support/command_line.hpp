// Reads the words of a command line as options, and lists the options for --help. There are two sources of
// this class: command_line.cpp, and that of the browser (docs/web).
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// Error in the use of a program, which its user can correct.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;

  /// Takes the option at fault, and what is wrong with it.
  UsageError(const std::string& option, const std::string& error) : runtime_error(option + ": " + error) {}
};

/// Command line of a program: the options and words that it takes, and those that are given. Each program
/// also takes -h, --help and --version.
///
/// An option is given as --name VALUE, --name=VALUE, or -n VALUE and -nVALUE if its name is one letter. The
/// word after an option is its value, whatever it looks like. Flags have no value, and may be repeated. After
/// -- no word is an option.
class CommandLine {
 public:
  /// Takes the description, a sentence for --help, and the name of the program.
  CommandLine(const std::string& description, const std::string& program);
  ~CommandLine();

  /// Declares an option with a value. `type` names the value for --help, which leaves out options without a
  /// text: those that a program knows only to say why it refuses them.
  void add_option(const std::string& name, std::string& value, const std::string& type,
                  const std::string& help);

  /// Declares an option without a value.
  void add_flag(const std::string& name, bool& flag, const std::string& help);

  /// Declares a word that has to be given, after those declared before.
  void add_word(const std::string& name, std::string& word, const std::string& type, const std::string& help);

  /// Declares words, of which one at least has to be given, after all others.
  void add_words(const std::string& name, std::vector<std::string>& words, const std::string& help);

  /// Reads the words into what has been declared. Returns false if it has printed the help or the version
  /// that was asked for. Throws UsageError.
  bool read(int argc, const char* const* argv);

  /// Returns true if read() has found an option.
  bool given(const std::string& name) const;

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};
