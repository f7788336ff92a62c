#include "pcm/update/tree_update.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/bpc/layout.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t data_file_limit = std::uint64_t(1) << 30;  // a larger one is ended and another begun

fs::path folder_of(const fs::path& path)
{
    if (path.filename() == index_file_name) return path.has_parent_path() ? path.parent_path() : fs::path(".");
    return path;
}

// Keeps a lock file from being made in a folder that is no tree: opening it throws.
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

TreeUpdate::TreeUpdate(const fs::path& path) : lock_(checked(folder_of(path))), tree_(Tree::open(path))
{
    generation_ = tree_->info().generation + 1;
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
    if (!fs::create_directory(path, error) && error)
        throw Error::from_errno(error.value(), path, "creating the folder");
    return path;
}

void TreeUpdate::begin_file()
{
    end_file();
    const auto number = static_cast<std::uint32_t>(tree_->data_files().size() + files_.size());
    file_ = File(folder() / data_file_name(number), File::Mode::create_new);
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

void TreeUpdate::commit(TreeInfo info, NodeVector joined)
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
    find_parts(index, folder() / index_file_name);
    write_commit(folder(), index);
    sync_folder(folder());

    // The new index is written completely before any existing file is touched.
    const fs::path path = folder() / index_file_name;
    fs::path ready = path;
    ready += ".new";
    const std::vector<std::byte> bytes = encode_index(index);
    decode_index(bytes, ready);  // an index that Tree::open would refuse does not replace a good one
    {
        File file(ready, File::Mode::create_or_truncate);
        file.write_at(bytes.data(), bytes.size(), 0);
        file.sync();
        file.close();
    }
    about_ahead_ = true;
    write_about(folder(), index.info);
    if (std::rename(ready.c_str(), path.c_str()) != 0)
        throw Error::from_errno(errno, path, "putting the new index in place");
    committed_ = true;
    sync_folder(folder());
}

void TreeUpdate::start_next()
{
    tree_ = Tree::open(folder());
    generation_ = tree_->info().generation + 1;
    files_.clear();
    bytes_written_ = 0;
    committed_ = about_ahead_ = false;
}

}  // namespace pcm
