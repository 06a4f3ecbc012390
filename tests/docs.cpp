// Checks of the documentation: its code is that of the sources, and its links and pictures lead to files.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <protostar/encode.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path repository = PROTOSTAR_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  REQUIRE(fs::is_regular_file(path));
  return bytes_of(path);
}

std::vector<fs::path> documents() {
  std::vector<fs::path> found{repository / "README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(repository / "docs"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

/// Returns the names of the stages, such as 09_shadow.
std::vector<std::string> stages() {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(repository / "stages"))
    if (entry.path().extension() == ".cpp" && entry.path().stem() != "render" &&  // it draws any scene
        entry.path().stem() != "merge")                                           // it draws none
      found.push_back(entry.path().stem().string());
  std::sort(found.begin(), found.end());
  return found;
}

/// Returns each text between `open` and the next `close`.
std::vector<std::string> all_between(const std::string& text, const std::string& open,
                                     const std::string& close) {
  std::vector<std::string> found;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    found.push_back(text.substr(at, text.find(close, at) - at));
  }
  return found;
}

/// A document, split into prose and fenced blocks.
struct Document {
  std::string prose;                // all that is not in a fenced block
  std::vector<std::string> fences;  // the languages of the fenced blocks, in order
};

Document document(const fs::path& path) {
  Document parts;
  std::istringstream lines(text_of(path));
  bool in_block = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      if (!in_block) parts.fences.push_back(line.substr(3));
      in_block = !in_block;
    } else if (!in_block) {
      parts.prose += line + '\n';
    }
  }
  return parts;
}

std::string quoted(const fs::path& path) {
  const std::string name = path.string();
  return "'" + name + "'";
}

