// The one host-device macro. Element math is compiled by the C++ and by the CUDA compiler from
// the same source.
#pragma once

#ifdef __CUDACC__
#define BB_HD __host__ __device__
#else
#define BB_HD
#endif
