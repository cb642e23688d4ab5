// What stands where a file should: devices, pipes, sockets and folders.

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "one_image.h"
#include "program.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using HostileInput = OneImage;

TEST_F(HostileInput, ThatIsADeviceWithoutEndIsRefusedAtOnceWhereverItStands) {
  const std::string zero = "/dev/zero", said = "error: /dev/zero: cannot be read: it is a device, not a file";
  fs::create_symlink(zero, folder_ / "zero.png");
  fs::create_symlink(zero, folder_ / "zero.mcap");
  const std::vector<ProgramRun> runs = {
      track({"--map", zero}),
      track({"--camera", zero}),
      calibrate({"--tag-sizes", zero}),
      calibrate({"--config", zero}),
      calibrate({"--constraints", zero}),
      run_program({"calibrate", "--detections", zero, "--camera", path("camera.yaml"), "--tag-size", "0.1",
                   "--output", path("m.yaml")}),
      run_program({"detect", zero, "--output", path("d.csv")}),
      run_program({"map", "show", zero}),
      run_program({"map", "convert", zero, path("o.fmap")}),
      run_program({"camera", "show", zero}),
      run_program({"evaluate", "--truth", zero, "--estimate", zero}),
      run_program({"doctor", zero})};
  for (const ProgramRun& run : runs) EXPECT_THAT(run, EndsWith(3, said));
  for (const char* name : {"zero.png", "zero.mcap"})
    EXPECT_THAT(run_program({"detect", path(name), "--output", path("d.csv")}),
                EndsWith(3, "it is a device, not a file"));
}

TEST_F(HostileInput, ThatIsADeviceAmongPicturesIsAFrameThatCannotBeRead) {
  fs::create_symlink("/dev/zero", folder_ / "frames" / "2000000000.png");
  const ProgramRun run = detect();
  EXPECT_THAT(run, EndsWith(1, "1 of 2 frames are left out"));
  EXPECT_NE(run.err.find("2000000000.png: cannot be read: it is a device"), std::string::npos) << run.err;
}

/// The program with so much memory, in kilobytes; its words in err_file.
int status_with_memory(long most_kb, const std::string& words, const std::string& err_file) {
  const std::string command =
      fmt::format("ulimit -v {}; '{}' {} >/dev/null 2>'{}'", most_kb, APRILTRACK_PROGRAM, words, err_file);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// 20 MB each, of values of one digit: what a text costs most for.
TEST_F(HostileInput, ThatIsMadeOfSmallValuesTakesLittleMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more memory than the test allows";
#endif
  std::string ones = "1";
  for (int i = 0; i < 10'000'000; ++i) ones += ",1";
  write_text(path("big.json"), "{\"tags\": [" + ones + "]}");
  EXPECT_EQ(status_with_memory(1'500'000, "map show '" + path("big.json") + "'", path("err")), 2);
  EXPECT_NE(read_text(path("err")).find("has more than 2000000 values"), std::string::npos)
      << read_text(path("err"));

  std::string table = "timestamp_ns,exposure_s,gain,a,b\n";
  for (int i = 1; i <= 1'500'000; ++i) table += std::to_string(i) + ",,1,1,1\n";
  write_text(path("frames.csv"), table);
  EXPECT_EQ(status_with_memory(1'500'000, "track '" + folder_.string() + "' --output '" + path("o.tum") + "'",
                               path("err")),
            2);
  EXPECT_NE(read_text(path("err")).find("none of its rows has the time of a frame"), std::string::npos)
      << read_text(path("err"));
}

TEST_F(HostileInput, ThatIsAPipeWithoutAWriterHoldsNobodyUpWhoReadsTwice) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(run_program({"doctor", path("pipe")}), EndsWith(2, "is a pipe, which can be read once"));
}

TEST_F(HostileInput, ThatIsAMapThroughAPipeIsRead) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::thread writer([&] {
    const int end = ::open(path("pipe").c_str(), O_WRONLY | O_CLOEXEC);
    const std::string map = read_text(path("map.yaml"));
    EXPECT_EQ(::write(end, map.data(), map.size()), static_cast<ssize_t>(map.size()));
    ::close(end);
  });
  const ProgramRun run = run_program({"map", "show", path("pipe")});
  writer.join();
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, run_program({"map", "show", path("map.yaml")}).out);
}

/// A hole of 3 TB, as a mistaken `dd` makes it.
TEST_F(HostileInput, ThatIsLargerThanAnyMapIsNotBroughtIntoMemory) {
  write_text(path("large.yaml"), "");
  if (::truncate(path("large.yaml").c_str(), off_t{3} << 40) != 0)
    GTEST_SKIP() << "no file of 3 TB can be made here";
  EXPECT_THAT(track({"--map", path("large.yaml")}), EndsWith(2, "large.yaml: is too large"));
  EXPECT_THAT(track({"--camera", path("large.yaml")}), EndsWith(2, "large.yaml: is too large"));
}

}  // namespace
}  // namespace apriltrack::test
