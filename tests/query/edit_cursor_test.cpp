// Changing points of a cloud, and making clouds of an open one.

#include "pcm/make_cloud.h"

#include "pcm/system/error.h"
#include "pcm/tree/verify.h"
#include "pcm/update/append.h"
#include "pcm/update/compact.h"
#include "pcm/update/repair.h"
#include "tests/clouds.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <map>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class EditCursorTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 30000, 3), {});
        BuildOptions options;
        options.chunk_points = 1000;
        build_tree({folder_ / "in.las"}, tree_, options);
    }
    std::shared_ptr<PointCloud> open(Access access, std::uint64_t bytes = 100000) const
    {
        L2Options cache;
        cache.capacity_bytes = bytes;  // far less than the cloud
        return PointCloud::open(tree_, cache, access);
    }
    template <class Call>
    static std::string error_of(const Call& call)
    {
        try {
            call();
        } catch (const Error& error) {
            return std::string(error.code() == ErrorCode::invalid_argument ? "invalid: "
                               : error.code() == ErrorCode::exists         ? "exists: "
                                                                           : "other: ") +
                   error.what();
        }
        return "";
    }
    // Attribute values by position, which identifies a point as far as this cloud's points have different positions.
    using Key = std::array<std::int64_t, 5>;
    std::multimap<Key, double> values(PointCloud& cloud, const std::string& name) const
    {
        Query query;
        query.attributes = {name, "point_source_id", "user_data"};
        std::multimap<Key, double> all;
        auto cursor = cloud.points(query);
        for (PointView view; cursor.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i) {
                const Vec3i q = view.grid_position(i);
                all.insert({{q[0], q[1], q[2], static_cast<std::int64_t>(view.value(i, 1)),
                             static_cast<std::int64_t>(view.value(i, 2))},
                            view.value(i, 0)});
            }
        return all;
    }
    std::unique_ptr<PointReader> open_cloud_reader() const { return open_reader(folder_ / "in.las"); }
    void expect_whole() const
    {
        const VerifyReport report = verify_tree(tree_, 2);
        EXPECT_TRUE(report.faults.empty()) << report.faults[0];
    }

    TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "out.pct";
};

// Changes of one column that are not yet on disk, of chunks whose other columns are not in memory.
TEST_F(EditCursorTest, QueriesSeeChangesThatAreInMemoryAlone)
{
    const auto cloud = open(Access::write, std::uint64_t(64) << 20);
    const Schema& schema = cloud->info().schema;
    const std::size_t intensity = *schema.find("intensity");
    ColumnSet changed;
    changed.positions = false;
    changed.attributes.set(intensity);
    L2Cache& cache = cloud->cache();
    std::uint64_t expected = 0, found = 0;
    const Box3d bounds = cloud->info().bounds();
    Box3d half = bounds;
    half.max[0] = bounds.centre()[0];
    const Region region = Region::box(half);
    for (NodeId node = 0; node < cloud->tree()->nodes().size(); ++node) {
        if (cloud->tree()->node(node).points == 0) continue;
        const Chunk chunk = cloud->tree()->read_chunk(node, ColumnSet::only_positions());
        for (std::size_t i = 0; i < chunk.points; ++i)
            expected += region.contains(cloud->info().grid.to_source(chunk.positions->grid(i)));
        L2Cache::Edit edit = cache.edit(node, changed);
        Column& column = edit.column(intensity);
        std::fill_n(column.as<std::uint16_t>(), column.size(), std::uint16_t(4711));
        edit.mark_written();
    }
    Query query;
    query.region = region;
    query.attributes = {"intensity", "classification"};
    std::multimap<Key, double> classes = values(*open(Access::read), "classification");
    auto cursor = cloud->points(query);
    for (PointView view; cursor.getNextData(view);)
        for (std::size_t i = 0; i < view.size(); ++i, ++found) {
            ASSERT_EQ(view.value(i, 0), 4711);
            ASSERT_TRUE(region.contains(view.position(i)));
        }
    EXPECT_EQ(found, expected);
    EXPECT_GT(found, 1000u);
    EXPECT_EQ(values(*cloud, "classification"), classes);
}

