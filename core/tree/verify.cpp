#include "pcm/tree/verify.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "pcm/system/seconds.h"
#include "pcm/system/url.h"
#include "pcm/threads/crew.h"
#include "pcm/threads/team.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/about.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/point_hash.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/tree_lock.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// Chosen: chunks that a thread takes at a time: they lie next to each other, and 10^9 points are some ten thousand
// questions to the team's counter.
constexpr std::size_t chunks_of_a_job = 4;

// The nodes with a chunk, in the order of the files.
std::vector<NodeId> nodes_by_place(const NodeTable& nodes)
{
    std::vector<NodeId> by_place;
    for (NodeId id = 0; id < nodes.size(); ++id)
        if (nodes[id].extent.bytes) by_place.push_back(id);
    std::sort(by_place.begin(), by_place.end(), [&](NodeId p, NodeId q) {
        const Extent &a = nodes[p].extent, &b = nodes[q].extent;
        return a.file != b.file ? a.file < b.file : a.offset < b.offset;
    });
    return by_place;
}

// Finds bytes that belong to two chunks.
void check_extents(const NodeTable& nodes, const std::vector<NodeId>& by_place, VerifyReport& report)
{
    for (std::size_t i = 1; i < by_place.size(); ++i) {
        const Extent &a = nodes[by_place[i - 1]].extent, &b = nodes[by_place[i]].extent;
        if (a.file == b.file && a.offset + a.bytes > b.offset)
            report.faults.push_back("nodes " + std::to_string(by_place[i - 1]) + " and " + std::to_string(by_place[i]) +
                                    " share bytes of data file " + std::to_string(a.file));
    }
}

// Checks the commit record at the end of the newest data file in use.
void check_commit(const Tree& tree, VerifyReport& report)
{
    const std::vector<DataFile>& files = tree.data_files();
    std::size_t last = files.size();
    while (last > 0 && files[last - 1].bytes == 0) --last;
    if (last == 0) return;
    const fs::path path = tree.folder() / data_file_name(static_cast<std::uint32_t>(last - 1));
    // The record serves to rebuild a lost index, and nothing else.
    const std::string remedy = "; no point is lost, and 'pcmlab compact' writes a new one";
    const std::string missing = path.string() + ": it does not end with the commit record of its generation" + remedy;
    try {
        const std::optional<CommitRecord> commit = tree.last_commit();
        if (!commit) return report.notes.push_back(missing);
        const TreeInfo& info = tree.info();
        if (commit->generation == info.generation &&
            (commit->points != info.points || commit->content_hash != info.content_hash ||
             commit->coverage_kept != info.coverage_kept || commit->data_files != files))
            report.notes.push_back(path.string() + ": the commit record of generation " +
                                   std::to_string(info.generation) + " differs from the index" + remedy);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::io) throw;
        report.notes.push_back(error.what() + remedy);
    }
}

// Lists the files and bytes that the index does not name.
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
                                   " bytes after those that the index names");
        if (!error && used == 0) report.notes.push_back(path.string() + ": nothing in it is in use; it can be removed");
    }
    if (is_url(tree.folder())) return;  // what else is on a server is not asked
    std::sort(known.begin(), known.end());
    for (const auto& entry : fs::directory_iterator(tree.folder()))
        if (!std::binary_search(known.begin(), known.end(), entry.path().filename().string()))
            report.notes.push_back(entry.path().string() + ": it does not belong to the tree");
    const fs::path lock = tree.folder() / lock_file_name;
    if (const fs::file_status status = fs::symlink_status(lock); fs::exists(status) && !fs::is_regular_file(status))
        report.notes.push_back(lock.string() + ": it is not a file, so that the tree cannot be changed; remove it");
}

// Reads a node's chunk segment by segment and checks that the box of each segment is tight; adds them to `own`.
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

