// SPDX-License-Identifier: MIT
// The hot loops, on every instruction set that this processor has, against the same sums written down plainly.
#include "gp/aligned_matrices.hpp"
#include "support/instruction_sets.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/Core>

#include <array>
#include <cstdint>

#include <sys/resource.h>

namespace palpate::loops {
namespace {

class Loops : public testing::TestWithParam<Instructions> {
 protected:
  double draw() { return random_.uniform() - 0.5; }
  AlignedArray drawn(std::size_t size) {
    AlignedArray out(size);
    for (std::size_t i = 0; i < size; ++i) out.data()[i] = draw();
    return out;
  }

  test::OnInstructions on_{GetParam()};
  Random random_{3, "loops_test"};
};

/// A product of a shape, and what it is, cell by cell in the order of vector_loops.hpp.
struct Trial {
  Trial(int rows, int columns, int depth, Random& random)
      : a(static_cast<std::size_t>(rows * depth * kStripRows)), b(columns, kPanelLines * kLine, kLine) {
    for (std::size_t i = 0; i < a.size(); ++i) a.data()[i] = random.uniform() - 0.5;
    std::vector<double> row(static_cast<std::size_t>(columns));
    b.reserve(depth);
    for (int k = 0; k < depth; ++k) {
      for (double& one : row) one = random.uniform() - 0.5;
      b.append(row.data());
    }
    const auto a_stride = static_cast<std::size_t>(depth) * kStripRows;
    product = {a.data(), a_stride, rows, b.panel(0), b.stride(), depth, b.padded() / kLine};
    for (int strip = 0; strip < rows; ++strip) {
      for (int panel = 0; panel < b.panels(); ++panel) {
        for (int i = 0; i < kStripRows; ++i) {
          for (int j = 0; j < b.width(panel); ++j) {
            double sum = 0.0;
            for (int k = 0; k < depth; ++k) {
              const double left =
                  a.data()[static_cast<std::size_t>(strip) * a_stride + static_cast<std::size_t>(k * kStripRows + i)];
              sum += left * b.row(panel, k)[j];
            }
            expected.push_back(sum);
          }
        }
      }
    }
  }

