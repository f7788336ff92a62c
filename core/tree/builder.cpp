#include "tree/builder.h"

#include "cloud/error.h"
#include "io/merged_reader.h"
#include "tree/about.h"
#include "tree/batch_queue.h"
#include "tree/build_folder.h"
#include "tree/crew.h"
#include "tree/data_files.h"
#include "tree/ingest.h"
#include "tree/level_sampler.h"
#include "tree/morton_sort.h"
#include "tree/node_builder.h"
#include "tree/node_jobs.h"
#include "tree/observed.h"
#include "tree/scratch.h"
#include "tree/top_tree.h"
#include "tree/tree_index.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <thread>

namespace pcm {
namespace {

namespace fs = std::filesystem;

class TreeBuild {
public:
    TreeBuild(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output, const BuildOptions& options)
        : options_(options),
          threads_(options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency())),
          output_(output),
          watch_(options.progress),
          cloud_(cloud),
          sources_(sources)
    {
        node_options_.schema = cloud_.info().schema;
    }

    BuildReport run()
    {
        BuildFolder folder(output_, options_.overwrite);
        folder_ = folder.path();
        if (!cloud_.info().grid)
            build_from_doubles();
        else if (cloud_.info().points_known && (cloud_.seekable() || fits_one_bin()))
            build_from_grid();
        else
            build_from_grid_spool();
        folder.publish();
        // Now they are complete: readers count on the way what they drop.
        report_.notes.insert(report_.notes.begin(), cloud_.info().notes.begin(), cloud_.info().notes.end());
        report_.outcome.seconds = watch_.seconds();
        return report_;
    }

private:
    // Points of a bin. It must not depend on the number of threads, or the tree would: sixteen bins at work fill half of the
    // memory. Where a bin of two chunks is more than that, fewer threads work (build_threads_).
    std::uint64_t bin_points(std::size_t row_bytes, std::size_t key_bytes)
    {
        const std::uint64_t half = options_.memory_bytes / 2;
        const std::uint64_t point_bytes = 2 * row_bytes + key_bytes + 32;  // rows before and after the sort, and its work space
        const std::uint64_t points = std::max(half / 16 / point_bytes, 2 * std::uint64_t(options_.chunk_points));
        build_threads_ = static_cast<unsigned>(std::clamp<std::uint64_t>(half / (points * point_bytes), 1, threads_));
        return points;
    }

    bool fits_one_bin()
    {
        const RowLayout layout(cloud_.info().schema, false);
        return cloud_.info().points <= bin_points(layout.bytes, sizeof(Point<std::uint32_t>));
    }

    bool next_batch(PointBatch& batch)
    {
        if (!cloud_.read(batch, default_batch_points)) return false;
        report_.outcome.points_in += batch.size;
        return true;
    }

    // The rows of gridded points, and what they say about themselves.
    void put_gridded_rows(const PointBatch& batch, std::vector<std::byte>& rows, Observed& observed) const
    {
        const RowLayout& layout = node_options_.layout;
        rows.resize(batch.size * layout.bytes);
        put_attributes(batch, layout, rows.data());
        for (std::size_t i = 0; i < batch.size; ++i) {
            std::array<std::uint32_t, 3> c;
            Vec3i p;
            for (std::size_t a = 0; a < 3; ++a) {
                p[a] = batch.grid_xyz[a][i];
                c[a] = to_coordinate<std::uint32_t>(p[a]);
            }
            std::memcpy(rows.data() + i * layout.bytes, c.data(), sizeof c);
            observed.see(p);
        }
        observed.hash += hash_rows(rows.data(), batch.size, layout.bytes);
    }

