#include "mp4_file.h"

extern "C" {
#include <libavcodec/packet.h>
#include <libavformat/avformat.h>
}

#include <fmt/format.h>

#include <array>
#include <utility>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

// Bytes of the index: fixed parts, and each frame's length, time, place and whether it is a key frame (at
// most 40, ISO/IEC 14496-12, section 8.6 and 8.7).
constexpr std::int64_t kIndexBytes = 8192;
constexpr std::int64_t kIndexBytesPerFrame = 48;

struct InputCloser {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
using Mp4Input = std::unique_ptr<AVFormatContext, InputCloser>;

struct PacketFreer {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

/// The protocol is named, lest a colon in a file name be taken for one.
std::string url_of(const std::filesystem::path& file) {
  return "file:" + file.string();
}

Mp4Input open_input(const std::filesystem::path& file, const std::string& name) {
  AVFormatContext* context = nullptr;
  check_written(avformat_open_input(&context, url_of(file).c_str(), nullptr, nullptr), name);
  return Mp4Input(context);
}

void copy_packets(AVFormatContext& input, AVFormatContext& output, const std::string& name) {
  const std::unique_ptr<AVPacket, PacketFreer> packet(av_packet_alloc());
  for (;;) {
    const int got = av_read_frame(&input, packet.get());
    if (got == AVERROR_EOF) return;
    check_written(got, name);
    av_packet_rescale_ts(packet.get(), input.streams[0]->time_base, output.streams[0]->time_base);
    packet->pos = -1;
    check_written(av_interleaved_write_frame(&output, packet.get()), name);
  }
}

}  // namespace

void check_written(int code, const std::string& name) {
  if (code >= 0) return;
  std::array<char, AV_ERROR_MAX_STRING_SIZE> reason{};
  av_strerror(code, reason.data(), reason.size());
  throw io_error(name, fmt::format("cannot be written: {}", reason.data()));
}

void OutputCloser::operator()(AVFormatContext* context) const {
  if (context->pb) avio_closep(&context->pb);
  avformat_free_context(context);
}

OutputFile open_output(const std::filesystem::path& file, const std::string& name) {
  AVFormatContext* context = nullptr;
  check_written(avformat_alloc_output_context2(&context, nullptr, "mp4", url_of(file).c_str()), name);
  OutputFile output(context);
  check_written(avio_open(&output->pb, url_of(file).c_str(), AVIO_FLAG_WRITE), name);
  return output;
}

void finish_output(OutputFile output, const std::string& name) {
  check_written(av_write_trailer(output.get()), name);
  check_written(avio_closep(&output->pb), name);
}

void move_index_to_front(const std::filesystem::path& from, const std::filesystem::path& to,
                         const std::string& name, std::int64_t num_frames) {
  const Mp4Input input = open_input(from, name);
  OutputFile output = open_output(to, name);
  AVStream* stream = avformat_new_stream(output.get(), nullptr);
  check_written(avcodec_parameters_copy(stream->codecpar, input->streams[0]->codecpar), name);
  stream->time_base = input->streams[0]->time_base;
  AVDictionary* options = nullptr;
  av_dict_set_int(&options, "moov_size", kIndexBytes + kIndexBytesPerFrame * num_frames, 0);
  const int begun = avformat_write_header(output.get(), &options);
  av_dict_free(&options);
  check_written(begun, name);
  copy_packets(*input, *output, name);
  finish_output(std::move(output), name);
}

}  // namespace apriltrack
