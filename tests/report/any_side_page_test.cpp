// SPDX-License-Identifier: MIT
// The page of a run from any side in a browser: surface, taps as arrows, text.
#include "record/files.hpp"
#include "record/run_replay.hpp"
#include "report/browser.hpp"
#include "report/history.hpp"
#include "support/programs.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <utility>

namespace palpate {
namespace {

using ::testing::HasSubstr;

constexpr int kTaps = 10;

/// Makes a run from any side. The meshes of its scene are relative to `folder`. Returns the run directory.
fs::path touched(const test::TemporaryFolder& folder) {
  fs::create_directory_symlink(test::source_folder() / "configs", folder.path() / "configs");
  const test::Ended ran =
      test::palpate({"run", (test::source_folder() / "configs/any_side.yaml").string(), "--quiet", "scene=any_bowl",
                     fmt::format("taps={}", kTaps), "candidates.count=200", "belief.moves=100"},
                    folder.path());
  EXPECT_EQ(ran.status, 0) << ran.err;
  return test::only_run(folder.path() / "runs");
}

class AnySidePage : public test::ReportsInBoth {};

/// Returns vertices, triangles and volume of the drawn mesh.
const std::string kMesh =
    "const {x, y, z, i, j, k} = document.getElementById('surface').data[0]; const at = (v) => [x[v], y[v], z[v]]; "
    "let volume = 0; for (let t = 0; t < i.length; t += 1) { const [a, b, c] = [at(i[t]), at(j[t]), at(k[t])]; "
    "volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * "
    "c[0])) / 6; } return [x.length, i.length, volume]";
const std::string kNames = "return document.getElementById('surface').data.map((trace) => trace.name)";
const std::string kStory = "return document.getElementById('story').textContent";

TEST_P(AnySidePage, DrawsTheSurfaceAfterEachTapAndTheTapsAsArrows) {
  const fs::path directory = touched(folder_);
  const fs::path here = fs::current_path();
  fs::current_path(folder_.path());  // the scene's mesh file is relative to this folder
  report(directory);
  const Browsed seen = browse(
      directory, {drawn(kTaps), kMesh, kNames, kStory, "key ARROW_LEFT", drawn(kTaps - 1), kMesh,
                  "return Plotly.toImage('surface', {format: 'png', width: 400, height: 300})",
                  "document.getElementById('truth').click()",
                  "await document.getElementById('surface').data.some((trace) => trace.name === 'truth')",
                  "const s = document.getElementById('slider'); s.value = 0; s.dispatchEvent(new Event('input'));",
                  drawn(0), kStory, "return document.querySelectorAll('#curves .plot').length",
                  "return document.getElementById('maps_row') === null",
                  "return document.getElementById('standing').textContent"});
  ASSERT_EQ(seen.values.size(), 11U);
  const Installation installation;
  const RunEnvironment environment{test::shared_host(), installation, {}, nullptr};
  const RecordedRun recording = read_recorded_run(environment.host, directory);
  const History history = make_history(environment, recording, [](int, int) {});
  ASSERT_EQ(history.surfaces.size(), 1U + kTaps);
  for (const auto& [value, taps] : {std::pair(0, kTaps), std::pair(3, kTaps - 1)}) {
    const Surface& mesh = history.surfaces[static_cast<std::size_t>(taps)];
    double volume = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto at = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)].position; };
      volume += at(a).dot(at(b).cross(at(c))) / 6.0;
    }
    const json& drawn_mesh = seen.values.at(static_cast<std::size_t>(value));
    EXPECT_GT(mesh.vertices.size(), 500U);
    EXPECT_EQ(drawn_mesh.at(0), mesh.vertices.size());
    EXPECT_EQ(drawn_mesh.at(1), mesh.triangles.size());
    EXPECT_NEAR(drawn_mesh.at(2).get<double>(), 1e6 * volume, 1e4 * volume);
  }
  fs::current_path(here);
  const Browsed flat = test::browse(directory / "report.html", {drawn(kTaps), "return document.body.innerText"}, false);
  ASSERT_EQ(flat.trouble, "");
  EXPECT_THAT(flat.severe, testing::IsEmpty());
  EXPECT_THAT(flat.values.at(0).get<std::string>(), HasSubstr("is not drawn, because this browser has no WebGL"));
  const auto names = seen.values.at(1).get<std::vector<std::string>>();
  EXPECT_THAT(names, testing::IsSupersetOf({"surface", "on the object", "next"}));
  EXPECT_THAT(seen.values.at(2).get<std::string>(), HasSubstr(fmt::format("Tap {} from (", kTaps)));
  EXPECT_THAT(seen.values.at(2).get<std::string>(), HasSubstr("Next: from ("));
  EXPECT_GT(seen.values.at(4).get<std::string>().size(), 5000U);
  EXPECT_THAT(seen.values.at(7).get<std::string>(), HasSubstr("it may be anywhere"));
  EXPECT_GT(seen.values.at(8), 3);
  EXPECT_EQ(seen.values.at(9), true);
  EXPECT_THAT(seen.values.at(10).get<std::string>(), HasSubstr("error to the nearest point"));
}

INSTANTIATE_TEST_SUITE_P(Browser, AnySidePage, ::testing::Values(true), test::webgl_name);

}  // namespace
}  // namespace palpate
