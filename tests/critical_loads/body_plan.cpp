#include "body_plan.hpp"

#include <fmt/format.h>

#include <numeric>

namespace vbond::campaign {
namespace {

std::vector<ParticleId> ids(const Particles& particles) {
  return {particles.begin(), particles.end()};
}

Vec3d cycled(const Vec3d& v) {
  return {v.z, v.x, v.y};
}

std::vector<Vec3d> positions(const BodyPlan& plan) {
  std::vector<Vec3d> r = plan.r;
  for (std::size_t k = 0; k < plan.offset.size(); ++k) r[k] += plan.offset[k];
  return r;
}

/// Every vector of the plan: positions and offsets, lengths of supports, turns, forces, moments, directions.
struct Vectors {
  std::vector<Vec3d*> lengths, turns, forces, moments, directions;
};

Vectors vectors_of(BodyPlan& plan) {
  Vectors v;
  for (Vec3d& r : plan.r) v.lengths.push_back(&r);
  for (Vec3d& r : plan.offset) v.lengths.push_back(&r);
  for (PlannedSupport& s : plan.supports)
    v.lengths.push_back(&s.displacement), v.turns.push_back(&s.rotation);
  for (PlannedLoad& l : plan.loads) v.forces.push_back(&l.force), v.moments.push_back(&l.moment);
  v.forces.push_back(&plan.gravity);
  for (BondSet& s : plan.sets)
    if (s.n_2) v.directions.push_back(&*s.n_2);
  return v;
}

template <class F>
void for_all(const Vectors& v, F&& f) {
  for (const auto* some : {&v.lengths, &v.turns, &v.forces, &v.moments, &v.directions})
    for (Vec3d* x : *some) *x = f(*x);
}

std::string text_of(const Vec3d& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z);
}

std::string text_of(const HeldDofs& held) {
  constexpr const char* names[] = {"x", "y", "z", "rx", "ry", "rz"};
  std::string text;
  for (std::size_t k = 0; k < 6; ++k)
    if (held[k]) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", names[k]);
  return "[" + text + "]";
}

std::string toml_of(const BondSet& set) {
  const auto& c = set.stiffness;
  std::string text =
      fmt::format("\n[[bonds]]\nlaw = \"{}\"\npairs = [", set.law == &bond_law<Evm> ? "evm" : "v-model");
  for (const auto& [i, j] : set.pairs) text += fmt::format("[{}, {}], ", i, j);
  text += fmt::format("]\nstiffness = {{c_A = {:.17g}, c_D = {:.17g}, c_B = {:.17g}, c_T = {:.17g}}}\n",
                      c.c_A, c.c_D, c.c_B, c.c_T);
  if (set.n_2) text += "n_2 = " + text_of(*set.n_2) + "\n";
  return text;
}

std::string settings_of(const StaticStage& stage) {
  if (stage.kind != StageKind::path) return fmt::format("kind = \"buckling\"\ncount = {}\n", stage.count);
  std::string text = fmt::format("kind = \"path\"\nfirst_step = {:.17g}\nmost_points = {}\n",
                                 stage.path.first_step, stage.path.most_points);
  if (stage.path.largest_step > 0.0) text += fmt::format("largest_step = {:.17g}\n", stage.path.largest_step);
  if (stage.path.above)
    text += fmt::format("stop = {{load_factor = {{above = {:.17g}}}}}\n", *stage.path.above);
  return text;
}

}  // namespace

