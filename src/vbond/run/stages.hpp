#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/setup/outlook.hpp"

namespace vbond {

/// One stage of a run, dynamic or static.
using AnyStage = std::variant<Stage, StaticStage>;

StageKind kind_of(const AnyStage& stage);
const std::string& name_of(const AnyStage& stage);

/// The stages of a run, in order. Each is made when the run comes to it, as it may depend on the state that
/// the stages before it leave: its bonds, its time step.
class Stages {
 public:
  virtual ~Stages() = default;
  virtual std::size_t size() const = 0;
  virtual StageKind kind(std::size_t k) const = 0;
  virtual std::string name(std::size_t k) const = 0;
  /// Where a user finds the stage; without a file if a program has made it.
  virtual SourcePlace place(std::size_t /*k*/) const { return {}; }
  /// Stage k, k < size(), as it begins in this state, to which it adds its bonds, or as it goes on if
  /// state.clock.stage_step > 0. Throws CaseError or std::invalid_argument.
  virtual AnyStage make(std::size_t k, const Model& model, State& state) const = 0;
  /// What there is to tell of stage k, which has just begun in this state and added all bonds but the first
  /// `bonds_before`; a line each.
  virtual std::vector<std::string> notes(std::size_t /*k*/, const State&,
                                         std::size_t /*bonds_before*/) const {
    return {};
  }
  /// The same before the stages in front of it have run; throws only for what is wrong whatever they do.
  virtual AnyStage look_ahead(std::size_t k, const Model& model, Outlook& outlook) const = 0;
};

/// Stages that a program has made. A step above the critical one is refused unless the stage insists.
std::unique_ptr<const Stages> given_stages(std::vector<AnyStage> stages);

/// The stages of a case, made as it is then: keeps a reference to it. Throws CaseError as require_statics
/// does. threads: see build(). own: if the state of the first stage has own bonds alone.
std::unique_ptr<const Stages> stages_of(const Case& c, int threads = 0,
                                        std::shared_ptr<const BondsFromSetUp> own = {});
std::unique_ptr<const Stages> stages_of(const Case&&, int threads = 0,
                                        std::shared_ptr<const BondsFromSetUp> own = {}) = delete;

/// Throws CaseError if the case needs statics and this library was built without.
void require_statics(const Case& c);

}  // namespace vbond
