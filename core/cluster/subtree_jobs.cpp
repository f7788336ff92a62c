#include "pcm/cluster/subtree_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/nodes/draft_record.h"
#include "pcm/build/nodes/node_plan.h"
#include "pcm/cluster/data_layout.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/stages.h"
#include "pcm/tree/tree_index.h"

#include <algorithm>
#include <map>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// Points of a subtree: some bins, so that few points are handed up by way of files; of large clouds a share, so that
// rank 0 has few subtrees.
constexpr std::uint64_t bins_a_subtree = 8, most_subtrees = 4096;

struct Subtree {
    std::size_t first, root;  // numbers of its jobs
};

void put_rows(ByteWriter& out, const LeveledRows& rows)
{
    for (const std::size_t bytes : {rows.rows.size(), rows.levels.size(), rows.sizes.size()})
        out.put(static_cast<std::uint64_t>(bytes));
    out.put_bytes(rows.rows.data(), rows.rows.size());
    out.put_bytes(rows.levels.data(), rows.levels.size());
    out.put_bytes(rows.sizes.data(), rows.sizes.size());
}

LeveledRows get_rows(ByteReader& in)
{
    LeveledRows rows;
    const auto bytes = in.get<std::uint64_t>(), levels = in.get<std::uint64_t>(), sizes = in.get<std::uint64_t>();
    const std::byte* from = in.get_bytes(bytes);
    rows.rows.assign(from, from + bytes);
    const auto* of_levels = reinterpret_cast<const std::uint8_t*>(in.get_bytes(levels));
    rows.levels.assign(of_levels, of_levels + levels);
    const auto* of_sizes = reinterpret_cast<const std::uint8_t*>(in.get_bytes(sizes));
    rows.sizes.assign(of_sizes, of_sizes + sizes);
    return rows;
}

// The chunks of a subtree in the order in which they lie in its file.
std::vector<Draft*> chunks_of(Draft* root)
{
    std::vector<Draft*> chunks, nodes{root};
    while (!nodes.empty()) {
        Draft* const draft = nodes.back();
        nodes.pop_back();
        if (!draft) continue;
        nodes.insert(nodes.end(), draft->children.begin(), draft->children.end());
        if (draft->extent.bytes) chunks.push_back(draft);
    }
    std::sort(chunks.begin(), chunks.end(),
              [](const Draft* a, const Draft* b) { return a->extent.offset < b->extent.offset; });
    return chunks;
}

template <class Coord>
class SubtreeJobs {
public:
    SubtreeJobs(const TeamWork& all, const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins,
                const LevelFiles& levels)
        : all_(all), cloud_(cloud), bins_(bins), levels_(levels)
    {
        options_.grid = cloud.grid;
        options_.lattice = Lattice(cloud.grid);
        options_.schema = cloud.schema;
        options_.layout = cloud.layout;
        options_.chunk_points = all.work.chunk_points;
        options_.spacings = levels.spacings();
        plan_ = plan_nodes<Coord>(
            top, [&](std::size_t bin) { return bins.rows(bin); }, levels, options_.chunk_points);
        list_subtrees();
    }

    // Collective.
    TeamTree run(const fs::path& folder, DraftStore& drafts)
    {
        for (const char* name : {stage::subtrees, stage::above, stage::data}) all_.jobs.begin(name);
        share_jobs(
            all_.team, count_subtrees, subtrees_.size(), all_.work.bin_threads(cloud_.layout, cloud_.observed.points),
            [&](std::size_t i) {
                if (!all_.jobs.is_done({stage::subtrees, i})) build(i);
            },
            [&](std::size_t begun) { report("Building chunks", 0.7, 0.25, begun, subtrees_.size()); });
        TeamTree tree;
        ByteWriter bytes;
        if (all_.team.rank() == 0) {
            all_.jobs.give_up({stage::bins, stage::levels}, stage::subtrees);
            const DataLayout layout = join(drafts, tree);
            layout.save(bytes);
        }
        const Team::Bytes shared = all_.team.broadcast(0, std::move(bytes.bytes()));
        ByteReader in(shared.data(), shared.size(), all_.work.folder);
        write_data_files(DataLayout::load(in), folder);
        return tree;
    }

private:
    using Builder = NodeBuilder<Coord>;
    using Region = typename Builder::Region;

