// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/parts/detail/assembly_turns.hpp"
#include "framehex/parts/detail/contender_turns.hpp"
#include "framehex/parts/detail/greedy_rounds.hpp"
#include "framehex/parts/detail/halo.hpp"
#include "framehex/parts/detail/part_bound.hpp"
#include "framehex/parts/detail/part_candidates.hpp"
#include "framehex/parts/detail/part_choice.hpp"
#include "framehex/parts/detail/result_maker.hpp"
#include "framehex/parts/detail/whole_part.hpp"
#include "framehex/parts/input.hpp"
#include "framehex/parts/result.hpp"
#include "framehex/selection/candidate_weights.hpp"

#include <chrono>
#include <functional>
#include <optional>

namespace framehex::detail {

/// The steps of `recombine_in_parts`, on one rank.
template <Transport Tr, Executor E>
class PartsRecombiner {
public:
  PartsRecombiner(const PartInput& input, const Tr& transport, const PartsOptions& options, const E& executor)
      : input_(input), transport_(transport), options_(options), thread_(options.observer), executor_(executor, [this] {
          return !thread_.go_on(stage_, thread_.fraction());
        }) {}

  PartRecombination run() {
    check_input();
    if (!find_box(transport_, input_, low_, high_)) return std::move(result_);
    while (!attempt()) result_ = {};
    return std::move(result_);
  }

private:
  using States = CandidateStates<Tr>;

  /// Leaves in which contenders are exchanged may be larger by this: these are one candidate in twelve at most.
  static constexpr std::size_t contender_size = 4;

  using Clock = std::chrono::steady_clock;

  void lap(double& seconds) {
    const Clock::time_point now = Clock::now();
    seconds += std::chrono::duration<double>(now - std::exchange(last_lap_, now)).count();
  }

  bool stopped() {
    result_ = {};
    result_.status = Status::cancelled;
    return true;
  }

  /// @return false when some quadrilaterals could not be closed: the next attempt does without the cells there.
  bool attempt() {
    gather_patch();
    result_.n_parts = static_cast<std::int64_t>(partition_->size());
    if (partition_->size() == 1) return run_whole();
    PartState state;
    if (!select(state)) return stopped();
    AssemblyOptions assembling = options_.assembly;
    if (n_attempts_ >= most_attempts) assembling.improvement = ImprovementMode::none;
    AssemblyTurns turns(transport_, low_, high_, assembling, executor_, thread_);
    if (!turns.run(state, turn_size(state))) return stopped();
    result_.n_turns = turns.n_turns();
    result_.n_kept = sum_of(transport_, static_cast<std::int64_t>(turns.n_kept));
    if (options_.assembly.interfaces == InterfaceMode::conforming) {
      if (turns.n_unmatched() > 0) return withdraw(turns.unmatched_vertices());
      check_volume(state);
    }
    lap(result_.assembly_seconds);
    ResultMaker(transport_, turns.partition(), turns.leaf_of_cell(), first_new_).run(std::move(state), result_);
    result_.assembly = turns.statistics;
    for (std::size_t v = 0; v < result_.owners.size(); ++v)
      result_.assembly.n_new_vertices +=
          result_.vertex_numbers[v] >= first_new_ && result_.owners[v] == transport_.rank();
    add_up(result_.assembly);
    return true;
  }

  /// Counts of all ranks.
  void add_up(AssemblyStatistics& s) const {
    constexpr std::array counts{&AssemblyStatistics::n_open_quadrilaterals,
                                &AssemblyStatistics::n_merged,
                                &AssemblyStatistics::n_raised,
                                &AssemblyStatistics::n_split,
                                &AssemblyStatistics::n_dissolved,
                                &AssemblyStatistics::n_withdrawn,
                                &AssemblyStatistics::n_refitted,
                                &AssemblyStatistics::n_unfit,
                                &AssemblyStatistics::n_new_vertices,
                                &AssemblyStatistics::n_removed_vertices};
    std::array<std::int64_t, counts.size()> sums{};
    for (std::size_t i = 0; i < counts.size(); ++i) sums[i] = static_cast<std::int64_t>(s.*counts[i]);
    transport_.sum(std::span<std::int64_t>(sums));
    for (std::size_t i = 0; i < counts.size(); ++i) s.*counts[i] = static_cast<std::size_t>(sums[i]);
  }

