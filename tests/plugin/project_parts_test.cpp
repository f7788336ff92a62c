// What a document has in addition to layers, in project files.
#include "plugin/scene/project_parts.h"
#include "plugin/meshlab/document_scene.h"

#include "pcm/system/error.h"
#include "plugin/scene/project_unit.h"
#include "tests/plugin/met_document.h"

#include <gtest/gtest.h>

#include <map>

using namespace pcm;
using namespace pcm::host;

namespace {

// Parts register themselves once in a process, so all tests share these two.
std::map<QString, QString>& kept()
{
    static std::map<QString, QString> texts;
    return texts;
}

void add_parts()
{
    if (!kept().empty()) return;
    for (const QString name : {"TestPartOne", "TestPartTwo"}) {
        kept()[name] = "";
        add_project_part({name,
                          [name](Scene&) {
                              if (kept()[name] == "unwritable") throw Error(ErrorCode::invalid_argument, {}, "no text");
                              return kept()[name];
                          },
                          [name](Scene&, const QString& text) {
                              if (text == "unreadable") throw Error(ErrorCode::corrupt, {}, "not a list");
                              kept()[name] = text;
                          }});
    }
}

class ProjectParts : public testing::Test {
protected:
    void SetUp() override
    {
        add_parts();
        for (auto& [name, text] : kept()) text.clear();
    }
    QString log()
    {
        QString all;
        for (const auto& line : document.Log.logStringList()) all += line.second + "\n";
        return all;
    }
    // Both texts, through a file.
    void round_trip(const QString& one, const QString& two)
    {
        kept() = {{"TestPartOne", one}, {"TestPartTwo", two}};
        const QByteArray file = with_parts(project, scene_of(document));
        kept() = {{"TestPartOne", "old"}, {"TestPartTwo", "old"}};
        take_parts(file, scene_of(document));
        EXPECT_EQ(kept()["TestPartOne"], one);
        EXPECT_EQ(kept()["TestPartTwo"], two);
    }

    const QByteArray project = "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup/>\n</MeshLabProject>\n";
    MetDocument document;
};

TEST_F(ProjectParts, AProjectWithoutPartsStaysAsItIs)
{
    EXPECT_EQ(with_parts(project, scene_of(document)), project);
    kept()["TestPartOne"] = "text";
    EXPECT_EQ(with_parts("v 1 2 3\n", scene_of(document)), "v 1 2 3\n");
}

TEST_F(ProjectParts, TheUnitOfLengths)
{
    keep_units_in_projects();
    keep_units_in_projects();  // once
    EXPECT_EQ(chosen_unit(scene_of(document)), std::nullopt);
    EXPECT_EQ(with_parts(project, scene_of(document)), project);
    for (const char* symbol : {"ftUS", ""}) {
        choose_unit(scene_of(document), symbol);
        const QByteArray file = with_parts(project, scene_of(document));
        EXPECT_EQ(file.count("<PointCloudLengthUnit>"), 1) << file.toStdString();
        MetDocument other;
        take_parts(file, scene_of(other));
        EXPECT_EQ(chosen_unit(scene_of(other)), std::string(symbol));
    }
    EXPECT_THROW(choose_unit(scene_of(document), "yard"), Error);
    MetDocument other;
    take_parts(QByteArray(with_parts(project, scene_of(document))).replace("unknown", "yard"), scene_of(other));
    EXPECT_EQ(chosen_unit(scene_of(other)), std::nullopt);
}

TEST_F(ProjectParts, AnElementOfTheProject)
{
    kept()["TestPartOne"] = "a < b";
    EXPECT_EQ(with_parts(project, scene_of(document)),
              "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup/>\n<TestPartOne>a &lt; b</TestPartOne>\n"
              "</MeshLabProject>\n");
}

TEST_F(ProjectParts, AnyTextComesBack)
{
    round_trip("{\"name\":\"</TestPartOne>\\n & <TestPartTwo>\"}",
               QString::fromUtf8("Straße\r\n\t\"ü\" \U0001F600  ]]>"));
}

TEST_F(ProjectParts, ANewTextTakesThePlaceOfTheOldOne)
{
    kept() = {{"TestPartOne", "first"}, {"TestPartTwo", "stays"}};
    const QByteArray first = with_parts(project, scene_of(document));
    kept()["TestPartOne"] = "second";
    const QByteArray second = with_parts(first, scene_of(document));
    EXPECT_EQ(second.count("<TestPartOne>"), 1);
    EXPECT_EQ(second.count("<TestPartTwo>"), 1);
    take_parts(second, scene_of(document));
    EXPECT_EQ(kept()["TestPartOne"], "second");
    kept()["TestPartOne"] = "";
    kept()["TestPartTwo"] = "";
    EXPECT_EQ(with_parts(second, scene_of(document)), project);
}

TEST_F(ProjectParts, WhatCannotBeReadIsLoggedAndKept)
{
    const QByteArray file = QByteArray(project).replace(
        "</MeshLabProject>",
        "<TestPartOne>unreadable</TestPartOne>\n<TestPartTwo>good</TestPartTwo>\n</MeshLabProject>");
    take_parts(file, scene_of(document));
    EXPECT_EQ(kept()["TestPartOne"], "");
    EXPECT_EQ(kept()["TestPartTwo"], "good");
    EXPECT_TRUE(log().contains("<TestPartOne> of the project cannot be read")) << log().toStdString();
    EXPECT_TRUE(log().contains("not a list"));
    EXPECT_TRUE(with_parts(project, scene_of(document)).contains("<TestPartOne>unreadable</TestPartOne>"));
    kept()["TestPartOne"] = "new";
    EXPECT_TRUE(with_parts(project, scene_of(document)).contains("<TestPartOne>new</TestPartOne>"));
}

TEST_F(ProjectParts, WhatCannotBeWrittenIsLoggedAndTheOthersAreKept)
{
    kept() = {{"TestPartOne", "unwritable"}, {"TestPartTwo", "good"}};
    const QByteArray file = with_parts(project, scene_of(document));
    EXPECT_TRUE(file.contains("<TestPartTwo>good</TestPartTwo>"));
    EXPECT_TRUE(log().contains("<TestPartOne> of the project cannot be saved"));
}

TEST_F(ProjectParts, WhatIsNoProjectGivesNothing)
{
    take_parts("<MeshLabProject><TestPartOne>text", scene_of(document));
    EXPECT_EQ(kept()["TestPartOne"], "");
}

}  // namespace