    // Gridded, seekable input (or so little that there is nothing to cut): sample, cut, distribute while parsing.
    void build_from_grid()
    {
        using Coord = std::uint32_t;
        set_grid(*cloud_.info().grid);
        node_options_.layout = RowLayout(node_options_.schema, false);
        const RowLayout& layout = node_options_.layout;
        const std::uint64_t points = cloud_.info().points;
        const std::uint64_t per_bin = bin_points(layout.bytes, sizeof(Point<Coord>));

        TopTree<Coord> top;
        std::size_t bins = 1;
        if (points > per_bin) {
            TopPlanner<Coord>::Sample sample;
            for (const Vec3i& p : sample_evenly(cloud_, sample_points(points, per_bin)))
                sample.push_back({to_coordinate<Coord>(p[0]), to_coordinate<Coord>(p[1]), to_coordinate<Coord>(p[2])});
            bins = TopPlanner<Coord>(top, node_options_.lattice.finer, per_bin).plan(0, sample, points, 0);
        }

        Scratch scratch(folder_ / "scratch.tmp", layout.bytes);
        scratch.add_bins(bins);
        std::vector<Observed> observed(threads_);
        Signal signal;
        BatchQueue queue(signal, threads_ + 2);
        Crew crew(signal);
        for (unsigned t = 0; t < threads_; ++t)
            crew.add([&, t] {
                Scratch::Writer writer(scratch, 0, bins, options_.memory_bytes / 4 / threads_);
                std::vector<std::byte> rows;
                while (auto batch = queue.pop()) {
                    put_gridded_rows(*batch, rows, observed[t]);
                    for (std::size_t i = 0; i < batch->size; ++i) {
                        const std::byte* row = rows.data() + i * layout.bytes;
                        writer.add(top.bin_of(coordinates_of<Coord>(row)), row);
                    }
                    queue.recycle(std::move(*batch));
                }
                writer.flush();
            });
        while (auto batch = queue.empty_batch()) {
            if (!next_batch(*batch)) break;
            queue.push(std::move(*batch));
            watch_.report("Reading points", 0.4 * cloud_.fraction_read());
        }
        queue.close();
        crew.join([&] { watch_.report("Reading points", 0.4); });
        for (const Observed& o : observed) observed_.merge(o);
        build_bins<Coord>(scratch, top, per_bin);
    }

    // Gridded input that can only be read in order: one parse into a spool of rows, which are then distributed.
    void build_from_grid_spool()
    {
        using Coord = std::uint32_t;
        set_grid(*cloud_.info().grid);
        node_options_.layout = RowLayout(node_options_.schema, false);
        const RowLayout& layout = node_options_.layout;
        const std::uint64_t per_bin = bin_points(layout.bytes, sizeof(Point<Coord>));

        Scratch spool(folder_ / "spool.tmp", layout.bytes);
        spool.add_bins(1);
        using Coordinates = std::array<Coord, 3>;
        StridedSample<Coordinates> sample(static_cast<std::size_t>(options_.memory_bytes / 16 / sizeof(Coordinates)));
        std::vector<std::byte> rows;
        PointBatch batch;
        while (next_batch(batch)) {
            put_gridded_rows(batch, rows, observed_);
            for (std::size_t i = 0; i < batch.size; ++i) sample.see(coordinates_of<Coord>(rows.data() + i * layout.bytes));
            spool.append(0, rows.data(), batch.size);
            watch_.report("Reading points", 0.25 * cloud_.fraction_read());
        }
        TopTree<Coord> top;
        std::size_t bins = 1;
        if (spool.rows(0) > per_bin)
            bins = TopPlanner<Coord>(top, node_options_.lattice.finer, per_bin).plan(0, sample.items(), spool.rows(0), 0);
        sample = StridedSample<Coordinates>(0);
        Scratch scratch(folder_ / "scratch.tmp", layout.bytes);
        scratch.add_bins(bins);
        distribute(spool, 0, scratch, 0, bins, [&](unsigned, std::byte* block, std::size_t count, auto&& add) {
            for (std::size_t i = 0; i < count; ++i) {
                const std::byte* row = block + i * layout.bytes;
                add(top.bin_of(coordinates_of<Coord>(row)), row);
            }
        });
        build_bins<Coord>(scratch, top, per_bin);
    }

