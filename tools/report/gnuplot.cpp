#include "report/gnuplot.hpp"

#include <sys/wait.h>

#include <cstdio>
#include <fstream>

#include "fault/fault.hpp"

namespace tact::report {

std::string quoted(const std::string& words) {
  std::string out = "'";
  for (const char c : words)
    out += c == '\'' ? std::string("''") : c < ' ' && c >= 0 ? std::string(" ") : std::string(1, c);
  return out + "'";
}

void draw(const std::string& commands, const std::filesystem::path& png, int width, int height) {
  if (!std::ofstream(png)) throw SetupError(png.string() + ": cannot write the plot here");
  FILE* gnuplot = popen("exec gnuplot 2>/dev/null", "w");
  if (gnuplot == nullptr) throw SetupError("gnuplot: cannot start it");
  std::fprintf(gnuplot, "set terminal pngcairo size %d,%d font 'sans,10'\nset output %s\n", width, height,
               quoted(png.string()).c_str());
  std::fputs(commands.c_str(), gnuplot);
  const int status = pclose(gnuplot);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw SetupError("gnuplot failed on the plot " + png.string() + ": is the package gnuplot-nox installed?");
  }
}

}  // namespace tact::report
