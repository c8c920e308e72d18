#include "bond_vbond.hpp"

#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <fix_bond_history.h>
#include <force.h>
#include <memory.h>
#include <modify.h>
#include <neighbor.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <optional>

#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/bond_list.hpp"

namespace vbond {
namespace {

using LAMMPS_NS::tagint;

// What is stored of a bond: its length, as LAMMPS' package BPM wants it first, ...
constexpr int at_length = 0;
constexpr int at_reversed = 1;  // whether its first particle has the larger id
constexpr int at_attachment = 2, at_frames = 4, at_coefficients = 12;
constexpr int stored_numbers = at_coefficients + static_cast<int>(most_coefficients);

Vec3d vector(const double* x) {
  return {x[0], x[1], x[2]};
}
Quatd quaternion(const double* q) {
  return {q[0], q[1], q[2], q[3]};
}

Team one_thread(std::size_t rows) {
  return {rows, std::vector<std::size_t>((rows + block_rows - 1) / block_rows, block_rows), 1};
}

void add(const Vec3d& x, double* to) {
  to[0] += x.x, to[1] += x.y, to[2] += x.z;
}

}  // namespace

BondVbond::BondVbond(LAMMPS_NS::LAMMPS* lmp) : BondBPM(lmp) {
  nhistory = stored_numbers;
  id_fix_bond_history = LAMMPS_NS::utils::strdup("HISTORY_VBOND");
}

BondVbond::~BondVbond() {
  if (allocated && !copymode) memory->destroy(setflag);
}

void BondVbond::allocate() {
  allocated = 1;
  types_.resize(static_cast<std::size_t>(atom->nbondtypes) + 1);
  memory->create(setflag, atom->nbondtypes + 1, "bond:setflag");
  std::fill_n(setflag, atom->nbondtypes + 1, 0);
}

void BondVbond::settings(int narg, char** arg) {
  BondBPM::settings(narg, arg);
  for (std::size_t k = 0; k < leftover_iarg.size(); k += 2) {
    const int at = leftover_iarg[k];
    const std::string key = arg[at];
    if (key != "bonds")
      error->all(FLERR,
                 "Unknown keyword {} of bond_style vbond: it may be bonds, "
                 "break, overlay/pair or store/local",
                 key);
    if (at + 1 >= narg) LAMMPS_NS::utils::missing_cmd_args(FLERR, "bond_style vbond bonds", error);
    file_ = arg[at + 1];
  }
}

/// TYPE LAW Kr Ks Kt Kb [strength Fr Fs Tt Tb] [damping gr gs gt gb], or TYPE listed.
void BondVbond::coeff(int narg, char** arg) {
  if (!allocated) allocate();
  if (narg < 2) error->all(FLERR, "bond_coeff of bond_style vbond: give a law and Kr Ks Kt Kb, or listed");
  BondRecipe recipe;
  if (std::strcmp(arg[1], "listed") == 0) {
    if (file_.empty()) error->all(FLERR, "bond_coeff listed: bond_style vbond names no file of bonds");
    if (narg != 2) error->all(FLERR, "bond_coeff listed: nothing may stand behind it");
  } else {
    const auto number = [&](int k) { return LAMMPS_NS::utils::numeric(FLERR, arg[k], false, lmp); };
    const auto named = named_laws();
    const auto law =
        std::find_if(named.begin(), named.end(), [&](const BondLaw* l) { return l->name == arg[1]; });
    if (law == named.end()) error->all(FLERR, "bond_coeff: vbond has no law of bonds named {}", arg[1]);
    if (narg < 6) error->all(FLERR, "bond_coeff {}: the stiffnesses Kr Ks Kt Kb are missing", arg[1]);
    recipe.law = *law;
    const BondStiffness<double> c{number(2), number(3), number(5), number(4)};
    if (!(c.c_A > 0.0 && c.c_D > 0.0 && c.c_B > 0.0 && c.c_T > 0.0))
      error->all(FLERR, "bond_coeff {}: Kr, Ks, Kt and Kb must be > 0", arg[1]);
    recipe.parameters = c;
    for (int k = 6; k < narg; k += 5) {
      const std::string key = arg[k];
      if (k + 4 >= narg) LAMMPS_NS::utils::missing_cmd_args(FLERR, "bond_coeff " + key, error);
      const double x[] = {number(k + 1), number(k + 2), number(k + 3), number(k + 4)};
      const double least = *std::min_element(x, x + 4);
      if (key == "strength") {
        if (!(least > 0.0)) error->all(FLERR, "bond_coeff strength: Fr, Fs, Tt and Tb must be > 0");
        recipe.rules.strength = linear_strength(x[0], x[1], x[3], x[2]);
      } else if (key == "damping") {
        if (!(least >= 0.0)) error->all(FLERR, "bond_coeff damping: gr, gs, gt and gb must be >= 0");
        recipe.damping = {DampingBy::coefficients, {x[0], x[1], x[3], x[2]}};
      } else {
        error->all(FLERR, "Unknown keyword {} of bond_coeff: it may be strength or damping", key);
      }
    }
  }
  int first = 0, last = 0;
  LAMMPS_NS::utils::bounds(FLERR, arg[0], 1, atom->nbondtypes, first, last, error);
  for (int type = first; type <= last; ++type) {
    types_[static_cast<std::size_t>(type)] = recipe;
    setflag[type] = 1;
  }
}

void BondVbond::init_style() {
  BondBPM::init_style();
  // LAMMPS of 4 July 2026 lists them before it makes ours: what is stored would not follow bonds that break
  histories = modify->get_fix_by_style("BOND_HISTORY");
  n_histories = static_cast<int>(histories.size());
  if (!atom->quat_flag || !atom->omega_flag || !atom->torque_flag)
    error->all(FLERR, "bond_style vbond needs quaternions of atoms: use atom_style bpm/sphere");
  if (comm->ghost_velocity == 0)
    error->all(FLERR, "bond_style vbond needs the quaternions of ghost atoms: use comm_modify vel yes");
  arranged_ = -1;
}

// ---- what is stored of each bond --------------------------------------------------------------------------

void BondVbond::store(int i, int place, const vbond::Bond& b, bool first_has_larger_id) {
  std::array<double, stored_numbers> numbers{};
  numbers[at_length] = b.a;
  numbers[at_reversed] = first_has_larger_id ? 1.0 : 0.0;
  numbers[at_attachment] = b.R_i, numbers[at_attachment + 1] = b.R_j;
  double* to = &numbers[at_frames];
  for (const Quatd& q : {b.frame_i, frame_j(b)})
    for (const double x : {q.w, q.x, q.y, q.z}) *to++ = x;
  const vbond::Coefficients coefficients = b.coefficients;
  std::copy(coefficients.begin(), coefficients.end(), to);
  for (int k = 0; k < stored_numbers; ++k)
    fix_bond_history->update_atom_value(i, place, k, numbers[static_cast<std::size_t>(k)]);
}

/// The bond, without its particles.
vbond::Bond BondVbond::stored(const double* numbers, int type) const {
  const BondRecipe& recipe = types_[static_cast<std::size_t>(type)];
  vbond::Bond b;
  b.law = recipe.has_rules() ? with_rules(*recipe.law, recipe.rules) : recipe.law;
  BondRules rules = recipe.rules;
  rules.damped = recipe.damping.by != DampingBy::none;
  b.rules = b.law->has_rules ? &kept(rules) : &no_rules;
  b.a = numbers[at_length];
  b.R_i = numbers[at_attachment], b.R_j = numbers[at_attachment + 1];
  set_frames(b, quaternion(numbers + at_frames), quaternion(numbers + at_frames + 4));
  vbond::Coefficients coefficients;
  std::copy_n(numbers + at_coefficients, coefficients.size(), coefficients.begin());
  b.coefficients = coefficients;
  return b;
}

void BondVbond::store_data() {
  if (!file_.empty()) store_from_file();
  store_as_they_stand();
}

/// Every rank reads all bonds and keeps those of its atoms.
void BondVbond::store_from_file() {
  BondList list;
  try {
    list = read_bond_list(file_);
  } catch (const std::exception& e) {
    error->all(FLERR, "{}", e.what());
  }
  if (list.kinds.size() > static_cast<std::size_t>(atom->nbondtypes))
    error->all(FLERR, "{} has {} kinds of bonds, but there are {} bond types", file_, list.kinds.size(),
               atom->nbondtypes);
  for (std::size_t k = 0; k < list.kinds.size(); ++k) {
    if (list.kinds[k].law->remembers())
      error->all(FLERR,
                 "{}: bonds of the law {} remember what they went through: bond_style vbond cannot "
                 "do this yet",
                 file_, list.kinds[k].law->name);
    BondRecipe& recipe = types_[k + 1];
    recipe.law = list.kinds[k].law, recipe.rules = *list.kinds[k].rules;
    recipe.damping.by = recipe.rules.damped ? DampingBy::coefficients : DampingBy::none;
  }
  for (std::size_t n = 0; n < list.bonds.size(); ++n) {
    const vbond::Bond& b = list.bonds[n];
    const std::array<tagint, 2> ids{static_cast<tagint>(b.i.value) + 1, static_cast<tagint>(b.j.value) + 1};
    for (const std::size_t end : {0u, 1u}) {
      const int i = atom->map(ids[end]);
      if (i < 0 || i >= atom->nlocal) continue;
      for (int place = 0; place < atom->num_bond[i]; ++place)
        if (atom->bond_atom[i][place] == ids[1 - end] &&
            atom->bond_type[i][place] == static_cast<int>(list.kind[n]) + 1)
          store(i, place, b, ids[0] > ids[1]);
    }
  }
}

/// Bonds that have no constants yet are made of the particles as they are now.
void BondVbond::store_as_they_stand() {
  for (int i = 0; i < atom->nlocal; ++i)
    for (int place = 0; place < atom->num_bond[i]; ++place) {
      const int type = atom->bond_type[i][place];
      if (type <= 0 || !setflag[type] || fix_bond_history->get_atom_value(i, place, at_length) > 0.0)
        continue;
      const tagint other = atom->bond_atom[i][place];
      if (!file_.empty())
        error->one(FLERR, "{} has no bond of type {} between {} and {}", file_, type, atom->tag[i], other);
      int j = atom->map(other);
      if (j < 0) error->one(FLERR, "Atom {} of a bond of bond_style vbond is missing", other);
      j = domain->closest_image(i, j);
      const auto site = [this](int k) {
        return BondSite{ParticleId{static_cast<std::size_t>(atom->tag[k])}, vector(atom->x[k]),
                        quaternion(atom->quat[k]), atom->radius[k]};
      };
      const bool in_order = atom->tag[i] < other;
      const auto bond =
          make_bond(types_[static_cast<std::size_t>(type)], site(in_order ? i : j), site(in_order ? j : i));
      if (!bond) error->one(FLERR, "Atoms {} and {} of a bond stand at one place", atom->tag[i], other);
      store(i, place, *bond, false);
    }
}

// ---- loads ------------------------------------------------------------------------------------------------

/// LAMMPS has listed its bonds anew: so do the packs.
void BondVbond::arrange() {
  const auto rows = filled_up(static_cast<std::size_t>(atom->nlocal + atom->nghost));
  pose_.assign(rows, {}), rates_.assign(rows, {}), load_.assign(rows, {}), damping_.assign(rows, {});
  state_.bonds = {};
  listed_.clear();
  for (int n = 0; n < neighbor->nbondlist; ++n) {
    const int* listed = neighbor->bondlist[n];
    if (listed[2] <= 0) continue;
    const double* numbers = fix_bond_history->bondstore[n];
    if (!(numbers[at_length] > 0.0))
      error->one(FLERR,
                 "The bond of {} and {} was made after the first step: bond_style vbond cannot do this",
                 atom->tag[listed[0]], atom->tag[listed[1]]);
    vbond::Bond b = stored(numbers, listed[2]);
    const bool in_order = (atom->tag[listed[0]] < atom->tag[listed[1]]) != (numbers[at_reversed] != 0.0);
    b.i = ParticleId{static_cast<std::size_t>(listed[in_order ? 0 : 1])};
    b.j = ParticleId{static_cast<std::size_t>(listed[in_order ? 1 : 0])};
    state_.bonds.push_back(b);
    listed_.push_back(n);
  }
  Order order;
  PerParticle<Row> own(rows);
  for (std::size_t row = 0; row < rows; ++row)
    own[ParticleId{row}] = Row{row}, order.particle.push_back(ParticleId{row});
  order.row = RowOf(std::move(own));
  order.own = order.known = rows;  // LAMMPS lists a bond where it is to be worked out
  packs_.arrange(state_, order, one_thread(rows));
  arranged_ = neighbor->lastcall;
}

void BondVbond::take_poses() {
  for (int i = 0; i < atom->nlocal + atom->nghost; ++i) {
    PoseRow& p = pose_[static_cast<std::size_t>(i)];
    p.r = vector(atom->x[i]), p.q = quaternion(atom->quat[i]);
  }
  if (!packs_.reads_rates()) return;
  for (int i = 0; i < atom->nlocal + atom->nghost; ++i) {
    MotionRow& m = rates_[static_cast<std::size_t>(i)];
    m.v = vector(atom->v[i]), m.omega = vector(atom->omega[i]);
  }
}

void BondVbond::compute(int eflag, int vflag) {
  pre_compute();
  ev_init(eflag, vflag);
  if (arranged_ != neighbor->lastcall) arrange();
  take_poses();
  std::fill(load_.begin(), load_.end(), LoadRow{});
  breaking_.clear();
  const Team team = one_thread(load_.size());
  for (const Part& part : team.parts()) {
    BondSweep sweep{part.rows, pose_.data(), load_.data(), rates_.data(), damping_.data()};
    for (std::size_t b = part.first_block; b < part.last_block; ++b)
      packs_.add_loads(team.block(b), sweep, {}, break_flag ? &breaking_ : nullptr);
  }
  add_to_forces();
  if (evflag) tally();
  take_out_broken();
  post_compute();
}

void BondVbond::add_to_forces() {
  const int atoms = force->newton_bond ? atom->nlocal + atom->nghost : atom->nlocal;
  for (int i = 0; i < atoms; ++i) {
    const LoadRow& l = load_[static_cast<std::size_t>(i)];
    add(l.F, atom->f[i]), add(l.M, atom->torque[i]);
  }
}

/// Energy and virial, bond by bond, in the steps that ask for them.
void BondVbond::tally() {
  for (const BondId id : state_.bonds.ids()) {
    const vbond::Bond& b = state_.bonds[id];
    if (b.broken) continue;
    const PoseRow &i = pose_[b.i.value], &j = pose_[b.j.value];
    const BondPose<double> pose = bond_pose(b, between(i, j), i.q, j.q);
    const BondEnergy<double> U = b.law->energy(b, pose, no_history);
    const Vec3d F = b.law->loads(b, pose, no_history).F;
    const Vec3d d = between(j, i);
    ev_tally_xyz(static_cast<int>(b.i.value), static_cast<int>(b.j.value), atom->nlocal, force->newton_bond,
                 U.U_L + U.U_B + U.U_T, F.x, F.y, F.z, d.x, d.y, d.z);
  }
}

void BondVbond::take_out_broken() {
  std::sort(breaking_.begin(), breaking_.end());
  for (const BondId id : breaking_) {
    vbond::Bond& b = state_.bonds[id];
    b.broken = true;
    packs_.remove(id);
    neighbor->bondlist[listed_[id.value]][2] = 0;
    int i = static_cast<int>(b.i.value), j = static_cast<int>(b.j.value);
    if (atom->tag[j] < atom->tag[i]) std::swap(i, j);  // as the package wants it
    process_broken(i, j);
  }
}

/// Energy of one bond for compute bond/local, and the axial force by its length.
double BondVbond::single(int type, double rsq, int i, int j, double& fforce) {
  fforce = 0.0;
  if (type <= 0) return 0.0;
  for (const BondId id : state_.bonds.ids()) {
    const vbond::Bond& b = state_.bonds[id];
    const auto is = [&](int k, ParticleId p) { return atom->tag[k] == atom->tag[static_cast<int>(p.value)]; };
    if (b.broken || !((is(i, b.i) && is(j, b.j)) || (is(i, b.j) && is(j, b.i)))) continue;
    const auto r = [this](ParticleId p) { return vector(atom->x[p.value]); };
    const auto q = [this](ParticleId p) { return quaternion(atom->quat[p.value]); };
    const BondPose<double> pose = bond_pose(b, between(r(b.i), r(b.j)), q(b.i), q(b.j));
    const BondEnergy<double> U = b.law->energy(b, pose, no_history);
    fforce = dot(b.law->loads(b, pose, no_history).F, between(r(b.j), r(b.i))) / rsq;
    return U.U_L + U.U_B + U.U_T;
  }
  return 0.0;
}

// ---- restart files ----------------------------------------------------------------------------------------

void BondVbond::write_restart(FILE* file) {
  BondBPM::write_restart(file);
  write_restart_settings(file);
}
void BondVbond::read_restart(FILE* file) {
  BondBPM::read_restart(file);
  read_restart_settings(file);
}

namespace {

/// What a restart file holds of a bond type.
struct StoredType {
  char law[64]{};
  BondStiffness<double> stiffness{};
  double damping[4]{};
  RuleNumbers rules{};
};

}  // namespace

void BondVbond::write_restart_settings(FILE* file) {
  for (std::size_t type = 1; type < types_.size(); ++type) {
    const BondRecipe& recipe = types_[type];
    StoredType s;
    std::strncpy(s.law, recipe.law->name.data(), std::min(sizeof s.law - 1, recipe.law->name.size()));
    if (const auto* c = std::get_if<BondStiffness<double>>(&recipe.parameters)) s.stiffness = *c;
    std::copy(recipe.damping.values.begin(), recipe.damping.values.end(), s.damping);
    BondRules rules = recipe.rules;
    rules.damped = recipe.damping.by != DampingBy::none;
    s.rules = numbers_of(rules);
    fwrite(&s, sizeof s, 1, file);
  }
}

void BondVbond::read_restart_settings(FILE* file) {
  allocate();
  for (std::size_t type = 1; type < types_.size(); ++type) {
    StoredType s;
    if (comm->me == 0) LAMMPS_NS::utils::sfread(FLERR, &s, sizeof s, 1, file, nullptr, error);
    MPI_Bcast(&s, sizeof s, MPI_BYTE, 0, world);
    const auto rules = rules_of(s.rules);
    BondRecipe& recipe = types_[type];
    recipe.law = find_law(s.law);
    if (!recipe.law || !rules) error->all(FLERR, "The restart file has bonds that vbond does not know");
    recipe.parameters = s.stiffness;
    recipe.rules = *rules;
    recipe.damping.by = rules->damped ? DampingBy::coefficients : DampingBy::none;
    std::copy(std::begin(s.damping), std::end(s.damping), recipe.damping.values.begin());
    recipe.rules.damped = false;  // it follows from the damping
    setflag[type] = 1;
  }
}

}  // namespace vbond
