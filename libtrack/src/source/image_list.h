#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/source/frame_source.h"
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

/// Reads images one by one, each only when it is asked for.
class ImageListSource : public SkippableSource {
 public:
  ImageListSource(std::string name, std::vector<ImageEntry> entries)
      : name_(std::move(name)), entries_(std::move(entries)) {}

  std::optional<SourceFrame> next() override;
  bool pass_over() override;
  std::optional<std::size_t> num_frames() const override { return entries_.size(); }
  std::string name() const override { return name_; }

 private:
  std::string name_;
  std::vector<ImageEntry> entries_;
  std::size_t position_ = 0;
};

}  // namespace apriltrack