TEST_F(EditCursorTest, ANewAttributeOfEveryPoint)
{
    for (const bool again : {false, true}) {  // then its values are changed
        auto cloud = open(Access::write);
        const std::size_t attributes = cloud->info().schema.size();
        if (!again) EXPECT_EQ(cloud->add_attribute({"height", ScalarType::f64}), attributes);
        Query query;
        query.attributes = {"height"};
        std::size_t points = 0;
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view); view.mark_written(), points += view.size())
            for (std::size_t i = 0; i < view.size(); ++i) {
                EXPECT_EQ(view.value(i, 0), again ? 2 * view.position(i)[2] : 0);
                view.set(i, 0, (again ? 3 : 2) * view.position(i)[2]);
                EXPECT_EQ(view.value(i, 0), (again ? 3 : 2) * view.position(i)[2]);
            }
        EXPECT_EQ(points, 30000u);
        EXPECT_GT(cloud->cache().statistics().written_chunks, 20u);  // the cache does not hold the whole cloud
        cloud->close();
        expect_whole();
        cloud = open(Access::read);
        auto reading = cloud->points(query);
        points = 0;
        for (PointView view; reading.getNextData(view); points += view.size())
            for (std::size_t i = 0; i < view.size(); ++i)
                ASSERT_EQ(view.value(i, 0), (again ? 3 : 2) * view.position(i)[2]);
        EXPECT_EQ(points, 30000u);
    }
}

// Random selections, values and flushes against a model in memory.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(EditCursorTest, PCM_NOT_UNDER_THREAD(RandomChangesAgainstAModel))
{
    auto cloud = open(Access::write);
    auto model = values(*cloud, "intensity"), committed = model;
    std::mt19937 random(9);
    const Box3d all = cloud->info().bounds();
    for (int step = 0; step < 60; ++step) {
        Query query;
        query.attributes = {"intensity", "point_source_id", "user_data"};
        Box3d box;
        for (std::size_t a = 0; a < 3; ++a) {
            const double from = std::uniform_real_distribution<double>(0, 0.8)(random),
                         to = from + std::uniform_real_distribution<double>(0, 0.6)(random);
            box.min[a] = all.min[a] + from * all.extent(a);
            box.max[a] = all.min[a] + to * all.extent(a);
        }
        if (step % 4) query.box = box;
        if (step % 3 == 0) query.where = {parse_condition("intensity>=" + std::to_string(random() % 40000))};
        const auto value = static_cast<double>(random() % 65536);
        std::multimap<Key, double> next = model;
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view); view.mark_written())
            for (std::size_t i = 0; i < view.size(); ++i) {
                const Vec3d p = view.position(i);
                const Vec3i g = view.chunk().positions->grid(view.index(i));
                const Key key{g[0], g[1], g[2], static_cast<std::int64_t>(view.value(i, 1)),
                              static_cast<std::int64_t>(view.value(i, 2))};
                if (query.box) EXPECT_TRUE(query.box->contains(p));
                auto [first, last] = next.equal_range(key);
                ASSERT_NE(first, last);
                for (; first != last; ++first)
                    if (first->second == view.value(i, 0)) break;
                ASSERT_NE(first, last);
                first->second = value;
                view.set(i, 0, value);
            }
        model = std::move(next);
        if (step % 7 == 0) {
            cloud->flush();
            committed = model;
            expect_whole();
        }
        if (step % 10 == 9) {  // this cloud sees what is not flushed, others do not
            const auto sorted = [](const std::multimap<Key, double>& of) {
                std::vector<std::pair<Key, double>> pairs(of.begin(), of.end());
                std::sort(pairs.begin(), pairs.end());
                return pairs;
            };
            EXPECT_EQ(sorted(values(*cloud, "intensity")), sorted(model));
            EXPECT_EQ(sorted(values(*open(Access::read), "intensity")), sorted(committed));
        }
        if (step == 40) {
            cloud->abandon();
            cloud = open(Access::write);
            model = committed;
        }
    }
    cloud->close();
    expect_whole();
}

