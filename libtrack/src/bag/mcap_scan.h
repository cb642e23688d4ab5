#pragma once

#include "chunk_layout.h"
#include "random_access_file.h"

namespace apriltrack {

/// The layout of an MCAP file from its beginning on, record by record, as far as it goes.
FileLayout scan_mcap(const RandomAccessFile& file, Damage& damage);

}  // namespace apriltrack
