#include "report/gnuplot.hpp"

#include <sys/wait.h>

#include <fstream>

#include "fault/fault.hpp"

namespace tact::report {

Gnuplot::Gnuplot(const std::filesystem::path& png, int width, int height) : png_(png) {
  if (!std::ofstream(png)) throw SetupError(png.string() + ": cannot write the plot here");
  pipe_ = popen("exec gnuplot 2>/dev/null", "w");
  if (pipe_ == nullptr) throw SetupError("gnuplot: cannot start it");
  std::fprintf(pipe_, "set terminal pngcairo size %d,%d font 'sans,10'\nset output %s\n", width, height,
               quoted(png.string()).c_str());
}

Gnuplot::~Gnuplot() {
  if (pipe_ != nullptr) pclose(pipe_);
}

void Gnuplot::finish() {
  const int status = pclose(pipe_);
  pipe_ = nullptr;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw SetupError("gnuplot failed on the plot " + png_.string() + ": is the package gnuplot-nox installed?");
  }
}

std::string Gnuplot::quoted(const std::string& words) {
  std::string out = "'";
  for (const char c : words)
    out += c == '\'' ? std::string("''") : c < ' ' && c >= 0 ? std::string(" ") : std::string(1, c);
  return out + "'";
}

}  // namespace tact::report
