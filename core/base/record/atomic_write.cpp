// Files that are either whole or absent, and the trace. Every failure names path and cause.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

/// Trying again later does not help.
bool lasts(int error) {
  switch (error) {
    case EACCES:
    case EPERM:
    case EROFS:
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
    case EEXIST:
    case ELOOP:
    case ENAMETOOLONG:
    case EINVAL:
      return true;
    default:
      return false;
  }
}

}  // namespace

void fail_with(const fs::path& path, const char* what, int error) {
  throw RecordError(path.string() + ": " + what + ": " + std::strerror(error), lasts(error));
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) fail_with(folder, "cannot create the folder", error.value());
}

namespace {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : fd_(::open(path.c_str(), flags, 0644)) {
    if (fd_ < 0) fail_with(path, "cannot open", errno);
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  int close() {
    const int result = ::close(fd_);
    fd_ = -1;
    return result;
  }

 private:
  int fd_;
};

void write_and_sync(const fs::path& path, const std::string& text) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
  std::size_t done = 0;
  while (done < text.size()) {
    const ::ssize_t n = ::write(file.get(), text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_with(path, "cannot write", errno);
    done += static_cast<std::size_t>(n);
  }
  if (::fsync(file.get()) != 0) fail_with(path, "cannot write to the disk", errno);
  if (file.close() != 0) fail_with(path, "cannot close", errno);
}

void sync_folder(const fs::path& folder) {
  const Descriptor dir(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (::fsync(dir.get()) != 0 && errno != EINVAL) fail_with(folder, "cannot sync the folder", errno);
}

fs::path temp_beside(const fs::path& path) { return path.string() + ".tmp." + std::to_string(::getpid()); }

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace

StagedFile::StagedFile(const fs::path& path, const std::string& text)
    : path_(path), temp_(temp_beside(path)) {
  make_folder(folder_of(path));
  try {
    write_and_sync(temp_, text);
  } catch (const RecordError&) {
    ::unlink(temp_.c_str());
    throw;
  }
}

StagedFile::~StagedFile() {
  if (!temp_.empty()) ::unlink(temp_.c_str());
}

void StagedFile::commit() {
  if (::rename(temp_.c_str(), path_.c_str()) != 0) fail_with(path_, "cannot rename into place", errno);
  temp_.clear();
  sync_folder(folder_of(path_));
}

bool StagedFile::commit_as_first() {
  if (::link(temp_.c_str(), path_.c_str()) != 0) {
    if (errno == EEXIST) return false;
    commit();  // of a file system without links
    return true;
  }
  ::unlink(temp_.c_str());
  temp_.clear();
  sync_folder(folder_of(path_));
  return true;
}

void write_atomically(const fs::path& path, const std::string& text) { StagedFile(path, text).commit(); }

void move_into_place(const fs::path& from, const fs::path& to) {
  make_folder(folder_of(to));
  if (::rename(from.c_str(), to.c_str()) != 0) fail_with(to, "cannot rename into place", errno);
}

void write_run(const fs::path& folder, const RunRecord& record) {
  write_atomically(folder / "run.json", to_json(record));
}

void check_writable(const fs::path& folder) {
  make_folder(folder);
  const fs::path probe = temp_beside(folder / "probe");
  try {
    write_and_sync(probe, std::string(4096, ' '));
  } catch (const RecordError&) {
    ::unlink(probe.c_str());
    throw;
  }
  ::unlink(probe.c_str());
  std::error_code absent;
  for (const char* name : {"run.json", "trace.jsonl"}) {
    if (fs::is_directory(folder / name, absent)) fail_with(folder / name, "in the way of a file", EISDIR);
  }
  for (const char* name : {"frames", "forces", "matrices"}) {
    const fs::file_status found = fs::status(folder / name, absent);
    if (fs::exists(found) && !fs::is_directory(found)) {
      fail_with(folder / name, "in the way of a folder", ENOTDIR);
    }
  }
}

TraceWriter::TraceWriter(const fs::path& folder) : path_(folder / "trace.jsonl") {
  make_folder(folder);
  part_ = path_;
  part_ += ".part";
  file_ = std::fopen(part_.c_str(), "we");
  if (file_ == nullptr) fail("cannot open");
}

std::optional<fs::path> find_trace(const fs::path& folder, const FilePrefix& prefix) {
  for (const char* name : {"trace.jsonl.part", "trace.jsonl"}) {
    if (hash_of_prefix((folder / name).string(), prefix)) return folder / name;
  }
  return std::nullopt;
}

TraceWriter::TraceWriter(const fs::path& folder, const FilePrefix& prefix)
    : path_(folder / "trace.jsonl"), leave_(true) {
  part_ = path_;
  part_ += ".part";
  const std::optional<fs::path> found = find_trace(folder, prefix);
  if (!found)
    throw RecordError(part_.string() + ": not as the checkpoint beside it has it, run without --resume",
                      true);
  std::error_code error;
  if (*found != part_) fs::copy_file(*found, part_, fs::copy_options::overwrite_existing, error);
  if (error) fail_with(part_, "cannot copy", error.value());
  auto hash = hash_of_prefix(part_.string(), prefix);
  if (!hash) throw RecordError(part_.string() + ": changed while it was read", false);
  hash_ = std::move(*hash);
  fs::resize_file(part_, prefix.bytes, error);
  if (error) fail_with(part_, "cannot cut", error.value());
  file_ = std::fopen(part_.c_str(), "ae");
  if (file_ == nullptr) fail("cannot open");
}

FilePrefix TraceWriter::checkpoint(bool sync) {
  end_step();
  if (sync && ::fsync(::fileno(file_)) != 0) fail("cannot write to the disk");
  leave_ = true;
  return hash_.so_far();
}

TraceWriter::~TraceWriter() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  if (leave_) return;
  std::error_code ignored;
  fs::remove(part_, ignored);
}

void TraceWriter::fail(const char* what) const { fail_with(path_, what, errno); }

void TraceWriter::add(const TraceRow& row) {
  const std::string line = to_json(row) + "\n";
  if (std::fwrite(line.data(), 1, line.size(), file_) != line.size()) fail("cannot write");
  hash_.add(line);
}

void TraceWriter::end_step() {
  if (std::fflush(file_) != 0) fail("cannot write");
}

Artifact TraceWriter::artifact() const {
  const FilePrefix written = hash_.so_far();
  Artifact out;
  out.path = path_.filename().string();
  out.kind = "trace";
  out.media_type = "application/jsonl";
  out.sha256 = written.sha256;
  out.bytes = written.bytes;
  return out;
}

void TraceWriter::close() {
  end_step();
  if (::fsync(::fileno(file_)) != 0) fail("cannot write to the disk");
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail("cannot close");
}

void TraceWriter::finish() {
  close();
  if (std::rename(part_.c_str(), path_.c_str()) != 0) fail("cannot rename to");
}

}  // namespace bb
