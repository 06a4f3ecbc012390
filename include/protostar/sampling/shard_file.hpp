// Shards as files.
//
// A .shard file consists of words of 8 bytes, the lowest byte first on any machine:
//   "protostar shard\n"                                     2 words
//   version of the format: 2
//   width, height; x0, y0; x1, y1; samples, samples in a unit; rows in a unit, 0      each pair in one word
//   seed
//   version of the library, sampler, filter, scene
//     of each its length, its bytes, zeros to a whole word
//   exposure as a double; tone, 1 if plain; transfer, 0; exponent of a gamma as a double, otherwise 0
//   number of ranges of units, and of each its first unit and the one after its last
//   for each band with units, in their order, for each pixel in rows, for both scramblings:
//     low and high word of r, of g and of b (ExactSum::Words)
//   checksum of all words before it
// Nothing is in it twice, and equal sums have equal words: equal shards have equal bytes.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "../bit_cast.hpp"
#include "../error_number.hpp"
#include "../output_file.hpp"
#include "../shown.hpp"
#include "finish.hpp"
#include "sampler.hpp"
#include "shard.hpp"
#include "word_file.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline constexpr std::string_view shard_magic = "protostar shard\n";
inline constexpr std::uint64_t shard_format = 2;

inline void put_sums(auto& writer, const PixelSums& pixel) {
  for (const ExactColorSum& sum : pixel.sums)
    for (const ExactSum& channel : sum.channels) {
      const ExactSum::Words words = channel.words();
      writer.put(words.low);
      writer.put(static_cast<std::uint64_t>(words.high));
    }
}

/// Reads the sums of a pixel that has counts[k] samples in scrambling k. Fails at a sum that is larger than
/// as many samples can make it, 2^94 units each.
inline PixelSums get_sums(auto& reader, const std::array<std::uint32_t, scramblings>& counts) {
  PixelSums pixel{.sums = {}, .counts = counts};
  for (std::size_t k = 0; k < scramblings; ++k)
    for (ExactSum& channel : pixel.sums[k].channels) {
      const std::uint64_t low = reader.get();
      const auto high = static_cast<std::int64_t>(reader.get());
      const std::int64_t most = std::int64_t{counts[k]} << 30;
      if (high < -most || high > most || (high == most && low != 0))
        reader.fail_at_word("a sum is beyond that of " + std::to_string(counts[k]) + " samples");
      channel = ExactSum({high, low});
    }
  return pixel;
}

inline void put_finish(auto& writer, const Finish& finish) {
  const auto* const gamma = std::get_if<Gamma>(&finish.transfer);
  writer.put(bit_cast<std::uint64_t>(finish.exposure));
  writer.put(static_cast<std::uint64_t>(finish.tone), finish.plain ? 1 : 0);
  writer.put(finish.transfer.index(), 0);
  writer.put(gamma ? bit_cast<std::uint64_t>(gamma->exponent) : 0);
}

/// Reads a finish. Its exposure and gamma are not checked here (Finish::validate).
inline Finish get_finish(auto& reader) {
  Finish finish{.exposure = bit_cast<double>(reader.get())};
  const auto [tone, plain] = reader.get_pair();
  if (tone > static_cast<std::uint32_t>(Tone::scale_image) || plain > 1)
    reader.fail_at_word("tone " + std::to_string(tone) + " and plain " + std::to_string(plain) +
                        "; allowed are 0 to 2, and 0 and 1");
  finish.tone = static_cast<Tone>(tone), finish.plain = plain == 1;
  const std::uint64_t transfer = reader.get("transfer", 0, 2), exponent = reader.get();
  if (transfer == 1) finish.transfer = Linear{};
  if (transfer == 2) finish.transfer = Gamma{bit_cast<double>(exponent)};
  if (transfer == 0) finish.transfer = Srgb{};
  if (transfer != 2 && exponent != 0) reader.fail_at_word("an exponent of a transfer that has none");
  return finish;
}

