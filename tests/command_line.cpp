// The stages as a user runs them: options, refused input, pictures, threads, memory, and progress.
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <protostar/version.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_stage.hpp"
#include "support/sanitizers.hpp"
#include "support/wrong_cases.hpp"

namespace fs = std::filesystem;

namespace {

struct StageRow {
  std::string name, integrator;
  int samples = 0;  ///< rays through each pixel by default; 0: one through its center
};

const std::vector<StageRow> all_stages {
  {"01_gradient", "gradient"}, {"02_sphere", "sphere"}, {"03_scene", "binary"}, {"04_depth", "depth"},
      {"05_normal", "normal"}, {"06_color", "color"}, {"07_diffuse", "diffuse"},
      {"08_transparency", "transparency"}, {"09_shadow", "shadow"}, {"10_phong", "whitted"},
      {"11_mirror", "whitted"}, {"12_glass", "whitted"}, {"13_whitted", "whitted"},
      {"14_primitives", "shadow"}, {"15_csg", "shadow"}, {"16_environment", "whitted"},
      {"18_antialiasing", "shadow", 16}, {"19_soft_shadows", "direct", 16}, {"20_lens", "shadow", 64},
      {"21_motion", "shadow", 64}, {"22_glossy", "path", 16},
      {"23_ambient_occlusion", "ambient-occlusion", 16}, {"24_path", "path", 16}, {"25_cornell", "path", 8},
      {"26_weekend", "path", 8}, {"27_normal_map", "whitted"}, {"34_fields", "diffuse"},
      {"35_blend", "diffuse"}, {"36_repetition", "diffuse"}, {"37_marched_shadow", "shadow"},
      {"38_fractal", "shadow"},
#if __has_include(<tiny_obj_loader.h>)  // otherwise this stage is not built
      {"17_mesh", "shadow"},
#endif
};

/// Rows of the stages that are built.
const std::vector<StageRow> built_stages =
    of_built_stages(all_stages, [](const StageRow& row) { return row.name; });

}  // namespace

TEST_CASE("every stage writes out.ppm in the requested size, and reports it in one line") {
  const StageRow row = GENERATE(from_range(built_stages));
  CAPTURE(row.name);
  const TemporaryFolder folder;
  const Outcome outcome = run_stage(row.name, "--size 16x12", folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == "");
  CHECK(without_times(outcome.out) ==
        "out.ppm: 16x12, " + row.integrator + ", rendered in 0.0 ms, written in 0.0 ms\n");
  CHECK(folder.count() == 1);

  const std::string file = bytes_of(folder / "out.ppm");
  if (row.name == "01_gradient") {
    CHECK(file.starts_with("P3\n16 12\n255\n"));
  } else {
    const std::string header = "P6\n16 12\n255\n";
    CHECK(file.starts_with(header));
    CHECK(file.size() == header.size() + 16 * 12 * 3);
  }
}

TEST_CASE("every stage takes every option") {
  const StageRow row = GENERATE(from_range(built_stages));
  CAPTURE(row.name);
  const TemporaryFolder folder;
  const Outcome outcome = run_stage(
      row.name, "-o a.ppm --size 7x5 --samples 3 --threads 2 --bits 16 --transfer srgb --plain --quiet",
      folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out == "");
  CHECK(outcome.err == "");
  CHECK(bytes_of(folder / "a.ppm").starts_with("P3\n7 5\n65535\n"));
  CHECK(folder.count() == 1);
}

TEST_CASE("options about rays and samples are refused for a picture that is drawn without any") {
  const TemporaryFolder folder;
  for (const auto& [option, arguments] : {std::pair{"--rays", "--pixel 3,4 --rays a.svg"},
                                          {"--shard", "--samples 4 --shard 0/2 -o a.shard"},
                                          {"--checkpoint", "--samples 4 --checkpoint c"}}) {
    CAPTURE(option);
    const Outcome outcome = run_stage("01_gradient", arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err == std::string("01_gradient: ") + option +
                             ": is for pictures that are drawn by rays, and this one is drawn without any\n"
                             "Run with --help for what is allowed.\n");
  }
  CHECK(folder.count() == 0);
}

