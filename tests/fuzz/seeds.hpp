// What the fuzz targets start from: valid inputs out of configs/, examples/ and results/ and of the writers of this
// program, so that nothing is kept twice, and the words of each format.
#pragma once

#include <string>
#include <vector>

namespace bb::fuzz {

/// In alphabetical order.
const std::vector<std::string>& target_names();

/// Inputs of at most 16 KiB that a target must survive; never empty.
/// Errors: std::out_of_range for a name that is no target, std::runtime_error for files that are not there.
std::vector<std::string> seeds_of(const std::string& target);

/// Words for libFuzzer's dictionary: keys, words and names out of the lists of settings and fields; may be empty.
std::vector<std::string> words_of(const std::string& target);

}  // namespace bb::fuzz
