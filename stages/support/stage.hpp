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
  Stage(const Options& options, std::string integrator, std::stop_token stop);

  /// A black image of the size asked for. Throws std::system_error right away if it could not be saved later.
  protostar::Image image() const;

  /// The threads asked for, a progress display, and an end on Ctrl-C. The time of the render counts from
  /// here.
  protostar::RenderOptions render_options();

  /// Saves the image in the format asked for and prints the line about it. Throws std::system_error if it
  /// cannot.
  void save(const protostar::Image& image);

  /// The value of one of the stage's own options.
  double number(const std::string& option) const;

  /// Prints a line where save prints its own, and likewise not at all if the user wants none.
  void print(const std::string& line) const;

 private:
  using Clock = std::chrono::steady_clock;

  void write(const protostar::Image& image) const;

  Options options_;
  std::string integrator_;
  std::stop_token stop_;
  Progress progress_;
  Clock::time_point start_ = Clock::now();
};

/// Reads the command line, runs the stage, and returns the program's exit status: 0, 1 if something failed, 2
/// for an error in usage, 130 after Ctrl-C.
int run_stage(int argc, char** argv, const StageDefaults& defaults, const std::function<void(Stage&)>& draw);
