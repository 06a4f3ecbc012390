#include <protostar/sampling/film.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {

PixelSums pixel_of(const std::vector<Color>& samples) {
  PixelSums pixel;
  for (std::uint32_t i = 0; i < samples.size(); ++i) pixel.add(i, samples[i]);
  return pixel;
}

}  // namespace

TEST_CASE("a pixel's error comes from the means of its even and its odd samples") {
  // Means of the scramblings: red 2 and 1, green 3 and 3, blue -1 and 0.5.
  const PixelSums pixel = pixel_of({{1, 3, -1}, {1, 2, 0}, {3, 3, -1}, {1, 4, 1}});
  CHECK(pixel.counts == std::array{2u, 2u});
  CHECK(pixel.mean() == Color{1.5f, 3, -0.25f});
  CHECK(pixel.squared_error(0) == 0.25);  // (2 − 1)²/4
  CHECK(pixel.squared_error(1) == 0);
  CHECK(pixel.squared_error(2) == 0.5625);
  CHECK(pixel.squared_error() == 0.8125 / 3);
  CHECK(pixel.standard_error() == Color{0.5f, 0, 0.75f});

  // With 2 and 1 samples each of the two counts as if its share were 2/3.
  const PixelSums uneven = pixel_of({{1, 0, 0}, {1, 0, 0}, {3, 0, 0}});
  CHECK(uneven.mean().r == 5.0f / 3);
  CHECK(uneven.squared_error(0) == 4.0 / 9);

  CHECK(PixelSums().mean() == Color{0});
  CHECK(pixel_of({{1, 1, 1}}).squared_error() == infinity);
}

TEST_CASE("a film is the same in whatever order and parts its samples come") {
  const Tile area{5, 2, 12, 8};
  constexpr std::uint32_t samples = 9;
  const int pixels = area.width() * area.height();
  Random random(1);
  std::vector<Color> radiance;
  for (int i = 0; i < pixels * static_cast<int>(samples); ++i)
    radiance.push_back(random.color() * static_cast<float>(std::exp2(random.real(-20, 10))));
  const auto add = [&](Film& film, std::size_t k) {
    const int pixel = static_cast<int>(k / samples);
    film(area.x0 + pixel % area.width(), area.y0 + pixel / area.width())
        .add(static_cast<std::uint32_t>(k % samples), radiance[k]);
  };
  Film expected(area);
  for (std::size_t k = 0; k < radiance.size(); ++k) add(expected, k);

  std::vector<std::size_t> order(radiance.size());
  std::iota(order.begin(), order.end(), 0u);
  WrongCases wrong(random);
  for (int trial = 0; trial < cases(5, 200); ++trial) {
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
    std::vector<Film> parts(1 + random.bits() % 5, Film(area));
    for (const std::size_t k : order) add(parts[random.bits() % parts.size()], k);
    Film sum(area);
    for (const Film& part : parts) sum += part;
    wrong.add(!(sum == expected) || sum.error().bound() != expected.error().bound(), trial);
    wrong.add(sum.mean()(6, 5) != expected.mean()(6, 5), trial);
  }
  CHECK(wrong == 0);
  Film other = expected;
  other(5, 2).add(0, Color{1});
  CHECK_FALSE(other == expected);
}

TEST_CASE("a film's pictures and its error are those of its pixels") {
  const Tile area{5, 2, 8, 4};
  Film film(area);
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x)
      film(x, y) = pixel_of({Color{static_cast<float>(x)}, Color{static_cast<float>(x + 2 * y)}});
  const Image mean = film.mean(), error = film.standard_error();
  CHECK(mean.width() == 3);
  CHECK(mean.height() == 2);
  CHECK(mean(2, 1) == Color{7 + 3.0f});
  CHECK(error(2, 1) == Color{3.0f});

  // v is y² in each pixel: 3 times 4 and 3 times 9.
  const PictureError of_film = film.error();
  CHECK(of_film.pixels() == 6);
  CHECK(of_film.squared() == 6.5);
  CHECK(of_film.rmse() == std::sqrt(6.5));
  CHECK(of_film.deviation() == std::sqrt((48.5 - 6.5 * 6.5) / 6));
  CHECK(of_film.bound() == 6.5 + 2.9 * of_film.deviation() + 2.9 * std::sqrt(2 * 48.5 / 6));

  film(5, 2) = pixel_of({Color{1}});  // nothing is known of its error
  CHECK(film.error().bound() == infinity);
  CHECK_FALSE(film.error().is_within(1e100));
  CHECK(film.error().share(1) == 0);
}

TEST_CASE("a film with any samples that tell no error refuses to tell one") {
  const Tile area{0, 0, 2, 2};
  Film told(area), untold(area);
  untold.lose_error();
  told += Film(area);
  CHECK_NOTHROW(told.error());
  CHECK_NOTHROW(told.standard_error());
  for (int i = 0; i < 2; ++i, untold += Film(area), told += untold) {
    Film& film = i == 0 ? untold : told;
    CHECK_NOTHROW(film.mean());
    if (i == 1) film += untold;
    CHECK_THAT(message_of<std::logic_error>([&] { return film.error(); }),
               ContainsSubstring("Film: its samples tell no error") &&
                   ContainsSubstring("draw all of them with SobolSampler"));
    CHECK_THROWS_AS(film.standard_error(), std::logic_error);
  }
}

TEST_CASE("a film has the pixels of a tile, and is added to films of that tile only") {
  for (const Tile& area :
       {Tile{0, 0, 0, 1}, Tile{0, 3, 1, 3}, Tile{4, 0, 2, 1}, Tile{0, 0, 1 << 15, 1 << 14}})
    CHECK_THAT(message_of<std::invalid_argument>([&] { Film film(area); }),
               ContainsSubstring("is not a size"));
  Film film(Tile{0, 0, 2, 2});
  for (const Tile& area : {Tile{0, 0, 2, 1}, Tile{1, 0, 3, 2}, Tile{0, 1, 2, 3}, Tile{0, 0, 1, 2}})
    CHECK_THROWS_AS(film += Film(area), std::invalid_argument);
}
