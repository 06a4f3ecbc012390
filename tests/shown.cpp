#include <protostar/shown.hpp>

#include <string>

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
