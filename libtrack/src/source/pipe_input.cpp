#include "pipe_input.h"

#include <filesystem>
#include <system_error>

namespace apriltrack {

bool is_pipe_input(const std::string& input) {
  std::error_code ignored;
  return input == kStandardInput || std::filesystem::is_fifo(input, ignored);
}

}  // namespace apriltrack
