// SPDX-License-Identifier: BSL-1.0
// Every rank runs the same cases in the same order; a failed assertion on one ends them all.
#define CATCH_CONFIG_RUNNER
#include <mpi.h>

#include <catch2/catch.hpp>
#include <iostream>

namespace {

struct EndAll : Catch::TestEventListenerBase {
  using TestEventListenerBase::TestEventListenerBase;

  bool assertionEnded(const Catch::AssertionStats& stats) override {
    const Catch::AssertionResult& result = stats.assertionResult;
    if (result.isOk()) return true;
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    std::cerr << "rank " << rank << ": " << result.getSourceInfo() << ": " << result.getExpression() << "\n  is "
              << result.getExpandedExpression() << '\n';
    for (const Catch::MessageInfo& info : stats.infoMessages) std::cerr << "  " << info.message << '\n';
    MPI_Abort(MPI_COMM_WORLD, 1);
    return true;
  }
};

}  // namespace

CATCH_REGISTER_LISTENER(EndAll)

int main(int argc, char** argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &provided);
  const int failed = Catch::Session().run(argc, argv);
  MPI_Finalize();
  return failed;
}