TEST_CASE("the options --version and --help print to stdout and draw nothing") {
  const StageRow row = GENERATE(from_range(built_stages));
  CAPTURE(row.name);
  const TemporaryFolder folder;
  const Outcome version = run_stage(row.name, "--version", folder);
  CHECK(version.status == 0);
  CHECK(version.out == std::string("protostar ") + PROTOSTAR_VERSION + "\n");
  CHECK(version.err == "");

  const std::string help = stage_help(row.name, folder);
  for (const char* text : {"-o FILE",         "--crop X,Y,W,H",
                           "--size WxH",      "--samples N",
                           "--error E",       "--time S",
                           "--max-samples N", "--noise FILE.pfm",
                           "--clamp C",       "--every-pixel",
                           "--sampler NAME",  "--filter NAME",
                           "--seed N",        "--threads N",
                           "--bits 8|16",     "--transfer srgb|linear|gamma=G",
                           "--pixel X,Y",     "--explain FILE.json",
                           "--plain",         "--quiet",
                           "--help",          "--version"})
    CHECK_THAT(help, ContainsSubstring(text));
  for (const char* text : {"--rays FILE.svg|FILE.obj", "--shard I/N|slurm|mpi", "--checkpoint FILE"}) {
    CAPTURE(text);
    CHECK((help.find(text) != std::string::npos) == (row.name != "01_gradient"));  // which refuses them
  }
  CHECK_THAT(help, ContainsSubstring(row.name + " [OPTIONS]"));
  CHECK_THAT(help, ContainsSubstring(row.name == "01_gradient"     ? "[100x100]"
                                     : row.integrator == "whitted" ? "[1024x768]"
                                                                   : "[640x480]"));
  CHECK_THAT(help, ContainsSubstring("through its center [" + std::to_string(row.samples) + "]"));
  CHECK(folder.count() == 0);
}

// Tests of render compare the mean with the rays. Stage 01_gradient casts no rays.
TEST_CASE("the option --samples draws the mean of several rays a pixel in every stage") {
  const StageRow row = GENERATE(from_range(built_stages));
  CAPTURE(row.name);
  const std::string center = stage_picture(row.name, "--size 32x24 --samples 1");
  CHECK((stage_picture(row.name, "--size 32x24") == center) == (row.samples == 0));
  CHECK((stage_picture(row.name, "--size 32x24 --samples 4") == center) == (row.name == "01_gradient"));
}

TEST_CASE("the extension of the output file, in upper or lower case, selects its format") {
  struct Row {
    std::string file, magic;
  };
  const Row row =
      GENERATE(Row{"a.ppm", "P6\n"}, Row{"a.PPM", "P6\n"}, Row{".ppm", "P6\n"}, Row{"a.png", "\x89PNG"},
               Row{"a.b.PnG", "\x89PNG"}, Row{"a.pfm", "PF\n"}, Row{"a.ppm.Pfm", "PF\n"},
               Row{"a.hdr", "#?RADIANCE\n"}, Row{"a.Hdr", "#?RADIANCE\n"});
  CAPTURE(row.file);
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("06_color", "--size 4x3 -o " + row.file, folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.err == "");
  CHECK(outcome.out.starts_with(row.file + ": 4x3, "));
  CHECK(bytes_of(folder / row.file).starts_with(row.magic));
  CHECK(folder.count() == 1);
}

TEST_CASE("a PFM file holds linear light, whatever the stage's transfer") {
  const TemporaryFolder folder;
  for (const char* transfer : {"", " --transfer linear"}) {
    CHECK(run_stage("08_transparency", std::string("--size 1x1 -o a.pfm") + transfer, folder).status == 0);
    const std::string file = bytes_of(folder / "a.pfm");
    REQUIRE(file.size() == std::string("PF\n1 1\n-1.0\n").size() + 12);
    CHECK(file.starts_with("PF\n1 1\n-1.0\n"));
  }
}

