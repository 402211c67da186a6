// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/incompatibility_graph.hpp"

#include <charconv>
#include <istream>
#include <limits>
#include <ostream>
#include <string_view>

namespace framehex {

/// Writes a graph in the text format of METIS, which solvers of independent sets read: a line `n m 010`, then for each
/// candidate its weight and its neighbours, counted from 1. Weights are written in units, whole numbers; a first line,
/// a comment, gives the unit.
///
/// @throws io_error  when the stream fails.
inline void write_metis(std::ostream& out, const IncompatibilityGraph& graph) {
  std::string line = "% unit " + std::to_string(std::ilogb(graph.unit())) + " (a weight of 1 stands for 2^that)\n";
  line += std::to_string(graph.size()) + ' ' + std::to_string(graph.n_conflicts()) + " 010\n";
  for (index_t v = 0; v < graph.size(); ++v) {
    line += std::to_string(graph.weights_in_units()[v]);
    for (const index_t u : graph.neighbours(v)) (line += ' ') += std::to_string(u + 1);
    line += '\n';
    if (line.size() > 60000) {
      out << line;
      line.clear();
    }
  }
  out << line;
  if (!out) throw io_error("the graph could not be written");
}

namespace detail {

/// Reads the numbers of one line of a METIS file after the other.
class MetisReader {
public:
  explicit MetisReader(std::istream& in) : in_(in) {}

  /// Goes to the next line that is not a comment. @return false at the end.
  bool next_line() {
    while (std::getline(in_, line_)) {
      ++number_;
      rest_ = line_;
      if (rest_.starts_with("% unit ")) {
        rest_.remove_prefix(7);
        unit_exponent_ = static_cast<int>(need<std::int64_t>("an exponent"));
      } else if (!rest_.starts_with('%')) {
        return true;
      }
    }
    return false;
  }

  /// The next number of the line, if there is one.
  template <class Number>
  bool read(Number& number) {
    while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\t' || rest_[0] == '\r')) rest_.remove_prefix(1);
    if (rest_.empty()) return false;
    const auto [end, status] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (status != std::errc{}) refuse("'" + std::string(rest_.substr(0, 20)) + "' is not a number that fits here");
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return true;
  }

  template <class Number>
  Number need(const std::string& what) {
    Number number{};
    if (!read(number)) refuse(what + " is missing");
    return number;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw io_error("METIS graph, line " + std::to_string(number_) + ": " + why, Entity::line, {number_});
  }

  int unit_exponent() const { return unit_exponent_; }

private:
  std::istream& in_;
  std::string line_;
  std::string_view rest_;
  std::size_t number_ = 0;
  int unit_exponent_ = 0;
};

}  // namespace detail

/// Reads a graph in the text format of METIS, with or without weights of the candidates; weights of conflicts are
/// skipped.
///
/// @throws io_error       with the line, when it cannot be understood, or a row, neighbour or weight is missing.
/// @throws invalid_graph  with the candidate, when it is its own neighbour.
/// @throws invalid_weight with the candidate, when the weight is negative.
/// @par Complexity   O(n + conflicts log degree).
inline IncompatibilityGraph read_metis(std::istream& in) {
  detail::MetisReader reader(in);
  if (!reader.next_line()) throw io_error("METIS graph: there is no header");
  const auto n = reader.need<std::size_t>("the number of candidates");
  const auto n_conflicts = reader.need<std::size_t>("the number of conflicts");
  std::size_t format = 0, n_weights = 0;
  reader.read(format);
  const bool has_weights = format / 10 % 10 == 1, has_conflict_weights = format % 10 == 1;
  if (format > 11 || (!reader.read(n_weights) && has_weights)) n_weights = has_weights ? 1 : 0;
  if (format > 11 || format % 10 > 1 || n_weights > 1)
    reader.refuse("the format is not 0, 1, 10 or 11 with one weight");
  if (n >= no_index) reader.refuse("there are too many candidates");

  std::vector<double> weights;
  std::vector<std::array<index_t, 2>> conflicts;
  std::size_t n_entries = 0;
  for (std::size_t v = 0; v < n; ++v) {
    if (!reader.next_line()) throw io_error("METIS graph: it ends before candidate " + std::to_string(v + 1));
    weights.push_back(has_weights ? static_cast<double>(reader.need<std::int64_t>("a weight")) : 1.0);
    std::size_t u = 0;
    while (reader.read(u)) {
      if (u == 0 || u > n) reader.refuse("there is no candidate " + std::to_string(u));
      if (has_conflict_weights) reader.need<std::int64_t>("the weight of a conflict");
      conflicts.push_back({static_cast<index_t>(v), static_cast<index_t>(u - 1)});
      ++n_entries;
    }
  }
  if (n_entries != 2 * n_conflicts)
    throw io_error("METIS graph: " + std::to_string(n_conflicts) + " conflicts are announced, which are " +
                   std::to_string(2 * n_conflicts) + " entries, but there are " + std::to_string(n_entries));
  for (double& w : weights) w = std::ldexp(w, reader.unit_exponent());
  return make_incompatibility_graph(weights, conflicts);
}

}  // namespace framehex
