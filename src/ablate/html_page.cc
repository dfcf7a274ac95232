// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/html_page.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "ablate/tables.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

constexpr int kPreviewWidth = 480;

const char* const kHead =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<title>facet ablation</title>\n<style>\n"
    "body { font-family: sans-serif; margin: 2em; max-width: 1250px; }\n"
    "table { border-collapse: collapse; margin: 1em 0; font-size: 14px; }\n"
    "th, td { border-bottom: 1px solid #ccc; padding: 4px 10px; "
    "text-align: right; }\n"
    "th:first-child, td:first-child { text-align: left; }\n"
    "code { background: #f2f2f2; }\n"
    ".row { display: flex; flex-wrap: wrap; gap: 10px; }\n"
    "figure { margin: 0; }\nfigcaption { font-size: 13px; max-width: 480px; }\n"
    "</style>\n</head>\n<body>\n<h1>Ablation</h1>\n";

std::string Element(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + EscapeXml(text) + "</" + tag + ">";
}

std::string TableHtml(const AblationPlan& plan,
                      const GroupTable& table,
                      bool differences) {
  std::string html = "<table>\n<tr>";
  html += Element("th",
                  differences
                      ? "difference against '" + plan.variants[0].label + "'"
                      : "variant");
  if (!differences) html += Element("th", "runs");
  for (const size_t f : table.figures) {
    html += Element("th", Figures()[f].title);
  }
  html += "</tr>\n";
  for (size_t v = differences ? 1 : 0; v < plan.variants.size(); ++v) {
    html += "<tr>" + Element("td", plan.variants[v].label);
    if (!differences) {
      html += Element("td", std::to_string(table.finished[v]));
    }
    for (const TableCell& cell : table.cells[v]) {
      html += Element("td",
                      differences ? DifferenceText(cell.difference)
                                  : CellText(cell, table.finished[v]));
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

// A smaller copy as a data URI; empty if the file is no picture.
std::string PictureUri(const std::string& path) {
  const cv::Mat picture = cv::imread(path, cv::IMREAD_COLOR);
  if (picture.empty()) return "";
  const double scale = std::min(1.0, kPreviewWidth / double(picture.cols));
  cv::Mat small;
  cv::resize(picture, small, cv::Size(), scale, scale, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, 88});
  return "data:image/jpeg;base64," + Base64(bytes);
}

std::string FigureHtml(const std::string& path, const std::string& caption) {
  const std::string uri = PictureUri(path);
  if (uri.empty()) return "";
  return "<figure><img alt=\"" + EscapeXml(caption) + "\" src=\"" + uri +
         "\">" + Element("figcaption", caption) + "</figure>\n";
}

// "above" for "after_above.png", sorted.
std::set<std::string> ViewsOf(const std::string& run_folder) {
  std::set<std::string> views;
  const fs::path folder = fs::path(run_folder) / "previews";
  if (!fs::is_directory(folder)) return views;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().stem().string();
    if (name.compare(0, 6, "after_") == 0) views.insert(name.substr(6));
  }
  return views;
}

std::string PreviewsHtml(const AblationPlan& plan,
                         const std::vector<RunResult>& runs,
                         const std::string& group) {
  std::vector<const RunResult*> shown;
  for (const RunResult& run : runs) {
    if (!run.problem.empty() || plan.scans[run.scan].spec.group != group ||
        (!shown.empty() && shown[0]->scan != run.scan) ||
        ViewsOf(run.folder).empty()) {
      continue;
    }
    shown.push_back(&run);
  }
  if (shown.empty()) return "";
  std::string html =
      Element("h3", "Previews of " + plan.scans[shown[0]->scan].spec.name) +
      "\n";
  for (const std::string& view : ViewsOf(shown[0]->folder)) {
    html += "<div class=\"row\">\n" +
            FigureHtml(shown[0]->folder + "/previews/before_" + view + ".png",
                       "before");
    for (const RunResult* run : shown) {
      html += FigureHtml(run->folder + "/previews/after_" + view + ".png",
                         plan.variants[run->variant].label);
    }
    html += "</div>\n";
  }
  return html;
}

}  // namespace

std::string Base64(const std::vector<unsigned char>& bytes) {
  static const char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    unsigned word = 0;
    for (size_t k = 0; k < 3; ++k) {
      word = word << 8 | (k < count ? bytes[i + k] : 0u);
    }
    for (size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

std::string HtmlPage(const AblationPlan& plan,
                     const std::vector<RunResult>& runs,
                     const std::vector<NamedPlot>& plots) {
  std::string html = kHead;
  html += "<p>" + Element("code", "--vary=" + ToString(plan.axes)) + "</p>\n" +
          Element("p", TableLegend()) + "\n";
  for (const RunResult& run : runs) {
    if (run.problem.empty()) continue;
    html += Element("p",
                    "Failed: " + plan.scans[run.scan].spec.name + ", " +
                        plan.variants[run.variant].label + ": " + run.problem) +
            "\n";
  }
  for (const GroupTable& table : MakeTables(plan, runs)) {
    html += Element("h2",
                    table.group + " (" + std::to_string(table.scans) +
                        (table.scans == 1 ? " scan)" : " scans)")) +
            "\n" + TableHtml(plan, table, false);
    if (plan.variants.size() > 1) html += TableHtml(plan, table, true);
    html += "<div class=\"row\">\n";
    for (const NamedPlot& plot : plots) {
      if (plot.group == table.group) html += DrawSvg(plot.plot);
    }
    html += "</div>\n" + PreviewsHtml(plan, runs, table.group);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace facet
