// Preloaded by faults_test: zlib finds no memory, as where it runs out while a frame is written.
#include <zlib.h>

extern "C" int compress2(Bytef*, uLongf*, const Bytef*, uLong, int) {
  return Z_MEM_ERROR;
}
