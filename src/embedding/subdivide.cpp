// SPDX-License-Identifier: Apache-2.0
#include "embedding/subdivide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/append.h"
#include "core/cancel_poll.h"
#include "core/parallel.h"
#include "core/ranges.h"
#include "core/vector_math.h"
#include "field/field.h"

namespace isoatlas::detail {
namespace {

// Points keep this distance from the edges of their walls and from the walls of their grid cells.
// Nodes keep more distance from the ends of their edges, since there may be other nodes near them
// on other edges: all of them may become vertices. (Chords of two nodes keep kWallMargin if nodes
// keep kNodeMargin.)
constexpr double kNodeMargin = 2 * kWallMargin;
constexpr int kNewtonSteps = 3;
constexpr double kShortestSplitSide =
    0.02;  // shortest side within a grid cell that is split; in sample-index units
constexpr double kTowardsCurve = 0.75;
constexpr std::size_t kFacesPerChunk = 4096;  // faces or sides per piece of a parallel loop

using Point = std::array<double, 3>;
Point as_array(Vec3 p) { return {p.x, p.y, p.z}; }
Vec3 as_vector(const Point& p) { return {p[0], p[1], p[2]}; }
bool is_integer(double x) { return x == std::floor(x); }

// The smallest box with integer corners around some points.
struct Box {
  Point low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  void include(Vec3 position) {
    const Point p = as_array(position);
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], std::floor(p[a]));
      high[a] = std::max(high[a], std::ceil(p[a]));
    }
  }
  bool is_in_one_cell() const {
    return high[0] - low[0] <= 1 && high[1] - low[1] <= 1 && high[2] - low[2] <= 1;
  }
};

Box box_of(const SurfaceComplex& complex, const Face& face) {
  Box box;
  for (int k = 0; k < face.size(); ++k) box.include(complex.positions[face.corner[k]]);
  return box;
}

// A side of a face that is to be split.
struct Side {
  CVertexId a, b;  // a < b
  Vec3 node;       // the node of one of its faces, if it crosses a wall
  bool same_as(const Side& o) const { return a == o.a && b == o.b; }
};

// The field on the wall that a point is on, bilinear in the wall's four corners, as parsing uses
// it.
class BilinearWall {
 public:
  BilinearWall(const InterpolatedField& field, Vec3 point) : low_(as_array(point)) {
    std::size_t k = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!is_integer(low_[a]) && k < 2) along_[k++] = a;
      low_[a] = std::floor(low_[a]);
    }
    for (k = 0; k < 4; ++k) {
      Point corner = low_;
      corner[along_[0]] += static_cast<double>(k & 1);
      corner[along_[1]] += static_cast<double>(k >> 1);
      f_[k] = field.at_sample(as_vector(corner));
    }
    f_ = rescaled(f_);
  }

  double value(Vec3 point) const {
    const Point p = as_array(point);
    const double u = p[along_[0]] - low_[along_[0]], v = p[along_[1]] - low_[along_[1]];
    return (1 - v) * ((1 - u) * f_[0] + u * f_[1]) + v * ((1 - u) * f_[2] + u * f_[3]);
  }

  // Signs alternate: two curves of the surface cross the wall, each around one of two opposite
  // corners.
  bool has_two_curves() const {
    const auto inside = [&](std::size_t k) { return f_[k] >= 0; };
    return inside(0) == inside(3) && inside(1) == inside(2) && inside(0) != inside(1);
  }

 private:
  Point low_;
  std::array<std::size_t, 2> along_{0, 1};
  std::array<double, 4> f_;
};

bool crosses_wall(const SurfaceComplex& complex, CVertexId a, CVertexId b) {
  Box box;
  box.include(complex.positions[a]);
  box.include(complex.positions[b]);
  return !box.is_in_one_cell();
}

