// SPDX-License-Identifier: MIT
// What enters the id of a run, and what a record means to later versions: options as several versions would have them.
#include "config/compose.hpp"
#include "config/describe.hpp"
#include "record/resolved_config.hpp"
#include "unit/resolve_fixtures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

/// The first version.
struct First : Options {
  double reach = 0.017;
  double deviation = 1.0;
  double tolerance = 1e-8;
  void list(Fields& fields) override {
    fields.real(reach, Field("reach", "").in(Unit::metre).above(0));
    fields.real(deviation, Field("deviation", "").at_least(0));
    fields.real(tolerance, Field("tolerance", ""));
  }
};

struct Extra : Options {
  double gain = 2.0;
  void list(Fields& fields) override { fields.real(gain, Field("gain", "").neutral(1.0)); }
};

/// Has all kinds of options more, in another order.
struct Second : First {
  enum class Mode { plain, fancy };
  Mode mode = Mode::plain;
  std::optional<double> limit;
  std::vector<PluginChoice> parts;
  Extra extra;
  std::optional<PluginChoice> kernel;
  std::string note = "";
  std::int64_t workers = 1;
  void list(Fields& fields) override {
    fields.choice(mode, Field("mode", "").neutral("plain"), {{"plain", "", {}}, {"fancy", "", {}}});
    fields.real(tolerance, Field("tolerance", ""));
    fields.real(limit, Field("limit", "").in(Unit::metre));
    fields.plugins(parts, "kernel", Field("parts", "").neutral(NoValue()));
    fields.section(extra, Field("extra", ""));
    fields.plugin(kernel, "kernel", Field("kernel", ""));
    fields.text(note, Field("note", "").neutral(""));
    fields.real(reach, Field("reach", "").in(Unit::metre).above(0));
    fields.real(deviation, Field("deviation", "").at_least(0));
    fields.integer(workers, Field("workers", "").at_least(1).not_identifying());
  }
};

/// Has lost an option, renamed one and changed defaults.
struct Third : Second {
  Third() {
    reach = 0.03;
    mode = Mode::fancy;
    limit = 0.5;
    extra.gain = 1.0;
  }
  void list(Fields& fields) override {
    fields.choice(mode, Field("mode", "").neutral("plain"), {{"plain", "", {}}, {"fancy", "", {}}});
    fields.retired(Field("tolerance", "nothing has taken its place"), 1e-8);
    fields.real(limit, Field("limit", "").in(Unit::metre));
    fields.section(extra, Field("extra", ""));
    fields.real(reach, Field("reach", "").in(Unit::metre).above(0));
    fields.real(deviation, Field("spread", "").at_least(0).was("deviation"));
  }
};

struct Read {
  std::string id_text;
  std::string yaml;
};

template <class Version>
Read read(const std::string& text, bool of_record = false) {
  Tree input = parse_yaml((of_record ? "complete: 1\n" : "") + text, "c.yaml");
  mark_complete(input);
  input.erase("complete");
  Version options;
  ResolveNotes notes;
  const Tree tree = resolve(options, input, TwoPlugins(), notes);
  return {identity_text(notes), to_yaml(tree)};
}

template <class Version>
std::string trouble_with(const std::string& text, bool of_record = true) {
  return error_of([&] { read<Version>(text, of_record); });
}

TEST(Identity, IsSortedLinesOfPathsAndValuesInSi) {
  EXPECT_EQ(read<First>("reach: 1.7 cm\ndeviation: -0.0").id_text,
            "palpate-id 1\ndeviation=0\nreach=0.017 m\ntolerance=1e-08\n");
  EXPECT_EQ(read<Second>("{reach: 17 mm, mode: fancy, limit: 1 mm, note: 'a\nb=1', workers: 7, kernel: {type: smooth}, "
                         "parts: [{type: rough, nu: 1}, {type: smooth}]}")
                .id_text,
            "palpate-id 1\ndeviation=1\nextra.gain=2\nkernel.scale=0.1 m\nkernel.type=smooth\nlimit=0.001 m\n"
            "mode=fancy\nnote=5:a b=1\nparts.#=2\nparts.0.nu=1\nparts.0.scale=0.1 m\nparts.0.type=rough\n"
            "parts.1.scale=0.1 m\nparts.1.type=smooth\nreach=0.017 m\ntolerance=1e-08\n");
}

TEST(Identity, StaysWhereOptionsAreAddedThatAreNeutralAndWhereTheyChangePlaces) {
  const std::string before = read<First>("{}").id_text;
  EXPECT_EQ(read<Second>("extra: {gain: 1}").id_text, before);
  EXPECT_NE(read<Second>("{}").id_text, before) << "the default of extra.gain is not neutral";
  EXPECT_NE(read<Second>("extra: {gain: 1}\nmode: fancy").id_text, before);
  EXPECT_NE(read<Second>("extra: {gain: 1}\nnote: x").id_text, before);
  EXPECT_EQ(read<Second>("extra: {gain: 1}\nworkers: 4").id_text, before) << "it changes no result";
}

TEST(Identity, MovesWithADefaultAndStaysForWhoeverWritesTheOldOne) {
  const std::string before = read<First>("{}").id_text;
  EXPECT_NE(read<Third>("{}").id_text, before);
  EXPECT_EQ(read<Third>("{reach: 17 mm, mode: plain, limit: none}").id_text, before);
  EXPECT_EQ(read<Third>("deviation: 2\nreach: 3 cm\ntolerance: 1e-8", true).id_text,
            read<First>("{deviation: 2, reach: 3 cm}").id_text);
}

