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
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vbond/dynamics/order.hpp"

namespace vbond {
namespace {

/// A bond longer than at the last redistribution finds its ghost all the same: messages go on to those who
/// were listed then. So this margin covers rounding alone.
constexpr double beyond_longest = 1.0 + 1e-6;

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

/// What LAMMPS' atoms lack of a particle, carried along with them; and the messages of a step.
class FixVbond : public LAMMPS_NS::Fix {
 public:
  static constexpr int pose_numbers = 7, load_numbers = 6, carried_numbers = 10;
  FixVbond(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) : Fix(lmp, narg, arg) {
    comm_forward = pose_numbers;
    comm_reverse = load_numbers;
    maxexchange = carried_numbers;
    grow_arrays(atom->nmax);
    atom->add_callback(LAMMPS_NS::Atom::GROW);
  }
  ~FixVbond() override { atom->delete_callback(id, LAMMPS_NS::Atom::GROW); }
  static Fix* make(LAMMPS_NS::LAMMPS* lmp, int narg, char** arg) { return new FixVbond(lmp, narg, arg); }

  int setmask() override { return 0; }
  void grow_arrays(int n) override { carried.resize(static_cast<std::size_t>(n)); }
  void copy_arrays(int i, int j, int /*delflag*/) override { at(j) = at(i); }
  int pack_exchange(int i, double* to) override {
    const Motion& m = at(i);
    put(m.q, to), put(m.v, to), put(m.omega, to);
    return carried_numbers;
  }
  int unpack_exchange(int i, double* values) override {
    const double* from = values;
    Motion& m = at(i);
    m.q = take_quaternion(from), m.v = take_vector(from), m.omega = take_vector(from);
    return carried_numbers;
  }
  int pack_forward_comm(int n, int* list, double* to, int /*pbc_flag*/, int* /*pbc*/) override {
    for (int k = 0; k < n; ++k) {
      const PoseRow& p = pose[row(list[k])];
      put(p.r, to), put(p.q, to);
    }
    return n * pose_numbers;
  }
  void unpack_forward_comm(int n, int first, double* values) override {
    const double* from = values;
    for (int k = first; k < first + n; ++k) {
      PoseRow& p = pose[row(k)];
      p.r = take_vector(from), p.q = take_quaternion(from);
    }
  }
  int pack_reverse_comm(int n, int first, double* to) override {
    for (int k = first; k < first + n; ++k) {
      const LoadRow& l = load[row(k)];
      put(l.F, to), put(l.M, to);
    }
    return n * load_numbers;
  }
  void unpack_reverse_comm(int n, int* list, double* values) override {
    const double* from = values;
    for (int k = 0; k < n; ++k) {
      LoadRow& l = load[row(list[k])];
      l.F += take_vector(from), l.M += take_vector(from);
    }
  }

  Motion& at(int k) { return carried[static_cast<std::size_t>(k)]; }

  std::vector<Motion> carried;  // of each atom; its position is LAMMPS' own
  // of the message under way
  const std::uint32_t* rows = nullptr;
  PoseRow* pose = nullptr;
  LoadRow* load = nullptr;

 private:
  std::uint32_t row(int k) const { return rows[k]; }
};

double length_of(const Bond& b, const State& s) {
  return norm(s.r[b.j] - s.r[b.i]);
}

}  // namespace

/// Atoms are the particles, numbered from 1. The "type" of a bond is its number, from 1.
struct Domains::Lammps {
  Lammps() {
    std::array<std::string, 5> words{"vbond-lammps", "-log", "none", "-screen", "none"};
    std::array<char*, 5> arguments{};
    std::transform(words.begin(), words.end(), arguments.begin(), [](std::string& w) { return w.data(); });
    lmp =
        std::make_unique<LAMMPS_NS::LAMMPS>(static_cast<int>(words.size()), arguments.data(), MPI_COMM_WORLD);
  }

  void command(const std::string& line) const { lmp->input->one(line); }
  void make_box(const State& state, double margin, std::size_t most_bonds);
  void make_atoms(const Model& model, const State& state) const;
  void make_bonds(const State& state) const;
  /// What LAMMPS does wherever it lists neighbours anew.
  void spread(double longest) const;

