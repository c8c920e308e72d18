#include "vbond/ranks/domains.hpp"

#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <fix.h>
#include <input.h>
#include <lammps.h>
#include <library.h>
#include <modify.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbond {
namespace {

/// What each atom costs, which LAMMPS carries along with it to balance them.
class FixVbond : public LAMMPS_NS::Fix {
 public:
  FixVbond(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) : Fix(lmp, narg, arg) {
    peratom_flag = 1;
    peratom_freq = 1;
    size_peratom_cols = 0;
    maxexchange = 1;
    grow_arrays(atom->nmax);
    atom->add_callback(LAMMPS_NS::Atom::GROW);
  }
  ~FixVbond() override { atom->delete_callback(id, LAMMPS_NS::Atom::GROW); }
  static Fix* make(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) { return new FixVbond(lmp, narg, arg); }

  int setmask() override { return 0; }
  void grow_arrays(int n) override {
    costs.resize(static_cast<std::size_t>(n), 1.0);
    vector_atom = costs.data();
  }
  void copy_arrays(int i, int j, int /*delflag*/) override { vector_atom[j] = vector_atom[i]; }
  int pack_exchange(int i, double* to) override { return *to = vector_atom[i], 1; }
  int unpack_exchange(int i, double* from) override { return vector_atom[i] = *from, 1; }
  void set_costs(const PerParticle<double>& work) {
    for (int k = 0; k < atom->nlocal; ++k)
      vector_atom[k] = work[ParticleId{static_cast<std::size_t>(atom->tag[k] - 1)}];
  }

  std::vector<double> costs;  // of each atom
};

}  // namespace

/// Atoms are the particles, numbered from 1.
struct Domains::Lammps {
  Lammps() {
    std::array<std::string, 5> words{"vbond-lammps", "-log", "none", "-screen", "none"};
    std::array<char*, 5> arguments{};
    std::transform(words.begin(), words.end(), arguments.begin(), [](std::string& w) { return w.data(); });
    lmp =
        std::make_unique<LAMMPS_NS::LAMMPS>(static_cast<int>(words.size()), arguments.data(), MPI_COMM_WORLD);
  }

  void command(const std::string& line) const { lmp->input->one(line); }
  void make_box(const PerParticle<Vec3d>& all, double margin);
  void make_atoms(const PerParticle<Vec3d>& all) const;
  /// Moves the borders between domains so that their work is the same but for a twentieth, where planes
  /// through the body can do so.
  void balance() const;
  /// Particles go to the ranks in whose domains they are.
  void spread() const;

  std::unique_ptr<LAMMPS_NS::LAMMPS> lmp;
  FixVbond* fix = nullptr;
  std::int64_t particles = 0;
};

void Domains::Lammps::make_box(const PerParticle<Vec3d>& all, double margin) {
  Vec3d low = all[ParticleId{0}], high = low;
  for (const Vec3d& r : all)
    for (int k = 0; k < 3; ++k) {
      component(low, k) = std::min(component(low, k), component(r, k));
      component(high, k) = std::max(component(high, k), component(r, k));
    }
  const auto text = [](double x) {  // to the last digit
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.17g", x);
    return std::string(digits.data());
  };
  std::string sides;
  for (int k = 0; k < 3; ++k)
    sides += " " + text(component(low, k) - margin) + " " + text(component(high, k) + margin);
  for (const char* line : {"units lj", "atom_style atomic", "atom_modify sort 0 0.0", "newton on",
                           "boundary s s s", "neighbor 0.0 bin"})
    command(line);
  command("region body block" + sides + " units box");
  command("create_box 1 body");
  command("mass 1 1.0");
  (*lmp->modify->fix_map)["vbond"] = FixVbond::make;
  fix = dynamic_cast<FixVbond*>(lmp->modify->add_fix("body all vbond"));
}

void Domains::Lammps::make_atoms(const PerParticle<Vec3d>& all) const {
  std::vector<int> id, type(all.size(), 1);
  std::vector<double> x;
  id.reserve(all.size()), x.reserve(3 * all.size());
  for (const ParticleId p : all.ids()) {
    id.push_back(static_cast<int>(p.value) + 1);
    x.insert(x.end(), {all[p].x, all[p].y, all[p].z});
  }
  lammps_create_atoms(lmp.get(), static_cast<int>(id.size()), id.data(), type.data(), x.data(), nullptr,
                      nullptr, 1);
}

void Domains::Lammps::balance() const {
  if (lmp->comm->nprocs == 1) return;
  command("balance 1.05 shift xyz 20 1.02 weight var cost");
}

void Domains::Lammps::spread() const {
  lmp->domain->pbc();
  lmp->domain->reset_box();
  lmp->comm->setup();
  lmp->comm->exchange();
  std::int64_t mine = lmp->atom->nlocal, all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  if (all != particles)
    throw std::runtime_error("LAMMPS has lost " + std::to_string(particles - all) +
                             " particles on their way between ranks");
}

Domains::Domains(const PerParticle<Vec3d>& all, const PerParticle<double>& work, double margin)
    : lammps_(std::make_unique<Lammps>()) {
  lammps_->particles = static_cast<std::int64_t>(all.size());
  lammps_->make_box(all, std::max(margin, 1e-3));
  lammps_->make_atoms(all);
  lammps_->command("variable cost atom f_body");
  lammps_->lmp->init();
  lammps_->fix->set_costs(work);
  lammps_->balance();
  lammps_->spread();
}

Domains::~Domains() = default;

void Domains::redistribute(const PerParticle<Vec3d>& all, const PerParticle<double>& work) {
  LAMMPS_NS::Atom& atom = *lammps_->lmp->atom;
  for (int k = 0; k < atom.nlocal; ++k) {
    const Vec3d& r = all[ParticleId{static_cast<std::size_t>(atom.tag[k] - 1)}];
    atom.x[k][0] = r.x, atom.x[k][1] = r.y, atom.x[k][2] = r.z;
  }
  lammps_->fix->set_costs(work);  // goes along with them
  // to their new ranks however far they have gone: what follows is for neighbouring domains only
  lammps_->command("displace_atoms all move 0.0 0.0 0.0 units box");
  lammps_->balance();
  lammps_->spread();
}

std::vector<ParticleId> Domains::own() const {
  const LAMMPS_NS::Atom& atom = *lammps_->lmp->atom;
  std::vector<ParticleId> own;
  own.reserve(static_cast<std::size_t>(atom.nlocal));
  for (int k = 0; k < atom.nlocal; ++k) own.push_back(ParticleId{static_cast<std::size_t>(atom.tag[k] - 1)});
  std::sort(own.begin(), own.end());
  return own;
}

}  // namespace vbond
