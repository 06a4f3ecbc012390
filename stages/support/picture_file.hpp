// Formats of the files of pictures.
#pragma once

#include <filesystem>
#include <protostar/image.hpp>
#include <protostar/stop_token.hpp>
#include <string>
#include <string_view>

#include "options.hpp"

/// Endings of the formats, for a help text.
extern const std::string_view format_endings;

/// Returns true if there is a device, a pipe, a folder or the like of that name, or if the name is that of a
/// descriptor of this process, such as /dev/fd/1, even if a regular file is open there.
bool is_no_regular_file(const std::filesystem::path& path);

/// Returns the format for a file's extension. A device, a pipe or a descriptor of this process by its name,
/// such as /dev/fd/1, has none and takes a PPM, even if a regular file is open there; a folder is left to the
/// writer, whose error says what it is. The option is named in the error.
Options::Format format_of(const std::filesystem::path& path, const std::string& option);

/// Returns true if two paths lead to the same place, whether there is a file or not: ./a.ppm and a.ppm do,
/// and a link and the name that it holds.
/// Two hard links to a file do not, since each is replaced and removed by itself.
bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b);

/// Throws std::length_error for a size that the format cannot have.
void check_size(Options::Format format, int width, int height);

/// Writes a picture into the file that the options name, in their format.
void write_picture(const protostar::Image& image, const Options& options, const protostar::StopToken& stop);
