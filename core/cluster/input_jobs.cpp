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
#include "pcm/cluster/batches.h"
#include "pcm/cluster/division_jobs.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pcm {
namespace {

using Narrow = std::uint32_t;
using Key = JobFolder::Key;
constexpr const char* plan_stage = "plan";
constexpr const char* batch_stage = "batches";

class InputJobs {
public:
    InputJobs(const TeamWork& all, MergedReader& cloud, Ingested& found, BinRows& rows)
        : team_(all.team),
          jobs_(all.jobs),
          work_(all.work),
          options_(all.options),
          all_(all),
          cloud_(cloud),
          found_(found),
          rows_(rows)
    {
    }

    AnyTop run()
    {
        jobs_.begin(plan_stage);
        jobs_.begin(batch_stage);
        const std::vector<std::byte> plan = find_or_make_plan();
        ByteReader in(plan.data(), plan.size(), jobs_.file({plan_stage}));
        return in.get<std::uint8_t>() ? read_batches(in) : take_bins(in);
    }

private:
    // Whether points can be read from anywhere, and nothing is left out of what the headers promise.
    bool can_be_read_in_batches() const
    {
        const FileInfo& info = cloud_.info();
        return info.grid && info.points_known && cloud_.seekable() && !options_.read.skip_bad_files &&
               !options_.read.largest_coordinate;
    }

    std::vector<std::byte> find_or_make_plan()
    {
        std::vector<std::byte> found;
        if (team_.rank() == 0) found = jobs_.record_if_done({plan_stage}).value_or(std::vector<std::byte>());
        found = team_.broadcast(0, std::move(found));
        if (!found.empty()) return found;
        std::vector<std::byte> made = can_be_read_in_batches() ? plan_batches() : read_by_one();
        if (team_.rank() == 0) jobs_.write({plan_stage}, {}, made);
        return team_.broadcast(0, std::move(made));
    }

    // Collective; the plan is rank 0's.
    std::vector<std::byte> plan_batches()
    {
        const std::uint64_t points = cloud_.info().points, per_bin = work_.bin_points(points);
        check_tree_grid(*cloud_.info().grid);
        TopTree<Narrow> top;
        std::size_t bins = 1;
        TopPlanner<Narrow>::Sample sample;
        if (points > per_bin) {
            const auto share = sample_evenly(cloud_, team_.rank(), team_.size());
            std::vector<std::byte> bytes(share.size() * sizeof share[0]);
            std::memcpy(bytes.data(), share.data(), bytes.size());
            for (const Team::Bytes& part : team_.gather(std::move(bytes))) {
                if (team_.rank() != 0) continue;
                const std::size_t before = sample.size();
                sample.resize(before + part.size() / sizeof sample[0]);
                std::memcpy(sample.data() + before, part.data(), part.size());
            }
        }
        if (team_.rank() != 0) return {};
        if (!sample.empty())
            bins = TopPlanner<Narrow>(top, axis_shift(*cloud_.info().grid), per_bin).plan(0, sample, points, 0);
        ByteWriter plan;
        plan.put(std::uint8_t(1));
        plan.put(batch_size(points));
        plan.put(static_cast<std::uint64_t>(bins));
        save_top(top, plan);
        return std::move(plan.bytes());
    }

    // By rank 0; the plan is the result.
    std::vector<std::byte> read_by_one()
    {
        if (team_.rank() != 0) return {};
        const AnyBins bins = partition(cloud_, work_, found_);
        take_reader_facts(cloud_.info(), found_);
        ByteWriter plan;
        plan.put(std::uint8_t(0));
        save_bins(found_, bins, plan);
        std::visit([](const auto& of) { of.scratch->sync(); }, bins);
        found_ = Ingested();
        return std::move(plan.bytes());
    }