  /// Cells at some vertices are not chosen again, and after some attempts none is.
  bool withdraw(const std::vector<global_t>& vertices) {
    if (n_attempts_ > most_attempts)
      throw unsound_mesh("the mesh that was made does not pass its own check: faces have no other side", Entity::vertex,
                         {vertices.begin(), vertices.end()});
    ++n_attempts_;
    Rows<global_t> rows(static_cast<std::size_t>(transport_.n_ranks()), vertices);
    for (const global_t v : send_joined(transport_, std::move(rows))) withdrawn_.push_back(v);
    std::sort(withdrawn_.begin(), withdrawn_.end());
    withdrawn_.erase(std::unique(withdrawn_.begin(), withdrawn_.end()), withdrawn_.end());
    return false;
  }

  bool is_withdrawn(global_t vertex) const {
    return n_attempts_ >= most_attempts || std::binary_search(withdrawn_.begin(), withdrawn_.end(), vertex);
  }

  void check_input() const {
    const auto check = [](const char* name, std::size_t n, std::size_t expected) {
      if (n != expected)
        throw invalid_option(std::string(name) + " has " + std::to_string(n) + " entries where " +
                             std::to_string(expected) + " are needed");
    };
    check("PartInput::vertex_numbers", input_.vertex_numbers.size(), input_.points.size());
    check("PartInput::cell_numbers", input_.cell_numbers.size(), input_.tets.size());
    if (!input_.regions.empty()) check("PartInput::regions", input_.regions.size(), input_.tets.size());
    check_numbers(input_.vertex_numbers, Entity::vertex);
    check_numbers(input_.cell_numbers, Entity::cell);
    if (options_.assembly.boundary_projection)
      throw invalid_option("a mesh in parts keeps its boundary vertices: boundary_projection must be empty");
    if (options_.assembly.interfaces == InterfaceMode::no_pyramids || options_.assembly.fit != CellFit::any)
      throw invalid_option("a mesh in parts is closed with pyramids and fits elements of any kind only");
    if (options_.finder.input_check == InputCheck::validate)
      validate(IndexedTetMesh{{input_.points.begin(), input_.points.end()}, {input_.tets.begin(), input_.tets.end()}});
  }

  void gather_patch() {
    const MortonCube cube(low_, high_, 0);
    std::vector<MortonCube::Code> codes;
    for (std::size_t tet = 0; tet < input_.tets.size(); ++tet) codes.push_back(cube.code(centre_of_tet(input_, tet)));
    partition_.emplace(transport_, cube, std::move(codes), options_.part_size);
    const bool has_regions = any_rank(transport_, !input_.regions.empty());
    HeldTets held = distribute(transport_, *partition_, input_);
    HaloExchange(transport_, *partition_, held).run(n_halo_layers);
    patch_.emplace(std::move(held), *partition_, has_regions);
    leaves_ = partition_->leaves_of(transport_.rank());
    first_new_ = greatest_number(transport_, input_.vertex_numbers) + 1;
    for_each_own_tet([&](index_t) { ++n_tets_; });
    n_tets_ = sum_of(transport_, n_tets_);
  }

  template <class Visit>
  void for_each_own_tet(Visit&& visit) const {
    for (index_t tet = 0; tet < patch_->mesh.tets.size(); ++tet)
      if (patch_->leaf_of_tet[tet] >= leaves_[0] && patch_->leaf_of_tet[tet] < leaves_[1]) visit(tet);
  }

  /// The cells' volumes and that inside the boundary, as multiples of a part of the box, so that their sums do not depend on
  /// the order.
  void check_volume(const PartState& state) const {
    const double width = (high_ - low_).maxCoeff();
    const auto in_units = [&](double volume) { return std::llround(std::ldexp(volume / (width * width * width), 58)); };
    std::array<std::int64_t, 2> sums{0, 0};
    std::array<Vector3, 8> p;
    for (const CellRecord& cell : state.cells) {
      for (std::size_t i = 0; i < cell.size(); ++i)
        p[i] = point_at(state.vertices[state.find(cell.corners[i])].place) - low_;
      sums[0] += in_units(cell_volume(cell.kind, {p.data(), cell.size()}));
      const auto faces = faces_of(cell.kind);
      for (std::size_t f = 0; f < faces.size(); ++f)
        if (cell.marks[f] & FaceMark::boundary) sums[1] += in_units(volume_under(faces[f], p));
    }
    transport_.sum(std::span<std::int64_t>(sums));
    const auto volume = static_cast<double>(sums[0]);
    if (!(std::abs(volume - static_cast<double>(sums[1])) <= 1e-9 * volume))
      throw unsound_mesh("the mesh that was made does not pass its own check: the volume is not kept");
  }

