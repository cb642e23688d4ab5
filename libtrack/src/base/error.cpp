#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

constexpr std::string_view kBetween = ": ";

std::string message(std::string_view where, std::string_view what) {
  if (where.empty()) return std::string(what);
  return std::string(where) + std::string(kBetween) + std::string(what);
}

}  // namespace

Error::Error(ErrorKind kind, std::string_view where, std::string_view what)
    : std::runtime_error(message(where, what)), kind_(kind), where_size_(where.size()) {}

std::string_view Error::cause() const {
  const std::string_view whole = what();
  return where_size_ == 0 ? whole : whole.substr(where_size_ + kBetween.size());
}

Error no_result(std::string_view where, std::string_view what) {
  return {ErrorKind::kNoResult, where, what};
}

Error invalid_input(std::string_view where, std::string_view what) {
  return {ErrorKind::kInvalidInput, where, what};
}

Error io_error(std::string_view where, std::string_view what) {
  return {ErrorKind::kIo, where, what};
}

}  // namespace apriltrack