  AlignedArray a;
  Panels b;
  StripProduct product;
  std::vector<double> expected;
};

constexpr double kUlp = std::numeric_limits<double>::epsilon();

void expect_product(Random& random) {
  for (const int columns : {1, 8, 17, 47, 64, 100}) {
    for (const int depth : {0, 1, 5, 40}) {
      for (const int strips : {1, 3}) {
        const Trial trial(strips, columns, depth, random);
        AlignedArray c(trial.expected.size());
        multiply(trial.product, c.data());
        for (std::size_t i = 0; i < trial.expected.size(); ++i) {
          ASSERT_NEAR(c.data()[i], trial.expected[i], (depth + 1) * 0.25 * depth * kUlp)
              << columns << " columns, depth " << depth << ", cell " << i;
        }
      }
    }
  }
}

TEST_P(Loops, MultiplyAsWrittenDown) { expect_product(random_); }

TEST_P(Loops, UpdateTheMapsByEveryCellOfAProduct) {
  const Trial trial(2, 77, 9, random_);
  const std::size_t cells = trial.expected.size();
  const auto map = [&] {
    AlignedArray out(cells);
    for (std::size_t i = 0; i < cells; ++i) out.data()[i] = random_.uniform();
    return out;
  };
  std::array<AlignedArray, 2> means{map(), map()};
  AlignedArray variance = map();
  std::vector<double> mean_0(means[0].data(), means[0].data() + cells);
  std::vector<double> mean_1(means[1].data(), means[1].data() + cells);
  std::vector<double> left(variance.data(), variance.data() + cells);
  Update update{};
  update.means = 2;
  update.coefficient[0] = 0.75;
  update.coefficient[1] = -1.25;
  update.mean[0] = means[0].data();
  update.mean[1] = means[1].data();
  update.variance = variance.data();
  absorb_product(trial.product, update);

  const double bound = 40 * kUlp;
  for (std::size_t i = 0; i < cells; ++i) {
    const double v = trial.expected[i];
    ASSERT_NEAR(means[0].data()[i], mean_0[i] + 0.75 * v, bound);
    ASSERT_NEAR(means[1].data()[i], mean_1[i] - 1.25 * v, bound);
    ASSERT_NEAR(variance.data()[i], left[i] - v * v, bound);
  }
}

TEST_P(Loops, UpdateADensePieceByAllItsRows) {
  for (const int depth : {0, 1, 7, 8, 9, 30}) {
    AlignedArray rows = drawn((static_cast<std::size_t>(depth) + 1) * kBlock);
    const AlignedArray factor = drawn(static_cast<std::size_t>(depth) + 1);
    const AlignedArray covariance = drawn(kBlock);
    const Eigen::Map<const Eigen::VectorXd> k(covariance.data(), kBlock);
    using Rows = Eigen::Matrix<double, kBlock, Eigen::Dynamic>;
    const Rows all = Eigen::Map<const Rows>(rows.data(), kBlock, depth + 1);
    const Eigen::Map<const Eigen::VectorXd> l(factor.data(), depth);
    const Eigen::VectorXd v = (k - all.leftCols(depth) * l) / 1.75;
    AlignedArray mean = drawn(kBlock);
    AlignedArray variance = drawn(kBlock);
    const Eigen::VectorXd mean_before = Eigen::Map<Eigen::VectorXd>(mean.data(), kBlock);
    const Eigen::VectorXd variance_before = Eigen::Map<Eigen::VectorXd>(variance.data(), kBlock);
    Update update{};
    update.means = 1;
    update.coefficient[0] = 0.5;
    update.mean[0] = mean.data();
    update.variance = variance.data();
    absorb_dense({rows.data(), covariance.data(), factor.data(), depth, 1.75}, update);
    const auto near = [&](const double* values, const Eigen::VectorXd& expected) {
      return (Eigen::Map<const Eigen::VectorXd>(values, kBlock) - expected).cwiseAbs().maxCoeff() < 1e-14;
    };
    EXPECT_TRUE(near(rows.data() + static_cast<std::ptrdiff_t>(depth) * kBlock, v))
        << "the new row stays, for those to come";
    EXPECT_TRUE(near(mean.data(), mean_before + 0.5 * v));
    EXPECT_TRUE(near(variance.data(), variance_before - v.cwiseAbs2()));
  }
}

TEST_P(Loops, ReadCellsToTheSameBytesAsWrittenDown) {
  constexpr int kRows = 3;
  constexpr int kWidth = kPanelLines * kLine;
  constexpr int kColumns = 61;
  const AlignedArray cells = drawn(std::size_t{kRows} * kWidth);
  const MapTransform reading{-0.25, 0.375, 0.1, 0.3};
  for (int count = 0; count <= kWidth; ++count) {
    for (const bool mirrored : {false, true}) {
      std::vector<double> to(std::size_t{kRows} * kColumns, 7.0);
      std::vector<double> expected = to;
      const int first = mirrored ? kWidth : 1;
      for (int row = 0; row < kRows; ++row) {
        for (int i = 0; i < count; ++i) {
          // Two roundings, which no compiler makes one of.
          const volatile double product =
              std::min(std::max(cells.data()[row * kWidth + i], reading.least), reading.most) * reading.scale;
          const int place = row * kColumns + first + (mirrored ? -i : i);
          expected[static_cast<std::size_t>(place)] = product + reading.offset;
        }
      }
      read({cells.data(), kWidth, to.data() + first, kColumns, kRows, count, mirrored}, reading);
      ASSERT_EQ(to, expected) << count << (mirrored ? " mirrored" : "");
    }
  }
}

TEST_P(Loops, SolveATriangleOfAnySize) {
  for (const int n : {0, 1, 2, 7, 8, 9, 16, 40, 61}) {
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n);
    AlignedArray packed(packed_row(round_up(n, kLine)) + 1);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k <= i; ++k) {
        lower(i, k) = i == k ? 2.0 + draw() : draw();
        packed.data()[packed_row(i) + static_cast<std::size_t>(k)] = lower(i, k);
      }
    }
    Eigen::VectorXd right(n);
    for (double& one : right) one = draw();
    AlignedArray x(static_cast<std::size_t>(round_up(n + 1, kLine)));
    const auto residual = [&](const Eigen::MatrixXd& matrix) {
      return n == 0 ? 0.0 : (matrix * Eigen::Map<Eigen::VectorXd>(x.data(), n) - right).cwiseAbs().maxCoeff();
    };
    std::fill_n(x.data(), x.size(), 0.0);
    std::copy_n(right.data(), n, x.data());
    solve_lower(packed.data(), n, x.data());
    EXPECT_LT(residual(lower), 1e-12) << n;
    std::fill_n(x.data(), x.size(), 0.0);
    std::copy_n(right.data(), n, x.data());
    solve_lower_transposed(packed.data(), n, x.data());
    EXPECT_LT(residual(lower.transpose()), 1e-12) << n;
  }
}

