// Pictures that are drawn in units: any partition has the bytes of the whole, and a run goes on from the
// checkpoint of another.
#include "stages/support/shared_render.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <protostar/integrators/shadow.hpp>
#include <protostar/protostar.hpp>
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

/// A small scene, and its picture of 32x24 pixels and 8 samples.
struct SharedScene {
  Scene<Sphere, Plane> scene;
  Camera camera;
  RenderOptions options{.samples = 8,
                        .sampler = sampler_of<SobolSampler>,
                        .filter = ReconstructionFilter::mitchell(),
                        .seed = 7,
                        .crop = {0, 0, 32, 24},
                        .threads = 1};
  SharedPicture picture{.width = 32, .height = 24, .area = {0, 0, 32, 24}, .samples = 8, .seed = 7};

  SharedScene() {
    scene.add(Sphere{.center = {0, 0, 3}, .radius = 1}, Color{0.9f, 0.5f, 0.1f});
    scene.add(Plane{.normal = {0, 1, 0}, .distance = -1}, Color{0.3f, 0.35f, 0.4f});
    scene.add(PointLight{.position = {-2, 3, 0}, .power = Color{250}});
    scene.set_sky({0.05f, 0.1f, 0.2f});
    picture.cut();
  }

  void add(Film& film, const WorkUnit& unit) const {
    add_samples(film, SampleRange{unit.first_sample, unit.last_sample}, camera, scene, ShadowIntegrator{},
                options);
  }

  [[nodiscard]] Image drawn_whole() const {
    Image image(32, 24);
    render(image, camera, scene, ShadowIntegrator{}, options);
    return image;
  }
};

bool same_light(const Image& a, const Image& b) {
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      if (a(x, y).r != b(x, y).r || a(x, y).g != b(x, y).g || a(x, y).b != b(x, y).b) return false;
  return true;
}

std::vector<PixelSums> sums_in_rows(const Film& film) {
  std::vector<PixelSums> sums;
  for (int y = film.tile().y0; y < film.tile().y1; ++y)
    for (int x = film.tile().x0; x < film.tile().x1; ++x) sums.push_back(film(x, y));
  return sums;
}

}  // namespace