TEST_CASE("tone mapping changes files of 8 or 16 bits, and no files of linear light") {
  // 13_whitted has white highlights above 1, whose hue is kept.
  const TemporaryFolder folder;
  CHECK(run_stage("13_whitted", "--size 128x96 -o a.pfm", folder).status == 0);
  CHECK(run_stage("13_whitted", "--size 128x96 -o a.hdr --transfer linear", folder).status == 0);
  const std::string pfm = bytes_of(folder / "a.pfm");
  const std::string header = "PF\n128 96\n-1.0\n";
  REQUIRE(pfm.size() == header.size() + 128 * 96 * 12);
  const std::string codes = stage_picture("13_whitted", "--size 128x96");
  const std::string codes_header = "P6\n128 96\n255\n";
  REQUIRE(codes.size() == codes_header.size() + 128 * 96 * 3);
  int above_1 = 0;
  WrongCases wrong;
  for (std::size_t y = 0; y < 96; ++y)
    for (std::size_t x = 0; x < 128; ++x) {
      std::array<float, 3> light{};
      std::memcpy(light.data(), pfm.data() + header.size() + ((95 - y) * 128 + x) * 12,
                  12);  // from the bottom
      const float largest = std::max({light[0], light[1], light[2], 1.0f});
      if (largest > 1) ++above_1;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto code = static_cast<unsigned char>(codes[codes_header.size() + (y * 128 + x) * 3 + c]);
        wrong.add(std::abs(static_cast<float>(code) - 255 * light[c] / largest) > 0.51f, light, "channel", c,
                  "has code", code);
      }
    }
  CHECK(above_1 > 100);
  CHECK(wrong == 0);
  CHECK(bytes_of(folder / "a.hdr").starts_with("#?RADIANCE\n"));
}

TEST_CASE("light is encoded with the given transfer, with 8 or 16 bits") {
  struct Row {
    std::string arguments, middle, last;  // codes of light 0.5 and 1 in a gradient of three pixels
  };
  const Row row = GENERATE(
      Row{"", "128", "255"}, Row{"--bits 8", "128", "255"}, Row{"--transfer linear", "128", "255"},
      Row{"--transfer gamma=1", "128", "255"}, Row{"--transfer gamma=2.2", "186", "255"},
      Row{"--transfer gamma=0.5", "64", "255"}, Row{"--transfer srgb", "188", "255"},
      Row{"--bits 16", "32768", "65535"}, Row{"--bits 16 --transfer gamma=2", "46340", "65535"},
      Row{"--bits 16 --transfer srgb", "48192", "65535"}, Row{"--transfer=srgb --plain", "188", "255"});
  CAPTURE(row.arguments);
  const auto gray = [](const std::string& code) { return code + "\t" + code + "\t" + code + "\t\t"; };
  CHECK(stage_picture("01_gradient", "--size 3x1 " + row.arguments) ==
        "P3\n3 1\n" + row.last + "\n" + gray("0") + gray(row.middle) + gray(row.last) + "\n");
}

TEST_CASE("a binary PPM has one byte or two per channel, the most significant first") {
  const std::string white8(3, '\xff'), white16(6, '\xff');
  CHECK(stage_picture("08_transparency", "--size 1x1 --transfer linear --bits 8").size() == 11 + 3);
  const std::string narrow = stage_picture("08_transparency", "--size 100x50");
  const std::string wide = stage_picture("08_transparency", "--size 100x50 --bits 16");
  CHECK(narrow.starts_with("P6\n100 50\n255\n" + white8));
  CHECK(wide.starts_with("P6\n100 50\n65535\n" + white16));
  CHECK(wide.size() - std::string("P6\n100 50\n65535\n").size() == 100 * 50 * 6);
  const std::size_t narrow_begin = std::string("P6\n100 50\n255\n").size();
  const std::size_t wide_begin = std::string("P6\n100 50\n65535\n").size();
  WrongCases wrong;
  for (std::size_t i = 0; i < std::size_t{100 * 50 * 3}; ++i) {
    const auto byte = [](const std::string& file, std::size_t at) {
      return static_cast<int>(static_cast<unsigned char>(file[at]));
    };
    const int code8 = byte(narrow, narrow_begin + i);
    const int code16 = 256 * byte(wide, wide_begin + 2 * i) + byte(wide, wide_begin + 2 * i + 1);
    wrong.add(2 * std::abs(257 * code8 - code16) > 257 + 1, "codes", code8,
              code16);  // both are rounded from the same light
  }
  CHECK(wrong == 0);
}

TEST_CASE("rows that consist of whole blocks of pixels are written completely, plain and with 16 bits") {
  const std::string file = stage_picture("08_transparency", "--size 8192x2 --bits 16 --plain");
  CHECK(file.starts_with("P3\n8192 2\n65535\n"));
  CHECK(file.ends_with("65535\t65535\t65535\t\t\n"));
  CHECK(std::count(file.begin(), file.end(), '\t') == 8192 * 2 * 4);
  CHECK(std::count(file.begin(), file.end(), '\n') == 3 + 2);
}

