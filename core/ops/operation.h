// The table of operations: what a person can do with a point cloud, described once.
//
// An operation is one source in this folder, with a class that declares its arguments in its constructor and a row in
// operations.cpp. The command line (cli/operation_command.h), MeshLab's filters, `pcmlab help --json`, man pages and
// completion are made of the rows.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/clip.h"
#include "pcm/ops/argument.h"
#include "pcm/ops/result.h"
#include "pcm/system/progress.h"
#include "pcm/system/work_done.h"
#include "pcm/update/target.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {
class PointCloud;
class PointSet;
class Team;
struct FittedPrimitive;
struct Primitive;
}  // namespace pcm

namespace pcm::ops {

struct RenderRequest;

// Radii by compute shaders (gl/compute/gpu_radii.h), of a face that has OpenGL.
struct GpuRadiiRequest {
    std::string tree;
    TargetChoice target;
    std::uint32_t neighbours;
    std::uint64_t memory_bytes;
};

// A layer of the window that shows a tree.
struct Layer {
    std::string label;
    std::filesystem::path tree;
    std::optional<Affine> map;  // its matrix, in source coordinates; absent: it has none
    bool visible = true, current = false;
};

// The primitives that a window has, and the unit of their coordinates: a symbol such as "m", or empty.
struct WindowPrimitives {
    std::vector<Primitive> primitives;
    std::string unit;
    std::vector<std::string> notes;
};

// What a window has and a command line has not: its members are then empty.
struct Window {
    std::function<std::shared_ptr<PointCloud>(const std::string& tree)> open;  // a cloud that it may have open already
    std::function<void(const std::string& tree)> refuse_change;                // throws for a tree that may not change
    std::optional<Clip> clip;                                                  // on the tree's layer, switched on
    // The current layer's cloud, its selected points, and how others are selected; `how` is for lists of steps.
    std::shared_ptr<PointCloud> cloud;
    std::shared_ptr<const PointSet> selected;
    std::function<void(PointSet points, const std::string& how)> select;
    // The list of primitives takes what was found, and gives it names, colours and the name of its cloud.
    std::function<void(std::vector<Primitive>& found)> keep_primitives;
    std::function<void(FittedPrimitive& fitted)> keep_fit;
    // Its list of primitives: moved by the matrices of layers, and with those that are hidden.
    std::function<WindowPrimitives(bool moved, bool hidden_too)> primitives;
};

struct Context {
    Face face = Face::command;
    ProgressFunction progress;
    std::function<std::vector<Layer>()> layers;  // in the window's order; empty: this face has no layers
    // Moves the current layer, which must show the tree, by its matrix, and returns what was done, for people. `step`
    // is what undoing it is called. Empty: this face has no layers.
    std::function<std::string(const std::filesystem::path& tree, const Affine& motion, const std::string& step)>
        set_matrix;
    std::function<Result(const GpuRadiiRequest&)> gpu_radii;  // empty: this face has no such device
    std::function<Result(const RenderRequest&)> render;       // draws pictures; empty: this face has no OpenGL
    Team* team = nullptr;                                     // processes that work together; null: this one alone
    std::vector<std::string> words;                           // with them: the command line, the same in all
    Window window;
    bool keeps_levels = true;  // false: no note about the levels of the result, which another step replaces

    // Throws what PointCloud::open() throws.
    std::shared_ptr<PointCloud> open(const std::string& tree) const;
};

// One run of an operation: its arguments are set, then run() is called, once. Not thread safe; not copied, because
// arguments point into it.
class Operation {
public:
    virtual ~Operation() = default;
    Operation(const Operation&) = delete;
    Operation& operator=(const Operation&) = delete;

    Arguments& arguments() { return arguments_; }
    const Arguments& arguments() const { return arguments_; }
    // Throws ArgumentError for arguments that contradict each other, and what the library's function throws.
    Result run(const Context& context);

protected:
    Operation() = default;
    // The answer and its accuracy; run() adds what it took.
    virtual Result answer(const Context& context) = 0;
    // "--radius" or 'Radius'. Throws std::logic_error for an argument that is not declared.
    std::string called(const Context& context, const std::string& key) const;

    Arguments arguments_;
};
std::string called(Face face, const Argument& argument);

// Times a piece of work and counts what it reads, from construction to put_into().
class Meter {
public:
    void put_into(Result& result) const;

private:
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    const WorkDone before_ = work_done();
};

// The menus of MeshLab's filters, bits.
namespace menu {
inline constexpr unsigned create = 1, points = 2, sampling = 4, layers = 8, measure = 16, select = 32, quality = 64,
                          normals = 128, clean = 256;
}

struct Row {
    const char* name;     // the command, or, of a filter alone, its name here
    const char* title;    // in MeshLab, where scripts spell it too; null: it is a command alone
    const char* help;     // one line
    const char* details;  // for dialogs and manual pages; HTML's <b> and <i> may occur
    unsigned menus;
    const char* ending;              // names proposed for results end so: "-clean.pct"; null: none is proposed
    std::vector<ResultKey> results;  // besides head_keys()
    std::unique_ptr<Operation> (*make)();
    // Arguments that a step of a chain (shared/step.h) gives without their names, in this order; empty: it is not a
    // step.
    std::vector<std::string> step{};
    // Why it takes no argument time_limit or error_target, for people; null: it takes both.
    const char* limits = nullptr;
    bool window_only = false;  // works on what the window has selected: a filter, but not a command
};

// For an operation that has nothing to trade.
inline constexpr const char* always_exact =
    "It is exact: there is no time limit and no error target that it could trade for.";
inline constexpr const char* only_rounds =
    "It takes neither a time limit nor an error target: every point is read and written, and only coordinates are "
    "rounded, by the grid.";
// For an operation with LevelArguments.
inline constexpr const char* follows_from_points_read =
    "A time limit is not taken: the time is that of the points read, whose number query --estimate predicts; "
    "--error-target chooses fewer.";
// Its details and limits, with <b>, <i> and <br>.
std::string description_of(const Row& row);

// In the order of the help and of MeshLab's menus.
const std::vector<Row>& operations();
const Row* find_operation(const std::string& name);  // null: there is none
// Single rows, for a program that is not to contain the code of all: pcmlab-render.
Row radii_row();
Row render_row();

// All that a row says, for programs: name, title, help, details, limits, arguments (key, option, script, label, help,
// unit, type, default, least, most, choices, required, advanced, positional, list, on: whether it is a flag that is on
// by default), head and results (key, type, unit, help), step. Made from a new operation, so defaults are the real
// ones. `face`: only the arguments that it shows.
Json usage_of(const Row& row, std::optional<Face> face = {});

}  // namespace pcm::ops
