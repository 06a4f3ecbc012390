// Stands for parts of the C and C++ libraries in modules that draw, which would be a twentieth of the module
// of a stage: printf with the conversions that stages use and JavaScript's digits of numbers, the names of
// the errors that files in memory have, and the end of a program that may not go on.
#include <emscripten.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <utility>

/// Writes a number as %.*f or %.*g of printf do: rounded to the nearest decimal, of two as near to that whose
/// last digit is even. toExponential gives the exact digits of a double, up to 101 of them, and these decide.
EM_JS(void, write_decimal, (char* to, int size, double number, int digits, int is_fixed), {
  let text = isNaN(number) ? "nan" : "inf";
  if (isFinite(number)) {
    const[mantissa, power] = Math.abs(number).toExponential(100).split("e");
    const all = mantissa.replace(".", "");
    let point = Number(power);
    const kept = is_fixed ? point + 1 + digits : Math.max(digits, 1);
    const rest = all.slice(Math.max(kept, 0));
    const half = "5".padEnd(rest.length, "0");
    let whole = BigInt(kept > 0 ? all.slice(0, kept).padEnd(kept, "0") : 0);
    if (kept >= 0 && (rest > half || (rest == half && whole % BigInt(2)))) ++whole;
    const shown = String(whole);
    if (is_fixed) {
      const padded = shown.padStart(digits + 1, "0");
      text = padded.slice(0, padded.length - digits) + (digits ? "." + padded.slice(-digits) : "");
    } else {
      point += shown.length > kept;
      const some = shown.padStart(kept, "0").slice(0, kept);
      const is_short = -4 <= point && point < kept;
      const before = is_short ? point + 1 : 1;
      text =
          before > 0 ? some.slice(0, before) + "." + some.slice(before) : "0." + "0".repeat(-before) + some;
      while (text.endsWith("0")) text = text.slice(0, -1);
      if (text.endsWith(".")) text = text.slice(0, -1);
      if (!is_short) text += (point < 0 ? "e-" : "e+") + String(Math.abs(point)).padStart(2, "0");
    }
  }
  stringToUTF8((number < 0 || Object.is(number, -0) ? "-" : "") + text, to, size);
})

/// Returns what printf prints, for conversions %s, %d, %f and %g with a width and a precision, and %%.
static std::string formatted(const char* format, std::va_list arguments) {
  std::string text;
  const auto whole_number = [&format] {
    int number = 0;
    for (; *format >= '0' && *format <= '9'; ++format) number = 10 * number + (*format - '0');
    return number;
  };
  for (; *format != '\0'; ++format) {
    if (*format != '%') {
      text += *format;
      continue;
    }
    ++format;
    const int width = whole_number();
    int digits = 6;
    if (*format == '.') {
      const bool is_given = *++format == '*';
      if (is_given) ++format;
      digits = is_given ? va_arg(arguments, int) : whole_number();
    }
    std::string part;
    std::array<char, 512> number;  // the largest double has 309 digits before the point
    switch (*format) {
      case '%':
        part = "%";
        break;
      case 's':
        part = va_arg(arguments, const char*);
        break;
      case 'd':
        part = std::to_string(va_arg(arguments, int));
        break;
      case 'f':
      case 'g':
        write_decimal(number.data(), number.size(), va_arg(arguments, double), digits, *format == 'f');
        part = number.data();
        break;
      default:
        std::abort();
    }
    text.append(static_cast<std::size_t>(std::max(0, width - static_cast<int>(part.size()))), ' ')
        .append(part);
  }
  return text;
}

/// Replaces vsnprintf, by the linker's --wrap.
extern "C" int __wrap_vsnprintf(char* to, std::size_t size, const char* format, std::va_list arguments) {
  const std::string text = formatted(format, arguments);
  if (size > 0) {
    const std::size_t count = std::min(text.size(), size - 1);
    std::memcpy(to, text.data(), count);
    to[count] = '\0';
  }
  return static_cast<int>(text.size());
}

/// Replaces snprintf, by the linker's --wrap.
extern "C" int __wrap_snprintf(char* to, std::size_t size, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int count = __wrap_vsnprintf(to, size, format, arguments);
  va_end(arguments);
  return count;
}

/// Replaces strerror_r, by the linker's --wrap.
extern "C" int __wrap_strerror_r(int number, char* to, std::size_t size) {
  constexpr std::pair<int, const char*> names[] = {
      {EACCES, "Permission denied"},         {EEXIST, "File exists"},   {EISDIR, "Is a directory"},
      {ENOENT, "No such file or directory"}, {ENOMEM, "Out of memory"}, {ENOTDIR, "Not a directory"}};
  for (const auto& [known, name] : names)
    if (known == number) return __wrap_snprintf(to, size, "%s", name), 0;
  return __wrap_snprintf(to, size, "error %d", number), 0;
}

// Replace the ends of programs of the C++ library, which would print the reason by printf. They are weak: the
// library's own are taken where its parts are cut in another way, which makes modules larger.
#define WEAK __attribute__((weak))
extern "C" {
WEAK void abort_message(const char*, ...) { std::abort(); }
WEAK void __abort_message(const char*, ...) { std::abort(); }  // its name from LLVM 20 on
WEAK std::terminate_handler __cxa_terminate_handler = std::abort;
WEAK std::terminate_handler __cxa_unexpected_handler = std::abort;
WEAK std::new_handler __cxa_new_handler = nullptr;
}
