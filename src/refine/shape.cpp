// SPDX-License-Identifier: Apache-2.0
#include "refine/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "core/cancel_poll.h"
#include "core/vector_math.h"
#include "core/whole_progress.h"
#include "refine/facing.h"
#include "refine/relax.h"

namespace isoatlas {
namespace {

constexpr int kPasses = 24;
constexpr std::size_t kFewKept = 10;  // no more passes for the sake of errors once fewer than one change in so many helps
constexpr double kWorthIt = 1e-3;
constexpr int kRelaxRounds = 3;
constexpr int kLooksBack = 4;            // after relaxing, for cells that it took over their bounds
constexpr double kLeastAgreement = 0.3;  // cosine between normals before and after a flip

// What a change is for: a triangle's shape, or the errors of a cell that is over its bounds.
enum class Purpose { shape, errors };

// A change of one place of the mesh.
struct Change {
  double score = 0;  // worst of the triangles concerned, afterwards
  // A flip: triangles i and j become these.
  std::uint32_t i = kNone, j = kNone;
  DualTriangle first, second;
  // A move: cell's vertex goes to this c-vertex.
  CellId cell = kNone;
  CVertexId to = kNone;
  bool is_flip() const { return i != kNone; }
};

class Workshop {
 public:
  /// @param meeting  careful: no change is kept that makes triangles meet, and then also vertices and edges may change that were given up;
  ///                 none: whether they do is not looked at
  Workshop(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control,
           IntersectionTracker* meeting = nullptr)
      : work_(work),
        goal_(goal),
        triangles_(triangles),
        control_(control),
        meeting_(meeting),
        places_(work.places()),
        rings_(work.places().offset.empty() ? 2 : 3) {
    occupied_.assign(work.ground().graph.c_vertex_count(), 0);
    for (const CVertexId v : places_.anchor) occupied_[v] = 1;
  }

  void run(Purpose purpose, std::span<const CellId> cells, ShapeReport& report) {
    for (int k = 0; k < kPasses; ++k) {
      report_going_on(control_);
      const std::size_t kept_before = report.flips + report.moves;
      const std::size_t tried = pass(purpose, cells, report);
      const std::size_t kept = report.flips + report.moves - kept_before;
      if (tried == 0 || (purpose == Purpose::errors && kept * kFewKept < tried)) break;
    }
    report.bad = bad_triangles().size();
  }

  // Moves vertices that are not frozen a little. Where that takes a cell over its bounds they go back. @return false if none moved
  bool relax_bad(ShapeReport& report) {
    const Ground& ground = work_.ground();
    const LevelMesh& mesh = work_.mesh();
    std::vector<Vec3> points = mesh.point;
    std::vector<Triangle> triangles;
    triangles.reserve(triangles_.size());
    for (const DualTriangle& t : triangles_) triangles.push_back(t.cell);
    std::vector<Roam> roam(mesh.cell_count());
    for (CellId c = 0; c < mesh.cell_count(); ++c) {
      const CVertexId v = places_.anchor[c];
      if (work_.is_frozen(c) || !may_move(c) || is_held(c) || !ground.may_roam(v)) {
        roam[c] = {points[c], points[c]};
        continue;
      }
      const Vec3 balanced = points[c] - places_.base(ground.surfels, c);
      roam[c] = roam_of(ground.complex.positions[v], ground.complex.spacing);
      roam[c] = {roam[c].low + balanced, roam[c].high + balanced};
    }
    const InterpolatedField* field = ground.isosurface == nullptr ? nullptr : &ground.isosurface->field();
    std::vector<CellId> moved = relax(points, triangles, mesh.triangles_of, roam, field, ground.complex.spacing, {goal_.aspect, 0}, control_);
    if (moved.empty()) return false;
    report_going_on(control_);

    if (places_.shift.empty()) places_.shift.resize(mesh.cell_count());
    const std::vector<CellError> before = work_.errors();
    const std::vector<Vec3> old_shift = places_.shift;
    for (const CellId c : moved) places_.shift[c] = places_.shift[c] + (points[c] - mesh.point[c]);
    held_.resize(mesh.cell_count(), 0);
    keep_from_straying(old_shift);
    std::vector<CellId> concerned = rings_around(moved, rings_);
    work_.remesh(triangles_, places_, concerned);
    const int looks = meeting_ == nullptr ? kLooksBack : kLooksBack + 1;
    for (int look = 0; look < looks; ++look) {
      report_going_on(control_);
      std::vector<CellId> worse = meeting_corners();
      for (const CellId c : concerned) {
        if (work_.errors()[c].excess > std::max(1.0, before[c].excess * (1 + kWorthIt))) worse.push_back(c);
      }
      if (worse.empty()) break;
      // At last everything around goes back, and if triangles must not meet, everything.
      worse = look >= kLooksBack ? moved : rings_around(worse, look + 1 < kLooksBack ? 1 : rings_);
      for (const CellId c : worse) {
        places_.shift[c] = old_shift[c];
        held_[c] = 1;
      }
      const std::vector<CellId> strayed = keep_from_straying(old_shift);
      worse.insert(worse.end(), strayed.begin(), strayed.end());
      concerned = rings_around(worse, rings_);
      work_.remesh(triangles_, places_, concerned);
    }
    for (const CellId c : moved) report.shifts += !(places_.shift[c] == old_shift[c]);
    return true;
  }