// Reads every chunk, and compares what the chunks hold, as a set, with what the build and the updates recorded: the sum
// of all points' hashes, the nodes' boxes and the number of points.
class ChunkVerification {
public:
    // Chunks are read in this order, by the ranks of the team.
    ChunkVerification(const Tree& tree, const std::vector<NodeId>& order, Team& team, std::uint64_t counter,
                      VerifyReport& report)
        : tree_(tree),
          nodes_(tree.nodes()),
          order_(order),
          team_(team),
          counter_(counter),
          report_(report),
          own_box_(nodes_.size())
    {
    }

    // Adds the faults of single chunks. Returns the number of points read, by all ranks in rank 0.
    std::uint64_t read(unsigned threads, const ProgressFunction& progress)
    {
        Watch watch(progress);
        const auto show = [&](bool at_once) {
            const std::size_t done = std::min(begun_.load(), order_.size());
            watch.report("Verifying chunks",
                         static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, order_.size())),
                         at_once);
        };
        show(true);
        Crew crew(signal_);
        for (unsigned t = 0; t < threads; ++t) crew.add([this] { work(); });
        crew.join([&] { show(false); });
        join_ranks();
        return points_;
    }

    // Adds the faults of the tree as a whole; for a tree whose chunks are all without fault.
    void compare_totals()
    {
        const TreeInfo& info = tree_.info();
        std::vector<std::string>& faults = report_.faults;
        if (points_ != info.points)
            faults.push_back(std::to_string(points_) + " points in the chunks, " + std::to_string(info.points) +
                             " in the index");
        if (hash_ != info.content_hash) faults.push_back("the points are not, bit for bit, the ones that were stored");
        std::vector<Box3i> tight = own_box_;
        for (auto id = static_cast<NodeId>(nodes_.size()); id-- > 0;) {
            if (!(tight[id] == nodes_[id].box))
                faults.push_back("node " + std::to_string(id) + ": its box is not tight around its points");
            if (id > 0) tight[nodes_[id].parent].extend(tight[id]);
        }
        for (const Vec3i& extreme : info.extremes)
            if (!nodes_.empty() && !info.box.contains(extreme))
                faults.push_back("an extreme point lies outside the box");
    }

private:
    // One thread's share. What is not damage of the tree, such as too little memory, ends all of them.
    void work()
    {
        const RowLayout layout(tree_.info().schema, tree_.info().wide);
        const ColumnSet all = ColumnSet::whole(tree_.info().schema);
        std::vector<std::byte> scratch;
        for (std::size_t i = 0, end = 0; !signal_.stopped; ++i) {
            if (i == end) {
                i = static_cast<std::size_t>(team_.next(counter_)) * chunks_of_a_job;
                if (i >= order_.size()) return;
                end = std::min(order_.size(), i + chunks_of_a_job);
                begun_ = end;
            }
            const NodeId id = order_[i];
            try {
                const Chunk chunk = read_checked(tree_, id, all, own_box_[id]);
                hash_ += hash_chunk(chunk, layout, scratch);
                points_ += chunk.points;
            } catch (const Error& error) {
                const auto* const damaged = dynamic_cast<const DamagedTree*>(&error);
                const std::lock_guard lock(signal_.mutex);
                report_.faults.push_back("node " + std::to_string(id) + ": " +
                                         (damaged ? damaged->fault() : error.what()));
            }
        }
    }

    // Gives rank 0 what the others have found.
    void join_ranks()
    {
        if (team_.size() == 1) return;
        std::vector<unsigned> others{0};
        if (team_.rank() == 0) {
            others.clear();
            for (unsigned r = 1; r < team_.size(); ++r) others.push_back(r);
        }
        team_.connect(others);
        std::vector<Team::Bytes> sent(others.size());
        if (team_.rank() != 0) sent[0] = found();
        for (const Team::Bytes& bytes : team_.exchange(std::move(sent))) add(bytes);
    }

    Team::Bytes found() const
    {
        ByteWriter out;
        out.put(hash_.load());
        out.put(points_.load());
        out.put(static_cast<std::uint64_t>(report_.faults.size()));
        for (const std::string& fault : report_.faults) out.put_string(fault);
        for (NodeId id = 0; id < own_box_.size(); ++id) {
            if (own_box_[id].empty()) continue;
            out.put(id);
            for (const Vec3i& corner : {own_box_[id].min, own_box_[id].max})
                for (std::size_t a = 0; a < 3; ++a) out.put(corner[a]);
        }
        return std::move(out.bytes());
    }

    void add(const Team::Bytes& bytes)
    {
        ByteReader in(bytes.data(), bytes.size(), tree_.folder());
        if (bytes.empty()) return;  // from rank 0
        hash_ += in.get<std::uint64_t>();
        points_ += in.get<std::uint64_t>();
        for (auto faults = in.get<std::uint64_t>(); faults-- > 0;) report_.faults.push_back(in.get_string());
        while (in.left()) {
            Box3i& box = own_box_.at(in.get<NodeId>());
            for (Vec3i* const corner : {&box.min, &box.max})
                for (std::size_t a = 0; a < 3; ++a) (*corner)[a] = in.get<std::int64_t>();
        }
    }

    const Tree& tree_;
    const NodeTable& nodes_;
    const std::vector<NodeId>& order_;
    Team& team_;
    const std::uint64_t counter_;
    VerifyReport& report_;
    std::vector<Box3i> own_box_;  // box of each node's own points
    std::atomic<std::size_t> begun_{0};
    std::atomic<std::uint64_t> hash_{0}, points_{0};
    Signal signal_;  // its mutex guards the faults while threads run
};

