#include "pcm/update/tree_update.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/layout.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/update/foreign_files.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t data_file_limit = std::uint64_t(1) << 30;  // a larger one is ended and another begun

// Keeps a lock file from being made in a folder that is not a tree: opening it throws.
const fs::path& checked(const fs::path& folder)
{
    if (!is_tree(folder)) Tree::open(folder);
    return folder;
}

bool about_is_of(const Tree& tree)
{
    try {
        return read_about(tree.folder()).generation == tree.info().generation;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

std::vector<fs::path> leftovers(const fs::path& folder, std::size_t data_files)
{
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        unsigned number = 0;
        const bool data = std::sscanf(name.c_str(), "chunks-%u.bpc", &number) == 1 && name == data_file_name(number);
        if ((data && number >= data_files) || name == update_scratch_name ||
            name == std::string(index_file_name) + ".new" || name == std::string(about_file_name) + ".new")
            found.push_back(entry.path());
    }
    std::sort(found.begin(), found.end());
    return found;
}

void warn_of_scratch(const fs::path& tree, Outcome& outcome)
{
    std::error_code error;
    const fs::path scratch = tree_folder_of(tree) / update_scratch_name;
    if (fs::exists(scratch, error))
        outcome.warnings.push_back(scratch.string() +
                                   ": the update is complete, but its scratch files could not be removed; the next "
                                   "update of the tree removes them");
}

ChunkIdentity identity_of(const PartNode& node, std::uint32_t generation)
{
    ChunkIdentity identity;
    identity.path = node.path;
    identity.part = node.part;
    identity.generation = generation;
    identity.first_level = node.first_level;
    identity.level_points = node.level_points;
    identity.spacing = node.spacing;
    return identity;
}

TreeUpdate::TreeUpdate(const fs::path& path) : lock_(checked(tree_folder_of(path))), tree_(Tree::open(path))
{
    generation_ = tree_->info().generation + 1;
    const std::vector<fs::path> foreign = foreign_data_files(folder(), tree_->info(), tree_->data_files().size());
    if (!foreign.empty())
        throw Error(ErrorCode::exists, foreign.front(),
                    "this file has the name of the tree's next data file, and belongs to another tree",
                    "move it out of the tree's folder");
    // about.pct first, then the data files: if this is interrupted and the index is then rebuilt, it is of this
    // generation, or of the interrupted one while all its chunks are still present.
    const std::vector<fs::path> left = leftovers(folder(), tree_->data_files().size());
    if (!left.empty() && !about_is_of(*tree_)) write_about(folder(), tree_->info());
    for (const fs::path& file : left) fs::remove_all(file);
}

TreeUpdate::~TreeUpdate()
{
    std::error_code ignored;
    try {
        file_ = File();
        if (!committed_)
            for (const fs::path& file : leftovers(folder(), tree_->data_files().size())) fs::remove_all(file, ignored);
        fs::remove_all(folder() / update_scratch_name, ignored);
        if (!committed_ && about_ahead_) write_about(folder(), tree_->info());
    } catch (...) {  // the index is valid; the next update removes what is left here
    }
}

fs::path TreeUpdate::scratch()
{
    const fs::path path = folder() / update_scratch_name;
    std::error_code error;
    if (fs::create_directory(path, error)) return path;
    if (error) throw Error::from_errno(error.value(), path, "creating the folder");
    if (!fs::is_directory(fs::symlink_status(path, error)))
        throw Error(ErrorCode::exists, path, "this is a symbolic link where the scratch files of the update belong",
                    "remove the link");
    return path;
}

void TreeUpdate::begin_file()
{
    end_file();
    const auto number = static_cast<std::uint32_t>(tree_->data_files().size() + files_.size());
    const fs::path path = folder() / data_file_name(number);
    try {
        file_ = File(path, File::Mode::create_new);
    } catch (const Error& error) {
        // It may have been made nevertheless, and would be in the way of another try.
        std::error_code ignored;
        if (error.code() != ErrorCode::exists) fs::remove(path, ignored);
        throw;
    }
    files_.push_back({0, generation_});
}

void TreeUpdate::end_file()
{
    if (!file_.is_open()) return;
    file_.sync();
    file_.close();
}

Extent TreeUpdate::write(const std::vector<std::byte>& chunk)
{
    if (!file_.is_open() || files_.back().bytes + chunk.size() > data_file_limit) begin_file();
    Extent extent;
    extent.file = static_cast<std::uint32_t>(tree_->data_files().size() + files_.size() - 1);
    extent.offset = files_.back().bytes;
    extent.bytes = chunk.size();
    std::memcpy(&extent.header_bytes, chunk.data() + bpc_layout::header_bytes_at, sizeof extent.header_bytes);
    file_.write_at(chunk.data(), chunk.size(), extent.offset);
    files_.back().bytes += chunk.size();
    bytes_written_ += chunk.size();
    return extent;
}

void TreeUpdate::adopt(const std::vector<std::uint64_t>& bytes)
{
    for (const std::uint64_t size : bytes) {
        files_.push_back({size, generation_});
        bytes_written_ += size;
    }
}

void TreeUpdate::write_tombstone(const PartNode& node)
{
    PartNode empty;
    empty.part = node.part;
    empty.path = node.path;
    empty.spacing = node.spacing;
    const TreeInfo& info = tree_->info();
    Chunk chunk;
    chunk.attributes.resize(info.schema.size());
    write(encode_chunk(chunk, info.schema, info.grid, identity_of(empty, generation_)));
}

void TreeUpdate::replace_index(TreeInfo info, NodeVector joined, bool another_follows)
{
    if (files_.empty()) begin_file();
    end_file();
    TreeIndex index;
    index.info = std::move(info);
    index.info.generation = generation_;
    index.nodes = std::move(joined.nodes);
    index.part_roots = std::move(joined.part_roots);
    // Part numbers are not reused as long as the tree has nodes.
    if (!index.nodes.empty())
        index.part_roots.resize(std::max(index.part_roots.size(), tree_->part_roots().size()), no_node);
    index.data_files = tree_->data_files();
    index.data_files.insert(index.data_files.end(), files_.begin(), files_.end());
    write_commit(folder(), index);
    const OpenFolder open_folder(folder());
    open_folder.sync();

    // The new index is written completely, and the new tree opened, before any existing file is touched.
    const fs::path path = folder() / index_file_name;
    fs::path ready = path;
    ready += ".new";
    const std::vector<std::byte> bytes = encode_index(index);
    TreeIndex again = decode_index(bytes, ready);  // what Tree::open would refuse does not replace a good index
    {
        File file(ready, File::Mode::create_or_truncate);
        file.write_at(bytes.data(), bytes.size(), 0);
        file.sync();
        file.close();
    }
    // Only checked where no other change follows: one file open at a time is enough.
    next_ = Tree::of_index(folder(), std::move(again), another_follows ? Tree::usual_open_files : 1);
    about_ahead_ = true;
    write_about(folder(), index.info);
    rename_path(ready, path, "putting the new index in place");
    committed_ = true;
    try {
        open_folder.sync();
    } catch (const Error& error) {
        throw Error::after(folder(), "the update is part of the tree", error);
    }
}

void TreeUpdate::commit(TreeInfo info, NodeVector joined) { replace_index(std::move(info), std::move(joined), false); }

void TreeUpdate::commit_and_continue(TreeInfo info, NodeVector joined)
{
    const auto start_next = [this] {
        tree_ = std::move(next_);
        generation_ = tree_->info().generation + 1;
        files_.clear();
        bytes_written_ = 0;
        committed_ = about_ahead_ = false;
    };
    try {
        replace_index(std::move(info), std::move(joined), true);
    } catch (const Error& error) {
        if (error.is_done()) start_next();
        throw;
    }
    start_next();
}

}  // namespace pcm
