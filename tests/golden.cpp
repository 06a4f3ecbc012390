// The pictures of the stages: each equals its golden, byte for byte.
#include <sys/wait.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "compare_images/picture.hpp"
#include "compare_images/read_image.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/pages.hpp"
#include "support/wrong_cases.hpp"

namespace {

const std::string source_dir = PROTOSTAR_SOURCE_DIR, binary_dir = PROTOSTAR_BINARY_DIR;

std::string golden(const std::string& name) { return source_dir + "/tests/golden/" + name + ".png"; }

std::string quoted(const std::string& word) { return "'" + word + "'"; }

/// Runs a shell command in a folder, with its output in output.txt there; returns its exit status, or −1.
int run_line(const TemporaryFolder& folder, const std::string& line) {
  const std::string all = "cd " + quoted((folder / "").string()) + " && (" + line + ") > output.txt 2>&1";
  const int status = std::system(all.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void check_equal(const Picture& a, const Picture& b) {
  REQUIRE(same_size(a, b));
  const Difference found = difference(a, b);
  INFO(found.pixels << " pixels differ, by at most " << found.largest << " levels");
  CHECK(found.pixels == 0);
}

/// A golden: the stage that draws it, and with which options. tests/reference/exact_pictures.cpp compares
/// goldens with exact arithmetic.
struct Golden {
  std::string name, stage, options;
};

/// Returns the row of a stage's picture without options.
Golden plain_golden(const std::string& stage) { return {stage, stage, ""}; }

const std::vector<Golden> goldens = [] {
  std::vector<Golden> all{{"07_diffuse_linear", "07_diffuse", " --transfer linear"},
                          {"08_naive_0", "08_naive", " --offset 0"},
                          {"09_naive_0", "09_naive", " --offset 0"},
                          {"18_antialiasing_1", "18_antialiasing", " --samples 1"},
                          {"19_soft_shadows_1", "19_soft_shadows", " --samples 1"},
                          {"24_path_1", "24_path", " --samples 1"}};
  for (const char* stage : {"01_gradient",     "02_sphere",         "03_scene",        "04_depth",
                            "05_normal",       "06_color",          "07_diffuse",      "08_naive",
                            "08_transparency", "09_naive",          "09_shadow",       "10_phong",
                            "11_mirror",       "12_glass",          "13_whitted",      "14_primitives",
                            "15_csg",          "16_environment",    "18_antialiasing", "19_soft_shadows",
                            "20_lens",         "21_motion",         "22_glossy",       "23_ambient_occlusion",
                            "24_path",         "25_cornell",        "26_weekend",      "27_normal_map",
                            "30_fixed_step",   "31_sphere_tracing", "32_enhanced",     "33_certified",
                            "34_fields",       "35_blend",          "36_repetition",   "37_marched_shadow",
                            "38_fractal"})
    all.push_back(plain_golden(stage));
#if __has_include(<tiny_obj_loader.h>)  // otherwise this stage is not built
  all.push_back(plain_golden("17_mesh"));
#endif
  return all;
}();

/// Returns true for a stage that is wrong on purpose.
bool is_naive(const std::string& stage) {
  return stage.ends_with("_naive") || stage == "30_fixed_step" || stage == "31_sphere_tracing" ||
         stage == "32_enhanced";
}

std::string command(const Golden& picture) {
  return quoted(binary_dir + "/stages/" + picture.stage) + picture.options;
}

/// Returns true for a picture that takes seconds, as it has many rays a pixel.
bool takes_seconds(const Golden& picture) {
  const std::set<std::string> slow = {"19_soft_shadows", "21_motion", "22_glossy", "24_path", "25_cornell"};
  return slow.contains(picture.name);
}

void check_drawn(const Golden& picture) {
  INFO(picture.name);
  const TemporaryFolder folder;
  REQUIRE(run_line(folder, command(picture)) == 0);
  check_equal(read_image((folder / "out.ppm").string()), read_image(golden(picture.name)));
}

}  // namespace

TEST_CASE("each stage writes its golden to out.ppm") {
  for (const Golden& picture : goldens)
    if (!takes_seconds(picture)) check_drawn(picture);
}

TEST_CASE("each stage that takes seconds writes its golden to out.ppm", "[long]") {
  for (const Golden& picture : goldens)
    if (takes_seconds(picture)) check_drawn(picture);
}

TEST_CASE("every stage has a golden, and the goldens are PNG files with three channels") {
  for (const auto& entry : std::filesystem::directory_iterator(source_dir + "/stages")) {
    if (!entry.is_regular_file() || entry.path().extension() != ".cpp") continue;
    const std::string stage = entry.path().stem().string();
    if (stage == "render") continue;  // it draws the pictures of scenes/ (render_program.cpp)
    if (stage == "merge") continue;   // it draws none
    INFO(stage);
    CHECK(std::count_if(goldens.begin(), goldens.end(),
                        [&](const Golden& picture) { return picture.name == stage; }) == 1);
  }
  for (const Golden& picture : goldens) {
    INFO(picture.name);
    const std::string bytes = bytes_of(golden(picture.name));
    REQUIRE(bytes.starts_with("\x89PNG\r\n"));
    CHECK(bytes.at(25) == 2);  // the header says: red, green and blue
  }
}

TEST_CASE("the gallery shows each stage in a picture that the stage draws") {
  const std::string page = bytes_of(source_dir + "/docs/gallery.md");
  int drawn = 0;
  for (const Golden& picture : goldens) {
    if (picture.name != picture.stage || is_naive(picture.stage)) continue;
    INFO(picture.name);
    CHECK_THAT(page, ContainsSubstring("../tests/golden/gallery/" + picture.name + ".png"));
    const Picture shown = read_image(golden("gallery/" + picture.name));
    CHECK(shown.width >= 640);
    CHECK(shown.height >= 480);
    if (++drawn > cases(3, 100)) continue;  // the short form draws some of them
    const TemporaryFolder folder;
    REQUIRE(run_line(folder, command(picture) + " --size 640x480 --samples 16") == 0);
    check_equal(read_image((folder / "out.ppm").string()), shown);
  }
}

TEST_CASE("a naive stage reports how many of its pixels differ from those of the exact stage") {
  struct Row {
    std::string stage, options, exact;
  };
  for (const auto& [stage, options, exact] :
       {Row{"08_naive", "", "08_transparency"}, Row{"08_naive", " --offset 0", "08_transparency"},
        Row{"09_naive", "", "09_shadow"}, Row{"09_naive", " --offset 0", "09_shadow"},
        Row{"30_fixed_step", "", "33_certified"}, Row{"31_sphere_tracing", " --epsilon 1e-2", "33_certified"},
        Row{"32_enhanced", " --epsilon 1e-6", "33_certified"}, Row{"33_certified", "", "07_diffuse"}}) {
    INFO(stage << options);
    const TemporaryFolder folder;
    REQUIRE(run_line(folder, quoted(binary_dir + "/stages/" + stage) + options + " -o out.png") == 0);
    const Picture naive = read_image((folder / "out.png").string()), right = read_image(golden(exact));
    int wrong = 0;
    for (std::size_t i = 0; i < naive.pixels.size(); ++i)
      for (std::size_t channel = 0; channel < 3; ++channel)
        if (std::abs(naive.pixels[i][channel] - right.pixels[i][channel]) > 1) {
          ++wrong;
          break;
        }
    std::string line = std::to_string(wrong);
    line += " of 307200 pixels are wrong\n";
    CHECK((bytes_of(folder / "output.txt").ends_with(line)));
    CHECK((wrong > 0) == (stage == "08_naive" || stage == "30_fixed_step" || !options.empty()));
  }
}

TEST_CASE("pages state the numbers that the stages print") {
  struct Row {
    std::string stage, options, printed, page, sentence;
  };
  for (const auto& [stage, options, printed, page, sentence] :
       {Row{"08_naive", " --offset 0", "76980 of 307200 pixels are wrong", "numerics",
            "| 76980 of 307200 pixels are wrong |"},
        Row{"08_naive", "", "1126 of 307200 pixels are wrong", "numerics",
            "| 1126 of 307200 pixels are wrong |"},
        Row{"09_naive", " --offset 0", "35395 of 307200 pixels are wrong", "numerics",
            "| 35395 of 307200 pixels are wrong |"},
        Row{"08_naive", " --pixel 282,298", "hit at t = 0.000137", "stages/08_naive",
            "and hits it again at `t = 0.000137`"},
        Row{"09_naive", " --offset 0 --pixel 320,280", "sphere 0: hit at t = 6.10947609e-07",
            "stages/09_naive", "and hits it at `t = 6.1e-07`"},
        Row{"30_fixed_step", "", "113022 of 307200 pixels are wrong", "stages/30_fixed_step",
            "With the default of 0.25, 113022 of 307200 pixels are wrong"},
        Row{"30_fixed_step", " --epsilon 0.1", "66976 of 307200 pixels are wrong", "stages/30_fixed_step",
            "with 0.1 66976 are"},
        Row{"31_sphere_tracing", " --epsilon 0.1", "152216 of 307200 pixels are wrong",
            "stages/31_sphere_tracing", "with 0.1 152216 of 307200 pixels are wrong"},
        Row{"31_sphere_tracing", " --epsilon 0.001", "391 of 307200 pixels are wrong",
            "stages/31_sphere_tracing", "with 0.001 391"},
        Row{"31_sphere_tracing", " --epsilon 1e-6", "923 of 307200 pixels are wrong",
            "stages/31_sphere_tracing", "with a millionth 923"},
        Row{"32_enhanced", " --epsilon 1e-6", "430 of 307200 pixels are wrong", "stages/32_enhanced",
            "430 pixels are wrong, and not 923"}}) {
    INFO(stage << options);
    const TemporaryFolder folder;
    REQUIRE(run_line(folder, quoted(binary_dir + "/stages/" + stage) + options) == 0);
    CHECK_THAT("\n" + bytes_of(folder / "output.txt"),
               ContainsSubstring("\n" + printed) || ContainsSubstring(" " + printed));
    CHECK_THAT(page_in_one_line(page), ContainsSubstring(sentence));
  }
}

TEST_CASE("pages state how much two of their pictures differ") {
  struct Row {
    std::string first, second, page;
  };
  for (const auto& [first, second, page] : {Row{"12_schlick", "fresnel_exact", "stages/fresnel"}}) {
    INFO(first << " " << second);
    const std::string solutions = source_dir + "/docs/figures/solutions/";
    const Picture one = read_image(solutions + first + ".png"),
                  other = read_image(solutions + second + ".png");
    REQUIRE(same_size(one, other));
    const Difference found = difference(one, other);
    CHECK_THAT(
        page_in_one_line(page),
        ContainsSubstring(std::to_string(found.pixels) + " of " + std::to_string(one.pixels.size()) +
                          " pixels differ, by at most " + std::to_string(found.largest) + " of 255 levels"));
  }
}

TEST_CASE("pages show the heat maps and the light by distance that the stages draw") {
  struct Row {
    std::string stage, options, figure;
  };
  std::vector<Row> rows{{"33_certified", "evaluations", "33_evaluations"},
                        {"33_certified", "enclosure-width", "33_widths"},
                        {"38_fractal", "evaluations", "38_evaluations"}};
  if (cases(0, 1) == 1) {
    rows.push_back({"37_marched_shadow", "distance-occlusion --samples 16", "37_distance_occlusion"});
    rows.push_back({"37_marched_shadow", "distance-shadow --samples 16", "37_distance_shadow"});
    rows.push_back({"37_marched_shadow", "ambient-occlusion --samples 64", "37_true_occlusion"});
    rows.push_back({"37_marched_shadow", "direct --samples 64", "37_true_shadow"});
  }
  for (const auto& [stage, options, figure] : rows) {
    INFO(figure);
    const TemporaryFolder folder;
    REQUIRE(run_line(folder, quoted(binary_dir + "/stages/" + stage) + " --size 320x240 -o out.ppm --show " +
                                 options) == 0);
    check_equal(read_image((folder / "out.ppm").string()),
                read_image(source_dir + "/docs/figures/marching/" + figure + ".png"));
  }
}

TEST_CASE("the number of threads changes no byte of a picture") {
  const std::string size = cases(0, 1) == 1 ? "" : " --size 160x120";  // the short form draws fewer tiles
  for (const Golden& picture : goldens) {
    INFO(picture.name);
    const TemporaryFolder folder;
    for (const std::string threads : {"1", "2", "7"})
      REQUIRE(run_line(folder,
                       command(picture) + size + " --threads " + threads + " -o " + threads + ".ppm") == 0);
    const std::string one = bytes_of(folder / "1.ppm");
    CHECK((one == bytes_of(folder / "2.ppm")));  // in parentheses, to print no megabyte
    CHECK((one == bytes_of(folder / "7.ppm")));
  }
}

TEST_CASE("compare_images reports how much pictures differ, and shows where") {
  const TemporaryFolder folder;
  const std::string compare = quoted(binary_dir + "/tests/compare_images") + " ";
  const std::string lit = quoted(golden("07_diffuse")) + " ", shadowed = quoted(golden("09_shadow")) + " ";

  CHECK(run_line(folder, compare + lit + lit + "difference.png") == 0);
  CHECK(bytes_of(folder / "output.txt") == "equal\n");
  CHECK_FALSE(std::filesystem::exists(folder / "difference.png"));

  CHECK(run_line(folder, compare + lit + shadowed + "difference.png") == 1);
  const Picture a = read_image(golden("07_diffuse")), b = read_image(golden("09_shadow"));
  const Picture shown = read_image((folder / "difference.png").string());
  REQUIRE(same_size(shown, a));
  int differing = 0;
  WrongCases wrong;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    if (a.pixels[i] != b.pixels[i]) ++differing;
    for (std::size_t c = 0; c < 3; ++c)
      wrong.add(a.pixels[i][c] == b.pixels[i][c] ? shown.pixels[i][c] != 0 : shown.pixels[i][c] < 96, "pixel",
                i, "channel", c);
  }
  CHECK(wrong == 0);
  CHECK_THAT(bytes_of(folder / "output.txt"),
             ContainsSubstring(std::to_string(differing) + " of 307200 pixels differ"));

  CHECK(run_line(folder, compare + lit + quoted(golden("01_gradient"))) == 1);
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("640x480 and 100x100"));
  CHECK(run_line(folder, compare + lit + "none.png") == 2);
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("none.png"));
  CHECK(run_line(folder, compare + lit) == 2);
  CHECK(run_line(folder, compare + lit + shadowed + "no/folder.png") == 2);

  for (const std::string pixel : {"9 8 7", "9 8 6"})
    put_bytes(folder / (pixel.substr(4) + ".ppm"), "P3\n1 1\n255\n" + pixel);
  CHECK(run_line(folder, compare + "7.ppm 6.ppm") == 1);
  CHECK(bytes_of(folder / "output.txt") == "1 of 1 pixels differ, by at most 1 of 255 levels\n");
  for (const std::string wrong_end :
       {"1 1\n65535\n9 8 7", "1 1\n255\n9 8", "1 1\n255\n9 8 256", "0 1\n255\n"}) {
    CAPTURE(wrong_end);
    put_bytes(folder / "wrong.ppm", "P3\n" + wrong_end);
    CHECK(run_line(folder, compare + "wrong.ppm 7.ppm") == 2);
    CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("wrong.ppm"));
  }
}

