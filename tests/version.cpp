#include <protostar/version.hpp>
#include <string>

#include "support/catch.hpp"

TEST_CASE("the version as text is made of its numbers") {
  CHECK(std::string{PROTOSTAR_VERSION} == std::to_string(PROTOSTAR_VERSION_MAJOR) + "." +
                                              std::to_string(PROTOSTAR_VERSION_MINOR) + "." +
                                              std::to_string(PROTOSTAR_VERSION_PATCH));
}