    void report(const char* what, double from, double share, std::size_t begun, std::size_t count)
    {
        all_.work.watch.report(
            what, from + share * static_cast<double>(begun) / static_cast<double>(std::max<std::size_t>(1, count)));
    }

    // The largest parts of the tree that have few enough points, in the order of their jobs.
    void list_subtrees()
    {
        if (plan_.empty()) return;
        std::vector<std::size_t> first(plan_.size());
        std::vector<std::uint64_t> points(plan_.size(), 0);
        for (std::size_t j = 0; j < plan_.size(); ++j) {
            first[j] = plan_[j].bin ? j : first[plan_[j].inputs[0]];
            for (const std::uint64_t of_level : plan_[j].histogram) points[j] += of_level;
        }
        const std::uint64_t most = std::max(bins_a_subtree * all_.work.bin_points(cloud_.observed.points),
                                            cloud_.observed.points / most_subtrees);
        std::vector<std::size_t> open{plan_.size() - 1};
        while (!open.empty()) {
            const std::size_t j = open.back();
            open.pop_back();
            if (plan_[j].bin || points[j] <= most)
                subtrees_.push_back({first[j], j});
            else
                open.insert(open.end(), {plan_[j].inputs[1], plan_[j].inputs[0]});
        }
    }

    // Appends the chunks to the file, and notes their places in their drafts.
    static void append(File& file, std::uint64_t& end, const typename Builder::Output& output)
    {
        for (const auto& piece : output.pieces) piece.draft->extent.offset = end + piece.from;
        file.write_at(output.bytes.data(), output.bytes.size(), end);
        end += output.bytes.size();
    }

    Region merge(Builder& builder, std::map<std::size_t, Region>& regions, std::size_t number,
                 typename Builder::Output& output) const
    {
        const NodeJob& job = plan_[number];
        Region left = std::move(regions.at(job.inputs[0])), right = std::move(regions.at(job.inputs[1]));
        regions.erase(job.inputs[0]);
        regions.erase(job.inputs[1]);
        return builder.merge(std::move(left), std::move(right), job.path, job.own, output);
    }

    void build(std::size_t number)
    {
        const JobFolder::Key key{stage::subtrees, number};
        const fs::path path = all_.jobs.unfinished(key);
        DraftStore drafts;
        Builder builder(options_, drafts);
        std::map<std::size_t, Region> regions;  // regions without their sibling yet
        std::uint64_t end = 0;
        {
            File file(path, File::Mode::create_new);
            for (std::size_t j = subtrees_[number].first; j <= subtrees_[number].root; ++j) {
                typename Builder::Output output;
                if (plan_[j].bin) {
                    bins_.load(*plan_[j].bin);
                    regions.emplace(j, builder.build(leveled_rows(bins_.bins(), levels_, options_, *plan_[j].bin),
                                                     plan_[j].path, plan_[j].above, output));
                } else {
                    Region region = merge(builder, regions, j, output);
                    regions.emplace(j, std::move(region));
                }
                append(file, end, output);
            }
        }
        const Region& region = regions.begin()->second;
        ByteWriter record;
        record.put(static_cast<std::uint8_t>(region.draft != nullptr));
        if (region.draft) put_subtree(record, *region.draft);
        record.put(static_cast<std::uint64_t>(region.above.size()));
        for (const LeveledRows& rows : region.above) put_rows(record, rows);
        all_.jobs.finish(key, path, end, record.bytes());
    }

    Region load(std::size_t number, DraftStore& drafts) const
    {
        const std::vector<std::byte> record = all_.jobs.record({stage::subtrees, number});
        ByteReader in(record.data(), record.size(), all_.work.folder);
        Region region;
        if (in.get<std::uint8_t>()) region.draft = get_subtree(in, drafts, [](Draft&) {});
        for (auto left = in.get<std::uint64_t>(); left > 0; --left) region.above.push_back(get_rows(in));
        return region;
    }

