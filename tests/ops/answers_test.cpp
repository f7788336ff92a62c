// What operations answer: the head and the keys that their rows describe, with these types, and no others.
#include "pcm/ops/operation.h"
#include "pcm/ops/render_request.h"

#include "tests/answer_faults.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include "pcm/build/builder.h"
#include "pcm/cad/primitive_files.h"
#include "pcm/point_cloud.h"
#include "pcm/query/point_set.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>

namespace {

using namespace pcm::ops;
namespace fs = std::filesystem;

// How each operation of the table is called here: arguments by key. A row without a call fails the test.
using Call = std::map<std::string, std::vector<std::string>>;
using Calls = std::map<std::string, Call>;

Calls calls(const std::string& tree, const std::string& folder)
{
    const std::string file = folder + "/cloud.las";
    return {
        {"build", {{"input", {file}}, {"output", {folder + "/built.pct"}}, {"normals", {"8"}}}},
        {"convert", {{"paths", {tree, folder + "/converted.laz"}}}},
        {"info", {{"input", {tree}}, {"statistics", {"on"}}}},
        {"verify", {{"tree", {tree}}, {"levels", {"on"}}}},
        {"append", {{"tree", {tree}}, {"input", {file}}, {"output", {folder + "/more.pct"}}}},
        {"compact", {{"tree", {tree}}, {"output", {folder + "/compact.pct"}}}},
        {"delete", {{"tree", {tree}}, {"where", {"intensity>=0"}}, {"output", {folder + "/none.pct"}}}},
        {"repair", {{"tree", {tree}}, {"check", {"on"}}}},
        {"transform", {{"tree", {tree}}, {"output", {folder + "/moved.pct"}}, {"translate", {"1", "2", "3"}}}},
        {"align",
         {{"moving", {tree}},
          {"fixed", {tree}},
          {"pair",
           {"512345", "4812345", "100", "512346", "4812345", "100", "512445", "4812345", "100", "512446", "4812345",
            "100", "512345", "4812445", "100", "512346", "4812445", "100"}}}},
        {"merge", {{"output", {folder + "/merged.pct"}}, {"trees", {tree, tree}}}},
        {"voxel", {{"input", {tree}}, {"size", {"1"}}, {"output", {folder + "/voxels.pct"}}}},
        {"subsample", {{"input", {file}}, {"points", {"1000"}}, {"output", {folder + "/thinned.pct"}}}},
        {"run",
         {{"input", {tree}}, {"delete", {"intensity>=1000"}}, {"normals", {"8"}}, {"output", {folder + "/chain.laz"}}}},
        {"generate", {{"output", {folder + "/scene.las"}}, {"points", {"2000"}}, {"truth", {"off"}}}},
        {"radii", {{"tree", {tree}}, {"output", {folder + "/radii.pct"}}}},
        {"normals", {{"tree", {tree}}, {"output", {folder + "/normals.pct"}}, {"radii", {"on"}}}},
        {"outliers", {{"tree", {tree}}, {"output", {folder + "/clean.pct"}}}},
        {"query", {{"tree", {tree}}, {"statistics", {"on"}}}},
        {"pick", {{"tree", {tree}}, {"ray", {"512345", "4812345", "500", "0", "0", "-1"}}}},
        {"select",
         {{"tree", {tree}}, {"where", {"intensity>=0"}}, {"classify", {"6"}}, {"output", {folder + "/classes.pct"}}}},
        {"save_selected", {{"output", {folder + "/saved.pct"}}}},
        {"extract_selected", {{"output", {folder + "/part.xyz"}}}},
        {"classify_selected", {{"value", {"7"}}, {"output", {folder + "/noise.pct"}}}},
        {"delete_selected", {{"output", {folder + "/without.pct"}}}},
        {"fit", {{"tree", {tree}}, {"at", {"512345", "4812345", "100"}}}},
        {"set", {{"tree", {tree}}, {"new", {"height:f32"}}, {"values", {"height=2"}}, {"statistics", {"on"}}}},
        {"detect", {{"tree", {tree}}, {"label", {"shape"}}, {"output", {folder + "/labelled.pct"}}}},
        {"measure", {{"kind", {"distance"}}, {"points", {"0", "0", "0", "3", "4", "0"}}, {"from", {tree}}}},
        {"profile", {{"tree", {tree}}, {"line", {"512300", "4812345", "512400", "4812345"}}}},
        {"volume", {{"tree", {tree}}, {"reference", {"90"}}}},
        {"primitives", {{"list", {folder + "/list.json"}}, {"output", {folder + "/list.csv"}}}}};
}

Result exact_result()
{
    Result result;
    result.accuracy = exact_answer();
    return result;
}

class Answers : public testing::Test {
protected:
    Answers()
    {
        tree_ = (folder_ / "cloud.pct").string();
        pcm::Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.offset = {512345, 4812345, 100};
        pcm::test::write_las(folder_ / "cloud.las", pcm::test::records(pcm::test::Shape::surface, 3000, 3), grid);
        pcm::BuildOptions small;
        small.chunk_points = pcm::least_chunk_points;  // so that there are several levels
        pcm::build_tree({folder_ / "cloud.las"}, tree_, small);
        pcm::Primitive ball;
        ball.name = "Ball";
        ball.fit.verdict = pcm::FitVerdict::good;
        ball.fit.shape.kind = pcm::ShapeKind::sphere;
        ball.fit.shape.radius = 1;
        pcm::write_primitives(folder_ / "list.json", {ball});
    }
    Json answer_of(const Row& row, const Call& call, const pcm::ProgressFunction& progress = {})
    {
        const auto operation = row.make();
        for (const auto& [key, words] : call) {
            Argument* const argument = operation->arguments().find(key);
            if (!argument) throw std::logic_error(std::string(row.name) + " has no argument " + key);
            if (argument->kind() == ValueKind::flag)
                argument->set(words[0] == "on");
            else
                argument->set(words, key);
        }
        Context with = context();
        with.progress = progress;
        return json_of(row.name, operation->run(with));
    }
    // As in a window that has selected all points.
    Context context() const
    {
        Context context;
        context.window.cloud = pcm::PointCloud::open(tree_);
        pcm::PointSet all(context.window.cloud->tree());
        all.invert();
        context.window.selected = std::make_shared<const pcm::PointSet>(std::move(all));
        return context;
    }

