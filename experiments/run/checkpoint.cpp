#include "experiments/run/checkpoint.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "core/input/read_file.hpp"
#include "core/math/error.hpp"
#include "core/record/provenance.hpp"
#include "core/record/writer.hpp"

namespace bb {
namespace {

constexpr std::string_view format_line = "barrierbench.checkpoint/1";
constexpr InputKind checkpoint_file{"a checkpoint", std::uint64_t{64} << 30};

/// The first lines, up to the empty one, which is taken off `text` with them; nothing when they are not there.
std::optional<std::array<std::string_view, 3>> take_head(std::string_view& text) {
  std::array<std::string_view, 3> lines;
  for (std::string_view& line : lines) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos || end > 200) return std::nullopt;
    line = text.substr(0, end);
    text.remove_prefix(end + 1);
  }
  if (text.empty() || text.front() != '\n') return std::nullopt;
  text.remove_prefix(1);
  return lines;
}

std::string contents_line(std::string_view archive) {
  return fmt::format("{} bytes {}", archive.size(), sha256_hex(archive));
}

}  // namespace

Checkpoint::Checkpoint(const std::filesystem::path& folder, std::string program)
    : file_(folder / "checkpoint.bin"), program_(std::move(program)) {}

std::optional<Archive> Checkpoint::read() const {
  std::error_code unreachable;
  if (!std::filesystem::exists(file_, unreachable)) return std::nullopt;
  const std::string name = file_.string(), text = read_input_file(name, checkpoint_file);
  std::string_view rest = text;
  const auto head = take_head(rest);
  if (!head || (*head)[0] != format_line) {
    throw ConfigError(name, "no checkpoint, or one of another version",
                      fmt::format("a file that begins with '{}'", format_line));
  }
  if ((*head)[1] != "program " + program_) {
    throw ConfigError(name, fmt::format("a checkpoint of another build ({})", (*head)[1].substr(0, 24)),
                      fmt::format("one of this program ({}), or no --resume", program_.substr(0, 16)));
  }
  if ((*head)[2] != contents_line(rest)) {
    throw ConfigError(name, fmt::format("a checkpoint that is cut off or damaged ({} bytes)", rest.size()),
                      fmt::format("{}, or no --resume", (*head)[2]));
  }
  return Archive(std::string(rest));
}

void Checkpoint::write(const Archive& archive) const {
  write_atomically(
      file_, fmt::format("{}\nprogram {}\n{}\n\n", format_line, program_, contents_line(archive.bytes())) +
                 archive.bytes());
}

void Checkpoint::remove() const {
  std::error_code absent;
  std::filesystem::remove(file_, absent);
}

}  // namespace bb
