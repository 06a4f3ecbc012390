// How much of the machine works, and who is told about it.
#pragma once

#include <functional>
#include <stop_token>

#include "platform.hpp"

#if !defined(__cpp_lib_jthread)
#error "protostar needs std::jthread and std::stop_token: libstdc++ 10 or newer"
#endif

namespace protostar::inline PROTOSTAR_ABI {

/// How render works. An exception that progress throws ends the render and reaches its caller; after a stop,
/// progress does not come to 1.
struct RenderOptions {
  int threads = 0;            ///< how many work, the caller among them; 0: one for each core
  std::stop_token stop = {};  ///< asked for, render returns early; other pixels stay as they were
  std::function<void(double done)> progress = {};  ///< called in the caller's thread with a share from 0 to 1
};

}  // namespace protostar::inline PROTOSTAR_ABI
