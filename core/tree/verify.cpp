#include "pcm/tree/verify.h"

#include "pcm/build/bins/row.h"
#include "pcm/system/error.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/about.h"
#include "pcm/tree/point_hash.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/tree_lock.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// No byte belongs to two chunks.
void check_extents(const std::vector<Node>& nodes, VerifyReport& report)
{
    std::vector<const Node*> by_place;
    for (const Node& node : nodes)
        if (node.extent.bytes) by_place.push_back(&node);
    std::sort(by_place.begin(), by_place.end(), [](const Node* p, const Node* q) {
        return p->extent.file != q->extent.file ? p->extent.file < q->extent.file : p->extent.offset < q->extent.offset;
    });
    for (std::size_t i = 1; i < by_place.size(); ++i) {
        const Extent &a = by_place[i - 1]->extent, &b = by_place[i]->extent;
        if (a.file == b.file && a.offset + a.bytes > b.offset)
            report.faults.push_back("nodes " + std::to_string(by_place[i - 1] - nodes.data()) + " and " +
                                    std::to_string(by_place[i] - nodes.data()) + " share bytes of data file " +
                                    std::to_string(a.file));
    }
}

// about.pct says what the index says, or an update that was interrupted before its index was in place has written it.
void check_about(const Tree& tree, VerifyReport& report)
{
    try {
        const TreeInfo about = read_about(tree.folder());
        const std::string name = (tree.folder() / about_file_name).string();
        if (about.generation == tree.info().generation) {
            if (!same_info(about, tree.info())) report.around.push_back(name + ": it does not say what the index says");
        } else if (about.generation == tree.info().generation + 1) {
            report.notes.push_back(name + ": it is of an update that was interrupted");
        } else {
            report.around.push_back(name + ": it is of generation " + std::to_string(about.generation) +
                                    ", the index of " + std::to_string(tree.info().generation));
        }
    } catch (const Error& error) {
        if (error.code() == ErrorCode::permission || error.code() == ErrorCode::io) throw;
        report.around.push_back(error.what());
    }
}

// The record at the end of the newest data file in use.
void check_commit(const Tree& tree, VerifyReport& report)
{
    const std::vector<DataFile>& files = tree.data_files();
    std::size_t last = files.size();
    while (last > 0 && files[last - 1].bytes == 0) --last;
    if (last == 0) return;
    const fs::path path = tree.folder() / data_file_name(static_cast<std::uint32_t>(last - 1));
    const std::string missing = path.string() + ": it does not end with the record of its generation";
    try {
        const std::uint64_t size = commit_bytes(last), end = files[last - 1].bytes;
        std::uint64_t bytes = 0;
        if (end < size) return report.notes.push_back(missing);
        const auto commit = read_commit(File(path, File::Mode::read), end - size, size, bytes);
        if (!commit || bytes != size) return report.notes.push_back(missing);
        const TreeInfo& info = tree.info();
        if (commit->generation == info.generation &&
            (commit->points != info.points || commit->content_hash != info.content_hash ||
             commit->coverage_kept != info.coverage_kept || commit->data_files != files))
            report.notes.push_back(path.string() + ": the record of generation " + std::to_string(info.generation) +
                                   " does not say what the index says");
    } catch (const Error& error) {
        if (error.code() == ErrorCode::io) throw;
        report.notes.push_back(error.what());
    }
}

// What the index does not name.
void list_strays(const Tree& tree, VerifyReport& report)
{
    std::vector<std::string> known{index_file_name, about_file_name, lock_file_name};
    for (std::uint32_t i = 0; i < tree.data_files().size(); ++i) {
        const fs::path path = tree.folder() / data_file_name(i);
        known.push_back(path.filename().string());
        const std::uint64_t used = tree.data_files()[i].bytes;
        std::error_code error;
        const std::uint64_t size = fs::file_size(path, error);
        if (!error && used > 0 && size > used)
            report.notes.push_back(path.string() + ": " + std::to_string(size - used) +
                                   " bytes behind those that the index names");
        if (!error && used == 0) report.notes.push_back(path.string() + ": nothing in it is in use; it can be removed");
    }
    std::sort(known.begin(), known.end());
    for (const auto& entry : fs::directory_iterator(tree.folder()))
        if (!std::binary_search(known.begin(), known.end(), entry.path().filename().string()))
            report.notes.push_back(entry.path().string() + ": it is no part of the tree");
}

