#pragma once

#include <optional>

#include "chunk_layout.h"
#include "mcap_records.h"
#include "random_access_file.h"

namespace apriltrack {

struct McapSummary {
  std::optional<FileLayout> layout;  ///< None where the summary is missing, damaged, or does not tell all.
  bool is_closed = false;            ///< The file ends as its writer meant it to.
};

/// By the summary at the end of an MCAP file. Throws Error(kInvalidInput) where it tells of chunks that are
/// packed in a way that is not read. channels: those that it tells of are added.
McapSummary read_mcap_summary(const RandomAccessFile& file, McapChannels& channels, Damage& damage);

}  // namespace apriltrack
