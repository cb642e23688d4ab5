#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/kept_files.h"

namespace apriltrack::app {

/// What can be wrong with a file to write, said before the work and not after it. option: "--output".
/// inputs: files and folders that this run reads; empty names are passed over. Throws Error(kInvalidInput)
/// when the name is empty, or that of an input or of a part of one, or what kept_files.h says is wrong with
/// it; Error(kIo) when it is a folder's, its folder is missing, or folder or file may not be written.
void check_output(const std::string& output, std::string_view option, const std::vector<std::string>& inputs,
                  OutputKind kind = OutputKind::kText);

/// One file that a run writes; an empty name: it was not asked for.
struct OutputFile {
  std::string name;
  std::string_view option;
  OutputKind kind = OutputKind::kText;
};

/// check_output() for each that is asked for; no two may be one file, unless that is a device.
void check_outputs(const std::vector<OutputFile>& outputs, const std::vector<std::string>& inputs);

/// The name of the file beside `output` that has the times of KITTI's poses. Throws Error(kInvalidInput)
/// where output is a device or a pipe, which nothing can stand beside.
std::string kitti_times_of(const std::string& output, std::string_view option);

/// check_output() for a folder that is made where it is missing: throws Error(kIo) when it cannot be, or
/// nothing in it.
void check_output_folder(const std::string& output);

}  // namespace apriltrack::app