// All that is checked without reading chunks.
void check_around(const Tree& tree, const fs::path& path, const std::vector<NodeId>& by_place, VerifyReport& report)
{
    check_extents(tree.nodes(), by_place, report);
    if (const auto about = is_url(path) ? std::nullopt : check_about(tree.folder(), tree.info()))
        (about->left_by_update ? report.notes : report.around).push_back(about->what);
    check_commit(tree, report);
    list_strays(tree, report);
}

// Those of rank 0.
std::vector<std::string> common_list(Team& team, const std::vector<std::string>& list, const fs::path& path)
{
    ByteWriter out;
    for (const std::string& line : list) out.put_string(line);
    const Team::Bytes bytes = team.broadcast(0, std::move(out.bytes()));
    ByteReader in(bytes.data(), bytes.size(), path);
    std::vector<std::string> common;
    while (in.left()) common.push_back(in.get_string());
    return common;
}

}  // namespace

VerifyReport verify_tree(const std::filesystem::path& path, unsigned threads, const ProgressFunction& progress)
{
    SoloTeam alone;
    return verify_tree(path, threads, progress, alone, 0);
}

VerifyReport verify_tree(const std::filesystem::path& path, unsigned threads, const ProgressFunction& progress,
                         Team& team, std::uint64_t counter)
{
    const auto start = std::chrono::steady_clock::now();
    const std::shared_ptr<const Tree> tree = Tree::open(path);
    const TreeInfo& info = tree->info();
    VerifyReport report;
    const std::vector<NodeId> by_place = nodes_by_place(tree->nodes());
    if (team.rank() == 0) check_around(*tree, path, by_place, report);
    ChunkVerification chunks(*tree, by_place, team, counter, report);
    const std::uint64_t points = chunks.read(thread_count(threads), progress);
    if (team.rank() == 0 && report.faults.empty()) chunks.compare_totals();
    std::sort(report.faults.begin(), report.faults.end());
    report.faults = common_list(team, report.faults, path);
    report.around = common_list(team, report.around, path);
    if (team.rank() != 0) return report;

    std::sort(report.notes.begin(), report.notes.end());
    report.position_error = report.outcome.error = info.position_error;
    report.bytes = info.bytes;
    report.outcome.points_in = info.points;
    report.outcome.points_out = points;
    report.outcome.error_meaning = "largest position error, source units";
    report.outcome.seconds = seconds_since(start);
    return report;
}

}  // namespace pcm
