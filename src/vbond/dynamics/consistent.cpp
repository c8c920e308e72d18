#include "vbond/dynamics/consistent.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

namespace vbond {
namespace {

void require(bool holds, const char* rule) {
  if (!holds) throw std::invalid_argument(std::string("Simulation: ") + rule);
}

}  // namespace

const Model& consistent(const Model& model, const Stage& stage, const State& state) {
  const std::size_t n = model.particles();
  require(model.inertia.size() == n && model.radius.size() == n && model.r_0.size() == n,
          "the model must have a mass, inertia, radius and first position for each particle");
  require(state.r.size() == n && state.v.size() == n && state.q.size() == n && state.omega.size() == n,
          "the state must have r, v, q and omega for each particle of the model: begin with at_rest(model)");
  require(model.contact.inelastic == nullptr || model.contact.law != ContactLaw::none,
          "contact.inelastic is for particles that repel each other: choose a contact.law");
  require(stage.dt > 0.0 && std::isfinite(stage.dt), "stage.dt must be above zero and finite");
  const auto known = [n](ParticleId p) { return p.value < n; };
  const auto all_known = [&](const auto& of) { return std::all_of(of.begin(), of.end(), known); };
  for (const Bond& b : state.bonds)
    require(known(b.i) && known(b.j) && b.i != b.j, "a bond must join two particles of the model");
  for (const Support& s : stage.supports)
    require(all_known(s.particles), "a support names a particle that the model has not");
  for (const PointLoad& l : stage.loads)
    require(all_known(l.particles), "a load names a particle that the model has not");
  require(!stage.strain || all_known(stage.strain->particles),
          "the imposed strain names a particle that the model has not");
  const std::optional<DistanceStop>& distance = stage.stops.distance;
  require(!distance || (known(distance->i) && known(distance->j)),
          "the stop at a distance names a particle that the model has not");
  require(!stage.stops.peak || all_known(stage.stops.peak->particles),
          "the stop at a peak names a particle that the model has not");
  for (const BondingRule& r : stage.bonding)
    require(r.in_a.size() == n && r.in_b.size() == n,
            "a bonding rule must say of each particle if it is meant");
  return model;
}

}  // namespace vbond
