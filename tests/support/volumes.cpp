// SPDX-License-Identifier: Apache-2.0
#include "support/volumes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "field/sample_type.h"

namespace isoatlas::detail::test {
namespace {

double distance(double x, double y, double z, Vec3 c) {
  return std::hypot(x - c.x, y - c.y, z - c.z);
}

}  // namespace

Samples constant(Size size, std::int64_t value) {
  return {size, std::vector<std::int64_t>(size[0] * size[1] * size[2], value)};
}

Samples sampled(Size size, const Function& f, double scale) {
  Samples out = constant(size, 0);
  std::size_t i = 0;
  for (std::size_t z = 0; z < size[2]; ++z) {
    for (std::size_t y = 0; y < size[1]; ++y) {
      for (std::size_t x = 0; x < size[0]; ++x) {
        out.values[i++] = std::llround(
            scale * f(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)));
      }
    }
  }
  return out;
}

Samples negated(Samples s) {
  for (std::int64_t& v : s.values) v = -v;
  return s;
}

Samples plus(Samples s, std::int64_t offset) {
  for (std::int64_t& v : s.values) v += offset;
  return s;
}

Samples mirrored(const Samples& s, int axis) {
  Samples out = s;
  for (std::size_t z = 0; z < s.size[2]; ++z) {
    for (std::size_t y = 0; y < s.size[1]; ++y) {
      for (std::size_t x = 0; x < s.size[0]; ++x) {
        Size p{x, y, z};
        p[axis] = s.size[axis] - 1 - p[axis];
        out.at(p[0], p[1], p[2]) = s.at(x, y, z);
      }
    }
  }
  return out;
}

Samples permuted(const Samples& s, std::array<int, 3> from) {
  Samples out = constant({s.size[from[0]], s.size[from[1]], s.size[from[2]]}, 0);
  for (std::size_t z = 0; z < s.size[2]; ++z) {
    for (std::size_t y = 0; y < s.size[1]; ++y) {
      for (std::size_t x = 0; x < s.size[0]; ++x) {
        const Size p{x, y, z};
        out.at(p[from[0]], p[from[1]], p[from[2]]) = s.at(x, y, z);
      }
    }
  }
  return out;
}

Volume to_volume(const Samples& s, SampleType type, Vec3 spacing) {
  Grid grid;
  grid.size = s.size;
  grid.spacing = spacing;
  return visit_sample_type(type, [&]<class T>(const T*) {
    std::vector<T> values;
    values.reserve(s.values.size());
    for (const std::int64_t v : s.values) {
      const T converted = static_cast<T>(v);
      const bool fits = std::is_floating_point_v<T> ? static_cast<std::int64_t>(converted) == v
                                                    : static_cast<std::int64_t>(converted) == v &&
                                                          (converted < T{}) == (v < 0);
      if (!fits) throw std::logic_error("a sample of a generated volume does not fit its type");
      values.push_back(converted);
    }
    return own(grid, type, std::move(values));
  });
}

Function sphere(Vec3 c, double radius) {
  return [=](double x, double y, double z) { return radius - distance(x, y, z, c); };
}

Function torus(Vec3 c, double ring, double tube, int axis) {
  return [=](double x, double y, double z) {
    std::array<double, 3> d{x - c.x, y - c.y, z - c.z};
    std::swap(d[axis], d[2]);
    return tube - std::hypot(std::hypot(d[0], d[1]) - ring, d[2]);
  };
}

Function unite(Function a, Function b) {
  return [a = std::move(a), b = std::move(b)](double x, double y, double z) {
    return std::max(a(x, y, z), b(x, y, z));
  };
}

Function nested_shells(Vec3 c, std::vector<double> radii) {
  return [c, radii = std::move(radii)](double x, double y, double z) {
    const double d = distance(x, y, z, c);
    double nearest = 1e9;
    int crossed = 0;
    for (const double r : radii) {
      nearest = std::min(nearest, std::abs(d - r));
      crossed += d > r;
    }
    return crossed % 2 == 0 ? nearest : -nearest;
  };
}

Function gyroid(double period, double level) {
  const double k = 2 * std::numbers::pi / period;
  return [=](double x, double y, double z) {
    return std::sin(k * x) * std::cos(k * y) + std::sin(k * y) * std::cos(k * z) +
           std::sin(k * z) * std::cos(k * x) - level;
  };
}

