#include <cstdio>

#include "report/gnuplot.hpp"
#include "report/session_report.hpp"

namespace tact::report {

void write_plot(const std::string& title, const std::vector<Sample>& samples, const std::filesystem::path& png) {
  std::string commands = "$session << EOD\n";
  for (const Sample& s : samples) {
    char row[128];
    std::snprintf(row, sizeof row, "%.4f %.5g %.5g %u %.5g\n", s.time_s, s.force_n, s.penetration_voxels, s.contacts,
                  s.tick_us);
    commands += row;
  }
  commands += "EOD\nset multiplot layout 4,1 title " + quoted(title) +
              " noenhanced\n"
              "set grid\nset autoscale xfix\nset offsets 0, 0, graph 0.05, 0\nset lmargin 10\nset rmargin 3\nunset "
              "key\nset yrange [0:*]\n"
              "set ylabel 'force [N]'\nplot $session using 1:2 with lines lc rgb '#c03020'\n"
              "set ylabel 'depth [voxels]'\nset yrange [0:0.6<*]\n"
              "plot $session using 1:3 with lines lc rgb '#2060c0', 0.5 with lines dt 2 lc rgb '#606060'\n"
              "set yrange [0:*]\nset ylabel 'contacts'\nplot $session using 1:4 with lines lc rgb '#208040'\n"
              "set ylabel 'tick [us]'\nset xlabel 'time [s]'\nplot $session using 1:5 with lines lc rgb '#805090'\n"
              "unset multiplot\n";
  draw(commands, png, 1200, 1000);
}

}  // namespace tact::report
