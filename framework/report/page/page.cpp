// SPDX-License-Identifier: MIT
#include "report/page/page.hpp"

#include "config/display_units.hpp"
#include "record/fields.hpp"
#include "report/colours.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <zlib.h>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

// Assets of all pages: plotly.js from the vendor folder, compressed by gzip, the style, and the common script.
extern "C" const char palpate_asset_plotly[], palpate_asset_plotly_end[];
extern "C" const char palpate_asset_style[], palpate_asset_common[];

namespace palpate {
namespace {

/// Returns a script element that contains `bytes` in base64. Browsers do not execute scripts of this type; a script of
/// the page unpacks the bytes, which are compressed in `format`.
std::string packed(const char* name, const char* format, std::string_view bytes) {
  return fmt::format("<script type=\"application/{}\" id=\"{}\">{}</script>\n", format, name, base64(bytes));
}

/// Returns the colours of colours.hpp as JSON for the scripts.
Json json_of_colours() {
  const auto stops = [](Palette palette) {
    const std::vector<std::string>& all = palette_stops(palette);
    Json out;
    for (std::size_t i = 0; i < all.size(); ++i)
      out.push_back({static_cast<double>(i) / static_cast<double>(all.size() - 1), all[i]});
    return out;
  };
  return {{"viridis", stops(Palette::viridis)},
          {"cividis", stops(Palette::cividis)},
          {"lines", {{"light", kLineColours}, {"dark", kLineColoursOnDark}}}};
}

}  // namespace

Json display_units(const std::vector<std::string>& columns) {
  Json out = Json::object();
  for (const std::string& name : columns) {
    const DisplayScale scale =
        boost::ends_with(name, "_bytes") ? DisplayScale{"MB", 1e6} : usual_scale(unit_of_column(name));
    if (!scale.unit.empty()) out[name] = {{"unit", scale.unit}, {"factor", 1.0 / scale.factor}};
  }
  return out;
}

std::string deflated(std::string_view bytes) {
  uLongf size = ::compressBound(bytes.size());
  std::string out(size, '\0');
  if (::compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 bytes.size()) != Z_OK)
    throw Error("report", "no memory to compress it", {}, Error::Kind::run);
  out.resize(size);
  return out;
}

std::string base64(std::string_view bytes) {
  using namespace boost::archive::iterators;
  using Digits = base64_from_binary<transform_width<std::string_view::const_iterator, 6, 8>>;
  std::string out(Digits(bytes.begin()), Digits(bytes.end()));
  while (out.size() % 4 != 0) out += '=';
  return out;
}

std::string line_of(const Json& data) { return data.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string make_page(std::string_view script, const Json& data, const std::string& maps, PageOrigin of) {
  // plotly needs unsafe-eval to draw with WebGL.
  constexpr const char* kPolicy =
      "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:";
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "http-equiv=\"Content-Security-Policy\" content=\"{}{}\">\n{}<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>palpate</title>\n<style>\n{}</style>\n</head>\n<body>\n<noscript>This "
      "page needs JavaScript, which your browser does not run.</noscript>\n",
      kPolicy, of == PageOrigin::server ? "; connect-src 'self'" : "",
      // With an empty icon, browsers do not request an icon from the server.
      of == PageOrigin::server ? "<link rel=\"icon\" href=\"data:,\">\n" : "", palpate_asset_style);
  static const std::string plotly =
      packed("plotly", "gzip",
             {palpate_asset_plotly, static_cast<std::size_t>(palpate_asset_plotly_end - palpate_asset_plotly)});
  out += plotly;
  out += packed("data", "deflate", deflated(line_of(data)));
  out += packed("maps", "deflate", deflated(maps));
  out += fmt::format("<script>\n\"use strict\";\nconst kColours = {};\n{}{}</script>\n</body>\n</html>\n",
                     json_of_colours().dump(), palpate_asset_common, script);
  return out;
}

}  // namespace palpate
