#include "pcm/tree/about.h"

#include "pcm/bpc/attribute_bytes.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/tree/parse_beginning.h"

#include <cmath>
#include <cstring>

namespace pcm {
namespace {

constexpr std::uint32_t about_version = 3;
constexpr std::uint8_t coverage_kept = 1;

// Throws Error(corrupt) when the file is not as long as its contents need, before memory is taken for it.
void check_size(const File& file)
{
    const std::uint64_t size = file.size();
    if (size <= first_beginning_bytes) return;
    const std::uint64_t needed = parse_beginning(file, [&](ByteReader& in) {
        in.get_bytes(sizeof about_magic + sizeof about_version);
        get_tree_info(in, file.path());
        return in.position() + sizeof(std::uint64_t);
    });
    if (size != needed)
        throw Error(ErrorCode::corrupt, file.path(),
                    "the file has " + std::to_string(size) + " bytes, and its contents take " + std::to_string(needed));
}

}  // namespace

void put_tree_info(ByteWriter& out, const TreeInfo& info)
{
    out.put(info.generation);
    out.put(static_cast<std::uint32_t>(info.levels));
    out.put(info.points);
    out.put(info.points_skipped);
    out.put(info.content_hash);
    out.put(info.position_error);
    for (const double s : info.grid.scale) out.put(s);
    for (const double o : info.grid.offset) out.put(o);
    put_vec(out, info.box.min);
    put_vec(out, info.box.max);
    for (const Vec3i& extreme : info.extremes) put_vec(out, extreme);
    out.put(static_cast<std::uint8_t>(info.position_type));
    out.put(static_cast<std::uint8_t>(info.wide));
    out.put(static_cast<std::uint8_t>(info.sampling));
    out.put(info.coverage_kept ? coverage_kept : std::uint8_t(0));
    for (const double spacing : info.spacings) out.put(spacing);
    out.put(static_cast<std::uint32_t>(info.schema.size()));
    for (const Attribute& attribute : info.schema) put_attribute(out, attribute);
    out.put(static_cast<std::uint32_t>(info.metadata.size()));
    for (const Metadata& block : info.metadata) {
        out.put_string(block.key);
        out.put(static_cast<std::uint64_t>(block.value.size()));
        out.put_bytes(block.value.data(), block.value.size());
    }
    out.put(static_cast<std::uint32_t>(info.sources.size()));
    for (const std::string& source : info.sources) out.put_string(source);
}

TreeInfo get_tree_info(ByteReader& in, const std::filesystem::path& path)
{
    const auto refuse = [&](const char* what) { return Error(ErrorCode::corrupt, path, what); };
    TreeInfo info;
    info.generation = in.get<std::uint32_t>();
    if (info.generation == 0) throw refuse("the generation is 0; the first is 1");
    const auto levels = in.get<std::uint32_t>();
    if (levels > 256) throw refuse("the number of levels is wrong");
    info.levels = static_cast<std::uint16_t>(levels);
    info.points = in.get<std::uint64_t>();
    info.points_skipped = in.get<std::uint64_t>();
    info.content_hash = in.get<std::uint64_t>();
    info.position_error = in.get<double>();
    for (double& s : info.grid.scale) s = in.get<double>();
    for (double& o : info.grid.offset) o = in.get<double>();
    info.box.min = get_vec(in);
    info.box.max = get_vec(in);
    for (Vec3i& extreme : info.extremes) extreme = get_vec(in);
    const auto type = in.get<std::uint8_t>();
    if (!is_valid(static_cast<ScalarType>(type))) throw refuse("the type of the positions does not exist");
    info.position_type = static_cast<ScalarType>(type);
    const auto wide = in.get<std::uint8_t>();
    const auto sampling = in.get<std::uint8_t>();
    const auto flags = in.get<std::uint8_t>();
    if (wide > 1 || flags > coverage_kept) throw refuse("a flag has a value that no tree has");
    info.wide = wide != 0;
    if (sampling > static_cast<std::uint8_t>(Sampling::grid)) throw refuse("the kind of sampling does not exist");
    info.sampling = static_cast<Sampling>(sampling);
    info.coverage_kept = flags & coverage_kept;
    info.spacings.resize(info.levels);
    for (double& spacing : info.spacings) spacing = in.get<double>();
    for (std::size_t k = 0; k < info.spacings.size(); ++k) {
        const double spacing = info.spacings[k];
        const bool last = k + 1 == info.spacings.size();
        if (!std::isfinite(spacing) || spacing < 0 || (spacing == 0 && !last) ||
            (k > 0 && spacing >= info.spacings[k - 1]))
            throw Error(ErrorCode::corrupt, path, "level " + std::to_string(k) + " has a spacing out of order");
    }
    const auto attributes = in.get<std::uint32_t>();
    if (attributes > max_attributes) throw refuse("the number of attributes is wrong");
    for (std::uint32_t i = 0; i < attributes; ++i) get_attribute(in, info.schema, path);
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
        Metadata block;
        block.key = in.get_string();
        const auto size = in.get<std::uint64_t>();
        if (size > in.left()) throw refuse("a metadata block reaches past the end");
        const std::byte* from = in.get_bytes(static_cast<std::size_t>(size));
        block.value.assign(from, from + size);
        info.metadata.push_back(std::move(block));
    }
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) info.sources.push_back(in.get_string());
    return info;
}

