#include "pcm/build/build_checkpoint.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"

#include <sys/stat.h>

#include <cerrno>

namespace pcm {
namespace {

namespace fs = std::filesystem;

// Incremented whenever the same files and options would make another tree, or the layout of scratch files changes.
constexpr std::uint32_t build_version = 6;

template <class T>
void put_all(ByteWriter& out, const T& values)
{
    for (const auto v : values) out.put(v);
}
template <class T>
void get_all(ByteReader& in, T& values)
{
    for (auto& v : values) v = in.get<std::decay_t<decltype(v)>>();
}

void put_bytes(ByteWriter& out, const std::vector<std::byte>& bytes)
{
    out.put(static_cast<std::uint64_t>(bytes.size()));
    out.put_bytes(bytes.data(), bytes.size());
}
std::vector<std::byte> get_bytes(ByteReader& in)
{
    const auto count = in.get<std::uint64_t>();
    if (count > in.left()) throw Error(ErrorCode::corrupt, {}, "a checkpoint is truncated");
    const std::byte* from = in.get_bytes(count);
    return {from, from + count};
}

template <class Coord>
Bins<Coord> get_bins(const Ingested& cloud, Workspace& work, ByteReader& in)
{
    Bins<Coord> bins;
    bins.top = load_top<Coord>(in);
    bins.scratch =
        std::make_shared<Scratch>(work.folder / scratch_file_name, cloud.layout, cloud.schema, work.space, in);
    for (const auto& node : bins.top.nodes)
        if (node.bin >= bins.scratch->bins()) throw Error(ErrorCode::corrupt, {}, "a checkpoint makes no sense");
    return bins;
}

}  // namespace

template <class Coord>
void save_top(const TopTree<Coord>& top, ByteWriter& out)
{
    out.put(static_cast<std::uint64_t>(top.nodes.size()));
    for (const auto& node : top.nodes) {
        out.put(static_cast<std::uint8_t>(node.axis));
        out.put(node.value);
        put_all(out, node.children);
        out.put(static_cast<std::uint64_t>(node.bin));
    }
}

template <class Coord>
TopTree<Coord> load_top(ByteReader& in)
{
    TopTree<Coord> top;
    const auto nodes = in.get<std::uint64_t>();
    top.nodes.clear();
    for (std::uint64_t n = 0; n < nodes; ++n) {
        auto& node = top.nodes.emplace_back();
        node.axis = in.get<std::uint8_t>();
        node.value = in.get<Coord>();
        get_all(in, node.children);
        node.bin = in.get<std::uint64_t>();
        if (node.axis > 2 || node.children[0] >= nodes || node.children[1] >= nodes ||
            (node.children[0] && (node.children[0] <= n || node.children[1] <= n)))
            throw Error(ErrorCode::corrupt, {}, "a checkpoint makes no sense");
    }
    if (nodes == 0) throw Error(ErrorCode::corrupt, {}, "a checkpoint makes no sense");
    return top;
}

template void save_top(const TopTree<std::uint32_t>&, ByteWriter&);
template void save_top(const TopTree<std::uint64_t>&, ByteWriter&);
template TopTree<std::uint32_t> load_top(ByteReader&);
template TopTree<std::uint64_t> load_top(ByteReader&);

void save_observed(const Observed& observed, ByteWriter& out)
{
    out.put(observed.points);
    out.put(observed.hash);
    out.put(observed.position_error);
    for (const Vec3i& p : observed.extremes) put_all(out, p);
}

Observed load_observed(ByteReader& in)
{
    Observed observed;
    observed.points = in.get<std::uint64_t>();
    observed.hash = in.get<std::uint64_t>();
    observed.position_error = in.get<double>();
    for (Vec3i& p : observed.extremes) get_all(in, p);
    return observed;
}

void save_found(const Ingested& cloud, ByteWriter& out)
{
    put_all(out, cloud.grid.scale);
    put_all(out, cloud.grid.offset);
    out.put(static_cast<std::uint8_t>(cloud.layout.coordinate_bytes));
    out.put(static_cast<std::uint8_t>(cloud.position_type));
    save_observed(cloud.observed, out);
    out.put(cloud.points_in);
    out.put(cloud.points_skipped);
    out.put(cloud.skipped.lines);
    out.put(cloud.skipped.files);
    out.put(cloud.skipped.incomplete_files);
    out.put(static_cast<std::uint64_t>(cloud.notes.size()));
    for (const std::string& note : cloud.notes) out.put_string(note);
    out.put(static_cast<std::uint64_t>(cloud.metadata.size()));
    for (const Metadata& metadata : cloud.metadata) {
        out.put_string(metadata.key);
        put_bytes(out, metadata.value);
    }
}

void save_bins(const Ingested& cloud, const AnyBins& any, ByteWriter& out)
{
    save_found(cloud, out);
    std::visit(
        [&](const auto& bins) {
            save_top(bins.top, out);
            bins.scratch->save(out);
        },
        any);
}

void load_found(Ingested& cloud, const Schema& schema, ByteReader& in)
{
    get_all(in, cloud.grid.scale);
    get_all(in, cloud.grid.offset);
    cloud.schema = schema;
    const bool wide = in.get<std::uint8_t>() == 8;
    cloud.layout = RowLayout(schema, wide);
    cloud.position_type = static_cast<ScalarType>(in.get<std::uint8_t>());
    cloud.observed = load_observed(in);
    cloud.points_in = in.get<std::uint64_t>();
    cloud.points_skipped = in.get<std::uint64_t>();
    cloud.skipped.lines = in.get<std::uint64_t>();
    cloud.skipped.files = in.get<std::uint64_t>();
    cloud.skipped.incomplete_files = in.get<std::uint64_t>();
    const auto notes = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < notes; ++i) cloud.notes.push_back(in.get_string());
    const auto items = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < items; ++i) {
        Metadata metadata;
        metadata.key = in.get_string();
        metadata.value = get_bytes(in);
        cloud.metadata.push_back(std::move(metadata));
    }
}