/// Runs a program through the shell; returns its exit status, or −1 if it did not exit.
int run_script(const fs::path& program, const std::string& arguments) {
  const int status = std::system((quoted(program) + " " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// A temporary project: the files that a test writes, and a copy of the script docs/embed_code.
class Project {
 public:
  Project() {
    fs::create_directory(folder_ / "docs");
    fs::copy_file(repository / "docs" / "embed_code", folder_ / "docs/embed_code");
    write("README.md", "Nothing to embed.\n");
  }

  void write(const std::string& name, const std::string& text) const { put_bytes(folder_ / name, text); }
  [[nodiscard]] std::string file(const std::string& name) const { return text_of(folder_ / name); }

  /// Runs the script, whose output is then in said(); returns its exit status.
  [[nodiscard]] int embed_code(const std::string& argument = "") const {
    return run_script(folder_ / "docs/embed_code",
                      argument + " > " + quoted(folder_ / "output.txt") + " 2>&1");
  }
  [[nodiscard]] std::string said() const { return file("output.txt"); }

 private:
  TemporaryFolder folder_;
};

const std::string embedded_header =
    "namespace n {\n\n"
    "class Ring;\n\n"
    "/// Says twice.\n"
    "template <class T>\n"
    "T twice(T x) {\n"
    "  if (x) { return 2 * x; }  // not }\n"
    "  return x;\n"
    "}\n\n"
    "struct Ring {\n"
    "  double radius = 1;\n\n"
    "  /// All around.\n"
    "  double length() const { return twice(radius) * 3; }\n"
    "  double area(double a,\n"
    "              double b) const {\n"
    "    return a * b;\n"
    "  }\n"
    "};\n\n"
    "}  // namespace n\n";

}  // namespace

TEST_CASE("the code in README.md and docs/ is that of its source files") {
  INFO("run docs/embed_code");
  CHECK(run_script(repository / "docs" / "embed_code", "--check") == 0);
}

TEST_CASE("docs/embed_code puts a file, a type, a function or a member between its marks") {
  const Project project;
  project.write("ring.hpp", embedded_header);
  const std::string end = "<!-- /code -->\nafter\n";
  struct Case {
    std::string name, code;
  };
  for (const auto& [name, code] : {
           Case{"", embedded_header},
           Case{" twice",
                "/// Says twice.\ntemplate <class T>\nT twice(T x) {\n  if (x) { return 2 * x; }  // not }\n"
                "  return x;\n}\n"},
           Case{" Ring::length", "/// All around.\ndouble length() const { return twice(radius) * 3; }\n"},
           Case{" Ring::area", "double area(double a,\n            double b) const {\n  return a * b;\n}\n"},
           Case{" Ring",
                embedded_header.substr(embedded_header.find("struct"),
                                       embedded_header.find("};") + 3 - embedded_header.find("struct"))},
       }) {
    CAPTURE(name);
    const std::string mark = "before\n<!-- code: ring.hpp" + name + " -->\n";
    project.write("docs/page.md", mark + "old\n" + end);
    CHECK(project.embed_code() == 0);
    CHECK(project.file("docs/page.md") == mark + "```cpp\n" + code + "```\n" + end);
    CHECK(project.embed_code("--check") == 0);
  }
}

TEST_CASE("docs/embed_code shows a file by the language that its ending tells") {
  const Project project;
  for (const auto& [name, language] : std::map<std::string, std::string>{{"ring.hpp", "cpp"},
                                                                         {"ring.diff", "diff"},
                                                                         {"ring.txt", "text"},
                                                                         {"CMakeLists.txt", "cmake"},
                                                                         {"run", "sh"}}) {
    project.write(name, "-1\n+2\n");
    const std::string mark = "<!-- code: " + name + " -->\n", end = "<!-- /code -->\n";
    project.write("docs/page.md", mark + end);
    CHECK(project.embed_code() == 0);
    CHECK(project.file("docs/page.md") == mark + "```" + language + "\n-1\n+2\n```\n" + end);
  }
}

TEST_CASE("docs/embed_code puts the step from one file to another between its marks") {
  const Project project;
  project.write("old.cpp",
                "// Old.\n\nint a;\nint b;\nint c;\nint d;\nint e;\nint f;\nint g;\n\nint h;\nint i;\n");
  project.write("new.cpp",
                "// New.\n\nint a;\nint b;\nint x;\n\nint y;\nint d;\nint e;\nint f;\nint g;\n\nint h;\nint "
                "i;\nint z;\n");
  const std::string mark = "before\n<!-- step: old.cpp new.cpp -->\n", end = "<!-- /step -->\nafter\n";
  project.write("docs/page.md", mark + "old\n" + end);
  CHECK(project.embed_code() == 0);
  CHECK(
      project.file("docs/page.md") ==
      mark +
          "```diff\n int a;\n int b;\n-int c;\n+int x;\n+\n+int y;\n int d;\n int e;\n...\n int h;\n int i;\n"
          "+int z;\n```\n" +
          end);
  CHECK(project.embed_code("--check") == 0);
  project.write("new.cpp", "// New.\n\nint x;\n");
  CHECK(project.embed_code("--check") == 1);
  CHECK_THAT(project.said(), ContainsSubstring("docs/page.md"));
}

TEST_CASE("docs/embed_code --check names the file that is out of date and leaves it unchanged") {
  const Project project;
  project.write("ring.hpp", embedded_header);
  project.write("docs/good.md", "<!-- code: ring.hpp -->\n<!-- /code -->\n");
  REQUIRE(project.embed_code() == 0);
  const std::string drifted = "<!-- code: ring.hpp twice -->\n```cpp\nold\n```\n<!-- /code -->\n";
  project.write("docs/drifted.md", drifted);
  CHECK(project.embed_code("--check") == 1);
  CHECK_THAT(project.said(), ContainsSubstring("docs/drifted.md"));
  CHECK_THAT(project.said(), !ContainsSubstring("good.md"));
  CHECK(project.file("docs/drifted.md") == drifted);
}

TEST_CASE(
    "docs/embed_code refuses marks that it cannot fill, names their place, and leaves the file unchanged") {
  const Project project;
  project.write("ring.hpp", embedded_header);
  project.write("long.hpp", "// A comment at the top.\n" + embedded_header);
  struct Case {
    std::string text, message;
  };
  for (const auto& [text, message] : {
           Case{"<!-- code: none.hpp -->\n<!-- /code -->\n", "none.hpp"},
           Case{"<!-- code: ring.hpp thrice -->\n<!-- /code -->\n", "thrice"},
           Case{"<!-- code: ring.hpp Ring::twice -->\n<!-- /code -->\n", "Ring::twice"},
           Case{"<!-- code: ring.hpp -->\n", "line 1"},
           Case{"x\n<!-- /code -->\n", "line 2"},
           Case{"<!-- code: ring.hpp -->\n<!-- code: ring.hpp -->\n<!-- /code -->\n", "line 1"},
           Case{"<!-- code: ring.hpp -->\n<!-- /step -->\n", "line 2"},
           Case{"<!-- step: ring.hpp none.hpp -->\n<!-- /step -->\n", "none.hpp"},
           Case{"<!-- step: ring.hpp ring.hpp -->\n<!-- /step -->\n", "do not differ"},
           Case{"<!-- step: ring.hpp long.hpp -->\n<!-- /step -->\n", "not equally long"},
       }) {
    CAPTURE(text);
    project.write("docs/bad.md", text);
    CHECK(project.embed_code() == 2);
    CHECK_THAT(project.said(), ContainsSubstring("docs/bad.md") && ContainsSubstring(message));
    CHECK(project.file("docs/bad.md") == text);
  }
}

TEST_CASE(
    "every link and picture in the documentation leads to a file of the project, or to an anchor in it") {
  for (const fs::path& path : documents()) {
    const std::string text = document(path).prose;
    std::vector<std::string> targets = all_between(text, "](", ")");
    for (const std::string attribute : {"src=", "href="})
      for (const std::string& target : all_between(text, attribute + '"', "\"")) targets.push_back(target);
    for (const std::string& target : targets) {
      if (target.starts_with("https://")) continue;
      CAPTURE(path, target);
      const std::size_t hash = target.find('#');
      const std::string file = target.substr(0, hash);
      CHECK(fs::path(file).is_relative());
      const fs::path found = file.empty() ? path : path.parent_path() / file;
      CHECK(fs::exists(found));
      if (hash != std::string::npos)
        CHECK_THAT(document(found).prose,
                   ContainsSubstring("<a id=\"" + target.substr(hash + 1) + "\"></a>"));
    }
  }
}

TEST_CASE("docs/architecture.md lists the functions of a pixel's way, and each is in the header it names") {
  const std::string page = text_of(repository / "docs" / "architecture.md");
  struct List {
    std::string begin, end;
    std::size_t most_functions, most_headers;
  };
  const auto list = GENERATE(List{"### The plain path", "### The fast path", 30, 13},
                             List{"### The fast path", "## The map", 45, 45});
  const std::string text = all_between(page, list.begin, list.end).at(0);
  const std::regex item(R"(\n\d+\. \[([a-z_/]+\.hpp)\]\(\S+\): `(?:(\w+)::)?([\w()]+)`)");
  std::set<std::string> headers, functions;
  for (std::sregex_iterator at(text.begin(), text.end(), item), last; at != last; ++at) {
    const std::string header = (*at)[1], type = (*at)[2], function = (*at)[3];
    CAPTURE(header, type, function);
    const std::string code = text_of(repository / "include" / "protostar" / header);
    CHECK_THAT(code, ContainsSubstring(function + "("));
    CHECK_THAT(code, ContainsSubstring(type.empty() ? function : " " + type + " "));
    headers.insert(header);
    CHECK(functions.insert(header + type + function).second);
  }
  CHECK(functions.size() > 20);
  CHECK(functions.size() <= list.most_functions);
  CHECK(headers.size() <= list.most_headers);
}

TEST_CASE("README.md starts with two sh blocks: for a first picture, and for all tests") {
  const auto [prose, blocks] = document(repository / "README.md");
  REQUIRE(blocks.size() > 2);
  CHECK(blocks[0] == "sh");
  CHECK(blocks[1] == "sh");
  CHECK(blocks[2] == "cpp");
  for (const std::string language : {"sh", "bash", "console", "shell"})
    CHECK(std::count(blocks.begin() + 2, blocks.end(), language) == 0);
  CHECK_THAT(prose, ContainsSubstring("<!-- code: tests/examples/readme.cpp -->"));
}

TEST_CASE("every stage has a page with its picture and its code, and both lists of stages link to it") {
  const std::string readme = text_of(repository / "README.md"),
                    index = text_of(repository / "docs" / "stages" / "README.md");
  REQUIRE(stages().size() >= 9);
  for (const std::string& stage : stages()) {
    CAPTURE(stage);
    const std::string page = text_of(repository / "docs" / "stages" / (stage + ".md"));
    CHECK_THAT(page, ContainsSubstring("](../../tests/golden/" + stage + ".png)"));
    CHECK_THAT(page, ContainsSubstring("<!-- code: stages/" + stage + ".cpp -->"));
    CHECK_THAT(page, ContainsSubstring("\n## Exercises\n"));
    CHECK_THAT(readme, ContainsSubstring("docs/stages/" + stage + ".md"));
    CHECK_THAT(index, ContainsSubstring("(" + stage + ".md)"));
  }
}

TEST_CASE("every picture of the gallery is at least 640 pixels wide and 480 high") {
  const std::string gallery = text_of(repository / "docs" / "gallery.md");
  const std::vector<std::string> pictures = all_between(gallery, "<img src=\"", "\"");
  CHECK(pictures.size() > 60);
  for (const std::string& picture : pictures) {
    CAPTURE(picture);
    // A PNG file holds width and height in its first chunk, highest byte first (PNG specification, 11.2.1).
    const std::string file = text_of(repository / "docs" / picture);
    REQUIRE(file.size() > 24);
    const auto number = [&](std::size_t at) {
      const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(file[at + i]); };
      return byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    };
    CHECK(number(16) >= 640);
    CHECK(number(20) >= 480);
  }
}

TEST_CASE("every stage but the naive ones has a plain ray tracer, and its page shows the step") {
  for (const std::string& stage : stages()) {
    if (stage.ends_with("_naive")) continue;
    CAPTURE(stage);
    const std::string source = "stages/plain/" + stage + ".cpp";
    CHECK_THAT(text_of(repository / source),
               ContainsSubstring("\n// g++ -O2 -std=c++20 " + stage + ".cpp -o " + stage + " && ./" + stage));
    const std::string page = text_of(repository / "docs" / "stages" / (stage + ".md"));
    CHECK_THAT(page, ContainsSubstring("\n## The step, plainly\n"));
    CHECK_THAT(page, ContainsSubstring(" " + source + " -->\n```"));
    CHECK_THAT(page, ContainsSubstring("\n<!-- plain: " + stage));
  }
}

TEST_CASE("each page of the stages leads to the one before and after it in their table") {
  const std::string index = text_of(repository / "docs" / "stages" / "README.md");
  const std::string table = all_between(index, "\n## The life of a star", "\n## ").at(0);
  std::vector<std::string> pages;
  for (const std::string& target : all_between(table, "](", ")"))
    if (std::find(pages.begin(), pages.end(), target) == pages.end()) pages.push_back(target);
  REQUIRE(pages.size() > 20);
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const std::string page = text_of(repository / "docs" / "stages" / pages[i]);
    const std::string way = all_between(page, "\n\n", "\n").at(0);  // the line below the title
    CAPTURE(pages[i], way);
    CHECK_THAT(way, ContainsSubstring("[all pages](README.md)"));
    if (i > 0) CHECK_THAT(way, ContainsSubstring("](" + pages[i - 1] + ") · [all pages]"));
    if (i + 1 < pages.size()) CHECK_THAT(way, ContainsSubstring(" →](" + pages[i + 1] + ")"));
  }
  for (const auto& entry : fs::directory_iterator(repository / "docs" / "stages")) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    CHECK((name == "README.md" || std::count(pages.begin(), pages.end(), name) == 1));
  }
}