TEST_CASE("the picture does not depend on the number of threads") {
  const std::string expected = stage_picture("09_shadow", "--size 130x70 --threads 1");
  for (const char* threads : {"0", "2", "7", "100000"}) {
    CAPTURE(threads);
    CHECK(stage_picture("09_shadow", std::string("--size 130x70 --threads ") + threads) == expected);
  }
}

TEST_CASE("a picture may be one pixel wide or high") {
  const std::string size = GENERATE("1x1", "1x5000", "5000x1");
  CAPTURE(size);
  const std::string stage_name = GENERATE("01_gradient", "09_shadow");
  CHECK_THAT(stage_picture(stage_name, "--size " + size),
             ContainsSubstring(size.substr(0, size.find('x')) + " " + size.substr(size.find('x') + 1)));
}

TEST_CASE("an error on the command line is reported, with what is allowed, and nothing is drawn") {
  struct Row {
    std::string arguments;
    std::vector<std::string> named;
  };
  const std::string size = "WIDTHxHEIGHT, whole numbers of at least 1 whose product is at most 2^28";
  const std::string threads = "a whole number from 0 to 2147483647";
  const std::string transfer = "srgb, linear or gamma=G with a number G greater than 0";
  const std::string pixel = "X,Y, whole numbers of a pixel inside the picture";
  const std::string endings = "a file that ends in .ppm, .png, .pfm or .hdr, or a device or pipe that exists";
  const auto not_allowed = [](const std::string& option, const std::string& found,
                              const std::string& allowed) {
    return Row{option + " " + found,
               {option.substr(option.rfind(' ') + 1) + ": '" + found + "' is not " + allowed}};
  };
  const std::vector<Row> rows{
      {"--bogus", {"--bogus", "--help"}},
      {"--siz 3x3", {"--siz", "--help"}},
      {"-q", {"-q", "--help"}},
      {"stray", {"stray", "--help"}},
      {"-- stray", {"stray", "--help"}},
      not_allowed("--size", "0x480", size),
      not_allowed("--size", "640x0", size),
      not_allowed("--size", "-5x5", size),
      not_allowed("--size", "5x-5", size),
      not_allowed("--size", "+5x5", size),
      not_allowed("--size", "640", size),
      not_allowed("--size", "x", size),
      not_allowed("--size", "640x", size),
      not_allowed("--size", "x480", size),
      not_allowed("--size", "640xabc", size),
      not_allowed("--size", "640x480x3", size),
      not_allowed("--size", "6.5x5", size),
      not_allowed("--size", "1e3x5", size),
      not_allowed("--size", "0x10x5", size),
      not_allowed("--size", "nanx5", size),
      not_allowed("--size", "40000x40000", size),
      not_allowed("--size", "16385x16384", size),
      not_allowed("--size", "65536x65536", size),  // the product is 0 in 32 bits
      not_allowed("--size", "99999999999x1", size),
      not_allowed("--samples", "-1", "a whole number from 0 to 65536"),
      not_allowed("--samples", "65537", "a whole number from 0 to 65536"),
      not_allowed("--sampler", "random", "one of independent, stratified, halton, sobol, hammersley"),
      not_allowed("--filter", "Box", "one of box, tent, gaussian, mitchell, blackman-harris"),
      not_allowed("--seed", "-1", "a whole number from 0 to 18446744073709551615"),
      not_allowed("--seed", "18446744073709551616", "a whole number from 0 to 18446744073709551615"),
      not_allowed("--seed", "1e3", "a whole number from 0 to 18446744073709551615"),
      not_allowed("--threads", "-1", threads),
      not_allowed("--threads", "1.5", threads),
      not_allowed("--threads", "abc", threads),
      not_allowed("--threads", "99999999999", threads),
      not_allowed("--bits", "7", "8 or 16"),
      not_allowed("--bits", "-8", "8 or 16"),
      not_allowed("--bits", "8.0", "8 or 16"),
      not_allowed("--transfer", "foo", transfer),
      not_allowed("--transfer", "SRGB", transfer),
      not_allowed("--transfer", "2.2", transfer),
      not_allowed("--transfer", "gamma", transfer),
      not_allowed("--transfer", "gamma=", transfer),
      not_allowed("--transfer", "gamma=0", transfer),
      not_allowed("--transfer", "gamma=-1", transfer),
      not_allowed("--transfer", "gamma=nan", transfer),
      not_allowed("--transfer", "gamma=inf", transfer),
      not_allowed("--transfer", "gamma=1e999", transfer),
      not_allowed("--transfer", "gamma=2.2x", transfer),
      not_allowed("-o", "a.jpg", endings),
      not_allowed("-o", "a", endings),
      not_allowed("-o", "a.ppm/", endings),
      not_allowed("-o", "a.ppm.gz", endings),
      not_allowed("-o", "/dev/protostar", endings),
      not_allowed("--pixel", "5", pixel),
      not_allowed("--pixel", "5,", pixel),
      not_allowed("--pixel", "5,6,7", pixel),
      not_allowed("--pixel", "-1,6", pixel),
      not_allowed("--pixel", "5.0,6", pixel),
      not_allowed("--pixel", "640,0", pixel + " of 640x480"),
      not_allowed("--pixel", "0,480", pixel + " of 640x480"),
      not_allowed("--size 4x3 --pixel", "4,0", pixel + " of 4x3"),
      {"--size", {"--size", "WxH", "missing"}},
      {"--samples", {"--samples", "N", "missing"}},
      {"--pixel", {"--pixel", "X,Y", "missing"}},
      {"--explain a.json", {"--explain requires --pixel X,Y"}},
      {"--rays a.svg", {"--rays requires --pixel X,Y"}},
      not_allowed("--pixel 1,2 --explain", "a.txt", "a file that ends in .json"),
      not_allowed("--pixel 1,2 --explain", "json", "a file that ends in .json"),
      not_allowed("--pixel 1,2 --rays", "a.png", "a file that ends in .svg or .obj"),
      {"--threads", {"--threads", "N", "missing"}},
      {"--bits", {"--bits", "8|16", "missing"}},
      {"--transfer", {"--transfer", "srgb|linear|gamma=G", "missing"}},
      {"-o", {"-o", "FILE", "missing"}},
      not_allowed("--size", "--quiet", size),
      {"-o a.ppm -o b.ppm", {"-o", "1", "2"}},
      {"--plain=false", {"--plain takes no value: '--plain=false'"}},
      {"--quiet=7", {"--quiet takes no value: '--quiet=7'"}},
      {"--help=3", {"--help takes no value: '--help=3'"}},
      {"-h=3", {"-h takes no value: '-h=3'"}},
      {"--version=2", {"--version takes no value: '--version=2'"}},
      {"--size= 3x3", {"--size: a value is missing: '--size='"}},
      {"--size=", {"--size: a value is missing: '--size='"}},
      {"--bits 16 -o a.png", {"--bits: '16' is not possible in .png; .ppm can have 16 bits"}},
      {"--bits 16 -o a.PFM", {"--bits: '16' is not possible in .pfm; .ppm can have 16 bits"}},
      {"--bits 16 -o a.hdr", {"--bits: '16' is not possible in .hdr; .ppm can have 16 bits"}},
      {"--plain -o a.hdr", {"--plain: '.hdr' is not a format with a plain form; .ppm is"}},
      {"--transfer srgb -o a.hdr", {"--transfer: 'srgb' is not possible in .hdr, which holds linear light"}},
      {"--plain -o a.png", {"--plain: '.png' is not a format with a plain form; .ppm is"}},
      {"--plain -o a.pfm", {"--plain: '.pfm' is not a format with a plain form; .ppm is"}},
      {"--transfer srgb -o a.pfm", {"--transfer: 'srgb' is not possible in .pfm, which holds linear light"}},
      {"--transfer gamma=2.2 -o a.pfm", {"--transfer: 'gamma=2.2' is not possible in .pfm"}}};
  const TemporaryFolder folder;
  for (const Row& row : rows) {
    CAPTURE(row.arguments);
    const Outcome outcome = run_stage("09_shadow", row.arguments, folder);
    CHECK(outcome.status == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.err.starts_with("09_shadow: "));
    for (const std::string& text : row.named) CHECK_THAT(outcome.err, ContainsSubstring(text));
    CHECK(folder.count() == 0);
  }
}

