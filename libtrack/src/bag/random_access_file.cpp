#include "random_access_file.h"

#include <algorithm>

namespace apriltrack {

void RandomAccessFile::read(std::uint64_t offset, std::uint64_t count, ByteBuffer& into) const {
  into.set_size(0);
  if (offset >= size()) return;
  const auto wanted = static_cast<std::size_t>(std::min(count, size() - offset));
  into.reserve(wanted);
  into.set_size(file_.read(offset, into.data(), wanted));
}

std::string RandomAccessFile::read(std::uint64_t offset, std::uint64_t count) const {
  ByteBuffer buffer;
  read(offset, count, buffer);
  return std::string(buffer.view());
}

}  // namespace apriltrack
