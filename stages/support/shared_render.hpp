// Draws a picture in units of work: a shard of it, or a picture whose state is saved meanwhile.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <protostar/image.hpp>
#include <protostar/render_options.hpp>
#include <protostar/sampling/film.hpp>
#include <protostar/sampling/shard.hpp>
#include <string>

#include "shard_number.hpp"

/// Work on the units of a picture, with an optional checkpoint: a .shard file of the units that are done. It
/// is replaced as a whole from time to time and when the work is stopped, and a run that finds it goes on
/// with the other units. It stays until finish().
class SharedRender {
 public:
  using Clock = std::chrono::steady_clock;

  /// Adds a unit's samples of each pixel to the film of its tile, in the calling thread.
  using DrawUnit = std::function<void(protostar::Film&, const protostar::WorkUnit&)>;

  /// Takes the shard to be drawn, and the name of the checkpoint; empty: none. The checkpoint is saved every
  /// ten seconds, or more seldom: at least twenty times as long is drawn as saving it takes.
  SharedRender(const ShardNumber& number, std::filesystem::path checkpoint,
               Clock::duration interval = std::chrono::seconds(10))
      : number_(number), checkpoint_(std::move(checkpoint)), interval_(interval) {}

  /// Draws the units of the shard that the checkpoint does not have, with threads, progress and stop of the
  /// options; after a stop, some units are missing. Throws std::runtime_error for a checkpoint of another
  /// picture or of another shard, std::system_error if it cannot be written, and what the function throws.
  void draw(const protostar::SharedPicture& picture, const protostar::RenderOptions& options,
            const DrawUnit& draw_unit);

  /// Returns the units that are done, after draw().
  [[nodiscard]] const std::optional<protostar::Shard>& shard() const { return shard_; }

  /// Saves the checkpoint, if there is to be one and it does not have all units that are done yet. Call it if
  /// the work ends without finish().
  void keep();

  /// Removes the checkpoint, if there is one, as it is not needed any more; of a link, the file. One that had
  /// all units before, as a finished shard has, stays: it is the work of another run.
  void finish() const;

 private:
  [[nodiscard]] protostar::Shard begun(const protostar::SharedPicture& picture,
                                       const protostar::UnitRange& units) const;
  void save();

  ShardNumber number_;
  std::filesystem::path checkpoint_;
  Clock::duration interval_;
  Clock::time_point next_save_;
  bool is_saved_ = false;                ///< true if the checkpoint has all units that are done
  bool is_checkpoint_complete_ = false;  ///< true if it had all units when it was read
  std::optional<protostar::Shard> shard_;
};

/// Returns a word that tells pictures apart by their light, so that a scene that was changed is noticed: that
/// of an image of the scene in a few pixels.
[[nodiscard]] std::uint64_t word_of_light(const protostar::Image& image);

/// Returns a text that tells files apart by their bytes, in whatever order and under whatever names.
/// Throws std::runtime_error if one cannot be read twice, as it is no regular file.
[[nodiscard]] std::string fingerprint_of(const std::vector<std::filesystem::path>& files);

/// Returns a word as sixteen digits.
[[nodiscard]] std::string hexadecimal(std::uint64_t word);
