#include "plugin/scene/tree_beside.h"

#include "pcm/build/builder.h"
#include "pcm/tree/tree.h"
#include "plugin/scene/text.h"

#include <unistd.h>

#include <cstdint>
#include <cstdio>

namespace pcm::host {

namespace fs = std::filesystem;

fs::path tree_path(const fs::path& file, const fs::path& folder)
{
    fs::path tree = file;
    tree.replace_extension(tree_extension);
    if (folder.empty()) return tree;
    std::uint32_t hash = 2166136261u;  // FNV-1a
    for (const char c : fs::absolute(file).lexically_normal().string())
        hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    char digits[16];
    std::snprintf(digits, sizeof digits, "-%08x", static_cast<unsigned>(hash));
    return folder / (file.stem().string() + digits + "." + tree_extension);
}

bool tree_is_current(const fs::path& tree, const fs::path& file, std::optional<std::uint64_t> file_points)
{
    if (!is_tree(tree)) return false;
    std::shared_ptr<const Tree> opened;
    try {
        opened = Tree::open(tree);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::interrupted_build) return false;
        throw;
    }
    const TreeInfo& info = opened->info();
    if (info.sources.size() != 1 || fs::path(info.sources[0]).filename() != file.filename()) return false;
    if (file_points && info.points + info.points_skipped != *file_points) return false;
    std::error_code ignored;
    return fs::last_write_time(file, ignored) <= fs::last_write_time(tree / index_file_name, ignored);
}

namespace {

// Whether the tree was built from this file alone, so that replacing it loses nothing.
bool is_tree_of(const fs::path& tree, const fs::path& file)
{
    try {
        const auto opened = Tree::open(tree);
        return opened->info().sources.size() == 1 && fs::path(opened->info().sources[0]).filename() == file.filename();
    } catch (const Error& error) {
        return error.code() == ErrorCode::interrupted_build;
    }
}

// Whether all coordinates of the tree are within the limit, if there is one.
bool is_within(const fs::path& tree, const std::optional<double>& largest)
{
    if (!largest) return true;
    const TreeInfo info = Tree::open(tree)->info();
    const Box3d box = info.bounds();
    for (std::size_t a = 0; a < 3 && info.points; ++a)
        if (box.min[a] < -*largest || box.max[a] > *largest) return false;
    return true;
}

}  // namespace

std::vector<std::string> ensure_tree(const TreeBeside& wanted, const FileInfo& info, const ProgressFunction& progress)
{
    const fs::path &file = wanted.file, &tree = wanted.tree;
    const auto file_points = info.points_known ? std::optional(info.points) : std::nullopt;
    if (!wanted.rebuild && tree_is_current(tree, file, file_points) && is_within(tree, wanted.read.largest_coordinate))
        return {"The tree " + tree.string() + " is up to date."};
    const bool replace = fs::exists(tree);
    if (replace && !is_tree_of(tree, file))
        throw Error(ErrorCode::exists, tree,
                    "is not a tree of " + file.filename().string() + ", whose tree would be written there",
                    "move it, or choose another folder for trees in MeshLab's Tools > Options");
    const fs::path folder = tree.has_parent_path() ? tree.parent_path() : fs::path(".");
    if (!fs::exists(folder))
        throw Error(ErrorCode::not_found, folder, "the folder for trees does not exist",
                    "create it, or choose another folder in MeshLab's Tools > Options");
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throw Error(
            ErrorCode::permission, folder,
            "cannot be written: " + file.filename().string() + " has " + (info.points_known ? "" : "about ") +
                grouped(info.points) + " points and is opened through a tree in this folder",
            "choose another folder for trees, or more points for an ordinary layer, in MeshLab's Tools > Options");
    BuildOptions options;
    options.read = wanted.read;
    options.overwrite = replace;
    options.progress = progress;
    const BuildReport report = build_tree({file}, tree, options);
    std::vector<std::string> lines{"Built " + tree.string() + " with " + grouped(report.outcome.points_out) +
                                   " points in " + brief(report.outcome.seconds) + " s."};
    if (report.points_skipped)
        lines.push_back(grouped(report.points_skipped) +
                        " points without a finite position, or beyond the largest coordinate, were left out.");
    lines.insert(lines.end(), report.notes.begin(), report.notes.end());
    for (const std::string& warning : report.outcome.warnings) lines.push_back("Warning: " + warning);
    return lines;
}

}  // namespace pcm::host
