// Parameters as MeshLab's lists, and settings as MeshLab keeps them.
#include "plugin/meshlab/rich_parameters.h"

#include "plugin/meshlab/meshlab.h"
#include "plugin/settings/project_settings.h"
#include "plugin/settings/settings.h"

#include <gtest/gtest.h>

namespace pcm::host {
namespace {

Parameters examples()
{
    Parameters parameters;
    parameters.add({"Flag", true, "A flag", "Default on."});
    parameters.add({"Count", -1, "A count", "Default -1."});
    parameters.add({"Size", 0.1f, "A size", "Default 0.1."});
    parameters.add({"Name", "city", "A name", "Default city."});
    parameters.add({"Colour", QColor(10, 20, 30), "A colour", "Default dark."});
    parameters.add({"Choice", 1, "A choice", "Default two.", {"one", "two"}});
    return parameters;
}

TEST(RichParameters, KeepNamesValuesTextsAndChoices)
{
    RichParameterList list;
    add_to(list, examples());
    EXPECT_EQ(list.getParameterByName("Choice").stringType(), "RichEnum");
    EXPECT_EQ(list.getEnum("Choice"), 1);
    EXPECT_EQ(list.getFloat("Size"), 0.1f);
    EXPECT_EQ(list.getColor("Colour"), QColor(10, 20, 30));
    list.addParam(RichMatrix44f("Theirs", Matrix44m::Identity()));  // a type that ours do not have
    const Parameters before = examples(), after = parameters_of(list);
    EXPECT_FALSE(after.has("Theirs"));
    for (const Parameter& p : before) {
        const Parameter* const same = after.find(p.name);
        ASSERT_TRUE(same) << p.name.toStdString();
        EXPECT_EQ(same->value, p.value) << p.name.toStdString();
        EXPECT_EQ(same->value.userType(), p.value.userType()) << p.name.toStdString();
        EXPECT_EQ(same->label, p.label);
        EXPECT_EQ(same->help, p.help);
        EXPECT_EQ(same->choices, p.choices);
    }
}

TEST(RichParameters, SettingsOfAProjectFile)
{
    Parameters defaults;
    add_settings(defaults);
    RichParameterList list;
    add_to(list, defaults);
    const auto settings = setting_store(&list);
    settings->set("MeshLab::PointCloud::SplatSize", 7.5f);
    settings->set("MeshLab::PointCloud::Splats", 2);
    settings->set("MeshLab::PointCloud::Memory", 77);
    settings->set("MeshLab::PointCloud::NoSuchSetting", 1);
    EXPECT_EQ(list.getFloat("MeshLab::PointCloud::SplatSize"), 7.5f);
    const QByteArray empty = "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n</MeshLabProject>\n";
    const QByteArray project = with_settings(empty, *settings);
    EXPECT_NE(project, empty);
    EXPECT_EQ(with_settings(project, *settings), project);  // once
    EXPECT_FALSE(project.contains("PointCloud::Memory"));   // it belongs to the computer

    RichParameterList other;
    add_to(other, defaults);
    const auto taken = setting_store(&other);
    EXPECT_FALSE(take_settings(empty, *taken));
    EXPECT_TRUE(take_settings(project, *taken));
    EXPECT_EQ(other.getFloat("MeshLab::PointCloud::SplatSize"), 7.5f);
    EXPECT_EQ(other.getEnum("MeshLab::PointCloud::Splats"), 2);
    EXPECT_EQ(read_settings(taken->all()).style.point_size_px, 7.5f);
}

}  // namespace
}  // namespace pcm::host
