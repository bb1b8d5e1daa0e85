// How many threads a block of a kernel over items has.
#pragma once

namespace bb::cuda {

/// Warps that the registers of a processor hold in blocks of so many threads: 65,536, of which a warp gets them by 256, and 64
/// warps at most. Those are the numbers of compute capability 8.0, 9.0 and 10.0.
constexpr int resident_warps(int threads, int registers) {
  const int warps = threads / 32, a_block = warps * ((32 * registers + 255) / 256 * 256);
  const int held = a_block > 0 ? 65536 / a_block * warps : 64;
  return held < 64 ? held : 64;
}

/// 64 where a processor holds at least a fifth more warps then than in blocks of 256, else 256. A kernel of 129 to 168
/// registers has one block of 256 threads a processor, which is 8 warps, and 6 or 7 blocks of 64.
/// @param registers of a thread; 0: not known
constexpr int threads_of_block(int registers) {
  return 5 * resident_warps(64, registers) >= 6 * resident_warps(256, registers) ? 64 : 256;
}

}  // namespace bb::cuda
