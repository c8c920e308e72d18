#pragma once
#include <cstdint>
#include <string>

namespace vbond {

/// The kernel with which OpenBLAS computes in this process, by its name, such as "Haswell".
std::string blas_kernel();

/// Vector instructions of a processor, as far as OpenBLAS has kernels of them: each includes those before.
enum class VectorSet : std::uint8_t { sse, avx, avx2, avx512 };

/// The kernel of OpenBLAS that uses what such a processor has, if `own`, the library's own choice, uses less;
/// else empty. Empty also for a kernel whose name is not known here: it is newer than this list.
std::string better_blas_kernel(const std::string& own, VectorSet processor);

/// The same of this process and processor. Empty also where OpenBLAS was built for one kind of processor. The
/// library takes another kernel only from OPENBLAS_CORETYPE in the environment, and reads it as it is loaded.
std::string better_blas_kernel();

}  // namespace vbond
