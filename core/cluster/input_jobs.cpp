#include "pcm/cluster/input_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/bins/distribute.h"
#include "pcm/build/bins/divide_bins.h"
#include "pcm/build/bins/ingest.h"
#include "pcm/build/bins/partition.h"
#include "pcm/build/bins/position_grid.h"
#include "pcm/build/bins/reader_facts.h"
#include "pcm/build/bins/record_rows.h"
#include "pcm/build/build_checkpoint.h"
#include "pcm/cluster/batch_files.h"
#include "pcm/cluster/batches.h"
#include "pcm/cluster/division_jobs.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/shared_record.h"
#include "pcm/cluster/spool_jobs.h"
#include "pcm/cluster/stages.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

namespace pcm {
namespace {

using Narrow = std::uint32_t;
using Key = JobFolder::Key;
constexpr Key plan_of_cloud{stage::plan, 0}, plan_of_kept_integers{stage::plan, 1};

class InputJobs {
public:
    InputJobs(const TeamWork& all, MergedReader& cloud, Ingested& found, BinRows& rows)
        : team_(all.team),
          jobs_(all.jobs),
          work_(all.work),
          options_(all.options),
          all_(all),
          cloud_(cloud),
          header_(cloud.info()),
          found_(found),
          rows_(rows)
    {
    }

    AnyTop run()
    {
        jobs_.begin(stage::plan);
        jobs_.begin(stage::batches);
        if (cloud_.can_keep_integers()) {
            cloud_.keep_integers(true);
            if (can_be_read_in_batches())
                if (auto top = follow_plan(plan_of_kept_integers, [&] { return plan_batches(); }))
                    return std::move(*top);
            cloud_.keep_integers(false);  // as they can be where a header is wrong
        }
        if (can_be_spooled(cloud_, options_.read)) return spool_input(all_, cloud_, header_, found_, rows_);
        return *follow_plan(plan_of_cloud, [&] { return can_be_read_in_batches() ? plan_batches() : read_by_one(); });
    }

private:
    // Kinds of plans, their first byte.
    enum Plan : std::uint8_t { take_bins_of_one, read_in_batches, integers_lost };

    // The cuts between the bins; none where integers were lost.
    template <class Make>
    std::optional<AnyTop> follow_plan(const Key& key, const Make& make)
    {
        const std::vector<std::byte> plan = find_or_make(team_, jobs_, key, make);
        ByteReader in(plan.data(), plan.size(), jobs_.file(key));
        switch (in.get<std::uint8_t>()) {
            case take_bins_of_one:
                return take_bins(in);
            case read_in_batches:
                return read_batches(in);
            default:
                return std::nullopt;
        }
    }

    // Whether points can be read from anywhere, and nothing is left out of what the headers promise.
    bool can_be_read_in_batches() const
    {
        const FileInfo& info = cloud_.info();
        return info.grid && info.points_known && cloud_.seekable() && !options_.read.skip_bad_files &&
               !options_.read.largest_coordinate;
    }

    // Collective: the sample of all ranks, in rank 0. False where integers were lost.
    bool sample_together(TopPlanner<Narrow>::Sample& sample)
    {
        std::vector<std::array<Narrow, 3>> share;
        bool kept = true;
        try {
            share = sample_evenly(cloud_, team_.rank(), team_.size());
        } catch (const IntegersLost&) {
            kept = false;
        }
        ByteWriter mine;
        mine.put(static_cast<std::uint8_t>(kept));
        mine.put_bytes(reinterpret_cast<const std::byte*>(share.data()), share.size() * sizeof share[0]);
        for (const Team::Bytes& part : team_.gather(std::move(mine.bytes()))) {
            ByteReader in(part.data(), part.size(), work_.folder);
            kept = in.get<std::uint8_t>() && kept;
            if (team_.rank() != 0) continue;
            const std::size_t before = sample.size(), bytes = in.left();
            sample.resize(before + bytes / sizeof sample[0]);
            if (bytes > 0) std::memcpy(sample.data() + before, in.get_bytes(bytes), bytes);
        }
        return kept;
    }

