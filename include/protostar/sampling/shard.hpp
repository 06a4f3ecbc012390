// Shards: parts of a picture's work that are drawn by themselves, on any machine and at any time, and merged
// in any order into the same bytes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../render_options.hpp"
#include "../shown.hpp"
#include "../version.hpp"
#include "film.hpp"
#include "finish.hpp"
#include "sampler.hpp"
#include "samplers.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Range of units of work, [first, last).
struct UnitRange {
  std::uint64_t first = 0, last = 0;

  friend bool operator==(const UnitRange& a, const UnitRange& b) {
    return a.first == b.first && a.last == b.last;
  }
};

/// Unit of work: the samples [first_sample, last_sample) of each pixel of a tile.
struct WorkUnit {
  Tile tile;
  std::uint32_t first_sample, last_sample;

  /// Returns how many of the samples belong to a scrambling.
  [[nodiscard]] std::uint32_t samples_of(std::uint32_t scrambling) const {
    const auto below = [&](std::uint32_t end) { return (end + scramblings - 1 - scrambling) / scramblings; };
    return below(last_sample) - below(first_sample);
  }
};

/// Description of a picture whose work is shared. Runs may be merged if all of it is equal. Its work is cut
/// into bands of rows, and each band's samples into blocks: a unit is a block of a band.
struct SharedPicture {
  int width = 0, height = 0;  ///< size of the whole picture
  Tile area{0, 0, 0, 0};      ///< part of it that is drawn
  std::uint32_t samples = 1;  ///< samples in each pixel, up to most_samples_of_pixel
  std::uint64_t seed = 0;
  std::string sampler = {}, filter = {};    ///< names
  std::string scene = {};                   ///< fingerprint of all else on which radiance depends
  Finish finish = {};                       ///< treatment of the light of the merged picture
  std::string version = PROTOSTAR_VERSION;  ///< version of the library
  int rows_in_unit = 16;                    ///< rows of a band; the last one may have fewer
  std::uint32_t samples_in_unit = 16;       ///< samples of a block; the last one may have fewer

  static constexpr std::size_t longest_text = 4096;  ///< bytes of a name, a fingerprint or a version
  static constexpr std::uint64_t most_units = std::uint64_t{1} << 20;  ///< after cut()

  /// Throws std::invalid_argument for sizes and numbers that no picture has.
  void validate() const {
    const auto require = [](bool holds, const std::string& what) {
      if (!holds) throw std::invalid_argument("SharedPicture: " + what);
    };
    static_cast<void>(Image::require_size("SharedPicture", width, height));
    require(0 <= area.x0 && area.x0 < area.x1 && area.x1 <= width && 0 <= area.y0 && area.y0 < area.y1 &&
                area.y1 <= height,
            "the area is " + text(area) + "; it must have pixels, all inside " + std::to_string(width) + "x" +
                std::to_string(height));
    require(samples >= 1 && samples <= std::uint32_t{most_samples_of_pixel},
            "samples are " + std::to_string(samples) + "; they must be from 1 to " +
                std::to_string(most_samples_of_pixel) + ", as many as a pixel can have");
    require(rows_in_unit >= 1,
            "rows in a unit are " + std::to_string(rows_in_unit) + "; they must be at least 1");
    require(samples_in_unit >= 1, "samples in a unit are 0; they must be at least 1");
    for (const std::string* const name : {&sampler, &filter, &scene, &version})
      require(name->size() <= longest_text,
              "a text has " + std::to_string(name->size()) + " bytes; at most 4096 are allowed");
    finish.validate();
  }

  /// Sets rows_in_unit and samples_in_unit. Units are halved until there are 1024 of them, as long as each
  /// has more than 2^16 samples of pixels, or 64 of them, as long as each has more than 2^9. There are at
  /// most most_units.
  void cut() {
    rows_in_unit = 16, samples_in_unit = 16;
    const auto samples_of_unit = [&] { return std::int64_t{area.width()} * rows_in_unit * samples_in_unit; };
    while (units() < 1024 && samples_of_unit() > (units() < 64 ? 1 << 9 : 1 << 16) &&
           (rows_in_unit > 1 || samples_in_unit > 1)) {
      if (rows_in_unit > static_cast<int>(samples_in_unit))
        rows_in_unit /= 2;
      else
        samples_in_unit /= 2;
    }
    while (units() > most_units) {
      if (bands() > blocks())
        rows_in_unit *= 2;
      else
        samples_in_unit *= 2;
    }
  }