    // Rank 0: the nodes above the subtrees, and where all chunks lie.
    DataLayout join(DraftStore& drafts, TeamTree& tree)
    {
        Builder builder(options_, drafts);
        DataLayout layout(plan_.back().histogram);
        std::map<std::size_t, Region> regions;
        const JobFolder::Key key{stage::above};
        const fs::path path = all_.jobs.unfinished(key);
        std::uint64_t end = 0;
        {
            File file(path, File::Mode::create_new);
            std::size_t next = 0;  // subtree
            for (std::size_t j = 0; j < plan_.size(); ++j) {
                if (next < subtrees_.size() && j == subtrees_[next].first) {
                    Region region = load(next, drafts);
                    for (Draft* draft : chunks_of(region.draft)) layout.add(*draft, next);
                    j = subtrees_[next++].root;
                    regions.emplace(j, std::move(region));
                    continue;
                }
                typename Builder::Output output;
                Region region = merge(builder, regions, j, output);
                append(file, end, output);
                for (const auto& piece : output.pieces) layout.add(*piece.draft, subtrees_.size());
                regions.emplace(j, std::move(region));
                report("Building chunks", 0.95, 0.02, next, subtrees_.size());
            }
        }
        all_.jobs.finish(key, path, end, {});
        layout.finish();
        tree.root = regions.at(plan_.size() - 1).draft;
        tree.data_files = layout.bytes();
        return layout;
    }

    void write_data_files(const DataLayout& layout, const fs::path& folder)
    {
        const std::vector<std::uint64_t> bytes = layout.bytes();
        share_jobs(
            all_.team, count_data_files, bytes.size(), 1,
            [&](std::size_t i) {
                const fs::path name = folder / data_file_name(static_cast<std::uint32_t>(i));
                std::error_code error;
                if (fs::exists(name, error) && File(name, File::Mode::read).size() == bytes[i]) return;
                const fs::path path = all_.jobs.unfinished({stage::data, i});
                write_data_file(layout.files()[i], path);
                rename_path(path, name, "giving a data file its name");
                sync_folder(folder);
            },
            [&](std::size_t begun) { report("Writing data files", 0.97, 0.02, begun, bytes.size()); });
    }

    void write_data_file(const std::vector<DataLayout::Run>& runs, const fs::path& path) const
    {
        constexpr std::uint64_t most = std::uint64_t(4) << 20;
        File to(path, File::Mode::create_new);
        std::uint64_t end = 0;
        std::vector<std::byte> buffer;
        for (const DataLayout::Run& run : runs) {
            const bool is_above = run.source == subtrees_.size();
            const File from(
                all_.jobs.file(is_above ? JobFolder::Key{stage::above} : JobFolder::Key{stage::subtrees, run.source}),
                File::Mode::read);
            for (std::uint64_t done = 0; done < run.bytes; done += buffer.size()) {
                buffer.resize(std::min(most, run.bytes - done));
                from.read_at(buffer.data(), buffer.size(), run.offset + done);
                to.write_at(buffer.data(), buffer.size(), end);
                end += buffer.size();
            }
        }
        to.sync();
        to.close();
    }

    const TeamWork& all_;
    const Ingested& cloud_;
    BinFiles<Coord>& bins_;
    const LevelFiles& levels_;
    NodeBuilderOptions options_;
    std::vector<NodeJob> plan_;
    std::vector<Subtree> subtrees_;
};

}  // namespace

template <class Coord>
TeamTree build_nodes(const TeamWork& team_work, const Ingested& cloud, const TopTree<Coord>& top, BinFiles<Coord>& bins,
                     const LevelFiles& levels, const fs::path& folder, DraftStore& drafts)
{
    return SubtreeJobs<Coord>(team_work, cloud, top, bins, levels).run(folder, drafts);
}

template TeamTree build_nodes(const TeamWork&, const Ingested&, const TopTree<std::uint32_t>&, BinFiles<std::uint32_t>&,
                              const LevelFiles&, const fs::path&, DraftStore&);
template TeamTree build_nodes(const TeamWork&, const Ingested&, const TopTree<std::uint64_t>&, BinFiles<std::uint64_t>&,
                              const LevelFiles&, const fs::path&, DraftStore&);

}  // namespace pcm
