#include <protostar/shown.hpp>

#include <clocale>
#include <limits>
#include <protostar/io/text.hpp>
#include <string>
#include <utility>

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE("foreign text is shown with its control characters escaped") {
  struct {
    std::string text, expected;
  } const rows[] = {
      {"", ""},
      {"a b~\\\"'.png", "a b~\\\"'.png"},
      {std::string("\0\x01\x1f", 3), "\\x00\\x01\\x1f"},
      {"a\x1b[31m\x07red\nline\r\t.png", "a\\x1b[31m\\x07red\\x0aline\\x0d\\x09.png"},
      {"\x7f", "\\x7f"},
      {"\xc2\x9b", "\\xc2\\x9b"},  // U+009B, which begins a terminal command as ESC [ does
      {"\xc2\xa0\xc3\xa4 \xe2\x82\xac \xf0\x9f\x8c\x8d", "\xc2\xa0\xc3\xa4 \xe2\x82\xac \xf0\x9f\x8c\x8d"},
      {"\x9b", "\\x9b"},
      {"\xff\xfe", "\\xff\\xfe"},
      {"\xe2\x82", "\\xe2\\x82"},           // truncated
      {"\xc0\x8a", "\\xc0\\x8a"},           // a line feed in two bytes
      {"\xe0\x80\x8a", "\\xe0\\x80\\x8a"},  // a line feed in three bytes
      {"\xf0\x80\x80\x8a", "\\xf0\\x80\\x80\\x8a"},
      {"\xed\xa0\x80", "\\xed\\xa0\\x80"},           // a surrogate
      {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"},  // above U+10FFFF
      {"\xe2\x1b[", "\\xe2\\x1b["},
  };
  for (const auto& row : rows) {
    CAPTURE(row.expected);
    CHECK(shown(row.text) == row.expected);
    CHECK(shown(shown(row.text)) == row.expected);
  }
}

TEST_CASE("a number is shown with a point and with all digits, in any locale, and read again") {
  const std::pair<double, std::string> rows[] = {
      {0, "0"},
      {-0.1, "-0.1"},
      {1.5, "1.5"},
      {1.0 / 3, "0.3333333333333333"},
      {0.1 + 0.2, "0.30000000000000004"},
      {1234.5, "1234.5"},
      {1e300, "1e+300"},
      {-std::numeric_limits<double>::min(), "-2.2250738585072014e-308"},
      {std::numeric_limits<double>::denorm_min(), "5e-324"},
  };
  // Locales with a comma, and with a point of two bytes, as far as the system has them.
  for (const char* const locale :
       {"C", "de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "nb_NO.UTF-8", "ps_AF.UTF-8"}) {
    if (!std::setlocale(LC_NUMERIC, locale)) continue;
    CAPTURE(locale);
    for (const auto& [number, expected] : rows) {
      CHECK(shown(number) == expected);
      CHECK(detail::number_of<double>(expected) == number);
    }
    CHECK(shown(std::numeric_limits<double>::infinity()) == "inf");
  }
  std::setlocale(LC_NUMERIC, "C");
}
