#include "option_values.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <protostar/io/text.hpp>
#include <stdexcept>
#include <vector>

#include "message.hpp"

using protostar::Gamma, protostar::Linear, protostar::Srgb, protostar::Transfer;
using protostar::detail::number_of;

std::string found_text(std::string_view text) { return "'" + shortened(std::string(text), 200) + "'"; }

void print_usage_error(const std::string& program, const UsageError& error) {
  std::fputs((error_line(program, error.what()) + "Run with --help for what is allowed.\n").c_str(), stderr);
}

void refuse(const std::string& option, std::string_view found, const std::string& allowed) {
  throw UsageError(option, found_text(found) + " is not " + allowed);
}

Transfer read_transfer(std::string_view text) {
  if (text == "srgb") return Srgb{};
  if (text == "linear") return Linear{};
  if (text.starts_with("gamma="))
    if (const auto exponent = number_of<double>(text.substr(6));
        exponent && *exponent > 0 && std::isfinite(*exponent))
      return Gamma{*exponent};
  refuse("--transfer", text, "srgb, linear or gamma=G with a number G greater than 0");
}

std::string name_of(const Transfer& transfer) {
  if (std::holds_alternative<Srgb>(transfer)) return "srgb";
  if (std::holds_alternative<Linear>(transfer)) return "linear";
  return "gamma=" + in_digits(std::get<Gamma>(transfer).exponent, 6);
}

int read_whole(const std::string& option, std::string_view text, bool (*is_allowed)(int),
               const std::string& allowed) {
  const auto value = number_of<int>(text);
  if (!value || !is_allowed(*value)) refuse(option, text, allowed);
  return *value;
}

bool ends_in(const std::filesystem::path& path, std::string_view ending) {
  std::string name = path.string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.ends_with(ending);
}

static std::string ending_of(Options::Format format) {
  switch (format) {
    case Options::Format::ppm:
      return ".ppm";
    case Options::Format::png:
      return ".png";
    case Options::Format::pfm:
      return ".pfm";
    case Options::Format::hdr:
      return ".hdr";
    case Options::Format::shard:
      return ".shard";
  }
  throw std::logic_error("a format without an ending");
}

void FileOptions::add_to(CommandLine& line, const std::string& default_transfer,
                         const std::string& default_plain) {
  line.add_option("--bits", bits, "8|16", "Bits per channel of a .ppm: 8 or 16 [8]");
  line.add_option(
      "--transfer", transfer, "srgb|linear|gamma=G",
      "How light becomes numbers: the sRGB curve, as it is, or its G-th root [" + default_transfer + "]");
  line.add_flag("--plain", plain, "Write the .ppm as decimal numbers (P3)" + default_plain);
}

std::optional<Transfer> FileOptions::read(const CommandLine& line, Options& options) const {
  std::optional<Transfer> own_transfer;
  if (line.given("--bits"))
    options.bits = read_whole(
        "--bits", bits, [](int n) { return n == 8 || n == 16; }, "8 or 16");
  if (line.given("--transfer")) own_transfer = read_transfer(transfer);
  if (plain) options.plain = true;
  const std::string ending = ending_of(options.format);
  if (options.format == Options::Format::shard) {
    for (const char* option : {"--bits", "--transfer", "--plain"})
      if (line.given(option))
        throw UsageError(option, "is for a picture, and a .shard file is none yet; give the option to merge");
  } else if (options.format != Options::Format::ppm) {
    if (plain) refuse("--plain", ending, "a format with a plain form; .ppm is");
    if (options.bits != 8) refuse("--bits", bits, "possible in " + ending + "; .ppm can have 16 bits");
  }
  if (options.is_linear() && own_transfer && !std::holds_alternative<Linear>(*own_transfer))
    refuse("--transfer", transfer, "possible in " + ending + ", which holds linear light");
  return own_transfer;
}
