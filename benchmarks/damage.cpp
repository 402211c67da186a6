// SPDX-License-Identifier: BSL-1.0
// Damages files at random and reads them: damage SAMPLES N [SEED]
//
// SAMPLES is a folder of whole files; each is read N times after damage of some kind. A reader may take what it gets or
// refuse it by a framehex::error that names the file. Anything else ends the program: another exception, an index out of
// range, a crash, more than 2 GB of memory, or more than 20 seconds for one file. That file is left in the working folder
// as damaged.EXTENSION.
#include "support/usable.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <random>

using namespace framehex;

namespace {

using Random = std::mt19937_64;

/// One change: a byte, a bit, a cut, a repetition, a swap, or another number.
void change(std::string& bytes, Random& random) {
  if (bytes.empty()) return;
  const std::size_t at = random() % bytes.size(), n = 1 + random() % std::min<std::size_t>(64, bytes.size() - at);
  constexpr std::array<const char*, 10> numbers{
      "-1", "0", "1e999", "nan", "4294967296", "99999999999999999999", "inf", "-0", "2147483647", "1e-320"};
  switch (random() % 8) {
    case 0: bytes[at] = static_cast<char>(random()); break;
    case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8)); break;
    case 2: bytes.erase(at, n); break;
    case 3: bytes.insert(at, bytes.substr(random() % bytes.size(), n)); break;
    case 4: bytes.resize(at); break;
    case 5: bytes.insert(at, 1, static_cast<char>('0' + random() % 10)); break;
    case 6: {  // a whole number in text
      const std::size_t begin = bytes.find_first_of("0123456789", at);
      if (begin == bytes.npos) break;
      const std::size_t end = bytes.find_first_not_of("0123456789.e+-", begin);
      bytes.replace(begin, std::min(end, bytes.size()) - begin, numbers[random() % numbers.size()]);
      break;
    }
    default: {  // eight bytes of a count
      const std::uint64_t value = random() % 3 == 0 ? ~std::uint64_t{0} : std::uint64_t{1} << random() % 64;
      const auto* const raw = reinterpret_cast<const char*>(&value);
      std::copy_n(raw, std::min<std::size_t>(random() % 2 == 0 ? 4 : 8, bytes.size() - at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}

struct Outcome {
  std::size_t n_read = 0, n_refused = 0;
};

Outcome damage(const std::filesystem::path& sample, std::size_t n, Random& random) {
  const std::string whole = read_file(sample), name = "damaged" + sample.extension().string();
  Outcome outcome;
  for (std::size_t i = 0; i < n; ++i) {
    std::string bytes = whole;
    for (std::size_t k = 1 + random() % 4; k > 0; --k) change(bytes, random);
    std::ofstream(name, std::ios::binary) << bytes;
    alarm(20);
    try {
      if (!test::reads_something_usable(name)) {
        std::printf("%s: read, but not usable (see %s)\n", sample.c_str(), name.c_str());
        std::exit(1);
      }
      ++outcome.n_read;
    } catch (const error& e) {
      if (std::string_view(e.what()).find(name) == std::string_view::npos) {
        std::printf("%s: refused without the file's name: %s\n", sample.c_str(), e.what());
        std::exit(1);
      }
      ++outcome.n_refused;
    }
    alarm(0);
  }
  std::filesystem::remove(name);
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::puts("damage SAMPLES N [SEED]");
    return 2;
  }
  constexpr rlim_t most = rlim_t{2} << 30;
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
  std::vector<std::filesystem::path> samples;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) samples.push_back(entry.path());
  std::sort(samples.begin(), samples.end());
  Random random(argc > 3 ? std::stoull(argv[3]) : 1);
  std::map<std::string, Outcome> of_reader;
  for (const auto& sample : samples) {
    const Outcome outcome = damage(sample, std::stoull(argv[2]), random);
    std::printf("%-24s %8zu read %8zu refused\n", sample.filename().c_str(), outcome.n_read, outcome.n_refused);
    std::fflush(stdout);
    Outcome& all = of_reader[sample.extension().string()];
    all.n_read += outcome.n_read;
    all.n_refused += outcome.n_refused;
  }
  for (const auto& [reader, outcome] : of_reader)
    std::printf("%-24s %8zu read %8zu refused\n", reader.c_str(), outcome.n_read, outcome.n_refused);
  return 0;
}