// Whether a side that crosses a wall must be split there so that its faces are pieces of cones;
// otherwise they might intersect others.
bool needs_point_on_wall(const SurfaceComplex& complex, const SurfaceInGrid& in, CVertexId a,
                         CVertexId b) {
  const auto is_multi_sheet = [&](CVertexId v) {
    return v < in.multi_sheet.size() && in.multi_sheet[v] != 0;
  };
  if (is_multi_sheet(a) || is_multi_sheet(b)) return true;
  const Point p = as_array(complex.positions[a]), q = as_array(complex.positions[b]);
  Point on_wall;
  int walls = 0;
  for (std::size_t x = 0; x < 3; ++x) {
    on_wall[x] = std::floor(p[x]) + 0.5;
    if (std::floor(p[x]) == std::floor(q[x])) continue;
    on_wall[x] = std::max(std::floor(p[x]), std::floor(q[x]));
    ++walls;
  }
  return walls == 1 && has_two_curves(in.field, as_vector(on_wall));
}

Fineness fineness_of(const SurfaceComplex& complex, const SurfaceInGrid& in, const Face& face) {
  if (!face.is_triangle()) return Fineness::faces;
  if (box_of(complex, face).is_in_one_cell()) return Fineness::pieces;
  for (std::size_t k = 0; k < 3; ++k) {
    const CVertexId a = face.corner[k], b = face.corner[(k + 1) % 3];
    if (crosses_wall(complex, a, b) && needs_point_on_wall(complex, in, a, b))
      return Fineness::faces;
  }
  return Fineness::fans;
}

class Subdivider {
 public:
  Subdivider(const SurfaceComplex& complex, std::span<const CVertexId> wanted,
             std::span<const Fineness> current, const SurfaceInGrid& in)
      : complex_(complex),
        in_(in),
        field_(in.field),
        poll_(in.control),
        targets_(complex.c_vertex_count(), Target::nothing) {
    for (const CVertexId v : wanted) {
      targets_[v] = current[v] == Fineness::faces  ? Target::fans
                    : current[v] == Fineness::fans ? Target::pieces
                                                   : Target::smaller_pieces;
    }
    // For a node, the sides opposite to it are the ones that cross walls.
    std::vector<std::pair<CVertexId, Target>> opposite;
    for (const Face& face : complex.faces) {
      poll_.step();
      if (!face.is_triangle()) continue;
      const auto& c = face.corner;
      for (std::size_t k = 0; k < 3; ++k) {
        const CVertexId a = c[(k + 1) % 3];
        const Target target = std::min(targets_[c[k]], Target::pieces);
        if (target > targets_[a] && current[a] != Fineness::pieces &&
            crosses_wall(complex, a, c[(k + 2) % 3]))
          opposite.emplace_back(a, target);
      }
    }
    for (const auto& [v, target] : opposite) targets_[v] = std::max(targets_[v], target);
  }