/// Reads the description of a picture.
inline SharedPicture get_picture(auto& reader) {
  SharedPicture picture;
  const auto to_int = [](std::uint32_t word) { return static_cast<int>(word); };  // modulo 2^32
  const auto [width, height] = reader.get_pair();
  const auto [x0, y0] = reader.get_pair();
  const auto [x1, y1] = reader.get_pair();
  const auto [samples, samples_in_unit] = reader.get_pair();
  const auto [rows, none] = reader.get_pair();
  if (none != 0) reader.fail_at_word("the upper half of the rows in a unit is not 0");
  picture.width = to_int(width), picture.height = to_int(height);
  picture.area = {to_int(x0), to_int(y0), to_int(x1), to_int(y1)};
  picture.samples = samples, picture.samples_in_unit = samples_in_unit;
  picture.rows_in_unit = to_int(rows);
  picture.seed = reader.get();
  for (std::string* const text : {&picture.version, &picture.sampler, &picture.filter, &picture.scene})
    *text = reader.get_bytes(
        static_cast<std::size_t>(reader.get("length of a text", 0, SharedPicture::longest_text)));
  picture.finish = get_finish(reader);
  try {
    picture.validate();
  } catch (const std::invalid_argument& error) {
    reader.fail(error.what());
  }
  return picture;
}

/// Reads ranges of units in rising order.
inline UnitSet get_units(auto& reader, const SharedPicture& picture) {
  UnitSet units;
  const std::uint64_t all = picture.units();
  std::uint64_t least = 0;  // ranges do not touch: each begins after the end of the one before it
  for (std::uint64_t count = reader.get("number of ranges of units", 0, (all + 1) / 2); count > 0; --count) {
    if (least >= all)
      reader.fail_at_word("a range of units ends at " + std::to_string(least - 1) + " of " +
                          std::to_string(all) + ", and another should follow");
    const std::uint64_t first = reader.get("first unit", least, all - 1);
    const std::uint64_t last = reader.get("end of a range of units", first + 1, all);
    units.add({first, last});
    least = last + 1;
  }
  return units;
}

/// Reads the sums of the bands of units. Memory is taken as the file goes on, whatever it says of its size.
inline Shard::Bands get_bands(auto& reader, const SharedPicture& picture, const UnitSet& units) {
  Shard::Bands bands;
  const std::uint64_t blocks = picture.blocks();
  auto range = units.ranges().begin();
  for (std::uint64_t unit = range != units.ranges().end() ? range->first : 0;
       range != units.ranges().end();) {
    const std::uint64_t band = picture.band_of(unit), end_of_band = (band + 1) * blocks;
    std::array<std::uint32_t, scramblings> counts{};
    while (range != units.ranges().end() && unit < end_of_band) {
      const std::uint64_t end = std::min(range->second, end_of_band);
      const WorkUnit all{{}, picture.unit(unit).first_sample, picture.unit(end - 1).last_sample};
      counts[0] += all.samples_of(0), counts[1] += all.samples_of(1);
      unit = end;
      if (end == range->second && ++range != units.ranges().end()) unit = range->first;
    }
    const Tile tile = picture.tile_of(band);
    const std::size_t size = static_cast<std::size_t>(tile.width()) * static_cast<std::size_t>(tile.height());
    std::vector<PixelSums>& pixels = bands[band];
    while (pixels.size() < size) pixels.push_back(get_sums(reader, counts));
  }
  return bands;
}

}  // namespace detail

/// Writes a shard to a sink, which takes bytes in blocks as sink(bytes, size).
void write_shard(const Shard& shard, auto&& sink) {
  const SharedPicture& picture = shard.picture();
  detail::WordWriter writer(sink);
  const auto halves = [&](auto low, auto high) {
    writer.put(static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high));
  };
  writer.put_bytes(detail::shard_magic);
  writer.put(detail::shard_format);
  halves(picture.width, picture.height);
  halves(picture.area.x0, picture.area.y0);
  halves(picture.area.x1, picture.area.y1);
  halves(picture.samples, picture.samples_in_unit);
  halves(picture.rows_in_unit, 0);
  writer.put(picture.seed);
  for (const std::string* const text :
       {&picture.version, &picture.sampler, &picture.filter, &picture.scene}) {
    writer.put(text->size());
    writer.put_bytes(*text);
  }
  detail::put_finish(writer, picture.finish);
  writer.put(shard.units().ranges().size());
  for (const auto& [first, last] : shard.units().ranges()) writer.put(first), writer.put(last);
  for (const auto& [band, pixels] : shard.bands())
    for (const PixelSums& pixel : pixels) detail::put_sums(writer, pixel);
  writer.end();
}

