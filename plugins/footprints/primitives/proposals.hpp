// SPDX-License-Identifier: MIT
// Moves of the Markov chain over hypotheses: the proposed change, and its acceptance ratio without the likelihood. For
// changes of the number of primitives see Green 1995.
#pragma once

#include "coverage.hpp"
#include "hypothesis.hpp"

#include <palpate/random.hpp>

namespace palpate::footprints {

/// A proposed change of a hypothesis.
struct Proposal {
  /// Each of change_form, replace, flip_noise and push is its own reverse. The reverse of add is remove, and that of
  /// make_hole is fill_hole.
  enum class Kind { change_form, replace, add, remove, make_hole, fill_hole, flip_noise, push };
  Kind kind = Kind::change_form;
  /// Metropolis-Hastings ratio without the likelihood: (prior density after the change) * (density of the reverse
  /// proposal) / ((prior density before the change) * (density of the proposal)). 0 if the move is impossible.
  double ratio = 0.0;
  ShortList<int> removed;      ///< indices in the hypothesis
  ShortList<Primitive> added;  ///< the first elements replace the removed ones
  Push push;
  bool noisy = false;

  /// Resets the proposal: it changes nothing in `from` and has the ratio 0.
  void begin(const Hypothesis& from) {
    ratio = 0.0;
    removed.clear();
    added.clear();
    push = from.push;
    noisy = from.noisy;
  }
  /// Marks a primitive as replaced and returns its copy in `added` for changes.
  Primitive& change(const Hypothesis& from, int primitive) {
    removed.add(primitive);
    return added.add(from.primitives[primitive]);
  }
  /// Applies the change to the primitives of the hypothesis, or to a list with one element per primitive.
  template <class T>
  void apply(const ShortList<T>& added_ones, ShortList<T>& to) const {
    for (int i = 0; i < added_ones.size(); ++i) {
      if (i < removed.size()) {
        to[removed[i]] = added_ones[i];
      } else {
        to.add(added_ones[i]);
      }
    }
    for (int i = added_ones.size(); i < removed.size(); ++i) to.remove(removed[i]);  // at most one
  }
};

/// Proposes a move of the primitives. `taps` are the positions after the push of the hypothesis. `which`, uniform in
/// [0, 1), selects the kind.
///
/// A form is translated, rotated or stretched, one of its sides is moved, or its family changes; primitives near the
/// latest tap are selected more often. A new primitive covers a random object tap. A new hole is drawn from the prior.
void propose(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, double which, Random& random);

/// Proposes to switch between exact and noisy positions.
void propose_noise(Proposal& out, const Hypothesis& from);

/// Proposes to add, remove or change a push. With probability 1/2 the primitives move with the push, so that they still
/// fit the earlier taps. `rate`: prior weight of a push between two taps, relative to no push. `taps` must be at least
/// 2.
///
/// The ratio omits the factor (1 - rate)^(taps - 1) for the pairs of taps without a push. With a push, the exponent
/// would be smaller by 1, so the omission changes the ratio only by one factor 1 - rate. The ratio also omits exp(-r),
/// where r is the expected number of primitives with an object tap, and the effect of the desk taps on r. Both depend
/// on the push; no effect of their omission was measured in 1200 runs.
void propose_push(Proposal& out, const Hypothesis& from, const Prior& prior, int taps, double rate, Random& random);

}  // namespace palpate::footprints
