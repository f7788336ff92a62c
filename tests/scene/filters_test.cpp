// The filters on a scene of lists, and the parameters through which dialogs and scripts give their arguments.
#include "plugin/filter/filter.h"

#include "pcm/system/round_number.h"
#include "plugin/filter/proposed_spacing.h"
#include "plugin/scene/scene_state.h"
#include "tests/scene/fake_scene.h"

using namespace pcm;
using namespace pcm::host;

namespace {

namespace fs = std::filesystem;

const Filter& filter_called(const QString& name)
{
    for (const Filter& filter : filters())
        if (name == filter.name) return filter;
    throw std::runtime_error("no filter " + name.toStdString());
}

// A filter with its defaults, some of which a test changes.
struct Call {
    explicit Call(Scene& of, const QString& name) : scene(of), filter(filter_called(name))
    {
        filter.add_parameters(parameters);
    }
    void run()
    {
        const auto keep = [this](const std::string& line) { log += line + "\n"; };
        filter.run({scene, parameters, nullptr, keep, keep});
    }

    Scene& scene;
    const Filter& filter;
    Parameters parameters;
    std::string log;
};

// The message of what `run` throws; empty: nothing.
template <class Run>
std::string refused(const Run& run)
{
    try {
        run();
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

TEST(Parameters, ValuesHaveOneType)
{
    Parameters parameters;
    parameters.add({"Flag", true});
    parameters.add({"Count", 3});
    parameters.add({"Size", 0.1f});
    parameters.add({"Name", "city"});
    EXPECT_TRUE(parameters.flag("Flag"));
    EXPECT_EQ(parameters.whole("Count"), 3);
    EXPECT_EQ(parameters.real("Size"), 0.1f);
    EXPECT_EQ(parameters.text("Name"), "city");
    EXPECT_NE(refused([&] { parameters.whole("Name"); }).find("'Name'"), std::string::npos);
    EXPECT_NE(refused([&] { parameters.real("Other"); }).find("'Other' is missing"), std::string::npos);
    parameters.set("Count", 4);
    EXPECT_EQ(parameters.whole("Count"), 4);
    EXPECT_FALSE(refused([&] { parameters.set("Other", 1); }).empty());
}

TEST(Parameters, AFloatIsTheDecimalThatWasTyped)
{
    EXPECT_EQ(decimal_of(0.1f), 0.1);
    EXPECT_EQ(decimal_of(-2.5e-7f), -2.5e-7);
    EXPECT_EQ(decimal_of(16777216.0f), 16777216.0);
}

TEST(Filters, EachHasParametersWithLabelsHelpAndValues)
{
    for (const Filter& filter : filters()) {
        Parameters parameters;
        filter.add_parameters(parameters);
        EXPECT_NE(filter.menus, 0u) << filter.name;
        for (const Parameter& p : parameters) {
            EXPECT_FALSE(p.label.isEmpty()) << filter.name << ": " << p.name.toStdString();
            EXPECT_TRUE(p.help.contains("efault")) << filter.name << ": " << p.name.toStdString();
            EXPECT_TRUE(p.value.isValid()) << filter.name << ": " << p.name.toStdString();
            if (!p.choices.isEmpty()) EXPECT_EQ(p.value.userType(), QMetaType::Int) << p.name.toStdString();
        }
    }
}

TEST(Filters, ProposeTheSpacingOfTheCurrentCloud)
{
    const test::TemporaryFolder folder;
    for (const char* name : {"Subsample Point Cloud Tree", "Voxel Grid of Point Cloud Tree"}) {
        FakeScene scene;
        Call call(scene, name);
        const char* const spacing = call.parameters.has("Spacing") ? "Spacing" : "VoxelSize";
        propose_spacing(call.parameters, scene);
        EXPECT_EQ(call.parameters.real(spacing), 0.1f) << name;
        const FakeLayer& layer = scene.add("city", make_tree(folder, std::string(name).substr(0, 5), 30000));
        propose_spacing(call.parameters, scene);
        std::vector<double> spacings = layer.cloud->cloud->info().spacings;
        spacings.erase(std::remove(spacings.begin(), spacings.end(), 0.0), spacings.end());
        ASSERT_FALSE(spacings.empty());
        EXPECT_EQ(call.parameters.real(spacing), static_cast<float>(round_number(spacings.back()))) << name;
        EXPECT_EQ(call.parameters.find("Tree")->empty, QString("the current layer")) << name;
    }
}

TEST(Filters, AResultTakesThePlaceOfItsLayer)
{
    const test::TemporaryFolder folder;
    FakeScene scene;
    FakeLayer& layer = scene.add("city", make_tree(folder, "city", 3000));
    LayerMatrix moved = host::identity_matrix;
    moved[0][3] = 5;
    layer.set_matrix(moved);
    Call call(scene, "Subsample Point Cloud Tree");
    call.parameters.set("Output", QString::fromStdString((folder / "few").string()));
    call.run();
    ASSERT_EQ(scene.layers().size(), 2u) << call.log;
    EXPECT_FALSE(layer.visible);
    EXPECT_EQ(scene.current()->matrix(), moved);
    EXPECT_TRUE(fs::exists(folder / "few.pct" / "index.pct"));
}

TEST(Filters, AScriptMayLackParameters)
{
    const test::TemporaryFolder folder;
    FakeScene scene;
    scene.add("city", make_tree(folder, "city", 3000));
    Call call(scene, "Subsample Point Cloud Tree");
    call.parameters = {};
    call.parameters.add({"Output", QString::fromStdString((folder / "few.pct").string())});
    call.run();
    EXPECT_NE(call.log.find("keep their defaults"), std::string::npos) << call.log;
    EXPECT_TRUE(fs::exists(folder / "few.pct"));

    Call wrong(scene, "Subsample Point Cloud Tree");
    wrong.parameters.set("Output", 7);
    EXPECT_NE(refused([&] { wrong.run(); }).find("'Output'"), std::string::npos);
}

TEST(Filters, SetClipBox)
{
    FakeScene scene;
    Call call(scene, "Set Clip Box");
    EXPECT_NE(refused([&] { call.run(); }).find("no clip box yet"), std::string::npos);
    call.parameters.set("Box", "0 0 0 2 4 6");
    call.run();
    const auto& clip = scene.part<SceneState>().clip();
    ASSERT_TRUE(clip);
    EXPECT_EQ(clip->centre, (Vec3d{1, 2, 3}));
    EXPECT_FALSE(clip->outside);
    EXPECT_NE(call.log.find("Shown alone"), std::string::npos) << call.log;
    call.parameters.set("Mode", 1);
    call.run();
    EXPECT_TRUE(clip->outside);
}

}  // namespace
