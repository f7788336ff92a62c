// What is done with sets of points: saved, classified, deleted, extracted, counted.

#include "pcm/filter/set_changes.h"

#include "pcm/bpc/chunk.h"
#include "pcm/filter/set_points.h"
#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "pcm/tree/verify.h"
#include "tests/outcome.h"
#include "tests/select/cloud_of_points.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class SetChanges : public CloudOfPoints {
protected:
    void SetUp() override
    {
        make(Shape::surface, 6000);
        Selection selection;
        selection.region = Region::sphere(middle(), 20);
        chosen_ = std::make_unique<PointSet>(select_points(tree_, selection));
        ASSERT_GT(chosen_->size(), 200u);
        ASSERT_LT(chosen_->size(), points_.size() / 2);
    }
    SetChangeOptions in_place() const
    {
        SetChangeOptions options;
        options.target.in_place = true;
        return options;
    }
    SetChangeOptions to_copy() const
    {
        SetChangeOptions options;
        options.target.copy = folder_ / "copy.pct";
        return options;
    }
    static void expect_sound(const fs::path& tree)
    {
        const VerifyReport verified = verify_tree(tree, 1);
        EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();
    }
    static std::vector<double> values(const fs::path& path, const std::string& name)
    {
        const auto tree = Tree::open(path);
        std::vector<double> values;
        for (NodeId node = 0; node < tree->nodes().size(); ++node) {
            const Chunk chunk = tree->read_chunk(node, ColumnSet::all(tree->info().schema));
            const auto place = tree->info().schema.find(name);
            EXPECT_TRUE(place) << name;
            for (std::uint32_t i = 0; i < chunk.points; ++i) values.push_back(chunk.attributes[*place]->value(i, 0));
        }
        return values;
    }
    static ErrorCode code_of(const std::function<void()>& f)
    {
        try {
            f();
        } catch (const Error& error) {
            return error.code();
        }
        ADD_FAILURE() << "nothing was thrown";
        return ErrorCode::io;
    }
    std::unique_ptr<PointSet> chosen_;
};

TEST_F(SetChanges, SavedAsAnAttributeAndSelectedByIt)
{
    const Stopwatch watch;
    const SetChangeReport report = save_as_attribute(*chosen_, "yard", to_copy());
    EXPECT_EQ(report.tree, folder_ / "copy.pct");
    expect_outcome(report.outcome, points_.size(), chosen_->size(), watch);
    EXPECT_FALSE(Tree::open(path())->info().schema.find("yard"));
    expect_sound(report.tree);
    const auto flags = values(report.tree, "yard");
    for (std::size_t i = 0; i < points_.size(); ++i)
        ASSERT_EQ(flags[i], chosen_->contains(points_[i].node, points_[i].number));

    // Again, with another set: ones become zeros, too.
    Selection by_it;
    by_it.where.push_back(parse_condition("yard=1"));
    PointSet again = select_points(Tree::open(report.tree), by_it);
    EXPECT_EQ(again.size(), chosen_->size());
    again.invert();
    SetChangeOptions options = in_place();
    EXPECT_EQ(save_as_attribute(again, "yard", options).outcome.points_out, points_.size());
    const auto turned = values(report.tree, "yard");
    for (std::size_t i = 0; i < flags.size(); ++i) ASSERT_EQ(turned[i], 1 - flags[i]);

    // An empty set is one, too; another type is refused.
    EXPECT_EQ(code_of([&] { save_as_attribute(*chosen_, "intensity", in_place()); }), ErrorCode::invalid_argument);
    save_as_attribute(PointSet(tree_), "none", in_place());
    for (const double flag : values(path(), "none")) ASSERT_EQ(flag, 0);
}

TEST_F(SetChanges, Classified)
{
    const Stopwatch watch;
    const SetChangeReport report = classify_points(*chosen_, 6, "classification", to_copy());
    expect_sound(report.tree);
    const auto before = values(path(), "classification"), after = values(report.tree, "classification");
    std::uint64_t changed = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const bool in = chosen_->contains(points_[i].node, points_[i].number);
        ASSERT_EQ(after[i], in ? 6 : before[i]);
        changed += in && before[i] != 6;
    }
    expect_outcome(report.outcome, points_.size(), changed, watch);
    EXPECT_EQ(code_of([&] { classify_points(*chosen_, 256, "classification", in_place()); }),
              ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { classify_points(*chosen_, -1, "classification", in_place()); }),
              ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { classify_points(*chosen_, 1, "rgb", in_place()); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { classify_points(PointSet(tree_), 1, "classification", in_place()); }),
              ErrorCode::invalid_argument);
    classify_points(*chosen_, 250, "kind", in_place());  // made
    const auto kinds = values(path(), "kind");
    for (std::size_t i = 0; i < points_.size(); ++i)
        ASSERT_EQ(kinds[i], chosen_->contains(points_[i].node, points_[i].number) ? 250 : 0);
}

