#pragma once
#include <algorithm>
#include <thread>

namespace vbond {

/// A number of threads, of which 0 stands for as many as the machine runs at once.
inline int threads_or_all(int threads) {
  return threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace vbond
