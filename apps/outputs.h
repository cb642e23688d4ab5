#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace apriltrack::app {

/// What can be wrong with a file to write, said before the work and not after it. option: "--output".
/// inputs: files and folders that this run reads; empty names are passed over. Throws Error(kInvalidInput)
/// when the name is empty, or that of an input, of a recording's own file or of a picture; Error(kIo) when it
/// is a folder's, its folder is missing, or the file may not be written.
void check_output(const std::string& output, std::string_view option, const std::vector<std::string>& inputs);

}  // namespace apriltrack::app