    // Collective; the plan is rank 0's.
    std::vector<std::byte> plan_batches()
    {
        const std::uint64_t points = cloud_.info().points, per_bin = work_.bin_points(points);
        check_tree_grid(*cloud_.info().grid);
        TopTree<Narrow> top;
        std::size_t bins = 1;
        TopPlanner<Narrow>::Sample sample;
        if (points > per_bin && !sample_together(sample)) return {std::byte(integers_lost)};
        if (team_.rank() != 0) return {};
        if (!sample.empty())
            bins = TopPlanner<Narrow>(top, axis_shift(*cloud_.info().grid), per_bin).plan(0, sample, points, 0);
        ByteWriter plan;
        plan.put(static_cast<std::uint8_t>(read_in_batches));
        plan.put(batch_size(points));
        plan.put(static_cast<std::uint64_t>(bins));
        save_top(top, plan);
        return std::move(plan.bytes());
    }

    // What rank 0 reads alone lies with the plan.
    struct WorkOfOne : Workspace {
        explicit WorkOfOne(const InputJobs& all)
            : Workspace(all.jobs_.file(plan_of_cloud).parent_path(), all.work_.memory_bytes, all.work_.chunk_points,
                        all.work_.threads, all.options_.progress)
        {
        }
    };

    // By rank 0; the plan is the result.
    std::vector<std::byte> read_by_one()
    {
        if (team_.rank() != 0) return {};
        WorkOfOne work(*this);
        const AnyBins bins = partition(cloud_, work, found_);
        take_reader_facts(cloud_.info(), found_);
        ByteWriter plan;
        plan.put(static_cast<std::uint8_t>(take_bins_of_one));
        save_bins(found_, bins, plan);
        std::visit([](const auto& of) { of.scratch->sync(); }, bins);
        found_ = Ingested();
        return std::move(plan.bytes());
    }

    AnyTop take_bins(ByteReader& in)
    {
        WorkOfOne work(*this);
        const AnyBins bins = load_bins(found_, work, cloud_.info().schema, in);
        const std::uint32_t file = rows_.add_file(work.folder / scratch_file_name);
        return std::visit(
            [&](const auto& of) -> AnyTop {
                rows_.add_bins(of.scratch->bins());
                ByteWriter pieces;
                BinRows::save(*of.scratch, pieces);
                ByteReader from(pieces.bytes().data(), pieces.size(), work_.folder);
                for (auto& [bin, piece] : BinRows::load(from, file)) rows_.add(bin, std::move(piece));
                return of.top;
            },
            bins);
    }

    // None where integers were lost.
    std::optional<AnyTop> read_batches(ByteReader& in)
    {
        const auto size = in.get<std::uint64_t>();
        const auto bins = in.get<std::uint64_t>();
        top_ = load_top<Narrow>(in);
        found_.schema = cloud_.info().schema;
        found_.position_type = cloud_.info().position_type;
        found_.grid = *cloud_.info().grid;
        found_.layout = RowLayout(found_.schema, false);
        make_starts();
        const std::vector<Batch> batches = batches_of(cloud_.points_of_sources(), size);
        share_jobs(
            team_, count_batches, batches.size(), 1,
            [&](std::size_t i) {
                if (!jobs_.is_done({stage::batches, i})) read_batch(i, batches[i], bins);
            },
            [&](std::size_t begun) {
                work_.watch.report("Reading points", 0.4 * static_cast<double>(begun) /
                                                         static_cast<double>(std::max<std::size_t>(1, batches.size())));
            });
        buffer_ = {};
        FileInfo info = header_;
        const BatchFacts facts = take_batches(team_, jobs_, stage::batches, batches.size(), bins, rows_, info);
        if (!facts.kept) {
            found_ = Ingested();
            return std::nullopt;
        }
        found_.observed = facts.observed;
        found_.points_in = found_.observed.points;
        take_reader_facts(info, found_);
        divide_bins<Narrow>(all_, found_, top_, rows_);
        return AnyTop(std::move(top_));
    }

