#include "experiments/run/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/base/input/read_file.hpp"
#include "core/base/record/phase_times.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view format_line = "barrierbench.checkpoint/3";
constexpr std::string_view config_word = "config ";
constexpr InputKind checkpoint_file{"a checkpoint", std::uint64_t{64} << 30};
constexpr double sync_every_s = 1;

/// Takes a line off `text`; empty without one.
std::string_view take_line(std::string_view& text, std::size_t longest = 200) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos || end > longest) return {};
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

std::string prefix_line(const char* of, const FilePrefix& prefix) {
  return fmt::format("{} {} bytes {}", of, prefix.bytes, prefix.sha256);
}

/// What prefix_line wrote; the hash of a line that it did not write fits nothing.
FilePrefix prefix_of(std::string_view line) {
  FilePrefix out;
  const std::size_t begin = line.find(' ') + 1, end = line.find(' ', begin);
  if (end == std::string_view::npos) return {1, ""};
  std::from_chars(line.data() + begin, line.data() + end, out.bytes);
  out.sha256 = line.substr(line.rfind(' ') + 1);
  return out;
}

/// The trace that belongs to a checkpoint in `folder`, as `line` has it. Errors: ConfigError: it is another one, or not there.
FilePrefix trace_of(const fs::path& folder, std::string_view line) {
  FilePrefix trace = prefix_of(line);
  if (trace.bytes == 0 || find_trace(folder, trace)) return trace;
  const fs::path part = folder / "trace.jsonl.part";
  std::error_code unreachable;
  const auto size = fs::file_size(part, unreachable);
  throw ConfigError(part.string(),
                    unreachable          ? "not there"
                    : size < trace.bytes ? "shorter than the checkpoint beside it states"
                                         : "not as the checkpoint beside it has it",
                    fmt::format("{}, or no --resume", line));
}

FilePrefix prefix_of_bytes(std::string_view bytes) { return {bytes.size(), sha256_hex(bytes)}; }

void write_all(int fd, const fs::path& path, std::string_view text, std::uint64_t at) {
  while (!text.empty()) {
    const ::ssize_t n = ::pwrite(fd, text.data(), text.size(), static_cast<::off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_with(path, "cannot write", errno);
    text.remove_prefix(static_cast<std::size_t>(n));
    at += static_cast<std::uint64_t>(n);
  }
}

int open_to_write(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) fail_with(path, "cannot open", errno);
  return fd;
}

}  // namespace

/// A checkpoint in memory, and the log that belongs to it.
struct Checkpoint::Read {
  std::string archive, log;
  RunningHash log_hash;
  FilePrefix trace;
  std::uint64_t number = 0;
};

Checkpoint::Checkpoint(const fs::path& folder, std::string program, const std::string& config)
    : folder_(folder),
      file_(folder / "checkpoint.bin"),
      next_(folder / "checkpoint.next.bin"),
      log_(folder / "checkpoint.log"),
      program_(std::move(program)),
      config_(nlohmann::json::parse(config).dump()) {}

Checkpoint::~Checkpoint() {
  if (log_fd_ >= 0) ::close(log_fd_);
  if (next_fd_ >= 0) ::close(next_fd_);
}

