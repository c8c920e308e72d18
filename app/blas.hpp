#pragma once

namespace vbond::app {

/// Starts the program anew with OPENBLAS_CORETYPE in its environment where OpenBLAS, which does not know
/// every processor, has chosen a kernel of older instructions than this processor has: the library chooses as
/// it is loaded, so there is no other way. Does nothing if the user has set that variable. To be called first
/// in main().
void choose_blas_kernel(char** arguments);

}  // namespace vbond::app
