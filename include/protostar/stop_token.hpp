// A request to stop, asked for by whatever takes long.
#pragma once

#include <concepts>
#include <functional>
#include <utility>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Tells long work whether it has been asked to stop. It is made from a std::stop_token, or from a function
/// that returns whether to stop and may be called by several threads at once; by default nobody asks.
///
/// It is a type of the library's, since not every standard library has std::stop_token (libc++ 14 has none).
class StopToken {
 public:
  StopToken() = default;

  template <class Token>
  requires(!std::same_as<Token, StopToken> &&
           requires(const Token& token) {
             { token.stop_requested() } -> std::same_as<bool>;
           }) StopToken(Token token)
      : asks_([token = std::move(token)] { return token.stop_requested(); }) {}

  template <std::predicate Asks>
  requires(!std::same_as<Asks, StopToken>) StopToken(Asks asks) : asks_(std::move(asks)) {}

  /// Returns true once a stop has been asked for.
  [[nodiscard]] bool stop_requested() const { return asks_ && asks_(); }

 private:
  std::function<bool()> asks_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
