#include "stage.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <protostar/encode.hpp>
#include <protostar/error_number.hpp>
#include <protostar/output_file.hpp>
#include <protostar/pfm.hpp>
#include <protostar/sampling/every_pixel.hpp>
#include <protostar/sampling/reconstruction.hpp>
#include <protostar/sampling/samplers.hpp>
#include <protostar/shown.hpp>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "command_line.hpp"
#include "interrupt.hpp"
#include "message.hpp"
#include "option_values.hpp"
#include "picture_file.hpp"

using namespace protostar;

namespace {

double milliseconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

/// Returns true if a path is the file of stdout, so that a line printed there would end up in the picture.
bool is_stdout(const std::filesystem::path& path) {
  struct stat file, standard;
  return stat(path.c_str(), &file) == 0 && fstat(STDOUT_FILENO, &standard) == 0 &&
         file.st_dev == standard.st_dev && file.st_ino == standard.st_ino;
}

/// Returns an error with two digits.
std::string in_short(double error) { return in_digits(error, 2); }

Image part_of(const Image& whole, const Crop& crop, int width, int height) {
  Image part(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) part(x, y) = whole(crop.x + x, crop.y + y);
  return part;
}

void flush(std::FILE* stream, const char* name) {
  if (std::fflush(stream) != 0 || std::ferror(stream) != 0)
    throw std::system_error(detail::error_number(), std::generic_category(),
                            std::string("cannot write ") + name);
}

/// Returns the message for a picture that is not done in time.
std::string timeout_text(const Options& options) {
  return "the picture is not done after " + shown(options.timeout) +
         " seconds; --timeout sets how many it may take";
}

}  // namespace

Stage::Stage(const Options& options, StopToken stop)
    : options_(options), stop_(std::move(stop)), progress_(options.quiet) {
  if (options.shard || !options.checkpoint.empty()) begin_shared();
  if (options.pixel) begin_explanation();
}

Image Stage::image() const {
  if (options_.pixel) return Image(options_.width, options_.height);
  check_size(options_.format, options_.width, options_.height);
  check_output(options_.output);
  if (!options_.noise.empty()) check_output(options_.noise);
  if (options_.draws_more()) return Image(options_.crop.width, options_.crop.height);
  return Image(options_.width, options_.height);
}

void Stage::check_output(const std::filesystem::path& path) const {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool is_device = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
                         !std::filesystem::is_directory(status);
  if (is_device && OutputFile::descriptor_of(path) < 0) {
    // Opening a pipe or a device is an event; hence only its permission is tested.
    if (faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0)
      throw std::system_error(errno, std::generic_category(), "cannot write '" + path.string() + "'");
  } else if (OutputFile(path).is_in_place() && !options_.quiet) {
    print_error(options_.program,
                "cannot replace '" + path.string() + "', which is a mount point: it is written in place");
  }
}

StageRenderOptions Stage::render_options() {
  start_ = Clock::now();
  StageRenderOptions options({.samples = options_.samples,
                              .sampler = sampler_named(options_.sampler).value_or(SamplerChoice{}),
                              .filter = ReconstructionFilter::named(options_.filter),
                              .seed = options_.seed,
                              .clamp = options_.clamp,
                              .crop = options_.draws_more() ? Crop{} : options_.crop,
                              .threads = options_.threads,
                              .stop = stop_,
                              .progress = [this](double done) { progress_.show(done, note_on_passes()); }});
  if (options_.in_passes()) set_passes(options);
  if (options_.pixel) {
    options.draws = options_.tone == Tone::scale_image && !options_.is_linear();
    options.explanation = explanation_.get();
  }
  if (shared_) {
    share(options);
  } else if (options_.shard) {
    options.draws = false;  // a second picture, to compare the first with
  }
  return options;
}

