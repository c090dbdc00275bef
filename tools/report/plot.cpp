#include <sys/wait.h>

#include <cstdio>
#include <fstream>

#include "fault/fault.hpp"
#include "report/session_report.hpp"

namespace tact::report {
namespace {

/// Titles and file names are users' words: gnuplot reads them inside single quotes, where only ' is special.
std::string quoted(const std::string& words) {
  std::string out = "'";
  for (const char c : words)
    out += c == '\'' ? std::string("''") : c < ' ' && c >= 0 ? std::string(" ") : std::string(1, c);
  return out + "'";
}

}  // namespace

void write_plot(const std::string& title, const std::vector<Sample>& samples, const std::filesystem::path& png) {
  if (!std::ofstream(png)) throw SetupError(png.string() + ": cannot write the plot here");
  FILE* gnuplot = popen("exec gnuplot 2>/dev/null", "w");
  if (gnuplot == nullptr) throw SetupError("gnuplot: cannot start it");
  std::fprintf(gnuplot, "set terminal pngcairo size 1200,1000 font 'sans,10'\nset output %s\n$session << EOD\n",
               quoted(png.string()).c_str());
  for (const Sample& s : samples) {
    std::fprintf(gnuplot, "%.4f %.5g %.5g %u %.5g\n", s.time_s, s.force_n, s.penetration_voxels, s.contacts, s.tick_us);
  }
  std::fprintf(gnuplot,
               "EOD\nset multiplot layout 4,1 title %s noenhanced\n"
               "set grid\nset autoscale xfix\nset offsets 0, 0, graph 0.05, 0\nset lmargin 10\nset rmargin 3\nunset "
               "key\nset yrange [0:*]\n"
               "set ylabel 'force [N]'\nplot $session using 1:2 with lines lc rgb '#c03020'\n"
               "set ylabel 'depth [voxels]'\nset yrange [0:0.6<*]\n"
               "plot $session using 1:3 with lines lc rgb '#2060c0', 0.5 with lines dt 2 lc rgb '#606060'\n"
               "set yrange [0:*]\nset ylabel 'contacts'\nplot $session using 1:4 with lines lc rgb '#208040'\n"
               "set ylabel 'tick [us]'\nset xlabel 'time [s]'\nplot $session using 1:5 with lines lc rgb '#805090'\n"
               "unset multiplot\n",
               quoted(title).c_str());
  const int status = pclose(gnuplot);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw SetupError("gnuplot failed on the plot " + png.string() + ": is the package gnuplot-nox installed?");
  }
}

}  // namespace tact::report
