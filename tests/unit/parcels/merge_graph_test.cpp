// Who merges into whom: every pattern the method lists, for every order in memory, and the
// statistics of random clouds.
#include "parcels/merge_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "parcel_cloud.hpp"
#include "parcels/merge.hpp"

namespace pileus::parcels {
namespace {

using std::numbers::pi;

struct Spot {
  double x, z;
  bool small;
};
using Group = std::set<int>;
struct Pattern {
  const char* name;
  std::vector<Spot> spots;
  std::set<Group> groups;  // members of every parcel that is left
};

constexpr bool s = true, L = false;
/// Dossier 8.3: lower case small, capital large, "−" one-way link, "=" dual.
const std::vector<Pattern> patterns = {
    {"a=b", {{-0.1, 0, s}, {0.1, 0, s}}, {{0, 1}}},
    {"a-B", {{-0.1, 0, s}, {0.1, 0, L}}, {{0, 1}}},
    {"a=b-c", {{-0.1, 0, s}, {0, 0, s}, {0.12, 0, s}}, {{0, 1, 2}}},
    {"a-b-C", {{-0.2, 0, s}, {0, 0, s}, {0.1, 0, L}}, {{0, 1}, {2}}},
    {"a=b C", {{-0.1, 0, s}, {0, 0, s}, {0.11, 0, L}}, {{0, 1}, {2}}},
    {"a-B-c", {{-0.1, 0, s}, {0, 0, L}, {0.12, 0, s}}, {{0, 1, 2}}},
    {"a-b=c-d", {{-0.2, 0, s}, {-0.05, 0, s}, {0.05, 0, s}, {0.2, 0, s}}, {{0, 1}, {2, 3}}},
    {"a-b-c=d", {{-0.25, 0, s}, {-0.05, 0, s}, {0.1, 0, s}, {0.2, 0, s}}, {{0, 1}, {2, 3}}},
    {"a-B-c-d", {{-0.2, 0, s}, {-0.1, 0, L}, {0, 0, s}, {0.15, 0, s}}, {{0, 1}, {2, 3}}},
    {"a=b c=d", {{-0.1, 0, s}, {0, 0, s}, {0.101, 0, s}, {0.2, 0, s}}, {{0, 1}, {2, 3}}},
    {"a-b-c-D", {{-0.11, 0, s}, {-0.02, 0, s}, {0.05, 0, s}, {0.1, 0, L}}, {{0, 1}, {2, 3}}},
    {"(a,b)-c-d=e",
     {{0.12, 0.07, s}, {0.12, -0.07, s}, {0.19, 0, s}, {0.25, 0, s}, {0.3, 0, s}},
     {{0, 1, 2}, {3, 4}}},
    {"(a,b)-C-(d,e)",
     {{-0.12, 0.07, s}, {-0.12, -0.07, s}, {0, 0, L}, {0.12, 0.07, s}, {0.12, -0.07, s}},
     {{0, 1, 2, 3, 4}}},
};

/// Nearest other spot of every small one, by the storage order `place` (spot at every place).
std::vector<Link> nearest_links(const std::vector<Spot>& spots, const std::vector<int>& place) {
  std::vector<Link> links;
  for (std::uint32_t p = 0; p < place.size(); ++p) {
    const Spot& a = spots[static_cast<std::size_t>(place[p])];
    if (!a.small) continue;
    double best = std::numeric_limits<double>::infinity();
    Link link{p, p};
    for (std::uint32_t q = 0; q < place.size(); ++q) {
      const Spot& b = spots[static_cast<std::size_t>(place[q])];
      const double d = (a.x - b.x) * (a.x - b.x) + (a.z - b.z) * (a.z - b.z);
      if (p != q && d < best) {
        best = d;
        link.to = q;
      }
    }
    links.push_back(link);
  }
  return links;
}

void expect_stars(const std::vector<Link>& links, const std::vector<Link>& kept,
                  std::size_t parcels, bool everyone) {
  std::vector<int> source(parcels), receiver(parcels);
  for (const Link& link : kept) {
    ++source[link.from];
    receiver[link.to] = 1;
  }
  for (std::size_t p = 0; p < parcels; ++p) {
    EXPECT_LE(source[p], 1);
    EXPECT_FALSE(source[p] && receiver[p]) << "both source and receiver";
  }
  for (const Link& link : links) EXPECT_TRUE(!everyone || source[link.from] || receiver[link.from]);
}

TEST(MergeGraph, AllPatternsInAllOrders) {
  MergeGraph graph;
  for (const Pattern& pattern : patterns) {
    std::vector<int> place(pattern.spots.size());
    std::iota(place.begin(), place.end(), 0);
    do {
      const auto links = nearest_links(pattern.spots, place);
      const auto& kept = graph.resolve(links, place.size());
      expect_stars(links, kept, place.size(), true);
      std::vector<Group> group(place.size());
      std::vector<bool> gone(place.size());
      for (std::size_t p = 0; p < place.size(); ++p) group[p].insert(place[p]);
      for (const Link& link : kept) {
        group[link.to].insert(place[link.from]);
        gone[link.from] = true;
      }
      std::set<Group> left;
      for (std::size_t p = 0; p < place.size(); ++p)
        if (!gone[p]) left.insert(group[p]);
      EXPECT_EQ(left, pattern.groups) << pattern.name;
    } while (std::next_permutation(place.begin(), place.end()));
  }
}

// The same through the whole merge, with identities that stay with the parcels: not only the groups
// but every bit of the merged parcels is the same for every order in memory.
TEST(MergeGraph, MergedParcelsDoNotDependOnTheOrderInMemory) {
  const mesh::Grid<2> grid({1, 1}, {-pi / 2, -pi / 2}, {pi, pi});
  const Tiling<2> tiling(grid);
  for (const Pattern& pattern : patterns) {
    std::vector<int> place(pattern.spots.size());
    std::iota(place.begin(), place.end(), 0);
    std::map<std::uint64_t, std::vector<double>> first;
    do {
      Store store(2, {{"members", "1", Nature::extensive, "", 0, 0, 0}});
      store.resize(place.size());
      for (std::size_t p = 0; p < place.size(); ++p) {
        const auto spot = static_cast<std::size_t>(place[p]);
        store.position(0)[p] = pattern.spots[spot].x;
        store.position(1)[p] = pattern.spots[spot].z;
        store.volume()[p] = (pattern.spots[spot].small ? 0.1 : 0.4) * pi;
        store.vorticity(0)[p] = std::sqrt(1.0 + static_cast<double>(spot));
        testing::put_shape<2>(store, p, store.volume()[p] / pi * Eigen::Matrix2d::Identity());
        store.scalar(0)[p] = std::ldexp(1.0, place[p]);
        store.uid()[p] = 1000 + 7 * spot;
      }
      CellOrder<2> order(grid, tiling);
      std::vector<std::uint32_t> keys;
      order.sort(store, keys);
      Merge<2> merge(grid, pi * pi / 10);
      merge.run(store, order);
      std::set<Group> groups;
      std::map<std::uint64_t, std::vector<double>> merged;
      for (std::size_t p = 0; p < place.size(); ++p) {
        if (merge.gone()[p]) continue;
        Group group;
        for (int m = 0; m < 5; ++m)
          if (static_cast<int>(store.scalar(0)[p]) >> m & 1) group.insert(m);
        groups.insert(group);
        for (int c = 0; c < store.state_columns(); ++c)
          merged[store.uid()[p]].push_back(store.column(c)[p]);
      }
      EXPECT_EQ(groups, pattern.groups) << pattern.name;
      if (first.empty()) first = merged;
      EXPECT_EQ(merged, first) << pattern.name;
    } while (std::next_permutation(place.begin(), place.end()));
  }
}

// Dossier 8.3: 300 parcels in a unit cube, each small with probability ½, 60 draws: 73.5 % of the
// small ones disappear, clusters by number of sources 4555:905:63:2. The counts of some 9000 small
// parcels scatter by half a per cent; two is four standard deviations.
TEST(MergeGraph, RandomClouds) {
  testing::Random random(31);
  MergeGraph graph;
  std::size_t small = 0, gone = 0;
  std::array<double, 6> clusters{};
  for (int draw = 0; draw < 60; ++draw) {
    constexpr std::size_t count = 300;
    std::array<std::array<double, 3>, count> x;
    std::array<bool, count> is_small;
    for (std::size_t p = 0; p < count; ++p) {
      for (double& c : x[p]) c = testing::uniform(random, 0, 1);
      is_small[p] = testing::uniform(random, 0, 1) < 0.5;
    }
    std::vector<Link> links;
    for (std::uint32_t p = 0; p < count; ++p) {
      if (!is_small[p]) continue;
      Link link{p, p};
      double best = 4;
      for (std::uint32_t q = 0; q < count; ++q) {
        double d = 0;
        for (int a = 0; a < 3; ++a) d += (x[p][a] - x[q][a]) * (x[p][a] - x[q][a]);
        if (p != q && d < best) {
          best = d;
          link.to = q;
        }
      }
      links.push_back(link);
    }
    const auto& kept = graph.resolve(links, count);
    expect_stars(links, kept, count, true);
    std::array<std::size_t, count> sources{};
    for (const Link& link : kept) ++sources[link.to];
    for (const std::size_t n : sources)
      if (n > 0) clusters[std::min<std::size_t>(n, 6) - 1] += 1;
    small += links.size();
    gone += kept.size();
  }
  EXPECT_NEAR(static_cast<double>(gone) / static_cast<double>(small), 0.735, 0.02);
  const double total = std::accumulate(clusters.begin(), clusters.end(), 0.0);
  EXPECT_NEAR(clusters[0] / total, 4555.0 / 5525, 0.02);
  EXPECT_NEAR(clusters[1] / total, 905.0 / 5525, 0.02);
  EXPECT_NEAR(clusters[2] / total, 63.0 / 5525, 0.006);
}

// Links in a circle, as no metric gives them but a search of finite reach may: whatever is left
// over waits, nobody is source and receiver at once.
TEST(MergeGraph, CyclesEndInStars) {
  MergeGraph graph;
  for (std::uint32_t n = 2; n < 12; ++n) {
    std::vector<Link> links;
    for (std::uint32_t i = 0; i < n; ++i) links.push_back({i, (i + 1) % n});
    const auto& kept = graph.resolve(links, n);
    EXPECT_FALSE(kept.empty());
    expect_stars(links, kept, n, false);
  }
}

// Any functional graph at all: stars, and no memory of earlier calls.
TEST(MergeGraph, AnyLinksGiveStars) {
  testing::Random random(32);
  MergeGraph graph;
  for (int draw = 0; draw < 20000; ++draw) {
    const auto count = static_cast<std::uint32_t>(2 + random() % 12);
    std::vector<Link> links;
    for (std::uint32_t p = 0; p < count; ++p)
      if (random() % 3 > 0) {
        const auto to = static_cast<std::uint32_t>(random() % count);
        if (to != p) links.push_back({p, to});
      }
    const std::vector<Link> kept = graph.resolve(links, count);
    expect_stars(links, kept, count, false);
    MergeGraph fresh;
    const auto& again = fresh.resolve(links, count);
    ASSERT_EQ(kept.size(), again.size());
    for (std::size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(kept[k].to, again[k].to);
  }
}

}  // namespace
}  // namespace pileus::parcels
