// All checks in one translation unit: nvcc reads Eigen once instead of six times.
#include "core/device_check/accd.cu"
#include "core/device_check/bending.cu"
#include "core/device_check/distance.cu"
#include "core/device_check/math.cu"
#include "core/device_check/membrane.cu"
#include "core/device_check/shapes.cu"
