#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "rods.hpp"
#include "teams.hpp"
#include "vbond/dynamics/contacts.hpp"

namespace vbond {
namespace {

using testing::Dice;

constexpr ContactModel elastic{ContactLaw::hertz, ContactPairs::all, 0, 1, 1.0, 0.3};
constexpr ContactModel papers{ContactLaw::paper_hertz, ContactPairs::all, 1.0, 1.0, 0, 0};

/// 6 x 6 x 6 particles at random near the points of a lattice: some touch, some do not.
struct Heap {
  Model model;
  Order order;
  std::vector<PoseRow> pose;
  BondIndex no_bonds;
  Team team = testing::team_of(1, 216);

  Heap(const ContactModel& contact, double R_min, unsigned seed = 1) {
    Dice dice(seed);
    std::vector<Vec3d> r;
    for (int x = 0; x < 6; ++x)
      for (int y = 0; y < 6; ++y)
        for (int z = 0; z < 6; ++z)
          r.push_back({x + dice(-0.2, 0.2), y + dice(-0.2, 0.2), z + dice(-0.2, 0.2)});
    model = equal_particles(r, 1.0, 0.1, 0.55);
    model.contact = contact;
    for (double& R : model.radius) R = dice(R_min, 0.55);
    order = spatial_order(model.r_0);
    pose.resize(r.size());
    for (const ParticleId p : model.r_0.ids()) pose[order.row[p].value].r = r[p.value];
    no_bonds = BondIndex(order, {});
  }

  Bodies bodies() const {
    Bodies b(model);
    std::copy(pose.begin(), pose.end(), b.pose.begin());
    return b;
  }
  double R(std::size_t k) const { return model.radius[order.particle[Row{k}]]; }
  /// Every pair, in increasing order of rows.
  std::vector<LoadRow> by_brute_force() const {
    std::vector<LoadRow> load(pose.size());
    for (std::size_t i = 0; i < pose.size(); ++i)
      for (std::size_t j = 0; j < pose.size(); ++j) {
        const Vec3d r_ij = pose[j].r - pose[i].r;
        if (i == j || norm2(r_ij) >= sq(R(i) + R(j))) continue;
        const double f = contact_force(contact_law(model.contact, R(i), R(j)), R(i) + R(j) - norm(r_ij));
        load[i].F -= (f / norm(r_ij)) * r_ij;
      }
    return load;
  }
  /// By `contacts`, in pieces of so many rows.
  std::vector<LoadRow> in_pieces(Contacts& contacts, std::size_t rows) const {
    std::vector<LoadRow> load(pose.size());
    for (std::size_t k = 0; k < load.size(); k += rows)
      contacts.add_loads({k, std::min(load.size(), k + rows)}, pose.data(), load.data());
    return load;
  }
};

void expect_same_bits(const std::vector<LoadRow>& a, const std::vector<LoadRow>& b) {
  ASSERT_EQ(a.size(), b.size());
  std::size_t loaded = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].F, b[k].F) << k;
    EXPECT_EQ(a[k].M, Vec3d{}) << k;
    loaded += norm2(a[k].F) > 0.0 ? 1u : 0u;
  }
  EXPECT_GT(loaded, a.size() / 4);  // else nothing was compared
}

// Equal radii, one law for all pairs although radii differ, and a law for each pair: to the bit, however rows
// are shared out, with every instruction set.
TEST(Contacts, HaveTheBitsOfTheSumOverAllPairsInAnyPieces) {
  for (const StepKernel* kernel : available_kernels())
    for (const ContactModel& contact : {elastic, papers})
      for (const double R_min : {0.55, 0.4}) {
        SCOPED_TRACE(kernel->name);
        const Heap heap(contact, R_min);
        Contacts contacts(heap.model, heap.order, heap.no_bonds, *kernel);
        contacts.refresh(heap.pose, heap.team);
        for (const std::size_t rows : {1u, 7u, 128u, 1000u})
          expect_same_bits(heap.in_pieces(contacts, rows), heap.by_brute_force());
      }
}

// A row's list may fill its lanes or leave any number of them to rows that are not its neighbours.
TEST(Contacts, AreThoseOfTheListWithAnyNumberOfNeighbours) {
  for (const StepKernel* kernel : available_kernels())
    for (std::size_t n = 2; n < 22; ++n) {
      SCOPED_TRACE(kernel->name + std::string(", particles: ") + std::to_string(n));
      Heap heap(elastic, 0.4);
      for (std::size_t k = 0; k < heap.pose.size(); ++k)  // one crowd, the others beside it in threes
        heap.pose[k].r = k < n
                             ? 0.05 * heap.pose[k].r
                             : Vec3d{100.0 + static_cast<double>(k / 3), 0.3 * static_cast<double>(k % 3), 0};
      Contacts contacts(heap.model, heap.order, heap.no_bonds, *kernel);
      contacts.refresh(heap.pose, heap.team);
      expect_same_bits(heap.in_pieces(contacts, 128), heap.by_brute_force());
    }
}

