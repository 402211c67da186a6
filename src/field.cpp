// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/detail/boundary_frames_impl.hpp"
#include "framehex/field/detail/quartic_frame_impl.hpp"
#include "framehex/field/detail/singular_graph_impl.hpp"
#include "framehex/field/frame_diffusion.hpp"
#include "framehex/field/smoothing.hpp"

namespace framehex {

template SmoothingReport smooth_frames(const TetAdjacency&, std::span<Quaternion>, std::span<double>,
                                       std::span<const FrameConstraint>, std::span<const Vector3>,
                                       const SmoothingOptions&, const ExecutorRef&, const detail::WholeMesh&);
template DiffusionReport diffuse_frames(const TetAdjacency&, std::span<const Vector3>, std::span<Quaternion>,
                                        std::span<const FrameConstraint>, std::span<const Vector3>,
                                        const DiffusionOptions&, const ExecutorRef&, const detail::WholeMesh&);

}  // namespace framehex