// Chunks that were written before an attribute was added have zeros for it, for every reader.
TEST_F(EditCursorTest, AnAttributeThatOnlySomeChunksHave)
{
    auto cloud = open(Access::write);
    cloud->add_attribute({"mark", ScalarType::u8, 2});
    Query query;
    query.attributes = {"mark"};
    query.box = cloud->info().bounds();
    query.box->max[0] = query.box->min[0] + query.box->extent(0) / 4;
    std::size_t marked = 0;
    {
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view); view.mark_written(), marked += view.size())
            for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 200, 1);
    }
    EXPECT_GT(marked, 1000u);
    EXPECT_LT(marked, 20000u);
    cloud->close();
    cloud = nullptr;
    const auto check = [&] {
        expect_whole();
        Query where;
        where.where = {parse_condition("mark[1]=200")};
        where.attributes = {"mark"};
        std::size_t found = 0, all = 0;
        const auto reading = open(Access::read);
        auto cursor = reading->points(where);
        for (PointView view; cursor.getNextData(view);) found += view.size();
        where.where.clear();
        auto every = reading->points(where);
        for (PointView view; every.getNextData(view); all += view.size())
            for (std::size_t i = 0; i < view.size(); ++i)
                EXPECT_TRUE(view.value(i, 0, 0) == 0 && (view.value(i, 0, 1) == 0 || view.value(i, 0, 1) == 200));
        EXPECT_EQ(found, marked);
        EXPECT_EQ(all, 30000u);
    };
    check();
    fs::remove(tree_ / index_file_name);
    repair_tree(tree_, {});
    check();
    fs::remove(tree_ / index_file_name);
    fs::remove(tree_ / "about.pct");
    repair_tree(tree_, {});
    check();
    compact_tree(tree_, {});
    check();
}

TEST_F(EditCursorTest, MisuseIsReportedClearly)
{
    Query query;
    query.attributes = {"intensity"};
    auto reading = open(Access::read);
    EXPECT_NE(error_of([&] { reading->edit(query); }).find("reading only"), std::string::npos);
    EXPECT_NE(error_of([&] { reading->add_attribute({"a"}); }).find("reading only"), std::string::npos);

    auto cloud = open(Access::write);
    EXPECT_EQ(error_of([&] { open(Access::write); }).substr(0, 7), "exists:");
    EXPECT_EQ(error_of([&] { cloud->add_attribute({"rgb"}); }).substr(0, 8), "invalid:");
    EditView view;
    {
        auto cursor = cloud->edit(query);
        ASSERT_TRUE(cursor.getNextData(view));
        EXPECT_EQ(error_of([&] { view.set(0, 0, 65536); }).substr(0, 8), "invalid:");
        EXPECT_EQ(error_of([&] { view.set(0, 0, -1); }).substr(0, 8), "invalid:");
        EXPECT_EQ(error_of([&] { view.set(0, 0, 0.5); }).substr(0, 8), "invalid:");
        EXPECT_EQ(error_of([&] { view.set(0, 0, 1, 1); }).substr(0, 8), "invalid:");
        view.set(0, 0, 65535);
        EXPECT_NE(error_of([&] { cursor.getNextData(view); }).find("mark_written"), std::string::npos);
        ASSERT_TRUE(cursor.getNextData(view));
        view.set(0, 0, 1);
    }
    EXPECT_NE(error_of([&] { cloud->flush(); }).find("mark_written"),
              std::string::npos);  // the cursor was destroyed with an unmarked change
    cloud->flush();
    auto cursor = cloud->edit(query);
    ASSERT_TRUE(cursor.getNextData(view));
    view.set(0, 0, 1);
    cloud->close();
    EXPECT_NE(error_of([&] { view.mark_written(); }).find("closed"), std::string::npos);
    EXPECT_NE(error_of([&] { cursor.getNextData(view); }), "");
    EXPECT_NE(error_of([&] { cloud->edit(query); }).find("closed"), std::string::npos);
    EXPECT_NE(error_of([&] {
                  auto points = cloud->points(query);
                  for (PointView v; points.getNextData(v);) {
                  }
              }).find("closed"),
              std::string::npos);
    EXPECT_EQ(error_of([&] { open(Access::write); }), "");  // the lock is free
    expect_whole();

    // A cursor works after its cloud is released.
    auto kept = open(Access::write)->edit(query);
    ASSERT_TRUE(kept.getNextData(view));
    view.set(0, 0, 77);
    view.mark_written();
    EXPECT_EQ(view.value(0, 0), 77);
}

