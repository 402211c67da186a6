// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/complex_builder.hpp"
#include "framehex/assembly/detail/finite_volume_fit.hpp"
#include "framehex/assembly/detail/improver.hpp"
#include "framehex/assembly/detail/interface_closer.hpp"
#include "framehex/assembly/detail/prism_chooser.hpp"
#include "framehex/assembly/detail/pyramid_free.hpp"

#include <optional>

namespace framehex::detail {

/// The steps of `assemble` up to the finished cells: choose, close, improve.
///
/// Closing may fail at a quadrilateral; nothing is then known of the mesh around. The chosen cell that has it is
/// left out, and closing begins anew: at the latest without any chosen cell there is nothing left to close.
class Assembler {
public:
  Assembler(const std::vector<Vector3>& points, const TetAdjacency& adjacency, const PotentialHexahedra& candidates,
            const AssemblyOptions& options, AssemblyStatistics& statistics, Pulse& pulse)
      : points_(points),
        adjacency_(adjacency),
        candidates_(candidates),
        options_(options),
        statistics_(statistics),
        pulse_(pulse) {
    builder_.emplace(points_, adjacency_, options_);
  }

  /// @return false when cancelled.
  bool run(std::span<const index_t> selected) {
    add_selection(selected);
    if (!pulse_.report(0.05) || !add_prisms()) return false;
    for (const CellComplex::Cell& cell : complex().cells) chosen_.push_back({cell.kind, cell.source});
    close();
    for (auto open = unclosed(); !open.empty() && !pulse_.stopped(); open = unclosed()) {
      withdraw(open);
      close();
    }
    if (pulse_.stopped()) return false;
    if (improves()) improver_->run(8, options_.interfaces == InterfaceMode::conforming);
    if (options_.fit == CellFit::finite_volume && options_.interfaces == InterfaceMode::conforming)
      fit_finite_volumes();
    return pulse_.report(1);
  }

  const CellComplex& complex() const { return builder_->complex; }
  const std::vector<OtherCut>& other_cuts() const { return builder_->other_cuts; }

  /// The tetrahedra that a hexahedron or prism was made of; none for one that was cut from another.
  std::span<const index_t> tets_of(const CellComplex::Cell& cell) const {
    return cell.source == no_index ? std::span<const index_t>{} : originals_.tets_of(cell);
  }

private:
  struct Choice {
    CellKind kind;
    index_t source;
  };

  bool improves() const { return options_.improvement == ImprovementMode::improve; }

  void add_selection(std::span<const index_t> selected) {
    for (const index_t candidate : selected) {
      if (candidate >= candidates_.size())
        throw incompatible_selection("candidate " + std::to_string(candidate) + " does not exist", Entity::candidate,
                                     {candidate});
      const auto refusal =
          builder_->add(CellKind::hexahedron, candidates_.vertices[candidate], candidates_.tets[candidate], candidate);
      if (!refusal.reason) continue;
      if (refusal.other == no_index)
        throw incompatible_selection("candidate " + std::to_string(candidate) + " does not fit: " + refusal.reason,
                                     Entity::candidate, {candidate});
      const index_t other = complex().cells[refusal.other].source;
      throw incompatible_selection("candidates " + std::to_string(other) + " and " + std::to_string(candidate) +
                                       " do not fit together: " + refusal.reason,
                                   Entity::candidate, {other, candidate});
    }
    for (index_t cell = 0; cell < complex().cells.size(); ++cell) {
      if (!complex().valid(cell))
        throw incompatible_selection(
            "candidate " + std::to_string(complex().cells[cell].source) + " is not a valid hexahedron",
            Entity::candidate, {complex().cells[cell].source});
      statistics_.hexahedron_volume_chosen += complex().volume(cell);
    }
  }

  bool add_prisms() {
    if (options_.prisms == PrismMode::none) return true;
    const Observer observer = [&](const Progress& p) { return pulse_.report(0.05 + 0.05 * p.fraction); };
    prisms_ = find_free_prisms(*builder_, adjacency_, options_,
                               {.quality_floor = options_.prism_quality_floor, .observer = observer});
    if (prisms_.status == Status::cancelled) return false;
    choose_prisms(*builder_, prisms_, options_.interfaces == InterfaceMode::open ? 3 : 1);
    return true;
  }

