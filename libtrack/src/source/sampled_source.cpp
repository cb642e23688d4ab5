#include "sampled_source.h"

#include <algorithm>

namespace apriltrack {

std::optional<SourceFrame> SampledSource::next() {
  if (options_.max_frames && num_taken_ >= *options_.max_frames) return std::nullopt;
  const std::size_t left_out = num_taken_ == 0 ? options_.skip : options_.step - 1;
  for (std::size_t i = 0; i < left_out; ++i) {
    if (!source_->pass_over()) return std::nullopt;
  }
  ++num_taken_;
  return source_->next();
}

std::optional<std::size_t> SampledSource::num_frames() const {
  const auto all = source_->num_frames();
  if (!all) return std::nullopt;
  const std::size_t rest = *all - std::min(*all, options_.skip);
  const std::size_t sampled = (rest + options_.step - 1) / options_.step;
  return std::min(sampled, options_.max_frames.value_or(sampled));
}

}  // namespace apriltrack