TEST_P(Loops, FindTheHighestOfEachBlockWhereverItStands) {
  constexpr int kBlocks = 2 * kScores;
  AlignedArray numbers = drawn(static_cast<std::size_t>(kBlocks) * kScores + 1);
  double* const from = numbers.data() + 1;  // not aligned
  std::array<double, kBlocks + 1> found;
  found.fill(7.0);
  for (int i = 0; i < kScores; ++i) from[i * kScores + i] = 1.0 + i;
  for (int i = 0; i < kScores; ++i) from[kScores * kScores + i] = -1.0 - i;
  highest(from, kBlocks, found.data());
  for (int i = 0; i < kScores; ++i) EXPECT_EQ(found[static_cast<std::size_t>(i)], 1.0 + i);
  EXPECT_EQ(found[kScores], -1.0);
  for (int i = kScores; i < kBlocks; ++i) {
    const double* const block = from + static_cast<std::ptrdiff_t>(i) * kScores;
    EXPECT_EQ(found[static_cast<std::size_t>(i)], *std::max_element(block, block + kScores));
  }
  EXPECT_EQ(found[kBlocks], 7.0) << "nothing is written beside";
}

/// Of what all loops with sums of products make of the same numbers.
std::uint64_t hash_on(Instructions instructions) {
  const test::OnInstructions on(instructions);
  Random random(5, "loops_test");
  const auto drawn = [&](std::size_t size) {
    AlignedArray out(size);
    for (std::size_t i = 0; i < size; ++i) out.data()[i] = random.uniform() - 0.5;
    return out;
  };
  constexpr int kDepth = 29;
  AlignedArray rows = drawn((kDepth + 1) * std::size_t{kBlock});
  AlignedArray maps = drawn(2 * std::size_t{kBlock});
  const AlignedArray factor = drawn(kDepth);
  const AlignedArray covariance = drawn(kBlock);
  Update update{};
  update.means = 1;
  update.coefficient[0] = 0.3;
  update.mean[0] = maps.data();
  update.variance = maps.data() + kBlock;
  absorb_dense({rows.data(), covariance.data(), factor.data(), kDepth, 1.75}, update);
  AlignedArray lower = drawn(packed_row(64));
  for (int i = 0; i < 61; ++i) lower.data()[packed_row(i) + static_cast<std::size_t>(i)] = 2.5;
  AlignedArray x = drawn(64);
  solve_lower(lower.data(), 61, x.data());
  std::uint64_t hash = test::hash_of(x.data(), 61, test::hash_of(maps.data(), maps.size()));
  solve_lower_transposed(lower.data(), 61, x.data());
  hash = test::hash_of(x.data(), 61, hash);
  const Trial trial(2, 61, kDepth, random);
  const std::size_t cells = trial.expected.size();
  AlignedArray product(cells);
  multiply(trial.product, product.data());
  maps = drawn(4 * cells);  // with mirror images
  update.mean[0] = maps.data();
  update.variance = maps.data() + 2 * cells;
  absorb_product(trial.product, update);
  absorb_mirrored({trial.product, 13, static_cast<std::ptrdiff_t>(cells / 2)}, update);
  return test::hash_of(maps.data(), maps.size(), test::hash_of(product.data(), cells, hash));
}

TEST(InstructionSets, ThatFuseProductsWithSumsGiveTheBytesThatWereWrittenDown) {
  for (const Instructions one : math::instruction_sets()) {
    if (one == Instructions::baseline) continue;
    EXPECT_EQ(hash_on(one), 0x9beec07c0cc3febfULL) << math::name_of(one);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Loops, testing::ValuesIn(math::instruction_sets()),
                         [](const auto& one) { return test::test_name(one.param); });

TEST(AlignedArray, BeginWithACacheLine) {
  for (const std::size_t size : {1U, 1000U, 131071U, 131072U, 300000U}) {
    AlignedArray numbers(size);
    EXPECT_EQ(numbers.size(), size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % kLineBytes, 0U) << size;
    numbers.data()[size - 1] = 1.0;
  }
}

TEST(Panels, OfWhichFewRowsAreWrittenTakeLittleOfTheMemoryThatTheyReserve) {
  if (test::kSanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  const auto most_memory = [] {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;  // in kB
  };
  Panels panels(53361, 192, 8);
  panels.reserve(1000);  // 427 MB
  const std::vector<double> row(53361, 1.0);
  const long before = most_memory();
  for (int i = 0; i < 17; ++i) panels.append(row.data());
  EXPECT_LT(most_memory() - before, 30000);
}

TEST(Panels, KeepTheirRowsWhenTheyGrow) {
  Panels panels(53, 24, 8);
  std::vector<double> row(53);
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 53; ++j) row[static_cast<std::size_t>(j)] = 1000.0 * i + j;
    panels.append(row.data());
  }
  ASSERT_EQ(panels.padded(), 56);
  for (int i = 0; i < 100; ++i) {
    for (int p = 0; p < panels.panels(); ++p) {
      for (int j = 0; j < panels.width(p); ++j) {
        const int column = 24 * p + j;
        EXPECT_EQ(panels.row(p, i)[j], column < 53 ? 1000.0 * i + column : 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::loops
