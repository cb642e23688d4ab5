#include "stored_help.h"

#include <memory>

namespace apriltrack::app {

const CommandHelp* help_of(const CLI::App& command) {
  const auto formatter = std::dynamic_pointer_cast<StoredHelp>(command.get_formatter());
  return formatter == nullptr ? nullptr : &formatter->help();
}

}  // namespace apriltrack::app