    pcm::test::TemporaryFolder folder_;
    std::string tree_;
};

TEST_F(Answers, HaveTheKeysOfTheirRows)
{
    const Calls all = calls(tree_, folder_.path().string());
    for (const Row& row : operations()) {
        SCOPED_TRACE(row.name);
        if (std::string(row.name) == "render") continue;  // tests/cli/render_test.cpp: it needs OpenGL
        const auto call = all.find(row.name);
        ASSERT_NE(call, all.end()) << "this test does not call it";
        const Json answer = answer_of(row, call->second);
        EXPECT_EQ(pcm::test::faults_of_answer(row, answer), "");
        EXPECT_EQ(answer["command"], row.name);
        EXPECT_GT(answer["seconds"], 0);
        EXPECT_GT(answer["cpu_seconds"], 0);
        EXPECT_GT(answer["peak_memory"], 1000000);
        // What needs no point, or has it from the index.
        const std::set<std::string> without_points{"info", "generate", "measure", "primitives", "repair"};
        if (!without_points.count(row.name)) EXPECT_GT(answer["points_read"], 0);
    }
}

// A row that traded something says what, in the words of accuracy.h.
TEST_F(Answers, SayWhatTheyTraded)
{
    struct Case {
        std::string operation;
        Call call;
        std::string kind, unit;
    };
    const std::string file = (folder_ / "cloud.las").string(), out = (folder_ / "out.pct").string();
    const Call level{{"tree", {tree_}}, {"level", {"0"}}};
    const auto with = [](Call call, const std::string& key, const std::vector<std::string>& words) {
        call[key] = words;
        return call;
    };
    const std::vector<Case> cases{
        {"query", {{"tree", {tree_}}}, "exact", ""},
        {"query", level, "bound", "source units"},
        {"query", {{"tree", {tree_}}, {"error_target", {"50"}}}, "bound", "source units"},
        {"query", {{"tree", {tree_}}, {"error_target", {"0"}}}, "exact", ""},
        {"query", with(level, "nearest", {"512345", "4812345", "100"}), "bound", "source units"},
        {"query",
         {{"tree", {tree_}}, {"estimate", {"on"}}, {"region", {"sphere 512345 4812345 100 20"}}},
         "bound",
         "points"},
        {"select", level, "bound", "source units"},
        {"profile", with(level, "line", {"512300", "4812345", "512400", "4812345"}), "bound", "source units"},
        {"set", with(level, "new", {"height:f32"}), "bound", "source units"},
        {"convert", {{"paths", {tree_, (folder_ / "a.laz").string()}}, {"level", {"0"}}}, "bound", "source units"},
        {"convert",
         {{"paths", {tree_, (folder_ / "b.laz").string()}}, {"max_points", {"500"}}},
         "bound",
         "source units"},
        {"convert", {{"paths", {tree_, (folder_ / "c.laz").string()}}, {"grid", {"0.3"}}}, "bound", "source units"},
        {"convert", {{"paths", {tree_, (folder_ / "d.laz").string()}}}, "exact", ""},
        {"radii", {{"tree", {tree_}}, {"output", {(folder_ / "r.pct").string()}}}, "exact", ""},
        {"subsample",
         {{"input", {tree_}}, {"spacing", {"3"}}, {"exact", {"off"}}, {"output", {(folder_ / "s.pct").string()}}},
         "bound",
         "source units"},
        {"subsample",
         {{"input", {tree_}}, {"spacing", {"3"}}, {"output", {(folder_ / "t.pct").string()}}},
         "exact",
         ""},
        {"subsample",
         {{"input", {tree_}}, {"points", {"500"}}, {"exact", {"off"}}, {"output", {(folder_ / "u.pct").string()}}},
         "bound",
         "points"},
        {"volume", {{"tree", {tree_}}, {"reference", {"90"}}}, "95 %", "source units^3"},
        {"measure",
         {{"kind", {"distance"}},
          {"points", {"512345", "4812345", "100", "512355", "4812345", "100"}},
          {"from", {tree_}}},
         "95 %",
         "source units"},
        {"info", {{"input", {(folder_ / "cloud.xyz").string()}}}, "estimated", "points"},
        {"run",
         {{"input", {tree_}}, {"subsample", {"3,nearest-level"}}, {"output", {(folder_ / "v.pct").string()}}},
         "bound",
         "source units"},
    };
    answer_of(*find_operation("convert"), {{"paths", {tree_, (folder_ / "cloud.xyz").string()}}});
    for (const Case& one : cases) {
        const Json answer = answer_of(*find_operation(one.operation), one.call);
        SCOPED_TRACE(one.operation + " " + answer.dump().substr(0, 300));
        EXPECT_EQ(pcm::test::faults_of_answer(*find_operation(one.operation), answer), "");
        EXPECT_EQ(answer["error_kind"], one.kind);
        EXPECT_EQ(answer["error_unit"], one.unit);
    }
}

TEST_F(Answers, OfALevelHaveTheErrorThatWasAskedFor)
{
    const Row& row = *find_operation("query");
    double before = 1e9;
    for (const char* const target : {"50", "20", "8", "0.001"}) {
        const Json answer = answer_of(row, {{"tree", {tree_}}, {"error_target", {target}}});
        EXPECT_LE(answer["error"], std::stod(target));
        EXPECT_LE(answer["error"], before);
        before = answer["error"];
    }
    EXPECT_EQ(before, 0) << "all points";
    EXPECT_THROW(answer_of(row, {{"tree", {tree_}}, {"error_target", {"1"}}, {"level", {"0"}}}), ArgumentError);
}

TEST_F(Answers, AreRefusedWithoutAWordOnTheirAccuracy)
{
    const auto operation = find_operation("render")->make();
    operation->arguments().find("trees")->set({tree_}, "trees");
    Context context;
    context.render = [](const RenderRequest&) { return Result(); };
    EXPECT_THROW(operation->run(context), std::logic_error);
}

TEST(Accuracy, OfAChainIsTheSumOfWhatIsAlike)
{
    const Accuracy a = bounded(0.5, "coordinates"), b = bounded(0.25, "coordinates"), none = exact_answer();
    EXPECT_EQ(of_steps({none, none}).kind, ErrorKind::exact);
    EXPECT_EQ(of_steps({none, a}).error, 0.5);
    EXPECT_EQ(of_steps({a, none, b}).error, 0.75);
    EXPECT_EQ(of_steps({a, b}).kind, ErrorKind::bound);
    EXPECT_EQ(of_steps({a, from_deviation(1, "source units", "coordinates")}).kind, ErrorKind::estimated);
    EXPECT_FALSE(std::isfinite(of_steps({a, bounded(1, "the spacing")}).error));
    EXPECT_EQ(text_of(none), "error 0 (exact)");
    EXPECT_EQ(text_of(a), "error 0.5 source units (bound, of coordinates)");
    EXPECT_EQ(text_of(from_deviation(1, "degrees", "the axis")), "error 1.96 degrees (95 %, of the axis)");
    EXPECT_NEAR(from_deviation(1, "m", "a place", 2).error, std::sqrt(-2 * std::log(0.05)), 1e-6) << "Rayleigh";
    EXPECT_NEAR(from_deviation(2, "m", "a place", 3).error, 2 * 2.7955, 1e-4);
    EXPECT_EQ(text_of(bounded(INFINITY, "the spacing")), "error not known (bound, of the spacing)");
}

// Cancelled at its first report of progress; what it works on is not changed.
TEST_F(Answers, OperationsThatWriteTreesReportProgressAndCanBeCancelled)
{
    const Calls all = calls(tree_, folder_.path().string());
    for (const char* const name :
         {"append", "compact", "delete", "transform", "merge", "voxel", "radii", "normals", "outliers", "run"}) {
        SCOPED_TRACE(name);
        int reports = 0;
        const auto cancel = [&](const pcm::ProgressUpdate&) { return ++reports < 1; };
        try {
            answer_of(*find_operation(name), all.at(name), cancel);
            ADD_FAILURE() << "not cancelled; " << reports << " reports";
        } catch (const pcm::Error& error) {
            EXPECT_EQ(error.code(), pcm::ErrorCode::cancelled) << error.what();
        }
        EXPECT_GE(reports, 1);
        const std::string output = all.at(name).at("output")[0];
        EXPECT_FALSE(fs::exists(output)) << output;
    }
}

TEST_F(Answers, OfARenderingAreWhatDraws)
{
    const Row& row = *find_operation("render");
    const auto operation = row.make();
    Arguments& arguments = operation->arguments();
    arguments.find("trees")->set({tree_}, "trees");
    arguments.find("output")->set({"picture.png"}, "output");
    arguments.find("clip")->set({"sphere 0 0 0 1"}, "clip");
    arguments.find("ramp")->set({"turbo"}, "ramp");
    arguments.find("gamma")->set({"1.8"}, "gamma");
    EXPECT_THROW(operation->run({}), pcm::Error) << "nothing draws";
    Context context;
    context.render = [](const RenderRequest& request) {
        EXPECT_EQ(request.output, "picture.png");
        EXPECT_EQ(request.style.ramp, pcm::ColourRamp::turbo);
        EXPECT_EQ(request.style.gamma, 1.8f);
        EXPECT_EQ(request.style.splats, pcm::SplatMode::fitted);
        EXPECT_EQ(request.limits.clips.size(), 1u);
        EXPECT_EQ(request.options.smooth_frames, pcm::usual_smooth_frames);
        Result result = exact_result();
        result.input = request.trees;
        return result;
    };
    EXPECT_EQ(operation->run(context).input, std::vector<std::string>{tree_});
    arguments.find("discs")->set(true);
    context.render = [](const RenderRequest& request) {
        EXPECT_EQ(request.style.splats, pcm::SplatMode::perspective);
        return exact_result();
    };
    operation->run(context);
    arguments.find("splats")->set({"constant"}, "splats");
    EXPECT_THROW(operation->run(context), ArgumentError);
}

TEST_F(Answers, OfARenderingHaveOneKindOfCamera)
{
    const auto operation = find_operation("render")->make();
    operation->arguments().find("path")->set({"tour.json"}, "path");
    operation->arguments().find("eye")->set({"1", "2", "3"}, "eye");
    Context context;
    context.render = [](const RenderRequest&) { return Result(); };
    EXPECT_THROW(operation->run(context), ArgumentError);
}

TEST_F(Answers, AreOfTheSelectedPointsAlone)
{
    const auto operation = find_operation("classify_selected")->make();
    operation->arguments().find("output")->set({(folder_ / "out.pct").string()}, "output");
    EXPECT_THROW(operation->run({}), pcm::Error) << "nothing is selected";
    EXPECT_FALSE(fs::exists(folder_ / "out.pct"));
}

TEST_F(Answers, ErrorsNameCodePathAndHint)
{
    const pcm::Error error(pcm::ErrorCode::not_found, "a/b.las", "there is no such file", "look elsewhere");
    const Json json = json_of_error(error)["error"];
    EXPECT_EQ(json["code"], "not_found");
    EXPECT_EQ(json["path"], "a/b.las");
    EXPECT_EQ(json["hint"], "look elsewhere");
    EXPECT_EQ(json["text"], error.what());
    EXPECT_EQ(json_of_error(ArgumentError("x"))["error"]["code"], "usage");
    EXPECT_EQ(json_of_error(std::runtime_error("x"))["error"]["code"], "failed");
    EXPECT_TRUE(json_of_error(std::runtime_error("x"))["error"]["path"].is_null());
}

}  // namespace
