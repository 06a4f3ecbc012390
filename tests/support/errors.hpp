// Messages of exceptions.
#pragma once

#include <string>

/// Returns the message of the E that an action throws, or an empty string if it throws nothing. Any other
/// exception fails the test.
template <class E>
std::string message_of(auto&& action) {
  try {
    action();
  } catch (const E& error) {
    return error.what();
  }
  return "";
}
