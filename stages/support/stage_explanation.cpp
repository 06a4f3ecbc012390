#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <protostar/encode.hpp>
#include <protostar/output_file.hpp>
#include <stdexcept>
#include <string>

#include "explanation.hpp"
#include "option_values.hpp"
#include "stage.hpp"

using namespace protostar;

namespace {

/// Replaces a file by one with this text.
void save_text(const std::filesystem::path& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace

void Stage::begin_explanation() {
  explanation_ = std::make_shared<Explanation>();
  explanation_->pixel = *options_.pixel;
  explanation_->width = options_.width;
  explanation_->height = options_.height;
}

void Stage::tell(const Image& image) {
  if (!explanation_) return;
  Explanation& explanation = *explanation_;
  const auto [x, y] = explanation.pixel;
  explanation.light = image(x, y);
  explanation.toned = explanation.light;
  if (!explanation.is_traced) explanation.mean = explanation.light;
  if (!options_.is_linear()) {
    Image toned(1, 1);
    if (options_.tone == Tone::scale_image) {
      toned = image;
      for (int row = 0; row < image.height(); ++row)
        for (int column = 0; column < image.width(); ++column) {
          const Color light = clamped(image(column, row));
          explanation.largest = std::max({explanation.largest, light.r, light.g, light.b});
        }
    } else {
      toned(0, 0) = explanation.light;
    }
    apply(options_.tone, toned);
    explanation.toned = options_.tone == Tone::scale_image ? toned(x, y) : toned(0, 0);
    explanation.codes = Encoder(options_.transfer, options_.bits == 16 ? 65535 : 255)(explanation.toned);
  }
  if (!options_.quiet) {
    const std::string text = text_of(explanation, options_);
    std::fwrite(text.data(), 1, text.size(), stdout);
  }
  if (!options_.explain.empty()) save_text(options_.explain, json_of(explanation, options_));
  if (!options_.rays.empty()) {
    if (!explanation.is_traced) throw std::logic_error("a stage draws without rays, and has not declared so");
    save_text(options_.rays, rays_of(explanation, ends_in(options_.rays, ".svg")));
  }
  explanation_.reset();
}