  // Vertices that are not frozen go back to their c-vertices where surfels of one grid cell meet as all are now. @return whether any did
  bool settle() {
    if (places_.shift.empty()) return false;
    std::vector<Vec3> home = places_.shift;
    for (CellId c = 0; c < home.size(); ++c) {
      if (!work_.is_frozen(c)) home[c] = {};
    }
    const std::vector<CellId> back = keep_from_straying(home);
    if (!back.empty()) work_.remesh(triangles_, places_, rings_around(back, rings_));
    return !back.empty();
  }

  // Flips around these cells; where there are none, moves. What that takes over its bounds follows. @return whether there was anything
  bool take_back(std::vector<CellId> cells) {
    const std::vector<CellError> before = work_.errors();
    places_.given_up.resize(work_.mesh().cell_count(), 0);
    bool any = false;
    for (int look = 0; !cells.empty(); ++look) {
      std::vector<CellId> changed = take_back_flips(cells);
      for (const CellId c : cells) {
        if (places_.given_up[c] == 1 && std::binary_search(changed.begin(), changed.end(), c)) continue;
        const bool was_given_up = std::exchange(places_.given_up[c], std::uint8_t{3}) == 3;
        if (put_back(c) || !was_given_up) changed.push_back(c);
      }
      if (changed.empty()) break;
      any = true;
      const std::vector<CellId> concerned = rings_around(changed, rings_);
      work_.remesh(triangles_, places_, concerned);
      std::vector<CellId> worse;
      for (const CellId c : concerned) {
        if (work_.errors()[c].excess > std::max(1.0, before[c].excess * (1 + kWorthIt))) worse.push_back(c);
      }
      cells = worse.empty() ? worse : rings_around(worse, look + 1 < kLooksBack ? 1 : rings_);
    }
    return any;
  }

 private:
  // Flipped triangles become the dual's again, those that have a corner in common together. @return their corners, sorted
  std::vector<CellId> take_back_flips(std::span<const CellId> cells) {
    const std::vector<DualTriangle>& dual = work_.triangles();
    std::vector<std::uint8_t> is_near(work_.mesh().cell_count(), 0);
    for (const CellId c : cells) is_near[c] = 1;
    std::vector<std::uint32_t> flipped;
    for (std::uint32_t i = 0; i < dual.size(); ++i) {
      if (triangles_[i].cell != dual[i].cell) flipped.push_back(i);
    }
    std::vector<CellId> changed;
    for (std::size_t before = kNone; before != flipped.size();) {
      before = flipped.size();
      std::erase_if(flipped, [&](std::uint32_t i) {
        std::array<CellId, 6> corners;
        std::copy(dual[i].cell.begin(), dual[i].cell.end(),
                  std::copy(triangles_[i].cell.begin(), triangles_[i].cell.end(), corners.begin()));
        if (std::none_of(corners.begin(), corners.end(), [&](CellId c) { return is_near[c]; })) return false;
        for (const CellId c : corners) is_near[c] = 1;
        changed.insert(changed.end(), corners.begin(), corners.end());
        triangles_[i] = dual[i];
        return true;
      });
    }
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    for (const CellId c : changed) places_.given_up[c] = std::max(places_.given_up[c], std::uint8_t{1});
    return changed;
  }

