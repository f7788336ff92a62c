#include "pcm/build/written_tree.h"

#include "pcm/build/nodes/draft_index.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/renamed_error.h"
#include "pcm/system/tree_folder.h"
#include "pcm/tree/about.h"
#include "pcm/tree/tree_index.h"

#include <cstddef>

namespace pcm {
namespace {

namespace fs = std::filesystem;

void take_over(const WrittenTree& tree, TreeInfo& info)
{
    const TreeInfo& like = *tree.like;
    if (info.points != like.points || info.content_hash != like.content_hash)
        throw Error(ErrorCode::corrupt, tree.output, "the points that were read differ from those that the tree had",
                    "check it with 'pcmlab verify'");
    info.points_skipped = like.points_skipped;
    info.position_type = like.position_type;
    info.position_error = like.position_error;
    info.metadata = like.metadata;
}

void fill_info(const WrittenTree& tree, const Ingested& cloud, TreeIndex& index)
{
    TreeInfo& info = index.info;
    info.spacings = tree.spacings;
    info.sampling = tree.sampling;
    info.levels = static_cast<std::uint16_t>(info.spacings.size());
    info.points = cloud.observed.points;
    const std::uint64_t stored = index.nodes.empty() ? 0 : index.nodes[0].subtree_points;
    if (stored != info.points || cloud.points_in != stored + cloud.points_skipped)
        throw Error(ErrorCode::corrupt, tree.output,
                    std::to_string(cloud.points_in) + " points went in, " + std::to_string(stored) +
                        " came out; this is a defect of the program");
    info.points_skipped = cloud.points_skipped;
    info.content_hash = cloud.observed.hash;
    info.grid = cloud.grid;
    info.position_type = cloud.position_type;
    info.wide = cloud.layout.coordinate_bytes == 8;
    info.schema = cloud.schema;
    if (!index.nodes.empty()) info.box = index.nodes[0].box;
    info.extremes = cloud.observed.extremes;
    info.position_error = cloud.observed.position_error;
    info.metadata = cloud.metadata;
    info.sources = tree.sources;
    if (tree.like) take_over(tree, info);
}

// What interrupted work on the tree of an earlier run has left in it, which build_tree_then() does again.
void remove_strays(const fs::path& folder, std::size_t data_files)
{
    std::vector<fs::path> strays{folder / update_scratch_name, folder / lock_file_name};
    const auto file = [&] { return folder / data_file_name(static_cast<std::uint32_t>(data_files)); };
    for (; fs::exists(file()); ++data_files) strays.push_back(file());
    for (const fs::path& stray : strays) fs::remove_all(stray);
}

}  // namespace

void write_tree(const WrittenTree& tree, const Ingested& cloud, BuildReport& report)
{
    TreeIndex index = index_of_drafts(tree.root);
    fill_info(tree, cloud, index);
    const TreeInfo& info = index.info;
    for (const std::uint64_t bytes : tree.data_files) index.data_files.push_back({bytes, info.generation});
    write_commit(tree.folder, index);
    write_about(tree.folder, info);
    const std::vector<std::byte> bytes = encode_index(index);
    replace_file(tree.folder / index_file_name, bytes.data(), bytes.size());
    remove_strays(tree.folder, index.data_files.size());

    report.outcome.points_in = cloud.points_in;
    report.outcome.points_out = info.points;
    report.outcome.error = info.position_error;
    report.outcome.error_meaning = "largest position error, source units";
    report.points_skipped = cloud.points_skipped;
    report.nodes = index.nodes.size();
    report.levels = info.levels;
    report.bytes = bytes.size();
    for (const DataFile& file : index.data_files) report.bytes += file.bytes;
}

void run_then(const WorkOnTree& then, const std::filesystem::path& folder, const std::filesystem::path& output,
              BuildReport& report)
{
    then(folder, report);
    for (std::string& warning : report.outcome.warnings) warning = renamed(warning, folder, output);
}

}  // namespace pcm
