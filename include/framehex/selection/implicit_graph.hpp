// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/candidates.hpp"
#include "framehex/recombination/compatibility.hpp"
#include "framehex/selection/candidate_weights.hpp"
#include "framehex/selection/conflict_source.hpp"
#include "framehex/selection/detail/candidate_checks.hpp"
#include "framehex/selection/detail/vertex_pairs.hpp"
#include "framehex/selection/incompatibility_graph.hpp"

#include <memory>
#include <mutex>

namespace framehex {

/// Incompatibility graph of potential hexahedra that stores no conflicts: they follow from the candidates' tetrahedra
/// and vertices, and are found when asked for.
///
/// The same graph as that of `build_incompatibility_graph`, for searches that look at few of its conflicts: a
/// selection needs about one in a hundred.
///
/// Safe to read from several threads at a time.
///
/// @par Complexity  8 bytes a candidate, against some 1,000 to 2,000 where conflicts are stored. `conflicts` O(1).
///                  `for_each_conflict` looks at all candidates that share a vertex, some 20 to 100 microseconds; its
///                  first call makes lists of 70 bytes a candidate. `select` does without.
/// @par Source      Paper, section 2; the rule of pairs is ours, see `build_incompatibility_graph`.
class ImplicitIncompatibilityGraph {
public:
  /// @param candidates  n potential hexahedra; must outlive this.
  /// @param weight      `double weight(index_t candidate)`, finite, >= 0; see selection/candidate_weights.hpp.
  /// @throws invalid_weight        with the candidate.
  /// @throws invalid_connectivity  with the candidate, when it names a vertex twice.
  /// @throws invalid_graph         with the candidate, when it has no tetrahedron.
  template <class Weight>
  ImplicitIncompatibilityGraph(const PotentialHexahedra& candidates, Weight&& weight)
      : candidates_(&candidates), extent_(detail::check_candidates(candidates)) {
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (candidates.tets[i].empty()) detail::refuse_graph(i, "has no tetrahedron");
    auto quantised = detail::quantise(detail::list_weights(candidates.size(), weight));
    weights_ = std::move(quantised.values);
    unit_ = quantised.unit;
  }

  std::size_t size() const { return weights_.size(); }
  bool empty() const { return weights_.empty(); }
  double weight(index_t v) const { return static_cast<double>(weights_[v]) * unit_; }
  double unit() const { return unit_; }
  std::span<const std::int64_t> weights_in_units() const { return weights_; }

  bool conflicts(index_t u, index_t v) const {
    return u != v && !(are_disjoint(candidates_->tets[u], candidates_->tets[v]) &&
                       detail::hexahedra_fit(candidates_->vertices[u], candidates_->vertices[v]));
  }

  /// Ascending.
  template <class Found>
  void for_each_conflict(index_t v, Found&& found) const {
    const Users& users = this->users();
    std::vector<index_t> near;
    const auto append = [&near](std::span<const index_t> row) { near.insert(near.end(), row.begin(), row.end()); };
    for (const index_t corner : candidates_->vertices[v]) append(users.of_vertex[corner]);
    for (const index_t tet : candidates_->tets[v]) append(users.of_tet[tet]);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const index_t u : near)
      if (conflicts(u, v)) found(u);
  }

  const PotentialHexahedra& candidates() const { return *candidates_; }
  /// Vertices and tetrahedra that candidates name are numbered below these.
  std::size_t n_vertices() const { return extent_.n_vertices; }
  std::size_t n_tets() const { return extent_.n_tets; }

private:
  /// Candidates by what they are made of.
  struct Users {
    std::once_flag made;
    Csr<index_t> of_vertex, of_tet;
  };

  const Users& users() const {
    const auto list = [this](std::size_t n_rows, const auto& parts) {
      return make_csr(n_rows, [&](auto&& put) {
        for (std::size_t i = 0; i < size(); ++i)
          for (const index_t part : parts[i]) put(part, static_cast<index_t>(i));
      });
    };
    std::call_once(users_->made, [&] {
      users_->of_vertex = list(extent_.n_vertices, candidates_->vertices);
      users_->of_tet = list(extent_.n_tets, candidates_->tets);
    });
    return *users_;
  }

  const PotentialHexahedra* candidates_;
  detail::CandidateExtent extent_;
  std::shared_ptr<Users> users_ = std::make_shared<Users>();
  std::vector<std::int64_t> weights_;
  double unit_ = 1.0;
};

static_assert(ConflictSource<ImplicitIncompatibilityGraph>);

}  // namespace framehex