  // A vertex that is not frozen to its site, if that is free. @return whether it was elsewhere
  bool put_back(CellId c) {
    if (work_.is_frozen(c)) return false;
    const CVertexId site = work_.partition().site[c];
    const bool shifted = !places_.shift.empty() && std::exchange(places_.shift[c], Vec3{}) != Vec3{};
    if (places_.anchor[c] == site || occupied_[site]) return shifted;
    occupied_[places_.anchor[c]] = 0;
    occupied_[site] = 1;
    places_.anchor[c] = site;
    return true;
  }

  Vec3 facing_of(std::uint32_t i) const {
    const LevelMesh& mesh = work_.mesh();
    return facing(
        i, [&](std::uint32_t t) { return mesh.triangles[t].corner; },
        [&](auto add) {
          for (const CellId c : mesh.triangles[i].cell) {
            for (const std::uint32_t t : mesh.triangles_of.row(c)) add(t);
          }
        });
  }

  bool may_move(CellId c) const { return meeting_ != nullptr || places_.may_move(c); }
  bool may_flip(CellId c) const { return meeting_ != nullptr || places_.may_flip(c); }
  // If careful: corners of triangles that meet now.
  std::vector<CellId> meeting_corners() const {
    if (meeting_ == nullptr) return {};
    return meeting_->update(work_.positions(), cells_of(triangles_), control_);
  }

  bool is_held(CellId c) const { return c < held_.size() && held_[c] != 0; }
  double score(const MeshTriangle& t) const { return goal_.score(t.corner[0], t.corner[1], t.corner[2]); }

  std::vector<std::uint32_t> bad_triangles() const {
    std::vector<std::pair<double, std::uint32_t>> found;
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const double s = score(work_.mesh().triangles[i]);
      if (s < 1) found.emplace_back(s, i);
    }
    control_.check_cancelled();
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> out;
    for (const auto& [s, i] : found) out.push_back(i);
    return out;
  }

  // Those of the cells that are over their bounds, the worst first.
  std::vector<CellId> over_bounds(std::span<const CellId> cells) const {
    std::vector<std::pair<double, CellId>> found;
    for (const CellId c : cells) {
      if (work_.errors()[c].excess > 1) found.emplace_back(-work_.errors()[c].excess, c);
    }
    std::sort(found.begin(), found.end());
    std::vector<CellId> out;
    for (const auto& [excess, c] : found) out.push_back(c);
    return out;
  }

