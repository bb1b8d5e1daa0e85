// What ran on the card in this process.
#pragma once

#include <map>
#include <string>

namespace bb::test {

struct Launched {
  long launches = 0, compared = 0, differences = 0;
};

/// By the name of the kernel.
std::map<std::string, Launched>& launched_kernels();

}  // namespace bb::test
