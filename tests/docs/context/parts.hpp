// SPDX-License-Identifier: BSL-1.0

inline std::vector<framehex::Vector3> points;
inline std::vector<std::array<framehex::index_t, 4>> tets;
inline std::vector<framehex::global_t> vertices, cells;
