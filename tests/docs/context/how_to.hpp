// SPDX-License-Identifier: BSL-1.0
#include <atomic>

extern const framehex::IndexedTriangleMesh surface;
extern const framehex::IndexedTetMesh mesh;
extern std::vector<double> lengths;
struct Window {
  void show(std::string_view, double);
  bool cancelled();
};
extern Window window;
struct ThreadPool {
  std::size_t n_threads() const;
  void start(std::function<void()>);
  void wait();
};