TEST_CASE("an empty value of an option is refused") {
  const std::string option = GENERATE("-o", "--size", "--samples", "--threads", "--bits", "--transfer");
  CAPTURE(option);
  const TemporaryFolder folder;
  const Outcome outcome = run(stage("09_shadow", {option, ""}, folder / ""));
  CHECK(outcome.status == 2);
  CHECK(outcome.err.starts_with("09_shadow: " + option + ": '' is not "));
  CHECK(folder.count() == 0);
}

TEST_CASE("long values are shortened to their beginning and end in messages") {
  const TemporaryFolder folder;
  const std::string value = "begin" + std::string(5000, 'x') + "the end";
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--size", value}, {"--transfer", value}, {"-o", value}, {value}, {"--" + value}}) {
    CAPTURE(arguments[0].substr(0, 20));
    const Outcome outcome = run(stage("09_shadow", arguments, folder / ""));
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, ContainsSubstring("begin"));
    CHECK_THAT(outcome.err, ContainsSubstring("the end"));
    CHECK(outcome.err.size() < 500);
  }
  const Outcome outcome = run(stage("09_shadow", {"-o", value + ".ppm"}, folder / ""));
  CHECK(outcome.status == 1);
  CHECK(outcome.err.starts_with("09_shadow: cannot write 'beginxxx"));
  CHECK(outcome.err.ends_with("xxthe end.ppm': " + std::generic_category().message(ENAMETOOLONG) + "\n"));
  CHECK(outcome.err.size() < 600);
  CHECK(folder.count() == 0);
}