  // One change for every bad triangle, or for every cell to mend that is over its bounds, that has one and is far from the others'.
  // @return how many were tried
  std::size_t pass(Purpose purpose, std::span<const CellId> cells_to_mend, ShapeReport& report) {
    const LevelMesh& mesh = work_.mesh();
    std::vector<std::uint8_t> taken(mesh.cell_count(), 0);
    const auto is_taken = [&](CellId c) { return taken[c] != 0; };
    std::vector<Change> changes;
    std::vector<std::vector<CellId>> concerned;
    const auto take = [&](const Change& change, std::uint32_t i) {
      if (change.score == 0) return;
      const std::vector<CellId> near = surroundings(mesh.triangles[i].cell);
      if (std::any_of(near.begin(), near.end(), is_taken)) return;
      for (const CellId c : near) taken[c] = 1;
      changes.push_back(change);
      concerned.push_back(near);
    };
    if (purpose == Purpose::errors) {
      for (const CellId cell : over_bounds(cells_to_mend)) {
        if (is_taken(cell)) continue;
        Change best;
        for (const std::uint32_t i : mesh.triangles_of.row(cell)) consider_flips(i, std::nullopt, best);
        consider_moves(cell, std::nullopt, best);
        take(best, best.is_flip() ? best.i : mesh.triangles_of.row(cell)[0]);
      }
    } else {
      control_.check_cancelled();
      CancelPoll poll(control_);
      for (const std::uint32_t i : bad_triangles()) {
        poll.step();
        if (std::any_of(mesh.triangles[i].cell.begin(), mesh.triangles[i].cell.end(), is_taken)) continue;  // most end here
        Change best;
        consider_flips(i, kWorthIt, best);
        for (const CellId cell : mesh.triangles[i].cell) consider_moves(cell, kWorthIt, best);
        take(best, i);
      }
    }
    if (changes.empty()) return 0;
    control_.check_cancelled();

    const std::vector<CellError> before = work_.errors();
    const std::vector<DualTriangle> old_triangles = triangles_;
    const Places old_places = places_;
    std::vector<CellId> cells;
    for (const auto& near : concerned) cells.insert(cells.end(), near.begin(), near.end());
    std::sort(cells.begin(), cells.end());
    for (const Change& c : changes) apply(c);
    work_.remesh(triangles_, places_, cells);

    std::vector<std::uint8_t> is_kept(changes.size(), 1);
    std::vector<CellId> stale;  // around what was taken back
    const auto take_back = [&](std::size_t k) {
      const Change& c = changes[k];
      is_kept[k] = 0;
      stale.insert(stale.end(), concerned[k].begin(), concerned[k].end());
      refused_.push_back(key(c));
      if (c.is_flip()) {
        triangles_[c.i] = old_triangles[c.i];
        triangles_[c.j] = old_triangles[c.j];
        return;
      }
      occupied_[places_.anchor[c.cell]] = 0;
      places_.anchor[c.cell] = old_places.anchor[c.cell];
      if (!places_.shift.empty()) places_.shift[c.cell] = old_places.shift[c.cell];
      occupied_[places_.anchor[c.cell]] = 1;
    };
    for (std::size_t k = 0; k < changes.size(); ++k) {
      bool worse = false;
      double most_before = 0, most_after = 0;
      for (const CellId cell : concerned[k]) {
        const double was = before[cell].excess, is = work_.errors()[cell].excess;
        worse = worse || is > std::max(1.0, was * (1 + kWorthIt));
        most_before = std::max(most_before, was);
        most_after = std::max(most_after, is);
      }
      if (worse || (purpose == Purpose::errors && most_after > most_before * (1 - kWorthIt))) take_back(k);
    }
    const auto measure_again = [&] {
      std::sort(stale.begin(), stale.end());
      if (!stale.empty()) work_.remesh(triangles_, places_, stale);
      stale.clear();
    };
    measure_again();
    for (std::vector<CellId> corners = meeting_corners(); !corners.empty(); corners = meeting_corners()) {
      bool any = false;
      for (std::size_t k = 0; k < changes.size(); ++k) {
        const auto is_corner = [&](CellId c) { return std::binary_search(corners.begin(), corners.end(), c); };
        if (is_kept[k] == 0 || std::none_of(concerned[k].begin(), concerned[k].end(), is_corner)) continue;
        take_back(k);
        any = true;
      }
      if (!any) break;
      measure_again();
    }
    for (std::size_t k = 0; k < changes.size(); ++k) {
      if (is_kept[k]) ++(changes[k].is_flip() ? report.flips : report.moves);
    }
    std::sort(refused_.begin(), refused_.end());
    return changes.size();
  }

  // Vertices whose shift is another one than before get that again where surfels of one grid cell would meet. @return their cells
  std::vector<CellId> keep_from_straying(const std::vector<Vec3>& before) {
    const Ground& ground = work_.ground();
    if (ground.roaming == nullptr || places_.shift.empty()) return {};
    std::vector<CellId> movers;
    std::vector<CVertexId> c_vertices;
    std::vector<Vec3> start, now = ground.complex.positions;
    for (CellId c = 0; c < places_.shift.size(); ++c) {
      const CVertexId v = places_.anchor[c];
      now[v] = base_position(ground.complex, places_, c);
      if (places_.shift[c] == before[c]) continue;
      movers.push_back(c);
      c_vertices.push_back(v);
      start.push_back(displaced(ground.complex, v, before[c]));
    }
    if (movers.empty()) return {};
    std::vector<CVertexId> back = ground.roaming->stray(c_vertices, start, now, c_vertices);
    std::sort(back.begin(), back.end());
    held_.resize(work_.mesh().cell_count(), 0);
    std::vector<CellId> out;
    for (const CellId c : movers) {
      if (!std::binary_search(back.begin(), back.end(), places_.anchor[c])) continue;
      places_.shift[c] = before[c];
      held_[c] = 1;
      out.push_back(c);
    }
    return out;
  }

  using Key = std::pair<std::uint64_t, std::uint64_t>;
  Key key(const Change& c) const {
    if (!c.is_flip()) return {static_cast<std::uint64_t>(c.cell) << 32 | kNone, c.to};
    return {static_cast<std::uint64_t>(std::min(c.first.cell[0], c.first.cell[1])) << 32 | std::max(c.first.cell[0], c.first.cell[1]),
            1ull << 40};
  }
  bool is_refused(const Change& c) const { return std::binary_search(refused_.begin(), refused_.end(), key(c)); }

