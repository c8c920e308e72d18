#include "vbond/setup/outlook.hpp"

#include "vbond/setup/bonds.hpp"
#include "vbond/setup/case_cell.hpp"
#include "vbond/setup/motion_stages.hpp"
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/setup/stage_step.hpp"

namespace vbond {
namespace {

void expect_stage_bonds(const Case& c, std::size_t k, const Model& model, Outlook& outlook,
                        Problems& problems) {
  for (std::size_t set = 0; set < c.bonds.size(); ++set) {
    if (!makes_bonds_as_it_begins(c.bonds[set], c.stages[k])) continue;
    outlook.bonds_known = false;  // their lengths will be those of then
    if (!expect_bonds(c, set, model, outlook.changed(), problems)) outlook.pairs_known = false;
  }
}

Stage look_ahead_at_dynamics(const Case& c, const Model& model, std::size_t k, Outlook& outlook) {
  Problems problems;
  Stage stage = resolve_stage(c, model, k, problems);
  expect_stage_bonds(c, k, model, outlook, problems);
  refuse_turned_through_face(c.stages[k], stage.supports, outlook.state(), true, problems);
  const bool bound_is_known = outlook.bonds_known && model.contact.law == ContactLaw::none;
  if (!stage.bonding.empty()) outlook.pairs_known = outlook.bonds_known = false;
  refuse_exact_with_bonding(c, stage, problems);
  problems.throw_if_any();
  if (bound_is_known && !step_is_exact(c)) choose_fitting_step(c, k, model, outlook.body(), {}, stage);
  return stage;
}

StaticStage look_ahead_at_statics(const Case& c, const Model& model, std::size_t k, Outlook& outlook) {
  Problems problems;
  StaticStage stage = resolve_static_stage(c, model, k, problems);
  expect_stage_bonds(c, k, model, outlook, problems);
  refuse_turned_through_face(c.stages[k], stage.supports, outlook.state(), true, problems);
  if (outlook.pairs_known) refuse_nothing_elastic(c.stages[k], model, outlook.state(), problems);
  problems.throw_if_any();
  return stage;
}

}  // namespace

std::variant<Stage, StaticStage> look_ahead(const Case& c, const Model& model, std::size_t k,
                                            Outlook& outlook) {
  if (!outlook.state().waiting.empty())
    outlook.pairs_known = outlook.bonds_known = false;  // they bring bonds
  if (is_static(c.stages.at(k).kind)) return look_ahead_at_statics(c, model, k, outlook);
  return look_ahead_at_dynamics(c, model, k, outlook);
}

}  // namespace vbond