std::optional<Checkpoint::Read> Checkpoint::read_one(const fs::path& file, bool may_be_torn) const {
  std::error_code unreachable;
  if (!fs::exists(file, unreachable)) return std::nullopt;
  const std::string name = file.string(), text = read_input_file(name, checkpoint_file);
  std::string_view rest = text;
  const std::string_view format = take_line(rest), program = take_line(rest), contents = take_line(rest);
  const bool whole = contents == prefix_line("contents", prefix_of_bytes(rest));
  if (may_be_torn && !whole) return std::nullopt;
  if (format != format_line) {
    throw ConfigError(name, "no checkpoint, or one of another version",
                      fmt::format("a file that begins with '{}'", format_line));
  }
  if (program != "program " + program_) {
    throw ConfigError(name, fmt::format("a checkpoint of another build ({})", program.substr(0, 24)),
                      fmt::format("one of this program ({}), or no --resume", program_.substr(0, 16)));
  }
  if (!whole) {
    throw ConfigError(name, fmt::format("a checkpoint that is cut off or damaged ({} bytes)", rest.size()),
                      fmt::format("{}, or no --resume", contents));
  }
  Read out;
  take_line(rest, text.size());  // the config: the archive has it too
  const std::string_view number = take_line(rest), log = take_line(rest), trace = take_line(rest);
  const std::string_view digits = number.substr(number.find(' ') + 1);
  std::from_chars(digits.data(), digits.data() + digits.size(), out.number);
  const FilePrefix logged = prefix_of(log);
  auto hash = hash_of_prefix(log_.string(), logged);
  if (!hash) {
    throw ConfigError(log_.string(), "a log that is cut off or damaged, or not there",
                      fmt::format("{}, as {} has it, or no --resume", log, file.filename().string()));
  }
  out.trace = trace_of(folder_, trace);
  out.log_hash = std::move(*hash);
  out.log = read_input_file(log_.string(), checkpoint_file).substr(0, logged.bytes);
  out.archive = rest;
  return out;
}

std::optional<Archive> Checkpoint::read() {
  std::optional<Read> found = read_one(file_, false);
  if (!found) return std::nullopt;
  std::optional<Read> next = read_one(next_, true);
  if (next && next->number > found->number) found = std::move(next);
  lists_ = {};
  lists_.add(std::move(found->log));
  log_hash_ = std::move(found->log_hash);
  trace_ = found->trace;
  number_ = found->number;
  return Archive(std::move(found->archive), lists_);
}

void Checkpoint::forget() {
  lists_ = {};
  log_hash_ = {};
  trace_ = {};
  number_ = 0;
}

bool Checkpoint::should_sync() const { return synced_s_ < 0 || now_s() - synced_s_ >= sync_every_s; }

bool Checkpoint::exists() const {
  std::error_code unreachable;
  return fs::exists(file_, unreachable);
}

std::optional<std::string> Checkpoint::config_there() const {
  std::ifstream in(file_, std::ios::binary);
  std::string format, program, contents, config;
  if (!std::getline(in, format) || format != format_line) return std::nullopt;
  for (std::string* line : {&program, &contents, &config}) std::getline(in, *line);
  if (!config.starts_with(config_word)) return std::nullopt;
  config.erase(0, config_word.size());
  return nlohmann::json::accept(config) ? std::optional(config) : std::nullopt;
}

// What an earlier process wrote behind the checkpoint that was read is written over, and cut.
void Checkpoint::append_to_log(bool sync) {
  if (log_fd_ < 0) {
    log_fd_ = open_to_write(log_);
    if (::ftruncate(log_fd_, static_cast<::off_t>(log_hash_.so_far().bytes)) != 0)
      fail_with(log_, "cannot cut", errno);
  }
  write_all(log_fd_, log_, lists_.added, log_hash_.so_far().bytes);
  log_hash_.add(lists_.added);
  lists_.added.clear();
  if (sync && ::fsync(log_fd_) != 0) fail_with(log_, "cannot write to the disk", errno);
}

void Checkpoint::write_in_place(const std::string& text) {
  if (next_fd_ < 0) next_fd_ = open_to_write(next_);
  write_all(next_fd_, next_, text, 0);
  if (::ftruncate(next_fd_, static_cast<::off_t>(text.size())) != 0) fail_with(next_, "cannot cut", errno);
}

void Checkpoint::write(const Archive& archive, const FilePrefix& trace, bool sync) {
  append_to_log(sync);
  const std::string rest = fmt::format("{}{}\nnumber {}\n{}\n{}\n", config_word, config_, ++number_,
                                       prefix_line("log", log_hash_.so_far()), prefix_line("trace", trace)) +
                           archive.bytes();
  const std::string text = fmt::format("{}\nprogram {}\n{}\n", format_line, program_,
                                       prefix_line("contents", prefix_of_bytes(rest))) +
                           rest;
  if (!sync) return write_in_place(text);
  write_atomically(file_, text);
  synced_s_ = now_s();
}

void Checkpoint::remove() {
  std::error_code absent;
  for (const fs::path& file : {file_, next_, log_})
    fs::remove(file, absent);  // without the first there is none
}

}  // namespace bb
