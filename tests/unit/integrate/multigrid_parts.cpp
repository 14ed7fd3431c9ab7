#include <cdem/core/random.hpp>
#include <cdem/integrate/detail/multigrid_groups.hpp>
#include <cdem/integrate/detail/multigrid_lanes.hpp>
#include <cdem/integrate/detail/multigrid_smoother.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

using namespace cdem;
using namespace cdem::integrate::detail;

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t nodes = 24;

/// Lines of a field: x y z 0 a b c 0 for each node.
struct Lines {
  std::vector<float> number = std::vector<float>(8 * (nodes + 8), 0.0F);

  static Lines random(core::Random& random) {
    Lines lines;
    for (std::size_t k = 0; k < 8 * nodes; ++k)
      lines.number[k] = k % 4 == 3 ? 0.0F : static_cast<float>(random.uniform(-1, 1));
    return lines;
  }
  Vector6 at(std::size_t node) const {
    Vector6 twist;
    for (std::size_t d = 0; d < 6; ++d)
      twist[static_cast<Eigen::Index>(d)] = static_cast<double>(number[8 * node + (d < 3 ? d : d + 1)]);
    return twist;
  }
};

Vec3 lane_of(const std::array<float, 8> (&vectors)[3], std::size_t lane) {
  return {static_cast<double>(vectors[0][lane]), static_cast<double>(vectors[1][lane]),
          static_cast<double>(vectors[2][lane])};
}

/// Stiffness of one lane, written out.
Matrix6 stiffness(const BondLinks& links, std::size_t lane) {
  const Vec3 d = lane_of(links.half_branch, lane);
  const auto block = [&](float across, float along) -> Mat3 {
    return static_cast<double>(across) * Mat3::Identity() + static_cast<double>(along) * d * d.transpose();
  };
  Matrix6 matrix = Matrix6::Zero();
  matrix.topLeftCorner<3, 3>() = block(links.tangential[lane], links.stretch[lane]);
  matrix.bottomRightCorner<3, 3>() = block(links.bending[lane], links.twist[lane]);
  return matrix;
}
Matrix6 symmetric(const float* upper, std::size_t lane) {
  Matrix6 matrix;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      matrix(row, column) = static_cast<double>(
          upper[8 * static_cast<std::size_t>(upper_entry(std::min(row, column), std::max(row, column))) +
                lane]);
  return matrix;
}
Matrix6 stiffness(const GroupLinks& links, std::size_t lane) {
  return symmetric(links.upper.data(), lane);
}

void fill(std::array<float, 8>& lanes, core::Random& random) {
  for (float& lane : lanes)
    lane = static_cast<float>(random.uniform(0, 1));
}
void fill_stiffness(BondLinks& links, core::Random& random) {
  for (auto* lanes : {&links.tangential, &links.stretch, &links.bending, &links.twist})
    fill(*lanes, random);
}
void fill_stiffness(GroupLinks& links, core::Random& random) {
  for (float& entry : links.upper)
    entry = static_cast<float>(random.uniform(-1, 1));
}

/// Three eights within the block and two that leave it, whose ends meet each other.
template <class Links>
std::vector<Links> random_links(core::Random& random) {
  std::vector<Links> links(5);
  for (Links& eight : links) {
    for (auto& lanes : eight.half_branch)
      fill(lanes, random);
    for (std::size_t lane = 0; lane < 8; ++lane) {
      eight.first[lane] = static_cast<std::uint32_t>(random.uniform(0, 3));
      eight.second[lane] = static_cast<std::uint32_t>(random.uniform(3, nodes));
    }
    fill_stiffness(eight, random);
  }
  return links;
}

template <class Links>
void check_against_formula() {
  core::Random random(3);
  const std::vector<Links> links = random_links<Links>(random);
  const LinkBlock<Links> block{links.data(), links.data() + 3, links.data() + 5};
  const Lines x = Lines::random(random);
  Lines force;
  AnyProcessor::act(block, x.number.data(), x.number.data(), force.number.data());

  std::vector<Vector6> expected(nodes, Vector6::Zero());
  for (std::size_t k = 0; k < links.size(); ++k)
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const std::uint32_t i = links[k].first[lane], j = links[k].second[lane];
      const Vector6 here = x.at(i), there = x.at(j);
      const Vec3 d = lane_of(links[k].half_branch, lane);
      // the ends' rigid motions seen at the link's middle
      Vector6 strain = there - here;
      strain.head<3>() =
          there.head<3>() + there.tail<3>().cross(-d) - here.head<3>() - here.tail<3>().cross(d);
      const Vector6 pull = stiffness(links[k], lane) * strain;
      expected[i] += pull;
      expected[i].tail<3>() += d.cross(pull.head<3>());
      if (k < 3) {
        expected[j] -= pull;
        expected[j].tail<3>() -= (-d).cross(pull.head<3>());
      }
    }
  for (std::size_t node = 0; node < nodes; ++node)
    CHECK((force.at(node) - expected[node]).norm() < 2e-5);