  // The cells whose metrics look at triangles that a change of one of a triangle with these corners touches, sorted.
  std::vector<CellId> surroundings(const std::array<CellId, 3>& of) const { return rings_around(of, rings_); }

  // The cells and those around them, so many rings, sorted.
  std::vector<CellId> rings_around(std::span<const CellId> of, int rings) const {
    const LevelMesh& mesh = work_.mesh();
    std::vector<CellId> out(of.begin(), of.end());
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<CellId> more;
      for (const CellId c : out) {
        for (const std::uint32_t t : mesh.triangles_of.row(c))
          more.insert(more.end(), mesh.triangles[t].cell.begin(), mesh.triangles[t].cell.end());
      }
      std::sort(more.begin(), more.end());
      more.erase(std::unique(more.begin(), more.end()), more.end());
      out = std::move(more);
    }
    return out;
  }

  // What a score has to be after a change: better by `gain`; without it, good enough or no worse.
  static double enough(double was, std::optional<double> gain) { return gain ? was + *gain : std::min(1.0, was); }

  void consider_flips(std::uint32_t i, std::optional<double> gain, Change& best) const {
    const LevelMesh& mesh = work_.mesh();
    const MeshTriangle& t = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const CellId a = t.cell[k], b = t.cell[(k + 1) % 3], c = t.cell[(k + 2) % 3];
      std::uint32_t j = kNone;
      CellId d = kNone;
      for (const std::uint32_t other : mesh.triangles_of.row(a)) {
        const auto& o = mesh.triangles[other].cell;
        for (std::size_t m = 0; m < 3; ++m) {
          if (o[m] == b && o[(m + 1) % 3] == a) {
            j = other;
            d = o[(m + 2) % 3];
          }
        }
      }
      if (j == kNone || !may_flip(a) || !may_flip(b) || !may_flip(c) || !may_flip(d)) continue;
      if (mesh.triangles_of.row(a).size() <= 3 || mesh.triangles_of.row(b).size() <= 3) continue;
      bool exists = false;
      for (const std::uint32_t other : mesh.triangles_of.row(c)) {
        for (const CellId e : mesh.triangles[other].cell) exists = exists || e == d;
      }
      if (exists) continue;
      const Vec3 pa = mesh.point[a], pb = mesh.point[b], pc = mesh.point[c], pd = mesh.point[d];
      const double was = std::min(score(t), score(mesh.triangles[j]));
      const double now = std::min(goal_.score(pa, pd, pc), goal_.score(pd, pb, pc));
      if (now < enough(was, gain) || now <= best.score) continue;
      const Vec3 n = normalized(facing_of(i) + facing_of(j));
      if (dot(n, normalized(cross(pd - pa, pc - pa))) < kLeastAgreement || dot(n, normalized(cross(pb - pd, pc - pd))) < kLeastAgreement)
        continue;
      Change change;
      change.score = now;
      change.i = i;
      change.j = j;
      change.first = {{d, c, a}, triangles_[i].at};
      change.second = {{c, d, b}, triangles_[j].at};
      if (!is_refused(change)) best = change;
    }
  }

  // To other c-vertices of the cell.
  void consider_moves(CellId cell, std::optional<double> gain, Change& best) const {
    const LevelMesh& mesh = work_.mesh();
    const Ground& ground = work_.ground();
    const CVertexId from = places_.anchor[cell];
    if (work_.is_frozen(cell) || !may_move(cell) || ground.graph.on_boundary[from]) return;
    double was = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : mesh.triangles_of.row(cell)) was = std::min(was, score(mesh.triangles[t]));
    const auto consider = [&](CVertexId to) {
      if (occupied_[to] || ground.graph.on_boundary[to] || work_.partition().cell_of[to] != cell) return;
      const Vec3 p = mesh.point[cell] + (ground.surfels.point[to] - places_.base(ground.surfels, cell));
      double now = std::numeric_limits<double>::infinity();
      for (const std::uint32_t t : mesh.triangles_of.row(cell)) {
        std::array<Vec3, 3> q = mesh.triangles[t].corner;
        for (std::size_t k = 0; k < 3; ++k) {
          if (mesh.triangles[t].cell[k] == cell) q[k] = p;
        }
        if (dot(normalized(cross(q[1] - q[0], q[2] - q[0])), normalized(facing_of(t))) < kLeastAgreement) return;
        now = std::min(now, goal_.score(q[0], q[1], q[2]));
      }
      if (now < enough(was, gain) || now <= best.score) return;
      Change change;
      change.score = now;
      change.cell = cell;
      change.to = to;
      if (!is_refused(change)) best = change;
    };
    for (const CVertexId v : mesh.c_vertices_of.row(cell)) consider(v);
  }

  void apply(const Change& c) {
    if (c.is_flip()) {
      triangles_[c.i] = c.first;
      triangles_[c.j] = c.second;
    } else {
      occupied_[places_.anchor[c.cell]] = 0;
      places_.anchor[c.cell] = c.to;
      if (!places_.shift.empty()) places_.shift[c.cell] = {};
      occupied_[c.to] = 1;
    }
  }

  MeasuredCovering& work_;
  const ShapeGoal& goal_;
  std::vector<DualTriangle>& triangles_;
  const RunControl& control_;
  IntersectionTracker* meeting_;           // none: triangles may meet
  Places places_;                       // offsets are the work's own business
  std::vector<std::uint8_t> occupied_;  // per c-vertex, 1 if a vertex sits there
  std::vector<Key> refused_;
  std::vector<std::uint8_t> held_;  // per cell, 1 if moving it was taken back
  int rings_;                       // of cells around a change that it concerns; balancing moves vertices beside it
};

}  // namespace