TEST_CASE("each page has its star, idea in a picture, derivations, mistakes, exercises, and two diagrams") {
  int pages = 0;
  for (const auto& entry : fs::directory_iterator(repository / "docs" / "stages")) {
    const std::string name = entry.path().filename().string();
    if (name == "README.md") continue;
    CAPTURE(name);
    ++pages;
    const std::string page = text_of(entry.path());
    CHECK_THAT(page, ContainsSubstring("\n## The idea in one picture\n"));
    CHECK(all_between(page, "](../figures/", ".svg)").size() >= 2);
    if (name == "introduction.md") continue;  // it comes before the first program
    for (const std::string heading : {"The mathematics", "Common mistakes", "Exercises"})
      CHECK_THAT(page, ContainsSubstring("\n## " + heading + "\n"));
    CHECK_THAT(page, ContainsSubstring("\n**The star.** "));
  }
  CHECK(pages >= 33);
}

TEST_CASE("docs/coverage.md names a page for each heading and figure of the texts") {
  const std::string page = text_of(repository / "docs" / "coverage.md");
  std::istringstream lines(page);
  int rows = 0, tables = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("|")) continue;
    CAPTURE(line);
    const std::regex row(R"(\| (.*\S.*) \| (.*\S.*) \|)");
    std::smatch cells;
    REQUIRE(std::regex_match(line, cells, row));
    if (cells[2] == "page") {
      ++tables;
    } else if (cells[2] != "---") {
      CHECK_THAT(cells[2].str(), ContainsSubstring(".md)"));
      ++rows;
    }
  }
  CHECK(tables == 4);
  CHECK(rows > 80);
}