    // For bin_of(): over the box of all files, where it is known.
    void make_starts()
    {
        if (top_.nodes.size() == 1 || !cloud_.info().promised_box) return;
        std::array<Narrow, 3> low, high;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto at = [&](double value) {
                const double q = (value - found_.grid.offset[a]) / found_.grid.scale[a];
                return to_coordinate<Narrow>(static_cast<std::int32_t>(std::clamp(q, -2147483648.0, 2147483647.0)));
            };
            low[a] = at(cloud_.info().promised_box->min[a]);
            high[a] = at(cloud_.info().promised_box->max[a]);
            if (high[a] < low[a]) return;
        }
        top_.make_starts(low, high, axis_shift(found_.grid));
    }

    void read_batch(std::size_t number, const Batch& batch, std::size_t bins)
    {
        const Key job{stage::batches, number};
        const std::filesystem::path path = jobs_.unfinished(job);
        BatchFacts facts;
        std::uint64_t bytes;
        ByteWriter record;
        {
            Scratch scratch(path, found_.layout, found_.schema, work_.space);
            scratch.add_bins(bins);
            Scratch::Writer writer(scratch, 0, bins, work_.memory_bytes / 4, std::move(buffer_));
            const std::size_t notes = cloud_.info().notes.size(), blocks = cloud_.info().metadata.size();
            facts.kept = distribute(batch, writer, facts.observed);
            writer.flush();
            buffer_ = writer.take_buffer();
            facts.late = LateFacts::since(cloud_.info(), notes, blocks);
            bytes = scratch.bytes();
            save_batch(facts, scratch, record);
        }
        jobs_.finish(job, path, bytes, record.bytes());
    }

    bool read_next(PointBatch& points, std::size_t most) { return cloud_.read(points, most); }
    bool read_next(RecordBatch& points, std::size_t most) { return cloud_.read_records(points, most); }
    void put_rows(const PointBatch& points, Observed& observed)
    {
        put_gridded_rows(points, found_.layout, row_bytes_, observed);
    }
    void put_rows(const RecordBatch& points, Observed& observed)
    {
        put_record_rows(points, found_.layout, row_bytes_, observed);
    }

    // False where integers were lost.
    bool distribute(const Batch& batch, Scratch::Writer& writer, Observed& observed)
    {
        try {
            cloud_.seek(batch.first);
            if (cloud_.has_records())
                distribute_points<RecordBatch>(batch, writer, observed);
            else
                distribute_points<PointBatch>(batch, writer, observed);
        } catch (const IntegersLost&) {
            return false;
        }
        observed.position_error = cloud_.info().move_error;  // since seek()
        return true;
    }

    template <class Points>
    void distribute_points(const Batch& batch, Scratch::Writer& writer, Observed& observed)
    {
        Points points;
        for (std::uint64_t at = batch.first; at < batch.end; at += points.size) {
            const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(default_batch_points, batch.end - at));
            if (!read_next(points, most) || points.size == 0)
                throw Error(ErrorCode::truncated, {},
                            "the input ends at point " + std::to_string(at) + ", " +
                                std::to_string(cloud_.info().points) + " were expected");
            put_rows(points, observed);
            add_to_bins(top_, row_bytes_.data(), points.size, found_.layout.bytes, writer);
        }
    }

    Team& team_;
    const JobFolder& jobs_;
    Workspace& work_;
    const BuildOptions& options_;
    const TeamWork& all_;
    MergedReader& cloud_;
    const FileInfo header_;  // before points are read
    Ingested& found_;
    BinRows& rows_;
    TopTree<Narrow> top_;
    std::vector<std::byte> row_bytes_, buffer_;
};

}  // namespace

AnyTop read_input(const TeamWork& team_work, MergedReader& cloud, Ingested& found, BinRows& rows)
{
    return InputJobs(team_work, cloud, found, rows).run();
}

}  // namespace pcm
