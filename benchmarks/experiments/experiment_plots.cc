#include "benchmarks/experiments/experiment_plots.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "adapters/files/input_error.h"
#include "benchmarks/experiments/condition_comparison.h"

namespace prospect {
namespace {

const char* const kHead =
    "set encoding utf8\n"
    "set termoption noenhanced\n"
    "set border 3 lc rgb '#888888'\n"
    "set tics nomirror textcolor rgb '#333333'\n"
    "set grid lc rgb '#dddddd' lt 1\n"
    "set linetype 1 lc rgb '#2563eb' pt 7\n"
    "set linetype 2 lc rgb '#ea580c' pt 5\n"
    "set linetype 3 lc rgb '#0d9488' pt 9\n"
    "set linetype 4 lc rgb '#c026d3' pt 11\n"
    "set linetype 5 lc rgb '#ca8a04' pt 13\n"
    "set linetype 6 lc rgb '#dc2626' pt 6\n"
    "set linetype 7 lc rgb '#65a30d' pt 4\n"
    "set linetype 8 lc rgb '#57534e' pt 8\n"
    "set linetype cycle 8\n";

/// In gnuplot's single quotes, where only those are special.
std::string in_quotes(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '\'' ? std::string("''") : std::string(1, c);
  return "'" + safe + "'";
}

/// The label of a tic, which is a format.
std::string tic(const std::string& text) {
  std::string format;
  for (const char c : text) format += c == '%' ? std::string("%%") : std::string(1, c);
  return in_quotes(format);
}

std::string label(const ConditionComparison& c) {
  return c.condition->name + " / " + c.condition->reference +
         (c.sensors == "camera" ? ", cameras, " : ", ") + std::to_string(c.pairs.size()) + " pairs";
}

/// A row for each number, a colour for each comparison.
std::string ratio_script(const std::vector<ConditionComparison>& all) {
  const auto has_ratio = [&](std::size_t k) {
    return std::any_of(all.begin(), all.end(), [k](const ConditionComparison& c) {
      return c.numbers[k].ratio > 0.0 && std::isfinite(c.numbers[k].ratio);
    });
  };
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < shown_numbers().size(); ++k) {
    if (has_ratio(k)) numbers.push_back(k);
  }
  const std::size_t height = 130 + numbers.size() * (14 + 12 * all.size()) + 18 * all.size();
  std::ostringstream s;
  s << "set terminal svg size 900," << height << " dynamic background 'white'\n" << kHead;
  for (std::size_t i = 0; i < all.size(); ++i) {
    s << "$c" << i << " << EOD\n";
    for (std::size_t row = 0; row < numbers.size(); ++row) {
      const NumberComparison& n = all[i].numbers[numbers[row]];
      if (!(n.ratio > 0.0) || !std::isfinite(n.ratio)) continue;
      const double y =
          static_cast<double>(row) +
          0.7 * ((static_cast<double>(i) + 0.5) / static_cast<double>(all.size()) - 0.5);
      // An interval down to nothing has no place on a logarithmic axis.
      s << n.ratio << ' ' << y << ' ' << std::max(n.ratio_interval.low, 1e-3) << ' '
        << n.ratio_interval.high << '\n';
    }
    s << "EOD\n";
  }
  s << "set title 'Ratio of means with 95 % interval'\n"
       "set logscale x\nset xrange [0.25:8]\n"
       "set xtics (0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 6, 8)\n"
       "set yrange ["
    << numbers.size() << " - 0.5:-0.5]\nset ytics (";
  for (std::size_t row = 0; row < numbers.size(); ++row) {
    s << (row == 0 ? "" : ", ") << tic(shown_numbers()[numbers[row]].label) << ' ' << row;
  }
  s << ")\nset key outside below\n"
       "set arrow from 1, graph 0 to 1, graph 1 nohead lc rgb '#333333' lw 1.5 back\nplot ";
  for (std::size_t i = 0; i < all.size(); ++i) {
    s << (i == 0 ? "" : ", ") << "$c" << i << " using 1:2:3:4 with xerrorbars lt " << i + 1
      << " lw 1.8 ps 0.6 title " << in_quotes(label(all[i]));
  }
  s << '\n';
  return s.str();
}

/// Reference across, condition up; a world has the same colour in all panels.
std::string pair_script(const ConditionComparison& c) {
  struct Panel {
    const char* title;
    double ExperimentRow::*member;
    double scale;
    bool logarithmic;
  };
  const Panel panels[] = {{"position error, RMS [m]", &ExperimentRow::error_rms_m, 1.0, true},
                          {"losses of localization", &ExperimentRow::losses, 1.0, false},
                          {"time with few features [%]", &ExperimentRow::few_share, 100.0, false}};
  std::set<std::string> worlds;
  for (const auto& [reference, row] : c.pairs) worlds.insert(row->world);
  const std::string name = c.condition->name;
  std::ostringstream s;
  s << "set terminal svg size 1100," << 430 + 10 * worlds.size() << " dynamic background 'white'\n"
    << kHead << "set multiplot layout 1,3 title "
    << in_quotes(label(c) + ": " + name + " up, " + c.condition->reference +
                 " across; above the line " + name + " has more")
    << "\nset key below\nset size square\n";
  for (const Panel& panel : panels) {
    const auto point = [&](const auto& pair) {
      return Eigen::Vector2d(panel.scale * pair.first->*panel.member,
                             panel.scale * pair.second->*panel.member);
    };
    const auto shown = [&](const Eigen::Vector2d& p) {
      return p.allFinite() && (!panel.logarithmic || p.minCoeff() > 0.0);
    };
    double least = INFINITY, most = 0.0;
    for (const auto& pair : c.pairs) {
      const Eigen::Vector2d p = point(pair);
      if (!shown(p)) continue;
      least = std::min(least, p.minCoeff());
      most = std::max(most, p.maxCoeff());
    }
    if (!(least <= most)) least = most = 1.0;
    const double from = panel.logarithmic ? 0.8 * least : 0.0;
    const double to = panel.logarithmic ? 1.25 * most : std::max(1.0, 1.05 * most);
    // A world without a point here still has its place in the key.
    int block = 0;
    for (const std::string& world : worlds) {
      s << "$p" << block++ << " << EOD\nNaN NaN\n";
      for (const auto& pair : c.pairs) {
        const Eigen::Vector2d p = point(pair);
        if (pair.second->world == world && shown(p)) s << p.x() << ' ' << p.y() << '\n';
      }
      s << "EOD\n";
    }
    s << (panel.logarithmic ? "set logscale xy\n" : "unset logscale xy\n") << "set title "
      << in_quotes(panel.title) << "\nset xrange [" << from << ':' << to << "]\nset yrange ["
      << from << ':' << to << "]\nplot x with lines lc rgb '#333333' notitle";
    block = 0;
    for (const std::string& world : worlds) {
      s << ", $p" << block << " with points lt " << block + 1 << " ps 0.8 title "
        << in_quotes(std::filesystem::path(world).filename().string());
      ++block;
    }
    s << '\n';
  }
  s << "unset multiplot\n";
  return s.str();
}

void draw(const std::string& script, const std::string& path) {
  const std::string source = std::filesystem::path(path).replace_extension(".gp").string();
  std::ofstream file(source);
  file << "set output " << in_quotes(path) << '\n' << script << "set output\n";
  file.close();
  if (!file) throw InputError(source + ": could not be written");
  char* const arguments[] = {const_cast<char*>("gnuplot"), const_cast<char*>(source.c_str()),
                             nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, "gnuplot", nullptr, nullptr, arguments, environ) != 0) {
    throw InputError("gnuplot could not be started to draw " + path +
                     "; expected the Debian package gnuplot-nox");
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(source + ": gnuplot failed");
  }
}

}  // namespace

std::vector<std::string> write_experiment_plots(const std::vector<ExperimentRow>& rows,
                                                const std::string& folder) {
  const std::vector<ConditionComparison> comparisons = compare_conditions(rows);
  std::vector<std::string> pictures;
  if (comparisons.empty()) return pictures;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder + ": " + error.message() + "; expected a folder to write to");
  const auto add = [&](const std::string& name, const std::string& script) {
    pictures.push_back((std::filesystem::path(folder) / (name + ".svg")).string());
    draw(script, pictures.back());
  };
  add("ratios", ratio_script(comparisons));
  for (const ConditionComparison& c : comparisons) {
    add("pairs_" + c.sensors + "_" + c.condition->name, pair_script(c));
  }
  return pictures;
}

}  // namespace prospect
