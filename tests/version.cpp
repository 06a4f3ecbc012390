#include <protostar/version.hpp>
#include <string>

#include "support/catch.hpp"

TEST_CASE("the version text consists of the version numbers") {
  CHECK(std::string{PROTOSTAR_VERSION} == std::to_string(PROTOSTAR_VERSION_MAJOR) + "." +
                                              std::to_string(PROTOSTAR_VERSION_MINOR) + "." +
                                              std::to_string(PROTOSTAR_VERSION_PATCH));
}
