// What the stages share besides the library: a command line, a picture to fill, a file to save it to.
#pragma once

#include <chrono>
#include <functional>
#include <protostar/image.hpp>
#include <protostar/render.hpp>
#include <string>

#include "options.hpp"
#include "pictures.hpp"
#include "progress.hpp"

/// One run of a stage: what the user asked for.
class Stage {
 public:
  Stage(const Options& options, protostar::StopToken stop);

  /// A black image to be drawn: the picture, or the part of it that was asked for. Throws std::system_error,
  /// or std::length_error for a size that the format cannot have, right away if it could not be saved later.
  protostar::Image image() const;

  /// What light the rays bring, by the name of the integrator.
  const std::string& integrator() const { return options_.integrator; }

  /// The samples, the crop and the threads asked for, a progress display, and an end on Ctrl-C. The time of
  /// the render counts from here.
  protostar::RenderOptions render_options();

  /// Saves the image, or the part of it that was asked for, in the format asked for, with the stage's tone
  /// unless the file holds the light itself, and prints the line about it. Throws std::system_error if it
  /// cannot.
  void save(const protostar::Image& image);

  /// Prints how many pixels of an image are wrong: more than one level of 255 off the exact image of the same
  /// size, as gamma 2.2 encodes them.
  void compare(const protostar::Image& image, const protostar::Image& exact) const;

  /// The value of one of the stage's own options.
  double number(const std::string& option) const;

 private:
  using Clock = std::chrono::steady_clock;

  /// Throws std::system_error if the file could not be written, as far as that is known without writing it,
  /// and says so if it cannot be replaced.
  void check_output() const;

  /// Prints a line, unless the user wants none.
  void print(const std::string& line) const;
  void write(const protostar::Image& image) const;

  Options options_;
  protostar::StopToken stop_;
  Progress progress_;
  Clock::time_point start_ = Clock::now();
};

/// Reads the command line, runs the stage, and returns the program's exit status: 0, 1 if something failed, 2
/// for an error in usage, 130 after Ctrl-C.
int run_stage(int argc, char** argv, const StageDefaults& defaults, const std::function<void(Stage&)>& draw);