  /// Returns the numbers of bands, of blocks of samples in a band, and of units.
  [[nodiscard]] std::uint64_t bands() const {
    return (static_cast<std::uint64_t>(area.height()) + static_cast<std::uint64_t>(rows_in_unit) - 1) /
           static_cast<std::uint64_t>(rows_in_unit);
  }
  [[nodiscard]] std::uint64_t blocks() const {
    return (std::uint64_t{samples} + samples_in_unit - 1) / samples_in_unit;
  }
  [[nodiscard]] std::uint64_t units() const { return bands() * blocks(); }

  /// Returns the band of a unit. The units of a band follow each other, so that a shard has at most two bands
  /// in common with other shards.
  [[nodiscard]] std::uint64_t band_of(std::uint64_t unit) const { return unit / blocks(); }

  /// Returns the pixels of a band. Each band lies .618 of the area's height below the one before it, modulo
  /// the height, so that every shard gets rows from all of the picture, slow and quick ones.
  [[nodiscard]] Tile tile_of(std::uint64_t band) const {
    std::uint64_t step = bands() * 618 / 1000;
    while (std::gcd(step, bands()) != 1) ++step;  // then the multiples of step are all bands
    const int y = area.y0 + static_cast<int>(band * step % bands()) * rows_in_unit;
    return {area.x0, y, area.x1, rows_in_unit < area.y1 - y ? y + rows_in_unit : area.y1};
  }

  /// Returns a unit by its number, below units().
  [[nodiscard]] WorkUnit unit(std::uint64_t number) const {
    const std::uint64_t first = number % blocks() * samples_in_unit;
    const std::uint64_t last = std::min<std::uint64_t>(first + samples_in_unit, samples);
    return {tile_of(band_of(number)), static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
  }

  /// Returns the units of shard i of n: each unit is in one of the n shards, and these differ by one unit at
  /// most. Throws std::invalid_argument unless i < n.
  [[nodiscard]] UnitRange units_of(std::uint64_t i, std::uint64_t n) const {
    if (i >= n)
      throw std::invalid_argument("shard " + std::to_string(i) + " of " + std::to_string(n) +
                                  ": shards are numbered from 0 to their number less 1");
    const std::uint64_t each = units() / n, more = units() % n;
    const auto first = [&](std::uint64_t k) { return k * each + std::min(k, more); };
    return {first(i), first(i + 1)};
  }

  /// Returns how many of n shards are in front of a unit; nullopt if the unit is not the first of a shard.
  /// Precondition: 1 ≤ n ≤ units().
  [[nodiscard]] std::optional<std::uint64_t> shards_before(std::uint64_t unit, std::uint64_t n) const {
    const std::uint64_t each = units() / n, more = units() % n, larger = more * (each + 1);
    const std::uint64_t i = unit < larger ? unit / (each + 1) : more + (unit - larger) / each;
    return i == n || units_of(i, n).first == unit ? std::optional(i) : std::nullopt;
  }

  /// Returns a unit in words: unit 17 (rows 16 to 31, samples 0 to 15).
  [[nodiscard]] std::string text_of(std::uint64_t number) const {
    const WorkUnit found = unit(number);
    return "unit " + std::to_string(number) + " (rows " + std::to_string(found.tile.y0) + " to " +
           std::to_string(found.tile.y1 - 1) + ", samples " + std::to_string(found.first_sample) + " to " +
           std::to_string(found.last_sample - 1) + ")";
  }

  /// Returns the first difference from another picture in words, such as "seed 3, not 1"; empty if there is
  /// none.
  [[nodiscard]] std::string difference_from(const SharedPicture& other) const {
    const auto number = [](std::uint64_t value) { return std::to_string(value); };
    const auto quoted = [](const std::string& name) { return "'" + shown(name) + "'"; };
    const auto size = [](const SharedPicture& of) {
      return std::to_string(of.width) + "x" + std::to_string(of.height);
    };
    const std::array<std::array<std::string, 3>, 11> rows{{
        {"version", quoted(version), quoted(other.version)},
        {"size", size(*this), size(other)},
        {"area", text(area), text(other.area)},
        {"samples", number(samples), number(other.samples)},
        {"seed", number(seed), number(other.seed)},
        {"sampler", quoted(sampler), quoted(other.sampler)},
        {"filter", quoted(filter), quoted(other.filter)},
        {"scene", quoted(scene), quoted(other.scene)},
        {"finish", quoted(finish.text()), quoted(other.finish.text())},
        {"rows in a unit", std::to_string(rows_in_unit), std::to_string(other.rows_in_unit)},
        {"samples in a unit", number(samples_in_unit), number(other.samples_in_unit)},
    }};
    for (const auto& [name, own, others] : rows)
      if (own != others) return name + " " + own + ", not " + others;
    return "";
  }

 private:
  static std::string text(const Tile& tile) {
    const auto range = [](std::int64_t first, std::int64_t end) {
      return std::to_string(first) + " to " + std::to_string(end - 1);
    };
    return "columns " + range(tile.x0, tile.x1) + " and rows " + range(tile.y0, tile.y1);
  }
};

/// Set of units as ranges without common units, none of which ends where another begins: equal sets have
/// equal ranges.
class UnitSet {
 public:
  /// Returns the ranges, as ends by beginnings.
  [[nodiscard]] const std::map<std::uint64_t, std::uint64_t>& ranges() const { return ranges_; }

