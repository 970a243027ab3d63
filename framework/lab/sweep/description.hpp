// SPDX-License-Identifier: MIT
// What a sweep varies, as the config's `sweep:` and the words behind `palpate sweep` describe it: which keys take which
// values together. Nothing is known here of what the keys mean.
#pragma once

#include "config/compose.hpp"
#include "config/expand.hpp"
#include "sweep/condition.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// `palpate sweep CONFIG` is followed by words of three kinds.
struct SweepWords {
  std::vector<Axis> axes;                            ///< KEY=VALUES
  std::vector<std::pair<std::string, Tree>> blocks;  ///< sweep.BLOCK=...
  std::vector<Override> expectations;                ///< expect...=...: they hold for the whole sweep and are no axes
};

/// Throws Error.
SweepWords parse_sweep_words(const std::vector<std::string>& words);

/// What one combination says of one key: a value of an axis.
struct SweptValue {
  const Axis* axis;   ///< lives as long as its description
  std::size_t digit;  ///< which of its values

  const Tree& value() const { return axis->values[digit]; }
};

/// In the order in which they are laid over the config, each key once.
using Combination = std::vector<SweptValue>;

/// The blocks of a sweep. They multiply with each other in the order in which they are written, the last running
/// fastest:
///
///     grid:  {a: [1, 2], b: [x, y]}               every value with every other, the last key fastest: 4 combinations
///     zip:   {a: [1, 2], b: [x, y]}               side by side: 2 combinations
///     list:  [{a: 1}, {a: 2, b: [x, y]}]          one after the other, each item a little grid: 3 combinations
///     sobol: {samples: 64, keys: {a: "uniform(1 cm, 2 cm)"}}    points of continuous ranges: see sobol_axes()
///     where: a > 1 and not b == x                 of all these, those for which this, or each of a list, holds
///
/// Values are lists, `range` and `log`: see expand_values(). A key stands in one block only.
class SweepDescription {
 public:
  /// `config` is the config's `sweep:`, or null. A block among the words takes the place of the config's block; a key
  /// among them leaves zip, sobol and list and goes to the grid, where it takes the place of that key. Throws Error for
  /// what is not understood, and for more than a million combinations.
  SweepDescription(const Tree* config, const SweepWords& words);
  SweepDescription(const SweepDescription&) = delete;  // combinations point at its axes
  SweepDescription& operator=(const SweepDescription&) = delete;

  /// All swept keys, in the order in which they are laid over a config.
  const std::vector<std::string>& keys() const { return keys_; }
  /// All of them, whatever `where` says. They live as long as the description.
  const std::vector<Combination>& combinations() const { return combinations_; }

  /// Whether `where` keeps a combination. `base` tells what the config says of names that the combination does not.
  /// Throws Error for a name that nobody knows, or that depends on a swept choice: kernel.alpha where kernel is swept.
  bool wanted(const Combination& combination, const Condition::Values& base) const;
  /// The place of the first `where`, or "".
  std::string where_place() const;

  /// What `palpate sweep` would read as the same description.
  const Tree& written() const { return written_; }

 private:
  /// Axes side by side, or multiplied with each other.
  struct Part {
    std::vector<Axis> axes;
    bool together = false;
  };
  /// Parts one after the other.
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
  std::vector<Condition> where_;
  std::vector<std::string> keys_;
  std::vector<Combination> combinations_;
};

/// What a combination lays over the config. A group or a type is laid on a higher layer than all options, so that
/// options that it does not have are left out rather than refused.
std::vector<Override> overrides_of(const Combination& combination);

/// A value as a condition sees it: a group is its type.
std::string condition_text(const Tree& value);

/// Whether `key` chooses a plugin or a type, and with it which options there are.
bool is_choice(const std::string& key);

}  // namespace palpate