  Subdivision run() {
    out_.complex = complex_;
    find_sides();
    std::vector<Vec3> midpoints(sides_.size());
    for_each_index(sides_.size(), kFacesPerChunk, in_.control,
                   [&](std::size_t i) { midpoints[i] = midpoint(sides_[i]); });
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      poll_.step();
      add_c_vertex(midpoints[i], sides_[i].a, sides_[i].is_boundary);
      if (!sides_[i].crosses) out_.between.back() = {sides_[i].a, sides_[i].b};
    }
    for (FaceId f = 0; f < complex_.face_count(); ++f) {
      poll_.step();
      if (is_split(complex_.faces[f])) split_face(f);
    }
    split_boundary();
    checked_id(out_.complex.faces.size(), "faces");
    return std::move(out_);
  }

 private:
  enum class Target : std::uint8_t { nothing, fans, pieces, smaller_pieces };

  struct SplitSide {
    CVertexId a, b;
    Vec3 first_node, second_node;
    bool crosses, is_boundary;
  };

  bool is_split(const Face& face) const {
    bool any = false;
    for (int k = 0; k < face.size(); ++k) any = any || targets_[face.corner[k]] != Target::nothing;
    if (!any) return false;
    if (!face.is_triangle()) return true;
    for (int k = 0; k < face.size(); ++k) {
      if (is_marked(face.corner[k], face.corner[(k + 1) % face.size()])) return true;
    }
    return false;
  }
  bool is_marked(CVertexId a, CVertexId b) const {
    const Target largest = std::max(targets_[a], targets_[b]);
    if (largest == Target::nothing || is_on_shared_face(a, b)) return false;
    if (crosses_wall(complex_, a, b))
      return largest >= Target::pieces || needs_point_on_wall(complex_, in_, a, b);
    // Triangles that are not in one grid cell yet are split at walls first.
    return largest == Target::smaller_pieces &&
           squared_distance(complex_.positions[a], complex_.positions[b], {1, 1, 1}) >
               kShortestSplitSide * kShortestSplitSide;
  }

  // Both blocks have such a side, so it stays as it is. It is in one grid face.
  bool is_on_shared_face(CVertexId a, CVertexId b) const {
    return complex_.on_boundary[a] == kOnSharedFace && complex_.on_boundary[b] == kOnSharedFace;
  }

  CVertexId add_c_vertex(Vec3 position, CVertexId origin, bool on_boundary) {
    const CVertexId id = checked_id(out_.complex.positions.size(), "c-vertices");
    out_.complex.positions.push_back(rounded(position));
    out_.complex.on_boundary.push_back(on_boundary);
    out_.origin.push_back(origin);
    out_.between.push_back({kNone, kNone});
    return id;
  }

  void add_sides(const Face& face, std::vector<Side>& found) const {
    const int size = face.size();
    const bool crosses = !box_of(complex_, face).is_in_one_cell();
    const Vec3 node = crosses ? node_of(face) : Vec3{};
    for (int k = 0; k < size; ++k) {
      const CVertexId a = face.corner[k], b = face.corner[(k + 1) % size];
      if (!is_marked(a, b) || (crosses && is_on_volume_boundary(a, b))) continue;
      found.push_back({std::min(a, b), std::max(a, b), node});
    }
  }

  // Every marked side once, with the nodes of its one or two faces.
  void find_sides() {
    std::vector<Side> found =
        collect_chunks<Side>(complex_.face_count(), kFacesPerChunk,
                             [&](std::size_t begin, std::size_t end, auto& sides) {
                               if (in_.control != nullptr) in_.control->check_cancelled();
                               for (std::size_t f = begin; f < end; ++f) {
                                 if (is_split(complex_.faces[f]))
                                   add_sides(complex_.faces[f], sides);
                               }
                             });
    if (in_.control != nullptr) in_.control->check_cancelled();
    const auto order = [](const Side& x, const Side& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    };
    std::stable_sort(found.begin(), found.end(), order);
    for (std::size_t i = 0; i < found.size();) {
      const bool has_two_faces = i + 1 < found.size() && found[i + 1].same_as(found[i]);
      const Side &first = found[i], &second = found[i + (has_two_faces ? 1 : 0)];
      sides_.push_back({first.a, first.b, first.node, second.node,
                        crosses_wall(complex_, first.a, first.b), !has_two_faces});
      i += has_two_faces ? 2 : 1;
    }
  }

  // Sides along the volume boundary from one grid face to the next are split at the node, together
  // with their face.
  bool is_on_volume_boundary(CVertexId a, CVertexId b) const {
    return complex_.on_boundary[a] && complex_.on_boundary[b] && crosses_wall(complex_, a, b);
  }

  CVertexId midpoint_of(CVertexId a, CVertexId b) const {
    if (a > b) std::swap(a, b);
    const auto at =
        std::lower_bound(sides_.begin(), sides_.end(), std::pair(a, b),
                         [](const SplitSide& s, const std::pair<CVertexId, CVertexId>& key) {
                           return std::pair(s.a, s.b) < key;
                         });
    if (at == sides_.end() || at->a != a || at->b != b) return kNone;
    return complex_.c_vertex_count() + static_cast<CVertexId>(at - sides_.begin());
  }

  // Where the surface intersects the grid edge that the face goes around: for a triangle of a fan
  // one of its corners, for a quad computed on the edge.
  Vec3 node_of(const Face& face) const {
    if (face.is_triangle()) {
      Vec3 best;
      int largest = -1;
      for (const CVertexId v : {face.corner[0], face.corner[1], face.corner[2]}) {
        const Point p = as_array(complex_.positions[v]);
        const int whole = is_integer(p[0]) + is_integer(p[1]) + is_integer(p[2]);
        if (whole > largest) {
          largest = whole;
          best = complex_.positions[v];
        }
      }
      return best;
    }
    const Box box = box_of(complex_, face);
    // For an edge along `axis` the corners are in one layer along it, and in two layers (or on the
    // volume boundary) along the other axes.
    std::size_t axis = 3;
    for (std::size_t a = 0; a < 3; ++a) {
      if (box.high[a] - box.low[a] <= 1 && !edge_is_across(face, a)) axis = axis == 3 ? a : 4;
    }
    if (axis >= 3) return mean_of(face);
    Point low;
    for (std::size_t a = 0; a < 3; ++a)
      low[a] = a == axis                       ? box.low[a]
               : box.high[a] - box.low[a] == 2 ? box.low[a] + 1
                                               : volume_boundary_of(face, a);
    const double t = field_.zero_on_edge(as_vector(low), static_cast<int>(axis)).value_or(0.5);
    low[axis] += std::clamp(t, kNodeMargin, 1 - kNodeMargin);
    return as_vector(low);
  }
  // Whether some corner is on a wall normal to the axis; then the edge is on the volume boundary.
  bool edge_is_across(const Face& face, std::size_t axis) const {
    for (int k = 0; k < face.size(); ++k) {
      if (is_integer(as_array(complex_.positions[face.corner[k]])[axis])) return true;
    }
    return false;
  }
  double volume_boundary_of(const Face& face, std::size_t axis) const {
    for (int k = 0; k < face.size(); ++k) {
      const double x = as_array(complex_.positions[face.corner[k]])[axis];
      if (is_integer(x)) return x;
    }
    return 0;
  }
  Vec3 mean_of(const Face& face) const {
    Vec3 sum;
    for (int k = 0; k < face.size(); ++k) sum = sum + complex_.positions[face.corner[k]];
    return (1.0 / face.size()) * sum;
  }

  double value(Vec3 p) const { return field_.at(p).value; }

  Vec3 midpoint(const SplitSide& s) const {
    const Vec3 a = complex_.positions[s.a], b = complex_.positions[s.b];
    return s.crosses ? on_wall(s.first_node, s.second_node) : moved_onto_surface(a, b);
  }

  // The point half-way between two nodes of one wall, on the curve of the surface from one to the
  // other.
  Vec3 on_wall(Vec3 first, Vec3 second) const {
    const Point n = as_array(first), m = as_array(second);
    const Vec3 chord = 0.5 * (first + second);
    std::array<std::size_t, 2> along{3, 3};  // the edge of each node
    std::size_t wall = 3;
    Point corner = n;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!is_integer(n[a])) along[0] = a;
      if (!is_integer(m[a])) along[1] = a;
      if (is_integer(n[a]) && n[a] == m[a]) wall = a;
    }
    if (along[0] == 3 || along[1] == 3 || wall == 3 || along[0] == wall || along[1] == wall)
      return chord;
    const BilinearWall wall_field(field_, chord);
    // Chords of two curves never intersect. The curves themselves are only known to be disjoint if
    // the field on walls is the bilinear one that parsing used.
    const bool cubic = field_.interpolation() == Interpolation::tricubic;
    if ((cubic || field_.supersample() > 1) && wall_field.has_two_curves()) return chord;
    Point from = as_array(chord), to = from;
    if (along[0] == along[1]) {  // opposite edges: f is monotone on the line half-way between them
      from[along[0]] = std::floor(n[along[0]]);
      to[along[0]] = from[along[0]] + 1;
    } else {  // edges that share a corner: the first crossing as seen from the corner
      corner[along[0]] = m[along[0]];
      from = corner;
      const Vec3 direction = chord - as_vector(corner);
      const Point w = as_array(direction);
      double longest = INFINITY;  // until it leaves the wall's square
      for (const std::size_t a : along)
        longest = std::min(longest, w[a] == 0 ? INFINITY : 1 / std::abs(w[a]));
      if (!std::isfinite(longest)) return chord;
      to = as_array(as_vector(corner) + longest * direction);
    }
    const Vec3 p = as_vector(from), q = as_vector(to);
    const double f0 = wall_field.value(p), f1 = wall_field.value(0.5 * (p + q)),
                 f2 = wall_field.value(q);
    // Along a line the bilinear function is quadratic.
    const double c = f0, b = -3 * f0 + 4 * f1 - f2, a = 2 * f0 - 4 * f1 + 2 * f2;
    double best = INFINITY;
    const auto offer = [&](double t) {
      if (t >= 0 && t <= 1)
        best = std::min(best, t);  // t is 0 or 1 at samples equal to the isovalue
    };
    const double discriminant = b * b - 4 * a * c;
    if (discriminant >= 0) {
      const double h = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
      if (a != 0) offer(h / a);
      if (h != 0) offer(c / h);
    }
    if (!std::isfinite(best)) return chord;
    if (cubic && (value(p) >= 0) != (value(q) >= 0)) {
      best = zero_between(value(p) >= 0, best, [&](double t) {
        const InterpolatedField::Value f = field_.at(p + t * (q - p));
        return std::pair(f.value, dot(f.gradient, q - p));
      });
    }
    Vec3 found = p + best * (q - p);
    // The two curves on a wall with alternating signs may touch, so each stays on its own side.
    if (along[0] != along[1]) found = chord + kTowardsCurve * (found - chord);
    Point out = as_array(found);
    for (std::size_t x = 0; x < 3; ++x) {
      const double low = std::floor(as_array(chord)[x]);
      out[x] = x == wall ? n[x] : std::clamp(out[x], low + kWallMargin, low + 1 - kWallMargin);
    }
    return as_vector(out);
  }

  // Starts at the midpoint of a side within a grid cell and takes a few Newton steps, without
  // leaving the grid cell or the wall that the side is on.
  Vec3 moved_onto_surface(Vec3 a, Vec3 b) const {
    const Point pa = as_array(a), pb = as_array(b);
    std::array<bool, 3> fixed;
    Point low, high;
    Box box;
    box.include(a);
    box.include(b);
    for (std::size_t x = 0; x < 3; ++x) {
      fixed[x] = is_integer(pa[x]) && pa[x] == pb[x];
      low[x] = fixed[x] ? pa[x] : box.low[x] + kWallMargin;
      high[x] = fixed[x] ? pa[x] : box.high[x] - kWallMargin;
    }
    const Vec3 spacing = complex_.spacing;
    const Point weight{1 / (spacing.x * spacing.x), 1 / (spacing.y * spacing.y),
                       1 / (spacing.z * spacing.z)};
    const auto inside = [&](Point p) {
      for (std::size_t x = 0; x < 3; ++x) p[x] = std::clamp(p[x], low[x], high[x]);
      return p;
    };
    Point p = inside(as_array(0.5 * (a + b))), best = p;
    InterpolatedField::Value f = field_.at(as_vector(p));
    double smallest = std::abs(f.value);
    for (int step = 0; step < kNewtonSteps && smallest > 0; ++step) {
      const Point g = as_array(f.gradient);
      double slope = 0;
      for (std::size_t x = 0; x < 3; ++x) slope += fixed[x] ? 0 : g[x] * g[x] * weight[x];
      if (!(slope > 0)) break;
      for (std::size_t x = 0; x < 3; ++x) p[x] -= fixed[x] ? 0 : f.value / slope * g[x] * weight[x];
      p = inside(p);
      f = field_.at(as_vector(p));
      if (!(std::abs(f.value) < smallest)) break;
      smallest = std::abs(f.value);
      best = p;
    }
    return as_vector(best);
  }

  void add_face(FaceId f, bool& first, CVertexId a, CVertexId b, CVertexId c) {
    const Face triangle{{a, b, c, kNone}};
    if (first) {
      out_.complex.faces[f] = triangle;
      first = false;
    } else {
      out_.complex.faces.push_back(triangle);
    }
  }

  void split_face(FaceId f) {
    const Face face = complex_.faces[f];
    const int size = face.size();
    bool first = true;
    if (!face.is_triangle() && !box_of(complex_, face).is_in_one_cell()) {
      split_around_node(f, face);
      return;
    }
    if (!face.is_triangle()) {  // on an edge of the volume: split along the diagonal from the
                                // c-vertex inside the grid cell
      int from = 0;
      for (int k = 0; k < size; ++k) {
        if (!complex_.on_boundary[face.corner[k]]) from = k;
      }
      const auto corner = [&](int k) { return face.corner[(from + k) % 4]; };
      split_triangle(f, first, {corner(0), corner(1), corner(2)});
      split_triangle(f, first, {corner(0), corner(2), corner(3)});
      return;
    }
    split_triangle(f, first, {face.corner[0], face.corner[1], face.corner[2]});
  }

  void split_around_node(FaceId f, const Face& face) {
    const Vec3 node = node_of(face);
    bool on_volume_boundary = false;
    for (int k = 0; k < 4; ++k)
      on_volume_boundary =
          on_volume_boundary || is_on_volume_boundary(face.corner[k], face.corner[(k + 1) % 4]);
    const CVertexId centre = add_c_vertex(node, face.corner[0], on_volume_boundary);
    bool first = true;
    for (int k = 0; k < 4; ++k) {
      const CVertexId a = face.corner[k], b = face.corner[(k + 1) % 4];
      if (is_on_volume_boundary(a, b)) {
        boundary_nodes_.push_back({a, b, centre});
        continue;
      }
      const CVertexId m = midpoint_of(a, b);
      if (m == kNone) {
        add_face(f, first, centre, a, b);
      } else {
        add_face(f, first, centre, a, m);
        add_face(f, first, centre, m, b);
      }
    }
  }

  void split_triangle(FaceId f, bool& first, std::array<CVertexId, 3> c) {
    std::array<CVertexId, 3> m;
    int marked = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      m[k] = midpoint_of(c[k], c[(k + 1) % 3]);
      marked += m[k] != kNone;
    }
    if (marked == 0) {
      add_face(f, first, c[0], c[1], c[2]);
      return;
    }
    if (marked == 3) {
      for (std::size_t k = 0; k < 3; ++k) add_face(f, first, c[k], m[k], m[(k + 2) % 3]);
      add_face(f, first, m[0], m[1], m[2]);
      return;
    }
    // Rotates the corners so that side k = 0 is split, and of two split sides the other one is side
    // 1.
    std::size_t k = 0;
    while (m[k] == kNone || (marked == 2 && m[(k + 1) % 3] == kNone)) ++k;
    const CVertexId a = c[k], b = c[(k + 1) % 3], d = c[(k + 2) % 3], ab = m[k],
                    bd = m[(k + 1) % 3];
    if (marked == 1) {
      add_face(f, first, a, ab, d);
      add_face(f, first, ab, b, d);
      return;
    }
    add_face(f, first, ab, b, bd);
    const auto squared = [&](CVertexId x, CVertexId y) {
      return squared_distance(out_.complex.positions[x], out_.complex.positions[y],
                              complex_.spacing);
    };
    if (squared(a, bd) <= squared(ab, d)) {
      add_face(f, first, a, ab, bd);
      add_face(f, first, a, bd, d);
    } else {
      add_face(f, first, a, ab, d);
      add_face(f, first, ab, bd, d);
    }
  }

  void split_boundary() {
    std::sort(boundary_nodes_.begin(), boundary_nodes_.end());
    std::vector<BoundarySide>& boundary = out_.complex.boundary;
    const std::size_t n = boundary.size();
    for (std::size_t i = 0; i < n; ++i) {
      const BoundarySide side = boundary[i];
      CVertexId m = midpoint_of(side.from, side.to);
      const auto at = std::lower_bound(boundary_nodes_.begin(), boundary_nodes_.end(),
                                       std::array<CVertexId, 3>{side.from, side.to, 0});
      if (at != boundary_nodes_.end() && (*at)[0] == side.from && (*at)[1] == side.to) m = (*at)[2];
      if (m == kNone) continue;
      boundary[i] = {side.from, m};
      boundary.push_back({m, side.to});
    }
  }

  const SurfaceComplex& complex_;
  const SurfaceInGrid& in_;
  const InterpolatedField& field_;
  CancelPoll poll_;
  std::vector<Target> targets_;   // per c-vertex
  std::vector<SplitSide> sides_;  // sorted by their ends; the i-th has the i-th new c-vertex
  std::vector<std::array<CVertexId, 3>>
      boundary_nodes_;  // ends of a side on the volume boundary and the node between them
  Subdivision out_;
};

}  // namespace