Function half_space(Vec3 n, double offset) {
  return [=](double x, double y, double z) { return offset - (n.x * x + n.y * y + n.z * z); };
}

std::vector<KnownVolume> known_volumes() {
  std::vector<KnownVolume> out;
  const auto add = [&](std::string title, Samples samples, std::vector<TopologySummary::Kind> kinds,
                       double isovalue = 0) {
    out.push_back({std::move(title), std::move(samples), isovalue, kinds, kinds});
  };
  const Vec3 c{11.3, 11.6, 11.45};
  add("sphere", sampled({24, 24, 24}, sphere(c, 8.2)), {{0, 0, 1}});
  add("cavity", negated(sampled({24, 24, 24}, sphere(c, 8.2))), {{0, 0, 1}});
  add("torus", sampled({28, 28, 14}, torus({13.4, 13.6, 6.55}, 8, 3.2)), {{1, 0, 1}});
  add("torus about x", sampled({14, 28, 28}, torus({6.4, 13.6, 13.55}, 8, 3.2, 0)), {{1, 0, 1}});
  add("double torus",
      sampled({46, 28, 14},
              unite(torus({13.4, 13.6, 6.55}, 8, 3.2), torus({29.4, 13.6, 6.55}, 8, 3.2))),
      {{2, 0, 1}});
  add("linked tori",
      sampled({36, 28, 28},
              unite(torus({13.4, 13.6, 13.55}, 8, 2.6), torus({21.4, 13.6, 13.55}, 8, 2.6, 1))),
      {{1, 0, 2}});
  add("nested shells",
      sampled({32, 32, 32}, nested_shells({15.4, 15.6, 15.55}, {3.1, 5.4, 8.2, 10.1, 13.7})),
      {{0, 0, 5}});
  add("half-space", sampled({9, 10, 11}, half_space({1, 0, 0}, 4.3)), {{0, 1, 1}});
  add("half-space along z", sampled({9, 10, 11}, half_space({0, 0, -1}, -4.3)), {{0, 1, 1}});
  add("oblique half-space", sampled({12, 13, 14}, half_space({0.51, 0.62, 0.597}, 10.1)),
      {{0, 1, 1}});
  add("slab", sampled({9, 9, 12}, [](double, double, double z) { return 2.2 - std::abs(z - 5.4); }),
      {{0, 1, 2}});
  add("cylinder",
      sampled({16, 16, 20},
              [](double x, double y, double) { return 5.3 - std::hypot(x - 7.4, y - 7.6); }),
      {{0, 2, 1}});
  add("capped cylinder",
      sampled({16, 16, 20},
              [](double x, double y, double z) {
                return std::min(5.3 - std::hypot(x - 7.4, y - 7.6), z - 4.4);
              }),
      {{0, 1, 1}});
  add("octant of a sphere", sampled({14, 14, 14}, sphere({0, 0, 0}, 9.4)), {{0, 1, 1}});
  // A torus cut lengthwise by the volume's face: a tube bent to a ring and slit open, an annulus of
  // two loops.
  add("torus cut by a face", sampled({28, 28, 8}, torus({13.4, 13.6, 0}, 8, 3.2)), {{0, 2, 1}});
  add("torus cut across", sampled({14, 28, 14}, torus({-0.2, 13.6, 6.55}, 8, 3.2)), {{0, 2, 1}});
  // Radial hole along each axis through a ball: the boundary of a ball with a three-way crossing of
  // tunnels has genus 5.
  add("ball with three tunnels",
      sampled({30, 30, 30},
              [](double x, double y, double z) {
                const double u = x - 14.4, v = y - 14.6, w = z - 14.55;
                return std::min({12.2 - std::hypot(u, v, w), std::hypot(u, v) - 4.2,
                                 std::hypot(v, w) - 4.2, std::hypot(w, u) - 4.2});
              }),
      {{5, 0, 1}});

  {
    Samples s = constant({5, 5, 5}, -10);
    s.at(2, 2, 2) = 7;
    add("one-voxel blob", s, {{0, 0, 1}});
    add("one-voxel blob equal to the isovalue", s, {{0, 0, 1}}, 7);
    add("one-voxel hole", negated(s), {{0, 0, 1}});
  }
  {
    Samples s = constant({4, 4, 4}, -10);
    s.at(0, 0, 0) = s.at(3, 3, 3) = s.at(3, 0, 0) = 5;
    add("three corners", s, {{0, 1, 3}});
  }
  {
    Samples s = constant({5, 4, 4}, -10);
    s.at(2, 0, 0) = 5;
    s.at(0, 0, 2) = 5;
    add("two blobs on edges", s, {{0, 1, 2}});
    s.at(2, 3, 2) = 5;
    add("two blobs on edges, one on a face", s, {{0, 1, 3}});
  }
  {
    Samples s = constant({6, 6, 6},
                         -1);  // face-to-face contact is one piece, corner contact in space is two
    s.at(1, 1, 1) = s.at(2, 1, 1) = 1;
    s.at(3, 4, 4) = 1;
    add("domino and speck", s, {{0, 0, 2}});
  }
  {
    Samples s = constant({6, 6, 6}, -1);  // an edge contact: the saddle ties, so the two are joined
    s.at(2, 2, 2) = s.at(3, 3, 2) = 1;
    add("two samples across a face, tie joins", s, {{0, 0, 1}});
    add("two holes across a face, tie parts them", negated(s), {{0, 0, 2}});
    const auto with = [&](std::int64_t high, std::int64_t low) {
      Samples t = s;
      for (std::int64_t& v : t.values) v = v > 0 ? high : low;
      return t;
    };
    add("two samples across a face, saddle outside", with(9, -10), {{0, 0, 2}});
    add("two samples across a face, saddle inside", with(9, -8), {{0, 0, 1}});
    add("two holes across a face, saddle outside", with(-10, 9), {{0, 0, 1}});
    add("two holes across a face, saddle inside", with(-8, 9), {{0, 0, 2}});
  }
  {
    Samples s = constant(
        {6, 6, 6},
        -1);  // across a cell: joined by a tunnel through it, or with one disk per loop never
    s.at(2, 2, 2) = s.at(3, 3, 3) = 100;
    add("two samples across a cell", s, {{0, 0, 1}});
    out.back().faces_kinds = {{0, 0, 2}};
  }
  {
    Samples s = constant({7, 7, 3}, -1);  // a ring one voxel wide
    for (std::size_t i = 1; i < 6; ++i)
      s.at(i, 1, 1) = s.at(i, 5, 1) = s.at(1, i, 1) = s.at(5, i, 1) = 1;
    add("one-voxel ring", s, {{1, 0, 1}});
    add("one-voxel ring, thin tube", s, {{1, 0, 1}}, 1);
    s.at(3, 3, 1) = 1;
    add("one-voxel ring and a speck in it", s, {{0, 0, 1}, {1, 0, 1}});
  }
  {
    Samples s =
        constant({2, 9, 9}, -3);  // a strip one voxel wide that goes through the whole volume
    for (std::size_t z = 0; z < 9; ++z) s.at(0, 4, z) = s.at(1, 4, z) = 4;
    add("one-voxel wall in a thin volume", s, {{0, 1, 2}});
    add("the same, isovalue equal to it", s, {{0, 1, 2}}, 4);
    Samples edge = constant({2, 2, 9}, -3);
    for (std::size_t z = 0; z < 9; ++z) edge.at(0, 0, z) = 4;
    add("one-voxel strip along an edge", edge, {{0, 1, 1}});
    Samples cell = constant({2, 2, 2}, -3);
    cell.at(1, 0, 1) = 2;
    add("one corner of the smallest volume", cell, {{0, 1, 1}});
  }
  {
    // Ties: a sphere whose whole inside equals the isovalue, and one whose whole outside does (so
    // that all is inside but a ball).
    const Samples ball = sampled({20, 20, 20}, sphere({9.4, 9.6, 9.55}, 6.2), 10);
    Samples low = ball, high = ball;
    for (std::int64_t& v : low.values) v = std::min<std::int64_t>(v, 0);
    for (std::int64_t& v : high.values) v = v >= 0 ? 0 : -1;
    add("plateau of ties inside", low, {{0, 0, 1}});
    add("plateau of ties, one step", high, {{0, 0, 1}});
    Samples outside = negated(ball);
    for (std::int64_t& v : outside.values) v = std::min<std::int64_t>(v, 0);
    add("plateau of ties around a cavity", outside, {{0, 0, 1}});
  }
  return out;
}

