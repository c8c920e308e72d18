#include "vbond/packing/voronoi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <voro++/voro++.hh>

#include "vbond/core/crew.hpp"
#include "vbond/core/images.hpp"

namespace vbond::packing {
namespace {

/// Particles in bins of the parallelepiped, so that those near one are found ring by ring. Bins are equal
/// parts; where particles crowd, as they do if one of them is far from all others, planes between bins part
/// them into equal numbers along each edge instead.
class Bins {
 public:
  struct Near {
    std::size_t j;
    Image image;  ///< of j, seen from the particle that asks
    Vec3d d;      ///< from that particle to this image  [length]
  };

  Bins(const VoronoiSpace& space, const std::vector<Vec3d>& r) : space_(space) {
    for (const Vec3d& e : space.edges) edges_.push_back({e, {}, {}, {}});
    height_ = heights(edges_);
    for (const Vec3d& at : r) {
      Vec3d s = in_edges(edges_, between(space.corner, at));
      const Image back{whole(s.x, 0), whole(s.y, 1), whole(s.z, 2)};
      s = s - Vec3d{double(back.a), double(back.b), double(back.c)};
      s_.push_back(s);
      moved_.push_back(-back);
      r_.push_back(at - double(back.a) * space.edges[0] - double(back.b) * space.edges[1] -
                   double(back.c) * space.edges[2]);
    }
    const double share = std::cbrt(3.0 / static_cast<double>(r.size()) * volume(edges_));
    for (std::size_t k = 0; k < 3; ++k) {
      const double parts = std::floor(std::min(component(height_, static_cast<int>(k)) / share, 1e4)) + 1.0;
      for (double cut = 0.0; cut <= parts; ++cut) cuts_[k].push_back(cut / parts);
    }
    if (fill() <= crowd) return;
    for (std::size_t k = 0; k < 3; ++k) cut_by_number(k);
    fill();
  }

