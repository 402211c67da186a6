// SPDX-License-Identifier: BSL-1.0
// Uses framehex for one thing: the heaviest independent set of a graph in a file, with a proven gap. No mesh is
// involved.
//
//   select_graph graph.metis [greedy|best|exact] [gap in percent] [seconds] > members.txt
//
// The members are written one a line, counted from 1 as in the file.
#include <framehex/io/metis_format.hpp>
#include <framehex/selection/select.hpp>
#include <framehex/verify/independence.hpp>

#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

namespace {

const char* name(framehex::SelectionStatus status) {
  switch (status) {
    case framehex::SelectionStatus::optimal: return "optimal";
    case framehex::SelectionStatus::gap_reached: return "gap_reached";
    case framehex::SelectionStatus::budget_exhausted: return "budget_exhausted";
    default: return "cancelled";
  }
}

double number(const std::string& word) {
  std::istringstream text(word);
  double value = 0;
  if (!(text >> value) || !text.eof()) throw framehex::invalid_option("'" + word + "' is not a number");
  return value;
}

int run(int argc, char** argv) {
  const std::map<std::string, framehex::SelectMethod> methods{{"greedy", framehex::SelectMethod::greedy},
                                                              {"best", framehex::SelectMethod::best},
                                                              {"exact", framehex::SelectMethod::exact}};
  const auto method = methods.find(argc > 2 ? argv[2] : "best");
  if (argc < 2 || argc > 5 || method == methods.end()) {
    std::cerr << "usage: " << argv[0] << " graph.metis [greedy|best|exact] [gap in percent] [seconds]\n";
    return 2;
  }
  std::ifstream file(argv[1]);
  if (!file) throw framehex::io_error(std::string(argv[1]) + ": cannot be opened");
  const framehex::IncompatibilityGraph graph = [&] {
    try {
      return framehex::read_metis(file);
    } catch (const framehex::error& e) {
      throw framehex::io_error(std::string(argv[1]) + ": " + e.what());
    }
  }();
  const framehex::GraphStatistics numbers = framehex::statistics(graph);
  std::cerr << numbers.n_candidates << " candidates, " << numbers.n_conflicts << " conflicts, mean degree "
            << numbers.mean_degree << ", components: " << numbers.n_components << '\n';

  framehex::SelectOptions options{.method = method->second};
  if (argc > 3) options.gap = number(argv[3]) / 100;
  if (argc > 4) options.seconds = number(argv[4]);
  const framehex::Selection selection = framehex::select(graph, options);
  if (!framehex::verify::is_maximal(graph, selection.members)) throw framehex::error("the selection is not maximal");

  std::cerr.precision(12);
  std::cerr << selection.members.size() << " selected, weight " << selection.weight << ", bound " << selection.bound
            << ", gap " << 100 * selection.gap() << " %, " << name(selection.status) << '\n';
  for (const framehex::index_t v : selection.members) std::cout << v + 1 << '\n';
  if (!std::cout.flush()) throw framehex::io_error("standard output: cannot be written");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const framehex::error& e) {
    std::cerr << e.what() << '\n';
    return 2;
  }
}
