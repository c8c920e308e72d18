// The vector loop over bonds. This file is compiled once per instruction set with its own namespace
// VBOND_KERNEL and with VBOND_HD forcing every law inline. It must define nothing but that namespace's
// function: an inline function emitted here would be compiled for a machine on which the rest of the program
// may not be running.
#include "vbond/dynamics/bond_pack.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

/// Positions and orientations of both ends, lane by lane.
struct Ends {
  BondPack::Lanes r_i[3], q_i[4], r_j[3], q_j[4];
};

inline void gather(const BondPack& p, const Vec3d* r, const Quatd* q, Ends& e) {
  for (std::size_t l = 0; l < pack_width; ++l) {
    const Vec3d &r_i = r[p.i[l]], &r_j = r[p.j[l]];
    const Quatd &q_i = q[p.i[l]], &q_j = q[p.j[l]];
    e.r_i[0][l] = r_i.x, e.r_i[1][l] = r_i.y, e.r_i[2][l] = r_i.z;
    e.r_j[0][l] = r_j.x, e.r_j[1][l] = r_j.y, e.r_j[2][l] = r_j.z;
    e.q_i[0][l] = q_i.w, e.q_i[1][l] = q_i.x, e.q_i[2][l] = q_i.y, e.q_i[3][l] = q_i.z;
    e.q_j[0][l] = q_j.w, e.q_j[1][l] = q_j.x, e.q_j[2][l] = q_j.y, e.q_j[3][l] = q_j.z;
  }
}

using Results = BondPack::Lanes[9];

/// One lane: the law of physics/ on this bond's numbers. A function of its own, because g++ keeps structs
/// that are declared inside a simd loop in memory.
template <class Law>
VBOND_HD void evaluate_lane(const BondPack& p, const Ends& e, std::size_t l, Results& out) {
  const BondFrames<double> frames{{p.frame[0][0][l], p.frame[0][1][l], p.frame[0][2][l], p.frame[0][3][l]},
                                  {p.frame[1][0][l], p.frame[1][1][l], p.frame[1][2][l], p.frame[1][3][l]}};
  const Vec3d r_i{e.r_i[0][l], e.r_i[1][l], e.r_i[2][l]}, r_j{e.r_j[0][l], e.r_j[1][l], e.r_j[2][l]};
  const Quatd q_i{e.q_i[0][l], e.q_i[1][l], e.q_i[2][l], e.q_i[3][l]};
  const Quatd q_j{e.q_j[0][l], e.q_j[1][l], e.q_j[2][l], e.q_j[3][l]};
  const Law law{p.a[l], p.R_i[l], p.R_j[l], p.B1[l], p.B2[l], p.B3[l], p.B4[l]};
  const BondLoads<double> loads = bond_loads(law, bond_pose(frames, r_i, q_i, r_j, q_j));
  out[0][l] = loads.F.x, out[1][l] = loads.F.y, out[2][l] = loads.F.z;
  out[3][l] = loads.M_ij.x, out[4][l] = loads.M_ij.y, out[5][l] = loads.M_ij.z;
  out[6][l] = loads.M_ji.x, out[7][l] = loads.M_ji.y, out[8][l] = loads.M_ji.z;
}

template <class Law>
void evaluate(const BondPack& p, const Vec3d* r, const Quatd* q, BondLoads<double>* of_bond) {
  Ends e;
  gather(p, r, q, e);
  Results out;
#pragma omp simd
  for (std::size_t l = 0; l < pack_width; ++l) evaluate_lane<Law>(p, e, l, out);
  for (std::size_t l = 0; l < p.count; ++l)
    of_bond[p.bond[l]] = {{out[0][l], out[1][l], out[2][l]},
                          {out[3][l], out[4][l], out[5][l]},
                          {out[6][l], out[7][l], out[8][l]}};
}

}  // namespace

void evaluate_packs(const BondPack* packs, std::size_t count, const Vec3d* r, const Quatd* q,
                    BondLoads<double>* of_bond) {
  for (const BondPack* p = packs; p != packs + count; ++p) switch (p->law) {
      case BondLaw::v_model: evaluate<VModel<double>>(*p, r, q, of_bond); break;
      case BondLaw::evm: evaluate<Evm<double>>(*p, r, q, of_bond); break;
    }
}

}  // namespace vbond::VBOND_KERNEL
