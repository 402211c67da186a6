// SPDX-License-Identifier: BSL-1.0
#include "measures.hpp"

#include "framehex/errors.hpp"
#include "framehex/verify/validity.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <numbers>

namespace program {

using framehex::CellKind;
using framehex::index_t;

namespace {

constexpr std::array<const char*, 4> kind_names{"tetrahedra", "pyramids", "prisms", "hexahedra"};
constexpr std::size_t hexahedron = static_cast<std::size_t>(CellKind::hexahedron);

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : 0.0;
}

}  // namespace

double Measures::hex_ratio_by_number() const {
  return ratio(static_cast<double>(kinds[hexahedron].n), static_cast<double>(n_cells));
}

double Measures::hex_ratio_by_volume() const {
  return ratio(kinds[hexahedron].volume, volume);
}

Measures measure(const framehex::MixedMesh& mesh) {
  Measures m;
  const framehex::verify::ConformityReport conformity = framehex::verify::is_conforming(mesh);
  if (!conformity.malformed_cells.empty()) {
    const std::size_t cell = conformity.malformed_cells.front();
    throw framehex::invalid_connectivity("cell " + std::to_string(cell) + " uses a vertex twice",
                                         framehex::Entity::cell, {cell});
  }
  m.n_points = mesh.points.size();
  m.n_cells = mesh.n_cells();
  m.scaled_jacobian.reserve(m.n_cells);
  std::array<framehex::Vector3, 8> corners;
  for (std::size_t c = 0; c < m.n_cells; ++c) {
    const auto row = mesh.cells[c];
    for (std::size_t i = 0; i < row.size(); ++i) corners[i] = mesh.points[row[i]];
    const double quality = framehex::scaled_jacobian(mesh.kinds[c], std::span(corners).first(row.size()));
    m.scaled_jacobian.push_back(quality);
    KindMeasures& kind = m.kinds[static_cast<std::size_t>(mesh.kinds[c])];
    ++kind.n;
    kind.least = std::min(kind.least, quality);
    kind.mean += quality;
    m.mean += quality;
    m.fraction_good += quality >= 0.2 ? 1 : 0;
  }
  for (KindMeasures& kind : m.kinds) {
    kind.mean = ratio(kind.mean, static_cast<double>(kind.n));
    m.least = std::min(m.least, kind.least);
  }
  m.mean = ratio(m.mean, static_cast<double>(m.n_cells));
  m.fraction_good = ratio(m.fraction_good, static_cast<double>(m.n_cells));

  framehex::verify::VolumeReport volume = framehex::verify::volume(mesh);
  for (std::size_t k = 0; k < 4; ++k) m.kinds[k].volume = volume.by_kind[k];
  m.volume = volume.cells;
  m.boundary_volume = volume.boundary;
  m.inverted_cells = std::move(volume.inverted_cells);
  m.invalid_cells = framehex::verify::is_valid(mesh).invalid_cells;
  for (const auto& face : conformity.open_quadrilaterals) m.open_cells.push_back(face.cell);
  std::sort(m.open_cells.begin(), m.open_cells.end());
  m.n_bad_faces = conformity.used_over_twice.size() + conformity.same_side.size() + conformity.twisted.size() +
                  conformity.three_vertices_shared.size();
  m.n_open_edges = conformity.open_edges.size();
  m.n_nonmanifold_edges = conformity.nonmanifold_edges.size();
  m.solver = framehex::verify::solver_quality(mesh);
  return m;
}

void add_to(nlohmann::ordered_json& json, const Measures& m) {
  auto& counts = json["counts"];
  counts["vertices"] = m.n_points;
  counts["cells"] = m.n_cells;
  for (std::size_t k = 0; k < 4; ++k) counts[kind_names[k]] = m.kinds[k].n;

  json["hex_ratio"]["number"] = m.hex_ratio_by_number();
  json["hex_ratio"]["volume"] = m.hex_ratio_by_volume();

  auto& quality = json["quality"];
  quality["least"] = m.least;
  quality["mean"] = m.mean;
  quality["fraction_above_0.2"] = m.fraction_good;
  for (std::size_t k = 0; k < 4; ++k)
    if (m.kinds[k].n > 0)
      quality[kind_names[k]] = {{"least", m.kinds[k].least}, {"mean", m.kinds[k].mean}, {"volume", m.kinds[k].volume}};
  quality["invalid_cells"] = m.invalid_cells;
  quality["inverted_cells"] = m.inverted_cells;
  quality["volume"] = m.volume;

  const framehex::verify::SolverQuality& solver = m.solver;
  constexpr double degree = std::numbers::pi / 180;
  json["solver_quality"] = {{"non_orthogonality_degrees", solver.non_orthogonality / degree},
                            {"mean_non_orthogonality_degrees", solver.mean_non_orthogonality / degree},
                            {"flatness", solver.flatness},
                            {"decomposition", solver.decomposition},
                            {"weight", solver.weight},
                            {"volume_ratio", solver.volume_ratio},
                            {"determinant", solver.determinant},
                            {"bad_decomposition_cells", solver.bad_decomposition},
                            {"small_determinant_cells", solver.small_determinant},
                            {"small_weight_cells", solver.small_weight},
                            {"cells_with_one_inner_face", solver.lonely}};

  auto& conformity = json["conformity"];
  conformity["open_quads"] = m.open_cells.size();
  conformity["open_cells"] = m.open_cells;
  conformity["other_bad_faces"] = m.n_bad_faces;
  conformity["open_boundary_edges"] = m.n_open_edges;
  conformity["nonmanifold_boundary_edges"] = m.n_nonmanifold_edges;
  conformity["boundary_volume"] = m.boundary_volume;
}

}  // namespace program
