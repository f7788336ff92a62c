#include "pcm/build/bins/partition.h"

#include "pcm/bpc/chunk_codec.h"
#include "pcm/build/bins/batch_queue.h"
#include "pcm/build/bins/ingest.h"
#include "pcm/build/bins/spool.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {
namespace {

class Partition {
public:
    Partition(PointReader& cloud, BuildState& state)
        : cloud_(cloud),
          state_(state),
          nodes_(state.nodes),
          threads_(state.threads),
          memory_(state.options.memory_bytes)
    {
        nodes_.schema = cloud_.info().schema;
        state_.position_type = cloud_.info().position_type;
    }

    AnyBins run()
    {
        if (!cloud_.info().grid) return of_doubles();
        if (cloud_.info().points_known && (cloud_.seekable() || fits_one_bin())) return of_grid();
        return of_grid_spool();
    }

private:
    bool fits_one_bin()
    {
        const RowLayout layout(cloud_.info().schema, false);
        return cloud_.info().points <= state_.bin_points(layout.bytes, sizeof(std::uint32_t));
    }

    // The rows of gridded points, and what they say about themselves.
    void put_gridded_rows(const PointBatch& batch, std::vector<std::byte>& rows, Observed& observed) const
    {
        const RowLayout& layout = nodes_.layout;
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

    // Reads the cloud on this thread, calling look(batch), and hands the batches to `take(thread, batch, rows)` on all
    // threads; `rows` is work space of the thread's own. `end(thread)` is called when there are no more.
    template <class Look, class Take, class End>
    void stream(double share, const Look& look, const Take& take, const End& end)
    {
        Signal signal;
        BatchQueue queue(signal, threads_ + 2);
        Crew crew(signal);
        for (unsigned t = 0; t < threads_; ++t)
            crew.add([&, t] {
                std::vector<std::byte> rows;
                while (auto batch = queue.pop()) {
                    take(t, *batch, rows);
                    queue.recycle(std::move(*batch));
                }
                if (!signal.stopped) end(t);
            });
        while (auto batch = queue.empty_batch()) {
            if (!cloud_.read(*batch, default_batch_points)) break;
            state_.points_in += batch->size;
            look(*batch);
            queue.push(std::move(*batch));
            state_.watch.report("Reading points", share * cloud_.fraction_read());
        }
        queue.close();
        crew.join([&] { state_.watch.report("Reading points", share); });
    }

    std::shared_ptr<Scratch> make_scratch(std::size_t bins) const
    {
        auto scratch =
            std::make_shared<Scratch>(state_.folder / scratch_file_name, nodes_.layout, nodes_.schema, state_.space);
        scratch->add_bins(bins);
        return scratch;
    }

    // Gridded, seekable input (or so little that there is nothing to cut): sample, cut, distribute while parsing.
    AnyBins of_grid()
    {
        using Coord = std::uint32_t;
        set_grid(*cloud_.info().grid);
        nodes_.layout = RowLayout(nodes_.schema, false);
        const RowLayout& layout = nodes_.layout;
        const std::uint64_t points = cloud_.info().points;
        const std::uint64_t per_bin = state_.bin_points(layout.bytes, sizeof(Coord));

        Bins<Coord> result;
        const TopTree<Coord>& top = result.top;
        std::size_t bins = 1;
        if (points > per_bin) {
            TopPlanner<Coord>::Sample sample;
            for (const Vec3i& p : sample_evenly(cloud_, sample_points(points, per_bin)))
                sample.push_back({to_coordinate<Coord>(p[0]), to_coordinate<Coord>(p[1]), to_coordinate<Coord>(p[2])});
            bins = TopPlanner<Coord>(result.top, nodes_.lattice.finer, per_bin).plan(0, sample, points, 0);
        }
        result.scratch = make_scratch(bins);
        std::vector<Observed> observed(threads_);
        std::vector<std::unique_ptr<Scratch::Writer>> writers;
        for (unsigned t = 0; t < threads_; ++t)
            writers.push_back(std::make_unique<Scratch::Writer>(*result.scratch, 0, bins, memory_ / 4 / threads_));
        stream(
            0.4, [](const PointBatch&) {},
            [&](unsigned t, const PointBatch& batch, std::vector<std::byte>& rows) {
                put_gridded_rows(batch, rows, observed[t]);
                for (std::size_t i = 0; i < batch.size; ++i) {
                    const std::byte* row = rows.data() + i * layout.bytes;
                    writers[t]->add(top.bin_of(coordinates_of<Coord>(row)), row);
                }
            },
            [&](unsigned t) { writers[t]->flush(); });
        writers.clear();
        for (const Observed& o : observed) state_.observed.merge(o);
        divide_large_bins(result, per_bin);
        return result;
    }

    // Gridded input that can only be read in order: one parse into a spool of rows, which are then distributed.
    AnyBins of_grid_spool()
    {
        using Coord = std::uint32_t;
        set_grid(*cloud_.info().grid);
        nodes_.layout = RowLayout(nodes_.schema, false);
        Spool spool(state_.folder / "spool.tmp", nodes_.layout, nodes_.schema, false, state_.space);
        using Coordinates = std::array<Coord, 3>;
        StridedSample<Coordinates> sample(static_cast<std::size_t>(memory_ / 16 / sizeof(Coordinates)));
        std::vector<Observed> observed(threads_);
        std::vector<Spool::Writer> writers(threads_, Spool::Writer(spool));
        stream(
            0.25,
            [&](const PointBatch& batch) {
                for (std::size_t i = 0; i < batch.size; ++i)
                    sample.see({to_coordinate<Coord>(batch.grid_xyz[0][i]), to_coordinate<Coord>(batch.grid_xyz[1][i]),
                                to_coordinate<Coord>(batch.grid_xyz[2][i])});
            },
            [&](unsigned t, const PointBatch& batch, std::vector<std::byte>& rows) {
                put_gridded_rows(batch, rows, observed[t]);
                writers[t].append(rows.data(), batch.size);
            },
            [](unsigned) {});
        for (const Observed& o : observed) state_.observed.merge(o);
        return of_spool<Coord>(spool, sample.items(), [](unsigned, std::byte* row) { return row; });
    }

    // Anything else: one parse into a spool of rows with positions in double, which shows how large coordinates get;
    // then the spool is put on a grid and distributed.
    AnyBins of_doubles()
    {
        const RowLayout layout(nodes_.schema, true);
        Spool spool(state_.folder / "spool.tmp", layout, nodes_.schema, true, state_.space);
        Box3d box;
        StridedSample<Vec3d> sample(static_cast<std::size_t>(memory_ / 16 / sizeof(Vec3d)));
        const auto position = [](const PointBatch& batch, std::size_t i) {
            return Vec3d{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
        };
        std::vector<Spool::Writer> writers(threads_, Spool::Writer(spool));
        stream(
            0.25,
            [&](const PointBatch& batch) {
                for (std::size_t i = 0; i < batch.size; ++i) {
                    const Vec3d p = position(batch, i);
                    if (!is_finite(p)) {
                        ++state_.points_skipped;
                        continue;
                    }
                    box.extend(p);
                    sample.see(p);
                }
            },
            [&](unsigned t, const PointBatch& batch, std::vector<std::byte>& rows) {
                rows.resize(batch.size * layout.bytes);
                put_attributes(batch, layout, rows.data());
                std::size_t kept = 0;
                for (std::size_t i = 0; i < batch.size; ++i) {
                    const Vec3d p = position(batch, i);
                    if (!is_finite(p)) continue;
                    std::byte* row = rows.data() + kept++ * layout.bytes;
                    if (row != rows.data() + i * layout.bytes)
                        std::memmove(row, rows.data() + i * layout.bytes, layout.bytes);
                    std::memcpy(row, p.data(), sizeof p);
                }
                writers[t].append(rows.data(), kept);
            },
            [](unsigned) {});
        if (state_.points_skipped)
            state_.notes.push_back(std::to_string(state_.points_skipped) +
                                   " points without a finite position were left out");
        if (choose_grid(box)) return put_on_grid<std::uint32_t>(spool, sample);
        return put_on_grid<std::uint64_t>(spool, sample);
    }

    // Rows of doubles become rows of Coord, in place: with narrow coordinates a row begins later.
    template <class Coord>
    AnyBins put_on_grid(Spool& spool, StridedSample<Vec3d>& sample)
    {
        static_assert(sizeof(Coord) <= sizeof(double));
        constexpr std::size_t shift = 3 * (sizeof(double) - sizeof(Coord));
        nodes_.layout = RowLayout(nodes_.schema, sizeof(Coord) == 8);
        const Grid& grid = nodes_.grid;
        const auto on_grid = [&](const Vec3d& p) {
            std::array<Coord, 3> c;
            for (std::size_t a = 0; a < 3; ++a)
                c[a] = to_coordinate<Coord>(to_grid_position(p[a], grid.scale[a], grid.offset[a]));
            return c;
        };
        typename TopPlanner<Coord>::Sample coordinates;
        coordinates.reserve(sample.items().size());
        for (const Vec3d& p : sample.items()) coordinates.push_back(on_grid(p));
        sample = StridedSample<Vec3d>(0);
        std::vector<Observed> observed(threads_);
        AnyBins bins = of_spool<Coord>(spool, coordinates, [&](unsigned t, std::byte* row) {
            Observed& seen = observed[t];
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
            seen.hash += hash_rows(row, 1, nodes_.layout.bytes);
            return row;
        });
        for (const Observed& o : observed) state_.observed.merge(o);
        return bins;
    }

    // Distributes a spool; `convert(thread, row)` gives the bins' row for one of the spool's.
    template <class Coord, class Convert>
    AnyBins of_spool(Spool& spool, typename TopPlanner<Coord>::Sample& sample, const Convert& convert)
    {
        const std::uint64_t per_bin = state_.bin_points(nodes_.layout.bytes, sizeof(Coord));
        Bins<Coord> result;
        const TopTree<Coord>& top = result.top;
        std::size_t bins = 1;
        if (spool.rows() > per_bin)
            bins = TopPlanner<Coord>(result.top, nodes_.lattice.finer, per_bin).plan(0, sample, spool.rows(), 0);
        typename TopPlanner<Coord>::Sample().swap(sample);
        result.scratch = make_scratch(bins);
        distribute(
            spool.pieces(), [&](std::size_t piece, std::vector<std::byte>& rows) { spool.read(piece, rows); },
            [&](std::size_t piece) { spool.give_back(piece); }, spool.row_bytes(), *result.scratch, 0, bins,
            [&](unsigned t, std::byte* row, Scratch::Writer& writer) {
                const std::byte* converted = convert(t, row);
                writer.add(top.bin_of(coordinates_of<Coord>(converted)), converted);
            });
        divide_large_bins(result, per_bin);
        return result;
    }

    // Moves rows, read piece by piece, into bins [first, first + bins) of `to`, on all threads. `put(thread, row,
    // writer)` adds a row to its bin; `done(piece)` is called when a piece has gone.
    template <class Read, class Done, class Put>
    void distribute(std::size_t pieces, const Read& read, const Done& done, std::size_t row_bytes, Scratch& to,
                    std::size_t first, std::size_t bins, const Put& put)
    {
        std::atomic<std::size_t> next{0};
        Signal signal;
        Crew crew(signal);
        for (unsigned t = 0; t < threads_; ++t)
            crew.add([&, t] {
                Scratch::Writer writer(to, first, bins, memory_ / 4 / threads_);
                std::vector<std::byte> rows;
                for (std::size_t piece; !signal.stopped && (piece = next++) < pieces;) {
                    rows.clear();
                    read(piece, rows);
                    for (std::size_t at = 0; at < rows.size(); at += row_bytes) put(t, rows.data() + at, writer);
                    done(piece);
                }
                if (!signal.stopped) writer.flush();
            });
        crew.join([&] { state_.watch.report("Sorting points into bins", 0.3); });
    }

    // Bins that came out larger than planned (a sample can miss a dense spot) are divided again.
    template <class Coord>
    void divide_large_bins(Bins<Coord>& of, std::uint64_t per_bin)
    {
        TopTree<Coord>& top = of.top;
        Scratch& scratch = *of.scratch;
        const std::size_t row_bytes = scratch.row_bytes();
        const std::uint64_t limit = per_bin + per_bin / 2;
        std::vector<unsigned> piles;
        for (std::uint32_t n = 0; n < top.nodes.size(); ++n) {
            if (top.nodes[n].children[0]) continue;
            const std::size_t bin = top.nodes[n].bin;
            if (scratch.rows(bin) <= limit) continue;
            // Rows lie in the order that threads wrote them; a sample by the rows' hashes is the same whatever the
            // order.
            std::vector<std::byte> rows;
            TopPlanner<Coord> planner(top, nodes_.lattice.finer, per_bin);
            typename TopPlanner<Coord>::Sample chosen;
            const std::uint64_t keep_one_in = std::max<std::uint64_t>(1, scratch.rows(bin) / 100000);
            for (std::size_t e = 0; e < scratch.extents(bin); ++e) {
                rows.clear();
                scratch.read(bin, e, rows);
                for (std::size_t at = 0; at < rows.size(); at += row_bytes)
                    if (checksum(rows.data() + at, row_bytes) % keep_one_in == 0)
                        chosen.push_back(coordinates_of<Coord>(rows.data() + at));
            }
            const std::size_t first = scratch.bins();
            const std::size_t bins = planner.plan(n, chosen, scratch.rows(bin), first);
            if (bins == 1) {
                top.nodes[n].bin = bin;
                divide_pile(of, n, per_bin, piles);
                continue;
            }
            scratch.add_bins(bins);
            distribute(
                scratch.extents(bin), [&](std::size_t e, std::vector<std::byte>& to) { scratch.read(bin, e, to); },
                [&](std::size_t e) { scratch.give_back(bin, e); }, row_bytes, scratch, first, bins,
                [&](unsigned, const std::byte* row, Scratch::Writer& writer) {
                    writer.add(top.bin_of(coordinates_of<Coord>(row), n), row);
                });
            scratch.forget(bin);
        }
    }

    // Divides the bin of node `n`, most of whose points lie in one place, into bins that overlap: by the rows' hashes,
    // or, where all rows are the same, in turn. `rounds` counts, for each node, how often that was done above it.
    template <class Coord>
    void divide_pile(Bins<Coord>& of, std::uint32_t n, std::uint64_t per_bin, std::vector<unsigned>& rounds)
    {
        constexpr unsigned most_rounds = 16;  // each leaves few rows beside those that are often the same
        auto& nodes = of.top.nodes;
        Scratch& scratch = *of.scratch;
        const std::size_t row_bytes = scratch.row_bytes(), bin = nodes[n].bin;
        rounds.resize(nodes.size());
        const unsigned round = rounds[n] + 1;
        if (round > most_rounds) return;
        int bits = 1;
        while (scratch.rows(bin) >> bits > per_bin) ++bits;

        std::vector<std::byte> rows, model;
        bool same = true;
        for (std::size_t e = 0; same && e < scratch.extents(bin); ++e) {
            rows.clear();
            scratch.read(bin, e, rows);
            if (model.empty()) model.assign(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(row_bytes));
            for (std::size_t at = 0; same && at < rows.size(); at += row_bytes)
                same = std::memcmp(rows.data() + at, model.data(), row_bytes) == 0;
        }
        const std::size_t bins = std::size_t(1) << bits, first = scratch.add_bins(bins);
        std::atomic<std::uint64_t> turn{0};
        distribute(
            scratch.extents(bin), [&](std::size_t e, std::vector<std::byte>& to) { scratch.read(bin, e, to); },
            [&](std::size_t e) { scratch.give_back(bin, e); }, row_bytes, scratch, first, bins,
            [&](unsigned, const std::byte* row, Scratch::Writer& writer) {
                // Odd multiples, another one each round: what one leaves together the next one parts.
                const std::uint64_t hash = checksum(row, row_bytes) * (0x9e3779b97f4a7c15u + 2 * std::uint64_t(round));
                writer.add(first + (same ? turn++ % bins : hash >> (64 - bits)), row);
            });
        scratch.forget(bin);

        std::vector<std::uint32_t> leaves{n};
        while (leaves.size() < bins) {
            std::vector<std::uint32_t> below;
            for (const std::uint32_t parent : leaves) {
                const auto child = static_cast<std::uint32_t>(nodes.size());
                nodes.resize(nodes.size() + 2);
                nodes[parent].children = {child, child + 1};
                below.insert(below.end(), {child, child + 1});
            }
            leaves = std::move(below);
        }
        rounds.resize(nodes.size());
        for (std::size_t k = 0; k < bins; ++k) {
            nodes[leaves[k]].bin = first + k;
            rounds[leaves[k]] = round;
        }
    }

    std::size_t sample_points(std::uint64_t points, std::uint64_t per_bin) const
    {
        const std::uint64_t wanted = std::max<std::uint64_t>(200000, points / per_bin * 4096);
        return static_cast<std::size_t>(std::min({wanted, memory_ / 16 / 24, points}));
    }

    void set_grid(const Grid& grid)
    {
        nodes_.grid = grid;
        nodes_.lattice = Lattice(grid);
    }

    // Doubles that come from integers keep those integers' grid; else a power of two an axis, the finest that holds the
    // largest coordinate. True when all positions are narrow on it.
    bool choose_grid(const Box3d& box)
    {
        if (state_.like) {
            set_grid(state_.like->grid);
            return !state_.like->wide;
        }
        Grid grid;
        Vec3d largest{0, 0, 0};
        for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
            largest[a] = std::max(std::fabs(box.min[a]), std::fabs(box.max[a]));
        if (cloud_.info().near_grid && tells_apart(*cloud_.info().near_grid, largest)) {
            grid = *cloud_.info().near_grid;
            set_grid(grid);
            state_.position_type = ScalarType::i32;
            bool narrow = true;
            for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
                for (const double end : {box.min[a], box.max[a]}) {
                    const std::int64_t q = to_grid_position(end, grid.scale[a], grid.offset[a]);
                    narrow = narrow && q >= std::numeric_limits<std::int32_t>::min() &&
                             q <= std::numeric_limits<std::int32_t>::max();
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
            if (!((largest[a] + std::fabs(grid.offset[a])) / std::fabs(grid.scale[a]) <= std::ldexp(1.0, 50)))
                return false;
        return true;
    }

    PointReader& cloud_;
    BuildState& state_;
    NodeBuilderOptions& nodes_;
    const unsigned threads_;
    const std::uint64_t memory_;
};

}  // namespace

AnyBins partition(PointReader& cloud, BuildState& state) { return Partition(cloud, state).run(); }

}  // namespace pcm
