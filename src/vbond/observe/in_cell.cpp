#include "vbond/observe/in_cell.hpp"

#include <algorithm>

#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond {

std::optional<FrameCell> frame_cell(const Model& model, const State& state) {
  if (state.cell.empty()) return std::nullopt;
  return FrameCell{{state.cell[0].along, state.cell[1].along, state.cell[2].along},
                   times(cell_gradient(model.cell, state.cell), model.cell.corner),
                   model.cell.periodic};
}

PerParticle<Image> images_in_cell(const Model& model, const State& state) {
  PerParticle<Image> images(state.r.size());
  if (state.cell.empty()) return images;
  const Vec3d corner = frame_cell(model, state)->corner;
  for (const ParticleId p : state.r.ids())
    images[p] = image_in_cell(state.cell, model.cell.periodic, corner, state.r[p]);
  return images;
}

State shown_by_images(const State& state, const PerParticle<Image>& images) {
  State shown = state;
  for (const ParticleId p : shown.r.ids()) shown.r[p] += to_image(state.cell, images[p]);
  if (!shown.v.empty())
    for (const ParticleId p : shown.v.ids()) shown.v[p] += image_velocity(state.cell, images[p]);
  // the image n of j stands away from i as the image n + n_i - n_j of the one shown from that of i
  for (Bond& b : shown.bonds) set_image_of_j(b, image_of_j(b) + images[b.i] - images[b.j]);
  for (PairMemory& m : shown.contact_history) m.image_j = m.image_j + images[m.i] - images[m.j];
  std::sort(shown.contact_history.begin(), shown.contact_history.end(),
            [](const PairMemory& a, const PairMemory& b) { return place_of(a) < place_of(b); });
  return shown;
}

}  // namespace vbond
