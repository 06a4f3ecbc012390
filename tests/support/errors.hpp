// What an exception says.
#pragma once

#include <string>

/// The message of the E that an action throws; empty if it throws nothing. Anything else fails the test.
template <class E>
std::string message_of(auto&& action) {
  try {
    action();
  } catch (const E& error) {
    return error.what();
  }
  return "";
}
