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
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace vbond {
namespace {

void put(const Vec3d& x, double*& to) {
  *to++ = x.x, *to++ = x.y, *to++ = x.z;
}
void put(const Quatd& q, double*& to) {
  *to++ = q.w, *to++ = q.x, *to++ = q.y, *to++ = q.z;
}
Vec3d take_vector(const double*& from) {
  from += 3;
  return {from[-3], from[-2], from[-1]};
}
Quatd take_quaternion(const double*& from) {
  from += 4;
  return {from[-4], from[-3], from[-2], from[-1]};
}

/// The messages of a step, and what each atom costs, which LAMMPS carries along with it to balance them.
class FixVbond : public LAMMPS_NS::Fix {
 public:
  static constexpr int pose_numbers = 7, motion_numbers = 6, load_numbers = 6;
  FixVbond(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) : Fix(lmp, narg, arg) {
    comm_forward = pose_numbers + motion_numbers;  // at most
    comm_reverse = load_numbers;
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
  int pack_forward_comm(int n, int* list, double* to, int /*pbc_flag*/, int* /*pbc*/) override {
    for (int k = 0; k < n; ++k) {
      const std::uint32_t from = rows[list[k]];
      put(ghosts.pose[from].r, to), put(ghosts.pose[from].q, to);
      if (!ghosts.motion.empty()) put(ghosts.motion[from].v, to), put(ghosts.motion[from].omega, to);
    }
    return n * comm_forward;
  }
  void unpack_forward_comm(int n, int first, double* values) override {
    const double* from = values;
    for (int k = first; k < first + n; ++k) {
      const std::uint32_t to = rows[k];
      ghosts.pose[to].r = take_vector(from), ghosts.pose[to].q = take_quaternion(from);
      if (ghosts.motion.empty()) continue;
      ghosts.motion[to].v = take_vector(from), ghosts.motion[to].omega = take_vector(from);
    }
  }
  int pack_reverse_comm(int n, int first, double* to) override {
    for (int k = first; k < first + n; ++k) put(load[rows[k]].F, to), put(load[rows[k]].M, to);
    return n * load_numbers;
  }
  void unpack_reverse_comm(int n, int* list, double* values) override {
    const double* from = values;
    for (int k = 0; k < n; ++k) {
      LoadRow& l = load[rows[list[k]]];
      l.F += take_vector(from), l.M += take_vector(from);
    }
  }

  void set_costs(const PerParticle<double>& work) {
    for (int k = 0; k < atom->nlocal; ++k)
      vector_atom[k] = work[ParticleId{static_cast<std::size_t>(atom->tag[k] - 1)}];
  }

  std::vector<double> costs;  // of each atom
  // of the message under way
  const std::uint32_t* rows = nullptr;
  HaloColumns ghosts;
  std::span<LoadRow> load;
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
  void make_atoms(const Order& order, const PerParticle<Vec3d>& all) const;
  /// Moves the borders between domains so that their work is the same but for a twentieth, where planes
  /// through the body can do so.
  void balance(const PerParticle<double>& work) const;
  /// What LAMMPS does wherever it lists neighbours anew.
  void spread(double reach) const;

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
  for (const char* line : {"units lj", "atom_style atomic", "atom_modify map yes sort 0 0.0", "newton on",
                           "boundary s s s", "neighbor 0.0 bin"})
    command(line);
  command("region body block" + sides + " units box");
  command("create_box 1 body");
  command("mass 1 1.0");
  (*lmp->modify->fix_map)["vbond"] = FixVbond::make;
  fix = dynamic_cast<FixVbond*>(lmp->modify->add_fix("body all vbond"));
}

/// In the order of space, as the step loop has them.
void Domains::Lammps::make_atoms(const Order& order, const PerParticle<Vec3d>& all) const {
  std::vector<int> id, type(all.size(), 1);
  std::vector<double> x;
  for (const ParticleId p : order.particle) {
    id.push_back(static_cast<int>(p.value) + 1);
    x.insert(x.end(), {all[p].x, all[p].y, all[p].z});
  }
  lammps_create_atoms(lmp.get(), static_cast<int>(id.size()), id.data(), type.data(), x.data(), nullptr,
                      nullptr, 1);
}

void Domains::Lammps::balance(const PerParticle<double>& work) const {
  if (lmp->comm->nprocs == 1) return;
  fix->set_costs(work);
  command("balance 1.05 shift xyz 20 1.02 weight var cost");
}

void Domains::Lammps::spread(double reach) const {
  lmp->comm->cutghostuser = reach;
  lmp->domain->pbc();
  lmp->domain->reset_box();
  lmp->comm->setup();
  lmp->comm->exchange();
  lmp->comm->borders();
  std::int64_t mine = lmp->atom->nlocal, all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  if (all != particles)
    throw std::runtime_error("LAMMPS has lost " + std::to_string(particles - all) +
                             " particles on their way between ranks");
}

Domains::Domains(const Order& order, const PerParticle<Vec3d>& all, const PerParticle<double>& work,
                 double reach)
    : lammps_(std::make_unique<Lammps>()) {
  lammps_->particles = static_cast<std::int64_t>(all.size());
  lammps_->make_box(all, std::max(reach, 1e-3));
  lammps_->make_atoms(order, all);
  lammps_->command("variable cost atom f_body");
  lammps_->lmp->init();
  lammps_->balance(work);
  lammps_->spread(reach);
}

Domains::~Domains() = default;

void Domains::redistribute(const PerParticle<Vec3d>& all, const PerParticle<double>& work, double reach) {
  LAMMPS_NS::Atom& atom = *lammps_->lmp->atom;
  for (int k = 0; k < atom.nlocal; ++k) {
    const Vec3d& r = all[ParticleId{static_cast<std::size_t>(atom.tag[k] - 1)}];
    atom.x[k][0] = r.x, atom.x[k][1] = r.y, atom.x[k][2] = r.z;
  }
  // to their new ranks however far they have gone: what follows is for neighbouring domains only
  lammps_->command("displace_atoms all move 0.0 0.0 0.0 units box");
  lammps_->balance(work);
  lammps_->spread(reach);
}

Holding Domains::holding() {
  const LAMMPS_NS::Atom& atom = *lammps_->lmp->atom;
  const auto own = static_cast<std::size_t>(atom.nlocal), all = own + static_cast<std::size_t>(atom.nghost);
  // ghosts report to their particles
  std::vector<std::uint32_t> rows(all);
  std::iota(rows.begin(), rows.end(), 0u);
  std::vector<LoadRow> reports(all);
  for (std::size_t k = own; k < all; ++k) reports[k].F.x = 1.0;
  reverse_sum(rows, reports);

  Holding h;
  for (std::size_t k = 0; k < all; ++k) {
    const ParticleId p{static_cast<std::size_t>(atom.tag[k] - 1)};
    (k < own ? h.own : h.ghosts).push_back(p);
    if (k < own && reports[k].F.x != 0.0) h.sent.push_back(p);
  }
  return h;
}

void Domains::halo(const std::vector<std::uint32_t>& rows, const HaloColumns& columns) {
  FixVbond& fix = *lammps_->fix;
  fix.rows = rows.data();
  fix.ghosts = columns;
  fix.comm_forward = FixVbond::pose_numbers + (columns.motion.empty() ? 0 : FixVbond::motion_numbers);
  lammps_->lmp->comm->forward_comm_fix(&fix);
}

void Domains::reverse_sum(const std::vector<std::uint32_t>& rows, std::span<LoadRow> load) {
  lammps_->fix->rows = rows.data();
  lammps_->fix->load = load;
  lammps_->lmp->comm->reverse_comm_fix(lammps_->fix);
}

}  // namespace vbond
