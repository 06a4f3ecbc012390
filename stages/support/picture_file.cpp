#include "picture_file.hpp"

#include <protostar/io/hdr.hpp>
#include <protostar/io/png.hpp>
#include <protostar/output_file.hpp>
#include <protostar/pfm.hpp>
#include <protostar/ppm.hpp>
#include <stdexcept>
#include <system_error>

#include "option_values.hpp"

using namespace protostar;

const std::string_view format_endings = ".ppm, .png, or .pfm and .hdr for the linear light";

bool is_no_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  return std::filesystem::exists(status) &&
         (!std::filesystem::is_regular_file(status) || OutputFile::descriptor_of(path) >= 0);
}

Options::Format format_of(const std::filesystem::path& path, const std::string& option) {
  if (is_no_regular_file(path)) return Options::Format::ppm;
  if (ends_in(path, ".ppm")) return Options::Format::ppm;
  if (ends_in(path, ".png")) return Options::Format::png;
  if (ends_in(path, ".pfm")) return Options::Format::pfm;
  if (ends_in(path, ".hdr")) return Options::Format::hdr;
  refuse(option, path.string(),
         "a file that ends in .ppm, .png, .pfm or .hdr, or a device or pipe that exists");
}

bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  namespace fs = std::filesystem;
  const auto place = [](const fs::path& path) {
    std::error_code error;
    // weakly_canonical leaves a relative path as it is if nothing of it exists, and a link to nothing.
    fs::path found = fs::absolute(path, error);
    if (!error) found = fs::weakly_canonical(found, error);
    std::error_code is_nothing;
    for (int links = 0; links < 40 && !error && fs::is_symlink(found, is_nothing); ++links)
      found = fs::weakly_canonical(found.parent_path() / fs::read_symlink(found, error), error);
    return error ? path : found;  // an error is a link to itself, for example, which no file is written to
  };
  return place(a) == place(b);
}

void check_size(Options::Format format, int width, int height) {
  if (format == Options::Format::png) check_png_size(width, height);
}

void write_picture(const Image& image, const Options& options, const StopToken& stop) {
  switch (options.format) {
    case Options::Format::ppm:
      return save_ppm(image, options.output, options.transfer,
                      {.bits = options.bits, .plain = options.plain, .stop = stop});
    case Options::Format::png:
      return save_png(image, options.output, options.transfer, stop);
    case Options::Format::pfm:
      return save_pfm(image, options.output, stop);
    case Options::Format::hdr:
      return save_hdr(image, options.output, stop);
    case Options::Format::shard:
      throw std::logic_error("a picture is not written as a shard");
  }
}