  std::unique_ptr<LAMMPS_NS::LAMMPS> lmp;
  FixVbond* fix = nullptr;
  std::int64_t particles = 0;
};

void Domains::Lammps::make_box(const State& state, double margin, std::size_t most_bonds) {
  Vec3d low = state.r[ParticleId{0}], high = low;
  for (const Vec3d& r : state.r)
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
  for (const char* line : {"units lj", "atom_style bond", "atom_modify map yes sort 0 0.0", "newton on",
                           "boundary s s s", "neighbor 0.0 bin"})
    command(line);
  command("region body block" + sides + " units box");
  command("create_box 1 body bond/types 1 extra/bond/per/atom " +
          std::to_string(std::max<std::size_t>(1, most_bonds)));
  command("mass 1 1.0");
  (*lmp->modify->fix_map)["vbond"] = FixVbond::make;
  fix = dynamic_cast<FixVbond*>(lmp->modify->add_fix("body all vbond"));
}

/// In the order of space, as the step loop has them.
void Domains::Lammps::make_atoms(const Model& model, const State& state) const {
  const Order order = spatial_order(model.r_0);
  std::vector<int> id, type(model.particles(), 1);
  std::vector<double> x;
  for (const ParticleId p : order.particle) {
    id.push_back(static_cast<int>(p.value) + 1);
    x.insert(x.end(), {state.r[p].x, state.r[p].y, state.r[p].z});
  }
  lammps_create_atoms(lmp.get(), static_cast<int>(id.size()), id.data(), type.data(), x.data(), nullptr,
                      nullptr, 1);
  for (int k = 0; k < lmp->atom->nlocal; ++k) {
    const ParticleId p{static_cast<std::size_t>(lmp->atom->tag[k] - 1)};
    fix->at(k) = {state.r[p], state.q[p], state.v[p], state.omega[p]};
  }
}

void Domains::Lammps::make_bonds(const State& state) const {
  LAMMPS_NS::Atom& atom = *lmp->atom;
  std::fill_n(atom.num_bond, atom.nlocal, 0);
  for (const BondId b : state.bonds.ids()) {
    if (state.bonds[b].broken) continue;
    ++atom.nbonds;
    const int k = atom.map(static_cast<int>(state.bonds[b].i.value) + 1);
    if (k < 0 || k >= atom.nlocal) continue;
    const int at = atom.num_bond[k]++;
    atom.bond_type[k][at] = static_cast<int>(b.value) + 1;
    atom.bond_atom[k][at] = static_cast<int>(state.bonds[b].j.value) + 1;
  }
}

void Domains::Lammps::spread(double longest) const {
  lmp->comm->cutghostuser = longest * beyond_longest;
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

Domains::Domains(const Model& model, const State& state) : lammps_(std::make_unique<Lammps>()) {
  lammps_->particles = static_cast<std::int64_t>(model.particles());
  double longest = std::numeric_limits<double>::min();
  PerParticle<std::size_t> bonds(model.particles());
  std::size_t most = 0;
  for (const Bond& b : state.bonds) {
    if (b.broken) continue;
    longest = std::max(longest, length_of(b, state));
    most = std::max(most, ++bonds[b.i]);
  }
  const double margin = std::max(longest, 1e-3);
  lammps_->make_box(state, margin, most);
  lammps_->make_atoms(model, state);
  lammps_->make_bonds(state);
  lammps_->lmp->init();
  lammps_->spread(longest);
}

Domains::~Domains() = default;

void Domains::redistribute(const std::vector<Motion>& own, double longest) {
  for (std::size_t k = 0; k < own.size(); ++k) {
    lammps_->fix->carried[k] = own[k];
    for (int d = 0; d < 3; ++d) lammps_->lmp->atom->x[k][d] = component(own[k].r, d);
  }
  // to their new ranks however far they have gone: what follows is for neighbouring domains only
  lammps_->command("displace_atoms all move 0.0 0.0 0.0 units box");
  lammps_->spread(longest);
}

Holding Domains::holding(const PerBond<Bond>& bonds) const {
  LAMMPS_NS::Atom& atom = *lammps_->lmp->atom;
  Holding h;
  for (int k = 0; k < atom.nlocal + atom.nghost; ++k)
    h.particles.push_back(ParticleId{static_cast<std::size_t>(atom.tag[k] - 1)});
  for (int k = 0; k < atom.nlocal; ++k) {
    Motion& m = h.own.emplace_back(lammps_->fix->at(k));
    m.r = {atom.x[k][0], atom.x[k][1], atom.x[k][2]};
    for (int n = 0; n < atom.num_bond[k]; ++n) {
      const BondId bond{static_cast<std::size_t>(atom.bond_type[k][n] - 1)};
      if (bonds[bond].broken) continue;
      const int other = atom.map(atom.bond_atom[k][n]);
      if (other < 0)
        throw std::runtime_error("a rank has no ghost of particle " +
                                 std::to_string(atom.bond_atom[k][n] - 1) + ", which its particle " +
                                 std::to_string(atom.tag[k] - 1) + " is bonded to");
      h.bonds.push_back(
          {bond, ParticleId{static_cast<std::size_t>(k)}, ParticleId{static_cast<std::size_t>(other)}});
    }
  }
  return h;
}

void Domains::send_poses(const std::vector<std::uint32_t>& rows, PoseRow* pose) {
  lammps_->fix->rows = rows.data();
  lammps_->fix->pose = pose;
  lammps_->lmp->comm->forward_comm_fix(lammps_->fix);
}

void Domains::gather_loads(const std::vector<std::uint32_t>& rows, LoadRow* load) {
  lammps_->fix->rows = rows.data();
  lammps_->fix->load = load;
  lammps_->lmp->comm->reverse_comm_fix(lammps_->fix);
}

}  // namespace vbond
