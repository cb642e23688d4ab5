#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/source/frame_source.h"
#include "picture_scaling.h"
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
      : name_(name), entries_(std::move(entries)), scaling_(std::move(name), options) {}

  std::optional<SourceFrame> next() override;
  bool pass_over() override;
  std::optional<std::size_t> num_frames() const override { return entries_.size(); }
  std::optional<ValueRange> value_range() const override { return scaling_.range(); }
  std::string name() const override { return name_; }
  bool tells_all_exposures() const override;

 private:
  GrayImage read(const std::filesystem::path& path);
  ValueCounts count_sample() const;

  std::string name_;
  std::vector<ImageEntry> entries_;
  PictureScaling scaling_;
  std::size_t position_ = 0;
};

}  // namespace apriltrack