  /// The particle as it stands in the parallelepiped.
  const Vec3d& at(std::size_t i) const { return r_[i]; }
  /// All particles nearer to i than this are in the rings up to this one; infinite if there are no more.
  double known_after(std::size_t i, std::int64_t ring) const {
    double known = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const int c = static_cast<int>(k);
      const double s = component(s_[i], c), height = component(height_, c);
      const std::int64_t low = home_[i][k] - ring, high = home_[i][k] + ring + 1;
      if (space_.periodic[k] || low > 0) known = std::min(known, (s - cut(k, low)) * height);
      if (space_.periodic[k] || high < count(k)) known = std::min(known, (cut(k, high) - s) * height);
    }
    return known;
  }
  /// Appends those in the bins that are `ring` bins away from that of i, i itself left out.
  void add_ring(std::size_t i, std::int64_t ring, std::vector<Near>& near) const {
    const auto& h = home_[i];
    for (std::int64_t z = -ring; z <= ring; ++z)
      for (std::int64_t y = -ring; y <= ring; ++y) {
        const bool edge = std::abs(z) == ring || std::abs(y) == ring;
        for (std::int64_t x = -ring; x <= ring; x += edge || ring == 0 ? 1 : 2 * ring)
          add_bin(i, {h[0] + x, h[1] + y, h[2] + z}, near);
      }
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  static constexpr std::size_t crowd = 60;  // particles in a bin; on the average there are three

  std::int32_t whole(double s, std::size_t k) const {
    return space_.periodic[k] ? static_cast<std::int32_t>(std::floor(s)) : 0;
  }
  std::int64_t count(std::size_t k) const { return static_cast<std::int64_t>(cuts_[k].size()) - 1; }
  std::int64_t part(double s, std::size_t k) const {
    const auto above = std::upper_bound(cuts_[k].begin(), cuts_[k].end(), s);
    return std::clamp(static_cast<std::int64_t>(above - cuts_[k].begin()) - 1, std::int64_t{0}, count(k) - 1);
  }
  /// Number m of the planes between bins, in parts of the edge; they repeat with it.
  double cut(std::size_t k, std::int64_t m) const {
    const std::int64_t edges = whole_edges(m, k);
    return static_cast<double>(edges) + cuts_[k][static_cast<std::size_t>(m - edges * count(k))];
  }
  std::int64_t whole_edges(std::int64_t m, std::size_t k) const {
    return m >= 0 ? m / count(k) : -((count(k) - 1 - m) / count(k));
  }
  std::size_t bin_of(const Place& p) const {
    return static_cast<std::size_t>(p[0] + count(0) * (p[1] + count(1) * p[2]));
  }
  void cut_by_number(std::size_t k) {
    std::vector<double> s;
    for (const Vec3d& place : s_) s.push_back(component(place, static_cast<int>(k)));
    std::sort(s.begin(), s.end());
    const std::size_t parts = cuts_[k].size() - 1;
    std::vector<double> cuts{0.0};
    for (std::size_t c = 1; c < parts; ++c)
      if (const double at = s[c * s.size() / parts]; at > cuts.back() && at < 1.0) cuts.push_back(at);
    cuts.push_back(1.0);
    cuts_[k] = std::move(cuts);
  }
  /// Sorts the particles into the bins; returns the largest number in one.
  std::size_t fill() {
    const std::size_t bins = static_cast<std::size_t>(count(0) * count(1) * count(2));
    std::vector<std::size_t> bin;
    first_.assign(bins + 1, 0), home_.clear();
    for (const Vec3d& s : s_) {
      home_.push_back({part(s.x, 0), part(s.y, 1), part(s.z, 2)});
      bin.push_back(bin_of(home_.back()));
      ++first_[bin.back() + 1];
    }
    const std::size_t most = *std::max_element(first_.begin(), first_.end());
    for (std::size_t b = 0; b < bins; ++b) first_[b + 1] += first_[b];
    members_.resize(s_.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < s_.size(); ++i) members_[next[bin[i]]++] = i;
    return most;
  }
  void add_bin(std::size_t i, Place p, std::vector<Near>& near) const {
    std::array<std::int64_t, 3> n{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t edges = whole_edges(p[k], k);
      if (edges != 0 && !space_.periodic[k]) return;
      n[k] = edges, p[k] -= edges * count(k);
    }
    const Image image{static_cast<std::int32_t>(n[0]), static_cast<std::int32_t>(n[1]),
                      static_cast<std::int32_t>(n[2])};
    const Vec3d shift = to_image(edges_, image);
    const std::size_t bin = bin_of(p);
    for (std::size_t m = first_[bin]; m < first_[bin + 1]; ++m) {
      const std::size_t j = members_[m];
      if (j == i && image.is_itself()) continue;
      near.push_back({j, moved_[j] + image - moved_[i], between(r_[i], r_[j] + shift)});
    }
  }

  const VoronoiSpace& space_;
  CellEdges edges_;
  Vec3d height_;
  std::array<std::vector<double>, 3> cuts_;  // planes between bins, from 0 to 1
  std::vector<Vec3d> r_, s_;                 // in the parallelepiped; the same in parts of its edges
  std::vector<Image> moved_;                 // by so many edges, to stand in it
  std::vector<Place> home_;
  std::vector<std::size_t> first_, members_;
};

/// A box around the place of a particle that its cell cannot leave: images of the particle itself bound it
/// along the edges that repeat, the parallelepiped along the others.
double reach_of_cells(const VoronoiSpace& space) {
  double reach = 0.0;
  for (std::size_t k = 0; k < 3; ++k) reach += (space.periodic[k] ? 0.5 : 1.0) * norm(space.edges[k]);
  return 1.01 * reach;
}

/// Makes one cell after the other.
class CellMaker {
 public:
  CellMaker(const VoronoiSpace& space, const Bins& bins, const std::vector<double>& radius, double unit)
      : space_(space), bins_(bins), radius_(radius), unit_(unit), reach_(reach_of_cells(space)) {
    for (const double R : radius) largest_ = std::max(largest_, R);
  }

  /// The volume; the faces are appended.
  double make(std::size_t i, std::vector<VoronoiFace>& faces) {
    if (!cut_all(i)) return 0.0;
    add_faces(faces);
    return cell_.volume() * unit_ * unit_ * unit_;
  }

  /// Appends, of each corner of the cell that is between particles, these and its own. False if there is one
  /// at which more than three others meet.
  bool add_corners(std::size_t i, std::vector<Tetrahedron>& corners) {
    if (!cut_all(i)) return false;
    cell_.neighbors(who_);
    cell_.face_vertices(of_faces_);
    std::vector<std::vector<int>> at(static_cast<std::size_t>(cell_.p));  // whose faces meet there
    for (std::size_t face = 0, k = 0; face < who_.size();
         ++face, k += static_cast<std::size_t>(of_faces_[k]) + 1)
      for (std::size_t m = 1; m <= static_cast<std::size_t>(of_faces_[k]); ++m)
        at[static_cast<std::size_t>(of_faces_[k + m])].push_back(who_[face]);
    for (const std::vector<int>& meet : at) {
      if (std::any_of(meet.begin(), meet.end(), [](int name) { return name < 0; })) continue;
      if (meet.size() != 3) return false;
      Tetrahedron t{i, 0, 0, 0};
      for (std::size_t k = 0; k < 3; ++k) t[k + 1] = names_[static_cast<std::size_t>(meet[k])].of;
      std::sort(t.begin(), t.end());
      corners.push_back(t);
    }
    return true;
  }

