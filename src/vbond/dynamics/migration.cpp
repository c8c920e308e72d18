#include "vbond/dynamics/migration.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>

#include "vbond/dynamics/gather.hpp"
#include "vbond/dynamics/owned_columns.hpp"

namespace vbond {
namespace {

template <class T>
using OfEach = std::vector<std::vector<T>>;  // of each part, or for it

template <class T>
OfEach<T> for_each_of(const Communicator& all) {
  return OfEach<T>(static_cast<std::size_t>(all.ranks()));
}

/// What a state and a model have of some particles alone; what they have of all stays.
template <class Visit>
void for_each_partial_column(State& state, Model& model, Visit visit) {
  const auto visit_partial = [&visit](auto& column) {
    if (!column.holds_all()) visit(column);
  };
  for_each_owned_column<ParticleId>(state, visit_partial);
  for_each_shared_column(model, visit_partial);
}

/// What belongs to the particles in `out` goes to each part, and comes of those in `in`; from then on these
/// particles are held.
void send(const OfEach<ParticleId>& out, const OfEach<ParticleId>& in,
          const std::shared_ptr<const IdSet<ParticleId>>& held, State& state, Model& model,
          const Communicator& all) {
  OfEach<std::byte> bytes(out.size());
  for_each_partial_column(state, model, [&](const auto& column) {
    for (std::size_t k = 0; k < out.size(); ++k)
      for (const ParticleId p : out[k]) {
        const auto* of_p = reinterpret_cast<const std::byte*>(&column[p]);
        bytes[k].insert(bytes[k].end(), of_p, of_p + sizeof(column[p]));
      }
  });
  bytes = all.swap(bytes);
  std::vector<const std::byte*> next;
  for (const std::vector<std::byte>& b : bytes) next.push_back(b.data());
  for_each_partial_column(state, model, [&](auto& column) {
    using Value = std::remove_reference_t<decltype(*column.data())>;
    static_assert(std::is_trivially_copyable_v<Value>);
    column.hold(held);
    for (std::size_t k = 0; k < in.size(); ++k)
      for (const ParticleId p : in[k]) {
        std::memcpy(&column[p], next[k], sizeof(Value));
        next[k] += sizeof(Value);
      }
  });
}

/// Particles and the parts that they go to.
class Leaving {
 public:
  Leaving(std::vector<ParticleId> particles, std::vector<int> to)
      : particles_(std::move(particles)), to_(std::move(to)) {}

  std::optional<std::size_t> goes_to(ParticleId p) const {
    const auto at = std::lower_bound(particles_.begin(), particles_.end(), p);
    if (at == particles_.end() || *at != p) return std::nullopt;
    return static_cast<std::size_t>(to_[static_cast<std::size_t>(at - particles_.begin())]);
  }
  OfEach<ParticleId> for_each_part(const Communicator& all) const {
    auto of_each = for_each_of<ParticleId>(all);
    for (std::size_t k = 0; k < particles_.size(); ++k)
      of_each[static_cast<std::size_t>(to_[k])].push_back(particles_[k]);
    return of_each;
  }

