#include "options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <protostar/image.hpp>
#include <protostar/io/scene_file.hpp>
#include <protostar/io/text.hpp>
#include <protostar/sampling/estimate.hpp>
#include <protostar/sampling/every_pixel.hpp>
#include <protostar/sampling/exact_sum.hpp>
#include <protostar/sampling/reconstruction.hpp>
#include <protostar/sampling/samplers.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "command_line.hpp"
#include "message.hpp"
#include "option_values.hpp"
#include "picture_file.hpp"
#include "shard_number.hpp"
#include "shared_render.hpp"

namespace {

using protostar::Transfer;
using protostar::detail::number_of;

struct Size {
  int width = 0, height = 0;
};

/// Returns the whole numbers of a text, which separators part; -1 stands for anything else.
std::vector<int> whole_numbers(std::string_view text, char separator) {
  std::vector<int> numbers;
  for (std::size_t begin = 0, end = 0; end != std::string_view::npos; begin = end + 1) {
    end = text.find(separator, begin);
    numbers.push_back(number_of<int>(text.substr(begin, end - begin)).value_or(-1));
  }
  return numbers;
}

Size read_size(std::string_view text) {
  const std::vector<int> sides = whole_numbers(text, 'x');
  if (sides.size() != 2 || sides[0] < 1 || sides[1] < 1 ||
      std::int64_t{sides[0]} * sides[1] > protostar::Image::max_pixels)
    refuse("--size", text, "WIDTHxHEIGHT, whole numbers of at least 1 whose product is at most 2^28");
  return {sides[0], sides[1]};
}

/// Part of a picture: its column and row, and its size.
struct Part {
  int x = 0, y = 0;
  Size size;
};

[[noreturn]] void refuse_crop(std::string_view text, const std::string& of_size) {
  refuse("--crop", text,
         "X,Y,W,H, whole numbers of a part of at least one pixel that lies inside the picture" + of_size);
}

Part read_crop(std::string_view text) {
  const std::vector<int> numbers = whole_numbers(text, ',');
  if (numbers.size() != 4 || numbers[0] < 0 || numbers[1] < 0 || numbers[2] < 1 || numbers[3] < 1)
    refuse_crop(text, "");
  return {.x = numbers[0], .y = numbers[1], .size = {.width = numbers[2], .height = numbers[3]}};
}

/// Turns options for a picture into options for a part of it; refuses a part that is not inside.
void crop_to(const Part& part, std::string_view text, Options& options) {
  const auto is_inside = [](int first, int size, int whole) {
    return size <= whole && first <= whole - size;
  };
  if (!is_inside(part.x, part.size.width, options.width) ||
      !is_inside(part.y, part.size.height, options.height))
    refuse_crop(text, " of " + std::to_string(options.width) + "x" + std::to_string(options.height));
  options.crop = {.x = part.x, .y = part.y, .width = options.width, .height = options.height};
  options.width = part.size.width;
  options.height = part.size.height;
}

[[noreturn]] void refuse_pixel(std::string_view text, const std::string& of_size) {
  refuse("--pixel", text, "X,Y, whole numbers of a pixel inside the picture" + of_size);
}

Pixel read_pixel(std::string_view text) {
  const std::vector<int> numbers = whole_numbers(text, ',');
  if (numbers.size() != 2 || numbers[0] < 0 || numbers[1] < 0) refuse_pixel(text, "");
  return {numbers[0], numbers[1]};
}

/// Turns options for a picture, or a part of one, into those for a pixel of the picture; refuses a pixel that
/// is not inside.
void explain_pixel(const Pixel& pixel, std::string_view text, Options& options) {
  if (options.crop.width > 0) {
    options.width = options.crop.width;
    options.height = options.crop.height;
    options.crop = {};
  }
  if (pixel.x >= options.width || pixel.y >= options.height)
    refuse_pixel(text, " of " + std::to_string(options.width) + "x" + std::to_string(options.height));
  options.pixel = pixel;
}

/// Refuses the name of a file about a pixel unless it ends in one of the endings.
void check_name(const std::string& option, const std::string& name,
                std::initializer_list<std::string_view> endings) {
  std::string names;
  for (const std::string_view ending : endings) {
    if (ends_in(name, ending)) return;
    names += (names.empty() ? "" : " or ") + std::string(ending);
  }
  refuse(option, name, "a file that ends in " + names);
}

std::string read_name(const std::string& option, std::string_view text, const auto& allowed) {
  std::string names;
  for (const std::string_view name : allowed) {
    if (name == text) return std::string(text);
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  refuse(option, text, "one of " + names);
}

std::uint64_t read_seed(std::string_view text) {
  const auto seed = number_of<std::uint64_t>(text);
  if (!seed) refuse("--seed", text, "a whole number from 0 to 18446744073709551615");
  return *seed;
}

/// Reads a finite number for which is_allowed is true.
double read_number(const std::string& option, std::string_view text, bool (*is_allowed)(double),
                   const std::string& allowed) {
  const auto value = number_of<double>(text);
  if (!value || !std::isfinite(*value) || !is_allowed(*value)) refuse(option, text, allowed);
  return *value;
}

double read_in_float(const std::string& option, std::string_view text) {
  return read_number(
      option, text, [](double x) { return std::abs(x) <= std::numeric_limits<float>::max(); },
      "a number of at most 3.4e38 in magnitude, which a float holds");
}

double read_above_0(const std::string& option, std::string_view text) {
  return read_number(
      option, text, [](double x) { return x > 0; }, "a finite number greater than 0");
}

/// Seconds of the longest timeout, 32 years; the system's timer takes no number above 2^63.
constexpr double longest_timeout = 1e9;

double read_timeout(std::string_view text) {
  return read_number(
      "--timeout", text, [](double x) { return 0 <= x && x <= longest_timeout; },
      "a number of seconds from 0 to 1e9");
}

/// Options of the command line that ask for a picture in passes, as far as they are given.
struct PassTexts {
  std::string error, seconds, max_samples, noise, clamp;
  bool every_pixel = false;
};

/// Declares the options that ask for a picture in passes.
void add_pass_options(CommandLine& line, PassTexts& texts) {
  line.add_option("--error", texts.error, "E",
                  "Draw samples until the picture's RMSE, in linear light, is at most that (95 %)");
  line.add_option("--time", texts.seconds, "S",
                  "Draw as many samples as fit into so many seconds, and tell the error");
  line.add_option("--max-samples", texts.max_samples, "N",
                  "With --error or --time: samples to end at [65536]");
  line.add_option("--noise", texts.noise, "FILE.pfm", "A file for the standard error of each pixel");
  line.add_option("--clamp", texts.clamp, "C", "The largest light of a sample, in each channel [none]");
  line.add_flag("--every-pixel", texts.every_pixel,
                "With --error and --clamp: each channel of each pixel is within E, proven");
}

/// Reads the values of the options that ask for a picture in passes, as far as they are given.
void read_pass_options(const CommandLine& line, const PassTexts& texts, Options& options) {
  if (line.given("--error")) options.error = read_above_0("--error", texts.error);
  if (line.given("--time")) options.seconds = read_above_0("--time", texts.seconds);
  if (line.given("--clamp")) options.clamp = read_above_0("--clamp", texts.clamp);
  if (line.given("--noise")) check_name("--noise", texts.noise, {".pfm"});
  if (line.given("--noise") && is_same_place(texts.noise, options.output))
    refuse("--noise", texts.noise, "another file than the picture's");
  if (line.given("--max-samples"))
    options.max_samples = read_whole(
        "--max-samples", texts.max_samples, [](int n) { return n >= 2 && n <= protostar::most_samples; },
        "a whole number from 2 to " + std::to_string(protostar::most_samples));
  options.noise = texts.noise;
  options.every_pixel = texts.every_pixel;
}

/// Names of the settings that other options may exclude, for messages: the option, or the key of the scene
/// file if the option is not given.
struct SettingNames {
  std::string sampler, filter;
};

/// Message about an option that excludes an error, if the scene asks for one.
constexpr const char* of_scenes_error =
    "needs a known number of samples, and the scene asks for an error; --samples N takes its place";

/// Refuses options of passes that make no sense together, when all settings are known.
void check_passes(const PassTexts& texts, const SettingNames& names, const Options& options) {
  const bool is_open = options.error > 0 || options.seconds > 0;
  if (!texts.max_samples.empty() && !is_open) throw UsageError("--max-samples requires --error or --time");
  if (options.every_pixel && options.error == 0) throw UsageError("--every-pixel requires --error E");
  if (options.every_pixel && options.clamp == 0)
    throw UsageError("--every-pixel requires --clamp C: without a largest light nothing can be proven");
  if (options.every_pixel && options.filter == "mitchell")
    refuse(names.filter, options.filter, "possible with --every-pixel, since it has negative weights");
  if (!options.noise.empty() && !is_open && options.samples < 2)
    throw UsageError("--noise requires --error, --time or --samples N of at least 2");
  if (options.in_passes() && (options.sampler == "hammersley" || options.sampler == "stratified"))
    refuse(names.sampler, options.sampler,
           std::string("possible with --error, --time and --noise: ") +
               (options.sampler == "hammersley" ? "its numbers are the same in every pixel and for every seed"
                                                : "its samples depend on each other and on their number") +
               ", so they tell no error; sobol, halton and independent do");
  if (options.pixel && options.error > 0 && texts.error.empty()) throw UsageError("--pixel", of_scenes_error);
  if (options.pixel && (options.in_passes() || options.clamp > 0))
    throw UsageError("--pixel excludes --error, --time, --noise and --clamp; --samples N sets the samples");
}

/// Refuses an error that cannot be promised for as many pixels as are drawn, by the option that asks for it
/// or for these pixels. If neither is given, throws std::runtime_error about the scene file.
void check_promise(const PassTexts& texts, const Options& options, std::string_view crop,
                   std::string_view size, const std::string& scene) {
  using protostar::PictureError, protostar::ExactSum;
  const protostar::Tile drawn = options.drawn();
  if (options.error > 0 && !options.every_pixel && drawn.pixel_count() < PictureError::fewest_pixels) {
    const std::string takes = "it takes at least " + std::to_string(PictureError::fewest_pixels) +
                              " pixels, or --every-pixel",
                      for_these = "possible for " + std::to_string(drawn.width()) + "x" +
                                  std::to_string(drawn.height()) + " pixels: " + takes,
                      with_that = "possible with the scene's error: " + takes;
    if (!texts.error.empty()) refuse("--error", texts.error, for_these);
    if (!crop.empty()) refuse("--crop", crop, with_that);
    if (!size.empty()) refuse("--size", size, with_that);
    throw std::runtime_error(scene + ": /settings/error: " + protostar::shown(options.error) + " is not " +
                             for_these);
  }
  if (!options.every_pixel) return;
  if (!(options.error > ExactSum::largest_rounding))
    throw UsageError("--every-pixel", "an error of " + protostar::shown(options.error) +
                                          " is not greater than 2^-48 (3.6e-15), below which light counts "
                                          "as black");
  const double least = protostar::EveryPixel(options.error, options.clamp, drawn).least_samples();
  if (least > options.max_samples)
    throw UsageError("--every-pixel", "an error of " + protostar::shown(options.error) + " with --clamp " +
                                          texts.clamp + " takes at least " + protostar::shown(least) +
                                          " samples, more than the " + std::to_string(options.max_samples) +
                                          " that --max-samples allows");
}

/// Refuses the sampler without chance for an integrator that draws by chance.
void check_sampler(const SettingNames& names, const Options& options) {
  if (options.sampler == "hammersley" && protostar::draws_by_chance(options.integrator))
    refuse(names.sampler, options.sampler,
           "possible here: " + protostar::why_not_hammersley(options.integrator));
}

/// Returns the seconds after which `render` gives up a scene file, unless it is told: ten for each pixel,
/// and those of --time. Scene files allow 2^22 rays through a pixel, and a few microseconds for each of them
/// are common.
double default_timeout(const Options& options) {
  return 10 * static_cast<double>(options.drawn().pixel_count()) + std::min(options.seconds, longest_timeout);
}

ShardNumber read_shard(std::string_view text) {
  try {
    return read_shard_number(text);
  } catch (const std::invalid_argument& error) {
    throw UsageError("--shard", error.what());
  }
}

/// Refuses options about rays and samples for a picture that is drawn without any.
void check_rays(const CommandLine& line, const Options& options) {
  if (!options.fills_whole) return;
  for (const char* const option : {"--shard", "--checkpoint", "--rays"})
    if (line.given(option))
      throw UsageError(option, "is for pictures that are drawn by rays, and this one is drawn without any");
}

/// Refuses options that make no sense with a shard or a checkpoint, and .shard files of whole pictures.
void check_parts(const CommandLine& line, const Options& options) {
  for (const char* const part : {"--shard", "--checkpoint"})
    for (const char* const other :
         {"--pixel", "--error", "--time", "--every-pixel", "--noise", "--max-samples"})
      if (line.given(part) && line.given(other))
        throw UsageError(std::string(part) + " excludes " + other +
                         (other == std::string_view("--pixel")
                              ? ", which draws nothing"
                              : ", which needs the samples of the whole picture"));
  const std::string output = options.output.string();
  if (options.shard && !ends_in(output, ".shard"))
    refuse("--shard", output, "a .shard file, which -o has to name");
  if (!options.shard && ends_in(output, ".shard"))
    refuse("-o", output, "the file of a picture, but of a part of one, which --shard I/N asks for");
  if (line.given("--checkpoint") && options.checkpoint.empty())
    refuse("--checkpoint", "", "the name of a file");
  if (line.given("--checkpoint") && is_same_place(options.checkpoint, options.output))
    refuse("--checkpoint", options.checkpoint.string(), "another file than that of -o");
}

/// Refuses outputs that would replace a file that the scene was read from.
void check_outputs(const Options& options, const std::vector<std::filesystem::path>& files) {
  const std::filesystem::path picture = options.pixel ? std::filesystem::path() : options.output;
  for (const auto& [option, output] : {std::pair{"-o", picture},
                                       {"--noise", options.noise},
                                       {"--explain", options.explain},
                                       {"--rays", options.rays}})
    refuse_replacing(option, output, files, "the scene");
}

/// Refuses pictures whose work cannot be shared: those that are no sums of samples. Shards take Sobol' points
/// unless another sampler is asked for. `crop` is the text of the option.
void check_sums(const SettingNames& names, Options& options, std::string_view crop) {
  if (!options.shard && options.checkpoint.empty()) return;
  const std::string option = options.shard ? "--shard" : "--checkpoint";
  if (options.in_passes()) throw UsageError(option, of_scenes_error);
  if (options.samples < 2)
    throw UsageError(option, "shares sums of samples, and the picture has " +
                                 (options.samples == 1 ? std::string("one sample a pixel")
                                                       : "one ray through each pixel's center") +
                                 "; --samples N with a number N of at least 2 is needed");
  if (!options.shard) return;
  if (options.sampler.empty()) options.sampler = "sobol";
  if (options.sampler == "hammersley")
    refuse(names.sampler, options.sampler,
           "possible with --shard: its places are the same in all pixels and at any seed, so that halves of "
           "the samples cannot tell the error of the others");
  if (options.crop.width > 0 && options.tone == protostar::Tone::scale_image)
    refuse("--crop", crop, "possible with --shard for the tone scale-image, which needs the whole picture");
}

}  // namespace

void refuse_replacing(const std::string& option, const std::filesystem::path& output,
                      const std::vector<std::filesystem::path>& files, const std::string& of_what) {
  std::error_code error;  // of a file that cannot be read, which the reader tells
  for (const std::filesystem::path& file : files)
    if (std::filesystem::is_regular_file(file, error) && is_same_place(output, file))
      refuse(option, output.string(), "another file than those of " + of_what);
}

std::optional<Options> parse_options(int argc, const char* const* argv, const StageDefaults& defaults,
                                     const std::string& program, int& status) {
  Options options{.program = program,
                  .plain = defaults.plain,
                  .fills_whole = defaults.fills_whole,
                  .numbers = defaults.numbers};
  std::vector<std::string> numbers(options.numbers.size());
  std::string output = options.output.string(), size, threads, shard, checkpoint;
  std::string scene, integrator, samples, sampler, filter, seed, crop, timeout, pixel, explain, rays;
  PassTexts passes;
  bool confine = false;
  const bool of_scene = static_cast<bool>(defaults.read_scene);
  const auto if_by_rays = [&](const std::string& help) { return defaults.fills_whole ? "" : help; };
  const auto or_of_scene = [&](const std::string& text) { return of_scene ? "the scene's" : text; };

  CommandLine line(
      of_scene ? "Draws the picture of a scene file." : "Draws the picture of one section of the tutorial.",
      program);
  line.add_option("-o", output, "FILE", "The picture's file: " + std::string(format_endings) + " [out.ppm]");
  line.add_option("--size", size, "WxH",
                  "Its size in pixels [" +
                      or_of_scene(std::to_string(defaults.width) + "x" + std::to_string(defaults.height)) +
                      "]");
  line.add_option("--samples", samples, "N",
                  "Rays through each pixel; 0: one through its center [" +
                      or_of_scene(std::to_string(defaults.samples)) + "]");
  line.add_option("--sampler", sampler, "NAME",
                  "Where samples are: independent, stratified, halton, sobol or hammersley [" +
                      or_of_scene("hammersley, or sobol if the stage draws by chance") + "]");
  line.add_option("--filter", filter, "NAME",
                  "What places around a pixel count: box, tent, gaussian, mitchell or blackman-harris [" +
                      or_of_scene(defaults.filter) + "]");
  line.add_option(
      "--seed", seed, "N",
      "Another whole number gives other random numbers [" + or_of_scene(std::to_string(defaults.seed)) + "]");
  add_pass_options(line, passes);
  line.add_option("--threads", threads, "N", "How many threads work on it; 0: one for each core [0]");
  FileOptions file;
  file.add_to(line, or_of_scene(name_of(defaults.transfer)), defaults.plain ? ", as here without it" : "");
  line.add_option(
      "--shard", shard, "I/N|slurm|mpi",
      if_by_rays("Draw a part of the samples, part I of N from 0 on, into a .shard file for merge; slurm and "
                 "mpi: I and N are those of the job"));
  line.add_option("--checkpoint", checkpoint, "FILE",
                  if_by_rays("Save the state of the work in this file, and go on from it if it is there"));
  line.add_option("--crop", crop, "X,Y,W,H", "Only W x H pixels of the picture, from column X and row Y on");
  if (!defaults.shows.empty()) {
    std::string names = defaults.integrator;
    for (const std::string& name : defaults.shows) names += ", " + name;
    line.add_option("--show", integrator, "NAME",
                    "What light a ray brings: " + names + " [" + defaults.integrator + "]");
  }
  if (of_scene) {
    line.add_word("scene", scene, "SCENE.json", "The scene, a file as docs/scene-format.md has it");
    line.add_option("--integrator", integrator, "I",
                    "What light a ray brings, such as color or shadow [the scene's]");
    line.add_option("--timeout", timeout, "SECONDS",
                    "Give up when drawing takes more seconds than that; 0: never [10 for each pixel, and "
                    "those of --time]");
    line.add_flag("--confine", confine, "Refuse images and meshes that are not inside the scene's folder");
  }
  line.add_option("--pixel", pixel, "X,Y",
                  "Draw nothing, but tell why this pixel, counted from 0,0 at the upper left, has its color");
  line.add_option("--explain", explain, "FILE.json", "With --pixel: a file for all of its numbers");
  line.add_option("--rays", rays, "FILE.svg|FILE.obj",
                  if_by_rays("With --pixel: a file for a drawing of its rays"));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    line.add_option(options.numbers[i].name, numbers[i], "X",
                    options.numbers[i].help + " [" + in_digits(options.numbers[i].value, 6) + "]");
  line.add_flag("--quiet", options.quiet, "Print nothing but errors");

  try {
    if (!line.read(argc, argv)) return std::nullopt;
    options.output = output;
    if (line.given("--shard")) options.shard = read_shard(shard);
    options.checkpoint = checkpoint;
    check_rays(line, options);
    check_parts(line, options);
    options.format = options.shard ? Options::Format::shard : format_of(options.output, "-o");
    const std::optional<Transfer> own_transfer = file.read(line, options);
    std::optional<Size> own_size;
    std::optional<Part> part;
    std::optional<Pixel> own_pixel;
    std::optional<std::string> own_integrator, own_sampler, own_filter;
    std::optional<std::uint64_t> own_seed;
    std::optional<int> own_samples;
    double own_timeout = 0;
    if (line.given("--size")) own_size = read_size(size);
    if (line.given("--crop")) part = read_crop(crop);
    if (line.given("--pixel")) own_pixel = read_pixel(pixel);
    for (const auto& [option, name] : {std::pair{"--explain", explain}, {"--rays", rays}})
      if (line.given(option) && !own_pixel)
        throw UsageError(std::string(option) + " requires --pixel X,Y, which names the pixel");
    if (line.given("--explain")) check_name("--explain", explain, {".json"});
    if (line.given("--rays")) check_name("--rays", rays, {".svg", ".obj"});
    options.explain = explain;
    options.rays = rays;
    if (line.given("--integrator"))
      own_integrator = read_name("--integrator", integrator, protostar::integrator_names);
    if (line.given("--show")) {
      std::vector<std::string> names = defaults.shows;
      names.insert(names.begin(), defaults.integrator);
      own_integrator = read_name("--show", integrator, names);
    }
    if (line.given("--sampler")) own_sampler = read_name("--sampler", sampler, protostar::sampler_names);
    if (line.given("--filter"))
      own_filter = read_name("--filter", filter, protostar::ReconstructionFilter::names);
    if (line.given("--seed")) own_seed = read_seed(seed);
    if (line.given("--samples"))
      own_samples = read_whole(
          "--samples", samples, [](int n) { return n >= 0 && n <= protostar::most_samples; },
          "a whole number from 0 to " + std::to_string(protostar::most_samples));
    if (line.given("--samples") + line.given("--error") + line.given("--time") > 1)
      throw UsageError("each of --samples, --error and --time excludes the others");
    read_pass_options(line, passes, options);
    if (line.given("--threads"))
      options.threads = read_whole(
          "--threads", threads, [](int n) { return n >= 0; }, "a whole number from 0 to 2147483647");
    if (line.given("--timeout")) own_timeout = read_timeout(timeout);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (line.given(options.numbers[i].name))
        options.numbers[i].value =
            (options.numbers[i].positive ? read_above_0 : read_in_float)(options.numbers[i].name, numbers[i]);

    // The scene is read when nothing else is wrong. Without --size, only the scene tells the size of the
    // picture, and thus whether the crop lies inside.
    const auto crop_to_part = [&](const Size& whole) {
      options.width = whole.width;
      options.height = whole.height;
      if (part) crop_to(*part, crop, options);
      if (own_pixel) explain_pixel(*own_pixel, pixel, options);
    };
    if (own_size) crop_to_part(*own_size);
    const StageDefaults settings =
        of_scene ? defaults.read_scene(scene, {.confine = confine, .threads = options.threads}) : defaults;
    if (!own_size) crop_to_part({settings.width, settings.height});
    options.integrator = own_integrator.value_or(settings.integrator);
    // Any of --samples, --error and --time takes the place of the samples or the error of the settings.
    const bool is_open = options.error > 0 || options.seconds > 0;
    options.samples = own_samples.value_or(is_open ? 0 : settings.samples);
    if (!own_samples && !is_open) options.error = settings.error;
    options.sampler = own_sampler.value_or(settings.sampler);
    options.filter = own_filter.value_or(settings.filter);
    options.seed = own_seed.value_or(settings.seed);
    options.transfer = own_transfer.value_or(settings.transfer);
    options.tone = settings.tone;
    options.exposure = settings.exposure;
    check_outputs(options, settings.files);
    const auto name_of_setting = [&](const std::string& name) {
      return of_scene && !line.given("--" + name) ? scene + ": /settings/" + name : "--" + name;
    };
    const SettingNames names{.sampler = name_of_setting("sampler"), .filter = name_of_setting("filter")};
    check_sampler(names, options);
    check_passes(passes, names, options);
    check_promise(passes, options, crop, size, scene);
    check_sums(names, options, crop);
    if (options.shard || !options.checkpoint.empty())
      options.scene = settings.files.empty() ? program : "files " + fingerprint_of(settings.files);
    if (line.given("--timeout"))
      options.timeout = own_timeout;
    else if (of_scene)
      options.timeout = default_timeout(options);
    return options;
  } catch (const UsageError& error) {
    print_usage_error(program, error);
    status = 2;
    return std::nullopt;
  }
}