void Stage::set_passes(RenderOptions& options) {
  if (told_passes_) {  // a second picture, to compare with the first
    options.samples = report_.samples;
    if (!options.sampler.is_made()) options.sampler = sampler_of<SobolSampler>;
    return;
  }
  options.error = options_.error;
  options.seconds = options_.seconds;
  options.max_samples = options_.max_samples;
  options.every_pixel = options_.every_pixel;
  options.report = &report_;
  if (!options_.noise.empty()) options.standard_error = &standard_error_;
  if (options_.every_pixel) {
    const EveryPixel price(options_.error, options_.clamp, options_.drawn());
    print("every pixel to within " + shown(options_.error) + " takes at least " +
          shown(price.least_samples()) + " samples in each");
  }
}

StageRenderOptions Stage::render_options(const Sphere& sphere) {
  StageRenderOptions options = render_options();
  options.sphere = &sphere;
  return options;
}

void Stage::save(const Image& image) {
  progress_.clear();  // the calling thread need not be the one that does the last tile
  if (options_.pixel) {
    if (!stop_.stop_requested()) tell(image);
    return;
  }
  const auto rendered = Clock::now();
  std::string units;
  try {
    if (!stop_.stop_requested()) units = write(image);
  } catch (...) {
    keep_shared();
    throw;
  }
  if (stop_.stop_requested()) return keep_shared();
  std::array<char, 128> times;
  std::snprintf(times.data(), times.size(), ", %s in %.2f ms, written in %.2f ms", options_.work.c_str(),
                milliseconds(rendered - start_), milliseconds(Clock::now() - rendered));
  print(shown(options_.output.string()) + ": " + units + std::to_string(options_.width) + "x" +
        std::to_string(options_.height) + ", " + options_.integrator + times.data());
  if (options_.in_passes()) tell_passes();
  if (shared_) end_shared();
}

std::string Stage::write(const Image& image) {
  if (options_.in_passes() && !told_passes_ && report_.samples == 0) {  // it was drawn without rays
    report_.is_met = true;
    standard_error_ = Image(image.width(), image.height());
  }
  const std::string units = shared_ ? save_shared() : std::string();
  if (options_.shard) {
    // The shard is the file.
  } else if (!options_.draws_more() && (options_.tone == Tone::clip || options_.is_linear())) {
    write_picture(image, options_, stop_);
  } else {
    Image toned = image;
    if (!options_.is_linear()) apply(options_.tone, toned);
    if (options_.draws_more()) toned = part_of(toned, options_.crop, options_.width, options_.height);
    write_picture(toned, options_, stop_);
  }
  if (options_.in_passes() && !told_passes_ && !options_.noise.empty()) {
    if (options_.draws_more())
      standard_error_ = part_of(standard_error_, options_.crop, options_.width, options_.height);
    save_pfm(standard_error_, options_.noise, stop_);
  }
  return units;
}

std::string Stage::note_on_passes() const {
  std::string note;
  if (!options_.in_passes() || told_passes_) return note;
  if (report_.samples > 0) note += ", " + std::to_string(report_.samples) + " samples";
  const double error = options_.every_pixel ? report_.pixel_error : report_.error;
  if (std::isfinite(error)) note += ", error " + in_short(error);
  if (std::isfinite(report_.seconds_left))
    note += ", " + in_digits(std::ceil(report_.seconds_left), 15) + " s left";
  return note;
}

void Stage::tell_passes() {
  told_passes_ = true;
  if (report_.samples == 0) return print("no samples, no error");
  const std::string samples = std::to_string(report_.samples);
  std::string line = samples + " samples in each pixel, RMSE about " + in_short(report_.error);
  const bool is_sure = options_.drawn().pixel_count() >= PictureError::fewest_pixels;
  if (options_.every_pixel)
    line += ", no channel of any pixel off by more than " + in_short(report_.pixel_error) + " (95 %)";
  else if (is_sure)
    line += ", at most " + in_short(report_.bound) + " (95 %)";
  if (options_.seconds > 0)
    line += "; --samples " + samples + (options_.sampler.empty() ? " --sampler sobol" : "") +
            " in the place of --time draws the same";
  print(line);
  if (!report_.is_met && !stop_.stop_requested())
    print_error(options_.program, "the error is not surely at most " + shown(options_.error) + " after " +
                                      samples + " samples in each pixel, but " +
                                      in_short(options_.every_pixel ? report_.pixel_error : report_.bound) +
                                      "; --max-samples sets how many there may be");
}