bool has_two_curves(const InterpolatedField& field, Vec3 point) {
  return BilinearWall(field, point).has_two_curves();
}

std::vector<Fineness> fineness(const SurfaceComplex& complex, const SurfaceInGrid& in) {
  std::vector<Fineness> out(complex.c_vertex_count(), Fineness::pieces);
  std::vector<Fineness> of_face(complex.face_count());
  for_each_index(complex.face_count(), kFacesPerChunk, in.control,
                 [&](std::size_t f) { of_face[f] = fineness_of(complex, in, complex.faces[f]); });
  CancelPoll poll(in.control);
  for (FaceId f = 0; f < complex.face_count(); ++f) {
    poll.step();
    const Face& face = complex.faces[f];
    for (int k = 0; k < face.size(); ++k)
      out[face.corner[k]] = std::min(out[face.corner[k]], of_face[f]);
  }
  return out;
}

std::vector<Fineness> fineness(const SurfaceComplex& complex, const SurfaceInGrid& in,
                               std::span<const CVertexId> c_vertices) {
  CancelPoll poll(in.control);
  std::vector<std::uint8_t> is_listed(complex.c_vertex_count(), 0);
  for (const CVertexId v : c_vertices) is_listed[v] = 1;
  std::vector<Fineness> all(complex.c_vertex_count(), Fineness::pieces), out;
  for (const Face& face : complex.faces) {
    const auto corners = std::span(face.corner).first(static_cast<std::size_t>(face.size()));
    if (ranges::none_of(corners, [&](CVertexId v) { return is_listed[v] != 0; })) continue;
    poll.step();
    const Fineness f = fineness_of(complex, in, face);
    for (const CVertexId v : corners) all[v] = std::min(all[v], f);
  }
  for (const CVertexId v : c_vertices) out.push_back(all[v]);
  return out;
}