TEST_CASE("1,000 random partitions of a picture, merged in random order, have the bytes of the whole") {
  const SharedScene shared;
  REQUIRE(shared.picture.units() == 12);
  std::vector<std::vector<PixelSums>> units;
  for (std::uint64_t unit = 0; unit < shared.picture.units(); ++unit) {
    Film film(shared.picture.unit(unit).tile);
    shared.add(film, shared.picture.unit(unit));
    units.push_back(sums_in_rows(film));
  }
  const Image whole = shared.drawn_whole();
  Random random(5);
  WrongCases wrong(random);
  for (int trial = 0; trial < cases(20, 1000); ++trial) {
    std::vector<Shard> parts(1 + random.bits() % 12, Shard(shared.picture));
    for (std::uint64_t unit = 0; unit < units.size(); ++unit)
      parts[random.bits() % parts.size()].add(unit, units[unit]);
    Shard all(shared.picture);
    while (!parts.empty()) {
      std::swap(parts[random.bits() % parts.size()], parts.back());
      all.merge(std::move(parts.back()));
      parts.pop_back();
    }
    wrong.add(!same_light(all.film().mean(), whole), trial);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a run goes on from the checkpoint of a run that was killed, and draws no unit twice") {
  const SharedScene shared;
  const TemporaryFolder folder;
  const std::filesystem::path checkpoint = folder / "state";
  const Image whole = shared.drawn_whole();
  const std::uint64_t all = shared.picture.units();
  std::vector<int> drawn(all, 0);
  for (std::uint64_t run = 0; run <= all / 5; ++run) {
    SharedRender render({}, checkpoint, std::chrono::seconds(0));
    int left = run < all / 5 ? 5 : static_cast<int>(all);
    const auto draw = [&](Film& film, const WorkUnit& unit) {
      if (left-- == 0) throw std::runtime_error("killed");
      shared.add(film, unit);
      for (std::uint64_t i = 0; i < all; ++i)
        if (shared.picture.unit(i).tile.y0 == unit.tile.y0 &&
            shared.picture.unit(i).first_sample == unit.first_sample)
          ++drawn[i];
    };
    if (run < all / 5) {
      CHECK(message_of<std::runtime_error>([&] { render.draw(shared.picture, shared.options, draw); }) ==
            "killed");
      // Saving takes time, after which some units are drawn and not saved.
      const std::uint64_t saved = load_shard(checkpoint).units().count();
      CHECK(saved > 0);
      CHECK(saved <= 5 * (run + 1));
      continue;
    }
    render.draw(shared.picture, shared.options, draw);
    CHECK(same_light(render.shard()->film().mean(), whole));
    CHECK(folder.count() == 1);
    render.finish();
    CHECK(folder.count() == 0);
  }
}

TEST_CASE("a finished shard that is named as the checkpoint is read, and stays") {
  const SharedScene shared;
  const TemporaryFolder folder;
  const std::filesystem::path finished = folder / "a.shard";
  const auto add = [&](Film& film, const WorkUnit& unit) { shared.add(film, unit); };
  SharedRender before({}, {});
  before.draw(shared.picture, shared.options, add);
  save_shard(*before.shard(), finished);

  SharedRender render({}, finished);
  render.draw(shared.picture, shared.options, [](Film&, const WorkUnit&) { FAIL("a unit is drawn again"); });
  CHECK(same_light(render.shard()->film().mean(), shared.drawn_whole()));
  render.finish();
  CHECK(folder.count() == 1);
}

TEST_CASE("after a stop the checkpoint has all units that are done, and no others are drawn later") {
  const SharedScene shared;
  const TemporaryFolder folder;
  std::atomic<int> count = 0;
  RenderOptions options = shared.options;
  options.threads = GENERATE(1, 3);
  options.stop = [&] { return count > 6; };
  std::vector<double> shares;
  {
    SharedRender render({}, folder / "state");
    render.draw(shared.picture, options, [&](Film& film, const WorkUnit& unit) {
      shared.add(film, unit);
      ++count;
    });
    CHECK(render.shard()->missing());
    CHECK(render.shard()->units() == load_shard(folder / "state").units());
    CHECK(render.shard()->units().count() <= 6);
    CHECK(render.shard()->units().count() >= 4);
  }
  const std::uint64_t before = load_shard(folder / "state").units().count();
  options.stop = {};
  options.progress = [&](double done) { shares.push_back(done); };
  count = 0;
  SharedRender render({}, folder / "state");
  render.draw(shared.picture, options, [&](Film& film, const WorkUnit& unit) {
    shared.add(film, unit);
    ++count;
  });
  CHECK(static_cast<std::uint64_t>(count) == shared.picture.units() - before);
  CHECK(same_light(render.shard()->film().mean(), shared.drawn_whole()));
  REQUIRE(!shares.empty());
  CHECK(shares.front() > static_cast<double>(before) / static_cast<double>(shared.picture.units()));
  CHECK(shares.back() == 1);
}

TEST_CASE("a checkpoint of another picture or shard, or one that cannot be written, is refused at once") {
  const SharedScene shared;
  const TemporaryFolder folder;
  const auto draw_from = [&](const std::filesystem::path& path, const SharedPicture& picture,
                             const ShardNumber& number) {
    SharedRender render(number, path);
    render.draw(picture, shared.options, [](Film&, const WorkUnit&) { FAIL("a unit is drawn"); });
  };
  const std::filesystem::path path = folder / "state";
  Shard shard(shared.picture);
  Film film(shared.picture.unit(0).tile);
  shared.add(film, shared.picture.unit(0));
  shard.add(0, sums_in_rows(film));
  save_shard(shard, path);
  const std::string bytes = bytes_of(path);

  SharedPicture other = shared.picture;
  other.seed = 8;
  CHECK(message_of<std::runtime_error>([&] { draw_from(path, other, {}); }) ==
        "--checkpoint: '" + path.string() +
            "' is of other work: it has seed 7, not 8; name another file, or remove it");
  CHECK_THAT(
      message_of<std::runtime_error>([&] {
        draw_from(path, shared.picture, {1, 2});
      }),
      ContainsSubstring("it has " + shared.picture.text_of(0) + ", which is in another shard than 1/2"));
  put_bytes(folder / "text", "no shard");
  CHECK_THAT(message_of<std::runtime_error>([&] { draw_from(folder / "text", shared.picture, {}); }),
             ContainsSubstring("the file ends after 8 bytes, too early"));
  CHECK_THAT(message_of<std::system_error>([&] { draw_from(folder / "none/state", shared.picture, {}); }),
             ContainsSubstring("cannot write '" + (folder / "none/state").string() + "'"));
  CHECK(bytes_of(path) == bytes);
  CHECK(folder.count() == 2);
}

TEST_CASE("files are told apart by their bytes, and not by their names or order") {
  const TemporaryFolder folder;
  put_bytes(folder / "a", "1");
  put_bytes(folder / "b", std::string(100000, '2'));
  put_bytes(folder / "c", "1");
  const std::string ab = fingerprint_of({folder / "a", folder / "b"});
  CHECK(ab.size() == 16);
  CHECK(fingerprint_of({folder / "b", folder / "c"}) == ab);
  CHECK(fingerprint_of({folder / "a"}) != ab);
  CHECK(fingerprint_of({folder / "a", folder / "b", folder / "c"}) != ab);
  std::string changed_b(100000, '2');
  for (const std::size_t at : {std::size_t{0}, std::size_t{65536}, std::size_t{99999}}) {
    changed_b[at] = '3';
    put_bytes(folder / "b", changed_b);
    CHECK(fingerprint_of({folder / "a", folder / "b"}) != ab);
    changed_b[at] = '2';
  }
  put_bytes(folder / "b", changed_b + '\0');
  CHECK(fingerprint_of({folder / "a", folder / "b"}) != ab);
  CHECK_THAT(message_of<std::runtime_error>([&] { return fingerprint_of({"/dev/null"}); }),
             ContainsSubstring("'/dev/null' is no regular file"));
}

TEST_CASE("pictures are told apart by any channel of their light, and NaN and 0 are one number each") {
  Image image(3, 2);
  const std::uint64_t black = word_of_light(image);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x)
      for (float Color::*const channel : {&Color::r, &Color::g, &Color::b}) {
        const Color before = image(x, y);
        image(x, y).*channel = 1e-40f;
        CHECK(word_of_light(image) != black);
        image(x, y).*channel = -0.0f;
        CHECK(word_of_light(image) == black);
        image(x, y) = before;
      }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  image(1, 1) = Color{nan};
  const std::uint64_t with_nan = word_of_light(image);
  image(1, 1) = Color{-nan};
  CHECK(word_of_light(image) == with_nan);
  CHECK(with_nan != black);
}
