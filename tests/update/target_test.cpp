#include "pcm/update/target.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/unfinished_build.h"
#include "pcm/update/append.h"
#include "pcm/update/erase.h"
#include "tests/update/model.h"

#include <fstream>
#include <iterator>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// The bytes of every file of a folder, by name.
std::map<std::string, std::string> contents(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        std::ifstream file(entry.path(), std::ios::binary);
        files[entry.path().filename().string()] = {std::istreambuf_iterator<char>(file), {}};
    }
    return files;
}

std::size_t entries_of(const fs::path& folder)
{
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

ErrorCode refusal_of(const fs::path& tree, const TargetChoice& choice)
{
    try {
        const UpdateTarget target(tree, choice);
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "not refused";
    return ErrorCode::io;
}

ErrorCode opening(const fs::path& tree)
{
    try {
        Tree::open(tree);
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "opened";
    return ErrorCode::io;
}

class Target : public testing::Test {
protected:
    Target() { build(surface(5000, 0, 0, 50, 7), tree_); }

    // Deletes the points of three of the eight classes.
    EraseReport erase_some(const fs::path& path)
    {
        Selection selection;
        selection.where.push_back(parse_condition("classification = 0,1,2"));
        return erase_points(path, selection);
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "tree.pct", copy_ = folder_ / "copy.pct";
};

TEST_F(Target, InPlaceIsTheTreeItself)
{
    EraseReport report;
    {
        UpdateTarget target(tree_, {{}, true});
        EXPECT_EQ(target.path(), tree_);
        EXPECT_FALSE(target.is_copy());
        report = target.update([&](const fs::path& folder) {
            EXPECT_EQ(folder, tree_);
            return erase_some(folder);
        });
    }
    ASSERT_GT(report.points_deleted, 0u);
    EXPECT_EQ(Tree::open(tree_)->info().points, 5000 - report.points_deleted);
    EXPECT_EQ(entries_of(folder_.path()), 1u);
}

TEST_F(Target, TheCopyHasTheUpdateAndTheOriginalHasNot)
{
    const auto before = contents(tree_);
    EraseReport report;
    {
        UpdateTarget target(tree_, {copy_, false});
        EXPECT_EQ(target.path(), copy_);
        EXPECT_TRUE(target.is_copy());
        report = target.update([&](const fs::path& folder) {
            EXPECT_FALSE(fs::exists(copy_));
            const EraseReport erased = erase_some(folder);
            EXPECT_FALSE(fs::exists(copy_));  // only when all is done
            EXPECT_EQ(opening(copy_), ErrorCode::not_found);
            EXPECT_EQ(opening(build_folder_of(copy_)), ErrorCode::interrupted_build);
            return erased;
        });
        EXPECT_TRUE(report.outcome.warnings.empty());
        EXPECT_TRUE(fs::exists(copy_));
    }
    EXPECT_EQ(entries_of(folder_.path()), 2u);
    ASSERT_GT(report.points_deleted, 0u);
    EXPECT_EQ(Tree::open(copy_)->info().points, 5000 - report.points_deleted);
    EXPECT_TRUE(verify_tree(copy_, 1).faults.empty());
    EXPECT_TRUE(contents(tree_) == before);
}

TEST_F(Target, ACopyIsRemovedWhenTheUpdateFails)
{
    const auto before = contents(tree_);
    const auto fail = [&] {
        MemoryCloud other = surface(10, 0, 0, 50, 8);
        other.info.grid = Grid{{0.003, 0.003, 0.003}, {0, 0, 0}};  // not the tree's grid
        MemoryReader reader(other);
        UpdateTarget target(tree_, {copy_, false});
        target.update([&](const fs::path& work) { return append_points(work, reader, {"other.las"}); });
    };
    EXPECT_THROW(fail(), Error);
    EXPECT_FALSE(fs::exists(copy_));
    EXPECT_EQ(entries_of(folder_.path()), 1u);
    EXPECT_TRUE(contents(tree_) == before);
}

TEST_F(Target, OneOfTheTwoMustBeChosen)
{
    EXPECT_EQ(refusal_of(tree_, {}), ErrorCode::invalid_argument);
    EXPECT_EQ(refusal_of(tree_, {copy_, true}), ErrorCode::invalid_argument);
    EXPECT_FALSE(fs::exists(copy_));
}

// The old tree has the name until the work on the new one is done.
TEST_F(Target, ATreeOfTheNameIsReplacedWhenThatIsAsked)
{
    build(surface(700, 0, 0, 10, 2), copy_);
    const auto old = contents(copy_);
    EXPECT_EQ(refusal_of(tree_, {copy_, false}), ErrorCode::exists);
    EXPECT_THROW(check_target(tree_, {copy_, false}), Error);
    check_target(tree_, {copy_, false, true});
    EXPECT_TRUE(contents(copy_) == old);
    try {
        UpdateTarget(tree_, {copy_, false, true}).update([&](const fs::path&) -> EraseReport {
            throw Error(ErrorCode::no_space, copy_, "no space");
        });
        ADD_FAILURE();
    } catch (const Error&) {
    }
    EXPECT_TRUE(contents(copy_) == old);
    UpdateTarget target(tree_, {copy_, false, true});
    const EraseReport report = target.update([&](const fs::path& folder) {
        EXPECT_TRUE(contents(copy_) == old);
        return erase_some(folder);
    });
    EXPECT_GT(report.points_deleted, 0u);
    EXPECT_EQ(Tree::open(copy_)->info().points, 5000 - report.points_deleted);
    EXPECT_EQ(entries_of(folder_.path()), 2u);
}

TEST_F(Target, NeverRemovesWhatItHasNotMade)
{
    const auto before = contents(tree_);
    fs::create_directory(copy_);
    std::ofstream(copy_ / "letter.txt") << "not a tree";
    EXPECT_EQ(refusal_of(tree_, {copy_, false}), ErrorCode::exists);
    EXPECT_TRUE(fs::exists(copy_ / "letter.txt"));
    EXPECT_EQ(refusal_of(tree_, {copy_, false, true}), ErrorCode::exists);
    // A copy of a tree onto itself.
    EXPECT_EQ(refusal_of(tree_, {tree_, false}), ErrorCode::invalid_argument);
    EXPECT_EQ(refusal_of(tree_, {tree_, false, true}), ErrorCode::invalid_argument);
    EXPECT_TRUE(fs::exists(copy_ / "letter.txt"));
    EXPECT_TRUE(contents(tree_) == before);
}

TEST_F(Target, ErrorsOfTheTreeComeFirst)
{
    EXPECT_EQ(refusal_of(folder_ / "none.pct", {copy_, false}), ErrorCode::not_found);
    EXPECT_FALSE(fs::exists(copy_));
}

// What is read is the original's, what is written is the copy's: nobody can look at the working folder afterwards.
TEST_F(Target, ErrorsAndWarningsNameTheOriginalOrTheCopy)
{
    const auto message_of = [&](const auto& work) -> std::string {
        try {
            UpdateTarget target(tree_, {copy_, false});
            return target.update(work).outcome.warnings.at(0);
        } catch (const Error& error) {
            EXPECT_TRUE(fs::exists(error.path().parent_path())) << error.path();
            return error.what();
        }
    };
    const std::string original = tree_.string(), copy = copy_.string();
    EXPECT_EQ(message_of([](const fs::path& folder) -> EraseReport {
                  throw Error(ErrorCode::corrupt, folder / "chunks-000.bpc", "a checksum is wrong", "repair it");
              }),
              original + "/chunks-000.bpc: a checksum is wrong (repair it)");
    EXPECT_EQ(message_of([](const fs::path& folder) -> EraseReport {
                  throw Error(ErrorCode::no_space, folder, "writing failed", "see " + folder.string());
              }),
              copy + ": writing failed (see " + copy + ")");
    EXPECT_FALSE(fs::exists(copy_));
    EXPECT_EQ(message_of([](const fs::path& folder) {
                  EraseReport report;
                  report.outcome.warnings = {folder.string() + "/x could not be removed"};
                  return report;
              }),
              copy + "/x could not be removed");
    EXPECT_TRUE(fs::exists(copy_));
}

// As a process leaves it that is killed during the work.
TEST_F(Target, TheRemainsOfAnInterruptedCopyAreReplaced)
{
    const fs::path part = build_folder_of(copy_);
    fs::create_directory(part);
    std::ofstream(part / "building");
    fs::copy(tree_, part / "tree", fs::copy_options::recursive);
    std::ofstream(part / "tree" / "chunks-001.bpc") << "half";
    EXPECT_EQ(opening(copy_), ErrorCode::not_found);
    UpdateTarget target(tree_, {copy_, false});
    const EraseReport report = target.update([&](const fs::path& folder) { return erase_some(folder); });
    EXPECT_EQ(Tree::open(copy_)->info().points, 5000 - report.points_deleted);
    EXPECT_TRUE(verify_tree(copy_, 1).faults.empty());
    EXPECT_EQ(entries_of(folder_.path()), 2u);
}

TEST_F(Target, TwoAtOnceDoNotWriteTheSameCopy)
{
    UpdateTarget target(tree_, {copy_, false});
    EXPECT_EQ(refusal_of(tree_, {copy_, false}), ErrorCode::exists);
    target.update([&](const fs::path& folder) { return erase_some(folder); });
    EXPECT_TRUE(verify_tree(copy_, 1).faults.empty());
}

}  // namespace
