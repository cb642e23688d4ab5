#include <dlfcn.h>
#include <gmock/gmock.h>

#include <optional>

#include "source_support.h"
#include "support/shared_data.h"
#include "video_files.h"

extern "C" {
#include <libavcodec/avcodec.h>
}

namespace {

/// What FFmpeg's decoder answers from now on, as if it had broken.
std::optional<int> broken_answer;

}  // namespace

/// Stands before FFmpeg's own, which is linked as a shared library.
extern "C" int avcodec_receive_frame(AVCodecContext* context, AVFrame* frame) {
  using Function = int (*)(AVCodecContext*, AVFrame*);
  static const auto original = reinterpret_cast<Function>(::dlsym(RTLD_NEXT, "avcodec_receive_frame"));
  return broken_answer ? *broken_answer : original(context, frame);
}

namespace apriltrack::test {
namespace {

constexpr int kNumPictures = 12;
constexpr int kNumGood = 3;

/// How many unreadable frames come after three good ones, when the decoder then answers always the same.
int count_frames_after_break(int answer) {
  VideoPlan plan;
  for (int i = 0; i < kNumPictures; ++i) {
    plan.pictures.emplace_back(64, 48, static_cast<std::uint8_t>(15 * i));
    plan.times_ticks.push_back(3000 * i);
  }
  const auto path = temporary_folder() / "video.mov";
  write_mjpeg_video(path, plan);
  const auto source = open_source(path.string());
  for (int i = 0; i < kNumGood; ++i) EXPECT_TRUE(source->next().value().is_readable());
  broken_answer = answer;
  int count = 0;
  for (std::optional<SourceFrame> frame; count < 1000 && (frame = source->next()); ++count)
    EXPECT_FALSE(frame->is_readable());
  EXPECT_FALSE(source->next()) << "the end is for good";
  broken_answer.reset();
  return count;
}

TEST(BrokenDecoder, ThatFailsForEverEndsTheVideo) {
  const int count = count_frames_after_break(AVERROR(EIO));
  EXPECT_GE(count, 1);
  EXPECT_LE(count, 100);
}

TEST(BrokenDecoder, ThatAsksForMoreForEverEndsTheVideo) {
  EXPECT_LE(count_frames_after_break(AVERROR(EAGAIN)), kNumPictures);
}

}  // namespace
}  // namespace apriltrack::test
