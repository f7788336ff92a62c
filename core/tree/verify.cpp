#include "tree/verify.h"

#include "cloud/error.h"
#include "tree/row.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

namespace pcm {

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

    // No byte belongs to two chunks.
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

    // Chunks are whole, and what they hold is, as a set, what the build was given: the sum of all points' hashes is the
    // one recorded, their tight boxes are the nodes' boxes, and points are as many as the nodes say.
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
                const Chunk chunk = tree->read_chunk(static_cast<NodeId>(id), all);
                for (std::size_t i = 0; i < chunk.points; ++i) own_box[id].extend(chunk.positions->grid(i));
                hash += hash_chunk(chunk, layout, scratch);
                points += chunk.points;
            } catch (const std::exception& error) {
                const std::lock_guard lock(mutex);
                report.faults.push_back("node " + std::to_string(id) + ": " + error.what());
            }
        }
    };
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
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
        if (hash != info.content_hash)
            report.faults.push_back("the points are not, bit for bit, those that the build read");
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
    report.outcome.points_out = points;
    report.outcome.error = info.position_error;
    report.outcome.error_meaning = "largest position error, source units";
    report.outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace pcm
