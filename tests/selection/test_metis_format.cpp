// SPDX-License-Identifier: BSL-1.0
#include "framehex/io/metis_format.hpp"
#include "support/random_graphs.hpp"

#include <catch2/catch.hpp>

#include <sstream>

using namespace framehex;

TEST_CASE("a graph survives METIS's format", "[selection][metis]") {
  std::mt19937_64 engine(11);
  for (int i = 0; i < 20; ++i) {
    const auto graph =
        test::random_graph(engine, static_cast<index_t>(engine() % 40), 0.3, static_cast<test::Weights>(i % 4));
    std::stringstream file;
    write_metis(file, graph);
    const auto read = read_metis(file);
    REQUIRE(read.size() == graph.size());
    CHECK(read.rows().values == graph.rows().values);
    for (index_t v = 0; v < graph.size(); ++v) CHECK(read.weight(v) == graph.weight(v));
  }
}

TEST_CASE("the text is METIS's", "[selection][metis]") {
  const auto path =
      make_incompatibility_graph(std::vector<double>{5, 7, 2}, std::vector<std::array<index_t, 2>>{{0, 1}, {1, 2}});
  std::stringstream file;
  write_metis(file, path);
  std::string comment;
  std::getline(file, comment);
  CHECK(comment.starts_with('%'));
  std::stringstream rest;
  rest << file.rdbuf();
  CHECK(rest.str() == "3 2 010\n5 2\n7 1 3\n2 2\n");

  std::stringstream plain("% from elsewhere\n3 2\n2\n1 3\n2\n");
  CHECK(read_metis(plain).weight(2) == 1);
  std::stringstream both("3 2 11\n4 2 9\n5 1 9 3 8\n6 2 8\r\n");
  const auto weighted = read_metis(both);
  CHECK(weighted.n_conflicts() == 2);
  CHECK(weighted.weight(2) == 6);
}

TEST_CASE("broken METIS files are refused with the line", "[selection][metis]") {
  const auto line_of = [](const std::string& text) -> std::size_t {
    std::stringstream file(text);
    try {
      read_metis(file);
    } catch (const io_error& e) {
      return e.indices().empty() ? 0 : e.indices()[0];
    }
    return 99;
  };
  CHECK(line_of("") == 0);
  CHECK(line_of("3\n") == 1);
  CHECK(line_of("3 2 100\n2\n1 3\n2\n") == 1);
  CHECK(line_of("3 2\n2\n1 4\n2\n") == 3);
  CHECK(line_of("3 2\n2\n1 x\n2\n") == 3);
  CHECK(line_of("3 2\n2\n0 3\n2\n") == 3);
  CHECK(line_of("3 2 10\n\n1 2\n1 2\n") == 2);
  CHECK(line_of("3 2\n2\n1 3\n") == 0);
  CHECK(line_of("3 5\n2\n1 3\n2\n") == 0);
  std::stringstream loop("2 1\n1\n2\n");
  CHECK_THROWS_AS(read_metis(loop), invalid_graph);
  std::stringstream negative("2 1 10\n-3 2\n1 1\n");
  CHECK_THROWS_AS(read_metis(negative), invalid_weight);
}
