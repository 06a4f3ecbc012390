// The reason why a function of the C library failed.
#pragma once

#include <cerrno>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Returns the error number of a call of the C library that has failed, before which errno was 0 or the
/// number of another failure: EIO if it is 0 still. The C standard lets a library leave errno as it is, as
/// for fwrite, and an error of number 0 would be told as "Success", or be taken for none.
[[nodiscard]] inline int error_number() { return errno != 0 ? errno : EIO; }

}  // namespace protostar::inline PROTOSTAR_ABI::detail