// One point of each node, of nodes with one point or more.
TEST_F(SetChanges, OfOnePointInEachNode)
{
    std::filesystem::remove_all(path());
    make(Shape::surface, 4);  // and a part of one point
    std::size_t single = 0;
    for (NodeId node = 0; node < tree_->nodes().size(); ++node) single += tree_->node(node).points == 1;
    ASSERT_GT(single, 0u);
    const PointSet first = expected([](const KnownPoint& p) { return p.number == 0; });
    ASSERT_LT(first.size(), points_.size());
    const auto expect = [&](const std::string& name, double in, double beside) {
        const auto found = values(path(), name);
        for (std::size_t i = 0; i < points_.size(); ++i)
            EXPECT_EQ(found[i], points_[i].number == 0 ? in : beside) << name << ", point " << i;
    };
    EXPECT_EQ(classify_points(first, 9, "kind", in_place()).outcome.points_out, first.size());
    expect("kind", 9, 0);
    read();
    save_as_attribute(expected([](const KnownPoint& p) { return p.number == 0; }), "first", in_place());
    expect("first", 1, 0);
    read();
    save_as_attribute(PointSet(tree_), "first", in_place());
    expect("first", 0, 0);
}

TEST_F(SetChanges, DeletedInPlaceAndFromACopy)
{
    std::multiset<Vec3d> kept;
    for (const KnownPoint& p : points_)
        if (!chosen_->contains(p.node, p.number)) kept.insert(p.position);
    for (const bool copy : {true, false}) {
        const SetErasure erased = delete_points(*chosen_, copy ? to_copy() : in_place());
        EXPECT_EQ(erased.report.points_deleted, chosen_->size());
        expect_sound(erased.tree);
        const auto left = Tree::open(erased.tree);
        EXPECT_EQ(left->info().points, kept.size());
        std::multiset<Vec3d> found;
        for (NodeId node = 0; node < left->nodes().size(); ++node) {
            const Chunk chunk = left->read_chunk(node, ColumnSet::only_positions());
            for (std::uint32_t i = 0; i < chunk.points; ++i)
                found.insert(left->info().grid.to_source(chunk.positions->grid(i)));
        }
        EXPECT_TRUE(found == kept);
        EXPECT_EQ(Tree::open(path())->info().points, copy ? points_.size() : kept.size());
    }
    // The tree is another one now.
    EXPECT_EQ(code_of([&] { delete_points(*chosen_, in_place()); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { classify_points(*chosen_, 1, "classification", in_place()); }),
              ErrorCode::invalid_argument);
    fs::remove_all(folder_ / "copy.pct");
    EXPECT_EQ(code_of([&] { save_as_attribute(*chosen_, "a", to_copy()); }), ErrorCode::invalid_argument);
    EXPECT_FALSE(fs::exists(folder_ / "copy.pct"));
}

// The same points with other values in their place: as many, in as many nodes, of the same generation.
TEST_F(SetChanges, ATreeBuiltAnewWithOtherValuesIsRefused)
{
    BuildOptions options;
    options.chunk_points = 1000;
    options.overwrite = true;
    build_tree({folder_ / "a.las"}, path(), options);
    const auto before = Tree::open(path());
    const PointSet set = PointSet::all_of(before);
    auto other = records(Shape::surface, 6000, 3);
    for (LasRecord& record : other) record.intensity ^= 1;
    write_las(folder_ / "a.las", other, Grid{{0.001, 0.001, 0.001}, {512345, 4812345, 100}});
    build_tree({folder_ / "a.las"}, path(), options);
    const auto after = Tree::open(path());
    ASSERT_EQ(after->info().generation, before->info().generation);
    ASSERT_EQ(after->info().points, before->info().points);
    ASSERT_EQ(after->nodes().size(), before->nodes().size());
    ASSERT_NE(after->info().content_hash, before->info().content_hash);
    EXPECT_FALSE(set.belongs_to(*after));
    for (const SetChangeOptions& options_of_change : {in_place(), to_copy()}) {
        EXPECT_EQ(code_of([&] { save_as_attribute(set, "yard", options_of_change); }), ErrorCode::invalid_argument);
        EXPECT_EQ(code_of([&] { classify_points(set, 9, "classification", options_of_change); }),
                  ErrorCode::invalid_argument);
        EXPECT_EQ(code_of([&] { delete_points(set, options_of_change); }), ErrorCode::invalid_argument);
        EXPECT_FALSE(fs::exists(folder_ / "copy.pct"));
    }
    EXPECT_EQ(Tree::open(path())->info().content_hash, after->info().content_hash);
    PointSet mixed = PointSet::all_of(after);
    EXPECT_EQ(code_of([&] { mixed.combine(SetOperation::add, set); }), ErrorCode::invalid_argument);
}

TEST_F(SetChanges, ACancelLeavesTheTreeAsItWas)
{
    const std::uint64_t hash = tree_->info().content_hash;
    for (const bool copy : {true, false}) {
        SetChangeOptions options = copy ? to_copy() : in_place();
        // The last question is asked just before the commit.
        for (const double at : {0.0, 0.9}) {
            options.progress = [&](const ProgressUpdate& update) { return update.fraction < at; };
            EXPECT_EQ(code_of([&] { save_as_attribute(*chosen_, "yard", options); }), ErrorCode::cancelled);
            EXPECT_EQ(code_of([&] { classify_points(*chosen_, 9, "classification", options); }), ErrorCode::cancelled);
            EXPECT_EQ(code_of([&] { delete_points(*chosen_, options); }), ErrorCode::cancelled);
            EXPECT_FALSE(fs::exists(folder_ / "copy.pct"));
            EXPECT_EQ(Tree::open(path())->info().content_hash, hash);
            EXPECT_EQ(Tree::open(path())->info().schema.size(), tree_->info().schema.size());
        }
    }
    ExtractOptions extract;
    extract.progress = [](const ProgressUpdate& update) { return update.fraction < 0.9; };
    for (const char* name : {"out.las", "out.pct", "out.ply"}) {
        EXPECT_EQ(code_of([&] { extract_points(*chosen_, folder_ / name, extract); }), ErrorCode::cancelled);
        EXPECT_FALSE(fs::exists(folder_ / name)) << name;
    }
}

using Row = std::vector<double>;

std::multiset<Row> rows_of(PointReader& reader, const PointSet* within)
{
    std::multiset<Row> rows;
    PointBatch batch;
    (void)within;
    while (reader.read(batch, 777))
        for (std::size_t i = 0; i < batch.size; ++i) {
            Row row;
            for (std::size_t a = 0; a < 3; ++a)
                row.push_back(batch.gridded ? reader.info().grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i]);
            for (std::size_t k = 0; k < batch.attributes.size(); ++k)
                for (std::uint32_t c = 0; c < batch.attributes[k].components(); ++c)
                    row.push_back(batch.attributes[k].value(i, c));
            rows.insert(row);
        }
    return rows;
}

