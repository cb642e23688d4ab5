#pragma once

#include "chunk_layout.h"
#include "mcap_records.h"
#include "random_access_file.h"

namespace apriltrack {

/// The layout of an MCAP file from its beginning on, record by record, as far as it goes.
/// channels: those of its records are added.
FileLayout scan_mcap(const RandomAccessFile& file, McapChannels& channels, Damage& damage);

}  // namespace apriltrack