TEST_CASE("control characters in names and values are printed as \\x and two digits") {
  const TemporaryFolder folder;
  const std::string name = "a\x1b[31m\n\x9b\x7f ü.ppm", name_shown = "a\\x1b[31m\\x0a\\x9b\\x7f ü.ppm";
  const auto outcome_of = [&](const std::vector<std::string>& arguments) {
    Outcome outcome = run(stage("09_shadow", arguments, folder / ""));
    for (const std::string& text : {outcome.out, outcome.err})
      CHECK(text.find_first_of("\x1b\x9b\x7f") == std::string::npos);
    return outcome;
  };
  const Outcome drawn = outcome_of({"--size", "8x8", "-o", name});
  CHECK(drawn.status == 0);
  CHECK(drawn.out.starts_with(name_shown + ": 8x8, "));
  CHECK(fs::exists(folder / name));

  CHECK(outcome_of({"-o", "none/" + name}).err == cannot_write("09_shadow", "none/" + name_shown, ENOENT));
  CHECK_THAT(outcome_of({"-o", name + ".gz"}).err, ContainsSubstring("-o: '" + name_shown + ".gz' is not"));
  CHECK_THAT(outcome_of({"--size", name}).err, ContainsSubstring("--size: '" + name_shown + "' is not"));
  CHECK_THAT(outcome_of({name}).err, ContainsSubstring("'" + name_shown + "'"));
  CHECK_THAT(outcome_of({"--" + name}).err, ContainsSubstring("'--" + name_shown + "'"));
  CHECK_THAT(outcome_of({"--quiet=" + name}).err, ContainsSubstring("'--quiet=" + name_shown + "'"));
}

TEST_CASE("a usage error leaves an existing file unchanged") {
  const TemporaryFolder folder;
  put_bytes(folder / "out.ppm", "old");
  CHECK(run_stage("09_shadow", "--size 0x0", folder).status == 2);
  CHECK(bytes_of(folder / "out.ppm") == "old");
}

TEST_CASE("if no thread can be started the main thread draws the picture, unless more were requested") {
  const TemporaryFolder folder;
  const std::string not_caught =
      "09_shadow: Ctrl-C is not caught, since no thread can be started that waits for it: it ends the "
      "program "
      "at once, and what it leaves of a file the next run removes\n";
  const auto outcome_of = [&](const std::string& options) {
    return run_stage("09_shadow", "--size 130x70 " + options, folder, forbid_threads);
  };
  const std::string expected = stage_picture("09_shadow", "--size 130x70");
  for (const char* threads : {"1", "0"}) {
    const Outcome outcome = outcome_of(std::string("--threads ") + threads);
    CHECK(outcome.status == 0);
    CHECK(outcome.err == not_caught);
    CHECK(bytes_of(folder / "out.ppm") == expected);
    fs::remove(folder / "out.ppm");
  }
  CHECK(outcome_of("--quiet --threads 1").err == "");
  fs::remove(folder / "out.ppm");
  const Outcome outcome = outcome_of("--threads 4");
  CHECK(outcome.status == 1);
  CHECK(outcome.err == not_caught + "09_shadow: render: cannot start 4 threads; try 1 or 0: " +
                           std::generic_category().message(EAGAIN) + "\n");
  CHECK(folder.count() == 0);
}

