#pragma once

#include <memory>

#include "apriltrack/bag/bag_reader.h"
#include "chunk_layout.h"
#include "random_access_file.h"

namespace apriltrack {

/// Reads a file whose messages lie in chunks. Throws Error(kIo) where not one message or topic can be found.
std::unique_ptr<BagReader> chunked_reader(std::shared_ptr<const RandomAccessFile> file,
                                          std::unique_ptr<ChunkedFormat> format);

}  // namespace apriltrack