    AnyTop take_bins(ByteReader& in)
    {
        const AnyBins bins = load_bins(found_, work_, cloud_.info().schema, in);
        const std::uint32_t file = rows_.add_file(work_.folder / scratch_file_name);
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

    AnyTop read_batches(ByteReader& in)
    {
        const auto size = in.get<std::uint64_t>();
        const auto bins = in.get<std::uint64_t>();
        top_ = load_top<Narrow>(in);
        found_.schema = cloud_.info().schema;
        found_.position_type = cloud_.info().position_type;
        found_.grid = *cloud_.info().grid;
        found_.layout = RowLayout(found_.schema, false);
        rows_.add_bins(bins);
        make_starts();
        const std::vector<Batch> batches = batches_of(cloud_.points_of_sources(), size);
        share_jobs(
            team_, count_batches, batches.size(), 1,
            [&](std::size_t i) {
                if (!jobs_.is_done({batch_stage, i})) read_batch(i, batches[i], bins);
            },
            [&](std::size_t begun) {
                work_.watch.report("Reading points", 0.4 * static_cast<double>(begun) /
                                                         static_cast<double>(std::max<std::size_t>(1, batches.size())));
            });
        take_batches(batches.size());
        divide_bins<Narrow>(all_, found_, top_, rows_);
        return std::move(top_);
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
        const Key job{batch_stage, number};
        const std::filesystem::path path = jobs_.unfinished(job);
        Observed observed;
        std::uint64_t bytes;
        ByteWriter record;
        {
            Scratch scratch(path, found_.layout, found_.schema, work_.space);
            scratch.add_bins(bins);
            Scratch::Writer writer(scratch, 0, bins, work_.memory_bytes / 4);
            const std::size_t notes_before = cloud_.info().notes.size();
            cloud_.seek(batch.first);
            if (cloud_.has_records())
                distribute<RecordBatch>(batch, writer, observed);
            else
                distribute<PointBatch>(batch, writer, observed);
            writer.flush();
            bytes = scratch.bytes();
            save_observed(observed, record);
            const std::vector<std::string>& notes = cloud_.info().notes;
            record.put(static_cast<std::uint64_t>(notes.size() - notes_before));
            for (std::size_t n = notes_before; n < notes.size(); ++n) record.put_string(notes[n]);
            BinRows::save(scratch, record);
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

    template <class Points>
    void distribute(const Batch& batch, Scratch::Writer& writer, Observed& observed)
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

    // Collective: what the batches hold. Each rank reads the records of some.
    void take_batches(std::size_t batches)
    {
        ByteWriter mine;
        for (std::size_t i = team_.rank(); i < batches; i += team_.size()) {
            const std::vector<std::byte> record = jobs_.record({batch_stage, i});
            mine.put_bytes(record.data(), record.size());
        }
        const std::vector<Team::Bytes> all = team_.gather(std::move(mine.bytes()));
        std::vector<ByteReader> in;
        for (const Team::Bytes& bytes : all) in.emplace_back(bytes.data(), bytes.size(), work_.folder);
        const FileInfo& info = cloud_.info();
        std::vector<std::string> late;
        for (std::size_t i = 0; i < batches; ++i) {
            ByteReader& from = in[i % team_.size()];
            found_.observed.merge(load_observed(from));
            for (auto left = from.get<std::uint64_t>(); left > 0; --left) late.push_back(from.get_string());
            const std::uint32_t file = rows_.add_file(jobs_.file({batch_stage, i}));
            for (auto& [bin, piece] : BinRows::load(from, file)) {
                if (bin >= rows_.bins()) throw Error(ErrorCode::corrupt, work_.folder, "a batch has unknown bins");
                rows_.add(bin, std::move(piece));
            }
        }
        found_.points_in = found_.observed.points;
        take_reader_facts(info, found_);
        for (std::string& note : late)
            if (std::find(found_.notes.begin(), found_.notes.end(), note) == found_.notes.end())
                found_.notes.push_back(std::move(note));
    }

    Team& team_;
    const JobFolder& jobs_;
    Workspace& work_;
    const BuildOptions& options_;
    const TeamWork& all_;
    MergedReader& cloud_;
    Ingested& found_;
    BinRows& rows_;
    TopTree<Narrow> top_;
    std::vector<std::byte> row_bytes_;
};

}  // namespace

AnyTop read_input(const TeamWork& team_work, MergedReader& cloud, Ingested& found, BinRows& rows)
{
    return InputJobs(team_work, cloud, found, rows).run();
}

}  // namespace pcm
