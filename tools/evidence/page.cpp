#include "evidence/page.hpp"

#include <algorithm>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <fstream>
#include <iterator>
#include <thread>

#include "fault/fault.hpp"
#include "file/whole_file.hpp"

namespace tact::evidence {
namespace {

using bench::Report;

constexpr const char* kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { margin-bottom: 0 } h2 { margin-top: 3rem; border-top: 1px solid #ccc; padding-top: 1rem }
table { border-collapse: collapse; margin: .8rem 0; font-size: 13px } th, td { padding: .2rem .6rem; text-align: right }
th:first-child, td:first-child { text-align: left } th { border-bottom: 1px solid #888; vertical-align: bottom }
tr:nth-child(even) td { background: #f5f5f5 } .scroll { overflow-x: auto }
.words td, .words th { text-align: left; vertical-align: top }
.claim { border-left: 5px solid #888; background: #f8f8f4; padding: .5rem 1rem; margin: 1rem 0 }
.claim.yes { border-color: #2a8a3a } .claim.partly { border-color: #d09000 } .claim.no { border-color: #c03020 }
.claim dt { font-size: 12px; color: #666 } .claim dd { margin: 0 0 .4rem 0 }
figure { margin: 1rem 0 } figcaption, .small { font-size: 12px; color: #666 } img { max-width: 100% }
code { background: #f0f0f0; padding: .1rem .3rem } a { color: #2060c0 }
)";

std::string slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw SetupError(file.string() + ": cannot read the picture that was drawn here");
  return {std::istreambuf_iterator<char>(in), {}};
}

const char* css_class(bench::Holds holds) {
  return holds == bench::Holds::yes ? "yes" : holds == bench::Holds::partly ? "partly" : "no";
}

/// Words rather than numbers: wide cells are read from the left.
bool is_of_words(const Report::Table& table) {
  for (const Report::Row& row : table.rows) {
    for (std::size_t c = 1; c < row.size(); ++c) {
      if (row[c].size() > 40) return true;
    }
  }
  return false;
}

std::string html(const Report::Table& table, const std::string& csv) {
  std::string out = "<div class=scroll><table" + std::string(is_of_words(table) ? " class=words" : "") + "><tr>";
  for (const std::string& column : table.columns) out += "<th>" + escaped(column) + "</th>";
  out += "</tr>\n";
  for (const Report::Row& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row) out += "<td>" + escaped(cell) + "</td>";
    out += "</tr>\n";
  }
  return out + "</table></div>\n<p class=small>" + escaped(csv) +
         (table.times ? ", times: another machine gives others" : "") + "</p>\n";
}

std::string html(const Report::Claim& claim) {
  return std::string("<dl class=\"claim ") + css_class(claim.holds) + "\"><dt>[P] says</dt><dd>" +
         escaped(claim.theirs) + "</dd><dt>Here</dt><dd>" + escaped(claim.ours) + "</dd><dt>" + name(claim.holds) +
         "</dt><dd>" + escaped(claim.sentence) + "</dd></dl>\n";
}

std::string html(const Report::Picture& picture) {
  const bool svg = picture.file.extension() == ".svg";
  return "<figure><img alt=\"" + escaped(picture.caption) + "\" src=\"data:image/" + (svg ? "svg+xml" : "jpeg") +
         ";base64," + base64(slurp(picture.file)) + "\"><figcaption>" + escaped(picture.caption) +
         "</figcaption></figure>\n";
}

std::string html(const Report::Bar& bar) {
  return "<p><b>" + std::string(bar.met ? "met" : "missed") + "</b> " + escaped(bar.what) + ": " +
         bench::number(bar.measured) + " " + escaped(bar.unit) + " (at " + (bar.at_least ? "least " : "most ") +
         bench::number(bar.required) + ")</p>\n";
}

std::string csv(const Report::Table& table) {
  std::string out;
  const auto line = [&out](const Report::Row& row) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) out += ',';
      out += csv_field(row[c]);
    }
    out += "\r\n";
  };
  line(table.columns);
  for (const Report::Row& row : table.rows) line(row);
  return out;
}

std::string section_html(const Report::Section& section, const Making& making, const std::filesystem::path& data) {
  const auto all = experiments();
  const auto known = std::find_if(all.begin(), all.end(), [&](const Experiment& e) { return section.name == e.name; });
  std::string out = "<h2 id=\"" + escaped(section.name) + "\">" +
                    escaped(known != all.end() ? known->title : section.name) + "</h2>\n";
  if (known != all.end()) out += "<p>" + escaped(known->tested) + "</p>\n";
  for (const auto& claim : section.all<Report::Claim>()) out += html(claim);
  out += "<p><code>tact report " + escaped(section.name) + (making.quick ? " --quick" : "") + " --out DIR</code> " +
         "<span class=small>" + bench::number(section.seconds) + " s</span></p>\n";
  std::size_t tables = 0;
  for (const Report::Item& item : section.items) {
    if (const auto* sentence = std::get_if<std::string>(&item)) {
      out += "<p>" + escaped(*sentence) + "</p>\n";
    } else if (const auto* table = std::get_if<Report::Table>(&item)) {
      const auto file = data / (section.name + "-" + std::to_string(++tables) + ".csv");
      write_whole(file, csv(*table));
      out += html(*table, "data/" + file.filename().string());
    } else if (const auto* bar = std::get_if<Report::Bar>(&item)) {
      out += html(*bar);
    } else if (const auto* picture = std::get_if<Report::Picture>(&item)) {
      out += html(*picture);
    }
  }
  return out;
}

std::string overview(const Report& report) {
  std::string out = "<table class=words><tr><th>experiment</th><th>[P] says</th><th>here</th><th></th></tr>\n";
  for (const auto& section : report.sections()) {
    const auto link = "<a href=\"#" + escaped(section.name) + "\">" + escaped(section.name) + "</a>";
    const auto claims = section.all<Report::Claim>();
    if (claims.empty()) out += "<tr><td>" + link + "</td><td></td><td></td><td></td></tr>\n";
    for (const auto& claim : claims) {
      out += "<tr><td>" + link + "</td><td>" + escaped(claim.theirs) + "</td><td>" + escaped(claim.ours) + "</td><td>" +
             name(claim.holds) + "</td></tr>\n";
    }
  }
  return out + "</table>\n";
}

}  // namespace

std::string escaped(const std::string& words) {
  std::string out;
  for (const char c : words) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(const std::string& bytes) {
  using namespace boost::archive::iterators;
  using Encoded = base64_from_binary<transform_width<std::string::const_iterator, 6, 8>>;
  std::string out(Encoded(bytes.begin()), Encoded(bytes.end()));
  return out.append((3 - bytes.size() % 3) % 3, '=');
}

std::string csv_field(const std::string& words) {
  if (words.find_first_of(",\"\r\n") == std::string::npos) return words;
  std::string out = "\"";
  for (const char c : words) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

void write_page(const Report& report, const Making& making, const std::filesystem::path& dir) {
  const auto data = dir / "data";
  std::error_code failed;
  std::filesystem::create_directories(data, failed);
  if (failed) throw SetupError(data.string() + ": cannot make this folder: " + failed.message());
  std::string out = "<!doctype html>\n<html lang=en><meta charset=utf-8><title>Tact: the evidence</title><style>";
  out += kStyle;
  out +=
      "</style>\n<h1>Tact: the evidence</h1>\n<p>Each figure of the paper behind Tact, [P], repeated; and what we "
      "wanted "
      "to know beyond it. [P]: an adaptive stiffness for 6-DoF haptic rendering of distributed contact from the Gauss "
      "map of its normals. Every number below comes out of the command beside it.</p>\n<p class=small>Version " +
      escaped(making.version) + ", " + escaped(bench::processor()) + ", " +
      std::to_string(std::thread::hardware_concurrency()) + " cores" +
      (making.quick ? ". Quick form: coarser, fewer cases" : "") + ". <code>" + escaped(making.command) +
      "</code>. Tables hold the same on every machine, but for those of times.</p>\n";
  out += overview(report);
  for (const auto& section : report.sections()) out += section_html(section, making, data);
  write_whole(dir / "index.html", out);
}

}  // namespace tact::evidence