    // Anything else: one parse into a spool of rows with positions in double, which shows how large coordinates get; then
    // the spool is put on a grid and distributed.
    void build_from_doubles()
    {
        const RowLayout layout(node_options_.schema, true);
        Scratch spool(folder_ / "spool.tmp", layout.bytes);
        spool.add_bins(1);
        Box3d box;
        StridedSample<Vec3d> sample(static_cast<std::size_t>(options_.memory_bytes / 16 / sizeof(Vec3d)));
        std::vector<std::byte> rows;
        PointBatch batch;
        while (next_batch(batch)) {
            rows.resize(batch.size * layout.bytes);
            put_attributes(batch, layout, rows.data());
            std::size_t kept = 0;
            for (std::size_t i = 0; i < batch.size; ++i) {
                const Vec3d p{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
                if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
                box.extend(p);
                sample.see(p);
                std::byte* row = rows.data() + kept++ * layout.bytes;
                if (row != rows.data() + i * layout.bytes) std::memmove(row, rows.data() + i * layout.bytes, layout.bytes);
                std::memcpy(row, p.data(), sizeof p);
            }
            report_.points_skipped += batch.size - kept;
            spool.append(0, rows.data(), kept);
            watch_.report("Reading points", 0.25 * cloud_.fraction_read());
        }
        if (report_.points_skipped)
            report_.notes.push_back(std::to_string(report_.points_skipped) + " points without a finite position were left out");
        if (choose_grid(box))
            build_from_spool<std::uint32_t>(spool, layout, sample);
        else
            build_from_spool<std::uint64_t>(spool, layout, sample);
    }

    // Rows of doubles become rows of Coord, in place: with narrow coordinates a row begins later.
    template <class Coord>
    void build_from_spool(Scratch& spool, const RowLayout& spooled, StridedSample<Vec3d>& sample)
    {
        static_assert(sizeof(Coord) <= sizeof(double));
        constexpr std::size_t shift = 3 * (sizeof(double) - sizeof(Coord));
        node_options_.layout = RowLayout(node_options_.schema, sizeof(Coord) == 8);
        const RowLayout& layout = node_options_.layout;
        const std::uint64_t per_bin = bin_points(layout.bytes, sizeof(Point<Coord>));
        const Grid& grid = node_options_.grid;
        const auto on_grid = [&](const Vec3d& p) {
            std::array<Coord, 3> c;
            for (std::size_t a = 0; a < 3; ++a)
                c[a] = to_coordinate<Coord>(to_grid_position(p[a], grid.scale[a], grid.offset[a]));
            return c;
        };
        TopTree<Coord> top;
        std::size_t bins = 1;
        if (spool.rows(0) > per_bin) {
            typename TopPlanner<Coord>::Sample coordinates;
            for (const Vec3d& p : sample.items()) coordinates.push_back(on_grid(p));
            bins = TopPlanner<Coord>(top, node_options_.lattice.finer, per_bin).plan(0, coordinates, spool.rows(0), 0);
        }
        sample = StridedSample<Vec3d>(0);
        Scratch scratch(folder_ / "scratch.tmp", layout.bytes);
        scratch.add_bins(bins);
        std::vector<Observed> observed(threads_);
        distribute(spool, 0, scratch, 0, bins, [&](unsigned t, std::byte* block, std::size_t count, auto&& add) {
            Observed& seen = observed[t];
            for (std::size_t i = 0; i < count; ++i) {
                std::byte* row = block + i * spooled.bytes;
                Vec3d p;
                std::memcpy(p.data(), row, sizeof p);
                const auto c = on_grid(p);
                row += shift;
                std::memcpy(row, c.data(), sizeof c);
                Vec3i q;
                for (std::size_t a = 0; a < 3; ++a) {
                    q[a] = to_grid<Coord>(c[a]);
                    seen.position_error = std::max(seen.position_error, std::fabs(grid.to_source(q[a], a) - p[a]));
                }
                seen.see(q);
                seen.hash += hash_rows(row, 1, layout.bytes);
                add(top.bin_of(c), row);
            }
        });
        for (const Observed& o : observed) observed_.merge(o);
        build_bins<Coord>(scratch, top, per_bin);
    }

    std::size_t sample_points(std::uint64_t points, std::uint64_t per_bin) const
    {
        const std::uint64_t wanted = std::max<std::uint64_t>(200000, points / per_bin * 4096);
        return static_cast<std::size_t>(std::min({wanted, options_.memory_bytes / 16 / 24, points}));
    }

    void set_grid(const Grid& grid)
    {
        node_options_.grid = grid;
        node_options_.lattice = Lattice(grid);
    }

    // Doubles that come from integers keep those integers' grid; else a power of two an axis, the finest that holds the largest
    // coordinate. True when all positions are narrow on it.
    bool choose_grid(const Box3d& box)
    {
        Grid grid;
        Vec3d largest{0, 0, 0};
        for (std::size_t a = 0; a < 3 && !box.empty(); ++a) largest[a] = std::max(std::fabs(box.min[a]), std::fabs(box.max[a]));
        if (cloud_.info().near_grid && tells_apart(*cloud_.info().near_grid, largest)) {
            grid = *cloud_.info().near_grid;
            set_grid(grid);
            on_source_grid_ = true;
            bool narrow = true;
            for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
                for (const double end : {box.min[a], box.max[a]}) {
                    const std::int64_t q = to_grid_position(end, grid.scale[a], grid.offset[a]);
                    narrow = narrow && q >= std::numeric_limits<std::int32_t>::min() && q <= std::numeric_limits<std::int32_t>::max();
                }
            return narrow;
        }
        const double all = std::max({largest[0], largest[1], largest[2]});
        for (std::size_t a = 0; a < 3; ++a) {
            // An axis of tiny coordinates need not be finer than 2^-40 of the largest.
            grid.scale[a] = power_of_two_step(std::max(largest[a], std::ldexp(all, -40)));
            grid.offset[a] = 0;
        }
        set_grid(grid);
        return false;
    }

    // Every coordinate must have a place on the grid that a double can tell from its neighbours.
    static bool tells_apart(const Grid& grid, const Vec3d& largest)
    {
        for (std::size_t a = 0; a < 3; ++a)
            if (!((largest[a] + std::fabs(grid.offset[a])) / std::fabs(grid.scale[a]) <= std::ldexp(1.0, 50))) return false;
        return true;
    }

    // Moves the rows of one bin into bins [first, first + bins) of `to`, on all threads. `put(thread, rows, count, add)` calls
    // add(bin, row) for each row.
    template <class Put>
    void distribute(Scratch& from, std::size_t bin, Scratch& to, std::size_t first, std::size_t bins, const Put& put)
    {
        std::atomic<std::size_t> next{0};
        Signal signal;
        Crew crew(signal);
        for (unsigned t = 0; t < threads_; ++t)
            crew.add([&, t] {
                Scratch::Writer writer(to, first, bins, options_.memory_bytes / 4 / threads_);
                std::vector<std::byte> rows;
                for (std::size_t block; !signal.stopped && (block = next++) < from.blocks(bin);) {
                    const std::size_t count = from.block_rows(bin, block);
                    rows.resize(count * from.row_bytes());
                    from.read_block(bin, block, rows.data());
                    put(t, rows.data(), count, [&](std::size_t target, const std::byte* row) { writer.add(target, row); });
                }
                writer.flush();
            });
        crew.join([&] { watch_.report("Sorting points into bins", 0.3); });
    }

    // Bins that came out larger than planned (a sample can miss a dense spot) are divided again.
    template <class Coord>
    void divide_large_bins(Scratch& scratch, TopTree<Coord>& top, std::uint64_t per_bin)
    {
        const std::uint64_t limit = per_bin + per_bin / 2;
        for (std::uint32_t n = 0; n < top.nodes.size(); ++n) {
            if (top.nodes[n].children[0]) continue;
            const std::size_t bin = top.nodes[n].bin;
            if (scratch.rows(bin) <= limit) continue;
            // Blocks lie in the order that threads wrote them; a sample by the rows' hashes is the same whatever the order.
            std::vector<std::byte> rows;
            TopPlanner<Coord> planner(top, node_options_.lattice.finer, per_bin);
            typename TopPlanner<Coord>::Sample chosen;
            const std::uint64_t keep_one_in = std::max<std::uint64_t>(1, scratch.rows(bin) / 100000);
            for (std::size_t b = 0; b < scratch.blocks(bin); ++b) {
                rows.resize(scratch.block_rows(bin, b) * scratch.row_bytes());
                scratch.read_block(bin, b, rows.data());
                for (std::size_t i = 0; i < scratch.block_rows(bin, b); ++i) {
                    const std::byte* row = rows.data() + i * scratch.row_bytes();
                    if (checksum(row, scratch.row_bytes()) % keep_one_in == 0) chosen.push_back(coordinates_of<Coord>(row));
                }
            }
            const std::size_t first = scratch.bins();
            const std::size_t bins = planner.plan(n, chosen, scratch.rows(bin), first);
            scratch.add_bins(bins);
            if (bins == 1) {
                top.nodes[n].bin = bin;  // it cannot be divided: a pile of points in one place
                continue;
            }
            distribute(scratch, bin, scratch, first, bins,
                       [&](unsigned, std::byte* block, std::size_t count, auto&& add) {
                           for (std::size_t i = 0; i < count; ++i) {
                               const std::byte* row = block + i * scratch.row_bytes();
                               add(top.bin_of(coordinates_of<Coord>(row), n), row);
                           }
                       });
            scratch.forget(bin);
        }
    }

    // Sort each bin, choose the points' levels, make the nodes.
    template <class Coord>
    void build_bins(Scratch& scratch, TopTree<Coord>& top, std::uint64_t per_bin)
    {
        divide_large_bins(scratch, top, per_bin);
        DataFiles files(folder_);
        DraftStore drafts;
        Draft* root = nullptr;
        if (observed_.points > 0) {
            SortedPoints<Coord> points(folder_ / "points.tmp");
            points.resize(scratch.bins());
            sort_bins(scratch, points);
            LevelSampler<Coord> levels(points, node_options_.lattice, options_.sampling, folder_ / "levels.tmp");
            levels.run(build_threads_, [&](double fraction) { watch_.report("Choosing levels", 0.5 + 0.2 * fraction); });
            node_options_.spacings = levels.spacings();
            node_options_.chunk_points = options_.chunk_points;
            NodeJobs<Coord> jobs(top, scratch, levels, node_options_, drafts, files);
            root = jobs.run(build_threads_, [&](std::uint64_t done) {
                watch_.report("Building chunks",
                              0.7 + 0.28 * static_cast<double>(done) / static_cast<double>(observed_.points));
            });
        }
        write_index(root, files);
    }

    // Each bin's rows into Morton order, in place; and the positions by themselves, for the sampler.
    template <class Coord>
    void sort_bins(Scratch& scratch, SortedPoints<Coord>& points)
    {
        const RowLayout& layout = node_options_.layout;
        std::atomic<std::size_t> next{0};
        Signal signal;
        Crew crew(signal);
        for (unsigned t = 0; t < build_threads_; ++t)
            crew.add([&] {
                for (std::size_t bin; !signal.stopped && (bin = next++) < scratch.bins();) {
                    const std::size_t count = scratch.rows(bin);
                    if (count == 0) continue;
                    const std::vector<std::byte> rows = scratch.read(bin);
                    std::vector<std::byte> sorted(rows.size());
                    std::vector<Point<Coord>> positions;
                    positions.reserve(count);
                    for (const std::uint32_t i : morton_order<Coord>(rows.data(), count, layout, node_options_.lattice.finer)) {
                        const std::byte* row = rows.data() + i * layout.bytes;
                        std::memcpy(sorted.data() + positions.size() * layout.bytes, row, layout.bytes);
                        positions.push_back(coordinates_of<Coord>(row));
                    }
                    scratch.rewrite(bin, sorted.data());
                    points.put(bin, positions);
                }
            });
        crew.join([&] {
            watch_.report("Sorting points", 0.4 + 0.1 * static_cast<double>(std::min(next.load(), scratch.bins())) /
                                                      static_cast<double>(scratch.bins()));
        });
    }

    // Drafts become nodes, parents first; subtrees without points vanish.
    void write_index(Draft* root, DataFiles& files)
    {
        watch_.report("Writing the index", 0.99);
        files.finish();
        TreeIndex index;
        TreeInfo& info = index.info;
        std::vector<Draft*> order;
        if (root && subtree_points(*root) > 0) {
            order.push_back(root);
            index.nodes.emplace_back();
        }
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Draft& draft = *order[i];
            std::size_t side = 0;
            for (Draft* child : draft.children) {
                if (child && subtree_points(*child) > 0) {
                    const auto id = static_cast<NodeId>(order.size());
                    index.nodes[i].children[side] = id;
                    index.nodes.emplace_back();
                    index.nodes.back().parent = static_cast<NodeId>(i);
                    order.push_back(child);
                }
                ++side;
            }
            Node& node = index.nodes[i];
            node.depth = draft.path.depth;
            node.points = draft.points;
            node.first_level = draft.first_level;
            node.level_points = draft.level_points;
            node.extent = draft.extent;
            node.spacing = node.is_leaf() ? 0 : draft.spacing;
            if (draft.points) node.box = draft.box;
        }
        for (std::size_t i = index.nodes.size(); i-- > 0;) {
            Node& node = index.nodes[i];
            node.subtree_points += node.points;
            if (i == 0) break;
            index.nodes[node.parent].subtree_points += node.subtree_points;
            index.nodes[node.parent].box.extend(node.box);
        }
        info.sampling = options_.sampling;
        info.spacings = node_options_.spacings;
        info.levels = static_cast<std::uint16_t>(info.spacings.size());
        info.points = observed_.points;
        const std::uint64_t stored = index.nodes.empty() ? 0 : index.nodes[0].subtree_points;
        if (stored != info.points || report_.outcome.points_in != stored + report_.points_skipped)
            throw Error(ErrorCode::corrupt, output_,
                        std::to_string(report_.outcome.points_in) + " points went in, " + std::to_string(stored) +
                            " came out; this is a defect of the program");
        info.points_skipped = report_.points_skipped;
        info.content_hash = observed_.hash;
        info.grid = node_options_.grid;
        info.position_type = on_source_grid_ ? ScalarType::i32 : cloud_.info().position_type;
        info.wide = node_options_.layout.coordinate_bytes == 8;
        info.schema = node_options_.schema;
        if (!index.nodes.empty()) info.box = index.nodes[0].box;
        info.extremes = observed_.extremes;
        info.position_error = observed_.position_error;
        info.metadata = cloud_.info().metadata;
        info.sources = sources_;
        for (const std::uint64_t data_bytes : files.bytes()) index.data_files.push_back({data_bytes, info.generation});
        write_commit(folder_, index);
        write_about(folder_, info);
        const std::vector<std::byte> bytes = encode_index(index);
        replace_file(folder_ / index_file_name, bytes.data(), bytes.size());

        report_.outcome.points_out = info.points;
        report_.outcome.error = info.position_error;
        report_.outcome.error_meaning = "largest position error, source units";
        report_.nodes = index.nodes.size();
        report_.levels = info.levels;
        report_.bytes = bytes.size();
        for (const DataFile& file : index.data_files) report_.bytes += file.bytes;
        watch_.report("Done", 1);
    }