TEST_CASE("every exercise has a hint, a solution, and the picture or the text that the solution gives") {
  const fs::path solutions = repository / "tests" / "examples" / "solutions",
                 pictures = repository / "docs" / "figures" / "solutions";
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(repository / "docs" / "stages")) {
    CAPTURE(entry.path());
    const auto sections = all_between(text_of(entry.path()), "\n## Exercise", "\n## ");
    if (sections.empty()) continue;
    REQUIRE((sections.size() == 1 && sections[0].starts_with("s\n")));
    const auto exercises = all_between(sections[0] + "\n### ", "\n### ", "\n### ");
    REQUIRE(exercises.size() > 1);  // the last is empty
    for (auto exercise = exercises.begin(); exercise != exercises.end() - 1; ++exercise) {
      CAPTURE(*exercise);
      CHECK(all_between(*exercise, "\n*Hint.* ", "\n").size() == 1);
      CHECK(all_between(*exercise, "\n<details><summary>Solution</summary>\n", "\n</details>").size() == 1);
      const std::regex code(R"(\n<!-- code: tests/examples/solutions/(\w+)\.(cpp|diff) -->\n)");
      std::smatch found;
      REQUIRE(std::regex_search(*exercise, found, code));
      const std::string name = found[1];
      CHECK(names.insert(name).second);
      const auto shows = [&](const std::string& mark) { return exercise->find(mark) != std::string::npos; };
      const bool has_picture = fs::exists(pictures / (name + ".png"));
      const bool has_text = fs::exists(solutions / (name + ".txt"));
      CHECK((has_picture || has_text));
      CHECK(has_picture == shows("](../figures/solutions/" + name + ".png)\n"));
      CHECK(has_text == shows("\n<!-- code: tests/examples/solutions/" + name + ".txt -->\n"));
    }
  }
  for (const fs::path& folder : {solutions, pictures})
    for (const auto& entry : fs::directory_iterator(folder)) {
      CAPTURE(entry.path());
      CHECK((entry.path().filename() == "check" || names.count(entry.path().stem().string()) == 1));
    }
}

