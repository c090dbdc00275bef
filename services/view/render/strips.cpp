#include "view/render/strips.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "view/render/canvas.hpp"

namespace tact::view {
namespace {

struct Strip {
  const char* name;
  const char* unit;
  float HistorySample::*value;
  cv::Scalar colour;
  double limit;     // <= 0: none
  double smallest;  // scale: noise about zero stays small
};

void draw_strip(cv::Mat area, const History& history, const Strip& strip, double window_s) {
  const double w = area.cols, h = area.rows;
  const double letters = std::clamp(0.19 * h, 6.0, 20.0);
  const double left = 13 * letters, right = w - 1, top = 0.14 * h, bottom = h - 0.06 * h;
  const std::size_t n = history.size();
  const double end_s = n > 0 ? history[n - 1].time_s : 0;
  std::size_t first = n;
  double largest = 0;
  while (first > 0 && history[first - 1].time_s > end_s - window_s)
    largest = std::max(largest, static_cast<double>(history[--first].*strip.value));
  const double scale = round_scale(std::max({largest, strip.limit, strip.smallest}));
  const auto y_of = [&](double v) { return bottom - (bottom - top) * std::clamp(v / scale, 0.0, 1.0); };

  const auto level = [&](double v, const cv::Scalar& colour) {
    cv::line(area, subpixel(left, y_of(v)), subpixel(right, y_of(v)), colour, 1, cv::LINE_AA, kShift);
  };
  level(0, ink::kAxis);
  level(0.5 * scale, ink::kGrid);
  level(scale, ink::kGrid);
  if (first < n) {
    std::vector<cv::Point> line;
    // One point every other pixel, the highest of its time: peaks stay, and drawing costs the same at any rate.
    for (std::size_t i = first; i < n;) {
      const double x = right - (right - left) * (end_s - history[i].time_s) / window_s;
      double highest = 0;
      for (const double t = history[i].time_s + 2 * window_s / (right - left); i < n && history[i].time_s < t; ++i) {
        highest = std::max(highest, static_cast<double>(history[i].*strip.value));
      }
      line.push_back(subpixel(x, y_of(highest)));
    }
    std::vector<cv::Point> fill = line;
    fill.push_back({line.back().x, subpixel(0, bottom).y});
    fill.push_back({line.front().x, subpixel(0, bottom).y});
    cv::fillPoly(area, std::vector<std::vector<cv::Point>>{fill}, 0.16 * strip.colour + 0.84 * ink::kPaper, cv::LINE_8,
                 kShift);
    cv::polylines(area, line, false, strip.colour, h > 60 ? 2 : 1, cv::LINE_AA, kShift);
  }
  if (strip.limit > 0) level(strip.limit, ink::kLimit);
  text(area, short_number(scale), left - 0.6 * letters, top + letters, 0.8 * letters, ink::kAxis, Align::right);
  text(area, strip.name, 0.3 * letters, 0.5 * (top + bottom) - 0.1 * letters, letters, ink::kText);
  const std::string now =
      n > 0 ? short_number(history[n - 1].*strip.value) + " " + strip.unit : std::string("- ") + strip.unit;
  text(area, now, 0.3 * letters, 0.5 * (top + bottom) + 1.5 * letters, letters, strip.colour);
}

}  // namespace

double round_scale(double value) {
  if (!(value > 1e-3)) return 1e-3;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= value * (1 - 1e-9)) return step * decade;
  }
  return 10 * decade;
}

Image draw_strips(const ViewScene& scene, int width, int height, double window_s) {
  Image image(width, height);
  cv::Mat mat = as_mat(image);
  mat = ink::kPaper;
  const double x_max_m = scene.info.x_max_m;
  const std::array<Strip, 5> strips{{
      {"Force", "N", &HistorySample::force_n, ink::kForce, scene.info.stiffness_n_per_m * x_max_m, 1},
      {"Torque", "Nm", &HistorySample::torque_nm, ink::kTorque, 0, 0.01},
      {"Contacts", "", &HistorySample::contacts, ink::kContacts, 0, 10},
      {"Penetration", "mm", &HistorySample::penetration_mm, ink::kDepth, 1e3 * x_max_m, 0.01},
      {"Tick", "us", &HistorySample::tick_us, ink::kTick, 0, 100},
  }};
  const int each = height / static_cast<int>(strips.size());
  for (std::size_t i = 0; i < strips.size(); ++i) {
    draw_strip(mat(cv::Rect(0, static_cast<int>(i) * each, width, each)), scene.history, strips[i], window_s);
  }
  return image;
}

}  // namespace tact::view
