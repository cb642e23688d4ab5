#pragma once

#include <memory>

#include "apriltrack/source/frame_source.h"

namespace apriltrack {

/// A source that can leave a frame out without the cost of decoding it.
class SkippableSource : public FrameSource {
 public:
  /// False at the end.
  virtual bool pass_over() = 0;
  /// Whether every frame brings its own exposure.
  virtual bool tells_all_exposures() const { return false; }
};

/// `skip`, `step`, `max_frames` and `stamp_is` over any source.
class SampledSource : public FrameSource {
 public:
  /// Throws Error(kInvalidInput) where times are to be moved by an exposure that nothing tells.
  SampledSource(std::unique_ptr<SkippableSource> source, const SourceOptions& options);

  std::optional<SourceFrame> next() override;
  std::optional<std::size_t> num_frames() const override;
  std::optional<ValueRange> value_range() const override { return source_->value_range(); }
  std::string name() const override { return source_->name(); }

 private:
  std::unique_ptr<SkippableSource> source_;
  SourceOptions options_;
  std::size_t num_taken_ = 0;
};

}  // namespace apriltrack
