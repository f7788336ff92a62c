#include "pcm/tree/tree.h"

#include "pcm/bpc/chunk_header.h"
#include "pcm/remote/open_bytes.h"
#include "pcm/system/error.h"
#include "pcm/system/renamed_error.h"
#include "pcm/system/url.h"
#include "pcm/tree/column_shares.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/data_file_pool.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/unfinished_build.h"

#include <algorithm>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// The error of an index that cannot be decoded, with what to do about it.
[[noreturn]] void refuse_index(const Error& error, const fs::path& folder)
{
    if (is_url(folder) && error.code() == ErrorCode::not_found)
        throw Error(ErrorCode::not_found, folder,
                    "there is no point cloud tree at this address: " + without_path(error),
                    std::string("an address of a tree is that of a folder with ") + index_file_name + " in it");
    // A folder or a device of this name is damage as well; repairing moves it aside.
    std::error_code ignored;
    if (is_damage(error) || (!is_url(folder) && !fs::is_regular_file(error.path(), ignored)))
        throw DamagedTree(error, folder, "rebuild the index from the chunks");
    throw error;
}

// The error of a data file that is missing, too short or no regular file.
[[noreturn]] void refuse_data_file(const Error& error, const fs::path& folder)
{
    if (is_damage(error) || error.code() == ErrorCode::not_found || error.code() == ErrorCode::unsupported)
        throw DamagedTree(error, folder, "put the tree's own file back, or keep what the other files hold");
    throw error;
}

[[noreturn]] void refuse_folder(const fs::path& folder)
{
    if (fs::exists(folder / build_marker_name))
        throw Error(ErrorCode::interrupted_build, folder,
                    "this tree is not finished: what makes it was interrupted or is still running",
                    "repeat the command that makes it, or remove the folder");
    throw Error(ErrorCode::not_a_tree, folder,
                std::string("this folder holds no point cloud tree: it has no ") + index_file_name,
                is_tree_folder(folder) ? "rebuild it from the chunks, in a terminal: " + repair_command(folder)
                                       : "make one with 'pcmlab build'");
}

// Reads all pages of an index of a few megabytes now, so that what walks the tree waits for no server then. Views do
// not wait in any case (node_loader.h).
void load_small_index(const NodeTable& nodes)
{
    constexpr std::size_t most_nodes = 1 << 17;  // some 17 MB
    if (nodes.size() > most_nodes) return;
    for ([[maybe_unused]] const Node& node : nodes) {
    }
}

// The error of a folder that is not a tree's, or of what is not a folder.
void refuse_what_is_no_tree(const fs::path& folder)
{
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (status.type() == fs::file_type::not_found) {
        if (was_being_replaced(folder))
            throw Error(ErrorCode::interrupted_build, folder,
                        "a build was about to replace this tree when it was interrupted",
                        "build it again, or put the tree back: " + repair_command(folder));
        throw Error(ErrorCode::not_found, folder, "no such tree",
                    fs::exists(build_folder_of(folder), error)
                        ? "what makes it was interrupted or is still running: repeat the command that makes it"
                        : "");
    }
    if (status.type() == fs::file_type::none) throw Error::from_errno(error.value(), folder, "opening");
    if (!fs::is_directory(status))
        throw Error(ErrorCode::not_a_tree, folder,
                    std::string("this is ") +
                        (fs::is_regular_file(status) ? "a file"
                         : fs::is_fifo(status)       ? "a FIFO"
                                                     : "a device") +
                        ", not a point cloud tree",
                    "a tree is a folder; make one with 'pcmlab build'");
    if (!fs::exists(folder / index_file_name, error)) {
        if (error) throw Error::from_errno(error.value(), folder, "opening");
        refuse_folder(folder);
    }
}

}  // namespace

bool is_tree(const fs::path& path)
{
    std::error_code ignored;
    return is_url(path) || fs::is_regular_file(tree_folder_of(path) / index_file_name, ignored);
}

std::shared_ptr<const Tree> Tree::open(const fs::path& path, std::size_t most_open_files)
{
    const fs::path folder = tree_folder_of(path);
    if (!is_url(folder)) refuse_what_is_no_tree(folder);
    // An update may replace the index or the folder while the data files of the old one are being opened.
    for (int tries = 1;; ++tries) {
        std::shared_ptr<const ByteSource> index_file;
        std::shared_ptr<Tree> tree;
        try {
            index_file = open_bytes(folder / index_file_name);
            tree = without_files(folder, open_index(index_file));
        } catch (const Error& failure) {
            refuse_index(failure, folder);
        }
        try {
            tree->files_ = std::make_shared<DataFilePool>(folder, tree->data_files(), most_open_files);
            if (is_url(folder)) {
                tree->refuse_other_data();
                load_small_index(tree->nodes_);
            }
        } catch (const Error& failure) {
            if (tries == 10 || index_file->keeps_its_name()) refuse_data_file(failure, folder);
            continue;
        }
        if (tries == 10 || is_url(folder) || index_file->keeps_its_name()) return tree;
    }
}