bool same_info(const TreeInfo& a, const TreeInfo& b)
{
    ByteWriter of_a, of_b;
    put_tree_info(of_a, a);
    put_tree_info(of_b, b);
    return of_a.bytes() == of_b.bytes();
}

void write_about(const std::filesystem::path& folder, const TreeInfo& info)
{
    ByteWriter out;
    out.put_bytes(about_magic, sizeof about_magic);
    out.put(about_version);
    put_tree_info(out, info);
    out.put(checksum(out.bytes().data(), out.size()));
    replace_file(folder / about_file_name, out.bytes().data(), out.size());
}

TreeInfo read_about(const std::filesystem::path& folder)
{
    const File file(folder / about_file_name, File::Mode::read);
    const std::filesystem::path& path = file.path();
    const std::uint64_t size = file.size();
    if (size < sizeof about_magic + 12)
        throw Error(ErrorCode::corrupt, path, "the file has " + std::to_string(size) + " bytes, which is impossible");
    check_size(file);
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    file.read_at(bytes.data(), bytes.size(), 0);
    if (std::memcmp(bytes.data(), about_magic, sizeof about_magic) != 0)
        throw Error(ErrorCode::corrupt, path, "this is not the about.pct of a tree");
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - 8, 8);
    if (stored != checksum(bytes.data(), bytes.size() - 8))
        throw Error(ErrorCode::corrupt, path, "the checksum does not match");
    ByteReader in(bytes.data(), bytes.size() - 8, path);
    in.get_bytes(sizeof about_magic);
    const auto found = in.get<std::uint32_t>();
    if (found != about_version)
        throw Error(
            ErrorCode::unsupported, path,
            "version " + std::to_string(found) + ", this program reads version " + std::to_string(about_version));
    TreeInfo info = get_tree_info(in, path);
    if (in.left() != 0) throw Error(ErrorCode::corrupt, path, "the file has bytes after its end");
    return info;
}

std::optional<AboutFault> check_about(const std::filesystem::path& folder, const TreeInfo& index)
{
    const std::string name = (folder / about_file_name).string();
    try {
        const TreeInfo about = read_about(folder);
        if (about.generation == index.generation + 1)
            return AboutFault{name + ": it was written by an interrupted update", true};
        if (about.generation != index.generation)
            return AboutFault{name + ": it is of generation " + std::to_string(about.generation) +
                              ", the index is of generation " + std::to_string(index.generation)};
        if (!same_info(about, index)) return AboutFault{name + ": it differs from the index"};
        return std::nullopt;
    } catch (const Error& error) {
        if (error.code() == ErrorCode::permission || error.code() == ErrorCode::io) throw;
        return AboutFault{error.what()};
    }
}

}  // namespace pcm
