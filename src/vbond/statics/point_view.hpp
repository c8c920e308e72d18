#pragma once
#include <optional>
#include <vector>

#include "vbond/model/body_view.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// A point of balance for those who write and watch. Keeps references.
class PointView final : public BodyView {
 public:
  PointView(const Model& model, const StaticPoint& point)
      : model_(model),
        point_(point),
        balance_{point.load_factor, point.kind, point.unstable, point.relieved} {}

  const Model& model() const override { return model_; }
  const State& state() const override { return point_.state; }
  BodyPart part(Show = Show::places, double /*near*/ = 0.0) const override { return state(); }
  const Survey& survey() const override {
    if (!survey_) {
      survey_ = {point_.energies, deformed_bonds(state())};
      survey_->any_deformed = !survey_->deformed.empty();
    }
    return *survey_;
  }
  const EnergyBooks& books() const override {
    if (!books_)
      books_ = {.at_start = point_.energies.total(),
                .dissipated = dissipated_by_flow(state()),
                .released = point_.released};
    return *books_;
  }
  double balance_error() const override { return 0.0; }
  Reaction reaction(const std::vector<ParticleId>& particles,
                    LastBreaks = LastBreaks::left_out) const override {
    return point_.reaction(particles);  // bonds that broke at rest have no loads
  }
  const std::vector<WallState>& walls() const override { return state().walls; }
  std::vector<GripView> grips() const override { return point_.grips; }
  const BalancePoint* balance() const override { return &balance_; }

 private:
  const State& known() const override { return state(); }

  const Model& model_;
  const StaticPoint& point_;
  BalancePoint balance_;
  mutable std::optional<Survey> survey_;
  mutable std::optional<EnergyBooks> books_;
};

}  // namespace vbond
