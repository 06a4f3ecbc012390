#include <atomic>
#include <protostar/stop_token.hpp>
#include <version>

#if defined(__cpp_lib_jthread)
#include <stop_token>
#endif

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE("a stop token by default never asks to stop") { CHECK_FALSE(StopToken{}.stop_requested()); }

TEST_CASE("a stop token asks the function that it is made from") {
  std::atomic<bool> stops = false;
  const StopToken token = [&stops] { return stops.load(); };
  const StopToken copy = token;
  CHECK_FALSE(token.stop_requested());
  stops = true;
  CHECK(token.stop_requested());
  CHECK(copy.stop_requested());
}

#if defined(__cpp_lib_jthread)
TEST_CASE("a std::stop_token is a stop token") {
  std::stop_source source;
  const StopToken token = source.get_token();
  CHECK_FALSE(token.stop_requested());
  source.request_stop();
  CHECK(token.stop_requested());
}
#endif
