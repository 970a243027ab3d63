// SPDX-License-Identifier: MIT
// Description of a sweep: the keys and values in `sweep:` of a config and on the command line, and their combinations.
// This file does not check the meaning of the keys.
#pragma once

#include "config/compose.hpp"
#include "config/expand.hpp"
#include "sweep/where_condition.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// The words after `palpate sweep CONFIG`, by their kind.
struct SweepOverrides {
  std::vector<SweepAxis> axes;                       ///< KEY=VALUES
  std::vector<std::pair<std::string, Tree>> blocks;  ///< sweep.BLOCK=...
  std::vector<Override> expectations;  ///< `expect...=...`, `compare...=...`: not swept; apply to the whole sweep
};

/// Throws Error for invalid words.
SweepOverrides parse_sweep_words(const std::vector<std::string>& words);

/// The value of one key in a combination.
struct SweptValue {
  const SweepAxis* axis;  ///< belongs to the SweepDescription
  std::size_t digit;      ///< index of the value

  const Tree& value() const { return axis->values[digit]; }
};

/// The values of a combination, in the order in which they are merged into the config. Each key occurs once.
using Combination = std::vector<SweptValue>;

/// The blocks of a sweep. The combinations of the sweep are the Cartesian product of its blocks, in their order; the
/// last block varies fastest:
///
///     grid:  {a: [1, 2], b: [x, y]}               all pairs, the last key varies fastest: 4 combinations
///     zip:   {a: [1, 2], b: [x, y]}               values with the same index: 2 combinations
///     list:  [{a: 1}, {a: 2, b: [x, y]}]          one item after the other, each a small grid: 3 combinations
///     sobol: {samples: 64, keys: {a: "uniform(1 cm, 2 cm)"}}    points in continuous ranges: see sobol_axes()
///     where: a > 1 and not b == x                 drops combinations that violate the condition, or one of a list
///
/// Values are lists, `range` and `logspace`: see expand_values(). A key may occur in one block only.
class SweepDescription {
 public:
  /// `config`: the config's `sweep:`, or null. A block in `words` replaces the block of the config. A key in `words` is
  /// removed from zip, sobol and list, and set in the grid. Throws Error for an invalid description, and for more than
  /// a million combinations.
  SweepDescription(const Tree* config, const SweepOverrides& words);
  SweepDescription(const SweepDescription&) = delete;  // not copyable, because combinations point to the axes
  SweepDescription& operator=(const SweepDescription&) = delete;

  /// Returns the swept keys, in the order in which they are merged into a config.
  const std::vector<std::string>& keys() const { return keys_; }
  /// Returns all combinations, including those that `where` excludes. The combinations exist as long as this object.
  const std::vector<Combination>& combinations() const { return combinations_; }

  /// Returns whether `where` keeps a combination. `base` returns the values that the config has for names without a
  /// value in the combination. Throws Error for an unknown name, and for a name that depends on a swept choice
  /// (kernel.alpha if kernel is swept).
  bool wanted(const Combination& combination, const WhereCondition::Values& base) const;
  /// Returns the source location of the first condition; "" if there is none.
  std::string where_place() const;

  /// Returns the description as a `sweep:` block that gives the same combinations.
  const Tree& written() const { return written_; }

 private:
  /// Axes whose values are combined: values with the same index (`together`), or each value of an axis with each value
  /// of the others.
  struct Part {
    std::vector<SweepAxis> axes;
    bool together = false;
  };
  /// Parts whose combinations are listed one part after the other.
  struct Block {
    std::string name;
    std::vector<Part> parts;
  };

  static Block read_block(const std::string& name, const Tree& described, ValueCount& count);
  void list_keys();
  void combine();
  bool depends(const std::string& name, const std::string& choice) const;

  Tree written_;
  std::vector<Block> blocks_;
  std::vector<WhereCondition> where_;
  std::vector<std::string> keys_;
  std::vector<Combination> combinations_;
};

/// Returns a combination as overrides. Groups and types get a higher layer than options, so that an option that a type
/// lacks is dropped instead of rejected.
std::vector<Override> overrides_of(const Combination& combination);

/// Returns a value as text for conditions. The text of a group is its type.
std::string condition_text(const Tree& value);

/// Returns whether `key` chooses a plugin or a type, and therefore decides which options exist.
bool is_choice(const std::string& key);

}  // namespace palpate