/// An option as one version has it, and the same as a later one has retired it.
template <class Value>
void expect_retiring_moves_no_id(Value value, const Field& field, const FixedValue& last) {
  struct Before : Options {
    Value value;
    Field field;
    Before(Value had, const Field& of) : value(had), field(of) {}
    void list(Fields& fields) override { fields.real(value, field); }
  };
  struct After : Options {
    Field field;
    FixedValue last;
    After(const Field& of, const FixedValue& had) : field(of), last(had) {}
    void list(Fields& fields) override { fields.retired(field, last); }
  };
  const auto id_of = [](Options& options) {
    ResolveNotes notes;
    resolve(options, Tree::map(), TwoPlugins(), notes);
    return identity_text(notes);
  };
  Before before(value, field);
  After after(field, last);
  EXPECT_EQ(id_of(after), id_of(before));
}

TEST(Identity, StaysWhereAnOptionIsRetiredWhateverItsDefaultWas) {
  expect_retiring_moves_no_id(2.0, Field("a", "").in(Unit::metre), 2.0);
  expect_retiring_moves_no_id(0.0, Field("a", "").neutral(0.0), 0.0);
  expect_retiring_moves_no_id(1.0, Field("a", "").neutral(0.0), 1.0);
  expect_retiring_moves_no_id(1.0, Field("a", "").not_identifying(), 1.0);
  expect_retiring_moves_no_id(std::optional<double>(), Field("a", ""), NoValue());
  expect_retiring_moves_no_id(std::optional<double>(), Field("a", "").neutral(1.0), NoValue());
}

TEST(Identity, OfARecordIsTheSameInLaterVersionsAndNewOptionsAreNeutralThere) {
  const Read record = read<First>("{reach: 2 cm, deviation: 3}");
  const Read second = read<Second>(record.yaml, true);
  EXPECT_EQ(second.id_text, record.id_text);
  EXPECT_EQ(second.yaml,
            "mode: plain\ntolerance: 1e-08\nparts: []\nextra:\n  gain: 1\nnote: \"\"\nreach: 0.02 m\ndeviation: 3\n"
            "workers: 1\n");
  const Read third = read<Third>(record.yaml, true);
  EXPECT_EQ(third.id_text, record.id_text);
  EXPECT_EQ(third.yaml, "mode: plain\nextra:\n  gain: 1\nreach: 0.02 m\nspread: 3\n")
      << "an absent limit is what the record has, whatever the default is now";
  EXPECT_EQ(read<Third>(third.yaml, true).id_text, record.id_text) << "and its record is one again";
}

TEST(Identity, OfARecordThatLacksWhatItMustHaveIsRefused) {
  EXPECT_EQ(trouble_with<First>("reach: 1 cm\ntolerance: 1e-8"),
            "c.yaml:1:1: 'deviation' is missing, a config with 'complete' needs every option: restore it, or remove "
            "'complete'");
  EXPECT_EQ(trouble_with<First>("reach: 1 cm\ntolerance: 1e-8", false), "accepted") << "it has a default";
  EXPECT_EQ(trouble_with<Third>("reach: 1 cm\nspread: 1\ntolerance: 1e-7"),
            "c.yaml:4:12: option 'tolerance' no longer exists, only records with the value 1e-08 can be read");
  EXPECT_EQ(trouble_with<Third>("reach: 1 cm\nspread: 1\ntolerance: 0.00000001"), "accepted") << "the same number";
  EXPECT_EQ(trouble_with<Third>("tolerance: 1e-8", false),
            "c.yaml:1:12: option 'tolerance' no longer exists, nothing has taken its place");
  EXPECT_THAT(trouble_with<Third>("deviation: 1", false), HasSubstr("unknown option 'deviation'"));
}

TEST(Identity, BelowATypeThatTheCommandLineChoseDefaultsAreWhatIsMissing) {
  struct Chosen : Options {
    PluginChoice kernel{"kernel", {}, nullptr};
    void list(Fields& fields) override { fields.plugin(kernel, Field("kernel", "")); }
  };
  Tree input = parse_yaml("complete: 1\nkernel: {type: smooth, scale: 2 cm}", "c.yaml");
  mark_complete(input);
  input.erase("complete");
  Tree& type = input.at_path("kernel.type", {});
  type = Tree::scalar("rough");
  EXPECT_THAT(
      error_of([&] { resolve(*std::make_unique<Chosen>(), input, TwoPlugins(), *std::make_unique<ResolveNotes>()); }),
      HasSubstr("'kernel.nu' is missing"))
      << "it may have been cut off by hand";
  type.layer = kCommandLineLayer;
  Chosen options;
  ResolveNotes notes;
  EXPECT_EQ(to_yaml(resolve(options, input, TwoPlugins(), notes)),
            "kernel:\n  type: rough\n  scale: 0.02 m\n  nu: 1.5\n");
}

struct Neutral : Options {
  Field field;
  explicit Neutral(const Field& of) : field(of) {}
  double value = 1.0;
  void list(Fields& fields) override { fields.real(value, field); }
};

TEST(NeutralValues, AreDescribedAsAConfigHasThem) {
  Neutral options(Field("a", "").in(Unit::metre).above(0).neutral(0.01));
  EXPECT_EQ(describe_fields([&](Fields& fields) { options.list(fields); }).front().neutral, "0.01 m");
}

}  // namespace
}  // namespace palpate::test
