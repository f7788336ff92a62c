// The filters that select points and work on them, in one document as MeshLab has it, without its window.
#include "pcm/make_cloud.h"
#include "pcm/system/text.h"
#include "pcm/tree/verify.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/layer.h"
#include "plugin/scene/open_clouds.h"
#include "plugin/scene/scene_state.h"
#include "tests/plugin/filter_call.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

namespace pcm::host {
namespace {

const char* const select_name = "Select Points of Point Cloud Tree";

class SelectFilters : public testing::Test {
protected:
    void SetUp() override
    {
        tree_ = tree_of(scene(folder_, "a.las", 8000, far_away), 1000);
        layer_ = document_.addNewMesh(QString::fromStdString(tree_.string()), "tree");
        show_tree(*layer_, open_cloud(tree_));
        document_.setCurrentMesh(layer_->id());
        const auto cloud = PointCloud::open(tree_);
        const Vec3d middle = cloud->info().bounds().centre();
        sphere_ = Region::sphere(middle, cloud->info().bounds().diagonal() / 4).text();
        wanted_ = count(tree_, sphere_, "");
        ASSERT_GT(wanted_, 100u);
        ASSERT_LT(wanted_, 7900u);
    }
    static std::uint64_t count(const fs::path& tree, const std::string& region, const std::string& where)
    {
        Query query;
        if (!region.empty()) query.region = parse_region(region);
        if (!where.empty()) query.where.push_back(parse_condition(where));
        std::uint64_t points = 0;
        const auto cloud = PointCloud::open(tree);
        auto cursor = cloud->points(query);
        for (PointView view; cursor.getNextData(view);) points += view.size();
        return points;
    }
    using Values = std::vector<std::pair<const char*, std::string>>;
    // Text and numbers as a script gives them.
    bool apply(const char* filter, const Values& texts, const std::vector<std::pair<const char*, int>>& numbers = {},
               const std::vector<std::pair<const char*, bool>>& flags = {})
    {
        QAction* const action = action_of(filter);
        RichParameterList parameters = plugin().parameters_for(action, document_);
        const auto set = [&](const char* name, const Value& value) {
            parameters.setValue(script_name_of(name), value);
        };
        for (const auto& [name, text] : texts) set(name, StringValue(QString::fromStdString(text)));
        for (const auto& [name, number] : numbers) {
            if (const RichEnum* choice = test::find_choice(parameters, script_name_of(name)))
                test::choose(parameters, *choice, number);
            else
                set(name, IntValue(number));
        }
        for (const auto& [name, flag] : flags) set(name, BoolValue(flag));
        return host::apply(action, document_, parameters);
    }
    std::string log() const
    {
        std::string text;
        for (const auto& line : document_.Log.logStringList()) text += line.second.toStdString() + "\n";
        return text;
    }
    std::uint64_t selected()
    {
        const auto points = scene_of(document_).part<SceneState>().selection(layer_of(*layer_));
        return points ? points->size() : 0;
    }
    const test::TemporaryFolder folder_;
    MetDocument document_;
    MeshModel* layer_ = nullptr;
    fs::path tree_;
    std::string sphere_;
    std::uint64_t wanted_ = 0;
};

TEST_F(SelectFilters, RegionsAndConditionsAreCombined)
{
    ASSERT_TRUE(apply(select_name, {{"Region", sphere_}})) << log();
    EXPECT_EQ(selected(), wanted_);
    const std::uint64_t ground = count(tree_, sphere_, "classification=2");
    ASSERT_TRUE(apply(select_name, {{"Where", "classification = 2"}}, {{"Operation", 2}}));  // subtract
    EXPECT_EQ(selected(), wanted_ - ground);
    ASSERT_TRUE(apply(select_name, {{"Where", "classification = 2"}, {"Region", sphere_}}, {{"Operation", 1}}));  // add
    EXPECT_EQ(selected(), wanted_);
    ASSERT_TRUE(apply(select_name, {{"Where", "classification = 2"}}, {{"Operation", 3}}));  // intersect
    EXPECT_EQ(selected(), ground);
    ASSERT_TRUE(apply(select_name, {}, {{"Operation", 4}}));  // invert
    EXPECT_EQ(selected(), 8000 - ground);
    scene_of(document_).part<SceneState>().undo(layer_of(*layer_));
    EXPECT_EQ(selected(), ground);
    ASSERT_TRUE(apply(select_name, {}, {{"Operation", 5}}));  // nothing
    EXPECT_EQ(selected(), 0u);
    EXPECT_FALSE(apply(select_name, {}));
    EXPECT_NE(log().find("no points were chosen"), std::string::npos) << log();
    EXPECT_FALSE(apply(select_name, {{"Region", "ball 1 2 3 4"}}));
    EXPECT_NE(log().find("'ball' is not a known shape"), std::string::npos) << log();
}

TEST_F(SelectFilters, TheClipBoxLimitsTheSelection)
{
    ClipBox box;  // a half of the scene
    const Box3d cloud = PointCloud::open(tree_)->info().bounds();
    box.half = {cloud.extent(0) / 4, cloud.extent(1), cloud.extent(2)};
    box.centre = cloud.centre();
    box.centre[0] -= cloud.extent(0) / 4;
    scene_of(document_).part<SceneState>().set_clip(box);
    ASSERT_TRUE(apply(select_name, {{"Where", "intensity >= 0"}})) << log();
    const auto clip = clip_of(layer_of(*layer_));
    ASSERT_TRUE(clip);
    const std::uint64_t shown = count(tree_, clip->region.text(), "");
    EXPECT_GT(shown, 500u);
    EXPECT_EQ(selected(), shown);
    ASSERT_TRUE(apply(select_name, {{"Where", "intensity >= 0"}}, {}, {{"InClip", false}})) << log();
    EXPECT_EQ(selected(), 8000u);
}

TEST_F(SelectFilters, GrowsFromAPlace)
{
    const Vec3d place = PointCloud::open(tree_)->nearest({500005, 4800005, 100}, 1).points[0].position;
    const std::string from = exact(place);
    EXPECT_FALSE(apply(select_name, {{"GrowFrom", from}}));
    EXPECT_NE(log().find("Longest step"), std::string::npos) << log();
    ASSERT_TRUE(apply(select_name, {{"GrowFrom", from}, {"GrowDistance", "1e6"}})) << log();
    EXPECT_EQ(selected(), 8000u);
    ASSERT_TRUE(apply(select_name, {{"GrowFrom", from}, {"GrowDistance", "1e6"}, {"Where", "classification=2"}}));
    EXPECT_LT(selected(), 8000u);
}

TEST_F(SelectFilters, WhatIsSelectedIsSavedExtractedClassifiedAndDeleted)
{
    EXPECT_FALSE(apply("Selected Points: Delete", {}, {}, {{"InPlace", true}}));
    EXPECT_NE(log().find("no point of the current layer is selected"), std::string::npos) << log();
    ASSERT_TRUE(apply(select_name, {{"Region", sphere_}})) << log();
    const std::string copy = (folder_ / "copy.pct").string(), part = (folder_ / "part.pct").string();

    ASSERT_TRUE(apply("Selected Points: Save as Attribute", {{"Attribute", "yard"}, {"Output", copy}})) << log();
    EXPECT_EQ(count(copy, "", "yard=1"), wanted_);
    // The copy is shown in place of the cloud, whose selection is used up until undo brings it back.
    ASSERT_EQ(models_of(document_).size(), 2u);
    EXPECT_EQ(document_.mm(), models_of(document_).back());
    EXPECT_TRUE(is_shown(*document_.mm()));
    EXPECT_FALSE(is_shown(*layer_));
    EXPECT_EQ(selected(), 0u);
    set_shown(*layer_, true);
    document_.setCurrentMesh(layer_->id());
    scene_of(document_).part<SceneState>().undo(layer_of(*layer_));
    EXPECT_EQ(selected(), wanted_);

    layer_->cm.Tr[0][3] = 25;
    ASSERT_TRUE(apply("Selected Points: Extract", {{"Output", part}})) << log();
    EXPECT_EQ(count(part, "", ""), wanted_);
    // A part does not replace the cloud; it lies where the cloud lies.
    ASSERT_EQ(models_of(document_).size(), 3u);
    EXPECT_TRUE(is_shown(*layer_));
    EXPECT_EQ(document_.mm()->cm.Tr, layer_->cm.Tr);
    EXPECT_EQ(selected(), wanted_);
    layer_->cm.Tr.SetIdentity();
    document_.setCurrentMesh(layer_->id());
    ASSERT_TRUE(apply("Selected Points: Extract", {{"Output", (folder_ / "part.laz").string()}})) << log();
    EXPECT_EQ(open_reader(folder_ / "part.laz")->info().points, wanted_);
    EXPECT_FALSE(apply("Selected Points: Extract", {{"Output", part}}));
    EXPECT_NE(log().find("exists already"), std::string::npos) << log();

    ASSERT_TRUE(apply("Selected Points: Classify", {}, {{"Value", 77}}, {{"InPlace", true}})) << log();
    EXPECT_EQ(count(tree_, "", "classification=77"), wanted_);
    EXPECT_EQ(selected(), 0u);  // the tree has changed
    ASSERT_TRUE(apply(select_name, {{"Where", "classification=77"}})) << log();
    EXPECT_EQ(selected(), wanted_);
    ASSERT_TRUE(apply("Selected Points: Delete", {}, {}, {{"InPlace", true}})) << log();
    EXPECT_EQ(count(tree_, "", ""), 8000 - wanted_);
    EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
    // Neither in place nor a copy: nothing happens.
    ASSERT_TRUE(apply(select_name, {{"Where", "intensity >= 0"}})) << log();
    EXPECT_FALSE(apply("Selected Points: Delete", {}));
    EXPECT_EQ(count(tree_, "", ""), 8000 - wanted_);
}

}  // namespace
}  // namespace pcm::host
