#pragma once
#include <bond_bpm.h>

#include <cstdint>
#include <string>
#include <vector>

#include "vbond/dynamics/bond_packs.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// LAMMPS' bond_style vbond: see docs/lammps-plugin.md. Bonds break, are stored with their atoms, migrate and
/// restart as all bonds of LAMMPS' package BPM do; their loads are those of vbond's kernels. The row of an
/// atom is its local index.
class BondVbond : public LAMMPS_NS::BondBPM {
 public:
  explicit BondVbond(LAMMPS_NS::LAMMPS* lmp);
  ~BondVbond() override;

  void settings(int narg, char** arg) override;
  void coeff(int narg, char** arg) override;
  void init_style() override;
  void compute(int eflag, int vflag) override;
  double single(int type, double rsq, int i, int j, double& fforce) override;
  void write_restart(FILE* file) override;
  void read_restart(FILE* file) override;
  void write_restart_settings(FILE* file) override;
  void read_restart_settings(FILE* file) override;
  static LAMMPS_NS::Bond* make(LAMMPS_NS::LAMMPS* lmp) { return new BondVbond(lmp); }

 private:
  void allocate();
  void store_data() override;
  void store_from_file();
  void store_as_they_stand();
  void store(int atom, int place, const vbond::Bond& bond, bool first_has_larger_id);
  vbond::Bond stored(const double* numbers, int type) const;
  void arrange();
  void take_poses();
  void add_to_forces();
  void tally();
  void take_out_broken();

  std::vector<BondRecipe> types_;    // from 1
  std::string file_;                 // of bonds; empty: bonds as they stand
  LAMMPS_NS::bigint arranged_ = -1;  // the step in which LAMMPS listed the bonds that are arranged
  State state_;                      // its bonds, in the order of LAMMPS' list, between rows
  std::vector<int> listed_;          // where each of them stands in that list
  BondPacks packs_;
  std::vector<PoseRow> pose_;
  std::vector<MotionRow> rates_;
  std::vector<LoadRow> load_, damping_;
  std::vector<BondId> breaking_;
};

}  // namespace vbond
