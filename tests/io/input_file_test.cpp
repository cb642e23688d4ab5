// What the door lets in: files, and pipes where the whole is read. What each other thing is comes from the
// system's own calls that make it.

#include "apriltrack/io/input_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <thread>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/csv.h"
#include "apriltrack/io/yaml_reader.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// What is no file, with the word for it.
struct OtherThing {
  fs::path path;
  std::string word;
};

class OtherThings : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::temporary_folder();
    fs::create_directories(folder_ / "folder");
    make_socket(folder_ / "socket");
    things_ = {{folder_ / "folder", "it is a folder"},
               {folder_ / "socket", "it is a socket"},
               {"/dev/zero", "it is a device"},
               {"/dev/null", "it is a device"}};
    fs::create_symlink("/dev/zero", folder_ / "zero.yaml");
    things_.push_back({folder_ / "zero.yaml", "it is a device"});
  }
  void TearDown() override { ::close(socket_); }

  void make_socket(const fs::path& path) {
    socket_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    // The folder's path is longer than a socket's name may be; a name relative to it is not.
    const fs::path before = fs::current_path();
    fs::current_path(path.parent_path());
    path.filename().string().copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    fs::current_path(before);
  }

  fs::path folder_;
  std::vector<OtherThing> things_;
  int socket_ = -1;
};

TEST_F(OtherThings, AreRefusedByWhatTheyAre) {
  for (const OtherThing& thing : things_) {
    const auto refused = AllOf(StartsWith(thing.path.string() + ": cannot be read: "), HasSubstr(thing.word));
    constexpr ErrorKind kIo = ErrorKind::kIo;
    EXPECT_THAT(test::message_of([&] { InputFile file(thing.path); }, kIo), refused);
    EXPECT_THAT(test::message_of([&] { read_file(thing.path); }, kIo), refused);
    EXPECT_THAT(test::message_of([&] { YamlNode::read_json_file(thing.path); }, kIo), refused);
    EXPECT_THAT(test::message_of([&] { CsvTable::read_file(thing.path, {"a"}); }, kIo), refused);
  }
}

TEST(InputFile, ReadsHereAndThere) {
  const auto path = test::temporary_folder() / "bytes";
  write_file_atomically(path, "0123456789");
  const InputFile file(path);
  EXPECT_EQ(file.size(), 10U);
  char bytes[8] = {};
  EXPECT_EQ(file.read(7, bytes, sizeof bytes), 3U);
  EXPECT_EQ(std::string(bytes, 3), "789");
  EXPECT_EQ(file.read(10, bytes, sizeof bytes), 0U);
  EXPECT_EQ(file.read(UINT64_MAX, bytes, sizeof bytes), 0U) << "no offset at all";
}

TEST(InputFile, OpensNoPipe) {
  const auto pipe = test::temporary_folder() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(test::message_of([&] { InputFile file(pipe); }, ErrorKind::kIo), HasSubstr("it is a pipe"));
}

// Never brought into memory: the file is one hole, of 3 TB.
TEST(ReadFile, RefusesWhatIsTooLargeBeforeItReads) {
  const auto path = test::temporary_folder() / "large.yaml";
  write_file_atomically(path, "");
  if (::truncate(path.c_str(), off_t{3} << 40) != 0) GTEST_SKIP() << "no file of 3 TB can be made here";
  EXPECT_THAT(test::message_of([&] { read_file(path); }),
              AllOf(HasSubstr("large.yaml: is too large"), HasSubstr("256 MB")));
}

TEST(ReadFile, TakesWhatIsJustNotTooLarge) {
  const auto path = test::temporary_folder() / "text";
  write_file_atomically(path, "12345");
  EXPECT_EQ(read_file(path, 5), "12345");
  EXPECT_THAT(test::message_of([&] { read_file(path, 4); }), HasSubstr("too large"));
}

TEST(ReadFile, ReadsFilesOfProcWhoseSizeIsNotTold) {
  EXPECT_THAT(read_file("/proc/self/status"), HasSubstr("Pid:"));
}

/// Writes `text` piece by piece and closes its end.
std::thread writer_of(int descriptor, std::string text) {
  return std::thread([descriptor, text = std::move(text)] {
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t done =
          ::write(descriptor, text.data() + at, std::min<std::size_t>(text.size() - at, 4096));
      if (done <= 0) break;
      at += static_cast<std::size_t>(done);
    }
    ::close(descriptor);
  });
}

TEST(ReadFile, ReadsAPipeToItsEnd) {
  std::string text;
  for (int i = 0; i < 30'000; ++i) text += std::to_string(i) + "\n";  // more than a pipe holds
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::thread writer = writer_of(ends[1], text);
  EXPECT_EQ(read_file("/dev/fd/" + std::to_string(ends[0])), text) << "as a shell's <(...) is";
  writer.join();
  ::close(ends[0]);
}

TEST(ReadFile, RefusesAPipeThroughWhichNothingCame) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[1]);
  EXPECT_THAT(test::message_of([&] { read_file("/dev/fd/" + std::to_string(ends[0])); }, ErrorKind::kIo),
              HasSubstr("nothing came through this pipe, or it was read before"));
  ::close(ends[0]);
}

TEST(ReadFile, ReadsANamedPipeWhoseWriterComesLater) {
  const auto path = test::temporary_folder() / "pipe.yaml";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&] { writer_of(::open(path.c_str(), O_WRONLY | O_CLOEXEC), "a: 1\n").join(); });
  EXPECT_EQ(YamlNode::read_file(path).at("a").as_int(), 1);
  writer.join();
}

TEST(ReadFile, StopsAtTheLargestSizeInAPipeToo) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::thread writer = writer_of(ends[1], std::string(1000, 'x'));
  EXPECT_THAT(test::message_of([&] { read_file("/dev/fd/" + std::to_string(ends[0]), 999); }),
              HasSubstr("too large"));
  writer.join();
  ::close(ends[0]);
}

}  // namespace
}  // namespace apriltrack
