#include <protostar/sampling/shard.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <protostar/sampling/shard_file.hpp>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/errors.hpp"
#include "support/files.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

SharedPicture picture_of(int width, int height, std::uint32_t samples) {
  return {.width = width,
          .height = height,
          .area = {0, 0, width, height},
          .samples = samples,
          .seed = 1,
          .sampler = "sobol",
          .filter = "box",
          .scene = "3f2a",
          .rows_in_unit = 4,
          .samples_in_unit = 3};
}

/// Radiance of a sample, as a render computes it from nothing else.
Color radiance(const SharedPicture& picture, int x, int y, std::uint32_t i) {
  std::uint64_t bits = (static_cast<std::uint64_t>(y * picture.width + x) << 32 | i) + picture.seed;
  Color color;
  for (float* const channel : {&color.r, &color.g, &color.b}) {
    bits = (bits ^ bits >> 31) * 0xd1342543de82ef95 + 1;
    *channel = static_cast<float>(static_cast<std::int64_t>(bits) >> 20) * (bits % 8 == 0 ? 1 : 0x1p-44f);
  }
  return color;
}

std::vector<PixelSums> drawn(const SharedPicture& picture, std::uint64_t number) {
  const WorkUnit unit = picture.unit(number);
  std::vector<PixelSums> pixels;
  for (int y = unit.tile.y0; y < unit.tile.y1; ++y)
    for (int x = unit.tile.x0; x < unit.tile.x1; ++x) {
      pixels.emplace_back();
      for (std::uint32_t i = unit.first_sample; i < unit.last_sample; ++i)
        pixels.back().add(i, radiance(picture, x, y, i));
    }
  return pixels;
}

Film drawn_at_once(const SharedPicture& picture) {
  Film film(picture.area);
  for (int y = picture.area.y0; y < picture.area.y1; ++y)
    for (int x = picture.area.x0; x < picture.area.x1; ++x)
      for (std::uint32_t i = 0; i < picture.samples; ++i) film(x, y).add(i, radiance(picture, x, y, i));
  return film;
}

Shard drawn(const SharedPicture& picture, const UnitRange& range) {
  Shard shard(picture);
  for (std::uint64_t unit = range.first; unit < range.last; ++unit) shard.add(unit, drawn(picture, unit));
  return shard;
}

std::string bytes_of(const Shard& shard) {
  std::string bytes;
  write_shard(shard, [&](const char* block, std::size_t size) { bytes.append(block, size); });
  return bytes;
}

Shard shard_of(const std::string& bytes) {
  std::size_t at = 0;
  return read_shard(
      [&](char* block, std::size_t size) {
        const std::size_t count = std::min(size, bytes.size() - at);
        bytes.copy(block, count, at);
        at += count;
        return count;
      },
      "a.shard");
}

std::string refusal(const std::string& bytes) {
  return message_of<std::runtime_error>([&] { return shard_of(bytes); });
}

/// Returns the bytes with a word in place of another, and the checksum that belongs to them.
std::string changed(std::string bytes, std::size_t at, std::uint64_t word) {
  const auto put = [&](std::size_t where, std::uint64_t value) {
    for (std::size_t i = 0; i < 8; ++i) bytes[where + i] = static_cast<char>(value >> (8 * i) & 0xff);
  };
  put(at, word);
  detail::WordChecksum checksum;
  for (std::size_t i = 0; i + 8 < bytes.size(); i += 8) {
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < 8; ++k)
      value |= std::uint64_t{static_cast<unsigned char>(bytes[i + k])} << (8 * k);
    checksum.add(value);
  }
  put(bytes.size() - 8, checksum.value());
  return bytes;
}

}  // namespace

