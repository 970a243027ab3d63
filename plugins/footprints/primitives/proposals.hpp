// SPDX-License-Identifier: MIT
// The moves of the Markov chain over outlines: what an outline is changed into, and how often that is to be taken
// (between outlines of unlike numbers of pieces: Green 1995; splitting and merging: Richardson and Green 1997).
#pragma once

#include "depths.hpp"
#include "outline.hpp"
#include "push.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::footprints {

/// An outline, and where it was before.
struct State {
  Outline outline;
  Push push;
};

/// A change, and what Metropolis and Hastings multiply the ratio of the likelihoods by: its prior density times the
/// density of proposing the way back, over those of what it was and of the way there. 0 where there is no way.
struct Proposal : State {
  /// What it does. Each of change_form, replace and push is the way back of its own kind; the others are in pairs.
  enum class Kind { change_form, replace, add, remove, make_hole, fill_hole, split, merge, push };
  Kind kind = Kind::change_form;
  double correction = 0.0;

  /// Which piece each one was before; kNew: none.
  static constexpr int kNew = -1;
  std::array<int, Outline::kMost> was;
  /// Touches from `since` on, and before `until`, are seen otherwise, or by another model of labels: of these, what any
  /// piece holds may have changed.
  int since = 0, until = 0;
  // What proposing works with, kept so that it need not be made for each.
  std::vector<LabelModel::Step> held;
  std::vector<Target> near;

  /// It is this state, so far, and there is no way.
  void begin(const State& from) {
    static_cast<State&>(*this) = from;
    correction = 0.0;
    since = until = 0;
    for (int i = 0; i < outline.size(); ++i) was[static_cast<std::size_t>(i)] = i;
  }
  /// It is this state again, from which it began, or that has become what it was.
  void begin_again(const State& from) {
    if (kind == Kind::push) return begin(from);
    for (int i = 0; i < from.outline.size(); ++i) {
      if (i < outline.size() && was[static_cast<std::size_t>(i)] == i) continue;
      outline[i] = from.outline[i];
      was[static_cast<std::size_t>(i)] = i;
    }
    outline.resize(from.outline.size());
    correction = 0.0;
    since = until = 0;
  }
  /// Another state becomes this one, which began as that.
  void take(State& to) const {
    if (kind == Kind::push) {
      to = *this;
      return;
    }
    to.outline.resize(outline.size());
    for (int i = 0; i < outline.size(); ++i) {
      if (was[static_cast<std::size_t>(i)] != i) to.outline[i] = outline[i];
    }
  }
  void changes(int piece) { was[static_cast<std::size_t>(piece)] = kNew; }
  void add(const Piece& piece) {
    changes(outline.size());
    outline.add(piece);
  }
  void remove(int piece) {
    was[static_cast<std::size_t>(piece)] = was[static_cast<std::size_t>(outline.size() - 1)];
    outline.remove(piece);
  }
};

/// Shifts, turns or stretches a form, moves one of its sides, changes its family; adds a piece or takes one away, makes
/// a hole or fills it, splits a piece or merges two, or draws one anew. A piece is added where the prior would have it
/// or, one time in two, about a touch of an object that no piece holds, a hole about one of the desk that the piece
/// holds: there they may set a label right. Pieces near the latest touch are moved more often, as they know least of
/// it. `out` has just begun, from a state by whose push the touches are `seen`. `which`: what it does, drawn evenly
/// from [0, 1), where the caller has drawn anyway.
void propose(Proposal& out, const OutlinePrior& prior, const Seen& seen, double which, Random& random);

/// Two of the moves of propose(): a piece is split into two, or two that are near each other are merged.
void propose_split(Proposal& out, const OutlinePrior& prior, Random& random);
void propose_merge(Proposal& out, const OutlinePrior& prior, Random& random);

/// Adds a push or takes it away, or changes it. Either the outline stays where it is now, or where it was before: then
/// what was touched before agrees with it as well as it did. `rate`: the prior probability of a push between two of
/// the `touches`, at least 2.
void propose_push(Proposal& out, const OutlinePrior& prior, int touches, double rate, Random& random);

}  // namespace palpate::footprints