 private:
  /// How far the corners of the cell are from the particle; voro++ keeps their places times two.  [length]
  double farthest() { return 0.5 * std::sqrt(cell_.max_radius_squared()) * unit_; }

  /// Leaves of the cell what is no farther along a vector than `times` of it; false if nothing is left, or
  /// the cell is spoilt.
  bool cut(const Vec3d& d, double times, int name) {
    constexpr int faces_of_box = 6;
    if (++cuts_ + faces_of_box > cell_.current_delete2_size) {
      spoilt_ = needs_room_ = true;
      return false;
    }
    const int room = cell_.current_delete_size;
    const bool left =
        cell_.nplane(d.x / unit_, d.y / unit_, d.z / unit_, 2.0 * times * norm2(d) / (unit_ * unit_), name);
    spoilt_ = cell_.current_delete_size != room;
    return left && !spoilt_;
  }

  /// Cuts by the planes that are from `from` to `to` away from the particle.
  bool cut_by_planes(double from, double to) {
    for (std::size_t p = 0; p < away_.size(); ++p)
      if (away_[p] >= from && away_[p] < to &&
          !cut(unit_ * space_.planes[p].normal, away_[p] / unit_, first_wall))
        return false;
    return true;
  }

  /// voro++ 0.4.6 reads a list that it has given away when more than 256 corners of a cell lie in a plane
  /// that takes all of it (search_for_outside_edge). No face has more corners than there are other faces. The
  /// list stays as large as it has once been, and grows rightly where a plane takes nothing: of a prism with
  /// more sides, its own end.
  void make_room() {
    const int sides = cell_.current_delete2_size + 1;
    cell_.init(-2, 2, -2, 2, -1, 1);
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / sides;
      cell_.nplane(std::cos(angle), std::sin(angle), 0, 2, 0);
    }
    cell_.nplane(0, 0, 1, 2, 0);
    if (cell_.current_delete2_size < sides) throw std::logic_error("voro++ makes no room for corners");
  }

  /// The cell of a particle; false if nothing is left of it. voro++ 0.4.6 loses its place in the list of
  /// corners that a plane cuts off when that list must grow, from 256 on, and leaves a cell that does not
  /// close. The list stays as large, so that the cell is made again.
  bool cut_all(std::size_t i) {
    const double side = reach_ / unit_;
    bool left = false;
    do {
      if (std::exchange(needs_room_, false)) make_room();
      cuts_ = 0;
      cell_.init(-side, side, -side, side, -side, side);
      names_.clear();
      spoilt_ = false;
      left = cut_by_all(i);
    } while (spoilt_);
    return left;
  }

  /// Nearest rings first, until no particle of those that follow can reach the cell. A particle at the
  /// distance d bounds it at (d^2 + R_i^2 - R_j^2)/(2 d), which grows with d. Planes likewise: of a curved
  /// wall there are thousands, and few of them are near.
  bool cut_by_all(std::size_t i) {
    away_.clear();
    for (const Plane& p : space_.planes) away_.push_back(p.at - dot(bins_.at(i), p.normal));
    const double excess = sq(radius_[i]) - sq(largest_);
    double cut_to = -std::numeric_limits<double>::infinity();
    for (std::int64_t ring = 0;; ++ring) {
      if (!cut_by_ring(i, ring)) return false;
      const double known = bins_.known_after(i, ring),
                   to = std::min(farthest(), bins_.known_after(i, ring + 1));
      if (!cut_by_planes(cut_to, to)) return false;
      cut_to = std::max(cut_to, to);
      if (std::isinf(known) || (known > 0.0 && 0.5 * (known + excess / known) >= farthest())) break;
    }
    return cut_by_planes(cut_to, farthest());
  }

