#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "apriltrack/base/version.h"

namespace apriltrack {

/// Why the world is not as asked. The values are the exit statuses of the command line
/// (docs/file_formats.md).
enum class ErrorKind {
  kNoResult = 1,      ///< It ran, and no usable result came: no tags seen, nothing connected, not converged.
  kInvalidInput = 2,  ///< The command line, an option, or the CONTENT of a file is wrong.
  kIo = 3,            ///< A file cannot be opened, read or written.
};

/// The one exception for set-up and file errors; never thrown from a per-frame path.
///
/// `what()` reads `<where>: <what is wrong, the value, the range allowed, the way out>`, for example
/// `maps/lab.yaml:14: tag 7: size must be > 0 (is -0.16)`.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string_view where, std::string_view what);

  ErrorKind kind() const { return kind_; }
  /// The two parts of what(); views that live as long as this.
  std::string_view where() const { return std::string_view(what()).substr(0, where_size_); }
  std::string_view cause() const;

 private:
  ErrorKind kind_;
  std::size_t where_size_;
};

/// where: file, `file:line`, option or frame that the message is about; empty when there is none.
Error no_result(std::string_view where, std::string_view what);
Error invalid_input(std::string_view where, std::string_view what);
Error io_error(std::string_view where, std::string_view what);

}  // namespace apriltrack
