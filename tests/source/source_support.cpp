#include "source_support.h"

#include <fstream>
#include <sstream>

namespace apriltrack::test {
namespace fs = std::filesystem;

GrayImage test_picture(int width, int height, int seed) {
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      image(x, y) = static_cast<std::uint8_t>((x * 7 + y * 31 + x * y + seed * 53) % 256);
  }
  return image;
}

void write_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

void write_pgm(const fs::path& path, const GrayImage& image) {
  std::ostringstream bytes;
  bytes << "P5\n" << image.width() << ' ' << image.height() << "\n255\n";
  bytes.write(reinterpret_cast<const char*>(image.row(0)),
              static_cast<std::streamsize>(image.width()) * image.height());
  write_text(path, bytes.str());
}

void write_frames(const fs::path& folder, const std::vector<std::string>& names) {
  int seed = 0;
  for (const std::string& name : names) {
    fs::create_directories(folder);
    write_pgm(folder / name, test_picture(8, 6, seed++));
  }
}

std::string read_bytes(const fs::path& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

std::vector<SourceFrame> read_all(const std::string& input, const SourceOptions& options) {
  const auto source = open_source(input, options);
  std::vector<SourceFrame> frames;
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<std::int64_t> times_of(const std::vector<SourceFrame>& frames) {
  std::vector<std::int64_t> times;
  for (const SourceFrame& frame : frames) times.push_back(frame.timestamp.ns);
  return times;
}

void expect_error(ErrorKind kind, const std::vector<std::string>& words,
                  const std::function<void()>& action) {
  try {
    action();
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.kind()), static_cast<int>(kind)) << error.what();
    for (const std::string& word : words) EXPECT_THAT(error.what(), ::testing::HasSubstr(word));
  }
}

void expect_refused(const fs::path& input, ErrorKind kind, const std::vector<std::string>& words,
                    const SourceOptions& options) {
  expect_error(kind, words, [&] { open_source(input.string(), options); });
}

}  // namespace apriltrack::test