TEST_CASE("an exercise that changes a plain ray tracer says how its copy is built and run") {
  int copies = 0;
  for (const auto& entry : fs::directory_iterator(repository / "docs" / "stages")) {
    CAPTURE(entry.path());
    std::string page = text_of(entry.path());
    std::replace(page.begin(), page.end(), '\n', ' ');
    for (const std::string& stage : all_between(page, "Copy [", ".cpp](../../stages/plain/")) {
      // The line at the top of the source, with the copy's name.
      const std::string source = text_of(repository / "stages" / "plain" / (stage + ".cpp"));
      const std::string command = all_between(source, "\n// g++", "\n").at(0);
      CHECK_THAT(page,
                 ContainsSubstring("`g++" + std::regex_replace(command, std::regex(stage), "mine") + "`"));
      ++copies;
    }
  }
  CHECK(copies >= 33);
}

TEST_CASE("docs/errata.md: the tutorial's rounding differs in 24 of the 100 columns of the gradient") {
  const protostar::Encoder encode(protostar::Linear{}, 255);
  int differing = 0;
  for (int x = 0; x < 100; ++x) {
    const float light = static_cast<float>(x) / 99;
    if (encode(light) != static_cast<int>(std::clamp(light * 256, 0.0f, 255.0f))) ++differing;
  }
  CHECK(differing == 24);
}

TEST_CASE("docs/web/make_pages takes one folder, and no option for its name") {
  const TemporaryFolder folder;
  const auto make_pages = [&](const std::vector<std::string>& words) {
    return run({.program = repository / "docs/web/make_pages", .arguments = words, .folder = folder / ""});
  };
  const Outcome help = make_pages({"--help"});
  if (help.status == 127) {
    WARN("not tested: python3 is not installed");
    return;
  }
  CHECK(help.status == 0);
  CHECK_THAT(help.out, ContainsSubstring("docs/web/make_pages SITE"));
  CHECK(help.err.empty());
  CHECK(make_pages({"-h"}).out == help.out);
  for (const auto& words : {std::vector<std::string>{}, {"a", "b"}, {"--bogus"}, {"--help", "a"}}) {
    CAPTURE(words);
    const Outcome outcome = make_pages(words);
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, ContainsSubstring("usage: docs/web/make_pages SITE"));
    for (const std::string& word : words)
      if (word.starts_with("-")) CHECK_THAT(outcome.err, ContainsSubstring("there is no option " + word));
  }
  CHECK(folder.count() == 0);
}
