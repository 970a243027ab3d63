// SPDX-License-Identifier: MIT
#include "report/page/page.hpp"

#include "report/page/assets.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <zlib.h>

namespace palpate {
namespace {

/// Bytes that a script of the page unpacks: no browser takes this type for a script of its own.
std::string packed(const char* name, std::string_view gzipped) {
  return fmt::format("<script type=\"application/gzip\" id=\"{}\">{}</script>\n", name, base64(gzipped));
}

}  // namespace

std::string gzip(std::string_view bytes) {
  constexpr int kWithGzipHeader = 15 + 16;
  constexpr int kMemory = 9;
  z_stream stream{};
  if (::deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kWithGzipHeader, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error("report", "no memory to compress it", {}, Error::Kind::run);
  std::string out(::deflateBound(&stream, bytes.size()), '\0');
  // zlib does not write to its input, whatever the type says.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int ended = ::deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  ::deflateEnd(&stream);
  if (ended != Z_STREAM_END) throw Error("report", "its data could not be compressed", {}, Error::Kind::run);
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < here ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= here ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

std::string make_page(std::string_view script, const std::string& json, const std::string& maps) {
  // plotly makes functions from texts of its own where it draws with WebGL: unsafe-eval.
  constexpr const char* kPolicy =
      "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:";
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>palpate</title>\n<style>\n{}</style>\n</head>\n"
      "<body>\n<noscript>This page draws itself by a script, which your browser does not run.</noscript>\n",
      kPolicy, style_asset());
  out += packed("plotly", plotly_asset());
  out += packed("data", gzip(json));
  out += packed("maps", gzip(maps));
  out += fmt::format("<script>\n\"use strict\";\n{}{}</script>\n</body>\n</html>\n", common_script(), script);
  return out;
}

}  // namespace palpate
