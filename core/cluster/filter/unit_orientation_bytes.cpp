#include "pcm/cluster/filter/unit_orientation_bytes.h"

namespace pcm {
namespace {

void put(ByteWriter& out, const PointPlace& place)
{
    out.put(place.node);
    out.put(place.index);
}

PointPlace get_place(ByteReader& in)
{
    const auto node = in.get<NodeId>();
    return {node, in.get<std::uint32_t>()};
}

}  // namespace

std::vector<std::byte> bytes_of(const UnitOrientation& unit)
{
    ByteWriter out;
    out.put(static_cast<std::uint64_t>(unit.pieces.size()));
    for (const UnitOrientation::Piece& piece : unit.pieces) {
        const PieceSums& sums = piece.sums;
        for (const double sum : {sums.count, sums.squares, sums.flux}) out.put(sum);
        for (const Vec3d& sum : {sums.positions, sums.normals})
            for (std::size_t a = 0; a < 3; ++a) out.put(sum[a]);
        put(out, piece.first);
    }
    out.put(static_cast<std::uint64_t>(unit.border.size()));
    for (const UnitOrientation::BorderPair& pair : unit.border) {
        put(out, pair.own);
        put(out, pair.other);
        out.put(static_cast<std::uint8_t>(pair.across));
    }
    return std::move(out.bytes());
}

UnitOrientation orientation_of(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    UnitOrientation unit;
    if (bytes.empty()) return unit;
    ByteReader in(bytes.data(), bytes.size(), path);
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        UnitOrientation::Piece piece{};
        PieceSums& sums = piece.sums;
        for (double* const sum : {&sums.count, &sums.squares, &sums.flux}) *sum = in.get<double>();
        for (Vec3d* const sum : {&sums.positions, &sums.normals})
            for (std::size_t a = 0; a < 3; ++a) (*sum)[a] = in.get<double>();
        piece.first = get_place(in);
        unit.pieces.push_back(piece);
    }
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        const PointPlace own = get_place(in), other = get_place(in);
        unit.border.push_back({own, other, in.get<std::uint8_t>() != 0});
    }
    return unit;
}

}  // namespace pcm