TEST_CASE("each sample of each pixel is in one unit, and each unit in one shard of any number") {
  Random random(1);
  WrongCases wrong(random);
  for (int trial = 0; trial < cases(30, 1000); ++trial) {
    SharedPicture picture =
        picture_of(static_cast<int>(1 + random.bits() % 5), static_cast<int>(1 + random.bits() % 60),
                   static_cast<std::uint32_t>(1 + random.bits() % 20));
    picture.area.y0 = static_cast<int>(random.bits() % static_cast<std::uint64_t>(picture.height));
    picture.area.x0 = static_cast<int>(random.bits() % static_cast<std::uint64_t>(picture.width));
    picture.rows_in_unit = static_cast<int>(1 + random.bits() % 9);
    picture.samples_in_unit = static_cast<std::uint32_t>(1 + random.bits() % 9);
    picture.validate();
    const std::uint64_t shards = 1 + random.bits() % 70;

    std::vector<std::uint64_t> found;
    std::uint64_t fewest = picture.units(), most = 0;
    for (std::uint64_t i = 0; i < shards; ++i) {
      const UnitRange range = picture.units_of(i, shards);
      fewest = std::min(fewest, range.last - range.first), most = std::max(most, range.last - range.first);
      for (std::uint64_t unit = range.first; unit < range.last; ++unit) found.push_back(unit);
    }
    std::vector<std::uint64_t> expected(picture.units());
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = i;
    wrong.add(found != expected || most - fewest > 1, picture.units(), shards);

    std::vector<int> times(static_cast<std::size_t>(picture.width * picture.height) * picture.samples);
    for (const std::uint64_t number : found) {
      const WorkUnit unit = picture.unit(number);
      std::array<std::uint32_t, 2> counts{};
      for (std::uint32_t i = unit.first_sample; i < unit.last_sample; ++i) ++counts[i % 2];
      wrong.add(counts != std::array{unit.samples_of(0), unit.samples_of(1)}, number);
      for (int y = unit.tile.y0; y < unit.tile.y1; ++y)
        for (int x = unit.tile.x0; x < unit.tile.x1; ++x)
          for (std::uint32_t i = unit.first_sample; i < unit.last_sample; ++i)
            ++times[static_cast<std::size_t>(y * picture.width + x) * picture.samples + i];
    }
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        for (std::uint32_t i = 0; i < picture.samples; ++i)
          wrong.add(times[static_cast<std::size_t>(y * picture.width + x) * picture.samples + i] !=
                        (x >= picture.area.x0 && y >= picture.area.y0 ? 1 : 0),
                    x, y, i);
  }
  CHECK(wrong == 0);
}

TEST_CASE("films of shards tell an error if the sampler does") {
  SharedPicture picture = picture_of(4, 4, 6);
  CHECK_NOTHROW(Shard(picture).sums().error());
  picture.sampler = "of my own";
  CHECK_NOTHROW(Shard(picture).sums().error());
  for (const char* const name : {"hammersley", "stratified"}) {
    picture.sampler = name;
    CHECK_THROWS_AS(Shard(picture).sums().error(), std::logic_error);
  }
}

TEST_CASE("shards are of work that exists") {
  const SharedPicture picture = picture_of(8, 8, 6);
  CHECK(picture.units() == 4);
  CHECK(picture.units_of(0, 1) == UnitRange{0, 4});
  CHECK(picture.units_of(6, 7) == UnitRange{4, 4});  // more shards than units
  CHECK(picture.units_of((std::uint64_t{1} << 63) - 1, std::uint64_t{1} << 63) == UnitRange{4, 4});
  for (const std::uint64_t n : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{3}})
    CHECK_THAT(message_of<std::invalid_argument>([&] { return picture.units_of(n, n); }),
               ContainsSubstring("shard " + std::to_string(n) + " of " + std::to_string(n) +
                                 ": shards are numbered from 0"));
  CHECK(picture.text_of(1) == "unit 1 (rows 0 to 3, samples 3 to 5)");

  // The largest picture that there can be has numbers for all its units.
  constexpr auto most = std::uint32_t{most_samples_of_pixel};
  SharedPicture largest = picture_of(1, 1 << 28, most);
  largest.rows_in_unit = 1, largest.samples_in_unit = 1;
  largest.validate();
  const std::uint64_t last = largest.units() - 1;
  CHECK(last == (std::uint64_t{1} << 28) * most - 1);
  CHECK(largest.unit(last).last_sample == most);
  largest.samples_in_unit = std::numeric_limits<std::uint32_t>::max();
  CHECK(largest.unit(0).samples_of(0) == 1u << 21);
  CHECK(largest.unit(0).samples_of(1) == (1u << 21) - 1);
}

