#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace apriltrack {

/// Whole pixels: columns x to x + width - 1, rows y to y + height - 1.
struct ImageRegion {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// A non-owning view of a single-channel image, row by row. Pixel (0, 0) is the CENTRE of the top-left pixel,
/// so pixel (x, y) covers [x - 0.5, x + 0.5] x [y - 0.5, y + 0.5] (docs/conventions.md).
template <class T>
class ImageView {
 public:
  ImageView() = default;
  /// stride: elements from one row to the next, at least `width`: bottom-up images are to be copied.
  ImageView(T* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), width_(width), height_(height), stride_(stride) {}

  /// A view of mutable pixels serves as a view of constant ones.
  template <class U>
  requires(std::is_same_v<const U, T>) ImageView(const ImageView<U>& other)
      : ImageView(other.data(), other.width(), other.height(), other.stride()) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }
  T* data() const { return data_; }
  bool is_empty() const { return width_ <= 0 || height_ <= 0; }

  T* row(int y) const { return data_ + y * stride_; }
  T& operator()(int x, int y) const { return row(y)[x]; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  /// The same pixels, those of `region` alone, which must lie inside.
  ImageView part(const ImageRegion& region) const {
    return {row(region.y) + region.x, region.width, region.height, stride_};
  }

 private:
  T* data_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

/// An owning single-channel image without padding between rows.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T value = T())
      : pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value),
        width_(width),
        height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool is_empty() const { return pixels_.empty(); }

  ImageView<T> view() { return {pixels_.data(), width_, height_, width_}; }
  ImageView<const T> view() const { return {pixels_.data(), width_, height_, width_}; }
  T* row(int y) { return view().row(y); }
  const T* row(int y) const { return view().row(y); }
  T& operator()(int x, int y) { return view()(x, y); }
  const T& operator()(int x, int y) const { return view()(x, y); }

 private:
  std::vector<T> pixels_;
  int width_ = 0;
  int height_ = 0;
};

using GrayImage = Image<std::uint8_t>;
using GrayView = ImageView<const std::uint8_t>;

}  // namespace apriltrack
