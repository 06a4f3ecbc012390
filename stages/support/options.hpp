// Reads the command line that all stages share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <protostar/encode.hpp>
#include <protostar/image.hpp>
#include <protostar/io/read_options.hpp>
#include <protostar/render_options.hpp>
#include <protostar/tone.hpp>
#include <string>
#include <vector>

#include "shard_number.hpp"

/// Option of one stage that takes a number in the range of float, or a finite one greater than 0.
struct NumberOption {
  std::string name, help;
  double value;           ///< default if the option is not given
  bool positive = false;  ///< takes numbers greater than 0 only
};

/// Pixel of a picture, counted from 0 at the upper left.
struct Pixel {
  int x = 0, y = 0;
};

/// Settings of a stage for options that are not given.
struct StageDefaults {
  std::string integrator = {};  ///< name, for the line that the stage prints
  int width = 640, height = 480;
  protostar::Transfer transfer = protostar::Gamma{2.2};
  protostar::Tone tone = protostar::Tone::clip;  ///< not applied to files of linear light
  double exposure = 1;  ///< factor on the light that the program applies, for the explanation of a pixel
  bool plain = false;
  bool fills_whole = false;                ///< true if the stage fills all pixels itself, without rays
  std::vector<NumberOption> numbers = {};  ///< options of this stage alone

  /// Names of integrators that the option --show chooses from; without names there is no such option.
  std::vector<std::string> shows = {};

  int samples = 0;
  double error = 0;          ///< RenderOptions::error
  std::string sampler = {};  ///< name; empty: that which the integrator takes by default
  std::string filter = "box";
  std::uint64_t seed = 0;

  /// Files that the scene was read from, if any: its own, and those that it names.
  std::vector<std::filesystem::path> files = {};

  /// Reads a scene file and returns its settings; for programs that draw scene files, empty for others.
  std::function<StageDefaults(const std::filesystem::path&, const protostar::ReadOptions&)> read_scene = {};
};

/// Options of a run, checked as far as possible without opening the output.
struct Options {
  enum class Format { ppm, png, pfm, hdr, shard };

  /// Returns true if the file holds linear light: nothing is encoded, nothing above 1 has to be cut.
  [[nodiscard]] bool is_linear() const { return format == Format::pfm || format == Format::hdr; }

  /// Returns true if all of the picture is drawn though a part of it is asked for: if the largest channel of
  /// the picture sets the scale of the part, or the stage does not draw parts.
  [[nodiscard]] bool draws_more() const {
    return crop.width > 0 && (fills_whole || (tone == protostar::Tone::scale_image && !is_linear()));
  }

  /// Returns the pixels that are drawn, from the upper left one on.
  [[nodiscard]] protostar::Tile drawn() const {
    return draws_more() ? protostar::Tile{0, 0, crop.width, crop.height}
                        : protostar::Tile{0, 0, width, height};
  }

  /// Returns true if the picture is drawn in passes, which tell its error.
  [[nodiscard]] bool in_passes() const { return error > 0 || seconds > 0 || !noise.empty(); }

  std::string program = {};       ///< name that begins each message
  std::string work = "rendered";  ///< verb for what the program does, for the line that it prints
  std::filesystem::path output = "out.ppm";
  Format format = Format::ppm;
  int width = 0, height = 0;
  int threads = 0;  ///< 0: all cores
  int bits = 8;
  protostar::Transfer transfer = {};
  protostar::Tone tone = protostar::Tone::clip;
  std::string integrator = {};
  int samples = 0;
  double error = 0, seconds = 0;     ///< RenderOptions::error and seconds; 0: none
  int max_samples = 65536;           ///< RenderOptions::max_samples
  double clamp = 0;                  ///< RenderOptions::clamp; 0: none
  bool every_pixel = false;          ///< RenderOptions::every_pixel
  std::filesystem::path noise = {};  ///< file for the standard errors; empty: none
  std::string sampler = {};          ///< name; empty: that which the integrator takes by default
  std::string filter = {};           ///< name
  std::uint64_t seed = 0;
  std::optional<ShardNumber> shard = {};  ///< part of the work, if not all of it is drawn
  std::filesystem::path checkpoint = {};  ///< file for the state of the work; empty: none
  std::string scene = {};                 ///< fingerprint of the files that the scene consists of
  protostar::Crop crop = {};              ///< in the picture, if width and height are those of a part of it
  bool plain = false;
  bool fills_whole = false;  ///< StageDefaults::fills_whole; pixels outside of the crop are filled, too
  bool quiet = false;
  double exposure = 1;
  std::optional<Pixel> pixel = {};     ///< explained, and nothing is drawn; the crop is then that of no part
  std::filesystem::path explain = {};  ///< file for the explanation as JSON; empty: none
  std::filesystem::path rays = {};     ///< file for a drawing of its rays; empty: none
  double timeout = 0;                  ///< seconds after which the program gives up; 0: never
  std::vector<NumberOption> numbers = {};  ///< with the values that are given
};

/// Command line of merge: a picture's file, and the .shard files of which it is made.
struct MergeOptions {
  Options options;
  std::vector<std::filesystem::path> shards;
  std::optional<protostar::Transfer> own_transfer;
};

/// Refuses an output that would replace one of the files of what is read, for example of "the scene".
void refuse_replacing(const std::string& option, const std::filesystem::path& output,
                      const std::vector<std::filesystem::path>& files, const std::string& of_what);

/// Reads the command line of merge, as parse_options does.
std::optional<MergeOptions> parse_merge_options(int argc, const char* const* argv, const std::string& program,
                                                int& status);

/// Reads a command line. Returns nullopt if the program has already printed all there is to say, help or an
/// error; then status is its exit status: 0, or 2 for an error in usage.
std::optional<Options> parse_options(int argc, const char* const* argv, const StageDefaults& defaults,
                                     const std::string& program, int& status);