  /// Adds the tetrahedra that are left, and closes interfaces as the mode asks.
  void close() {
    builder_->finish();
    if (!pulse_.report(0.1)) return;
    CellComplex& complex = builder_->complex;
    const QualityEnergy energy = QualityEnergy::reaching(options_.hexahedron_target, options_.quality_target);
    improver_.emplace(complex, energy, projection(), statistics_, pulse_);
    if (statistics_.n_withdrawn == 0) statistics_.n_open_quadrilaterals = complex.open_quads.size();
    if (options_.interfaces == InterfaceMode::no_pyramids)
      return PyramidFreeCloser(complex, originals_, options_.prism_quality_floor, statistics_, pulse_).close_all();
    InterfaceCloser closer(complex, originals_, options_.quality_floor, statistics_, pulse_);
    closer.merge_pairs(options_.quality_floor);
    if (options_.interfaces == InterfaceMode::open) return;
    if (improves()) improver_->reconnect();
    closer.close_all();
  }

  /// New cells are of poor shape, and moving vertices may spoil what fitted: in turn, a few times, and fitting has the
  /// last word.
  void fit_finite_volumes() {
    constexpr int max_rounds = 8;
    FiniteVolumeFit fit(builder_->complex);
    for (int round = 0; round < max_rounds && !pulse_.stopped(); ++round) {
      if (fit.run(statistics_) == 0) return;
      if (improves() && round + 1 < max_rounds) improver_->smooth(3, true);
    }
    statistics_.n_unfit = fit.find_refused().size();
  }

  /// The quadrilaterals that should face a quadrilateral and do not.
  std::vector<std::array<index_t, 4>> unclosed() const {
    std::vector<std::array<index_t, 4>> open = complex().refused_quads;
    if (options_.interfaces != InterfaceMode::open)
      for (const OpenQuad& quad : complex().open_quads)
        if (quad.open) open.push_back(quad.vertices);
    return open;
  }

  /// Begins anew without the chosen cells behind some quadrilaterals; if all of these are of pyramids, without those that
  /// had the other side.
  void withdraw(std::vector<std::array<index_t, 4>> quads) {
    std::size_t n_withdrawn = leave_out(quads);
    for (auto& quad : quads) std::swap(quad[1], quad[3]);
    if (n_withdrawn == 0) n_withdrawn = leave_out(quads);
    if (n_withdrawn == 0)
      throw incompatible_selection("a quadrilateral that is no chosen cell's cannot be closed", Entity::vertex,
                                   {quads[0].begin(), quads[0].end()});
    const std::size_t n_before = statistics_.n_withdrawn;
    statistics_ = {.n_open_quadrilaterals = statistics_.n_open_quadrilaterals,
                   .n_dissolved = n_before + n_withdrawn,
                   .n_withdrawn = n_before + n_withdrawn,
                   .hexahedron_volume_chosen = statistics_.hexahedron_volume_chosen};
    builder_.emplace(points_, adjacency_, options_);
    for (const Choice& choice : chosen_)
      builder_->add(choice.kind, corners_of(choice), originals_.tets_of(choice.kind, choice.source), choice.source);
  }

  /// @return how many of the chosen cells have one of some quadrilaterals, and are chosen no more.
  std::size_t leave_out(std::vector<std::array<index_t, 4>> quads) {
    std::ranges::transform(quads, quads.begin(), rotated);
    std::ranges::sort(quads);
    return std::erase_if(chosen_, [&](const Choice& choice) {
      const auto corners = corners_of(choice);
      return std::ranges::any_of(faces_of(choice.kind), [&](const LocalFace& local) {
        if (local.size() == 3) return false;
        std::array<index_t, 4> face{};
        for (std::size_t i = 0; i < 4; ++i) face[i] = corners[static_cast<std::size_t>(local.corners[i])];
        return std::ranges::binary_search(quads, rotated(face));
      });
    });
  }

  std::span<const index_t> corners_of(const Choice& choice) const {
    if (choice.kind == CellKind::hexahedron) return candidates_.vertices[choice.source];
    return prisms_.vertices[choice.source];
  }

  VertexSmoother::Projection projection() const {
    if (!options_.boundary_projection) return {};
    return [this](index_t v, Vector3& place) {
      return v < adjacency_.n_vertices() && options_.boundary_projection(v, place);
    };
  }

  const std::vector<Vector3>& points_;
  const TetAdjacency& adjacency_;
  const PotentialHexahedra& candidates_;
  const AssemblyOptions& options_;
  AssemblyStatistics& statistics_;
  Pulse& pulse_;
  PotentialPrisms prisms_;
  Originals originals_{adjacency_, candidates_, prisms_};
  std::vector<Choice> chosen_;
  std::optional<ComplexBuilder> builder_;  ///< anew for each attempt to close, as is what works on its cells
  std::optional<Improver> improver_;
};

}  // namespace framehex::detail
