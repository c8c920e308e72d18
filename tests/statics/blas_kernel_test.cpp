#include "vbond/statics/blas_kernel.hpp"

#include <gtest/gtest.h>

namespace vbond::blas_kernel_test {
namespace {

TEST(BlasKernel, IsReplacedWhereTheProcessorHasNewerInstructions) {
  // what OpenBLAS 0.3.21 takes on Intel's family 6, model 207
  EXPECT_EQ(better_blas_kernel("Prescott", VectorSet::avx512), "SkylakeX");
  EXPECT_EQ(better_blas_kernel("Prescott", VectorSet::avx2), "Haswell");
  EXPECT_EQ(better_blas_kernel("Barcelona", VectorSet::avx), "Sandybridge");
  EXPECT_EQ(better_blas_kernel("Zen", VectorSet::avx512), "SkylakeX");
}

TEST(BlasKernel, StaysWhereItUsesWhatTheProcessorHas) {
  EXPECT_EQ(better_blas_kernel("Prescott", VectorSet::sse), "");
  EXPECT_EQ(better_blas_kernel("Haswell", VectorSet::avx2), "");
  EXPECT_EQ(better_blas_kernel("Cooperlake", VectorSet::avx512), "");
  EXPECT_EQ(better_blas_kernel("SkylakeX", VectorSet::avx2), "");
}

TEST(BlasKernel, OfAnUnknownNameStays) {
  EXPECT_EQ(better_blas_kernel("Tomorrow", VectorSet::avx512), "");
}

}  // namespace
}  // namespace vbond::blas_kernel_test