  /// Between the origin and a face, a quadrilateral taken as its bilinear patch.
  static double volume_under(const LocalFace& face, const std::array<Vector3, 8>& corners) {
    const auto p = [&](std::size_t i) -> const Vector3& { return corners[static_cast<std::size_t>(face.corners[i])]; };
    if (face.size() == 3) return p(0).cross(p(1)).dot(p(2)) / 6;
    return (p(0).cross(p(2)).dot(p(3) - p(1)) + p(1).cross(p(3)).dot(p(0) - p(2))) / 12;
  }

  /// Search, greedy rounds, contenders, prisms. @return false when stopped.
  bool select(PartState& state) {
    stage_ = "recombination";
    const std::vector<index_t> own = own_vertices(*patch_, leaves_);
    PotentialHexahedra found = find_candidates_at(*patch_, own, options_.finder, executor_);
    if (any_rank(transport_, thread_.stopped())) return false;
    lap(result_.search_seconds);
    stage_ = "selection";
    result_.n_candidates = sum_of(transport_, static_cast<std::int64_t>(found.size()));
    std::vector<double> weights = list_weights(found.size(), volume_times_quality(found));
    CandidatePool pool(*patch_, std::move(found), std::move(weights));
    States states(transport_, pool);
    if (!choose(pool, states)) return false;
    give_up(pool, states);
    count_chosen(pool, states);
    lap(result_.selection_seconds);
    stage_ = "assembly";
    ChosenCells chosen = share_chosen(transport_, *partition_, *patch_, pool, states);
    return make_state(chosen, state);
  }

  bool choose(CandidatePool& pool, States& states) {
    BorderExchange border(transport_, *partition_, pool);
    const auto stop = [this] { return !thread_.go_on(stage_, thread_.fraction()); };
    const auto greedy = [&] {
      GreedyRounds rounds(transport_, pool, border, states);
      const bool done = rounds.run(stop);
      result_.n_rounds += rounds.n_rounds() + 1;
      return done;
    };
    if (!greedy()) return false;
    if (options_.selection.method == SelectMethod::greedy) return true;
    ContenderTurns turns(transport_, pool, border, states, executor_, thread_);
    for (const double shift : {0.0, 0.4, 0.2}) {
      const MortonCube cube(low_, high_, shift);
      std::vector<MortonCube::Code> codes;
      for_each_own_tet([&](index_t tet) {
        const auto& t = patch_->mesh.tets[tet];
        const auto& p = patch_->mesh.points;
        codes.push_back(cube.code(centre_of_tet(p[t[0]], p[t[1]], p[t[2]], p[t[3]])));
      });
      turns.run(Partition(transport_, cube, std::move(codes), contender_size * options_.part_size),
                options_.selection.seed);
      if (any_rank(transport_, thread_.stopped())) return false;
    }
    // What has become free may fit.
    states.reopen();
    states.exchange();
    return greedy();
  }

  void give_up(const CandidatePool& pool, States& states) {
    if (n_attempts_ == 0) return;
    std::int64_t n = 0;
    for (index_t v = 0; v < pool.n_own; ++v) {
      if (states[v] != States::taken) continue;
      const auto& corners = pool.candidates.vertices[v];
      if (std::ranges::none_of(corners, [&](index_t w) { return is_withdrawn(pool.vertex_number[w]); })) continue;
      states.set(v, States::refused);
      ++n;
    }
    states.exchange();
    result_.n_given_up = sum_of(transport_, n);
  }