TEST_CASE("a picture to be shared needs a size, an area inside of it, samples and units") {
  struct Row {
    void (*change)(SharedPicture&);
    const char* message;
  };
  const auto row = GENERATE(
      Row{[](SharedPicture& p) { p.width = 0; }, "0x6 is not a size"},
      Row{[](SharedPicture& p) { p.height = 1 << 28; }, "4x268435456 is not a size"},
      Row{[](SharedPicture& p) { p.area.x1 = 5; },
          "the area is columns 0 to 4 and rows 0 to 5; it must have pixels"},
      Row{[](SharedPicture& p) { p.area.y1 = std::numeric_limits<int>::min(); },
          "the area is columns 0 to 3"},
      Row{[](SharedPicture& p) { p.area.x0 = 4; }, "the area is columns 4 to 3"},
      Row{[](SharedPicture& p) { p.area.y0 = -1; }, "rows -1 to 5"},
      Row{[](SharedPicture& p) { p.samples = 0; }, "samples are 0; they must be from 1 to 4194303"},
      Row{[](SharedPicture& p) { p.samples = std::uint32_t{most_samples_of_pixel} + 1; },
          "samples are 4194304; they must be from 1 to 4194303, as many as a pixel can have"},
      Row{[](SharedPicture& p) { p.rows_in_unit = 0; }, "rows in a unit are 0; they must be at least 1"},
      Row{[](SharedPicture& p) { p.samples_in_unit = 0; },
          "samples in a unit are 0; they must be at least 1"},
      Row{[](SharedPicture& p) { p.scene.assign(4097, 'x'); },
          "a text has 4097 bytes; at most 4096 are allowed"});
  SharedPicture picture = picture_of(4, 6, 5);
  row.change(picture);
  CHECK_THAT(message_of<std::invalid_argument>([&] { Shard shard(picture); }),
             ContainsSubstring(row.message));
}

TEST_CASE("a set of units is the same in whatever order units are added") {
  Random random(2);
  WrongCases wrong(random);
  for (int trial = 0; trial < cases(50, 2000); ++trial) {
    std::vector<bool> is_in(64);
    std::vector<UnitRange> ranges;
    for (std::uint64_t at = random.bits() % 4; at < 60;) {
      const std::uint64_t end = std::min<std::uint64_t>(at + random.bits() % 6, 60);
      ranges.push_back({at, end});
      for (; at < end; ++at) is_in[at] = true;
      at += random.bits() % 3;
    }
    UnitSet rising, any;
    for (const UnitRange& range : ranges) rising.add(range);
    for (std::size_t i = ranges.size(); i > 1; --i) std::swap(ranges[i - 1], ranges[random.bits() % i]);
    for (const UnitRange& range : ranges) any.add(range);
    wrong.add(!(any == rising), trial);
    wrong.add(any.count() != static_cast<std::uint64_t>(std::count(is_in.begin(), is_in.end(), true)), trial);
    for (std::uint64_t first = 0; first < 64; ++first)
      for (std::uint64_t last = first; last < 64; ++last) {
        std::optional<std::uint64_t> common, missing;
        for (std::uint64_t i = last; i-- > first;) (is_in[i] ? common : missing) = i;
        wrong.add(any.common({first, last}) != common || any.missing({first, last}) != missing, first, last);
      }
  }
  CHECK(wrong == 0);
}

