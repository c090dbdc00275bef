#include "report/gnuplot.hpp"

#include <sys/wait.h>

#include <fstream>

#include "fault/fault.hpp"

namespace tact::report {

Gnuplot::Gnuplot(const std::filesystem::path& file, int width, int height) : file_(file) {
  if (!std::ofstream(file)) throw SetupError(file.string() + ": cannot write the plot here");
  pipe_ = popen("exec gnuplot 2>/dev/null", "w");
  if (pipe_ == nullptr) throw SetupError("gnuplot: cannot start it");
  const bool svg = file.extension() == ".svg";
  std::fprintf(pipe_, "set terminal %s size %d,%d font 'sans,10'%s\nset output %s\n", svg ? "svg" : "pngcairo", width,
               height, svg ? " background '#ffffff'" : "", quoted(file.string()).c_str());
}

Gnuplot::~Gnuplot() {
  if (pipe_ != nullptr) pclose(pipe_);
}

void Gnuplot::finish() {
  const int status = pclose(pipe_);
  pipe_ = nullptr;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw SetupError("gnuplot failed on the plot " + file_.string() + ": is the package gnuplot-nox installed?");
  }
}

std::string Gnuplot::quoted(const std::string& words) {
  std::string out = "'";
  for (const char c : words)
    out += c == '\'' ? std::string("''") : c < ' ' && c >= 0 ? std::string(" ") : std::string(1, c);
  return out + "'";
}

}  // namespace tact::report