Subdivision subdivide(const SurfaceComplex& complex, std::span<const CVertexId> wanted,
                      std::span<const Fineness> current, const SurfaceInGrid& in) {
  return Subdivider(complex, wanted, current, in).run();
}

ComplexPart::ComplexPart(const SurfaceComplex& whole, std::span<const CVertexId> around,
                         std::span<const Fineness> current,
                         std::span<const std::uint8_t> is_multi_sheet, const RunControl* control) {
  CancelPoll poll(control);
  enum : std::uint8_t { kWanted = 1, kNear = 2, kIn = 4 };
  std::vector<std::uint8_t> mark(whole.c_vertex_count(), 0);
  for (const CVertexId v : around) mark[v] = kWanted;
  const auto corners = [](const Face& f) {
    return std::span(f.corner).first(static_cast<std::size_t>(f.size()));
  };
  const auto has = [&](const Face& f, std::uint8_t bits) {
    return ranges::any_of(corners(f), [&](CVertexId v) { return (mark[v] & bits) != 0; });
  };
  const auto faces_with = [&](std::uint8_t bits) {
    return collect_chunks<FaceId>(
        whole.face_count(), kFacesPerChunk,
        [&](std::size_t begin, std::size_t end, std::vector<FaceId>& found) {
          if (control != nullptr) control->check_cancelled();
          for (auto f = static_cast<FaceId>(begin); f < end; ++f) {
            if (has(whole.faces[f], bits)) found.push_back(f);
          }
        });
  };
  for (const FaceId f : faces_with(kWanted)) {
    poll.step();
    for (const CVertexId v : corners(whole.faces[f])) mark[v] |= kNear;
  }
  face = faces_with(kWanted | kNear);
  for (const FaceId f : face) {
    poll.step();
    for (const CVertexId v : corners(whole.faces[f])) mark[v] |= kIn;
  }
  complex.spacing = whole.spacing;
  std::vector<CVertexId> number(whole.c_vertex_count(), kNone);
  for (CVertexId v = 0; v < whole.c_vertex_count(); ++v) {
    if (mark[v] == 0) continue;
    poll.step();
    number[v] = static_cast<CVertexId>(c_vertex.size());
    c_vertex.push_back(v);
    complex.positions.push_back(whole.positions[v]);
    complex.on_boundary.push_back(whole.on_boundary[v]);
    fineness.push_back(current[v]);
    multi_sheet.push_back(v < is_multi_sheet.size() ? is_multi_sheet[v] : 0);
  }
  for (const CVertexId v : around) wanted.push_back(number[v]);
  for (const FaceId f : face) {
    Face& own = complex.faces.emplace_back(whole.faces[f]);
    for (int k = 0; k < own.size(); ++k) own.corner[k] = number[own.corner[k]];
  }
  for (std::uint32_t i = 0; i < whole.boundary.size(); ++i) {
    const BoundarySide& s = whole.boundary[i];
    if (mark[s.from] == 0 || mark[s.to] == 0) continue;
    side.push_back(i);
    complex.boundary.push_back({number[s.from], number[s.to]});
  }
}