TEST_CASE("any partition, merged in any order, gives the same bytes") {
  SharedPicture picture = picture_of(32, 24, 8);
  picture.area = {0, 1, 31, 24};
  std::vector<std::vector<PixelSums>> units;
  for (std::uint64_t unit = 0; unit < picture.units(); ++unit) units.push_back(drawn(picture, unit));
  const Shard whole = drawn(picture, UnitRange{0, picture.units()});
  const std::string expected = bytes_of(whole);
  REQUIRE(whole.film() == drawn_at_once(picture));

  Random random(3);
  WrongCases wrong(random);
  for (int trial = 0; trial < cases(40, 1000); ++trial) {
    const std::uint64_t shards = 1 + random.bits() % 30;
    std::vector<Shard> parts(shards, Shard(picture));
    for (std::uint64_t i = 0; i < shards; ++i)
      for (auto [unit, last] = picture.units_of(i, shards); unit < last; ++unit)  // or units in any shard
        parts[trial % 2 == 0 ? i : random.bits() % shards].add(unit, units[unit]);
    if (trial % 4 < 2)
      for (Shard& part : parts) part = shard_of(bytes_of(part));  // by files
    while (parts.size() > 1) {
      std::swap(parts[random.bits() % parts.size()], parts.back());
      Shard last = std::move(parts.back());
      parts.pop_back();
      parts[random.bits() % parts.size()].merge(std::move(last));
    }
    wrong.add(bytes_of(parts[0]) != expected || !(parts[0].film() == whole.film()), trial, shards);
  }
  CHECK(wrong == 0);
}

TEST_CASE("the sum of some shards tells which are missing, unless several numbers of shards are possible") {
  Random random(31);
  WrongCases wrong;
  int told = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    SharedPicture picture = picture_of(1, static_cast<int>(1 + random.bits() % 200),
                                       static_cast<std::uint32_t>(1 + random.bits() % 40));
    const std::uint64_t n = 1 + random.bits() % picture.units();
    UnitSet units;
    std::vector<std::uint64_t> lost;
    for (std::uint64_t i = 0; i < n; ++i)
      if (random.bits() % 4 == 0)
        lost.push_back(i);
      else
        units.add(picture.units_of(i, n));
    const auto missing = Shard(picture, units, {}).missing_shards(n - lost.size());
    const bool is_told = missing.of == n && missing.numbers == lost;
    wrong.add(!is_told && (missing.of != 0 || !missing.numbers.empty()), trial, n, picture.units());
    told += is_told && !lost.empty();
  }
  CHECK(wrong == 0);
  CHECK(told > 1000);
}

TEST_CASE("the missing shards of pictures of the most units are told in no time, or not told") {
  SharedPicture picture = picture_of(1, 1 << 24, 1);
  picture.rows_in_unit = 16;
  CHECK(picture.units() == SharedPicture::most_units);
  UnitSet half;
  half.add(picture.units_of(1, 2));
  const auto missing = Shard(picture, half, {}).missing_shards(1);
  CHECK(missing.of == 2);
  CHECK(missing.numbers == std::vector<std::uint64_t>{0});

  picture.rows_in_unit = 1, picture.samples_in_unit = 1;
  picture.samples = 1 << 24;  // of a file that no program wrote
  UnitSet one;
  one.add({5, 6});
  CHECK(Shard(picture, one, {}).missing_shards(1).of == 0);
}

