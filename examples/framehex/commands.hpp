// SPDX-License-Identifier: BSL-1.0
// The commands. Each returns whether it came to its end (false: interrupted), and throws framehex::error.
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

#include "interruption.hpp"
#include "options.hpp"

namespace program {

bool mesh(const Options& options, const framehex::Observer& observer);
bool recombine(const Options& options, const framehex::Observer& observer);
bool plane(const Options& options, const framehex::Observer& observer);
bool shell(const Options& options, const framehex::Observer& observer);
bool field(const Options& options, const framehex::Observer& observer);
/// The whole of a run over MPI: one line on failure, by the first rank. @return the exit status, the same on all ranks.
int run_distributed(Options options);
bool inspect(const Options& options);                                         // and view, which writes a page besides
bool inspect_faces(const Options& options, const framehex::MixedMesh& mesh);  // a mesh without a volume

}  // namespace program
