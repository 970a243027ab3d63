// SPDX-License-Identifier: MIT
// The moves of the Markov chain over hypotheses: the change that a move proposes, and its acceptance ratio without the
// likelihood (between numbers of primitives: Green 1995).
#pragma once

#include "coverage.hpp"
#include "hypothesis.hpp"

#include <palpate/random.hpp>

namespace palpate::footprints {

/// Standard normal (Box and Muller 1958).
double normal(Random& random);

/// A change of a hypothesis.
struct Proposal {
  /// Each of change_form, replace, flip_noise and push is the reverse of its own kind; the others are pairs.
  enum class Kind { change_form, replace, add, remove, make_hole, fill_hole, flip_noise, push };
  Kind kind = Kind::change_form;
  /// Prior density times the density of proposing the reverse, after over before: the factor of Metropolis and
  /// Hastings beside the likelihood. 0 if the move is impossible.
  double ratio = 0.0;
  ShortList<int> removed;      ///< indices in the hypothesis
  ShortList<Primitive> added;  ///< the first ones take the places of the removed ones
  Push push;
  bool noisy = false;

  /// Begins with no change of a hypothesis, and ratio 0.
  void begin(const Hypothesis& from) {
    ratio = 0.0;
    removed.clear();
    added.clear();
    push = from.push;
    noisy = from.noisy;
  }
  /// Removes a primitive and returns its copy in `added`.
  Primitive& change(const Hypothesis& from, int primitive) {
    removed.add(primitive);
    return added.add(from.primitives[primitive]);
  }
  /// Makes the change in the primitives of the hypothesis, or in a list of something else about each of them.
  template <class T>
  void apply(const ShortList<T>& added_ones, ShortList<T>& to) const {
    for (int i = 0; i < added_ones.size(); ++i) {
      if (i < removed.size()) {
        to[removed[i]] = added_ones[i];
      } else {
        to.add(added_ones[i]);
      }
    }
    for (int i = added_ones.size(); i < removed.size(); ++i) to.remove(removed[i]);  // one at most
  }
};

/// Proposes a move of the primitives. `taps`: as seen after the push of the hypothesis. `which`: uniform in [0, 1),
/// chooses the kind.
///
/// A form is shifted, turned, stretched, has a side moved, or changes its family; primitives near the latest tap are
/// chosen more often. A new primitive covers a random object tap; a new hole is drawn from the prior.
void propose(Proposal& out, const Hypothesis& from, const Prior& prior, const Taps& taps, double which, Random& random);

/// Proposes that the positions are noisy if the hypothesis has exact ones, and the reverse.
void propose_noise(Proposal& out, const Hypothesis& from);

/// Adds a push, removes it, or changes it. Half of the time the primitives move along, and fit the taps before the push
/// as well as they did. `rate`: prior weight of a push between two taps, relative to none; `taps`: at least 2.
///
/// The weight omits (1 - rate)^(taps - 1), which hypotheses share up to one factor 1 - rate. The prior of a primitive
/// with an object tap omits exp(-r), r the expected number of them, and the desk taps' part of the same factor. Both
/// change with a push: no effect was seen in 1200 runs.
void propose_push(Proposal& out, const Hypothesis& from, const Prior& prior, int taps, double rate, Random& random);

}  // namespace palpate::footprints
