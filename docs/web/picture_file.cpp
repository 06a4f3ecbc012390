// Formats of the files of pictures in modules: those that a page reads. A canvas gives a PNG of its pixels.
#include "stages/support/picture_file.hpp"

#include <protostar/pfm.hpp>
#include <protostar/ppm.hpp>

#include "stages/support/option_values.hpp"

const std::string_view format_endings = ".ppm, or .pfm for the linear light";

Options::Format format_of(const std::filesystem::path& path, const std::string& option) {
  if (ends_in(path, ".ppm")) return Options::Format::ppm;
  if (ends_in(path, ".pfm")) return Options::Format::pfm;
  refuse(option, path.string(), "a file that ends in .ppm or .pfm");
}

// The files of a module are in memory, in one folder.
bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) { return a == b; }

void check_size(Options::Format, int, int) {}

void write_picture(const protostar::Image& image, const Options& options, const protostar::StopToken& stop) {
  if (options.format == Options::Format::pfm) return save_pfm(image, options.output, stop);
  save_ppm(image, options.output, options.transfer,
           {.bits = options.bits, .plain = options.plain, .stop = stop});
}
