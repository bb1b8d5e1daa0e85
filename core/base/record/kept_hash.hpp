// The SHA-256 of a large file that seldom changes, kept between processes.
#pragma once

#include <filesystem>
#include <string>

namespace bb {

/// Hashes of files lie here: BARRIERBENCH_CACHE/hashes, else barrierbench/hashes in the user's cache folder; empty where there is none.
std::filesystem::path hashes_folder();

/// sha256_file(path), read from `folder` where it stands there under device, inode, size, time of change of the content and time of
/// change of the inode, to the nanosecond. A file that has changed since less than `settled_s` is hashed and not kept, since
/// it may change again within one tick of those times. A folder that cannot be written keeps nothing, without an error. Empty for
/// what is no regular file.
/// Cost: a stat and a read of 64 bytes, else that of sha256_file, 20 ms for a program of 30 MB.
std::string kept_sha256(const std::string& path, const std::filesystem::path& folder, double settled_s = 2);

}  // namespace bb
