// SPDX-License-Identifier: MIT
// The part `scene.effects:` of a config.
#pragma once

#include <palpate/effects.hpp>
#include <palpate/options.hpp>

#include <optional>

namespace palpate {

/// The options of one effect: the effect itself, and its list of fields.
template <class Effect>
struct EffectGroup : Options {
  Effect value;
  void list(Fields& fields) override;
};

/// One group for each member of Effects, absent by default.
struct EffectOptions : Options {
  std::optional<EffectGroup<ForceNoise>> force_noise;
  std::optional<EffectGroup<ForceDrift>> force_drift;
  std::optional<EffectGroup<Stiffness>> stiffness;
  std::optional<EffectGroup<JointLag>> joint_lag;
  std::optional<EffectGroup<TipRadius>> tip_radius;
  std::optional<EffectGroup<PoseNoise>> pose_noise;
  std::optional<EffectGroup<MissedContacts>> missed_contacts;
  std::optional<EffectGroup<FalseContacts>> false_contacts;
  std::optional<EffectGroup<Reach>> reach;
  std::optional<EffectGroup<Shaft>> shaft;
  void list(Fields& fields) override;

  /// The effects alone, as simulators see them.
  Effects values() const;

 private:
  /// Calls visit(its group, the member of Effects, its field) for each effect.
  template <class Self, class Visit>
  static void each(Self& self, const Visit& visit);
};

}  // namespace palpate