  void count_chosen(const CandidatePool& pool, const States& states) {
    std::array<double, 1> heaviest{0};
    for (const double w : pool.weights) heaviest[0] = std::min(heaviest[0], -w);
    transport_.least(std::span<double>(heaviest));
    if (heaviest[0] == 0) heaviest[0] = -1;
    const double unit = std::ldexp(-heaviest[0], -30);
    std::array<std::int64_t, 3> sums{0, 0, 0};
    for (index_t v = 0; v < pool.n_own; ++v)
      if (states[v] == States::taken) {
        result_.chosen.push_back(v);
        ++sums[0];
        sums[1] += std::llround(pool.weights[v] / unit);
      }
    for (const double bound : bounds_of_leaves(pool, patch_->leaf_of_vertex, leaves_, executor_, thread_))
      sums[2] += static_cast<std::int64_t>(std::ceil(bound / unit)) + 1;
    transport_.sum(std::span<std::int64_t>(sums));
    result_.n_chosen = sums[0];
    result_.weight = static_cast<double>(sums[1]) * unit;
    result_.bound = static_cast<double>(std::max(sums[1], sums[2])) * unit;
  }

  bool make_state(const ChosenCells& hexahedra, PartState& state) {
    StateMaker maker(*patch_);
    maker.add(CellKind::hexahedron, hexahedra);
    if (options_.assembly.prisms == PrismMode::chosen)
      for (const ChosenCells& prisms : choose_prisms_of_leaves(hexahedra)) maker.add(CellKind::prism, prisms);
    state = maker.finish(leaves_);
    patch_.reset();
    return !any_rank(transport_, thread_.stopped());
  }

  std::vector<ChosenCells> choose_prisms_of_leaves(const ChosenCells& hexahedra) {
    const Csr<index_t> hexahedra_of_vertex = make_csr(patch_->mesh.points.size(), [&](auto&& put) {
      for (index_t i = 0; i < hexahedra.size(); ++i)
        for (const index_t v : hexahedra.vertices[i])
          if (v != no_index) put(v, i);
    });
    const Csr<index_t> tets_of_leaf = make_csr(leaves_[1] - leaves_[0], [&](auto&& put) {
      for_each_own_tet([&](index_t tet) { put(patch_->leaf_of_tet[tet] - leaves_[0], tet); });
    });
    std::vector<ChosenCells> prisms(tets_of_leaf.size());
    executor_(tets_of_leaf.size(), [&](std::size_t i, std::size_t) {
      if (!thread_.stopped())
        prisms[i] = LeafPrisms(*patch_, hexahedra, hexahedra_of_vertex, options_.assembly)
                        .choose(
                            leaves_[0] + static_cast<index_t>(i), tets_of_leaf[i],
                            [this](global_t v) { return !is_withdrawn(v); }, thread_.part("assembly"));
    });
    return prisms;
  }

  /// Cells for a leaf in the turns: as many as fill the tetrahedra of a part.
  std::size_t turn_size(const PartState& state) const {
    const auto n_cells = static_cast<double>(sum_of(transport_, static_cast<std::int64_t>(state.cells.size())));
    const double size = static_cast<double>(options_.part_size) * n_cells / static_cast<double>(n_tets_);
    return static_cast<std::size_t>(std::max(1.0, size));
  }

  /// One rank holds all: what is done with a mesh that lies in one place.
  bool run_whole() {
    const int rank = partition_->rank(0);
    bool is_stopped = false;
    if (rank == transport_.rank())
      is_stopped = !recombine_whole(*patch_, options_, executor_, thread_, first_new_, result_);
    if (any_rank(transport_, is_stopped)) return stopped();
    result_.owners.assign(result_.vertex_numbers.size(), transport_.rank());
    const auto share = [&](std::int64_t& value) { value = sum_of(transport_, value); };
    share(result_.n_candidates);
    share(result_.n_chosen);
    share(result_.n_given_up);
    add_up(result_.assembly);
    std::array<double, 2> least{-result_.weight, -result_.bound};
    transport_.least(std::span<double>(least));
    result_.weight = -least[0];
    result_.bound = -least[1];
    return true;
  }

  const PartInput& input_;
  const Tr& transport_;
  const PartsOptions& options_;
  CallingThread thread_;
  std::string_view stage_ = "recombination";
  StoppableExecutor<E, std::function<bool()>> executor_;
  Vector3 low_, high_;
  Clock::time_point last_lap_ = Clock::now();
  std::optional<Partition> partition_;
  std::optional<TetPatch> patch_;
  std::array<index_t, 2> leaves_{0, 0};
  std::int64_t n_tets_ = 0;
  global_t first_new_ = 0;  ///< number of a vertex
  static constexpr std::size_t most_attempts = 6;
  std::size_t n_attempts_ = 0;
  std::vector<global_t> withdrawn_;  ///< vertices, ascending
  PartRecombination result_;
};

}  // namespace framehex::detail