void Stage::compare(const Image& image, const Image& exact) const {
  if (options_.pixel || options_.shard) return;
  const Encoder encode(Gamma{2.2}, 255);
  const auto differs = [&](float a, float b) { return std::abs(encode(a) - encode(b)) > 1; };
  std::int64_t wrong = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Color a = image(x, y), b = exact(x, y);
      if (differs(a.r, b.r) || differs(a.g, b.g) || differs(a.b, b.b)) ++wrong;
    }
  print(std::to_string(wrong) + " of " + std::to_string(std::int64_t{image.width()} * image.height()) +
        " pixels are wrong");
}

void Stage::tell_range(const Image& numbers, const std::string& what) const {
  if (options_.pixel || options_.shard) return;
  double least = infinity, most = 0, sum = 0;
  std::int64_t count = 0;
  for (int y = 0; y < numbers.height(); ++y)
    for (int x = 0; x < numbers.width(); ++x) {
      const double number = numbers(x, y).r;
      if (!(number >= 0)) continue;
      least = std::min(least, number);
      most = std::max(most, number);
      sum += number;
      ++count;
    }
  if (count == 0) return print(what + ": none");
  char line[96];
  std::snprintf(line, sizeof line, ": %.4g at least, %.4g on average, %.4g at most", least,
                sum / static_cast<double>(count), most);
  print(what + line);
}

double Stage::number(const std::string& option) const {
  for (const NumberOption& own : options_.numbers)
    if (own.name == option) return own.value;
  throw std::logic_error("a stage asks for an option that it has not declared: " + option);
}

void Stage::print(const std::string& line) const {
  if (stop_.stop_requested() || options_.quiet) return;
  std::fputs((shown(line) + "\n").c_str(), is_stdout(options_.output) ? stderr : stdout);
}

int run_stage(int argc, char** argv, const StageDefaults& defaults, const std::function<void(Stage&)>& draw) {
  return run_program(
      argc, argv,
      [&](const std::string& program, int& status) {
        return parse_options(argc, argv, defaults, program, status);
      },
      draw);
}

int run_program(int argc, char** argv,
                const std::function<std::optional<Options>(const std::string& program, int& status)>& parse,
                const std::function<void(Stage&)>& draw) {
  const std::string program = std::filesystem::path(argc > 0 ? argv[0] : "protostar").filename().string();
  try {
    std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes then causes an error, as a full disk does
    int status = 0;
    const auto options = parse(program, status);
    if (options) {
      Interrupt interrupt;
      if (Interrupt::has_signals && !interrupt.listens() && !options->quiet)
        print_error(
            program,
            "Ctrl-C is not caught, since no thread can be started that waits for it: it ends the program "
            "at once, and what it leaves of a file the next run removes");
      if (options->timeout > 0)
        interrupt.set_timeout(options->timeout, error_line(program, timeout_text(*options)));
      if (!options->checkpoint.empty()) {
        interrupt.set_grace(std::chrono::seconds(10));
        Interrupt::ignore_broken_pipes();  // an error in place of a signal, after which the state is saved
      }
      Stage stage(*options, interrupt.token());
      draw(stage);
      if (interrupt.came()) return interrupt.status();
      if (!stage.is_good_enough()) status = 1;
    }
    flush(stdout, "standard output");
    return status;
  } catch (const UsageError& error) {  // that only the scene tells
    print_usage_error(program, error);
    return 2;
  } catch (const std::bad_alloc&) {
    print_error(program, "not enough memory for an image of this size");
  } catch (const std::exception& error) {
    print_error(program, error.what());
  }
  return 1;
}
