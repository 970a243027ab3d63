// SPDX-License-Identifier: MIT
#include "scene/random_objects.hpp"

#include "config/expand.hpp"
#include "scene/scene_options.hpp"

#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {
namespace {

constexpr const char* kObjects = "scene.objects";

struct DrawOptions : Options {
  std::int64_t least = 1;
  std::int64_t most = 1;
  std::vector<ObjectOptions> of;

  void list(Fields& fields) override {
    constexpr double kMost = 1000;
    fields.integer(least, Field("least", "minimum number of objects").within(0, kMost).needed());
    fields.integer(most, Field("most", "maximum number of objects").within(0, kMost).needed());
    fields.sections(of,
                    Field("of", "list of possible objects. Each object of the scene is drawn from this list").needed());
    fields.require(least <= most, "most", fmt::format("is less than 'least', which is {}", least));
    fields.require(!of.empty(), "of", "is empty, name at least one object");
  }
};

/// The map `{draw: {...}}`, which may replace a list of objects.
struct DrawBlockOptions : Options {
  DrawOptions draw;
  void list(Fields& fields) override {
    fields.section(draw, Field("draw", "random draw of the objects from the seed").needed());
  }
};

/// Replaces each range of an object by a number. Range i becomes the number at share(i) of the range, where 0 is its
/// lower end and 1 its upper end. `count` is the number of ranges before `tree`. Returns `count` plus the number of
/// ranges in `tree`.
int replace_ranges(Tree& tree, const std::string& path, const std::function<double(int)>& share, int count = 0) {
  if (const auto range = parse_continuous(tree, path)) {
    tree = number(range->at(share(count)), range->unit, tree);
    return count + 1;
  }
  for (std::size_t i = 0; i < tree.items.size(); ++i)
    count = replace_ranges(tree.items[i], fmt::format("{}.{}", path, i), share, count);
  for (Tree::Entry& entry : tree.entries) count = replace_ranges(entry.value, path + "." + entry.key, share, count);
  return count;
}

/// Reads `described`, the value of scene.objects, into `options`, after replace_ranges() has replaced each range.
/// Returns the largest number of ranges in one object.
int read_drawn(DrawBlockOptions& options, Tree described, const std::function<double(int)>& share,
               const PluginSource& plugins) {
  int most = 0;
  if (Tree* of = const_cast<Tree*>(described.find_path("draw.of"))) {
    for (std::size_t i = 0; i < of->items.size(); ++i)
      most = std::max(most, replace_ranges(of->items[i], fmt::format("{}.draw.of.{}", kObjects, i), share));
  }
  Tree scene = Tree::map();
  scene.place = described.place;
  scene.at("objects") = std::move(described);
  fill(scene, plugins, "scene", [&](Fields& fields) { fields.section(options, Field("objects", "")); });
  return most;
}

}  // namespace

bool draws_objects(const Tree& config) {
  const Tree* objects = config.find_path(kObjects);
  // A map with `type` is a single object without the brackets of a list, not a draw. resolve() reports it as an error.
  return objects != nullptr && objects->is_map() && objects->find_path("type") == nullptr;
}

void draw_objects(Tree& config, std::uint64_t seed, const PluginSource& plugins) {
  Tree& slot = config.at_path(kObjects, config.place);
  DrawBlockOptions options;
  const auto at_ends = [&](double end, int other) {
    return read_drawn(
        options, slot, [=](int range) { return range == other ? 1.0 - end : end; }, plugins);
  };
  constexpr int kNone = -1;
  const int ranges = at_ends(0.0, kNone);
  if (ranges > 0) at_ends(1.0, kNone);
  for (int other = 0; ranges > 1 && other < ranges; ++other) {
    at_ends(0.0, other);
    at_ends(1.0, other);
  }

  const Tree& of = *slot.find_path("draw.of");
  Tree drawn = Tree::list();
  drawn.place = slot.place;
  drawn.layer = slot.layer;
  const auto more = static_cast<std::uint64_t>(options.draw.most - options.draw.least);
  const std::uint64_t count =
      static_cast<std::uint64_t>(options.draw.least) + Random(seed, "scene/objects").index(more + 1);
  for (std::uint64_t i = 0; i < count; ++i) {
    Random random(seed, "scene/objects", i + 1);
    const std::size_t which = random.index(of.items.size());
    drawn.items.push_back(of.items[which]);
    replace_ranges(drawn.items.back(), fmt::format("{}.draw.of.{}", kObjects, which),
                   [&](int) { return random.uniform(); });
  }
  slot = std::move(drawn);
}

}  // namespace palpate
