#include "pcm/update/repair.h"

#include "pcm/bpc/chunk_decoder.h"
#include "pcm/build/bins/observed.h"
#include "pcm/build/build_folder.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/text.h"
#include "pcm/system/url.h"
#include "pcm/threads/ordered.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/about.h"
#include "pcm/tree/point_hash.h"
#include "pcm/tree/unfinished_build.h"
#include "pcm/tree/verify.h"
#include "pcm/update/chunk_scan.h"
#include "pcm/update/foreign_files.h"
#include "pcm/update/inferred_info.h"
#include "pcm/update/tree_update.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// Something else of this name, such as a folder or a FIFO, is damage.
bool is_file_or_missing(const fs::path& path)
{
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::is_regular_file(status) || !fs::exists(status);
}

std::optional<TreeIndex> read_old_index(const fs::path& folder, std::string& fault)
{
    try {
        const File file(folder / index_file_name, File::Mode::read);
        return decode_index(read_index(file), file.path());
    } catch (const Error& error) {
        if (error.code() != ErrorCode::not_found && error.code() != ErrorCode::corrupt &&
            error.code() != ErrorCode::not_a_tree && error.code() != ErrorCode::truncated &&
            is_file_or_missing(folder / index_file_name))
            throw;
        fault = error.what();
        return std::nullopt;
    }
}

std::optional<TreeInfo> read_about_if_whole(const fs::path& folder, std::string& fault)
{
    try {
        return read_about(folder);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::not_found && error.code() != ErrorCode::corrupt &&
            error.code() != ErrorCode::truncated && is_file_or_missing(folder / about_file_name))
            throw;
        fault = error.what();
        return std::nullopt;
    }
}

class Repair {
public:
    Repair(const fs::path& folder, const RepairOptions& options)
        : folder_(folder), options_(options), threads_(thread_count(options.threads)), watch_(options.progress)
    {
        if (!options_.check_only) put_back_replaced(folder_);
        if (fs::exists(folder_ / build_marker_name))
            throw Error(ErrorCode::interrupted_build, folder_,
                        "this tree is not finished: what makes it was interrupted or is still running",
                        "repeat the command that makes it");
        if (!fs::exists(folder_)) throw Error(ErrorCode::not_found, folder_, "no such folder");
        if (!fs::is_directory(folder_))
            throw Error(ErrorCode::not_a_tree, folder_, "this is not a folder, and a tree is one",
                        "name the tree's folder");
        files_ = list_data_files(folder_);
        if (files_.empty() && !is_tree(folder_))
            throw Error(ErrorCode::not_a_tree, folder_, "this folder holds no chunks of a point cloud tree");
        if (!options_.check_only) lock_.emplace(folder_);
    }

