// An image that several textures show.
#pragma once

#include <concepts>
#include <memory>
#include <stdexcept>
#include <utility>

#include "image.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Image that its copies share. There always is one.
class SharedImage {
 public:
  /// Takes a shared pointer to an image. Throws std::invalid_argument if it is null.
  template <std::convertible_to<std::shared_ptr<const Image>> P>
  SharedImage(P image) : image_(std::move(image)) {
    if (!image_) throw std::invalid_argument("SharedImage: the pointer to an image must not be null");
  }

  // Copied, never moved: a pointer that was moved from is null.
  SharedImage(const SharedImage&) = default;
  SharedImage& operator=(const SharedImage&) = default;
  ~SharedImage() = default;

  [[nodiscard]] const Image& operator*() const { return *image_; }
  [[nodiscard]] const Image* operator->() const { return image_.get(); }

 private:
  std::shared_ptr<const Image> image_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
