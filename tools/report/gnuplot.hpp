#pragma once
#include <cstdio>
#include <filesystem>
#include <string>

namespace tact::report {

/// gnuplot, told line by line what to draw into a picture: SVG where the name ends so, otherwise PNG.
class Gnuplot {
 public:
  /// Throws SetupError when the file cannot be written or gnuplot not be started.
  Gnuplot(const std::filesystem::path& file, int width, int height);
  ~Gnuplot();
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  FILE* in() const { return pipe_; }
  /// Waits for the picture. Throws SetupError when gnuplot failed.
  void finish();

  /// Titles and file names are users' words: gnuplot reads them inside single quotes, where only ' is special.
  static std::string quoted(const std::string& words);

 private:
  std::filesystem::path file_;
  FILE* pipe_;
};

}  // namespace tact::report
