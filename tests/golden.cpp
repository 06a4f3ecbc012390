// The pictures of the stages: each equals its golden, byte for byte, and each golden agrees with exact
// arithmetic.
#include <sys/wait.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "compare_images/picture.hpp"
#include "compare_images/read_image.hpp"
#include "reference/carved_solids.hpp"
#include "reference/endless_floor.hpp"
#include "reference/mesh.hpp"
#include "reference/pictures.hpp"
#include "reference/primitives.hpp"
#include "reference/soft_shadows.hpp"
#include "reference/whitted.hpp"
#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/wrong_cases.hpp"

namespace {

const std::string source_dir = PROTOSTAR_SOURCE_DIR, binary_dir = PROTOSTAR_BINARY_DIR;

std::string golden(const std::string& name) { return source_dir + "/tests/golden/" + name + ".png"; }

std::string quoted(const std::string& word) { return "'" + word + "'"; }

/// Runs a shell command in a folder, with its output in output.txt there; returns its exit status, or −1.
int run(const TemporaryFolder& folder, const std::string& line) {
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

/// Returns the number of pixels that differ by more than one level in a channel.
int pixels_beyond_a_level(const Picture& a, const Picture& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if (difference({1, 1, {a.pixels[i]}}, {1, 1, {b.pixels[i]}}).largest > 1) ++count;
  return count;
}

/// A golden: the stage that draws it, and its reference picture, which naive stages do not have: they are
/// wrong on purpose. Nor do stages whose rays take numbers of a sampler besides places: the closed forms of
/// tests/lens.cpp and tests/moving.cpp judge these. The fields of 34 to 38 have no equation:
/// tests/marched.cpp judges hits on fields.
struct Golden {
  std::string name, stage, options;
  Picture (*reference)();
  int undecided = 0;  ///< number of pixels that may be more than a level off the reference, inexact there
};

template <reference::Vector (*light_along)(reference::Whole)>
Picture of_scene() {
  return reference::picture(640, 480, light_along);
}

/// Number of pixels that look exactly at the lines x = ±4 between squares of the board: rounding decides
/// between these.
constexpr int lines_between_squares = 20;

const Golden goldens[] = {
    {"01_gradient", "01_gradient", "", [] { return reference::gradient(100, 100); }},
    {"02_sphere", "02_sphere", "", of_scene<reference::sphere_alone>},
    {"03_scene", "03_scene", "", of_scene<reference::binary>},
    {"04_depth", "04_depth", "", of_scene<reference::depth>},
    {"05_normal", "05_normal", "", of_scene<reference::normals>},
    {"06_color", "06_color", "", of_scene<reference::flat_color>},
    {"07_diffuse", "07_diffuse", "", of_scene<reference::diffuse>},
    {"07_diffuse_linear", "07_diffuse", " --transfer linear",
     [] { return reference::picture(640, 480, reference::diffuse, 1); }},
    {"08_naive", "08_naive", "", nullptr},
    {"08_naive_0", "08_naive", " --offset 0", nullptr},
    {"08_transparency", "08_transparency", "", of_scene<reference::transparency>},
    {"09_naive", "09_naive", "", nullptr},
    {"09_naive_0", "09_naive", " --offset 0", nullptr},
    {"09_shadow", "09_shadow", "", of_scene<reference::shadow>},
    {"10_phong", "10_phong", "",
     [] {
       using namespace reference;
       return picture({{dull_ivory, rubber, rubber, dull_ivory}});
     }},
    {"11_mirror", "11_mirror", "",
     [] {
       using namespace reference;
       return picture({{ivory, mirror, rubber, mirror}, true});
     },
     lines_between_squares},
    {"12_glass", "12_glass", "",
     [] {
       using namespace reference;
       return picture({{ivory, glass, rubber, glass}, true});
     },
     lines_between_squares},
    {"13_whitted", "13_whitted", "",
     [] {
       using namespace reference;
       return picture({{ivory, glass, rubber, mirror}, true});
     },
     lines_between_squares},
    {"14_primitives", "14_primitives", "", of_scene<reference::primitives_along>},
    {"15_csg", "15_csg", "", of_scene<reference::carved_solids_along>},
    {"16_environment", "16_environment", "",
     [] {
       using namespace reference;
       return picture({{ivory, glass, rubber, mirror}, true, true});
     },
     lines_between_squares},
    {"18_antialiasing", "18_antialiasing", "", [] { return reference::endless_floor(4); }},
    {"18_antialiasing_1", "18_antialiasing", " --samples 1", [] { return reference::endless_floor(0); }},
    {"19_soft_shadows", "19_soft_shadows", "", [] { return reference::soft_shadows(16); }},
    {"19_soft_shadows_1", "19_soft_shadows", " --samples 1", [] { return reference::soft_shadows(1); }},
    {"20_lens", "20_lens", "", nullptr},
    {"21_motion", "21_motion", "", nullptr},
    {"22_glossy", "22_glossy", "", nullptr},
    {"23_ambient_occlusion", "23_ambient_occlusion", "", {}},
    {"24_path", "24_path", "", {}},
    {"24_path_1", "24_path", " --samples 1", {}},
    {"25_cornell", "25_cornell", "", nullptr},
    {"26_weekend", "26_weekend", "", nullptr},
    {"27_normal_map", "27_normal_map", "",
     [] {
       using namespace reference;
       return picture({{bumpy_ivory, ribbed_rubber, ribbed_rubber, bumpy_ivory}});
     }},
    // Marches that stop at an epsilon are wrong on purpose. Fields without an equation have no reference: the
    // plain ray tracers, with a march of their own, draw the same pictures (tests/plain/check).
    {"30_fixed_step", "30_fixed_step", "", nullptr},
    {"31_sphere_tracing", "31_sphere_tracing", "", nullptr},
    {"32_enhanced", "32_enhanced", "", nullptr},
    {"33_certified", "33_certified", "", of_scene<reference::diffuse>},
    {"34_fields", "34_fields", "", nullptr},
    {"35_blend", "35_blend", "", nullptr},
    {"36_repetition", "36_repetition", "", nullptr},
    {"37_marched_shadow", "37_marched_shadow", "", nullptr},
    {"38_fractal", "38_fractal", "", nullptr},
#if __has_include(<tiny_obj_loader.h>)  // otherwise this stage is not built
    {"17_mesh", "17_mesh", "",
     [] { return reference::Knot(source_dir + "/scenes/knot.obj").picture(640, 480); }},
#endif
};

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
  REQUIRE(run(folder, command(picture)) == 0);
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

// A single level may come from rounding light to float, which moves it by 2^-24 of itself and its code, at
// most 255, by 255/2.2 · 2^-24 = 7e-6 of a level: a few of the 921,600 codes of a picture cross the middle
// between two levels.
TEST_CASE("no pixel of a golden is more than one level from exact arithmetic", "[long]") {
  // References take seconds; the cores share them.
  std::vector<std::future<Picture>> references;
  for (const Golden& picture : goldens)
    references.push_back(
        std::async(picture.reference ? std::launch::async : std::launch::deferred, picture.reference));
  for (std::size_t i = 0; i < references.size(); ++i) {
    const Golden& picture = goldens[i];
    if (!picture.reference) continue;
    const Picture stored = read_image(golden(picture.name)), exact = references[i].get();
    REQUIRE(same_size(stored, exact));
    const Difference found = difference(stored, exact);
    INFO(picture.name << ": " << found.pixels << " pixels differ from the reference, by at most "
                      << found.largest << " levels");
    CHECK(pixels_beyond_a_level(stored, exact) <= picture.undecided);
    CHECK(found.pixels < 10 + picture.undecided);
  }
}

TEST_CASE("every stage has a golden, and the goldens are PNG files with three channels") {
  for (const auto& entry : std::filesystem::directory_iterator(source_dir + "/stages")) {
    if (!entry.is_regular_file() || entry.path().extension() != ".cpp") continue;
    const std::string stage = entry.path().stem().string();
    if (stage == "render") continue;  // it draws the pictures of scenes/ (render_program.cpp)
    if (stage == "merge") continue;   // it draws none
    INFO(stage);
    CHECK(std::count_if(std::begin(goldens), std::end(goldens),
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
    if (picture.name != picture.stage || !picture.reference) continue;
    INFO(picture.name);
    CHECK_THAT(page, ContainsSubstring("../tests/golden/gallery/" + picture.name + ".png"));
    const Picture shown = read_image(golden("gallery/" + picture.name));
    CHECK(shown.width >= 640);
    CHECK(shown.height >= 480);
    if (++drawn > cases(3, 100)) continue;  // the short form draws some of them
    const TemporaryFolder folder;
    REQUIRE(run(folder, command(picture) + " --size 640x480 --samples 16") == 0);
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
    REQUIRE(run(folder, quoted(binary_dir + "/stages/" + stage) + options + " -o out.png") == 0);
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

TEST_CASE("pages state the counts of wrong pixels that the stages print") {
  struct Row {
    std::string stage, options, count, page, sentence;
  };
  for (const auto& [stage, options, count, page, sentence] :
       {Row{"31_sphere_tracing", " --epsilon 1e-6", "923", "31_sphere_tracing", "with a millionth 923"},
        Row{"32_enhanced", " --epsilon 1e-6", "430", "32_enhanced", "430 pixels are wrong, and not 923"}}) {
    INFO(stage << options);
    const TemporaryFolder folder;
    REQUIRE(run(folder, quoted(binary_dir + "/stages/" + stage) + options) == 0);
    CHECK((bytes_of(folder / "output.txt").ends_with("\n" + count + " of 307200 pixels are wrong\n")));
    CHECK_THAT(bytes_of(source_dir + "/docs/stages/" + page + ".md"), ContainsSubstring(sentence));
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
    REQUIRE(run(folder, quoted(binary_dir + "/stages/" + stage) + " --size 320x240 -o out.ppm --show " +
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
      REQUIRE(run(folder, command(picture) + size + " --threads " + threads + " -o " + threads + ".ppm") ==
              0);
    const std::string one = bytes_of(folder / "1.ppm");
    CHECK((one == bytes_of(folder / "2.ppm")));  // in parentheses, to print no megabyte
    CHECK((one == bytes_of(folder / "7.ppm")));
  }
}

TEST_CASE("compare_images reports how much pictures differ, and shows where") {
  const TemporaryFolder folder;
  const std::string compare = quoted(binary_dir + "/tests/compare_images") + " ";
  const std::string lit = quoted(golden("07_diffuse")) + " ", shadowed = quoted(golden("09_shadow")) + " ";

  CHECK(run(folder, compare + lit + lit + "difference.png") == 0);
  CHECK(bytes_of(folder / "output.txt") == "equal\n");
  CHECK_FALSE(std::filesystem::exists(folder / "difference.png"));

  CHECK(run(folder, compare + lit + shadowed + "difference.png") == 1);
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

  CHECK(run(folder, compare + lit + quoted(golden("01_gradient"))) == 1);
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("640x480 and 100x100"));
  CHECK(run(folder, compare + lit + "none.png") == 2);
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("none.png"));
  CHECK(run(folder, compare + lit) == 2);
  CHECK(run(folder, compare + lit + shadowed + "no/folder.png") == 2);

  for (const std::string pixel : {"9 8 7", "9 8 6"})
    put_bytes(folder / (pixel.substr(4) + ".ppm"), "P3\n1 1\n255\n" + pixel);
  CHECK(run(folder, compare + "7.ppm 6.ppm") == 1);
  CHECK(bytes_of(folder / "output.txt") == "1 of 1 pixels differ, by at most 1 of 255 levels\n");
  for (const std::string wrong_end :
       {"1 1\n65535\n9 8 7", "1 1\n255\n9 8", "1 1\n255\n9 8 256", "0 1\n255\n"}) {
    CAPTURE(wrong_end);
    put_bytes(folder / "wrong.ppm", "P3\n" + wrong_end);
    CHECK(run(folder, compare + "wrong.ppm 7.ppm") == 2);
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
    return run(folder, "printf '" + answers + "' | TMPDIR=. PATH=./bin:$PATH tests/update_golden " +
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

  CHECK(update("", " 99_nothing") == 1);
  CHECK_THAT(bytes_of(folder / "output.txt"), ContainsSubstring("no golden '99_nothing'"));
}