const char* name(Family family) {
  switch (family) {
    case Family::white_noise:
      return "white noise";
    case Family::few_values:
      return "few values";
    case Family::signs_only:
      return "signs only";
    case Family::smooth_blobs:
      return "smooth blobs";
    case Family::sparse_specks:
      return "sparse specks";
    case Family::gyroid_cut:
      return "gyroid";
    case Family::plateaus:
      return "plateaus";
    case Family::checkerboard:
      return "checkerboard";
  }
  return "?";
}

Samples random_samples(Family family, Size size, std::uint64_t seed) {
  Random random(seed * kFamilies + static_cast<std::uint64_t>(family));
  Samples out = constant(size, 0);
  const auto each = [&](auto value) {
    std::size_t i = 0;
    for (std::size_t z = 0; z < size[2]; ++z) {
      for (std::size_t y = 0; y < size[1]; ++y) {
        for (std::size_t x = 0; x < size[0]; ++x) out.values[i++] = value(x, y, z);
      }
    }
  };
  const auto blobs = [&](double scale) {
    struct Bump {
      Vec3 c;
      double width, height;
    };
    std::vector<Bump> bumps(3 + random.bits() % 6);
    for (Bump& b : bumps) {
      b.c = {random.unit() * size[0], random.unit() * size[1], random.unit() * size[2]};
      b.width = 0.8 + 2.5 * random.unit();
      b.height = random.unit() * 2 - 0.6;
    }
    const double level = 0.1 + 0.3 * random.unit();
    out = sampled(
        size,
        [&](double x, double y, double z) {
          double sum = -level;
          for (const Bump& b : bumps) {
            const double d = distance(x, y, z, b.c) / b.width;
            sum += b.height * std::exp(-d * d);
          }
          return sum;
        },
        scale);
  };
  switch (family) {
    case Family::white_noise:
      each([&](auto...) { return random.between(-1000, 1000); });
      break;
    case Family::few_values:
      each([&](auto...) { return random.between(-2, 2); });
      break;
    case Family::signs_only:
      each([&](auto...) { return random.bits() & 1 ? 1 : -1; });
      break;
    case Family::smooth_blobs:
      blobs(1000);
      break;
    case Family::sparse_specks: {
      each([&](auto...) { return random.between(-20, -1); });
      const std::size_t specks = 1 + random.bits() % 12;
      for (std::size_t k = 0; k < specks; ++k) {
        Size p{};
        for (int a = 0; a < 3; ++a) p[a] = random.bits() % size[a];
        const int axis = static_cast<int>(random.bits() % 3);
        const std::size_t end = std::min(size[axis], p[axis] + 1 + random.bits() % 5);
        for (; p[axis] < end; ++p[axis]) out.at(p[0], p[1], p[2]) = random.between(0, 20);
      }
      break;
    }
    case Family::gyroid_cut: {
      const double period = 4 + 8 * random.unit(), level = random.unit() - 0.5,
                   noise = random.unit() * 0.8;
      out = sampled(size, gyroid(period, level), 1000);
      for (std::int64_t& v : out.values)
        v += static_cast<std::int64_t>(1000 * noise * (random.unit() - 0.5));
      break;
    }
    case Family::plateaus: {
      blobs(8);
      const bool from_above = random.bits() & 1;
      for (std::int64_t& v : out.values)
        v = from_above ? std::min<std::int64_t>(v, 0) : std::max<std::int64_t>(v, -1);
      break;
    }
    case Family::checkerboard:
      each([&](std::size_t x, std::size_t y, std::size_t z) {
        const std::int64_t sign = (x + y + z) % 2 == 0 ? 1 : -1;
        const std::int64_t v = random.bits() % 16 == 0 ? -1 : 1;  // some flaws
        return v * sign * random.between(1, random.bits() & 1 ? 3 : 1000);
      });
      break;
  }
  return out;
}

Samples random_shells(std::uint64_t seed) {
  Random random(seed);
  const auto centre = [&](double x) {
    return Vec3{x + 0.1 * random.between(-9, 9), 11 + 0.1 * random.between(-9, 9),
                11 + 0.1 * random.between(-9, 9)};
  };
  Samples samples = sampled({40, 22, 22}, unite(nested_shells(centre(11), {8.5, 6, 3.5}),
                                                nested_shells(centre(29), {7, 4.5})));
  for (int k = 0; k < 40; ++k) {
    std::int64_t& sample =
        samples.at(random.between(0, 39), random.between(0, 21), random.between(0, 21));
    sample = -sample;
  }
  return samples;
}

}  // namespace isoatlas::detail::test
