#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/dynamics/touch_kernel.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/contact_masses.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Two capsules, or a capsule and a particle, that are deep in one another.
struct DeepCapsules {
  std::string first, second;  ///< names
  ParticleId i, j;            ///< the first particles of both
  double overlap, radius;     ///< the smaller radius  [length]
};

/// What bonds that touch as capsules do to each other and to particles: physics/touch.hpp where their axes
/// are nearest, by model/capsules.hpp. Contacts are worked out in the order of their places, whatever the
/// threads and whenever near pairs were listed.
class Capsules {
 public:
  /// Keeps references to all. cell: its edges now; what images do follows from them and from particles.
  Capsules(const Model& model, const Stage& stage, const Bodies& bodies, const CellEdges& cell);
  Capsules(const Model&&, const Stage&, const Bodies&, const CellEdges&) = delete;
  Capsules(const Model&, const Stage&&, const Bodies&, const CellEdges&) = delete;
  Capsules(const Model&, const Stage&, const Bodies&&, const CellEdges&) = delete;
  Capsules(const Model&, const Stage&, const Bodies&, const CellEdges&&) = delete;

  bool any() const { return any_; }
  /// The bonds are these now; refresh() and work_out() come next.
  void bonds_changed(const PerBond<Bond>& bonds);
  /// Lists near pairs anew if a particle has moved by half the skin, and finds out which of them may touch.
  void refresh();
  /// Contacts and their loads, from poses and the motion of the half step before; dt = 0: between steps,
  /// nothing is lost. Returns what is.
  TouchLosses<double> work_out(const Team& team, double dt);
  /// Looks for axes that pass through each other within the step that has just moved all particles by dt v,
  /// whether or not they touch at its end: for steps after which some are deep in one another, or in which
  /// something is fast. way: the longest of a particle in the step; longest: against the mean of all, for
  /// which near pairs are listed anew; 0: nothing is fast  [length]. After work_out().
  void look_at_drift(double dt, double way, double longest);
  /// Adds the loads of these rows.
  void add_loads(RowRange rows, LoadRow* load) const;
  /// Takes all of them away again.
  void take_loads(LoadRow* load) const;
  /// What a particle feels of a contact, there or where an image of it stands.
  struct Share {
    std::size_t row;
    Vec3d F, M;
    Image image{};
  };
  /// All of them, as worked out last.
  const std::vector<Share>& shares() const { return shares_; }
  /// The sum over the shares of rows [0, rows) of how many of each edge their images are away times the
  /// force.  [force]
  std::array<Vec3d, 3> edges_times_force(std::size_t rows) const;
  /// The sum of F (x) r of shares, as poses are now.  [energy]
  Tensor virial(const std::vector<Share>& shares) const;

  /// How many near pairs are listed. A step looks at those of them that may touch: they were no farther apart
  /// then than particles have moved since.
  std::size_t near_pairs() const { return near_.size(); }
  /// What contacts store as worked out last.  [energy]
  double energy() const;
  std::vector<FibreMemory> collect() const;
  /// Takes it up again: before the next work_out(), or after it in place of what it remembers.
  void restore(const std::vector<FibreMemory>& memories);

  /// Those that overlap by more than this part of the smaller radius.
  std::vector<DeepCapsules> deeper_than(double part) const;
  /// Whether any two axes are nearer than deep_part of the sum of the radii.
  bool deep() const { return deep_; }
  /// Two whose axes have passed through each other in the last step.
  const std::optional<DeepCapsules>& passed() const { return passed_; }

 private:
  struct Contact : FibreContact {
    Vec3d normal;
    PairHistory history{};
  };

  std::size_t row(ParticleId p) const { return bodies_.order.row[p].value; }
  Vec3d place(const ImageOf& p) const { return bodies_.pose[row(p.particle)].r + to_image(cell_, p.image); }
  Vec3d velocity(const ImageOf& p) const {
    return bodies_.motion[row(p.particle)].v + image_velocity(cell_, p.image);
  }
  std::optional<PerParticle<Vec3d>> finite_places() const;
  void list_near_pairs();
  void take_near_pairs();
  double way_since_listed() const;
  std::size_t may_have_come_nearer_by(double way) const;
  double way_of_images() const;
  Touching<double> touching(const FibreContact& c) const;
  const TouchNumbers<double>& numbers(const FibreContact& c) const;
  std::vector<FibreContact> find(const Team& team);
  std::vector<Contact> with_history(const std::vector<FibreContact>& found, std::vector<Contact>& parted);
  std::vector<double> friction_shares(const std::vector<Touching<double>>& touchings) const;
  TouchLosses<double> work_out(Contact& c, const Touching<double>& p, double friction_share, double dt);
  bool pass(const FibrePair& pair, double dt) const;
  DeepCapsules told(std::uint32_t first, std::uint32_t second, double overlap, double radius) const;

  const Model& model_;
  const Stage& stage_;
  const Bodies& bodies_;
  const CellEdges& cell_;
  TouchForms forms_;
  std::uint32_t materials_ = 1;
  std::vector<TouchNumbers<double>> numbers_;  // of each pair of materials
  ContactMasses masses_;                       // if there are any
  FibreParts fibres_;
  bool any_ = false, listed_ = false, deep_ = false;
  double skin_ = 0;                         // near pairs are listed so far beyond what touches  [length]
  std::vector<FibrePair> near_bodies_;      // as listed, whether or not they may touch
  std::vector<FibrePair> near_;             // by their gaps then
  std::vector<Vec3d> apart_along_;          // of each, a unit vector once they were apart
  double gone_ = 0;                         // the longest way since then  [length]
  std::size_t look_at_ = 0;                 // the first so many may touch
  PerParticle<Vec3d> r_listed_;             // places then
  CellEdges listed_at_;                     // edges as near pairs were listed
  std::array<double, 3> farthest_image_{};  // edges that an image may be away from what it is near
  std::vector<std::vector<FibreContact>> of_part_;  // of a team
  std::vector<Contact> contacts_;
  std::vector<Share> shares_;  // in order of rows, those of a row in order of contacts
  std::optional<DeepCapsules> passed_;
};

}  // namespace vbond
