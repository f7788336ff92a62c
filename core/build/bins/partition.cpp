#include "pcm/build/bins/partition.h"

#include "pcm/build/bins/batch_queue.h"
#include "pcm/build/bins/distribute.h"
#include "pcm/build/bins/divide_bins.h"
#include "pcm/build/bins/doubles.h"
#include "pcm/build/bins/ingest.h"
#include "pcm/build/bins/position_grid.h"
#include "pcm/build/bins/record_rows.h"
#include "pcm/build/bins/spool.h"
#include "pcm/build/bins/strided_sample.h"
#include "pcm/cloud/vector.h"
#include "pcm/io/pipe/far_points.h"
#include "pcm/system/error.h"

namespace pcm {
namespace {

class Partition {
public:
    Partition(PointReader& cloud, Workspace& work, Ingested& found, const TreeInfo* like)
        : cloud_(cloud), work_(work), found_(found), like_(like), threads_(work.threads)
    {
        begin();
    }

    AnyBins run()
    {
        if (cloud_.can_keep_integers() && !like_) {
            cloud_.keep_integers(true);
            try {
                AnyBins bins = of_integers();
                found_.observed.position_error = cloud_.info().move_error;
                return bins;
            } catch (const IntegersLost&) {  // a header is wrong
                cloud_.keep_integers(false);
                begin();
            }
        }
        return cloud_.info().grid ? of_integers() : of_doubles();
    }

private:
    // Also after what was read is given up.
    void begin()
    {
        found_ = Ingested();
        found_.schema = cloud_.info().schema;
        found_.position_type = cloud_.info().position_type;
    }

    AnyBins of_integers()
    {
        found_.position_type = cloud_.info().position_type;
        if (cloud_.info().points_known && (cloud_.seekable() || fits_one_bin())) return of_grid();
        return of_grid_spool();
    }

    bool fits_one_bin()
    {
        const std::uint64_t points = cloud_.info().points;
        return points <= work_.bin_points(points);
    }

    // The rows of gridded points, and their statistics.
    void put_gridded_rows(const PointBatch& batch, std::vector<std::byte>& rows, Observed& observed) const
    {
        pcm::put_gridded_rows(batch, found_.layout, rows, observed);
    }

    void put_gridded_rows(const RecordBatch& batch, std::vector<std::byte>& rows, Observed& observed) const
    {
        put_record_rows(batch, found_.layout, rows, observed);
    }

    bool read_next(PointBatch& batch) { return cloud_.read(batch, default_batch_points); }
    bool read_next(RecordBatch& batch) { return cloud_.read_records(batch, default_batch_points); }

    // Reads the cloud on this thread, calling look(batch), and passes the batches to `take(thread, batch, rows)` on all
    // threads; `rows` is the thread's own work space. Each thread calls `end(thread)` after the last batch.
    template <class Batch, class Look, class Take, class End>
    void stream(double share, const Look& look, const Take& take, const End& end)
    {
        Signal signal;
        BatchQueue<Batch> queue(signal, threads_ + 2);
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
            if (!read_next(*batch)) break;
            found_.points_in += batch->size;
            look(*batch);
            queue.push(std::move(*batch));
            work_.watch.report("Reading points", share * cloud_.fraction_read());
        }
        queue.close();
        crew.join([&] { work_.watch.report("Reading points", share); });
    }

    std::shared_ptr<Scratch> make_scratch(std::size_t bins) const
    {
        auto scratch =
            std::make_shared<Scratch>(work_.folder / scratch_file_name, found_.layout, found_.schema, work_.space);
        scratch->add_bins(bins);
        return scratch;
    }

