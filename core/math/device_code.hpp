// Device code that came after the program was built.
#pragma once

#include <string>

namespace bb {

struct DeviceCode {
  std::string ptx;     // text; the driver compiles it for the card that is there
  std::string entry;   // name of its kernel, (Index n, F f): f(i) for i in [0, n), F as the host lays it out
  std::string file;    // that has the text
  std::string sha256;  // of the file
};

}  // namespace bb