TEST_F(EditCursorTest, ACursorKeepsADroppedCloudOpenAndItsEndClosesIt)
{
    Query query;
    query.attributes = {"intensity"};
    {
        auto cursor = open(Access::write)->edit(query);  // only the cursor holds the cloud
        EXPECT_THROW(open(Access::write), Error);        // still locked
        for (EditView view; cursor.getNextData(view); view.mark_written())
            for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 5);
    }
    for (const auto& [key, value] : values(*open(Access::write), "intensity")) ASSERT_EQ(value, 5);
}

TEST_F(EditCursorTest, ATransformedCloud)
{
    auto cloud = open(Access::write);
    Query query;
    query.attributes = {"intensity"};
    auto cursor = cloud->edit(query);
    for (EditView view; cursor.getNextData(view); view.mark_written())
        for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 5);
    const auto moved = transform_cloud(*cloud, Affine::translation({1000, -2000, 0.5}), folder_ / "moved.pct");
    // The same integers on another grid, with what was changed.
    EXPECT_EQ(moved->info().content_hash, open(Access::read)->info().content_hash);
    EXPECT_EQ(moved->info().grid.offset[1], cloud->info().grid.offset[1] - 2000);
    EXPECT_EQ(values(*moved, "intensity").begin()->second, 5);
    const Vec3d centre = cloud->info().bounds().centre();
    const auto turned = transform_cloud(*cloud, Affine::rotation({0, 0, 1}, 0.5, centre), folder_ / "turned.pct");
    EXPECT_EQ(turned->info().points, 30000u);
    EXPECT_LT(turned->info().position_error, 1e-9);
    EXPECT_TRUE(verify_tree(folder_ / "turned.pct", 2).faults.empty());
    double farthest = 0;
    for (PointCloud* of : {&*cloud, &*turned}) {
        double most = 0;
        auto points = of->points();
        for (PointView view; points.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i)
                most = std::max(most, std::hypot(view.position(i)[0] - centre[0], view.position(i)[1] - centre[1]));
        if (of == &*cloud)
            farthest = most;
        else
            EXPECT_NEAR(most, farthest, 1e-9 * (1 + farthest));
    }
}

TEST_F(EditCursorTest, CreateSaveAndChangeTheCopy)
{
    const auto reader = open_cloud_reader();
    const auto made = create_cloud(folder_ / "made.pct", *reader);
    EXPECT_EQ(made->info().content_hash, open(Access::read)->info().content_hash);
    auto cloud = open(Access::write);
    Query query;
    query.attributes = {"intensity"};
    auto cursor = cloud->edit(query);
    for (EditView view; cursor.getNextData(view); view.mark_written())
        for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, 5);
    save_cloud(*cloud, folder_ / "copy.pct");  // with what was changed
    cloud->close();
    const auto copy = PointCloud::open(folder_ / "copy.pct", {}, Access::write);
    EXPECT_EQ(copy->info().content_hash, open(Access::read)->info().content_hash);
    auto second = copy->edit(query);
    for (EditView view; second.getNextData(view); view.mark_written())
        for (std::size_t i = 0; i < view.size(); ++i) {
            EXPECT_EQ(view.value(i, 0), 5);
            view.set(i, 0, 6);
        }
    copy->close();
    for (const auto& [key, value] : values(*open(Access::read), "intensity")) ASSERT_EQ(value, 5);
}

}  // namespace