    // Gridded, seekable input (or so few points that they are one bin): sample, cut, distribute while parsing.
    AnyBins of_grid()
    {
        using Coord = std::uint32_t;
        set_source_grid();
        found_.layout = RowLayout(found_.schema, false);
        const std::uint64_t points = cloud_.info().points;
        const std::uint64_t per_bin = work_.bin_points(points);

        Bins<Coord> result;
        std::size_t bins = 1;
        if (points > per_bin) {
            TopPlanner<Coord>::Sample sample = sample_evenly(cloud_);
            bins = TopPlanner<Coord>(result.top, finer_, per_bin).plan(0, sample, points, 0);
        }
        result.scratch = make_scratch(bins);
        if (cloud_.has_records())
            distribute_batches<RecordBatch>(result, bins);
        else
            distribute_batches<PointBatch>(result, bins);
        divide_large_bins(result, work_, finer_, per_bin);
        return result;
    }

    template <class Batch>
    void distribute_batches(const Bins<std::uint32_t>& to, std::size_t bins)
    {
        std::vector<Observed> observed(threads_);
        std::vector<std::unique_ptr<Scratch::Writer>> writers;
        for (unsigned t = 0; t < threads_; ++t)
            writers.push_back(std::make_unique<Scratch::Writer>(*to.scratch, 0, bins, work_.writer_bytes()));
        stream<Batch>(
            0.4, [](const Batch&) {},
            [&](unsigned t, const Batch& batch, std::vector<std::byte>& rows) {
                put_gridded_rows(batch, rows, observed[t]);
                add_to_bins(to.top, rows.data(), batch.size, found_.layout.bytes, *writers[t]);
            },
            [&](unsigned t) { writers[t]->flush(); });
        for (const Observed& o : observed) found_.observed.merge(o);
    }

    // Gridded input that can only be read in order: one parse into a spool of rows, which are then distributed.
    AnyBins of_grid_spool()
    {
        using Coord = std::uint32_t;
        set_source_grid();
        found_.layout = RowLayout(found_.schema, false);
        Spool spool(work_.folder / "spool.tmp", found_.layout, found_.schema, false, work_.space);
        StridedSample<std::array<Coord, 3>> sample;
        if (cloud_.has_records())
            spool_batches<RecordBatch>(spool, sample);
        else
            spool_batches<PointBatch>(spool, sample);
        return of_spool<Coord>(spool, sample.items(), [](unsigned, std::byte* row) { return row; });
    }

    template <class Batch>
    void spool_batches(Spool& spool, StridedSample<std::array<std::uint32_t, 3>>& sample)
    {
        std::vector<Observed> observed(threads_);
        std::vector<Spool::Writer> writers(threads_, Spool::Writer(spool));
        stream<Batch>(
            0.25,
            [&](const Batch& batch) {
                for (std::size_t i = 0; i < batch.size; ++i) sample.see(coordinates_of(batch, i));
            },
            [&](unsigned t, const Batch& batch, std::vector<std::byte>& rows) {
                put_gridded_rows(batch, rows, observed[t]);
                writers[t].append(rows.data(), batch.size);
            },
            [](unsigned) {});
        for (const Observed& o : observed) found_.observed.merge(o);
    }