Subdivision subdivide_in_place(SurfaceComplex& whole, std::span<const CVertexId> wanted,
                               std::span<const Fineness> current, const SurfaceInGrid& in) {
  if (wanted.empty()) return {};
  const ComplexPart part(whole, wanted, current, in.multi_sheet, in.control);
  Subdivision out = part.subdivided(in);
  const SurfaceComplex& subdivided_part = out.complex;
  const CVertexId before = whole.c_vertex_count(), own = part.complex.c_vertex_count();
  const auto number = [&](CVertexId v) {
    return v == kNone ? kNone : v < own ? part.c_vertex[v] : before + (v - own);
  };
  append(whole.positions, subdivided_part.positions.begin() + own, subdivided_part.positions.end());
  append(whole.on_boundary, subdivided_part.on_boundary.begin() + own,
         subdivided_part.on_boundary.end());
  std::vector<Face> more_faces;
  checked_id(whole.faces.size() + subdivided_part.faces.size(), "faces");
  CancelPoll poll(in.control);
  for (FaceId f = 0; f < subdivided_part.face_count(); ++f) {
    poll.step();
    Face face = subdivided_part.faces[f];
    for (int k = 0; k < face.size(); ++k) face.corner[k] = number(face.corner[k]);
    if (f < part.face.size()) {
      Face& own_face = whole.faces[part.face[f]];
      if (own_face.corner == face.corner) continue;
      out.touched.insert(out.touched.end(), own_face.corner.begin(),
                         own_face.corner.begin() + own_face.size());
      own_face = face;
    } else {
      more_faces.push_back(face);
    }
  }
  append(whole.faces, more_faces.begin(), more_faces.end());
  for (std::size_t i = 0; i < subdivided_part.boundary.size(); ++i) {
    const BoundarySide side{number(subdivided_part.boundary[i].from),
                            number(subdivided_part.boundary[i].to)};
    if (i < part.side.size()) {
      whole.boundary[part.side[i]] = side;
    } else {
      whole.boundary.push_back(side);
    }
  }
  for (CVertexId& v : out.origin) v = number(v);
  for (auto& [a, b] : out.between) {
    a = number(a);
    b = number(b);
  }
  std::sort(out.touched.begin(), out.touched.end());
  out.touched.erase(std::unique(out.touched.begin(), out.touched.end()), out.touched.end());
  out.complex = {};
  return out;
}

}  // namespace isoatlas::detail