/// Reads a shard from a source: source(bytes, size) writes up to `size` bytes and returns how many, 0 at the
/// end. Throws std::runtime_error for bytes that are no shard, with the name of the file, the place in it,
/// what is there and what is allowed.
[[nodiscard]] Shard read_shard(auto&& source, const std::string& name) {
  detail::WordReader reader(source, shown(name));
  if (reader.get_bytes(detail::shard_magic.size()) != detail::shard_magic)
    reader.fail("the file does not begin with 'protostar shard', so it is no .shard file");
  if (const std::uint64_t format = reader.get(); format != detail::shard_format)
    reader.fail_at_word("version " + std::to_string(format) +
                        " of .shard files; this program reads version " +
                        std::to_string(detail::shard_format));
  SharedPicture picture = detail::get_picture(reader);
  UnitSet units = detail::get_units(reader, picture);
  Shard::Bands bands = detail::get_bands(reader, picture, units);
  reader.end();
  return {std::move(picture), std::move(units), std::move(bands)};
}

/// Saves a shard as a .shard file, which is replaced as a whole or not at all (see OutputFile, also for its
/// errors): a run that is killed leaves the shard that was there before, or none.
inline void save_shard(const Shard& shard, const FileName& path) {
  OutputFile file(path);
  write_shard(shard, [&](const char* bytes, std::size_t size) { file.write(bytes, size); });
  file.commit();
}

/// Reads a .shard file. Throws std::system_error if it cannot be read, and std::runtime_error if it is none.
[[nodiscard]] inline Shard load_shard(const FileName& path) {
  const auto fail = [&] {
    throw std::system_error(detail::error_number(), std::generic_category(),
                            "cannot read '" + shown(path.text()) + "'");
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.text().c_str(), "rb"),
                                                             std::fclose);
  if (!file) fail();
  const auto source = [&](char* bytes, std::size_t size) {
    const std::size_t count = std::fread(bytes, 1, size, file.get());
    if (count == 0 && std::ferror(file.get())) fail();
    return count;
  };
  return read_shard(source, path.text());
}

/// Reads .shard files and merges them: the same shard in whatever order they are named. Throws
/// std::runtime_error for no files, and for a file of another picture than the first or with a unit that a
/// file before it has; it names both files and the difference or the unit. Units may be missing
/// (Shard::missing); Shard::film names the first of them.
[[nodiscard]] inline Shard merge_shards(const std::vector<FileName>& paths) {
  if (paths.empty()) throw std::runtime_error("no .shard files to be merged");
  const auto quoted = [](const FileName& path) { return "'" + shown(path.text()) + "'"; };
  Shard all = load_shard(paths[0]);
  std::vector<UnitSet> units{all.units()};
  for (std::size_t i = 1; i < paths.size(); ++i) {
    Shard next = load_shard(paths[i]);
    if (const std::string difference = next.picture().difference_from(all.picture()); !difference.empty())
      throw std::runtime_error(quoted(paths[i]) + " is not of the picture of " + quoted(paths[0]) + ": " +
                               difference);
    if (const auto unit = all.units().common(next.units())) {
      const auto before =
          std::find_if(units.begin(), units.end(), [&](const auto& u) { return u.contains(*unit); });
      throw std::runtime_error(quoted(paths[i]) + " has " + all.picture().text_of(*unit) + ", and " +
                               quoted(paths[static_cast<std::size_t>(before - units.begin())]) +
                               " has it too");
    }
    units.push_back(next.units());
    all.merge(std::move(next));
  }
  return all;
}

}  // namespace protostar::inline PROTOSTAR_ABI