#if defined(__x86_64__)
  if (has_avx2()) {
    Lines same;
    Avx2::act(block, x.number.data(), x.number.data(), same.number.data());
    CHECK(same.number == force.number);
  }
#endif
}

/// A line of nodes a distance 1 apart along x, joined to the next.
struct Chain {
  std::uint32_t count;
  double weak_after; ///< the link after this node is a thousand times weaker
  std::uint32_t size() const { return count; }
  bool is_held(std::uint32_t node) const { return node == 7; }
  double weight(std::uint32_t link) const { return link == weak_after ? 1e-3 : 1; }
  template <class Visit>
  void for_each_link(std::uint32_t node, Visit&& visit) const {
    const auto neighbour = [&](std::uint32_t other) { return is_held(other) ? none : other; };
    if (node > 0)
      visit(node - 1, neighbour(node - 1), [] { return Vec3(-1, 0, 0); });
    if (node + 1 < count)
      visit(node, neighbour(node + 1), [] { return Vec3(1, 0, 0); });
  }
};

} // namespace

TEST_CASE("Eight links at a time pull like one link after the other in double precision") {
  check_against_formula<BondLinks>();
  check_against_formula<GroupLinks>();
}

TEST_CASE("A relaxation of a block that is no multiple of eight leaves the next block alone") {
  core::Random random(5);
  const Lines rhs = Lines::random(random), force = Lines::random(random), x = Lines::random(random);
  std::vector<float> inverse(3 * 168);
  for (float& entry : inverse)
    entry = static_cast<float>(random.uniform(-1, 1));
  const std::size_t count = 19;
  Lines result;
  const RelaxedBlock block{inverse.data(),
                           rhs.number.data(),
                           force.number.data(),
                           x.number.data(),
                           result.number.data(),
                           count,
                           0.5F};
  AnyProcessor::relax(block);
  for (std::size_t node = 0; node < nodes; ++node) {
    const Vector6 moved =
        symmetric(inverse.data() + node / 8 * 168, node % 8) * (rhs.at(node) + force.at(node));
    const Vector6 expected = node < count ? Vector6(x.at(node) + 0.5 * moved) : Vector6(Vector6::Zero());
    CHECK((result.at(node) - expected).norm() < 1e-5);
  }
#if defined(__x86_64__)
  if (has_avx2()) {
    Lines same;
    RelaxedBlock again = block;
    again.result = same.number.data();
    Avx2::relax(again);
    CHECK(same.number == result.number);
  }
#endif
}

TEST_CASE("The smoother's polynomial meets the least possible bound of a V-cycle") {
  for (int steps = 1; steps <= 16; ++steps) {
    double worst = 0, largest = 0;
    for (int k = 1; k <= 20000; ++k) {
      const double s = k / 20000.0;
      double p = 1;
      for (int j = 0; j < steps; ++j)
        p *= 1 - 2 * s * static_cast<double>(smoothing_gain(j, steps)); // 2 is the largest eigenvalue
      worst = std::max(worst, s * p * p / (1 - p * p));
      largest = std::max(largest, std::abs(p));
    }
    CAPTURE(steps);
    CHECK(largest < 1);
    // Lottes (2023): the inverse of the bound is tan^2(k pi / (2k + 1)): 3, 9.47, 19.2, ...
    CHECK(1 / worst ==
          doctest::Approx(std::pow(std::tan(steps * std::numbers::pi / (2 * steps + 1)), 2)).epsilon(1e-3));
  }
}

TEST_CASE("Groups cover the free nodes, know where they stand, and are the same for any number of threads") {
  const Chain chain{150000, 70000}; // three ranges
  core::ThreadPool one(1), four(4);
  for (const std::uint32_t hanging : {0U, 3U}) {
    const Groups groups = grow_groups(chain, 20, 0.05, hanging, one);
    const Groups again = grow_groups(chain, 20, 0.05, hanging, four);
    CHECK(groups.group_of == again.group_of);
    std::vector<std::size_t> members(groups.count, 0);
    std::vector<double> first(groups.count, -1);
    std::vector<double> sum(groups.count, 0);
    bool consistent = true;
    for (std::uint32_t node = 0; node < chain.size(); ++node) {
      const std::uint32_t group = groups.group_of[node];
      consistent = consistent && (group == none) == chain.is_held(node);
      if (group == none)
        continue;
      ++members[group];
      sum[group] += groups.arm[node].x();
      if (first[group] < 0)
        first[group] = node - groups.arm[node].x(); // the centre, wherever it is seen from
      consistent = consistent && std::abs(node - groups.arm[node].x() - first[group]) < 1e-9;
    }
    CHECK(consistent);
    CHECK(*std::min_element(members.begin(), members.end()) >= 2);
    CHECK(*std::max_element(members.begin(), members.end()) <= 30);
    CHECK(std::all_of(sum.begin(), sum.end(), [](double s) { return std::abs(s) < 1e-9; }));
    CHECK(groups.group_of[70000] != groups.group_of[70001]); // the weak link parts them
    CHECK(groups.group_of[6] != groups.group_of[8]);         // and so does the held node
  }
}
