#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

struct AVFormatContext;

namespace apriltrack {

// Files by FFmpeg's MP4 writer. name: of the file in messages.

/// Throws Error(kIo) that says why the file cannot be written, for FFmpeg's error codes, which are negative.
void check_written(int code, const std::string& name);

struct OutputCloser {
  void operator()(AVFormatContext* context) const;
};
using OutputFile = std::unique_ptr<AVFormatContext, OutputCloser>;

/// Open, and without streams yet. Throws Error(kIo).
OutputFile open_output(const std::filesystem::path& file, const std::string& name);

/// Writes what is left, the index above all, and closes. Throws Error(kIo).
void finish_output(OutputFile output, const std::string& name);

/// Writes the MP4 file `from` as `to` with its index before the pictures, so that a browser starts to play
/// before it has the whole. (FFmpeg's own option for that tells of it on the terminal.) Throws Error(kIo).
void move_index_to_front(const std::filesystem::path& from, const std::filesystem::path& to,
                         const std::string& name, std::int64_t num_frames);

}  // namespace apriltrack