// Deep is said of rows that have such a pair, and of no others, whatever their neighbours' lists hold.
TEST(Contacts, SayWhichRowsAreDeep) {
  for (const StepKernel* kernel : available_kernels())
    for (const double R_min : {0.55, 0.4}) {
      const Heap heap(elastic, R_min);
      Contacts contacts(heap.model, heap.order, heap.no_bonds, *kernel);
      contacts.refresh(heap.pose, heap.team);
      std::vector<LoadRow> load(heap.pose.size());
      std::size_t deep_rows = 0;
      for (std::size_t i = 0; i < heap.pose.size(); ++i) {
        bool deep = false;
        for (std::size_t j = 0; j < heap.pose.size(); ++j)
          deep |= j != i && norm(heap.pose[j].r - heap.pose[i].r) < deep_part * (heap.R(i) + heap.R(j));
        EXPECT_EQ(contacts.add_loads({i, i + 1}, heap.pose.data(), load.data()), deep) << kernel->name << i;
        deep_rows += deep;
      }
      EXPECT_GT(deep_rows, 3u);
      EXPECT_LT(deep_rows, heap.pose.size() - 3);
    }
}

// What is not a number is not left out: the load check must see it.
TEST(Contacts, PassOnWhatIsNotANumber) {
  for (const StepKernel* kernel : available_kernels()) {
    Heap heap(elastic, 0.4);
    Contacts contacts(heap.model, heap.order, heap.no_bonds, *kernel);
    contacts.refresh(heap.pose, heap.team);
    heap.pose[100].r.y = NAN;
    const std::vector<LoadRow> load = heap.in_pieces(contacts, 128);
    EXPECT_TRUE(std::isnan(load[100].F.y)) << kernel->name;
  }
}

// A resumed run builds its list elsewhere than the undisturbed one.
TEST(Contacts, HaveBitsThatDoNotTellWhenTheListWasBuilt) {
  Heap heap(elastic, 0.4);
  Contacts contacts(heap.model, heap.order, heap.no_bonds);
  Dice dice(3);
  for (int move = 0; move < 20; ++move) {
    contacts.refresh(heap.pose, heap.team);
    expect_same_bits(heap.in_pieces(contacts, 50), heap.by_brute_force());
    for (PoseRow& p : heap.pose) p.r += Vec3d{dice(-0.02, 0.02), dice(-0.02, 0.02), dice(-0.02, 0.02)};
  }
}

// More neighbours than are evaluated together: everybody in one place but for a little.
TEST(Contacts, CountEveryNeighbourInACrowd) {
  for (const StepKernel* kernel : available_kernels()) {
    Heap heap(elastic, 0.4);
    for (PoseRow& p : heap.pose) p.r = 0.05 * p.r;
    Contacts contacts(heap.model, heap.order, heap.no_bonds, *kernel);
    contacts.refresh(heap.pose, heap.team);
    expect_same_bits(heap.in_pieces(contacts, 128), heap.by_brute_force());
  }
}

// F = -dU/dr. Central differences of step h are wrong by h^2/6 U''' and by 1e-16 U/h; the third derivative
// of delta^(5/2) goes as delta^(-1/2), so only pairs with less overlap than h spoil it, by h^(3/2).
TEST(Contacts, ForceIsTheGradientOfTheEnergy) {
  Heap heap(elastic, 0.4);
  Contacts contacts(heap.model, heap.order, heap.no_bonds);
  contacts.refresh(heap.pose, heap.team);
  const std::vector<LoadRow> load = heap.in_pieces(contacts, 128);
  const double h = 1e-6;
  for (std::size_t k = 0; k < heap.pose.size(); k += 11)
    for (int c = 0; c < 3; ++c) {
      double& x = component(heap.pose[k].r, c);
      const double x_0 = x;
      x = x_0 + h;
      const double above = contacts.energy(heap.bodies());
      x = x_0 - h;
      const double below = contacts.energy(heap.bodies());
      x = x_0;
      EXPECT_NEAR(component(load[k].F, c), -(above - below) / (2.0 * h), 1e-8) << k;
    }
}

TEST(Contacts, LeaveOutBondedPairsIfToldSo) {
  Heap heap(elastic, 0.4);
  heap.model.contact.pairs = ContactPairs::unbonded;
  BondIndex index = heap.no_bonds;
  Contacts contacts(heap.model, heap.order, index);
  contacts.refresh(heap.pose, heap.team);
  const std::vector<LoadRow> before = heap.in_pieces(contacts, 128);
  expect_same_bits(before, heap.by_brute_force());

  Bond bond;  // of the first two that touch
  for (std::size_t i = 0; i < heap.pose.size() && bond.i == bond.j; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (norm(heap.pose[j].r - heap.pose[i].r) < heap.R(i) + heap.R(j) - 0.05)
        bond.i = heap.order.particle[Row{i}], bond.j = heap.order.particle[Row{j}];
  ASSERT_NE(bond.i, bond.j);
  index = BondIndex(heap.order, {bond});
  contacts.bonds_changed();
  contacts.refresh(heap.pose, heap.team);
  const std::vector<LoadRow> after = heap.in_pieces(contacts, 128);
  for (const Row k : heap.order.particle.ids()) {
    const ParticleId p = heap.order.particle[k];
    EXPECT_EQ(before[k.value].F == after[k.value].F, p != bond.i && p != bond.j);
  }
}

TEST(Contacts, WithoutALawThereAreNone) {
  const Heap heap({}, 0.4);
  Contacts contacts(heap.model, heap.order, heap.no_bonds);
  EXPECT_FALSE(contacts.any());
  contacts.refresh(heap.pose, heap.team);
  EXPECT_EQ(heap.in_pieces(contacts, 128)[0].F, Vec3d{});
  EXPECT_EQ(contacts.energy(heap.bodies()), 0.0);
  const Heap touching(papers, 0.4);
  EXPECT_TRUE(Contacts(touching.model, touching.order, touching.no_bonds).any());
}

}  // namespace
}  // namespace vbond
