// Steps of a chain: which arguments of an operation the values in one word set.
#include "pcm/ops/shared/step.h"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

namespace {

using namespace pcm::ops;

// An operation with an argument of each kind that a step may set.
class Example : public Operation {
public:
    Example()
    {
        arguments_.add("tree", tree).as(ValueKind::tree).positional().required();
        arguments_.add("count", count);
        arguments_.add("factor", factor);
        arguments_.add("shift", shift).count(3);
        arguments_.add("where", where).as(ValueKind::texts);
        arguments_.add("names", names);
        arguments_.add("label", label);
        arguments_.add("confidence", confidence);
        arguments_.add("output", output).as(ValueKind::output_tree);
        arguments_.add("layer", layer).only(Face::dialog);
    }
    Result answer(const Context&) override { return {}; }

    std::string tree, output, layer;
    std::uint32_t count = 1;
    double factor = 1;
    std::vector<double> shift;
    std::vector<std::string> where, names;
    bool label = false, confidence = true;
};

Row row_with(std::vector<std::string> step)
{
    return {"example", nullptr, "An example", "An example", 0, nullptr, {}, nullptr, std::move(step)};
}

std::string fault_of(const std::string& values, std::vector<std::string> step = {"count", "factor"})
{
    Example example;
    try {
        set_step(row_with(std::move(step)), example, values);
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
}

TEST(Step, TakesValuesInTheOrderOfItsRowAndThenNames)
{
    Example example;
    set_step(row_with({"count", "factor"}), example, "16,3");
    EXPECT_EQ(example.count, 16u);
    EXPECT_EQ(example.factor, 3);
    Example other;
    set_step(row_with({"count", "factor"}), other, "8,where=classification=2,6,label,shift=1,-2,3e1,names=a,b");
    EXPECT_EQ(other.count, 8u);
    EXPECT_EQ(other.factor, 1) << "its default";
    EXPECT_EQ(other.where, std::vector<std::string>{"classification=2,6"});
    EXPECT_TRUE(other.label);
    EXPECT_TRUE(other.confidence);
    EXPECT_EQ(other.shift, (std::vector<double>{1, -2, 30}));
    EXPECT_EQ(other.names, (std::vector<std::string>{"a", "b"}));
}

TEST(Step, SwitchesFlagsOnAndOff)
{
    Example example;
    set_step(row_with({"count"}), example, "no-confidence");
    EXPECT_FALSE(example.confidence);
    set_step(row_with({"count"}), example, "2,confidence");
    EXPECT_TRUE(example.confidence);
    EXPECT_EQ(fault_of("label=1"), "label takes no value");
}

TEST(Step, ReadsAListOrATextWithCommasWithoutItsName)
{
    Example example;
    set_step(row_with({"shift", "count"}), example, "1,2,3,4");
    EXPECT_EQ(example.shift, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(example.count, 4u);
    set_step(row_with({"where"}), example, "classification=2,6");
    EXPECT_EQ(example.where, std::vector<std::string>{"classification=2,6"});
    set_step(row_with({"where"}), example, "where=count=2..3");
    EXPECT_EQ(example.where, std::vector<std::string>{"count=2..3"}) << "an attribute named like an argument";
}

TEST(Step, SaysWhichValueIsWrong)
{
    EXPECT_EQ(fault_of("x,3"), "count: 'x' is not a whole number");
    EXPECT_EQ(fault_of("16,x"), "factor: 'x' is not a number");
    EXPECT_EQ(fault_of("16,3,4"), "'4' is one value too many: it takes count,factor, then NAME=VALUE");
    EXPECT_EQ(fault_of("count=16,3"), "'3' is one value too many: it takes count,factor, then NAME=VALUE");
    EXPECT_EQ(fault_of("factr=3"), "it has no argument 'factr'; perhaps factor");
    EXPECT_EQ(fault_of("16,3,labl"), "it has no argument 'labl'; perhaps label");
    EXPECT_EQ(fault_of("16,count=3"), "count is given twice");
    EXPECT_EQ(fault_of("16,"), "a value is missing: it takes count,factor, then NAME=VALUE");
    EXPECT_EQ(fault_of(""), "a value is missing: it takes count,factor, then NAME=VALUE");
    EXPECT_NE(fault_of("shift=1,2"), "") << "three numbers are needed";
}

TEST(Step, LeavesInputAndOutputToTheChain)
{
    for (const char* const name : {"tree", "output", "layer"})
        EXPECT_EQ(fault_of(std::string(name) + "=x").rfind("it has no argument '" + std::string(name) + "'", 0), 0u);
}

TEST(Step, NeedsWhatTheOperationNeeds)
{
    const Row& voxel = *find_operation("voxel");
    const auto operation = voxel.make();
    try {
        set_step(voxel, *operation, "count");
        FAIL() << "no size is given";
    } catch (const ArgumentError& error) {
        EXPECT_STREQ(error.what(), "size is needed");
    }
}

// The rows of the table that are steps: what they take without names exists, and they have an input.
TEST(Step, IsARowWhoseArgumentsExist)
{
    std::size_t steps = 0;
    const auto chain = find_operation("run")->make();
    for (const Row& row : operations()) {
        SCOPED_TRACE(row.name);
        const Argument* const argument = chain->arguments().find(row.name);
        EXPECT_EQ(row.step.empty(), argument == nullptr);
        EXPECT_EQ(usage_of(row)["step"].size(), row.step.size());
        if (row.step.empty()) continue;
        ++steps;
        EXPECT_EQ(argument->kind(), ValueKind::step);
        const auto operation = row.make();
        EXPECT_TRUE(input_of_step(*operation).is_required());
        for (const std::string& key : row.step) {
            const Argument* const value = operation->arguments().find(key);
            ASSERT_NE(value, nullptr) << key;
            EXPECT_TRUE(value->is_in(Face::command)) << key;
            EXPECT_NE(value->kind(), ValueKind::flag) << key;
        }
    }
    EXPECT_GE(steps, 8u);
}

}  // namespace