  bool cut_by_ring(std::size_t i, std::int64_t ring) {
    near_.clear();
    bins_.add_ring(i, ring, near_);
    order_.clear();
    for (std::size_t k = 0; k < near_.size(); ++k) {
      const double d2 = norm2(near_[k].d);
      if (d2 > 0.0)
        order_.push_back({0.5 * (d2 + sq(radius_[i]) - sq(radius_[near_[k].j])) / std::sqrt(d2), k});
    }
    std::sort(order_.begin(), order_.end());
    double far = farthest();
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const auto& [away, which] = order_[k];
      if (k % 8 == 7) far = farthest();
      if (away >= far) break;
      const Bins::Near& n = near_[which];
      names_.push_back({n.j, n.image, 0.0});
      if (!cut(n.d, away / norm(n.d), static_cast<int>(names_.size() - 1))) return false;
    }
    return true;
  }

  void add_faces(std::vector<VoronoiFace>& faces) {
    cell_.neighbors(who_);
    cell_.face_areas(areas_);
    const std::size_t before = faces.size();
    for (std::size_t k = 0; k < who_.size(); ++k) {
      if (who_[k] < 0 || !(areas_[k] > 0.0)) continue;
      VoronoiFace face = names_[static_cast<std::size_t>(who_[k])];
      face.area = areas_[k] * unit_ * unit_;
      faces.push_back(face);
    }
    std::sort(faces.begin() + static_cast<std::ptrdiff_t>(before), faces.end(),
              [](const VoronoiFace& a, const VoronoiFace& b) {
                return a.of != b.of ? a.of < b.of : a.image < b.image;
              });
  }

  static constexpr int first_wall = -7;  // voro++ has -1 to -6 for the box

  const VoronoiSpace& space_;
  const Bins& bins_;
  const std::vector<double>& radius_;
  double unit_, reach_, largest_ = 0.0;
  voro::voronoicell_neighbor cell_;
  bool spoilt_ = false, needs_room_ = false;
  int cuts_ = 0;                    // of the cell at hand
  std::vector<VoronoiFace> names_;  // of planes that have cut
  std::vector<Bins::Near> near_;
  std::vector<double> away_;  // of the planes
  std::vector<std::pair<double, std::size_t>> order_;
  std::vector<int> who_, of_faces_;
  std::vector<double> areas_;
};

}  // namespace

VoronoiCells voronoi_cells(const VoronoiSpace& space, const std::vector<Vec3d>& r,
                           const std::vector<double>& radius, int threads) {
  VoronoiCells cells;
  cells.first.assign(r.size() + 1, 0);
  cells.volume.resize(r.size());
  if (r.empty()) return cells;
  // what voro++ takes for one point is 1e-11 of a length of 1
  const double box = dot(space.edges[0], cross(space.edges[1], space.edges[2]));
  const double unit = std::cbrt(box / static_cast<double>(r.size()));
  if (!(unit > 0.0)) throw std::invalid_argument("cells of particles need room");
  const Bins bins(space, r);
  Crew crew(static_cast<std::size_t>(std::max(1, threads)));
  const std::size_t shares = crew.count();
  std::vector<std::vector<VoronoiFace>> faces(shares);
  crew.for_each([&](std::size_t share) {
    CellMaker maker(space, bins, radius, unit);
    for (std::size_t i = r.size() * share / shares; i < r.size() * (share + 1) / shares; ++i) {
      const std::size_t before = faces[share].size();
      cells.volume[i] = maker.make(i, faces[share]);
      cells.first[i + 1] = faces[share].size() - before;
    }
  });
  for (std::size_t i = 0; i < r.size(); ++i) cells.first[i + 1] += cells.first[i];
  for (const auto& part : faces) cells.faces.insert(cells.faces.end(), part.begin(), part.end());
  return cells;
}

std::optional<std::vector<Tetrahedron>> delaunay_tetrahedra(const VoronoiSpace& space,
                                                            const std::vector<Vec3d>& r) {
  const double box = dot(space.edges[0], cross(space.edges[1], space.edges[2]));
  const std::vector<double> none(r.size(), 0.0);
  const Bins bins(space, r);
  CellMaker maker(space, bins, none, std::cbrt(box / static_cast<double>(r.size())));
  std::vector<Tetrahedron> all;
  for (std::size_t i = 0; i < r.size(); ++i)
    if (!maker.add_corners(i, all)) return std::nullopt;
  std::sort(all.begin(), all.end());
  std::vector<Tetrahedron> once;
  for (std::size_t k = 0; k < all.size(); k += 4) {  // each is a corner of four cells
    if (k + 3 >= all.size() || all[k] != all[k + 3]) return std::nullopt;
    once.push_back(all[k]);
  }
  return once;
}

}  // namespace vbond::packing