std::optional<CommitRecord> Tree::last_commit() const
{
    const std::vector<DataFile>& files = data_files();
    std::size_t last = files.size();
    while (last > 0 && files[last - 1].bytes == 0) --last;
    if (last == 0) return std::nullopt;
    const std::uint64_t size = commit_bytes(last), end = files[last - 1].bytes;
    std::uint64_t bytes = 0;
    if (end < size) return std::nullopt;
    auto commit = read_commit(*data_file(static_cast<std::uint32_t>(last - 1)), end - size, size, bytes);
    return commit && bytes == size ? std::move(commit) : std::nullopt;
}

// Files are put on a server one by one: an index may be there next to data of an earlier tree, or the other way round.
void Tree::refuse_other_data() const
{
    const std::optional<CommitRecord> commit = last_commit();
    const bool is_of_this = commit && commit->points == info_.points && commit->content_hash == info_.content_hash;
    if (!is_of_this && !data_files().empty())
        throw Error(ErrorCode::corrupt, folder_, "the data files are not those of the index");
}

std::shared_ptr<Tree> Tree::without_files(const fs::path& folder, OpenIndex index)
{
    std::shared_ptr<Tree> tree(new Tree);
    tree->shares_ = std::make_shared<ColumnShares>();
    tree->folder_ = folder;
    tree->info_ = index.head->info;
    tree->nodes_ = std::move(index.nodes);
    tree->head_ = std::move(index.head);
    return tree;
}

const std::vector<NodeId>& Tree::part_roots() const { return head_->part_roots; }
const std::vector<DataFile>& Tree::data_files() const { return head_->data_files; }

std::shared_ptr<const Tree> Tree::of_index(const fs::path& folder, TreeIndex index, std::size_t most_open_files)
{
    check_data_files(folder, index.data_files);
    const std::shared_ptr<Tree> tree = without_files(folder, in_memory(std::move(index)));
    tree->files_ = std::make_shared<DataFilePool>(folder, tree->data_files(), most_open_files);
    return tree;
}

ChunkIdentity Tree::identity(NodeId id) const
{
    const Node& node = nodes_.at(id);
    ChunkIdentity identity;
    identity.part = node.part;
    identity.generation = node.extent.bytes ? data_files()[node.extent.file].generation : info_.generation;
    identity.first_level = node.first_level;
    identity.level_points = node.level_points;
    identity.spacing = node.spacing;
    if (node.part == no_part) return identity;
    const NodeId root = part_roots()[node.part];
    identity.path.depth = static_cast<std::uint16_t>(node.depth - nodes_[root].depth);
    for (NodeId below = id; below != root; below = nodes_[below].parent) {
        const Node& parent = nodes_[nodes_[below].parent];
        const int depth = parent.depth - nodes_[root].depth;
        if (parent.children[1] == below)
            identity.path.bits[static_cast<std::size_t>(depth / 64)] |= std::uint64_t(1) << (depth % 64);
    }
    return identity;
}

Chunk Tree::empty_chunk(const ColumnSet& columns) const
{
    Chunk chunk;
    chunk.attributes.resize(info_.schema.size());
    if (columns.positions) chunk.positions = std::make_shared<ChunkPositions>();
    if (columns.sizes) chunk.sizes = std::make_shared<Column>(attribute_of_sizes());
    for (std::size_t i = 0; i < info_.schema.size(); ++i)
        if (columns.attributes.test(i)) chunk.attributes[i] = std::make_shared<Column>(info_.schema[i]);
    return chunk;
}

// Where not all files are open, one may be gone by now.
std::shared_ptr<const ByteSource> Tree::data_file(std::uint32_t number) const
{
    try {
        return files_->get(number);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::not_found)
            throw Error(ErrorCode::not_found, error.path(), "this file of the tree is gone since the tree was opened",
                        "if another program has changed the tree, open it again");
        refuse_data_file(error, folder_);
    }
}

// A chunk whose checksums match may still belong to another node.
void Tree::check(NodeId id, const BpcHeader& header) const
{
    const Node& node = nodes_[id];
    if (!header.identity || !(*header.identity == identity(id)) || !header.schema.is_beginning_of(info_.schema) ||
        !(header.grid == info_.grid) || !node.box.contains(header.box.min) || !node.box.contains(header.box.max))
        throw Error(ErrorCode::corrupt, folder_ / data_file_name(node.extent.file),
                    "chunk at byte " + std::to_string(node.extent.offset) + ": it does not belong to node " +
                        std::to_string(id));
}

std::shared_ptr<const Tree> Tree::with_schema(const Schema& longer) const
{
    if (!info_.schema.is_beginning_of(longer))
        throw Error(ErrorCode::invalid_argument, folder_, "a tree's attributes stay; others can be added after them");
    std::shared_ptr<Tree> tree(new Tree(*this));
    tree->info_.schema = longer;
    return tree;
}

const std::vector<LevelSummary>& Tree::level_summaries() const { return head_->levels; }

std::uint64_t Tree::points_to_level(std::uint16_t level) const
{
    const std::vector<LevelSummary>& levels = level_summaries();
    return levels.empty() ? 0 : levels[std::min<std::size_t>(level, levels.size() - 1)].points_to_here;
}

std::uint16_t Tree::level_with_at_most(std::uint64_t points) const
{
    std::uint16_t best = 0, level = 0;
    for (const LevelSummary& summary : level_summaries()) {
        if (summary.points_to_here > points) break;
        best = level++;
    }
    return best;
}

}  // namespace pcm