AnyBins load_bins(Ingested& cloud, Workspace& work, const Schema& schema, ByteReader& in)
{
    load_found(cloud, schema, in);
    if (cloud.layout.coordinate_bytes == 8) return get_bins<std::uint64_t>(cloud, work, in);
    return get_bins<std::uint32_t>(cloud, work, in);
}

std::vector<std::byte> identity_of_build(const std::vector<fs::path>& files, const BuildOptions& options)
{
    ByteWriter out;
    out.put(build_version);
    out.put(options.chunk_points);
    out.put(static_cast<std::uint8_t>(options.sampling));
    const TextLayout& text = options.read.text;
    out.put(static_cast<std::uint8_t>(text.separator.has_value()));
    out.put(text.separator.value_or(0));
    out.put(static_cast<std::uint8_t>(text.skip_lines.has_value()));
    out.put(static_cast<std::uint64_t>(text.skip_lines.value_or(0)));
    out.put(static_cast<std::uint64_t>(text.columns.size()));
    for (const std::string& column : text.columns) out.put_string(column);
    out.put(text.colour_range.value_or(-1));
    out.put(static_cast<std::uint8_t>(options.read.skip_bad_lines));
    out.put(static_cast<std::uint8_t>(options.read.skip_bad_files));
    out.put(options.read.largest_coordinate.value_or(-1));
    out.put(static_cast<std::uint64_t>(files.size()));
    for (const fs::path& file : files) {
        struct stat status {};
        if (::stat(file.c_str(), &status) != 0) throw Error::from_errno(errno, file, "reading the status of the file");
        std::error_code error;
        const fs::path absolute = fs::absolute(file, error);
        out.put_string((error ? file : absolute.lexically_normal()).string());
        out.put(static_cast<std::uint64_t>(status.st_size));
        out.put(static_cast<std::int64_t>(status.st_mtim.tv_sec));
        out.put(static_cast<std::int64_t>(status.st_mtim.tv_nsec));
    }
    return std::move(out.bytes());
}

}  // namespace pcm
