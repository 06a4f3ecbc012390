#include "shared_render.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <mutex>
#include <protostar/bit_cast.hpp>
#include <protostar/error_number.hpp>
#include <protostar/output_file.hpp>
#include <protostar/parallel.hpp>
#include <protostar/sampling/shard_file.hpp>
#include <protostar/shown.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "picture_file.hpp"

using namespace protostar;

namespace {

std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

std::vector<PixelSums> pixels_of(const Film& film) {
  const Tile& tile = film.tile();
  std::vector<PixelSums> pixels;
  pixels.reserve(static_cast<std::size_t>(tile.width()) * static_cast<std::size_t>(tile.height()));
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) pixels.push_back(film(x, y));
  return pixels;
}

}  // namespace

Shard SharedRender::begun(const SharedPicture& picture, const UnitRange& units) const {
  if (checkpoint_.empty()) return Shard(picture);
  if (is_no_regular_file(checkpoint_))
    throw std::runtime_error("--checkpoint: " + quoted(checkpoint_) +
                             " is no regular file: it cannot be read again and replaced");
  static_cast<void>(OutputFile(FileName(checkpoint_)));  // throws at once what saving would throw later
  if (!std::filesystem::exists(checkpoint_)) return Shard(picture);
  Shard shard = load_shard(checkpoint_);
  std::string difference = shard.picture().difference_from(picture);
  if (difference.empty())
    for (const auto& [first, last] : shard.units().ranges())
      for (const std::uint64_t unit : {first, last - 1})
        if (unit < units.first || unit >= units.last)
          difference = picture.text_of(unit) + ", which is in another shard than " +
                       std::to_string(number_.index) + "/" + std::to_string(number_.count);
  if (!difference.empty())
    throw std::runtime_error("--checkpoint: " + quoted(checkpoint_) + " is of other work: it has " +
                             difference + "; name another file, or remove it");
  return shard;
}

void SharedRender::save() {
  const Clock::time_point start = Clock::now();
  save_shard(*shard_, checkpoint_);
  is_saved_ = true;
  const Clock::time_point end = Clock::now();
  next_save_ = end + std::max(interval_, 20 * (end - start));
}

void SharedRender::draw(const SharedPicture& picture, const RenderOptions& options,
                        const DrawUnit& draw_unit) {
  const UnitRange all = picture.units_of(number_.index, number_.count);
  shard_ = begun(picture, all);
  is_saved_ = shard_->units().count() > 0;
  std::vector<std::uint64_t> units;
  for (std::uint64_t unit = all.first; unit < all.last; ++unit)
    if (!shard_->units().contains(unit)) units.push_back(unit);
  is_checkpoint_complete_ = units.empty();

  const double before = static_cast<double>(all.last - all.first) - static_cast<double>(units.size());
  const auto progress = [&](double done) {
    if (options.progress)
      options.progress((before + done * static_cast<double>(units.size())) /
                       static_cast<double>(all.last - all.first));
  };
  next_save_ = Clock::now() + interval_;
  std::mutex one_adds;
  const RenderOptions shared{.threads = options.threads, .stop = options.stop, .progress = progress};
  detail::for_each_in_parallel(static_cast<int>(units.size()), shared, [&](int i) {
    const std::uint64_t number = units[static_cast<std::size_t>(i)];
    const WorkUnit unit = picture.unit(number);
    Film film(unit.tile);
    draw_unit(film, unit);
    if (options.stop.stop_requested()) return;  // some samples may be missing
    std::vector<PixelSums> pixels = pixels_of(film);
    const std::lock_guard<std::mutex> lock(one_adds);
    shard_->add(number, std::move(pixels));
    is_saved_ = false;
    if (!checkpoint_.empty() && Clock::now() >= next_save_) save();
  });
  if (options.stop.stop_requested()) keep();
}

void SharedRender::keep() {
  if (shard_ && !checkpoint_.empty() && !is_saved_) save();
}

void SharedRender::finish() const {
  if (checkpoint_.empty() || is_checkpoint_complete_) return;
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(checkpoint_, error);  // saving follows links
  if (!error) std::filesystem::remove(file, error);
  if (error && error != std::errc::no_such_file_or_directory)
    throw std::system_error(error, "cannot remove " + quoted(checkpoint_));
}

std::uint64_t word_of_light(const Image& image) {
  detail::WordChecksum word;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Color light = image(x, y);
      for (const float channel : {light.r, light.g, light.b})  // NaN has many forms, and 0 has two
        word.add(channel != channel ? 1 : channel == 0 ? 0 : detail::bit_cast<std::uint32_t>(channel));
    }
  return word.value();
}

std::string fingerprint_of(const std::vector<std::filesystem::path>& files) {
  std::vector<std::uint64_t> words;
  for (const std::filesystem::path& path : files) {
    if (!std::filesystem::is_regular_file(path))
      throw std::runtime_error(
          quoted(path) + " is no regular file: it cannot be read twice, which --shard and --checkpoint do");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    detail::WordChecksum word;
    std::uint64_t size = 0;
    std::vector<unsigned char> block(1 << 16);
    while (const std::size_t count = file ? std::fread(block.data(), 1, block.size(), file.get()) : 0) {
      for (std::size_t i = 0; i < count; ++i) word.add(block[i]);
      size += count;
    }
    if (!file || std::ferror(file.get()))
      throw std::system_error(detail::error_number(), std::generic_category(), "cannot read " + quoted(path));
    word.add(size);
    words.push_back(word.value());
  }
  std::sort(words.begin(), words.end());
  detail::WordChecksum all;
  for (const std::uint64_t word : words) all.add(word);
  return hexadecimal(all.value());
}

std::string hexadecimal(std::uint64_t word) {
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[word >> shift & 15];
  return digits;
}