TEST_CASE("a missing or doubled unit is an error that names it, and nothing is merged") {
  const SharedPicture picture = picture_of(3, 8, 6);  // 2 bands of 2 blocks
  Shard first = drawn(picture, UnitRange{0, 2});
  const std::string before = bytes_of(first);
  CHECK(first.missing() == 2);
  CHECK(message_of<std::runtime_error>([&] { return first.film(); }) ==
        "unit 2 (rows 4 to 7, samples 0 to 2) is missing; 2 of 4 units are there");
  CHECK(message_of<std::runtime_error>([&] { return first.film(1); }) ==  // shard 0 of 2 or of 3
        "unit 2 (rows 4 to 7, samples 0 to 2) is missing; 2 of 4 units are there");
  CHECK(message_of<std::runtime_error>([&] { return first.film(2); }) ==
        "unit 2 (rows 4 to 7, samples 0 to 2) is missing; 2 of 4 units are there; missing: --shard 2/4, 3/4");
  CHECK(message_of<std::runtime_error>([&] { return Shard(picture).film(0); }) ==
        "unit 0 (rows 0 to 3, samples 0 to 2) is missing; 0 of 4 units are there");
  const SharedPicture bands = picture_of(1, 400, 1);
  Shard two = drawn(bands, UnitRange{0, 1});
  two.merge(drawn(bands, UnitRange{8, 9}));
  CHECK_THAT(message_of<std::runtime_error>([&] { return two.film(2); }),
             ContainsSubstring("; missing: --shard 1/100, 2/100, 3/100, 4/100, 5/100, 6/100, 7/100, 9/100, "
                               "10/100, 11/100 and 88 more"));
  CHECK(first.sums()(0, 0).count() == 6);
  CHECK(first.sums()(0, 4).count() == 0);

  CHECK(message_of<std::invalid_argument>([&] {
          first.merge(drawn(picture, UnitRange{1, 4}));
        }) == "Shard: unit 1 (rows 0 to 3, samples 3 to 5) is in both shards");
  CHECK(message_of<std::invalid_argument>([&] { first.add(1, drawn(picture, 1)); }) ==
        "Shard: unit 1 (rows 0 to 3, samples 3 to 5) is there already");
  CHECK(message_of<std::invalid_argument>([&] { first.add(4, drawn(picture, 1)); }) ==
        "Shard: unit 4 is none of the picture's 4");
  std::vector<PixelSums> cut = drawn(picture, 2);
  cut.pop_back();
  std::vector<PixelSums> twice = drawn(picture, 2);
  twice[5].add(0, Color{1});
  for (const auto& wrong : {cut, twice, drawn(picture, 3)})  // 3 has as many samples, but more odd ones
    CHECK_THAT(message_of<std::invalid_argument>([&] { first.add(2, wrong); }),
               ContainsSubstring("not those of all pixels and samples of unit 2"));
  CHECK(bytes_of(first) == before);
  first.merge(drawn(picture, UnitRange{2, 4}));
  CHECK(first.missing() == std::nullopt);
}

TEST_CASE("shards of different pictures are not merged") {
  struct Row {
    void (*change)(SharedPicture&);
    const char* message;
  };
  const auto row = GENERATE(
      Row{[](SharedPicture& p) { p.width = 4; }, "size 4x4, not 3x4"},
      Row{[](SharedPicture& p) { p.area.x1 = 2; },
          "area columns 0 to 1 and rows 0 to 3, not columns 0 to 2 and rows 0 to 3"},
      Row{[](SharedPicture& p) { p.samples = 7; }, "samples 7, not 6"},
      Row{[](SharedPicture& p) { p.seed = ~std::uint64_t{0}; }, "seed 18446744073709551615, not 1"},
      Row{[](SharedPicture& p) { p.sampler = "halton"; }, "sampler 'halton', not 'sobol'"},
      Row{[](SharedPicture& p) { p.filter = "te\nnt"; }, "filter 'te\\x0ant', not 'box'"},
      Row{[](SharedPicture& p) { p.scene = ""; }, "scene '', not '3f2a'"},
      Row{[](SharedPicture& p) { p.finish.exposure = 0.5; },
          "finish 'exposure 0.5, tone clip, transfer gamma=2.2', not 'exposure 1, tone clip, transfer "
          "gamma=2.2'"},
      Row{[](SharedPicture& p) { p.finish = {.tone = Tone::scale_image, .transfer = Srgb{}, .plain = true}; },
          "finish 'exposure 1, tone scale-image, transfer srgb, plain', not 'exposure 1, tone clip, transfer "
          "gamma=2.2'"},
      Row{[](SharedPicture& p) { p.version = "0.0.9"; }, "version '0.0.9', not '" PROTOSTAR_VERSION "'"},
      Row{[](SharedPicture& p) { p.rows_in_unit = 2; }, "rows in a unit 2, not 4"},
      Row{[](SharedPicture& p) { p.samples_in_unit = 2; }, "samples in a unit 2, not 3"});
  const SharedPicture picture = picture_of(3, 4, 6);
  SharedPicture other = picture;
  row.change(other);
  Shard shard(picture);
  CHECK_THAT(message_of<std::invalid_argument>([&] { shard.merge(Shard(other)); }),
             ContainsSubstring(row.message));

  const TemporaryFolder folder;
  save_shard(shard, folder / "a.shard");
  save_shard(Shard(other), folder / "b.shard");
  const std::string a = (folder / "a.shard").string(), b = (folder / "b.shard").string();
  CHECK(message_of<std::runtime_error>([&] {
          return merge_shards({a, b});
        }) == "'" + b + "' is not of the picture of '" + a + "': " + row.message);
}

