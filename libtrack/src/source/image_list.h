#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/source/frame_source.h"
#include "image_values.h"
#include "sampled_source.h"

namespace apriltrack {

/// One image on disk and what is known of it before it is read.
struct ImageEntry {
  std::filesystem::path path;
  Timestamp timestamp;
  std::optional<double> exposure_s = std::nullopt;
  double gain = 1.0;
  std::string exposure_where = {};  ///< As SourceFrame's.
};

/// Reads images one by one, each only when it is asked for. Before the first one of 16 bits it looks at some
/// of the others, evenly spread, so that all are scaled alike.
class ImageListSource : public SkippableSource {
 public:
  /// Of the options: bits and log.
  ImageListSource(std::string name, std::vector<ImageEntry> entries, const SourceOptions& options = {})
      : name_(std::move(name)), entries_(std::move(entries)), bits_(options.bits), log_(options.log) {}

  std::optional<SourceFrame> next() override;
  bool pass_over() override;
  std::optional<std::size_t> num_frames() const override { return entries_.size(); }
  std::optional<ValueRange> value_range() const override { return range_; }
  std::string name() const override { return name_; }

 private:
  GrayImage read(const std::filesystem::path& path);
  ValueRange find_range() const;
  void tell_of_range(const ValueRange& range) const;
  void check_range(const ImageValues& values, const std::filesystem::path& path);

  std::string name_;
  std::vector<ImageEntry> entries_;
  std::optional<int> bits_;
  LogSink log_;
  std::optional<ValueRange> range_;  ///< Of 16-bit pictures, once one has come.
  bool has_warned_ = false;
  std::size_t position_ = 0;
};

}  // namespace apriltrack
