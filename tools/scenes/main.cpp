// tact-write-motions FOLDER: writes the motions of the scenes.
#include <cstdio>
#include <fstream>

#include "scenes/stored_motions.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: tact-write-motions FOLDER    (deploy/scenes)\n");
    return 2;
  }
  for (const auto& [name, motion] : tact::scenes::stored_motions()) {
    const std::string path = std::string(argv[1]) + "/" + name;
    std::ofstream out(path, std::ios::binary);
    out << tact::scenes::to_csv(motion);
    if (!out.flush()) {
      std::fprintf(stderr, "%s: could not be written\n", path.c_str());
      return 1;
    }
  }
  return 0;
}