Particles everybody(const BodyPlan& plan) {
  Particles all(plan.r.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

BodyPlan perfect(BodyPlan plan) {
  plan.offset.clear();
  plan.imperfection = 0.0;
  return plan;
}

void change_units(BodyPlan& plan, double length, double force) {
  const Vectors v = vectors_of(plan);
  for (Vec3d* x : v.lengths) *x = length * *x;
  for (Vec3d* x : v.forces) *x = force * *x;
  for (Vec3d* x : v.moments) *x = force * length * *x;
  plan.radius *= length;
  for (BondSet& s : plan.sets) {
    s.stiffness.c_A *= force / length, s.stiffness.c_D *= force / length;
    s.stiffness.c_B *= force * length, s.stiffness.c_T *= force * length;
  }
}

void permute_axes(BodyPlan& plan) {
  for_all(vectors_of(plan), cycled);
  for (PlannedSupport& s : plan.supports) {
    const HeldDofs h = s.held;
    s.held = {h[2], h[0], h[1], h[5], h[3], h[4]};
  }
}

void turn(BodyPlan& plan, const Quatd& by) {
  for_all(vectors_of(plan), [&by](const Vec3d& v) { return rotate(by, v); });
}

testing::Specimen specimen_of(const BodyPlan& plan) {
  testing::Specimen s = testing::particles_at(positions(plan), plan.radius, 0.4 * sq(plan.radius));
  for (const BondSet& set : plan.sets) {
    BondRecipe recipe;
    recipe.law = set.law;
    recipe.parameters = set.stiffness;
    recipe.n_2 = set.n_2;
    for (const auto& [i, j] : set.pairs) testing::bond(s, i, j, recipe);
  }
  return s;
}

StaticStage stage_of(const BodyPlan& plan, StageKind kind) {
  StaticStage stage;
  stage.name = "campaign";
  stage.kind = kind;
  stage.gravity = plan.gravity;
  for (std::size_t k = 0; k < plan.supports.size(); ++k) {
    const PlannedSupport& s = plan.supports[k];
    stage.supports.push_back(
        {fmt::format("support_{}", k), ids(s.particles), s.held, s.displacement, s.rotation});
  }
  for (std::size_t k = 0; k < plan.loads.size(); ++k) {
    const PlannedLoad& l = plan.loads[k];
    stage.loads.push_back({fmt::format("load_{}", k), ids(l.particles), l.force, l.moment});
    stage.loads.back().constant = l.constant;
  }
  return stage;
}

std::string to_toml(const BodyPlan& plan, const StaticStage& stage) {
  std::string text =
      fmt::format("# {}: {}\n\n[[specimen]]\nkind = \"list\"\npositions = [\n", plan.kind, plan.what);
  for (const Vec3d& r : positions(plan)) text += "  " + text_of(r) + ",\n";
  text +=
      fmt::format("]\nradius = {:.17g}\nmass = 1.0\ninertia = {:.17g}\n", plan.radius, 0.4 * sq(plan.radius));
  for (const BondSet& set : plan.sets) text += toml_of(set);
  const auto group = [&text](const std::string& name, const Particles& particles) {
    text += fmt::format("\n[groups.{}]\nindices = [{}]\n", name, fmt::join(particles, ", "));
  };
  for (std::size_t k = 0; k < plan.supports.size(); ++k)
    group(stage.supports[k].group, plan.supports[k].particles);
  for (std::size_t k = 0; k < plan.loads.size(); ++k) group(stage.loads[k].group, plan.loads[k].particles);
  text += "\n[[stage]]\n" + settings_of(stage) + "gravity = " + text_of(plan.gravity) + "\nsupports = [\n";
  for (const Support& s : stage.supports) {
    text += fmt::format("  {{group = \"{}\", fix = {}", s.group, text_of(s.held));
    if (s.velocity != Vec3d{}) text += ", displacement = " + text_of(s.velocity);
    if (s.angular_velocity != Vec3d{}) text += ", rotation = " + text_of(s.angular_velocity);
    text += "},\n";
  }
  text += "]\nloads = [\n";
  for (const PointLoad& l : stage.loads)
    text += fmt::format("  {{group = \"{}\", force = {}, moment = {}, constant = {}}},\n", l.group,
                        text_of(l.force), text_of(l.moment), l.constant);
  return text + "]\n";
}

}  // namespace vbond::campaign
