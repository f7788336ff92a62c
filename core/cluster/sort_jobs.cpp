#include "pcm/cluster/sort_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/build/levels/morton_sort.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/stages.h"

namespace pcm {
namespace {

template <class Coord>
void put_box(ByteWriter& out, const typename SortedPoints<Coord>::Box& box)
{
    out.put(box.points);
    for (const Point<Coord>* p : {&box.low, &box.high})
        for (const Coord c : *p) out.put(c);
}

template <class Coord>
typename SortedPoints<Coord>::Box get_box(ByteReader& in)
{
    typename SortedPoints<Coord>::Box box;
    box.points = in.get<std::uint64_t>();
    for (Point<Coord>* p : {&box.low, &box.high})
        for (Coord& c : *p) c = in.get<Coord>();
    return box;
}

}  // namespace

template <class Coord>
BinFiles<Coord>::BinFiles(const TeamWork& team_work, const Ingested& cloud, std::size_t bins)
    : all_(team_work),
      cloud_(cloud),
      finer_(axis_shift(cloud.grid)),
      sorted_(
          [&jobs = team_work.jobs](std::size_t bin) {
              return File(jobs.file({stage::bins, bin}), File::Mode::read);
          },
          cloud.layout, cloud.schema, team_work.work.space),
      count_(bins)
{
    sorted_.resize(bins);
}

template <class Coord>
BinFiles<Coord>::BinFiles(const TeamWork& team_work, const Ingested& cloud, ByteReader& in)
    : BinFiles(team_work, cloud, in.get<std::uint64_t>())
{
    for (std::size_t bin = 0; bin < count_; ++bin) sorted_.set_box(bin, get_box<Coord>(in));
}

template <class Coord>
void BinFiles<Coord>::save(ByteWriter& out) const
{
    out.put(static_cast<std::uint64_t>(count_));
    for (std::size_t bin = 0; bin < count_; ++bin) put_box<Coord>(out, sorted_.points().box(bin));
}

template <class Coord>
void BinFiles<Coord>::sort(const BinRows& rows)
{
    all_.jobs.begin(stage::bins);
    std::vector<std::size_t> filled;
    for (std::size_t bin = 0; bin < count_; ++bin)
        if (rows.rows(bin) > 0) filled.push_back(bin);
    share_jobs(
        all_.team, count_bins, filled.size(), all_.work.bin_threads(cloud_.layout, cloud_.observed.points),
        [&](std::size_t i) {
            if (!all_.jobs.is_done({stage::bins, filled[i]})) sort_bin(filled[i], rows);
        },
        [&](std::size_t begun) {
            all_.work.watch.report("Sorting points",
                                   0.4 + 0.1 * static_cast<double>(begun) / static_cast<double>(filled.size() + 1));
        });
    // Each rank reads the boxes of some.
    ByteWriter boxes;
    for (std::size_t i = all_.team.rank(); i < filled.size(); i += all_.team.size()) {
        load(filled[i]);
        put_box<Coord>(boxes, sorted_.points().box(filled[i]));
    }
    const std::vector<Team::Bytes> all = all_.team.gather(std::move(boxes.bytes()));
    std::vector<ByteReader> in;
    for (const Team::Bytes& bytes : all) in.emplace_back(bytes.data(), bytes.size(), all_.work.folder);
    for (std::size_t i = 0; i < filled.size(); ++i) {
        const auto box = get_box<Coord>(in[i % all_.team.size()]);
        if (box.points != rows.rows(filled[i]))
            throw Error(ErrorCode::corrupt, all_.jobs.file({stage::bins, filled[i]}),
                        "the bin has " + std::to_string(box.points) + " points, " +
                            std::to_string(rows.rows(filled[i])) + " were expected",
                        "remove " + all_.work.folder.string() + " and build again");
        sorted_.set_box(filled[i], box);
    }
}

template <class Coord>
void BinFiles<Coord>::sort_bin(std::size_t bin, const BinRows& rows)
{
    const std::vector<std::byte> unsorted = rows.read(bin);
    const std::size_t count = unsorted.size() / cloud_.layout.bytes;
    const std::vector<std::byte> data =
        sorted_.packed(bin, unsorted, morton_order<Coord>(unsorted.data(), count, cloud_.layout, finer_));
    ByteWriter record;
    sorted_.save(bin, record);
    all_.jobs.write({stage::bins, bin}, data, record.bytes());
}

template <class Coord>
void BinFiles<Coord>::load(std::size_t bin)
{
    const std::vector<std::byte> record = all_.jobs.record({stage::bins, bin});
    ByteReader in(record.data(), record.size(), all_.work.folder);
    sorted_.load(bin, in);
}

template class BinFiles<std::uint32_t>;
template class BinFiles<std::uint64_t>;

}  // namespace pcm
