// The HTML page of a report.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace pileus::study {

/// A heading and the SVG documents below it.
struct PageSection {
  std::string heading;
  std::vector<std::string> svgs;
};

/// Text with the characters that HTML reserves replaced.
std::string escape_html(const std::string& text);

/// One self-contained page: the summary's tables (null: none yet) and the pictures inline.
std::string report_page(const nlohmann::json& summary, const std::vector<PageSection>& sections);

}  // namespace pileus::study