#if !defined(ADDRESS_SANITIZER)  // it alone exceeds the limit
TEST_CASE("threads that draw need no more than 256 KiB of stack") {
  const StageRow row = GENERATE(from_range(built_stages));
  CAPTURE(row.name);
  const TemporaryFolder folder;
  const Outcome outcome = run_stage(row.name, "--size 32x24 --threads 2 --quiet", folder, [] {
    const rlimit limit{262'144, 262'144};
    setrlimit(RLIMIT_STACK, &limit);  // which glibc gives to threads as well
  });
  CHECK(outcome.status == 0);
}

TEST_CASE("a picture that does not fit into memory is refused with a message") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("02_sphere", "--size 268435456x1", folder, [] {
    const rlimit limit{500'000'000, 500'000'000};
    setrlimit(RLIMIT_AS, &limit);
  });
  CHECK(outcome.status == 1);
  CHECK(outcome.out == "");
  CHECK(outcome.err == "02_sphere: not enough memory for an image of this size\n");
  CHECK(folder.count() == 0);
}
#endif

TEST_CASE("progress is shown on a terminal, and then cleared, if a render takes longer than a second",
          "[long]") {
  if (!has_terminals()) {
    WARN("not tested: this system has no pseudo terminals");
    return;
  }
  const auto begun = [](const TemporaryFolder& folder, const std::string& arguments, bool terminal) {
    Command command = stage("15_csg", words(arguments), folder / "");
    command.terminal = terminal;
    return std::make_unique<Process>(command);
  };
  const TemporaryFolder first;
  const Outcome small = begun(first, "--size 64x48", true)->wait();
  CHECK(small.status == 0);
  CHECK(small.err == "");

  // Doubles the height until the render takes 1.5 s on this machine.
  std::string size;
  double ms = 0;
  for (int height = 400; ms < 1500; height *= 2) {
    size = "--size 400x" + std::to_string(height);
    const Outcome outcome = begun(first, size, true)->wait();
    CAPTURE(size, outcome.out);
    REQUIRE(outcome.status == 0);
    const std::size_t at = outcome.out.find("rendered in ");
    REQUIRE(at != std::string::npos);
    ms = std::stod(outcome.out.substr(at + std::strlen("rendered in ")));
    if (ms < 1000) continue;
    CHECK(outcome.err.starts_with("\r"));
    CHECK_THAT(outcome.err, ContainsSubstring(" %"));
    CHECK(outcome.err.ends_with("\r       \r"));
  }

  const TemporaryFolder second;
  const auto no_terminal = begun(first, size, false), quiet = begun(second, size + " --quiet", true);
  for (const auto* process : {&no_terminal, &quiet}) {
    const Outcome outcome = (*process)->wait();
    CHECK(outcome.status == 0);
    CHECK(outcome.out.empty() == (process == &quiet));
    CHECK(outcome.err == "");
  }
}

TEST_CASE("every stage draws a part of its picture with the bytes of the whole") {
  std::vector<StageRow> stages = all_stages;
  for (const char* name :
       {"08_naive", "09_naive", "30_fixed_step", "31_sphere_tracing", "32_enhanced", "33_certified"})
    stages.push_back({name, ""});
  const StageRow row =
      GENERATE_COPY(from_range(of_built_stages(stages, [](const StageRow& r) { return r.name; })));
  CAPTURE(row.name);
  constexpr std::size_t width = 40, height = 30, pixel = 12, x = 3, y = 7, columns = 21, rows = 11;
  const std::string options = "--size 40x30" + std::string(row.samples > 0 ? " --samples 2" : "");
  // PFM has three floats a pixel, and its last row first.
  const std::string whole = stage_picture(row.name, options, "whole.pfm"),
                    part = stage_picture(row.name, options + " --crop 3,7,21,11", "part.pfm");
  const std::size_t begin = whole.size() - width * height * pixel,
                    part_begin = part.size() - columns * rows * pixel;
  for (std::size_t i = 0; i < rows; ++i)
    CHECK(part.substr(part_begin + i * columns * pixel, columns * pixel) ==
          whole.substr(begin + ((height - y - rows + i) * width + x) * pixel, columns * pixel));
}