  /// Returns the number of units.
  [[nodiscard]] std::uint64_t count() const {
    std::uint64_t sum = 0;
    for (const auto& [first, last] : ranges_) sum += last - first;
    return sum;
  }

  [[nodiscard]] bool contains(std::uint64_t unit) const { return common({unit, unit + 1}).has_value(); }

  /// Returns the first unit of a range that is in the set; nullopt if none is.
  [[nodiscard]] std::optional<std::uint64_t> common(const UnitRange& range) const {
    auto next = ranges_.upper_bound(range.first);
    if (next != ranges_.begin() && range.first < std::prev(next)->second && range.first < range.last)
      return range.first;
    return next != ranges_.end() && next->first < range.last ? std::optional(next->first) : std::nullopt;
  }

  /// Returns the first unit that is in both sets; nullopt if there is none.
  [[nodiscard]] std::optional<std::uint64_t> common(const UnitSet& other) const {
    for (const auto& [first, last] : other.ranges_)
      if (const auto unit = common(UnitRange{first, last})) return unit;
    return std::nullopt;
  }

  /// Returns the first unit of a range that is not in the set; nullopt if all are.
  [[nodiscard]] std::optional<std::uint64_t> missing(const UnitRange& range) const {
    if (range.first >= range.last) return std::nullopt;
    const auto next = ranges_.upper_bound(range.first);
    if (next == ranges_.begin() || std::prev(next)->second <= range.first) return range.first;
    return std::prev(next)->second < range.last ? std::optional(std::prev(next)->second) : std::nullopt;
  }

  /// Adds a range, none of whose units is in the set.
  void add(UnitRange range) {
    if (range.first >= range.last) return;
    auto next = ranges_.lower_bound(range.first);
    if (next != ranges_.end() && next->first == range.last) {
      range.last = next->second;
      next = ranges_.erase(next);
    }
    if (next != ranges_.begin() && std::prev(next)->second == range.first)
      std::prev(next)->second = range.last;
    else
      ranges_.emplace(range.first, range.last);
  }

  friend bool operator==(const UnitSet& a, const UnitSet& b) { return a.ranges_ == b.ranges_; }

 private:
  std::map<std::uint64_t, std::uint64_t> ranges_;
};

/// Sums of the samples of some units of a picture, from none to all. It is also the state of a long render
/// (checkpoint), which goes on with the units that are missing. Only the bands of its units take memory.
class Shard {
 public:
  /// Sums of the pixels of bands, in rows, by the number of the band.
  using Bands = std::map<std::uint64_t, std::vector<PixelSums>>;

  /// Makes a shard without units. Throws std::invalid_argument for an invalid picture.
  explicit Shard(SharedPicture picture) : picture_(std::move(picture)) { picture_.validate(); }

  [[nodiscard]] const SharedPicture& picture() const { return picture_; }
  [[nodiscard]] const UnitSet& units() const { return units_; }
  [[nodiscard]] const Bands& bands() const { return bands_; }

  /// Adds a unit that is complete: the sums of its samples for the pixels of its tile, in rows. Throws
  /// std::invalid_argument if the unit is there, or is none, or if the pixels do not have its samples.
  void add(std::uint64_t number, std::vector<PixelSums> pixels) {
    if (number >= picture_.units())
      throw std::invalid_argument("Shard: unit " + std::to_string(number) + " is none of the picture's " +
                                  std::to_string(picture_.units()));
    if (units_.contains(number))
      throw std::invalid_argument("Shard: " + picture_.text_of(number) + " is there already");
    const WorkUnit unit = picture_.unit(number);
    const auto width = static_cast<std::size_t>(unit.tile.width());
    const std::array counts{unit.samples_of(0), unit.samples_of(1)};
    if (pixels.size() != width * static_cast<std::size_t>(unit.tile.height()) ||
        !std::all_of(pixels.begin(), pixels.end(), [&](const auto& p) { return p.counts == counts; }))
      throw std::invalid_argument("Shard: the sums are not those of all pixels and samples of " +
                                  picture_.text_of(number));
    add_pixels(picture_.band_of(number), std::move(pixels));
    units_.add({number, number + 1});
  }