    std::uint64_t subtree_points(const Draft& draft) const
    {
        std::uint64_t sum = draft.points;
        for (const Draft* child : draft.children)
            if (child) sum += subtree_points(*child);
        return sum;
    }

    const BuildOptions& options_;
    const unsigned threads_;
    unsigned build_threads_ = 1;
    const fs::path output_;
    Watch watch_;
    PointReader& cloud_;
    const std::vector<std::string>& sources_;
    bool on_source_grid_ = false;
    fs::path folder_;
    NodeBuilderOptions node_options_;
    Observed observed_;
    BuildReport report_;
};

// Throws for options out of range; the folder that `output` names.
fs::path check(const fs::path& output, const BuildOptions& options)
{
    if (options.memory_bytes < (std::uint64_t(64) << 20))
        throw Error(ErrorCode::invalid_argument, {}, "a build needs at least 64 MiB of memory");
    if (options.chunk_points < 1000 || options.chunk_points > 10000000)
        throw Error(ErrorCode::invalid_argument, {}, "points a chunk must be between 1000 and 10000000, not " +
                                                         std::to_string(options.chunk_points));
    if (options.threads > 1024) throw Error(ErrorCode::invalid_argument, {}, "more than 1024 threads");
    fs::path folder = output;
    if (folder.filename().empty()) folder = folder.parent_path();  // "name.pct/" means name.pct
    if (folder.empty()) throw Error(ErrorCode::invalid_argument, {}, "the tree needs a name");
    return folder;
}

}  // namespace

BuildReport build_tree(const std::vector<fs::path>& inputs, const fs::path& output, const BuildOptions& options)
{
    check(output, options);  // before all files are looked at
    MergedReader cloud(inputs, options.read);
    std::vector<std::string> sources;
    for (const MergedReader::Source& source : cloud.sources()) sources.push_back(source.path.filename().string());
    return build_tree(cloud, sources, output, options);
}

BuildReport build_tree(PointReader& cloud, const std::vector<std::string>& sources, const fs::path& output,
                       const BuildOptions& options)
{
    const fs::path folder = check(output, options);
    try {
        return TreeBuild(cloud, sources, folder, options).run();
    } catch (const fs::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), error.path1(), "working in the folder");
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::io, folder, "the system has no memory left", "lower the memory of the build");
    }
}

}  // namespace pcm
