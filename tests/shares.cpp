// Choices by shares: probabilities, and the number that is left for the next choice.
#include <protostar/sampling/shares.hpp>

#include <cmath>

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE(
    "a choice by shares leaves a number below 1 for the next choice, which chooses nothing of share 0") {
  // The last number that chooses the second thing: its distance from the begin and the share both round up.
  struct Row {
    double first, second, third, number;
  };
  const auto [first, second, third, number] =
      GENERATE(Row{0x1.8b49bd8475d86p-4, 0x1.39b303c17d03fp-2, 0x1.f8f3b8e27badap-5, 0x1.bc0e525e11863p-1},
               Row{0x1.504022347c426p-4, 0x1.9582b82456283p-2, 0x1.549d17eb0964ep-3, 0x1.7bdbf34f40227p-1},
               Row{1, 1, 1, std::nextafter(2 / 3.0, 0)});
  Shares shares(3);
  for (const double share : {first, second, third}) shares.add(share);
  const auto [index, probability, rest] = shares.choose(number);
  CHECK(index == 1);
  CHECK(probability == shares.probability(1));
  CHECK(rest > 0.99);
  CHECK(rest < 1);

  Shares with_nothing(2);
  with_nothing.add(third);
  with_nothing.add(0);
  CHECK(with_nothing.choose(rest).index == 0);
}