TEST_CASE("a shard file is read as it was written, and a long render goes on from it") {
  const SharedPicture picture = picture_of(5, 12, 8);
  const TemporaryFolder folder;
  const auto save = [&](const char* name, UnitRange range) {
    save_shard(drawn(picture, range), folder / name);
    return (folder / name).string();
  };
  const std::string all = save("all.shard", {0, 9}), empty = save("empty.shard", {9, 9});
  const std::string b = save("b.shard", {4, 9}), a = save("a.shard", {0, 4});
  CHECK(bytes_of(merge_shards({b, empty, a})) == bytes_of(folder / "all.shard"));
  CHECK(bytes_of(merge_shards({a})) == bytes_of(folder / "a.shard"));
  CHECK(load_shard(empty).units().count() == 0);
  CHECK(folder.count() == 4);

  CHECK(message_of<std::runtime_error>([&] {
          return merge_shards({empty, b, a, all});
        }) == "'" + all + "' has unit 0 (rows 0 to 3, samples 0 to 2), and '" + a + "' has it too");
  CHECK_THAT(message_of<std::runtime_error>([&] { return merge_shards({}); }),
             ContainsSubstring("no .shard files"));
  CHECK_THAT(message_of<std::runtime_error>([&] {
               return merge_shards({b, empty}).film();
             }),
             ContainsSubstring("unit 0 (rows 0 to 3, samples 0 to 2) is missing; 5 of 9"));
  for (const std::string& wrong : {(folder / "none.shard").string(), (folder / "").string()})
    CHECK_THAT(message_of<std::system_error>([&] { return load_shard(wrong); }),
               ContainsSubstring("cannot read '" + wrong + "'"));

  Shard checkpoint = load_shard(b);  // its units are done
  for (std::uint64_t unit = 0; unit < picture.units(); ++unit)
    if (!checkpoint.units().contains(unit)) checkpoint.add(unit, drawn(picture, unit));
  CHECK(bytes_of(checkpoint) == bytes_of(folder / "all.shard"));
}

TEST_CASE("a shard file that ends early, goes on or has another byte anywhere is refused") {
  SharedPicture picture = picture_of(3, 7, 5);
  picture.rows_in_unit = 2;
  Shard shard = drawn(picture, UnitRange{1, 4});
  shard.add(6, drawn(picture, 6));
  const std::string bytes = bytes_of(shard);
  REQUIRE(bytes_of(shard_of(bytes)) == bytes);
  WrongCases wrong;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::string message = refusal(bytes.substr(0, size));
    wrong.add(message != "'a.shard': the file ends after " + std::to_string(size) + " bytes, too early", size,
              message);
  }
  Random random(4);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int k = 0; k < cases(3, 255); ++k) {
      std::string other = bytes;
      const int flips = cases(0, 1) ? k + 1
                        : k < 2     ? (k == 0 ? 1 : 128)
                                    : static_cast<int>(1 + random.bits() % 255);
      other[i] = static_cast<char>(static_cast<unsigned char>(other[i]) ^ flips);
      const std::string message = refusal(other);
      wrong.add(!message.starts_with("'a.shard': "), i, flips, message);
    }
  for (const char* more : {"x", "12345678"})
    CHECK(refusal(bytes + more) == "'a.shard': the file goes on after " + std::to_string(bytes.size()) +
                                       " bytes, where it should end");
  CHECK(wrong == 0);
}

