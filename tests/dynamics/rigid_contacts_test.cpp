// Pairs of one rigid body are out of contact, in all that is asked of contacts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <vector>

#include "clouds.hpp"
#include "processes.hpp"
#include "spheres_and_walls.hpp"
#include "vbond/model/contact_bound.hpp"
#include "vbond/model/rigid_bodies.hpp"
#include "vbond/model/stress.hpp"
#include "vbond/model/touching.hpp"

namespace vbond::rigid_contacts_test {
namespace {

using testing::grip;
using testing::Specimen;

constexpr HeldDofs nothing{};
constexpr double k = 1e3, R = 0.5, mass = 1.5;

/// Pairs that repel each other elastically, and those that also rub and damp: two loops.
std::vector<ContactModel> forms() {
  ContactModel plain{.law = ContactLaw::linear, .pairs = ContactPairs::all};
  plain.k = k;
  ContactModel rubbing = testing::linear(k, 0.4, 0.6), unbonded = rubbing;
  unbonded.pairs = ContactPairs::unbonded;
  return {plain, rubbing, unbonded};
}

/// Balls along x, each overlapping the next by this.
Specimen row(std::size_t n, double overlap, const ContactModel& contact) {
  std::vector<Vec3d> r;
  for (std::size_t i = 0; i < n; ++i) r.push_back({static_cast<double>(i) * (2.0 * R - overlap), 0, 0});
  Specimen s{equal_particles(r, mass, 0.15, R), {}};
  s.model.contact = contact;
  s.state = at_rest(s.model);
  return s;
}
std::vector<ParticleId> first(std::size_t n) {
  std::vector<ParticleId> all;
  for (std::size_t p = 0; p < n; ++p) all.push_back(ParticleId{p});
  return all;
}
std::size_t touching(const Model& model, const State& s) {
  std::size_t pairs = 0;
  for_touching_pairs(model, s, [&](ParticleId, ParticleId, const Image&, double) { ++pairs; });
  return pairs;
}
Stage stage_of(const std::vector<Support>& supports, double duration = 0.1) {
  Stage stage = testing::plain_stage(1e-3, duration);
  stage.supports = supports;
  return stage;
}

TEST(RigidContacts, BodyOfOverlappingBallsIsWithoutForceEnergyAndStress) {
  for (const ContactModel& contact : forms())
    for (const HeldDofs& held : {nothing, all_held}) {
      const Specimen s = row(3, 0.1, contact);
      Simulation run(s.model, stage_of({grip(first(3), held)}), s.state);
      run.run();
      EXPECT_EQ(run.energies().contact, 0.0);
      EXPECT_EQ(run.energies().kinetic(), 0.0);
      for (const Vec3d& F : run.loads().F) EXPECT_EQ(norm(F), 0.0);
      EXPECT_EQ(touching(s.model, run.state()), 0u);
      const PerParticle<Tensor> stress = stress_times_volume(s.model, run.state());
      for (const Vec3d& part : stress[ParticleId{1}].row) EXPECT_EQ(norm(part), 0.0);
    }
}

// The ball that is not of the body touches it still, and so do two bodies.
TEST(RigidContacts, BodiesTouchWhatIsNotOfThem) {
  for (const ContactModel& contact : forms()) {
    const Specimen s = row(4, 0.1, contact);
    for (const bool two : {false, true}) {
      std::vector<Support> supports = {grip(first(2), all_held)};
      if (two) supports.push_back(grip({ParticleId{2}, ParticleId{3}}, all_held));
      Simulation run(s.model, stage_of(supports), s.state);
      EXPECT_EQ(touching(s.model, run.state()), two ? 1u : 2u);
      EXPECT_NEAR(run.energies().contact, (two ? 1.0 : 2.0) * 0.5 * k * 0.01, 1e-12);
      EXPECT_NEAR(run.loads().F[ParticleId{1}].x, -k * 0.1, 1e-9);
      EXPECT_EQ(run.loads().F[ParticleId{0}].x, 0.0);
    }
  }
}

TEST(RigidContacts, SupportsThatShareParticlesMakeOneBody) {
  const auto body = [](std::size_t from, std::size_t to) {
    Support s = grip({}, all_held);
    for (std::size_t p = from; p < to; ++p) s.particles.push_back(ParticleId{p});
    return s;
  };
  Support loose = body(8, 10);
  loose.rigid = false;
  const RigidBodies one(10, carried_by({body(0, 3), body(4, 7), body(2, 5), loose}));
  EXPECT_TRUE(one.are_one(ParticleId{0}, ParticleId{6}));
  EXPECT_FALSE(one.are_one(ParticleId{8}, ParticleId{9}));
  EXPECT_FALSE(one.are_one(ParticleId{0}, ParticleId{6}, Image{1, 0, 0}));
  EXPECT_FALSE(one.are_one(ParticleId{0}, ParticleId{7}));
}

// A stage that lets go of a body gives its contacts back: k d^2/2 each, as work of supports; and one that
// takes hold takes them away.
TEST(RigidContacts, EnergyOfContactsThatComeBackIsWorkOfSupports) {
  const double U = 2.0 * 0.5 * k * 0.01;
  for (const ContactModel& contact : forms()) {
    Specimen s = row(3, 0.1, contact);
    State state = s.state;
    for (const bool held : {true, false, true}) {
      const double before = state.books.work_supports;
      const bool begins = state.clock.step == 0;
      Simulation run(s.model,
                     stage_of(held ? std::vector{grip(first(3), nothing)} : std::vector<Support>{}, 0.004),
                     state);
      if (!begins && !held) {
        EXPECT_NEAR(run.energies().contact, U, 1e-12);
        EXPECT_NEAR(run.books().work_supports - before, U, 1e-12);
      }
      run.run();
      EXPECT_LT(std::abs(run.balance_error()), 1e-4) << static_cast<int>(contact.law) << held;
      state = std::move(run).handover().state;
      begin_next_stage(state.clock);
    }
  }
}

// What friction has stored in a pair turns with the body that the pair is of, and is there again afterwards.
TEST(RigidContacts, MemoryOfPairsTurnsWithTheirBody) {
  Specimen s = row(2, 0.1, testing::linear(k, 0.4));
  PairMemory m{.i = ParticleId{0}, .j = ParticleId{1}};
  m.history = {0, 3, 1, 0.2, 5, 6, 7, 8, 0.1, 0.2, 0.3, 0.4}, m.kept = 0.02;
  s.state.contact_history = {m};
  State& state = s.state;
  take_hold(s.model, {grip(first(2), nothing)}, state);
  const State taken = state;
  take_hold(s.model, {grip(first(2), nothing)}, state);
  EXPECT_EQ(state, taken);  // once
  const Quatd turn = rotation_of({0.3, -0.7, 1.9});
  for (Vec3d& r : state.r) r = rotate(turn, r);
  for (Quatd& q : state.q) q = turn * q;
  take_hold(s.model, {}, state);
  ASSERT_EQ(state.contact_history.size(), 1u);
  const PairHistory now = state.contact_history[0].history;
  const Vec3d F_t = rotate(turn, Vec3d{0, 3, 1}), M_r = rotate(turn, Vec3d{0.1, 0.2, 0.3});
  EXPECT_LT(norm(Vec3d{now[0], now[1], now[2]} - F_t), 1e-14);
  EXPECT_LT(norm(Vec3d{now[8], now[9], now[10]} - M_r), 1e-14);
  EXPECT_EQ(norm(Vec3d{now[4], now[5], now[6]}), 0.0);  // of a step long ago
  EXPECT_EQ(now[3], 0.2);
  EXPECT_EQ(state.contact_history[0].kept, 0.02);
  EXPECT_NEAR(state.books.work_supports, 0.0, 1e-12);  // as much as was taken
}

// Parts that know the memories of their own pairs alone book together what one machine books.
TEST(RigidContacts, PartsBookTogetherWhatTheBodyTakesHoldOf) {
  for (const std::size_t parts : {2u, 3u}) {
    Specimen s = row(6, 0.1, testing::linear(k, 0.4));
    for (std::size_t i = 0; i + 1 < 6; ++i) {
      PairMemory m{.i = ParticleId{i}, .j = ParticleId{i + 1}};
      m.history = {0, 3, 1, 0.2, 5, 6, 7, 8, 0.1, 0.2, 0.3, 0.4};
      s.state.contact_history.push_back(m);
    }
    const std::vector<Support> held{grip(first(5), nothing)};
    State whole = s.state;
    take_hold(s.model, held, whole);
    ASSERT_NE(whole.books.work_supports, 0.0);
    testing::Meeting meeting(parts);
    std::vector<State> of_part(parts, s.state);
    std::vector<std::thread> threads;
    for (std::size_t part = 0; part < parts; ++part)
      threads.emplace_back([&, part] {
        const testing::Process process(meeting, part);
        const auto has = [&](ParticleId p) { return p.value % parts == part; };
        std::erase_if(of_part[part].contact_history, [&](const PairMemory& m) { return !has(m.i); });
        take_hold(s.model, held, of_part[part], has, process);
      });
    for (std::thread& t : threads) t.join();
    for (const State& state : of_part) {
      EXPECT_NEAR(state.books.work_supports, whole.books.work_supports,
                  1e-14 * std::abs(whole.books.work_supports));
      for (const PairMemory& m : state.contact_history) EXPECT_TRUE(m == whole.contact_history[m.i.value]);
    }
  }
}

// Overlap that a pair does not feel it does not feel after its time in a body either; a checkpoint within
// that time changes nothing.
TEST(RigidContacts, OverlapThatIsKeptStaysKept) {
  ContactModel contact = testing::linear(k, 0.4);
  contact.pairs = ContactPairs::unbonded, contact.keeps_overlap = true;
  Specimen s = row(2, 0.1, contact);
  s.state.contact_history = {{.i = ParticleId{0}, .j = ParticleId{1}, .kept = 0.1}};
  Simulation in_body(s.model, stage_of({grip(first(2), nothing)}, 0.02), s.state);
  in_body.run();
  Simulation resumed(s.model, stage_of({grip(first(2), nothing)}, 0.04), in_body.state());
  resumed.run();
  State state = std::move(resumed).handover().state;
  ASSERT_EQ(state.contact_history.size(), 1u);
  begin_next_stage(state.clock);
  Simulation free(s.model, stage_of({}, 0.1), state);
  free.run();
  EXPECT_LT(norm(free.state().v[ParticleId{0}]), 1e-12);
  EXPECT_LT(free.energies().contact, 1e-20);
}

TEST(RigidContacts, StepBoundCountsNoContactWithinABody) {
  const Specimen s = row(5, 0.4, forms()[0]);
  const std::vector<Support> one = {grip(first(5), nothing)};
  const double free = contact_bound(s.model, s.state, {}, {}, 1.0, {}).lambda;
  EXPECT_DOUBLE_EQ(free, 2.0 * 2.0 * k / mass);  // two neighbours
  EXPECT_DOUBLE_EQ(contact_bound(s.model, s.state, {}, {}, 1.0, one).lambda, 2.0 * k / mass);  // one to come
}

}  // namespace
}  // namespace vbond::rigid_contacts_test
