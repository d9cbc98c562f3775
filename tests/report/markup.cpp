// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/markup.h"

#include <set>
#include <vector>

namespace dendrofit::test {

std::string unclosed_tag(const std::string& html) {
  static const std::set<std::string> kVoid = {"meta", "link", "img", "br", "input", "!DOCTYPE"};
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at)) {
    // The end of the tag, passing over quoted attributes.
    std::size_t end = at + 1;
    bool quoted = false;
    while (end < html.size() && (quoted || html[end] != '>')) {
      if (html[end] == '"') quoted = !quoted;
      if (!quoted && html[end] == '<') return html.substr(at, 60);
      ++end;
    }
    if (end >= html.size()) return html.substr(at, 60);
    const bool closing = html[at + 1] == '/';
    const std::size_t name_at = at + (closing ? 2 : 1);
    const std::string name = html.substr(name_at, html.find_first_of(" />\n", name_at) - name_at);
    if (closing) {
      if (open.empty() || open.back() != name) return html.substr(at, 60);
      open.pop_back();
    } else if (html[end - 1] != '/' && !kVoid.count(name)) {
      open.push_back(name);
    }
    at = end + 1;
    if (!closing && (name == "script" || name == "style")) at = html.find("</" + name, at);
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

}  // namespace dendrofit::test
