// What contacts with friction cost: nanoseconds per contact and step, for equal spheres and for two sizes
// with equal volumes, and a new list of near pairs. Usage: contacts [particles = 100000] [steps = 200]
// [threads = 1]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "vbond/dynamics/contacts.hpp"
#include "vbond/dynamics/simulation.hpp"

namespace vbond {
namespace {

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Spheres of radius 0.5 on a cubic lattice a little narrower than they are, each touching its six
/// neighbours; with ratio > 1, large ones of that many times the size take the place of half the volume.
struct Packing {
  Model model;
  State state;
  Packing(std::size_t particles, double ratio) {
    const double spacing = 0.998, R = 0.5 * ratio, pitch = ratio > 1.0 ? 2.02 * R * std::cbrt(1.55) : 0.0;
    const auto edge = static_cast<int>(std::cbrt(static_cast<double>(particles) * (ratio > 1.0 ? 2.1 : 1.0)));
    std::vector<Vec3d> large, r;
    if (ratio > 1.0)
      for (double x = 0.5 * pitch; x + R < edge; x += pitch)
        for (double y = 0.5 * pitch; y + R < edge; y += pitch)
          for (double z = 0.5 * pitch; z + R < edge; z += pitch) large.push_back({x, y, z});
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z) {
          const Vec3d at = spacing * Vec3d{double(x), double(y), double(z)};
          const auto inside = [&](const Vec3d& c) { return norm(at - c) < R + 0.499; };
          if (std::none_of(large.begin(), large.end(), inside)) r.push_back(at);
        }
    const std::size_t small = r.size();
    r.insert(r.end(), large.begin(), large.end());
    model = equal_particles(r, 1.0, 0.1, 0.5);
    for (std::size_t k = small; k < r.size(); ++k) {
      const ParticleId p{k};
      model.radius[p] = R, model.mass[p] = ratio * ratio * ratio,
      model.inertia[p] = 0.4 * model.mass[p] * R * R;
    }
    ContactModel& c =
        model.contact = {.law = ContactLaw::hertz, .pairs = ContactPairs::all, .E = 1000, .nu = 0.3};
    c.tangential = TangentialForm::mindlin, c.surface = {.friction = 0.5, .restitution = 0.6};
    state = at_rest(model);
    std::uint32_t random = 1;
    const auto one = [&random] {
      random = random * 1664525u + 1013904223u;
      return 0.02 * ((random >> 8) * 0x1p-24 - 0.5);
    };
    for (Vec3d& v : state.v) v = {one(), one(), one()};
  }
};

void cost_of_a_step(const char* name, std::size_t particles, double ratio, int steps, int threads) {
  const Packing packing(particles, ratio);
  Stage stage;
  stage.dt = 1e-3;
  std::vector<double> ns;
  std::size_t contacts = 0;
  for (int round = 0; round < 3; ++round) {
    Simulation run(packing.model, stage, packing.state, threads);
    run.step();
    contacts = run.state().contact_history.size();
    const double seconds = seconds_of([&] {
      for (int k = 0; k < steps; ++k) run.step();
    });
    ns.push_back(1e9 * seconds / steps / static_cast<double>(contacts));
  }
  std::sort(ns.begin(), ns.end());
  std::printf("%-22s %8zu particles %8zu contacts: %.1f ns per contact and step (%.1f to %.1f)\n", name,
              packing.model.particles(), contacts, ns[1], ns[0], ns[2]);
  std::fflush(stdout);
}

/// Near pairs listed anew, with what they remember: the whole body has moved by more than the skin.
void cost_of_a_list(const char* name, std::size_t particles, double ratio, int threads) {
  const Packing packing(particles, ratio);
  Bodies bodies(packing.model);
  bodies.read(packing.state);
  const std::size_t blocks = (bodies.pose.size() + block_rows - 1) / block_rows;
  const Team team(packing.model.particles(), std::vector<std::size_t>(blocks, block_rows), threads);
  const BondIndex index;
  Contacts contacts(packing.model, bodies.order, index);
  contacts.refresh(bodies.poses(), team);
  std::vector<double> seconds;
  for (int round = 0; round < 5; ++round) {
    for (PoseRow& p : bodies.pose) p.r.x += 10.0;
    seconds.push_back(seconds_of([&] { contacts.refresh(bodies.poses(), team); }));
  }
  std::sort(seconds.begin(), seconds.end());
  std::printf("%-22s %8zu particles: a new list in %.3f s (%.3f to %.3f), %.0f ns per particle\n", name,
              packing.model.particles(), seconds[2], seconds[0], seconds[4],
              1e9 * seconds[2] / static_cast<double>(packing.model.particles()));
  std::fflush(stdout);
}

}  // namespace
}  // namespace vbond

int main(int count, char** arguments) {
  const auto number = [&](int k, int otherwise) { return count > k ? std::atoi(arguments[k]) : otherwise; };
  const int particles = number(1, 100000), steps = number(2, 200), threads = number(3, 1);
  const auto n = static_cast<std::size_t>(particles);
  vbond::cost_of_a_step("equal", n, 1.0, steps, threads);
  vbond::cost_of_a_step("1 : 20, equal volumes", n, 20.0, steps, threads);
  vbond::cost_of_a_list("equal", n, 1.0, threads);
  vbond::cost_of_a_list("1 : 20, equal volumes", n, 20.0, threads);
}