TEST_CASE("a wrong number in a shard file is refused with its place and what is allowed") {
  const SharedPicture picture = picture_of(1, 4, 6);  // 4 pixels in one band of 2 blocks
  const std::string bytes = bytes_of(drawn(picture, UnitRange{0, 1}));
  // 2 words of magic, the format, 6 words of numbers, 4 texts of 2 words, 3 of units, 4 · 12 of sums, 1.
  REQUIRE(bytes.size() == 8 * (2 + 1 + 6 + 8 + 4 + 3 + 48 + 1));
  struct Row {
    std::size_t word;
    std::uint64_t value;
    const char* message;
  };
  constexpr std::uint64_t big = std::uint64_t{1} << 63;
  const auto row = GENERATE(
      Row{0, 0, "the file does not begin with 'protostar shard'"},
      Row{2, 1, "byte 16: version 1 of .shard files; this program reads version 2"},
      Row{3, 1, "1x0 is not a size"}, Row{4, 1, "the area is columns 1 to 0 and rows 0 to 3"},
      Row{5, big | 1, "the area is columns 0 to 0 and rows 0 to -2147483649"},
      Row{6, std::uint64_t{3} << 32, "samples are 0"}, Row{6, 6, "samples in a unit are 0"},
      Row{7, 0xffffffff, "rows in a unit are -1"}, Row{7, big | 4, "byte 56: the upper half of the rows"},
      Row{9, 4097, "byte 72: length of a text 4097; allowed are 0 to 4096"},
      Row{12, 0x7800006c6f626f73, "byte 96: a text is filled up with something else than zeros"},
      Row{17, detail::bit_cast<std::uint64_t>(-1.0), "Finish: exposure must be from 0 to 3.4e38"},
      Row{18, 3, "byte 144: tone 3 and plain 0; allowed are 0 to 2, and 0 and 1"},
      Row{18, std::uint64_t{2} << 32, "byte 144: tone 0 and plain 2"},
      Row{19, 3, "byte 152: transfer 3; allowed are 0 to 2"},
      Row{19, 0, "byte 160: an exponent of a transfer that has none"},
      Row{20, 0, "Finish: gamma must be finite and greater than 0; it is 0"},
      Row{21, 3, "byte 168: number of ranges of units 3; allowed are 0 to 1"},
      Row{22, 3, "byte 176: first unit 3; allowed are 0 to 1"},
      Row{23, 0, "byte 184: end of a range of units 0; allowed are 1 to 2"},
      Row{23, 3, "byte 184: end of a range of units 3; allowed are 1 to 2"},
      // The first pixel has two samples in scrambling 0, of at most 2^94 units each, and one in scrambling 1.
      Row{25, big, "byte 200: a sum is beyond that of 2 samples"},
      Row{25, 1u << 31, "byte 200: a sum is beyond that of 2 samples"},
      Row{29, (1u << 31) + 1, "byte 232: a sum is beyond that of 2 samples"},
      Row{27, -(std::uint64_t{1} << 31) - 1, "byte 216: a sum is beyond that of 2 samples"},
      Row{31, 1u << 30, "byte 248: a sum is beyond that of 1 samples"});
  CHECK_THAT(refusal(changed(bytes, 8 * row.word, row.value)),
             ContainsSubstring("'a.shard': ") && ContainsSubstring(row.message));
  // Two ranges of four units may be there, but none that would go on from the one before it.
  const std::string of_four = bytes_of(drawn(picture_of(1, 4, 10), UnitRange{0, 1}));
  CHECK_THAT(refusal(changed(changed(of_four, 8 * 21, 2), 8 * 23, 3)),
             ContainsSubstring("byte 184: a range of units ends at 3 of 4, and another should follow"));
  for (const std::uint64_t high : {std::uint64_t{1} << 31, -(std::uint64_t{1} << 31)})  // just not beyond
    CHECK(refusal(changed(changed(bytes, 8 * 24, 0), 8 * 25, high)).empty());
  CHECK(refusal(changed(bytes, 64, 7)).empty());  // another seed is a picture of its own
  CHECK(shard_of(changed(bytes, 64, 7)).picture().seed == 7);
}

TEST_CASE("a shard file that claims a huge picture is refused before it takes memory") {
  SharedPicture huge = picture_of(1 << 14, 1 << 14, std::uint32_t{most_samples_of_pixel});
  huge.rows_in_unit = 1 << 14, huge.samples_in_unit = 1;
  std::string bytes = bytes_of(Shard(huge));
  bytes = changed(bytes.insert(bytes.size() - 8, 16, '\0'), 8 * 21, 1);
  bytes = changed(bytes, 8 * 23, huge.units());  // all units, of which none is there
  // What comes after the units is the checksum, which is no sum of a pixel; or the file ends.
  CHECK_THAT(refusal(bytes), ContainsSubstring("too early") || ContainsSubstring("a sum is beyond"));
}