    RepairReport run()
    {
        old_ = read_old_index(folder_, index_fault_);
        about_ = read_about_if_whole(folder_, about_fault_);
        if (old_ && tree_is_whole()) {
            heal_around(old_->info, old_->data_files.size());
            report_.generation = old_->info.generation;
            report_.outcome.points_in = report_.outcome.points_out = old_->info.points;
        } else {
            make_index();
            if (!options_.check_only) verify_result();
        }
        report_.outcome.seconds = watch_.seconds();
        return std::move(report_);
    }

private:
    // Whether the index and everything that it names are undamaged.
    bool tree_is_whole()
    {
        try {
            const VerifyReport verified = verify_tree(folder_, threads_, [this](const ProgressUpdate& update) {
                watch_.report("Verifying chunks", 0.4 * update.fraction);
                return true;
            });
            return verified.faults.empty();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::cancelled || error.code() == ErrorCode::io) throw;
            return false;
        }
    }

    // Removes what an interrupted update has left, and restores about.pct where it does not belong to this index.
    void heal_around(const TreeInfo& info, std::size_t data_files)
    {
        const auto fault = check_about(folder_, info);
        if (fault && !options_.check_only) write_about(folder_, info);
        if (fault && !fault->left_by_update) report_.restored.push_back(fault->what);
        remove_leftovers(info, data_files);
        report_.verified = !fault || fault->left_by_update || !options_.check_only;
        if (fault && !options_.check_only && check_about(folder_, info))
            throw Error(ErrorCode::io, folder_ / about_file_name, "it was written, and reads back differently");
    }

    // Reads the repaired tree again, as any reader will.
    void verify_result()
    {
        const VerifyReport now = verify_tree(folder_, threads_, [this](const ProgressUpdate& update) {
            watch_.report("Verifying the repaired tree", 0.75 + 0.24 * update.fraction);
            return true;
        });
        report_.verified = now.faults.empty() && now.around.empty();
        for (const auto* found : {&now.faults, &now.around})
            for (const std::string& fault : *found) report_.faults.push_back("after the repair: " + fault);
    }

    void remove_leftovers(const TreeInfo& info, std::size_t data_files)
    {
        const std::vector<fs::path> foreign = foreign_data_files(folder_, info, data_files);
        for (const fs::path& file : foreign)
            report_.outcome.warnings.push_back(file.string() +
                                               ": it belongs to another tree and is kept; move it out of the "
                                               "folder: this tree cannot be changed while it is there");
        for (const fs::path& file : leftovers(folder_, data_files)) {
            if (std::find(foreign.begin(), foreign.end(), file) != foreign.end()) continue;
            report_.healed.push_back(file.filename().string());
            if (!options_.check_only) fs::remove_all(file);
        }
    }

    void make_index()
    {
        report_.index_written = true;
        if (!old_) report_.faults.push_back(index_fault_);
        scan_files();
        refuse_foreign_files(folder_, files_, old_, about_);
        choose_generation();
        const std::vector<PartNode> wanted = newest_chunks();
        info_ = about_ ? *about_ : old_ ? old_->info : infer_info(*kind_, wanted);
        layout_ = RowLayout(info_.schema, info_.wide);
        TreeIndex index = put_together(check_chunks(wanted));
        report_losses(index);
        if (!options_.check_only) put_in_place(index);
        remove_leftovers(index.info, index.data_files.size());
    }

    void scan_files()
    {
        std::uint64_t all = 1, done = 0;
        for (const FoundFile& file : files_) all += fs::file_size(file.path);
        if (about_) kind_ = ChunkKind{about_->schema, about_->grid};
        if (old_) kind_ = ChunkKind{old_->info.schema, old_->info.grid};
        for (FoundFile& file : files_)
            scan(file, kind_, [&](std::uint64_t bytes) {
                done += bytes;
                watch_.report("Searching for chunks",
                              0.4 + 0.05 * static_cast<double>(done) / static_cast<double>(all));
            });
        if (!kind_) throw Error(ErrorCode::not_a_tree, folder_, "no chunk in this folder is undamaged");
    }

    // Chooses the newest generation that was completed. Chunks of later ones belong to an interrupted update.
    void choose_generation()
    {
        generation_ = old_ ? old_->info.generation : 1;
        for (const FoundFile& file : files_)
            if (file.commit && (!old_ || file.commit->generation == generation_) &&
                file.commit->generation >= generation_) {
                generation_ = file.commit->generation;
                commit_ = file.commit;
            }
        // about.pct is written after all chunks and the commit record: if its generation is newer, the record is
        // damaged.
        if (!old_ && about_ && about_->generation > generation_ && has_chunks_of(about_->generation)) {
            generation_ = about_->generation;
            commit_.reset();
        }
        report_.generation = generation_;
        // The new index names the files up to the last one of this generation.
        data_files_ = commit_ ? commit_->data_files.size() : old_ ? old_->data_files.size() : 0;
        for (const FoundFile& file : files_) {
            for (const std::string& fault : file.faults) report_.faults.push_back(fault);
            for (const FoundChunk& chunk : file.chunks)
                if (chunk.generation <= generation_)
                    data_files_ = std::max<std::size_t>(data_files_, file.number + std::size_t(1));
        }
    }

    bool has_chunks_of(std::uint32_t generation) const
    {
        for (const FoundFile& file : files_)
            for (const FoundChunk& chunk : file.chunks)
                if (chunk.generation == generation) return true;
        return false;
    }

    // The newest chunk or tombstone of each node.
    std::vector<PartNode> newest_chunks() const
    {
        using Key = std::tuple<std::uint32_t, std::uint16_t, std::uint64_t, std::uint64_t>;
        std::map<Key, const FoundChunk*> newest;
        for (const FoundFile& file : files_)
            for (const FoundChunk& chunk : file.chunks) {
                if (chunk.generation > generation_) continue;
                const NodePath& path = chunk.node.path;
                const FoundChunk*& best = newest[{chunk.node.part, path.depth, path.bits[0], path.bits[1]}];
                if (!best || chunk.generation >= best->generation) best = &chunk;
            }
        std::vector<PartNode> nodes;
        for (const auto& [key, chunk] : newest) nodes.push_back(chunk->node);
        return nodes;
    }

    // The result of reading all columns of a chunk.
    struct Checked {
        std::string fault;
        Observed observed;
    };
    Checked check(const PartNode& node, const std::vector<File>& files) const
    {
        Checked checked;
        if (node.points == 0) return checked;
        try {
            const ColumnSet all = ColumnSet::whole(info_.schema);
            DecodedChunk decoded = read_chunk(files[node.extent.file], node.extent.offset, node.extent.bytes,
                                              node.extent.header_bytes, all);
            if (!decoded.header.schema.is_beginning_of(info_.schema))
                throw Error(ErrorCode::corrupt, files[node.extent.file].path(),
                            "a chunk has attributes that the tree lacks");
            Chunk chunk = std::move(decoded.chunk);
            add_missing_columns(chunk, info_.schema, all);
            Box3i box;
            for (std::uint32_t i = 0; i < chunk.points; ++i) {
                const Vec3i p = chunk.positions->grid(i);
                box.extend(p);
                checked.observed.see(p);
            }
            if (!(box == node.box))
                throw Error(ErrorCode::corrupt, files[node.extent.file].path(),
                            "its box is not tight around its points");
            std::vector<std::byte> scratch;
            checked.observed.hash = hash_chunk(chunk, layout_, scratch);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::io) throw;
            checked = Checked();
            checked.fault = error.what();
        }
        return checked;
    }

    // Returns the undamaged nodes and sums up what they hold.
    std::vector<PartNode> check_chunks(const std::vector<PartNode>& nodes)
    {
        std::vector<File> files(data_files_);
        for (const FoundFile& file : files_)
            if (file.number < data_files_) files[file.number] = File(file.path, File::Mode::read);
        std::vector<PartNode> whole;
        in_turn(
            nodes.size(), threads_, [&](std::size_t i) { return check(nodes[i], files); },
            [&](std::size_t i, Checked&& checked) {
                if (!checked.fault.empty()) {
                    report_.faults.push_back(checked.fault + ": " + grouped(nodes[i].points) + " points");
                    return;
                }
                observed_.merge(checked.observed);
                whole.push_back(nodes[i]);
            },
            [&](std::size_t done) {
                watch_.report("Checking chunks",
                              0.45 + 0.29 * static_cast<double>(done) /
                                         static_cast<double>(std::max<std::size_t>(1, nodes.size())));
            });
        return whole;
    }

    TreeIndex put_together(const std::vector<PartNode>& nodes)
    {
        TreeIndex index;
        NodeVector joined = join_parts(nodes, info_.spacings, info_.grid.scale);
        index.nodes = std::move(joined.nodes);
        index.part_roots = std::move(joined.part_roots);
        std::size_t parts = commit_ ? commit_->parts : 0;
        for (const PartNode& node : nodes) parts = std::max(parts, commit_ ? 0 : node.part + std::size_t(1));
        if (!index.nodes.empty() && parts > index.part_roots.size()) index.part_roots.resize(parts, no_node);
        index.info = info_;
        TreeInfo& info = index.info;
        info.generation = generation_;
        info.points = observed_.points;
        info.content_hash = observed_.hash;
        info.extremes = observed_.extremes;
        info.box = index.nodes.empty() ? Box3i() : index.nodes[0].box;
        if (!about_ && !old_) info.coverage_kept = false;
        if (commit_ && (about_ || old_)) info.coverage_kept = commit_->coverage_kept;
        index.data_files = commit_ ? commit_->data_files : old_ ? old_->data_files : std::vector<DataFile>();
        index.data_files.resize(data_files_);
        for (const FoundFile& file : files_) {
            if (file.number >= data_files_) continue;
            DataFile& data = index.data_files[file.number];
            std::uint64_t end = 0;
            for (const FoundChunk& chunk : file.chunks) {
                data.generation = chunk.generation;
                end = std::max(end, chunk.node.extent.offset + chunk.node.extent.bytes);
            }
            // A truncated file, or one that nothing records: the bytes that its chunks need.
            if (data.bytes == 0 || data.bytes > file.size) data.bytes = end;
        }
        std::set<std::uint32_t> present;
        for (const FoundFile& file : files_) present.insert(file.number);
        for (std::uint32_t number = 0; number < data_files_; ++number)
            if (!present.count(number) && index.data_files[number].bytes) {
                report_.faults.push_back(data_file_name(number) + " is missing or no regular file");
                index.data_files[number].bytes = 0;
            }
        return index;
    }

    // Compares the restored points with the recorded ones.
    void report_losses(TreeIndex& index)
    {
        TreeInfo& info = index.info;
        std::optional<std::uint64_t> expected;
        if (commit_)
            expected = commit_->points;
        else if (about_ && about_->generation == generation_)
            expected = about_->points;
        else if (old_)
            expected = old_->info.points;
        report_.outcome.points_in = expected.value_or(info.points);
        if (info.points == 0 && report_.outcome.points_in)
            throw Error(ErrorCode::corrupt, folder_,
                        "not one of its " + grouped(report_.outcome.points_in) + " points is in an undamaged chunk",
                        "restore its data files from a copy");
        report_.outcome.points_out = info.points;
        if (report_.outcome.points_in > info.points) report_.points_lost = report_.outcome.points_in - info.points;
        if (report_.outcome.points_in < info.points)
            report_.faults.push_back("there are " + grouped(info.points - report_.outcome.points_in) +
                                     " points more than the tree had: deleted points are back, since the newer chunks "
                                     "of their nodes are lost");
        if (report_.outcome.points_in != info.points) info.coverage_kept = false;
        if (!about_)
            report_.faults.push_back(
                about_fault_ +
                (old_
                     ? "; the index has the same information"
                     : "; the metadata, the names of sources, the number of skipped points, the position error and the "
                       "kind of sampling are lost"));
        if (index.nodes.empty()) {
            info.spacings.clear();
            info.levels = 0;
        }
    }

    void put_in_place(TreeIndex& index)
    {
        watch_.report("Writing the index", 0.74);
        const std::vector<std::byte> bytes = encode_index(index);
        decode_index(bytes, folder_ / index_file_name);  // checks the invariants before the old index is replaced
        write_about(folder_, index.info);
        const fs::path path = folder_ / index_file_name, damaged = folder_ / damaged_index_name;
        if (fs::exists(fs::symlink_status(path))) keep_damaged(path, damaged);
        try {
            replace_file(path, bytes.data(), bytes.size());
        } catch (const Error& error) {
            if (!holds(path, bytes)) throw;
            report_.outcome.warnings.emplace_back(Error::after(folder_, "the new index is in place", error).what());
        }
    }

    static bool holds(const fs::path& path, const std::vector<std::byte>& bytes)
    {
        const File file(path, File::Mode::read);
        std::vector<std::byte> found(bytes.size());
        return file.size() == bytes.size() && file.read_some_at(found.data(), found.size(), 0) == bytes.size() &&
               found == bytes;
    }

    void keep_damaged(const fs::path& path, const fs::path& damaged) const
    {
        if (fs::is_directory(fs::symlink_status(damaged)))
            throw Error(ErrorCode::exists, damaged, "a folder has the name that the damaged index is to get",
                        "move it out of the tree's folder");
        fs::remove(damaged);
        // Only a regular file can be copied, and a folder cannot be replaced by a file.
        if (!fs::is_regular_file(fs::symlink_status(path))) return fs::rename(path, damaged);
        std::error_code no_links;
        fs::create_hard_link(path, damaged, no_links);
        if (no_links) fs::copy_file(path, damaged);
    }

    fs::path folder_;
    const RepairOptions& options_;
    const unsigned threads_;
    Watch watch_;
    std::optional<TreeLock> lock_;
    std::vector<FoundFile> files_;
    std::optional<TreeIndex> old_;
    std::optional<TreeInfo> about_;
    std::string index_fault_, about_fault_;
    std::optional<ChunkKind> kind_;
    std::uint32_t generation_ = 1;
    std::optional<CommitRecord> commit_;
    std::size_t data_files_ = 0;
    TreeInfo info_;
    RowLayout layout_;
    Observed observed_;
    RepairReport report_;
};

}  // namespace

RepairReport repair_tree(const fs::path& path, const RepairOptions& options)
{
    const fs::path folder = tree_folder_of(path);
    refuse_to_write(folder);
    try {
        return Repair(folder, options).run();
    } catch (const fs::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), error.path1(), "working in the folder");
    }
}

}  // namespace pcm
