// Words of a command line as options, flags and words: how they are told apart, and what is refused.
#include <string>
#include <vector>

#include "stages/support/command_line.hpp"
#include "support/catch.hpp"

namespace {

/// What a program with an option of each kind reads from a command line.
struct ReadWords {
  std::string out = "none", size = "none", error = {};
  bool quiet = false, plain = false;
  std::string word = {};
  std::vector<std::string> words = {};
};

ReadWords words_read(std::vector<const char*> arguments, bool has_words = true) {
  ReadWords read;
  CommandLine line("Draws.", "program");
  line.add_option("-o", read.out, "FILE", "A file");
  line.add_option("--size", read.size, "WxH", "A size");
  line.add_flag("--quiet", read.quiet, "Print less");
  line.add_flag("-p", read.plain, "Plain");
  if (has_words) {
    line.add_word("OUT", read.word, "", "A word");
    line.add_words("PART", read.words, "Words");
  }
  arguments.insert(arguments.begin(), "program");
  try {
    const bool goes_on = line.read(static_cast<int>(arguments.size()), arguments.data());
    CHECK(goes_on);
  } catch (const UsageError& error) {
    read.error = error.what();
  }
  return read;
}

}  // namespace

TEST_CASE("an option takes its value after a blank, after =, or after its letter") {
  CHECK(words_read({"-o", "a", "--size", "2x3"}, false).out == "a");
  CHECK(words_read({"-oa"}, false).out == "a");
  CHECK(words_read({"-o=a"}, false).out == "=a");
  CHECK(words_read({"--size=2x3"}, false).size == "2x3");
  CHECK(words_read({"--size=2=3"}, false).size == "2=3");
  CHECK(words_read({"--size", ""}, false).size.empty());
}

TEST_CASE("a word after an option is its value, whatever it looks like") {
  for (const std::string value : {"--quiet", "--", "-5", "-", "-p"}) {
    const ReadWords read = words_read({"--size", value.c_str()}, false);
    CHECK(read.size == value);
    CHECK((!read.quiet && !read.plain && read.error.empty()));
  }
}

TEST_CASE("flags of one letter may be one word, also before an option, and flags may be repeated") {
  const ReadWords read = words_read({"-poa", "-p", "--quiet", "--quiet"}, false);
  CHECK((read.plain && read.quiet && read.out == "a" && read.error.empty()));
}

TEST_CASE("words are those without a letter after - or --, and all that come after --") {
  const ReadWords read = words_read({"-", "-5", "--quiet", "--", "--size", "-o", "--"});
  CHECK(read.error.empty());
  CHECK(read.quiet);
  CHECK(read.word == "-");
  CHECK(read.words == std::vector<std::string>{"-5", "--size", "-o", "--"});
  CHECK(read.size == "none");
}

TEST_CASE("an error in usage names the words that are wrong") {
  CHECK(words_read({"--bogus"}, false).error == "The following argument was not expected: '--bogus'");
  CHECK(words_read({"-x", "a", "--", "-o"}, false).error ==
        "The following arguments were not expected: '-x' 'a' '-o'");
  CHECK(words_read({"--siz=3"}, false).error == "The following argument was not expected: '--siz=3'");
  CHECK(words_read({"--size"}, false).error == "--size: 1 required WxH missing");
  const std::string twice = words_read({"-o", "a", "-ob"}, false).error;  // newer versions of CLI11: At most
  CHECK(
      (twice == "-o: At Most 1 required but received 2" || twice == "-o: At most 1 required but received 2"));
  CHECK(words_read({"--size="}, false).error == "--size: a value is missing: '--size='");
  CHECK(words_read({"--quiet=1"}, false).error == "--quiet takes no value: '--quiet=1'");
  CHECK(words_read({"-h=1"}, false).error == "-h takes no value: '-h=1'");
  CHECK(words_read({}).error == "OUT is required");
  CHECK(words_read({"a"}).error == "PART is required");
  CHECK(words_read({"--", "--size="}, false).error == "The following argument was not expected: '--size='");
}