TEST_CASE("update_golden replaces a golden only if a reason is given, and records the reason") {
  // A temporary project, with one golden that is wrong and one that is right. Its cmake only records that it
  // was asked to build.
  const TemporaryFolder folder;
  namespace fs = std::filesystem;
  fs::create_directories(folder / "tests/golden");
  fs::create_directory(folder / "bin");
  fs::create_directory_symlink(source_dir + "/stages", folder / "stages");
  fs::copy_file(source_dir + "/tests/update_golden", folder / "tests/update_golden");
  put_bytes(folder / "bin/cmake", "#!/bin/sh\necho \"$@\" > built.txt\n");
  fs::permissions(folder / "bin/cmake", fs::perms::owner_all);
  const std::string right = bytes_of(golden("02_sphere")), wrong = bytes_of(golden("03_scene"));
  put_bytes(folder / "tests/golden/02_sphere.png", wrong);
  put_bytes(folder / "tests/golden/03_scene.png", wrong);

  const auto update = [&](const std::string& answers, const std::string& stages) {
    return run_line(folder, "printf '" + answers + "' | TMPDIR=. PATH=./bin:$PATH tests/update_golden " +
                                quoted(binary_dir) + stages);
  };
  const auto sphere = [&] { return bytes_of(folder / "tests/golden/02_sphere.png"); };
  const fs::path reasons = folder / "tests/golden/reasons.md";

  CHECK(update("", " 03_scene") == 0);  // nothing has changed, so no question is asked
  CHECK_THAT(bytes_of(folder / "built.txt"), ContainsSubstring("--target stages compare_images"));

  for (const std::string answers : {"", "n\\nNo reason.\\n", "y\\n", "y\\n\\n  \\n"}) {
    INFO("answers: " << answers);
    CHECK(update(answers, " 02_sphere") == 1);
    CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("02_sphere.difference.png"));
    CHECK((sphere() == wrong));  // in parentheses, to print no PNG
    CHECK_FALSE(fs::exists(reasons));
  }

  CHECK(update("y\\n\\nThe other spheres are gone.\\n", " 02_sphere 03_scene") == 0);
  CHECK((sphere() == right));
  CHECK((bytes_of(folder / "tests/golden/03_scene.png") == wrong));
  const std::string log = bytes_of(reasons);
  CHECK(log.starts_with("# Why the goldens are what they are\n"));
  CHECK_THAT(log, ContainsSubstring("\nThe other spheres are gone.\n"));
  CHECK_THAT(log, ContainsSubstring("\n- 02_sphere: "));
  CHECK_THAT(log, ContainsSubstring(" of 307200 pixels differ, by at most 255 of 255 levels\n"));
  CHECK_THAT(log, !ContainsSubstring("03_scene"));

  CHECK(update("y\\nThe first.\\n", " 01_gradient") == 0);
  CHECK(bytes_of(reasons).starts_with(log));
  CHECK_THAT(bytes_of(reasons), ContainsSubstring("\nThe first.\n\n- 01_gradient: new\n"));
  CHECK((bytes_of(folder / "tests/golden/01_gradient.png") == bytes_of(golden("01_gradient"))));

  // The plain ray tracer of a page is compared with the golden that has changed.
  fs::create_directories(folder / "docs/stages");
  put_bytes(folder / "docs/stages/02_sphere.md", "<!-- plain: 02_sphere 1e-4 -->\n<!-- /plain -->\n");
  fs::create_directory(folder / "tests/plain");
  put_bytes(folder / "tests/plain/check", "#!/bin/sh\necho \"$@\" > checked.txt\n");
  fs::permissions(folder / "tests/plain/check", fs::perms::owner_all);
  const auto spoil_both = [&] {
    put_bytes(folder / "tests/golden/02_sphere.png", wrong);
    put_bytes(folder / "tests/golden/03_scene.png", right);
  };
  spoil_both();
  CHECK(update("y\\nBoth.\\n", " 02_sphere 03_scene") == 0);  // the page of 03_scene has no such line
  CHECK_THAT(bytes_of(folder / "checked.txt"), ContainsSubstring("/plain --write 02_sphere\n"));

  // If that fails, the goldens are replaced all the same, and what is left to do is told.
  put_bytes(folder / "tests/plain/check", "#!/bin/sh\nexit 1\n");
  spoil_both();
  CHECK(update("y\\nBoth again.\\n", " 02_sphere 03_scene") == 1);
  CHECK((sphere() == right));
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("FOLDER --write 02_sphere\n"));

  CHECK(update("", " 99_nothing") == 1);
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("no golden '99_nothing'"));
}
