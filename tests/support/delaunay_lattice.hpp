// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <boost/random/normal_distribution.hpp>

#include <map>
#include <random>
#include <set>

namespace framehex::test {

/// Delaunay tetrahedra of the points of an n x n x n lattice of cubes, the ties of the eight co-spherical corners of
/// each cube being broken by moving every point by an infinitely small random vector.
///
/// In each cube the shift s of a point p lifts it by 2 (p - centre) . s over the paraboloid: the lower hull of the
/// lifted corners is its triangulation. Where two cubes cut their common face differently, the four corners of that
/// face, which are no longer in one plane, are a tetrahedron as well: a face sliver. Its volume is infinitely small;
/// points are therefore moved by `shift` times their vectors in the result.
class DelaunayLattice {
public:
  DelaunayLattice(index_t n, unsigned seed, double consistency = 0, double shift = 1e-6) : n_(n) {
    std::mt19937_64 engine(seed);
    boost::random::normal_distribution<> normal;
    for (index_t k = 0; k <= n; ++k)
      for (index_t j = 0; j <= n; ++j)
        for (index_t i = 0; i <= n; ++i) {
          const double x = normal(engine), y = normal(engine), z = normal(engine);
          shifts_.emplace_back(x - consistency * (j + k), y - consistency * (k + i), z - consistency * (i + j));
          lattice_.emplace_back(i, j, k);
          mesh.points.push_back(lattice_.back() + shift * shifts_.back());
        }
    for (index_t k = 0; k < n; ++k)
      for (index_t j = 0; j < n; ++j)
        for (index_t i = 0; i < n; ++i) cut(i, j, k);
    add_slivers();
  }

  IndexedTetMesh mesh;
  std::size_t n_slivers = 0;

private:
  index_t vertex(index_t i, index_t j, index_t k) const { return i + (n_ + 1) * (j + (n_ + 1) * k); }

  void cut(index_t i, index_t j, index_t k) {
    std::array<index_t, 8> v{};
    for (index_t c = 0; c < 8; ++c) v[c] = vertex(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
    const Vector3 centre = lattice_[v[0]] + Vector3(0.5, 0.5, 0.5);
    for (std::size_t a = 0; a < 8; ++a)
      for (std::size_t b = a + 1; b < 8; ++b)
        for (std::size_t c = b + 1; c < 8; ++c)
          for (std::size_t d = c + 1; d < 8; ++d) {
            const std::array<index_t, 4> tet{v[a], v[b], v[c], v[d]};
            Eigen::Matrix4d corners;
            Eigen::Vector4d lift;
            for (std::size_t r = 0; r < 4; ++r) {
              corners.row(static_cast<Eigen::Index>(r)) << lattice_[tet[r]].transpose() - centre.transpose(), 1;
              lift[static_cast<Eigen::Index>(r)] = (lattice_[tet[r]] - centre).dot(shifts_[tet[r]]);
            }
            if (std::abs(corners.determinant()) < 0.1) continue;
            const Eigen::Vector4d plane = corners.inverse() * lift;
            bool lower = true;
            for (const index_t w : v) {
              const Vector3 p = lattice_[w] - centre;
              if (std::find(tet.begin(), tet.end(), w) == tet.end())
                lower &= p.dot(shifts_[w]) > plane.head<3>().dot(p) + plane[3];
            }
            if (lower) add(tet);
          }
  }

  void add(std::array<index_t, 4> tet) {
    const auto& p = mesh.points;
    if (orientation(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]) < 0) std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
  }

  void add_slivers() {
    std::map<std::array<index_t, 3>, int> facets;
    for (const auto& t : mesh.tets)
      for (std::size_t i = 0; i < 4; ++i) {
        std::array<index_t, 3> f{t[(i + 1) % 4], t[(i + 2) % 4], t[(i + 3) % 4]};
        std::sort(f.begin(), f.end());
        ++facets[f];
      }
    std::set<std::array<index_t, 4>> slivers;
    for (index_t a = 0; a < lattice_.size(); ++a)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::array<index_t, 3> at{};
        for (int d = 0; d < 3; ++d) at[static_cast<std::size_t>(d)] = static_cast<index_t>(lattice_[a][d]);
        const auto corner = [&](index_t s, index_t t) {
          auto q = at;
          q[(axis + 1) % 3] += s;
          q[(axis + 2) % 3] += t;
          return vertex(q[0], q[1], q[2]);
        };
        if (at[(axis + 1) % 3] == n_ || at[(axis + 2) % 3] == n_ || at[axis] == 0 || at[axis] == n_) continue;
        std::array<index_t, 3> first{a, corner(1, 0), corner(1, 1)}, second{a, corner(1, 0), corner(0, 1)};
        std::sort(first.begin(), first.end());
        std::sort(second.begin(), second.end());
        if (facets.count(first) && facets.count(second)) slivers.insert({a, corner(1, 0), corner(1, 1), corner(0, 1)});
      }
    for (const auto& s : slivers) add(s);
    n_slivers = slivers.size();
  }

  index_t n_;
  std::vector<Vector3> lattice_, shifts_;
};

}  // namespace framehex::test