 private:
  std::vector<ParticleId> particles_;  // increasing
  std::vector<int> to_;
};

/// Rows go with the first particles that they name.
template <class Row>
void move_rows(const Leaving& leaving, std::vector<Row>& rows, const Communicator& all) {
  auto leave = for_each_of<Row>(all);
  const auto leaves = [&](const Row& row) {
    const auto to = leaving.goes_to(std::get<0>(place_of(row)));
    if (to) leave[*to].push_back(row);
    return to.has_value();
  };
  rows.erase(std::remove_if(rows.begin(), rows.end(), leaves), rows.end());
  std::vector<Row> come;
  for (const std::vector<Row>& some : all.swap(leave)) come.insert(come.end(), some.begin(), some.end());
  if (come.empty()) return;
  come = in_order_of_places(std::move(come));
  const auto stay = static_cast<std::ptrdiff_t>(rows.size());
  rows.insert(rows.end(), come.begin(), come.end());
  std::inplace_merge(rows.begin(), rows.begin() + stay, rows.end(),
                     [](const Row& a, const Row& b) { return place_of(a) < place_of(b); });
}

std::shared_ptr<const IdSet<ParticleId>> with_absent(const State& state, const std::vector<ParticleId>& own,
                                                     const std::vector<ParticleId>& others) {
  return std::make_shared<IdSet<ParticleId>>(IdSet<ParticleId>::of(state.r.size(), [&](const auto& add) {
    for (const ParticleId p : absent(state)) add(p);
    for (const ParticleId p : own) add(p);
    for (const ParticleId p : others) add(p);
  }));
}

}  // namespace

std::vector<int> owners_of(const std::vector<ParticleId>& asked, const std::vector<ParticleId>& own,
                           std::size_t particles, const Communicator& all) {
  const auto parts = static_cast<std::size_t>(all.ranks());
  const std::size_t share = std::max<std::size_t>(1, (particles + parts - 1) / parts);
  const auto keeper = [share](ParticleId p) { return p.value / share; };
  auto has = for_each_of<ParticleId>(all), asks = for_each_of<ParticleId>(all);
  for (const ParticleId p : own) has[keeper(p)].push_back(p);
  for (const ParticleId p : asked) asks[keeper(p)].push_back(p);
  std::vector<int> owner(share, 0);
  const OfEach<ParticleId> told = all.swap(has), asked_here = all.swap(asks);
  for (std::size_t part = 0; part < parts; ++part)
    for (const ParticleId p : told[part]) owner[p.value % share] = static_cast<int>(part);
  auto answers = for_each_of<int>(all);
  for (std::size_t part = 0; part < parts; ++part)
    for (const ParticleId p : asked_here[part]) answers[part].push_back(owner[p.value % share]);
  answers = all.swap(answers);
  std::vector<int> owners;
  std::vector<std::size_t> next(parts, 0);
  for (const ParticleId p : asked) owners.push_back(answers[keeper(p)][next[keeper(p)]++]);
  return owners;
}

void migrate(const std::vector<ParticleId>& before, const std::vector<ParticleId>& now, Model& model,
             State& state, PartHandedOver& part, const Communicator& all) {
  std::vector<ParticleId> gone;
  std::set_difference(before.begin(), before.end(), now.begin(), now.end(), std::back_inserter(gone));
  std::vector<int> to = owners_of(gone, now, state.r.size(), all);
  const Leaving leaving(std::move(gone), std::move(to));
  const OfEach<ParticleId> out = leaving.for_each_part(all);
  send(out, all.swap(out), with_absent(state, now, {}), state, model, all);
  move_bonds([&leaving](ParticleId p) { return leaving.goes_to(p); }, state, part.bonds, part.shared, all);
  for_each_list(state, [&](auto& rows) { move_rows(leaving, rows, all); });
}

void know_besides(const std::vector<ParticleId>& others, const std::vector<int>& owners,
                  const std::vector<ParticleId>& own, Model& model, State& state, const Communicator& all) {
  auto asks = for_each_of<ParticleId>(all);
  for (std::size_t k = 0; k < others.size(); ++k)
    asks[static_cast<std::size_t>(owners[k])].push_back(others[k]);
  send(all.swap(asks), asks, with_absent(state, own, others), state, model, all);
}

std::vector<ParticleId> others_to_know(const std::vector<ParticleId>& own, const std::vector<ImageOf>& ghosts,
                                       const State& state) {
  const IdSet<ParticleId> is_own(state.r.size(), own);
  std::vector<ParticleId> others;
  const auto add = [&](ParticleId p) {
    if (!is_own.has(p)) others.push_back(p);
  };
  for (const ImageOf& g : ghosts) add(g.particle);
  for (const Bond& b : state.bonds) add(b.i), add(b.j);
  for (const Carried& c : state.carried) add(c.particle);
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  std::erase_if(others, [&state](ParticleId p) { return is_absent(state, p); });
  return others;
}

}  // namespace vbond