// Reads a node's chunk segment by segment and checks that each one's box is tight. Returns the box of all.
Chunk read_checked(const Tree& tree, NodeId id, const ColumnSet& columns, Box3i& own)
{
    std::vector<Box3i> boxes;
    ChunkPart part = tree.read_chunk_part(id, columns, [&](const Box3i& box, std::uint16_t) {
        boxes.push_back(box);
        return true;
    });
    std::size_t at = 0;
    for (std::size_t s = 0; s < boxes.size(); ++s) {
        Box3i tight;
        for (std::uint32_t i = 0; i < part.count[s]; ++i) tight.extend(part.chunk.positions->grid(at++));
        if (!(tight == boxes[s]))
            throw Error(ErrorCode::corrupt, tree.folder() / data_file_name(tree.node(id).extent.file),
                        "the box of segment " + std::to_string(s) + " is not tight around its points");
        own.extend(tight);
    }
    return std::move(part.chunk);
}

}  // namespace

VerifyReport verify_tree(const std::filesystem::path& path, unsigned threads, const ProgressFunction& progress)
{
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<const Tree> tree = Tree::open(path);
    const TreeInfo& info = tree->info();
    const std::vector<Node>& nodes = tree->nodes();
    VerifyReport report;
    report.position_error = info.position_error;
    report.bytes = info.bytes;
    report.outcome.points_in = info.points;

    check_extents(nodes, report);
    check_about(*tree, report);
    check_commit(*tree, report);
    list_strays(*tree, report);

    // Chunks are whole, and what they hold is, as a set, what the build and the updates were given: the sum of all
    // points' hashes is the one recorded, their tight boxes are the nodes' boxes, and points are as many as the nodes
    // say.
    const RowLayout layout(info.schema, info.wide);
    const ColumnSet all = ColumnSet::all(info.schema);
    std::vector<Box3i> own_box(nodes.size());
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> hash{0}, points{0};
    std::atomic<bool> stop{false};
    std::mutex mutex;
    const auto work = [&] {
        std::vector<std::byte> scratch;
        for (std::size_t id; !stop && (id = next++) < nodes.size();) {
            if (nodes[id].points == 0) continue;
            try {
                const Chunk chunk = read_checked(*tree, static_cast<NodeId>(id), all, own_box[id]);
                hash += hash_chunk(chunk, layout, scratch);
                points += chunk.points;
            } catch (const std::exception& error) {
                const std::lock_guard lock(mutex);
                report.faults.push_back("node " + std::to_string(id) + ": " + error.what());
            }
        }
    };
    threads = thread_count(threads);
    std::vector<std::thread> crew;
    for (unsigned t = 0; t < threads; ++t) crew.emplace_back(work);
    bool cancelled = false;
    while (next < nodes.size() && !cancelled) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (!progress) continue;
        ProgressUpdate update;
        update.stage = "Verifying chunks";
        update.fraction = static_cast<double>(std::min(next.load(), nodes.size())) / static_cast<double>(nodes.size());
        if (!progress(update)) {
            cancelled = true;
            stop = true;
        }
    }
    for (std::thread& thread : crew) thread.join();
    if (cancelled) throw Error(ErrorCode::cancelled, path, "verifying was cancelled");

    if (report.faults.empty()) {
        if (points != info.points)
            report.faults.push_back(std::to_string(points) + " points in the chunks, " + std::to_string(info.points) +
                                    " in the index");
        if (hash != info.content_hash) report.faults.push_back("the points are not, bit for bit, those that went in");
        std::vector<Box3i> tight = own_box;
        for (std::size_t id = nodes.size(); id-- > 0;) {
            if (!(tight[id] == nodes[id].box))
                report.faults.push_back("node " + std::to_string(id) + ": its box is not tight around its points");
            if (id > 0) tight[nodes[id].parent].extend(tight[id]);
        }
        for (const Vec3i& extreme : info.extremes)
            if (!nodes.empty() && !info.box.contains(extreme))
                report.faults.push_back("an extreme point lies outside the box");
    }
    std::sort(report.faults.begin(), report.faults.end());
    std::sort(report.notes.begin(), report.notes.end());
    report.outcome.points_out = points;
    report.outcome.error = info.position_error;
    report.outcome.error_meaning = "largest position error, source units";
    report.outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace pcm
