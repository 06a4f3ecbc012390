// Reads decimal numbers in a browser. strtod of the C library computes in 128-bit numbers without hardware,
// and would be a twentieth of the module of a stage.
#include <emscripten.h>

#include <cerrno>
#include <cmath>
#include <cstring>

/// Returns the double nearest to a decimal number, and NaN for any other text. ECMAScript does not ask for
/// the digits from the 21st on; V8 takes them into account.
EM_JS(double, decimal_number, (const char* text), { return Number(UTF8ToString(text)); })

/// Replaces strtod, by the linker's --wrap. It reads a text that is a decimal number from beginning to end;
/// in any other text it finds no number.
extern "C" double __wrap_strtod(const char* text, char** end) {
  const double value = decimal_number(text);
  const bool has_digits = std::strcspn(text, "123456789") < std::strcspn(text, "eE");
  if (std::isinf(value) || (value == 0 && has_digits)) errno = ERANGE;
  if (end) *end = const_cast<char*>(text) + (std::isnan(value) ? 0 : std::strlen(text));
  return std::isnan(value) ? 0 : value;
}