  /// Adds the units of another shard. Throws std::invalid_argument if it is of another picture, or if both
  /// have a unit; this shard then stays as it was.
  void merge(Shard other) {
    if (const std::string difference = other.picture_.difference_from(picture_); !difference.empty())
      throw std::invalid_argument("Shard: the shard to be merged has " + difference);
    if (const auto unit = units_.common(other.units_))
      throw std::invalid_argument("Shard: " + picture_.text_of(*unit) + " is in both shards");
    for (const auto& [first, last] : other.units_.ranges()) units_.add({first, last});
    for (auto& [band, pixels] : other.bands_) add_pixels(band, std::move(pixels));
  }

  /// Returns the first unit that is missing; nullopt if the picture is complete.
  [[nodiscard]] std::optional<std::uint64_t> missing() const { return units_.missing({0, picture_.units()}); }

  /// Numbers of the shards that are missing, and the number of all shards; of is 0 if these are not known.
  struct MissingShards {
    std::vector<std::uint64_t> numbers = {};
    std::uint64_t of = 0;
  };

  /// Returns the missing shards of a picture of which `parts` shards have been merged. The number of all
  /// shards is the only one for which each gap consists of whole shards (SharedPicture::units_of), as many as
  /// `parts` leaves; it is not known if several numbers, or none, are possible.
  [[nodiscard]] MissingShards missing_shards(std::uint64_t parts) const {
    std::vector<UnitRange> gaps;
    std::uint64_t first = 0;
    for (const auto& [begin, end] : units_.ranges()) {
      if (first < begin) gaps.push_back({first, begin});
      first = end;
    }
    if (first < picture_.units()) gaps.push_back({first, picture_.units()});

    const std::uint64_t lost_units = picture_.units() - units_.count();
    const std::uint64_t most = std::min({picture_.units(), parts + lost_units, SharedPicture::most_units});
    MissingShards missing;
    for (std::uint64_t n = parts + 1; n <= most; ++n) {
      std::uint64_t count = 0;
      const bool are_shards = std::all_of(gaps.begin(), gaps.end(), [&](const UnitRange& gap) {
        const auto begin = picture_.shards_before(gap.first, n), end = picture_.shards_before(gap.last, n);
        if (begin && end) count += *end - *begin;
        return begin && end;
      });
      if (!are_shards || count != n - parts) continue;
      if (missing.of != 0) return {};
      missing.of = n;
    }
    for (std::uint64_t i = 0; i < missing.of; ++i)
      if (!units_.contains(picture_.units_of(i, missing.of).first)) missing.numbers.push_back(i);
    return missing;
  }

  /// Returns the sums of the picture's area. Throws std::runtime_error if units are missing: the message
  /// names the first of them, and the missing shards if the number of merged ones, `parts`, tells which.
  [[nodiscard]] Film film(std::uint64_t parts = 0) const {
    const auto unit = missing();
    if (!unit) return sums();
    std::string text = picture_.text_of(*unit) + " is missing; " + std::to_string(units_.count()) + " of " +
                       std::to_string(picture_.units()) + " units are there";
    const MissingShards lost = missing_shards(parts);
    for (std::size_t i = 0; i < lost.numbers.size() && i < 10; ++i)
      text += (i == 0 ? "; missing: --shard " : ", ") + std::to_string(lost.numbers[i]) + "/" +
              std::to_string(lost.of);
    if (lost.numbers.size() > 10) text += " and " + std::to_string(lost.numbers.size() - 10) + " more";
    throw std::runtime_error(text);
  }

  /// Returns the sums so far: pixels of missing units have fewer samples, or none. They tell an error unless
  /// the sampler has the name of one of the library's that does not (Film).
  [[nodiscard]] Film sums() const {
    Film film(picture_.area);
    if (const auto sampler = sampler_named(picture_.sampler); sampler && sampler->needs_number())
      film.lose_error();
    for (const auto& [band, pixels] : bands_) {
      const Tile tile = picture_.tile_of(band);
      auto pixel = pixels.begin();
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) film(x, y) = *pixel++;
    }
    return film;
  }

  /// Constructs a shard from the parts of a file: the bands of the units, and no others.
  Shard(SharedPicture picture, UnitSet units, Bands bands)
      : picture_(std::move(picture)), units_(std::move(units)), bands_(std::move(bands)) {}

 private:
  void add_pixels(std::uint64_t band, std::vector<PixelSums>&& pixels) {
    std::vector<PixelSums>& own = bands_[band];
    if (own.empty()) {
      own = std::move(pixels);
      return;
    }
    for (std::size_t i = 0; i < own.size(); ++i) own[i] += pixels[i];
  }

  SharedPicture picture_;
  UnitSet units_;
  Bands bands_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