    // Anything else: one parse into a spool of rows with positions in double, which finds the largest coordinates; then
    // the spool is put on a grid and distributed.
    AnyBins of_doubles()
    {
        const RowLayout layout(found_.schema, true);
        Spool spool(work_.folder / "spool.tmp", layout, found_.schema, true, work_.space);
        FarPoints positions;
        const bool with_decimals = counts_decimals(cloud_.info()) && !like_;
        std::vector<DoubleRows> makers(threads_, DoubleRows(layout, with_decimals));
        StridedSample<Vec3d> sample;
        std::vector<Spool::Writer> writers(threads_, Spool::Writer(spool));
        stream<PointBatch>(
            0.25,
            [&](const PointBatch& batch) {
                for (std::size_t i = 0; i < batch.size; ++i) {
                    const Vec3d p{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
                    if (!is_finite(p)) {
                        ++found_.points_skipped;
                        continue;
                    }
                    positions.watch(p);
                    sample.see(p);
                }
            },
            [&](unsigned t, const PointBatch& batch, std::vector<std::byte>& rows) {
                const std::size_t kept = makers[t].put(batch, rows);
                writers[t].append(rows.data(), kept);
            },
            [](unsigned) {});
        if (found_.points_skipped) found_.notes.push_back(note_of_skipped(found_.points_skipped));
        for (std::size_t a = 0; a < 3 && with_decimals; ++a) {
            for (unsigned t = 1; t < threads_; ++t) makers[0].decimals()[a].merge(makers[t].decimals()[a]);
            found_.decimals[a] = makers[0].decimals()[a].places();
        }
        if (choose_grid(positions)) return put_on_grid<std::uint32_t>(spool, sample);
        return put_on_grid<std::uint64_t>(spool, sample);
    }

    template <class Coord>
    AnyBins put_on_grid(Spool& spool, StridedSample<Vec3d>& sample)
    {
        found_.layout = RowLayout(found_.schema, sizeof(Coord) == 8);
        const GridRows<Coord> on_grid(found_.grid, found_.decimals);
        typename TopPlanner<Coord>::Sample coordinates;
        coordinates.reserve(sample.items().size());
        for (const Vec3d& p : sample.items()) coordinates.push_back(on_grid.on_grid(p));
        sample = StridedSample<Vec3d>();
        struct Seen {
            Observed observed;
            bool rounded = false;
        };
        std::vector<Seen> seen(threads_);
        AnyBins bins = of_spool<Coord>(spool, coordinates, [&](unsigned t, std::byte* row) {
            return on_grid.convert(row, found_.layout.bytes, seen[t].observed, seen[t].rounded);
        });
        bool rounded = false;
        for (const Seen& of_thread : seen) {
            rounded = rounded || of_thread.rounded;
            found_.observed.merge(of_thread.observed);
        }
        if (!rounded) found_.decimals = {no_decimals, no_decimals, no_decimals};
        return bins;
    }

    // Distributes a spool; `convert(thread, row)` gives the bins' row for one of the spool's.
    template <class Coord, class Convert>
    AnyBins of_spool(Spool& spool, typename TopPlanner<Coord>::Sample& sample, const Convert& convert)
    {
        const std::uint64_t per_bin = work_.bin_points(spool.rows());
        Bins<Coord> result;
        const TopTree<Coord>& top = result.top;
        std::size_t bins = 1;
        if (spool.rows() > per_bin)
            bins = TopPlanner<Coord>(result.top, finer_, per_bin).plan(0, sample, spool.rows(), 0);
        typename TopPlanner<Coord>::Sample().swap(sample);
        result.scratch = make_scratch(bins);
        distribute(
            work_, spool.pieces(), [&](std::size_t piece, std::vector<std::byte>& rows) { spool.read(piece, rows); },
            [&](std::size_t piece) { spool.give_back(piece); }, spool.row_bytes(), *result.scratch, 0, bins,
            [&](unsigned t, std::byte* row, Scratch::Writer& writer) {
                const std::byte* converted = convert(t, row);
                writer.add(top.bin_of(coordinates_of<Coord>(converted)), converted);
            });
        divide_large_bins(result, work_, finer_, per_bin);
        return result;
    }

    void set_grid(const Grid& grid)
    {
        found_.grid = grid;
        finer_ = axis_shift(grid);
    }

    void set_source_grid()
    {
        if (!like_) check_tree_grid(*cloud_.info().grid);
        set_grid(*cloud_.info().grid);
    }

    // True when all positions are narrow on the grid.
    bool choose_grid(const FarPoints& positions)
    {
        if (like_) {
            set_grid(like_->grid);
            return !like_->wide;
        }
        const bool narrow = pcm::choose_grid(cloud_.info(), positions, found_);
        finer_ = axis_shift(found_.grid);
        return narrow;
    }

    PointReader& cloud_;
    Workspace& work_;
    Ingested& found_;
    const TreeInfo* const like_;
    AxisShift finer_{0, 0, 0};
    const unsigned threads_;
};

}  // namespace

AnyBins partition(PointReader& cloud, Workspace& work, Ingested& found, const TreeInfo* like)
{
    return Partition(cloud, work, found, like).run();
}

}  // namespace pcm