TEST_F(SetChanges, ExtractedBitForBit)
{
    std::multiset<Row> wanted;
    for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
        const Chunk chunk = tree_->read_chunk(node, ColumnSet::all(tree_->info().schema));
        for (const std::uint32_t i : chosen_->points(node)) {
            const Vec3d p = tree_->info().grid.to_source(chunk.positions->grid(i));
            Row row{p[0], p[1], p[2]};
            for (const auto& column : chunk.attributes)
                for (std::uint32_t c = 0; c < column->components(); ++c) row.push_back(column->value(i, c));
            wanted.insert(row);
        }
    }
    ASSERT_EQ(wanted.size(), chosen_->size());
    const auto direct = open_set(*chosen_);
    EXPECT_EQ(direct->info().points, wanted.size());
    EXPECT_TRUE(direct->info().points_known);
    EXPECT_TRUE(rows_of(*direct, nullptr) == wanted);
    EXPECT_EQ(direct->fraction_read(), 1.0);

    extract_points(*chosen_, folder_ / "out.las");
    EXPECT_TRUE(rows_of(*open_reader(folder_ / "out.las"), nullptr) == wanted);
    const ConvertReport report = extract_points(*chosen_, folder_ / "out.pct");
    EXPECT_EQ(report.outcome.points_out, wanted.size());
    expect_sound(folder_ / "out.pct");
    EXPECT_TRUE(rows_of(*open_cloud({folder_ / "out.pct"}), nullptr) == wanted);
    EXPECT_TRUE(Tree::open(folder_ / "out.pct")->info().grid == tree_->info().grid);

    EXPECT_EQ(code_of([&] { extract_points(*chosen_, folder_ / "out.pct"); }), ErrorCode::exists);
    EXPECT_EQ(code_of([&] { extract_points(*chosen_, path()); }), ErrorCode::invalid_argument);
    EXPECT_EQ(code_of([&] { extract_points(PointSet(tree_), folder_ / "x.las"); }), ErrorCode::invalid_argument);
    ExtractOptions over;
    over.overwrite = true;
    extract_points(*chosen_, folder_ / "out.pct", over);
    EXPECT_EQ(code_of([&] { extract_points(*chosen_, path(), over); }), ErrorCode::invalid_argument);
}

TEST_F(SetChanges, CountedWithBoxAndClasses)
{
    const SetStatistics statistics = statistics_of(*chosen_, 2);
    Box3d box;
    std::map<std::int64_t, std::uint64_t> classes;
    for (const KnownPoint& p : points_)
        if (chosen_->contains(p.node, p.number)) {
            box.extend(p.position);
            ++classes[static_cast<std::int64_t>(p.classification)];
        }
    EXPECT_EQ(statistics.points, chosen_->size());
    EXPECT_EQ(statistics.box, box);
    EXPECT_EQ(statistics.classes, classes);
    EXPECT_TRUE(statistics_of(PointSet(tree_)).box.empty());
}

}  // namespace
