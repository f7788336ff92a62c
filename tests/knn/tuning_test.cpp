// The tuned values of the search for neighbours: they decide how much is loaded and searched one by one, and no result.
#include "pcm/knn/tuning.h"

#include "pcm/build/builder.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/knn/tuned_values.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace pcm::test {
namespace {

// The squared distances to the neighbours of each point.
using Squares = std::map<PointPlace, std::vector<double>>;

class KeptSquares final : public NeighbourhoodVisitor {
public:
    KeptSquares(Squares& all, std::mutex& mutex) : all_(all), mutex_(mutex) {}
    void visit(const NeighbourhoodUnit& unit, const Neighbourhoods& some) override
    {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < some.size(); ++i)
            all_[unit.place_of(some.number(i))].assign(some.squared(i), some.squared(i) + some.count(i));
    }

private:
    Squares& all_;
    std::mutex& mutex_;
};

// Dense in the middle and sparse around it, so that margins are too small for some units.
MemoryCloud dense_and_sparse_cloud()
{
    MemoryCloud cloud = random_cloud(Schema(), Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 20000, 1, 1);
    std::mt19937_64 random(1);
    for (std::size_t i = 0; i < cloud.points.size; ++i) {
        const std::uint64_t size = i % 30 ? 3000 : 300000;
        cloud.points.grid_xyz[0][i] = static_cast<std::int32_t>(random() % size);
        cloud.points.grid_xyz[1][i] = static_cast<std::int32_t>(random() % size);
        cloud.points.grid_xyz[2][i] = 0;
    }
    return cloud;
}

TEST(KnnTuning, ChangesNoNeighbour)
{
    const TemporaryFolder folder;
    const MemoryCloud cloud = dense_and_sparse_cloud();
    MemoryReader reader(cloud);
    BuildOptions build;
    build.chunk_points = 1000;
    build_tree(reader, {"memory"}, folder.path() / "cloud.pct", build);
    L2Cache cache(Tree::open(folder.path() / "cloud.pct"));
    NeighbourhoodOptions options;
    options.neighbours = 6;
    options.unit_points = 3000;
    options.threads = 1;
    std::uint64_t alone = 0;
    const auto squares = [&] {
        Squares all;
        std::mutex mutex;
        alone = for_each_neighbourhood(cache, options, [&] { return std::make_unique<KeptSquares>(all, mutex); }).alone;
        return all;
    };
    const Squares expected = squares();
    ASSERT_EQ(expected.size(), 20000u);
    std::set<std::uint64_t> numbers{alone};
    for (const TunedValue& tuned : knn_tuned_values()) {
        const double before = tuned.get();
        for (const double factor : {0.25, 4.0}) {
            tuned.set(before <= 1 ? std::min(1.0, factor * before) : factor * before);
            EXPECT_TRUE(squares() == expected) << tuned.name() << " = " << tuned.get();
            numbers.insert(alone);
        }
        tuned.set(before);
        EXPECT_EQ(tuned.get(), before);
    }
    EXPECT_GT(numbers.size(), 2u) << "the values do not change how many points are searched one by one";
}

TEST(KnnTuning, EachValueHasAName)
{
    std::set<std::string> names;
    for (const TunedValue& tuned : knn_tuned_values()) names.insert(tuned.name());
    EXPECT_EQ(names.size(), knn_tuned_values().size());
    EXPECT_TRUE(names.count("knn.margin.next_factor"));
    EXPECT_EQ(knn_tuning().margin.next_factor, 1.1);
}

}  // namespace
}  // namespace pcm::test
