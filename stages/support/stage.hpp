// Code that the stages share besides the library: a command line, a picture to fill, a file to save it to.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/image.hpp>
#include <protostar/render.hpp>
#include <string>

#include "options.hpp"
#include "pictures.hpp"
#include "progress.hpp"
#include "stage_render.hpp"

/// Run of a stage, by the options of the user.
class Stage {
 public:
  Stage(const Options& options, protostar::StopToken stop);

  /// Returns a black image to be drawn: the picture, or the part of it that is needed. Throws at once what
  /// saving would throw later, as far as that is known: std::system_error, or std::length_error for a size
  /// that the format cannot have.
  protostar::Image image() const;

  /// Returns the name of the integrator.
  const std::string& integrator() const { return options_.integrator; }

  /// Returns the samples, the crop and the threads asked for, with a progress display, and a stop on Ctrl-C
  /// or timeout. The time of the render counts from this call. With --pixel, render explains the pixel, and
  /// draws the picture only if the tone needs it.
  StageRenderOptions render_options();

  /// Returns the options of a render by a function of a ray that intersects this sphere and no more, so that
  /// --pixel can tell so.
  StageRenderOptions render_options(const protostar::Sphere& sphere);

  /// Saves the image, or the part of it that was asked for, in the format asked for, with the stage's tone
  /// unless the file holds linear light, and prints a line about it. With --pixel, prints the explanation
  /// instead, and writes the files of it that are asked for. Throws std::system_error if it cannot.
  ///
  /// A shard is saved instead of the image, with --shard. Throws std::logic_error if the stage has drawn
  /// its picture without rays, and not declared so. After that, the checkpoint is removed; if the work was
  /// stopped or something cannot be written, it is saved.
  void save(const protostar::Image& image);

  /// Prints how many pixels of an image are wrong: more than one level of 255 off the exact image of the same
  /// size, as gamma 2.2 encodes them.
  void compare(const protostar::Image& image, const protostar::Image& exact) const;

  /// Prints the least, the mean and the largest number of an image whose pixels hold one in all channels.
  /// Pixels with a number below 0 have none.
  void tell_range(const protostar::Image& numbers, const std::string& what) const;

  /// Returns the value of one of the stage's own options.
  double number(const std::string& option) const;

  /// Returns true unless the picture was to have an error that it does not surely have.
  bool is_good_enough() const { return !told_passes_ || report_.is_met; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Throws std::system_error if the file could not be written, as far as that is known without writing it,
  /// and prints a warning if it cannot be replaced.
  void check_output(const std::filesystem::path& path) const;

  /// Prints a line, unless the user wants none or the work was stopped; to stderr if stdout leads to the
  /// picture.
  void print(const std::string& line) const;

  /// Writes the standard errors, and the picture or the shard, which are asked for, and returns what a shard
  /// is of the picture (save_shared).
  std::string write(const protostar::Image& image);

  /// Adds what passes need to the options of a render.
  void set_passes(protostar::RenderOptions& options);

  /// Returns the samples, the error and the remaining time for the progress display.
  std::string note_on_passes() const;

  /// Saves the standard errors, and prints how many samples there are and what the error is.
  void tell_passes();

  // Shared work: a shard, or a picture with a checkpoint (stage_shards.cpp).

  /// Begins shared work. Called if the user asks for --shard or --checkpoint.
  void begin_shared();

  /// Adds what shared work needs to the options of a render.
  void share(StageRenderOptions& options) const;

  /// Saves the shard, and returns what it is of the picture: how many units.
  std::string save_shared() const;

  /// Saves the checkpoint, if there is one, of shared work that ends without its file.
  void keep_shared() const;

  /// Ends shared work, and removes the checkpoint, which is not needed any more.
  void end_shared();

  // The explanation of a pixel (stage_explanation.cpp).

  /// Begins the explanation of the pixel that the user asks for.
  void begin_explanation();

  /// Completes the explanation by the picture's pixel, prints it, and writes the files that are asked for.
  void tell(const protostar::Image& image);

  Options options_;
  protostar::StopToken stop_;
  Progress progress_;
  protostar::RenderReport report_;         ///< of a picture in passes
  protostar::Image standard_error_{1, 1};  ///< with --noise: of its pixels
  bool told_passes_ = false;
  std::shared_ptr<Explanation> explanation_;  ///< until it is told
  std::shared_ptr<SharedRender> shared_;      ///< until it is drawn and saved
  Clock::time_point start_ = Clock::now();
};

/// Reads the command line, runs the stage, and returns the exit status of the program: 0, 1 if something
/// failed or took too long, 2 for an error in usage, 128 plus its number after a signal (130 after Ctrl-C).
int run_stage(int argc, char** argv, const StageDefaults& defaults, const std::function<void(Stage&)>& draw);

/// Runs a program that writes a picture, and returns its exit status, as run_stage does: `parse` reads the
/// command line of the program of that name, as parse_options does.
int run_program(int argc, char** argv,
                const std::function<std::optional<Options>(const std::string& program, int& status)>& parse,
                const std::function<void(Stage&)>& draw);
