// The command line that all stages share.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <protostar/encode.hpp>
#include <protostar/io/read_options.hpp>
#include <protostar/render_options.hpp>
#include <protostar/tone.hpp>
#include <string>
#include <vector>

/// An option of one stage that takes a finite number.
struct NumberOption {
  std::string name, help;
  double value;  ///< when it is not given
};

/// What a stage draws when it is not told otherwise.
struct StageDefaults {
  std::string integrator = {};  ///< for the line that the stage prints
  int width = 640, height = 480;
  protostar::Transfer transfer = protostar::Gamma{2.2};
  protostar::Tone tone = protostar::Tone::clip;  ///< not for files of linear light
  bool plain = false;
  std::vector<NumberOption> numbers = {};  ///< options of its own
  int samples = 0;

  /// Of a program that draws scene files: reads one, and says what it asks for.
  std::function<StageDefaults(const std::filesystem::path&, const protostar::ReadOptions&)> read_scene = {};
};

/// What the user asked for, checked as far as it can be without touching a file.
struct Options {
  enum class Format { ppm, png, pfm, hdr };

  /// Whether the file holds the light itself: nothing is encoded, nothing above 1 has to be cut.
  [[nodiscard]] bool is_linear() const { return format == Format::pfm || format == Format::hdr; }

  /// Whether all of the picture is drawn though a part of it is asked for, as its largest channel says how
  /// light the part is.
  [[nodiscard]] bool draws_more() const {
    return crop.width > 0 && tone == protostar::Tone::scale_image && !is_linear();
  }

  std::string program = {};  ///< whose lines these are
  std::filesystem::path output = "out.ppm";
  Format format = Format::ppm;
  int width = 0, height = 0;
  int threads = 0;  ///< 0: all cores
  int bits = 8;
  protostar::Transfer transfer = {};
  protostar::Tone tone = protostar::Tone::clip;
  std::string integrator = {};
  int samples = 0;
  protostar::Crop crop = {};  ///< the picture, if width and height are those of a part of it
  bool plain = false;
  bool quiet = false;
  double timeout = 0;                 ///< seconds after which the program gives up; 0: it never does
  std::vector<NumberOption> numbers;  ///< with the values that were given
};

/// Reads a command line. Nothing is returned when the program has already said all that there is to say, help
/// or an error; then status is what it should exit with: 0, or 2 for an error in usage.
std::optional<Options> parse_options(int argc, const char* const* argv, const StageDefaults& defaults,
                                     const std::string& program, int& status);
