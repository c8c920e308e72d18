#include "vbond/dynamics/bond_pack.hpp"

namespace vbond {

namespace baseline {
void evaluate_packs(const BondPack*, std::size_t, const Vec3d*, const Quatd*, BondLoads<double>*);
}
#if defined(__x86_64__)
namespace avx2 {
void evaluate_packs(const BondPack*, std::size_t, const Vec3d*, const Quatd*, BondLoads<double>*);
}
namespace avx512 {
void evaluate_packs(const BondPack*, std::size_t, const Vec3d*, const Quatd*, BondLoads<double>*);
}
#endif

std::size_t available_kernels(NamedKernel (&kernels)[3]) {
  std::size_t n = 0;
  kernels[n++] = {"baseline", baseline::evaluate_packs};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) kernels[n++] = {"avx2", avx2::evaluate_packs};
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    kernels[n++] = {"avx512", avx512::evaluate_packs};
#endif
  return n;
}

void fill_lane(BondPack& p, std::uint32_t lane, BondId id, const Bond& b) {
  p.law = b.law;
  p.count = lane + 1;
  const Quatd* frames[2] = {&b.frame_i, &b.frame_j};
  for (std::uint32_t l = lane; l < pack_width; ++l) {
    p.bond[l] = id.value;
    p.i[l] = b.i.value;
    p.j[l] = b.j.value;
    p.a[l] = b.a, p.R_i[l] = b.R_i, p.R_j[l] = b.R_j;
    p.B1[l] = b.B1, p.B2[l] = b.B2, p.B3[l] = b.B3, p.B4[l] = b.B4;
    for (std::size_t n = 0; n < 2; ++n) {
      p.frame[n][0][l] = frames[n]->w, p.frame[n][1][l] = frames[n]->x;
      p.frame[n][2][l] = frames[n]->y, p.frame[n][3][l] = frames[n]->z;
    }
  }
}

PackKernel pack_kernel() {
  static const PackKernel best = [] {
    NamedKernel kernels[3];
    const std::size_t n = available_kernels(kernels);
    return kernels[n - 1].kernel;
  }();
  return best;
}

}  // namespace vbond