ShapeGoal ShapeGoal::of(double aspect) {
  const ShapeGoal usual;
  return {aspect, usual.sine * std::min(1.0, aspect / usual.aspect)};
}

double ShapeGoal::score(Vec3 a, Vec3 b, Vec3 c) const {
  std::array<double, 3> squared{squared_length(b - a), squared_length(c - b), squared_length(a - c)};
  std::sort(squared.begin(), squared.end());
  if (!(squared[0] > 0)) return 0;
  const double ratio = std::sqrt(squared[0] / squared[2]);
  const double smallest = length(cross(b - a, c - a)) / std::sqrt(squared[1] * squared[2]);
  return std::min(ratio / aspect, smallest / sine);
}

ShapeReport improve_shape(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control) {
  ShapeReport report;
  triangles.assign(work.triangles().begin(), work.triangles().end());
  std::vector<CellId> over;
  for (CellId c = 0; c < work.errors().size(); ++c) {
    if (work.errors()[c].excess > 1) over.push_back(c);
  }
  work.remesh(triangles, work.places(), over);
  Workshop workshop(work, goal, triangles, control);
  workshop.run(Purpose::shape, {}, report);
  for (int round = 0; round < kRelaxRounds && report.bad > 0 && workshop.relax_bad(report); ++round)
    workshop.run(Purpose::shape, {}, report);
  return report;
}

void improve_shape_carefully(MeasuredCovering& work, const ShapeGoal& goal, IntersectionTracker& meeting, std::vector<DualTriangle>& triangles,
                             ShapeReport& report, const RunControl& control) {
  Workshop workshop(work, goal, triangles, control, &meeting);
  for (int round = 0; round < kRelaxRounds && report.bad > 0 && workshop.relax_bad(report); ++round)
    workshop.run(Purpose::shape, {}, report);
}

void improve_errors(MeasuredCovering& work, const ShapeGoal& goal, std::span<const CellId> cells, std::vector<DualTriangle>& triangles,
                    ShapeReport& report, const RunControl& control) {
  Workshop(work, goal, triangles, control).run(Purpose::errors, cells, report);
}

std::vector<CellId> take_back_meeting(MeasuredCovering& work, const ShapeGoal& goal, IntersectionTracker& meeting,
                                      std::vector<DualTriangle>& triangles, const RunControl& control) {
  Workshop workshop(work, goal, triangles, control);
  for (;;) {
    std::vector<CellId> corners = meeting.update(work.positions(), cells_of(triangles), control);
    if (corners.empty() || !workshop.take_back(corners)) return corners;
  }
}

bool settle_vertices(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control) {
  return Workshop(work, goal, triangles, control).settle();
}

void take_back_all(MeasuredCovering& work, const ShapeGoal& goal, std::vector<DualTriangle>& triangles, const RunControl& control) {
  std::vector<CellId> all(work.mesh().cell_count());
  std::iota(all.begin(), all.end(), 0u);
  Workshop(work, goal, triangles, control).take_back(std::move(all));
}

}  // namespace isoatlas
